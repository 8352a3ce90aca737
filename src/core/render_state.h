/* SPDX-License-Identifier: MIT
 *
 * Layer 8, private to render*.c: what the owner and the workers share.
 *
 * Rules. 1. Everything in fl_render is guarded by `lock`, except what never changes after creation
 * and `generation`, which is written under the lock and read by workers amid their work. 2. Nobody
 * holds the lock while tracing, waiting or calling back; the longest holds are the commit of a unit
 * and the copy of a few rows. 3. A worker touches a job only under the lock; amid a unit it uses
 * its own copy of the pixels and its own reference to the frame. 4. What dies under the lock is
 * freed after it (fl_trash).
 */
#ifndef FL_RENDER_STATE_H
#define FL_RENDER_STATE_H

#include <pthread.h>
#include <stdatomic.h>

#include "core/allocation.h"
#include "core/render.h"

/** One generation: parameters, what to do next, what there is so far. */
typedef struct fl_job {
    uint64_t generation;
    fl_frame *frame; /**< A reference; NULL in a job that is not in use. */
    uint32_t width, height;
    size_t bytes;
    fl_film *film;
    fl_schedule *schedule;
    fl_estimate *estimate;
    fl_allocation *allocation; /**< Adaptive sampling only; else NULL. */
    fl_counts counts;
    double cpu_seconds, cost_seconds[FL_COST_COUNT];
    double seconds_before; /**< Rendering time up to the last stop of the clock. */
    double begun_at;       /**< When the clock was started last; only while it runs. */
    double requested_at;   /**< When fl_render_restart was called. */
    double first_picture_seconds, first_sample_seconds;
} fl_job;

/** NULL: out of memory. No frame yet. */
fl_job *fl_job_create(uint32_t width, uint32_t height, bool is_adaptive);
bool fl_job_bytes(uint32_t width, uint32_t height, bool is_adaptive, size_t *out_bytes);
/** Whether there is something to hand out or, no unit being out, to plan. */
bool fl_job_has_work(const fl_job *job);
void fl_job_destroy(fl_job *job);
/** Forget all samples and what was counted; the frame is the new one's. */
void fl_job_reset(fl_job *job);

/** Things to free once the lock is released. */
typedef struct fl_trash {
    fl_frame *frames[4];
    fl_job *jobs[4];
    uint32_t frame_count, job_count;
} fl_trash;

void fl_trash_empty(fl_trash *trash);

typedef struct fl_worker {
    fl_render *render;
    pthread_t thread;
    fl_workspace *workspace;
    fl_frame *frame; /**< A reference to that of the last unit; the worker's own. */
    double cpu_seconds_seen;
    uint16_t x[FL_UNIT_PIXELS], y[FL_UNIT_PIXELS];
} fl_worker;

struct fl_render {
    fl_render_options options; /**< Never changes, like the next three. */
    fl_tonemapper *tonemapper;
    uint32_t worker_count;
    fl_worker *workers;

    atomic_uint_least64_t generation; /**< Of `current`; any other is stale. */

    pthread_mutex_t lock;
    pthread_cond_t work;    /**< There may be a unit, or the end. */
    pthread_cond_t stopped; /**< The state is no longer running, or the last unit of a held render
                               has come back. */

    /* Jobs. `shown` has rank 0 complete. A pending restart without a job of its own takes over that
     * of `shown`, which is free when current becomes shown. */
    fl_job *current, *shown, *spare;
    fl_frame *pending_frame;
    fl_job *pending_job;
    uint64_t newest_generation; /**< Of the pending restart if there is one. */
    double requested_at;        /**< When that was called. */

    fl_render_limits limits;
    fl_render_state state;
    bool is_paused, has_failed, should_quit, is_notified;
    bool is_held;         /**< As paused, while the owner waits for the units that are out. */
    uint64_t revision;    /**< Of what is to be shown; from 1. */
    uint32_t out_units;   /**< Of the current generation, at the workers. */
    uint32_t stale_units; /**< Of older ones, at the workers. */
    uint32_t parked;      /**< Workers waiting for `work`. */
    double begun_at, cancel_seconds; /**< Of the current generation. */

    float
        *rows; /**< The owner's: a few rows of the widest picture so far, for fl_render_display. */
    size_t row_floats;
};

enum { FL_BAND_ROWS = 32 }; /**< Rows copied at a time; a multiple of FL_SQUARE_SIDE. */

/** Room that fl_display_picture needs in `rows`. */
size_t fl_display_floats(uint32_t width);
/** Tone-map the shown picture. The owner's, without the lock. False: it is no longer `picture`'s
 * generation. */
bool fl_display_picture(fl_render *render, const fl_progress *picture, const fl_tonemap *tonemap,
                        uint8_t *out_rgba);

/** Seconds of a clock that never jumps. */
double fl_render_now(void);
void *fl_worker_main(void *worker);

/* All below: the lock is held. */

double fl_job_seconds(const fl_render *render, const fl_job *job);
/** Set the state to what limits, pause and schedule make of it; starts or stops the clock; wakes
 * who must know. */
void fl_render_update(fl_render *render);
/** Make `job` with `frame` (the reference passes) the current one, of the newest generation; all
 * that is out becomes stale. */
void fl_render_begin(fl_render *render, fl_job *job, fl_frame *frame);
/** Rank 0 of the current job is complete: show it, and let a pending restart have its turn. */
void fl_render_show_current(fl_render *render, fl_trash *trash);
/** Free the job kept for reuse, if any. */
void fl_render_drop_spare(fl_render *render, fl_trash *trash);
/** Put away a job that nobody shows or renders: it becomes the spare one. NULL is allowed. */
void fl_render_retire(fl_render *render, fl_job *job, fl_trash *trash);

#endif
