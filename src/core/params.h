/* SPDX-License-Identifier: MIT
 *
 * Layer 5: everything that decides a picture besides the compiled scene: what a user changes while
 * looking. A plain value; whoever needs it longer copies it.
 */
#ifndef FL_PARAMS_H
#define FL_PARAMS_H

#include "core/revolve.h"
#include "core/sampler.h"
#include "core/scene.h"

/** How the picture plane is laid out (scene-format, section 5). */
typedef enum fl_camera_model {
    FL_CAMERA_VERTICAL_FOV, /**< Ours and PA1: vertical field of view, square pixels. */
    FL_CAMERA_UNIT_SQUARE,  /**< M04: the field of view spans the picture in both axes. */
    FL_CAMERA_RAW_UP        /**< M12: likewise, and `up` is used as given. */
} fl_camera_model;

/** Sampling sets that stand still: all samples of a pixel draw the set's point number 0, so that
 * what noise is left comes from the others (noise.h). Bits of fl_params.frozen; 0, the default,
 * costs nothing. Lights beyond the last bit share it. */
enum {
    FL_FREEZE_PIXEL = 1u << 0,
    FL_FREEZE_LENS = 1u << 1,
    FL_FREEZE_DEEPER = 1u << 2, /**< Lights seen from reflected and refracted rays. */
    FL_FREEZE_LIGHTS_MAX = 29
};

/** The bit of light number `index` (scene order) as seen from camera hits. */
static inline uint32_t fl_freeze_light(uint32_t index)
{
    return 1u << (3 + fl_min_u32(index, FL_FREEZE_LIGHTS_MAX - 1));
}

/** Where the single sample of a pixel lies under --dialect-exact. */
typedef enum fl_pixel_rule {
    FL_PIXEL_AREA,
    FL_PIXEL_CORNER,
    FL_PIXEL_CENTER,
    FL_PIXEL_GRID_ENDS
} fl_pixel_rule;

/** In which numbers rays are traced; double is the built-in measure of float error, and slower. */
typedef enum fl_precision { FL_PRECISION_FLOAT, FL_PRECISION_DOUBLE } fl_precision;

/** What a course's own program leaves out or does otherwise; all zero is our way (decision 22). */
typedef struct fl_exact_rules {
    fl_pixel_rule pixel;
    bool no_shadows, no_recursion, ungated_specular, no_normal_flip;
    bool black_back_faces; /**< M04 without its -shade_back: not even ambient light on them. */
    bool course_cube;      /**< M12's cube lookup: back and down mirrored, no half-texel shift. */
    bool truncate_bytes;   /**< Output is (int)(c * 255) of linear values, no sRGB. */
} fl_exact_rules;

typedef struct fl_params {
    fl_camera camera;
    fl_camera_model camera_model;
    uint32_t width, height; /**< Of the whole picture, pixels. */
    /** Part to render, from the top left; crop_w 0: all of it. */
    uint32_t crop_x, crop_y, crop_w, crop_h;
    uint32_t depth_limit;    /**< Bounces: 0 shades camera hits only. At most FL_DEPTH_MAX. */
    double weight_threshold; /**< A branch whose max(r,g,b) throughput is below ends. */
    uint32_t light_samples;  /**< Shadow rays per disc light and hit; 0: each light's own. */
    /** Of lights that have no number of their own; 0 counts as 1. */
    uint32_t light_samples_default;
    bool transparent_shadows;
    fl_sampler sampler;
    uint32_t seed;
    uint32_t strata; /**< Samples a pixel will get: FL_SAMPLER_STRATIFIED must know. */
    /** Samples go where the noise is (allocation.h): fl_render_limits.samples is then the mean
     * number. Never for references. A change restarts, and costs 28 bytes a pixel. */
    bool is_adaptive;
    uint32_t frozen; /**< For measurement: bits of FL_FREEZE_*. */
    fl_revolve_solver solver;
    fl_precision precision;
    fl_exact_rules exact;
    fl_vec3 background, ambient;
    /** Borrowed for the call that takes the parameters, which copies them. */
    const fl_light *lights;
    uint32_t light_count;
} fl_params;

enum {
    FL_DEPTH_MAX = 64,
    FL_DEPTH_DEFAULT = 5,
    FL_LIGHT_SAMPLES_MAX = 1 << 20,
    FL_SIZE_DEFAULT = 640, /**< Of a scene that has no size. */
    FL_SAMPLES_DEFAULT = 64
};
#define FL_WEIGHT_THRESHOLD_DEFAULT (1.0 / 1024.0)

/** What the scene asks for. Borrows scene->lights. is_exact: with the dialect's own rules. */
void fl_params_from_scene(fl_params *out_params, const fl_scene *scene, bool is_exact);

/** Check every range that a picture depends on; adds an error naming the option or key. True: all
 * is well. */
bool fl_params_check(const fl_params *params, fl_diags *diags);

#endif
