/* SPDX-License-Identifier: MIT
 *
 * Layer 5: parameters made ready for one generation of a render: camera basis, lights and features
 * in use, all in the space of the compiled geometry. Immutable, reference counted, shared by the
 * workers.
 */
#ifndef FL_FRAME_H
#define FL_FRAME_H

#include "core/compile.h"
#include "core/sample_warp.h"

typedef struct fl_frame_light {
    fl_light_kind kind;
    float position[3];
    float axis_u[3], axis_v[3]; /**< Disk: radius times an orthonormal basis of its plane. */
    float to_light[3];          /**< Directional: unit vector towards the light. */
    float normal[3];            /**< Disk. */
    float color[3];
    float attenuation[3];
    bool has_attenuation, is_two_sided;
    bool is_dark;     /**< Black, as when it is switched off: it is left out. */
    bool draws;       /**< Points of the disk are drawn: two dimensions a sample. */
    uint32_t samples; /**< 1 for point, directional and radius-0 disk lights. */
    uint32_t index;   /**< In the scene's order: part of the sample set's number (decision 6). */
} fl_frame_light;

/** Features whose sample dimensions exist in this frame. */
typedef struct fl_frame_plan {
    bool samples_pixel, samples_lens;
    bool has_lights, has_reflection, has_refraction, has_textures, has_specular, has_shadows;
    uint32_t dimensions; /**< Sample dimensions drawn per camera ray: pixel first, then lens. */
} fl_frame_plan;

typedef struct fl_frame {
    fl_ref ref;
    fl_compiled *scene; /**< A reference. */
    fl_params params;   /**< A copy; params.lights is owned by the frame. */
    fl_frame_plan plan;
    uint32_t x0, y0, width, height; /**< The rendered part, absolute pixels; row 0 is the top. */
    /* Camera: see fl_frame_ray. Relative to geometry.origin. */
    fl_vec3 eye, axis_h, axis_v, axis_w;
    double step_x, step_y, half_w, half_h;
    double pixel_x, pixel_y;        /**< Where in the pixel the sample lies when it is not drawn. */
    double inverse_focus, aperture; /**< aperture: radius of the lens. */
    fl_aperture opening;            /**< Its shape, of circumradius 1. */
    bool is_orthographic;
    fl_frame_light *lights;
    uint32_t light_count;
} fl_frame;

/** Check the parameters and prepare them. Retains `scene`, copies `params`. NULL after adding an
 * error. */
fl_frame *fl_frame_create(fl_compiled *scene, const fl_params *params, fl_diags *diags);
fl_frame *fl_frame_retain(fl_frame *frame);
/** Drop a reference; NULL is allowed. */
void fl_frame_release(fl_frame *frame);

/** For tests, before the frame is shared: turn on every stage and draw every dimension, needed or
 * not. The picture must stay the same to the bit. */
void fl_frame_generalize(fl_frame *frame);

/** The ray through the point (x, y) of the picture, pixels of the whole picture from its top left
 * corner, and through the point (lens_x, lens_y) of the aperture, in units of its radius. Relative
 * to geometry.origin; d . w = 1: a hit's t is its plane depth. With d = w + sx h + sy v - l/focus
 * for the lens point l, every ray through one point of the picture meets the focus plane in one
 * point, and focus may be infinite (decision 10). */
static inline void fl_frame_ray(const fl_frame *frame, double x, double y, double lens_x,
                                double lens_y, fl_vec3 *out_origin, fl_vec3 *out_direction)
{
    double sx = (x - frame->half_w) * frame->step_x, sy = (frame->half_h - y) * frame->step_y;
    fl_vec3 screen = fl_v3_mad(fl_v3_scale(frame->axis_h, sx), frame->axis_v, sy);
    lens_x *= frame->aperture;
    lens_y *= frame->aperture;
    fl_vec3 lens = fl_v3_mad(fl_v3_scale(frame->axis_h, lens_x), frame->axis_v, lens_y);
    fl_vec3 origin = fl_v3_add(frame->eye, lens);
    fl_vec3 direction = fl_v3_mad(frame->axis_w, lens, -frame->inverse_focus);
    *out_origin = frame->is_orthographic ? fl_v3_add(origin, screen) : origin;
    *out_direction = frame->is_orthographic ? direction : fl_v3_add(direction, screen);
}

#endif
