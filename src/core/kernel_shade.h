/* SPDX-License-Identifier: MIT
 *
 * Layer 6: the wide stages around the intersection kernels: camera rays, lights, reflected and
 * refracted directions. One source, compiled per instruction set (wide.h); the same bits from each.
 *
 * All arrays have FL_STREAM_SLACK entries beyond FL_STREAM_RAYS, so that whole vectors may be read
 * and written anywhere in them; entries beyond the count mean nothing.
 */
#ifndef FL_KERNEL_SHADE_H
#define FL_KERNEL_SHADE_H

#include "core/frame.h"
#include "core/pipeline.h"
#include "core/stream.h"

/** Rays that go through the stages together: small enough that all arrays stay in the second-level
 * cache and that no stage between two checks for cancellation takes long. */
enum { FL_STREAM_RAYS = 512, FL_STREAM_SLACK = 16 };

/** Three arrays: x y z or red green blue. */
typedef struct fl_array3 {
    float *x, *y, *z;
} fl_array3;

/** Rays of one level on their way through the stages; after the miss stage only those that hit
 * something. */
typedef struct fl_stage {
    fl_rays rays;
    fl_hits hits;
    fl_surface surface;
    bool is_camera;  /**< All paths are FL_PATH_CAMERA. */
    uint32_t *pixel; /**< fl_pixel_id. */
    uint32_t *path;
    uint32_t *entry;  /**< Index in the stream as it was before misses were taken out. */
    uint32_t *shader; /**< Index into the compiled scene's. */
    fl_array3 view;   /**< Unit, towards where the ray came from. */
    fl_array3 normal; /**< Shading normal on the viewer's side of the geometric one (exact rules: as
                         it is). */
    fl_array3 diffuse, specular;
    float *shininess;
    float *index;       /**< Index of refraction; 0: this surface spawns nothing. */
    fl_array3 radiance; /**< So far. */
} fl_stage;

/** Light that arrives unless its ray is blocked. */
typedef struct fl_shadow {
    fl_rays rays;
    uint32_t *at;      /**< Index into the stage. */
    fl_array3 arrives; /**< Contribution to the stage's radiance. */
} fl_shadow;

/* Fields of a branch that are numbers: origin, direction, throughput; and words. */
enum { FL_BRANCH_NUMBERS = 9 };
enum {
    FL_BRANCH_OBJECT, /**< Which surface it leaves, */
    FL_BRANCH_PRIM,   /**< and where on it. */
    FL_BRANCH_PATH,
    FL_BRANCH_SLOT, /**< Which sample of the unit it belongs to. */
    FL_BRANCH_PIXEL,
    FL_BRANCH_REFRACTED, /**< 1, or 0: reflected. */
    FL_BRANCH_WORDS
};

/** Reflected and refracted rays that wait for their level, those of a slot next to each other and
 * slots ascending; {0} to begin. */
typedef struct fl_branches {
    float *number[FL_BRANCH_NUMBERS]; /**< Whole vectors may be written behind `count`. */
    uint32_t *word[FL_BRANCH_WORDS];
    uint32_t count, capacity;
    void *memory; /**< Owned, from aligned_alloc: all arrays. */
} fl_branches;

/** One instruction set's entry points. Thread: any, with its own stages. */
typedef struct fl_shade_kernels {
    /** Camera rays of `count` pixels of the unit from number `begin` on; sets rays, pixel and path.
     */
    void (*generate)(const fl_frame *frame, const fl_unit *unit, uint32_t begin, uint32_t count,
                     fl_stage *out_stage);
    /** Take the rays that hit nothing out of the stream; sets entry, and reads and writes up to
     * FL_STREAM_SLACK beyond. Returns how many are left; rays.count stays. Afterwards t_max and
     * source_* mean nothing. */
    uint32_t (*keep_hits)(fl_stage *stage);
    /** shader, diffuse, specular, shininess, index and radiance (the ambient light alone) from
     * hits and surface. True: something may spawn rays. Adds to *texture_lookups. */
    bool (*material)(const fl_frame *frame, fl_stage *stage, uint64_t *texture_lookups);
    /** fl_texture_eval for `count` coordinates; arrays with FL_STREAM_SLACK beyond. */
    void (*texture)(const fl_texture *texture, const float *u, const float *v, uint32_t count,
                    fl_array3 out);
    /** view and normal from rays and surface. */
    void (*orient)(const fl_frame *frame, fl_stage *stage);
    /** Sample number j of a light, sample `sample` of the pixel: everything that arrives and is not
     * exactly 0, in order of the stage. out_shadow->rays is filled only when the frame has shadows;
     * its count always is. */
    void (*light)(const fl_frame *frame, const fl_frame_light *light, uint32_t sample, uint32_t j,
                  const fl_stage *stage, fl_shadow *out_shadow);
    /** Append what the surfaces reflect and let through, where index is not 0 and it weighs enough:
     * at most two rays a hit, for which `out` has room. throughput and slot are by stage->entry. */
    void (*spawn)(const fl_frame *frame, const fl_stage *stage, fl_array3 throughput,
                  const uint32_t *slot, fl_branches *out);
} fl_shade_kernels;

extern const fl_shade_kernels fl_shade_kernels_scalar;
#if defined(__x86_64__)
extern const fl_shade_kernels fl_shade_kernels_sse2, fl_shade_kernels_avx2;
#elif defined(__aarch64__)
extern const fl_shade_kernels fl_shade_kernels_neon;
#endif

#endif
