/* SPDX-License-Identifier: MIT
 *
 * Layer 6: one unit of work through the tile pipeline: generate, intersect, resolve, shade,
 * occlude, spawn, accumulate, as stages over streams. No recursion, no allocation per ray, no
 * locks.
 */
#ifndef FL_PIPELINE_H
#define FL_PIPELINE_H

#include "core/frame.h"
#include "core/stream.h"

enum {
    FL_UNIT_PIXELS = 1024, /**< Largest unit. */
    FL_PENDING_MAX =
        64, /**< Pending rays a sample; beyond, the lightest are dropped and counted. */
    FL_SHADOW_SURFACES_MAX = 1024 /**< That a shadow ray passes where shadows are transparent. One
                                     that meets more counts as blocked, and is counted: it bounds
                                     the time of rays that creep along surfaces below the resolution
                                     of their coordinates. */
};

/** Sample `sample` of `count` pixels (absolute coordinates, any order). */
typedef struct fl_unit {
    const uint16_t *x, *y;
    uint32_t count;
    uint32_t sample;
} fl_unit;

/** Radiance of the unit's samples, index for index. An invalid sample (NaN or infinite) has
 * is_valid 0 and must not be accumulated (design rule 6). */
typedef struct fl_unit_result {
    float *r, *g, *b; /**< FL_UNIT_PIXELS each, 64-byte aligned. */
    uint8_t *is_valid;
} fl_unit_result;

/** Exact counts of what was done. */
typedef struct fl_counts {
    uint64_t samples, invalid_samples;
    uint64_t camera_rays, shadow_rays, reflect_rays, refract_rays;
    uint64_t dropped_branches;    /**< By FL_PENDING_MAX. */
    uint64_t stopped_shadow_rays; /**< By FL_SHADOW_SURFACES_MAX. */
    uint64_t sample_dimensions;   /**< Drawn. */
    uint64_t texture_lookups;
    fl_isect_counts isect;   /**< Of all rays. */
    fl_isect_counts occlude; /**< Of shadow rays alone. */
} fl_counts;

void fl_counts_add(fl_counts *sum, const fl_counts *part);

/** Where time goes. */
typedef enum fl_cost {
    FL_COST_GENERATE,   /**< Camera rays, and spawned ones put into streams. */
    FL_COST_NEAREST,    /**< What a ray meets first. */
    FL_COST_RESOLVE,    /**< That point again, in double. */
    FL_COST_MATERIAL,   /**< Background, textures, ambient light. */
    FL_COST_LIGHT,      /**< Points on lights and what they send. */
    FL_COST_OCCLUDE,    /**< Whether it arrives. */
    FL_COST_SPAWN,      /**< Reflected and refracted rays. */
    FL_COST_ACCUMULATE, /**< Radiance to samples. */
    FL_COST_FILM,       /**< Samples to the film, with the lock and the choice of the next unit. */
    FL_COST_COUNT
} fl_cost;
/** "generate", "nearest", ... */
extern const char *const fl_cost_names[FL_COST_COUNT];

/** Time by stage in units of fl_ticks, which are good for shares alone. Never twice the same, so
 * kept apart from fl_counts. */
typedef struct fl_cost_ticks {
    uint64_t of[FL_COST_COUNT];
} fl_cost_ticks;

/** A worker's private memory: streams, queues, result. */
typedef struct fl_workspace fl_workspace;

/** NULL: out of memory. One per worker; reusable for any frame. */
fl_workspace *fl_workspace_create(void);
void fl_workspace_destroy(fl_workspace *workspace);
/** The result arrays that fl_pipeline_run fills; owned by the workspace, valid until its next run.
 */
const fl_unit_result *fl_workspace_result(const fl_workspace *workspace);
/** What fl_pipeline_run has cost since its owner last wiped it, all but FL_COST_FILM. */
fl_cost_ticks *fl_workspace_ticks(fl_workspace *workspace);

/** Run one unit with the frame's instruction set; adds what it did to *counts. `generation` and
 * `wanted` as in fl_isect_context: false when the work became stale (or memory ran out, then
 * *out_of_memory is set) and the result must be dropped. Result = f(frame, pixels, sample) only:
 * the same bytes for any grouping of pixels into units, thread and instruction set. */
bool fl_pipeline_run(const fl_frame *frame, const fl_unit *unit, fl_workspace *workspace,
                     const atomic_uint_least64_t *generation, uint64_t wanted, fl_counts *counts,
                     bool *out_of_memory);

#endif
