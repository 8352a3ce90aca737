/* SPDX-License-Identifier: MIT
 *
 * Layer 6: what a worker keeps while it runs the tile pipeline. For pipeline*.c and their tests
 * only.
 */
#ifndef FL_PIPELINE_WORK_H
#define FL_PIPELINE_WORK_H

#include "core/arena.h"
#include "core/kernel_shade.h"
#include "core/pipeline.h"
#include "core/ticks.h"

/** Room for `more` beyond count; false: out of memory, the old ones are kept. Amortised O(more). */
bool fl_branches_reserve(fl_branches *branches, uint32_t more);
void fl_branches_deinit(fl_branches *branches);

/** Bring each slot's branches into order of path and keep the FL_PENDING_MAX heaviest of them:
 * largest throughput first, of equals the higher path. Returns how many were dropped. O(n) for few
 * branches a slot, else quadratic in those. */
uint32_t fl_branches_settle(fl_branches *branches);

struct fl_pipe;

/** When a witness is called. */
typedef enum fl_moment {
    FL_AT_HITS,     /**< Nearest hits are known, misses still in the stream. */
    FL_AT_SURFACES, /**< Surfaces and the ambient light on them are known. */
    FL_AT_LIGHT,    /**< Sample `j` of `light` is drawn, its shadow rays not traced. */
    FL_AT_SHADOW,   /**< They are. */
    FL_AT_RADIANCE  /**< `glow` is complete. */
} fl_moment;

/** Looks on while a unit runs, once a stream and moment; changes nothing. */
typedef struct fl_witness {
    void (*see)(void *context, const struct fl_pipe *pipe, fl_moment moment, uint32_t light,
                uint32_t j);
    void *context;
} fl_witness;

struct fl_workspace {
    fl_arena arena;            /**< All fixed arrays. */
    const fl_witness *witness; /**< NULL: nobody looks, at no cost. */
    fl_stage stage;
    fl_shadow shadow;
    uint32_t *blocked; /**< By index into the shadow stream. */
    fl_array3 lit; /**< What one light sends to each ray of the stage, summed over its samples. */
    fl_array3 glow, throughput; /**< By index into the stream before misses are taken out. */
    uint32_t *slot;             /**< Likewise. */
    fl_branches current, next;
    fl_shadow
        through; /**< Transparent shadows: what is still on its way; allocated at first use. */
    fl_hits through_hits;
    fl_surface through_surface;
    fl_array3 end; /**< Transparent shadows: the point on the light. */
    fl_unit_result result;
    fl_cost_ticks ticks;
};

/** Arrays for transparent shadows, once. False: out of memory. */
bool fl_workspace_reserve_through(fl_workspace *workspace);

/** The array for roots of surfaces of revolution, once. False: out of memory. */
bool fl_workspace_reserve_roots(fl_workspace *workspace);

/** One run of the pipeline: what its stages share. */
typedef struct fl_pipe {
    const fl_frame *frame;
    const fl_unit *unit;
    fl_workspace *work;
    const fl_isect_kernels *isect;
    const fl_shade_kernels *shade;
    fl_isect_context context;
    fl_counts counts; /**< Of this run. */
    uint64_t lap;     /**< When the stage at work began. */
} fl_pipe;

/** The time since the last lap went into `cost`. */
static inline void fl_pipe_lap(fl_pipe *pipe, fl_cost cost)
{
    uint64_t now = fl_ticks();
    pipe->work->ticks.of[cost] += now - pipe->lap;
    pipe->lap = now;
}

/** Fill what lies between count and the next multiple of 8 with rays that hit nothing, like the last
 * one otherwise, so that they reach no further than the others. */
void fl_rays_pad(fl_rays *rays);
/** The same for hits: nothing was hit. */
void fl_hits_pad(fl_hits *hits, uint32_t count);

/** Trace pipe->work->shadow and multiply `arrives` by what comes through: 0 where blocked, unless
 * shadows are transparent; then by the `refract` colours on the way, nearest first. False:
 * cancelled. */
bool fl_pipe_occlude(fl_pipe *pipe);

#endif
