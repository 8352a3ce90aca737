/* SPDX-License-Identifier: MIT */
#include "core/render_state.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

double fl_render_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

bool fl_job_bytes(uint32_t width, uint32_t height, bool is_adaptive, size_t *out_bytes)
{
    size_t film, schedule, estimate, allocation = 0;
    if (!fl_film_bytes(width, height, &film) || !fl_schedule_bytes(width, height, &schedule) ||
        !fl_estimate_bytes(width, height, is_adaptive, &estimate) ||
        (is_adaptive && !fl_allocation_bytes(width, height, &allocation)))
        return false;
    size_t rows = fl_display_floats(width) * sizeof(float);
    return !__builtin_add_overflow(film, schedule + rows, out_bytes) &&
           !__builtin_add_overflow(*out_bytes, estimate, out_bytes) &&
           !__builtin_add_overflow(*out_bytes, allocation, out_bytes);
}

fl_job *fl_job_create(uint32_t width, uint32_t height, bool is_adaptive)
{
    fl_job *job = calloc(1, sizeof *job);
    if (!job || !fl_job_bytes(width, height, is_adaptive, &job->bytes)) {
        free(job);
        return NULL;
    }
    job->width = width;
    job->height = height;
    job->film = fl_film_create(width, height);
    job->schedule = fl_schedule_create(width, height);
    job->estimate = fl_estimate_create(width, height, is_adaptive);
    if (is_adaptive)
        job->allocation = fl_allocation_create(width, height);
    if (!job->film || !job->schedule || !job->estimate || (is_adaptive && !job->allocation)) {
        fl_job_destroy(job);
        return NULL;
    }
    return job;
}

void fl_job_destroy(fl_job *job)
{
    if (!job)
        return;
    fl_frame_release(job->frame);
    fl_film_destroy(job->film);
    fl_schedule_destroy(job->schedule);
    fl_estimate_destroy(job->estimate);
    fl_allocation_destroy(job->allocation);
    free(job);
}

void fl_job_reset(fl_job *job)
{
    fl_film_clear(job->film);
    fl_schedule_reset(job->schedule);
    fl_estimate_reset(job->estimate);
    if (job->allocation)
        fl_allocation_reset(job->allocation, job->frame->params.seed);
    job->counts = (fl_counts){0};
    job->cpu_seconds = job->seconds_before = 0.0;
    memset(job->cost_seconds, 0, sizeof job->cost_seconds);
    job->first_picture_seconds = job->first_sample_seconds = 0.0;
}

void fl_trash_empty(fl_trash *trash)
{
    for (uint32_t i = 0; i < trash->frame_count; i++)
        fl_frame_release(trash->frames[i]);
    for (uint32_t i = 0; i < trash->job_count; i++)
        fl_job_destroy(trash->jobs[i]);
    trash->frame_count = trash->job_count = 0;
}

static void throw_frame(fl_trash *trash, fl_frame *frame)
{
    FL_ASSERT(trash->frame_count < FL_COUNT_OF(trash->frames));
    if (frame)
        trash->frames[trash->frame_count++] = frame;
}

static void throw_job(fl_trash *trash, fl_job *job)
{
    FL_ASSERT(trash->job_count < FL_COUNT_OF(trash->jobs));
    if (job)
        trash->jobs[trash->job_count++] = job;
}

double fl_job_seconds(const fl_render *render, const fl_job *job)
{
    bool runs = job == render->current && render->state == FL_RENDER_RUNNING;
    return job->seconds_before + (runs ? fl_render_now() - job->begun_at : 0.0);
}

/* How many samples the limits allow as things stand. The noise is asked again at each power of two,
 * and no pixel goes beyond before the answer. */
static uint32_t sample_cap(const fl_render *render, const fl_job *job)
{
    const fl_render_limits *limits = &render->limits;
    uint32_t cap = limits->samples ? limits->samples : UINT32_MAX;
    if (limits->seconds > 0.0 && fl_job_seconds(render, job) >= limits->seconds)
        cap = 1;
    if (limits->noise_rmse > 0.0) {
        uint32_t complete = fl_schedule_complete_samples(job->schedule);
        cap = fl_min_u32(cap, fl_estimate_next_stop(job->estimate, complete, limits->noise_rmse));
    }
    return cap;
}

bool fl_job_has_work(const fl_job *job)
{
    return fl_schedule_has_work(job->schedule) ||
           (job->allocation && fl_allocation_has_work(job->allocation));
}

/* Adaptive sampling begins with an even block and takes the cap for the mean. */
static void set_cap(fl_job *job, uint32_t cap)
{
    if (job->allocation) {
        fl_allocation_set_goal(job->allocation, cap);
        cap = fl_min_u32(cap, FL_ALLOCATION_BLOCK);
    }
    fl_schedule_set_cap(job->schedule, cap);
}

static fl_render_state state_now(const fl_render *render)
{
    const fl_job *job = render->current;
    if (!job)
        return FL_RENDER_EMPTY;
    if (render->has_failed)
        return FL_RENDER_FAILED;
    if (render->out_units == 0 && !fl_job_has_work(job))
        return FL_RENDER_DONE;
    return render->is_paused || render->is_held ? FL_RENDER_PAUSED : FL_RENDER_RUNNING;
}

void fl_render_update(fl_render *render)
{
    fl_job *job = render->current;
    if (job)
        set_cap(job, sample_cap(render, job));
    fl_render_state state = state_now(render);
    if (state == render->state)
        return;
    if (render->state == FL_RENDER_RUNNING)
        job->seconds_before += fl_render_now() - job->begun_at;
    render->state = state;
    if (state == FL_RENDER_RUNNING) {
        job->begun_at = fl_render_now();
        pthread_cond_signal(&render->work); /* Who takes a unit wakes the next. */
    } else {
        pthread_cond_broadcast(&render->stopped);
    }
}

void fl_render_begin(fl_render *render, fl_job *job, fl_frame *frame)
{
    double now = fl_render_now();
    if (render->state == FL_RENDER_RUNNING)
        render->current->seconds_before += now - render->current->begun_at;
    FL_ASSERT(!job->frame);
    job->generation = render->newest_generation;
    job->requested_at = render->requested_at;
    job->frame = frame;
    fl_job_reset(job);

    render->current = job;
    atomic_store_explicit(&render->generation, job->generation, memory_order_relaxed);
    render->stale_units += render->out_units;
    render->out_units = 0;
    render->begun_at = now;
    render->cancel_seconds = 0.0;
    render->has_failed = false;
    render->state = FL_RENDER_EMPTY;
    fl_render_update(render);
}

void fl_render_drop_spare(fl_render *render, fl_trash *trash)
{
    throw_job(trash, render->spare);
    render->spare = NULL;
}

void fl_render_retire(fl_render *render, fl_job *job, fl_trash *trash)
{
    if (!job)
        return;
    throw_frame(trash, job->frame);
    job->frame = NULL;
    fl_render_drop_spare(render, trash);
    render->spare = job;
}

void fl_render_show_current(fl_render *render, fl_trash *trash)
{
    fl_job *old = render->shown;
    render->shown = render->current;
    fl_frame *frame = render->pending_frame;
    if (!frame) {
        fl_render_retire(render, old, trash);
        return;
    }
    fl_job *job = render->pending_job;
    render->pending_frame = NULL;
    render->pending_job = NULL;
    if (job) {
        fl_render_retire(render, old, trash);
    } else {
        FL_ASSERT(old && old->width == frame->width && old->height == frame->height);
        throw_frame(trash, old->frame);
        old->frame = NULL;
        job = old;
    }
    fl_render_begin(render, job, frame);
}
