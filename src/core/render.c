/* SPDX-License-Identifier: MIT */
#include "core/render_state.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/pool.h"

static bool start_workers(fl_render *render, uint32_t wanted, fl_diags *diags)
{
    render->workers = calloc(wanted, sizeof *render->workers);
    if (!render->workers)
        return fl_out_of_memory(diags, "the render's threads");
    while (render->worker_count < wanted) {
        fl_worker *worker = &render->workers[render->worker_count];
        worker->render = render;
        worker->workspace = fl_workspace_create();
        if (!worker->workspace)
            return fl_out_of_memory(diags, "the render's queues");
        int error = pthread_create(&worker->thread, NULL, fl_worker_main, worker);
        if (error != 0) {
            fl_workspace_destroy(worker->workspace);
            return fl_environment_error(diags, "cannot start render thread %u of %u (error %d)",
                                        render->worker_count + 1, wanted, error);
        }
        render->worker_count++;
    }
    return true;
}

fl_render *fl_render_create(const fl_render_options *options, fl_diags *diags)
{
    fl_render *render = calloc(1, sizeof *render);
    if (!render) {
        fl_out_of_memory(diags, "the render");
        return NULL;
    }
    render->options = *options;
    if (render->options.memory_limit_bytes == 0)
        render->options.memory_limit_bytes = FL_RENDER_MEMORY_LIMIT;
    render->revision = 1;
    atomic_init(&render->generation, 0);
    pthread_mutex_init(&render->lock, NULL);
    pthread_cond_init(&render->work, NULL);
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&render->stopped, &attributes);
    pthread_condattr_destroy(&attributes);
    render->tonemapper = fl_tonemapper_create();
    bool is_started = render->tonemapper
                          ? start_workers(render, fl_thread_count(options->thread_count), diags)
                          : fl_out_of_memory(diags, "the tone map");
    if (!is_started) {
        fl_render_destroy(render);
        return NULL;
    }
    return render;
}

void fl_render_destroy(fl_render *render)
{
    if (!render)
        return;
    pthread_mutex_lock(&render->lock);
    render->should_quit = true;
    atomic_store_explicit(&render->generation, UINT64_MAX, memory_order_relaxed);
    pthread_cond_broadcast(&render->work);
    pthread_mutex_unlock(&render->lock);
    for (uint32_t i = 0; i < render->worker_count; i++) {
        pthread_join(render->workers[i].thread, NULL);
        fl_workspace_destroy(render->workers[i].workspace);
    }
    if (render->shown != render->current)
        fl_job_destroy(render->shown);
    fl_job_destroy(render->current);
    fl_job_destroy(render->spare);
    fl_job_destroy(render->pending_job);
    fl_frame_release(render->pending_frame);
    fl_tonemapper_destroy(render->tonemapper);
    free(render->rows);
    free(render->workers);
    pthread_cond_destroy(&render->stopped);
    pthread_cond_destroy(&render->work);
    pthread_mutex_destroy(&render->lock);
    free(render);
}

/* --- Restart -----------------------------------------------------------------------------------
 */

static bool fits(const fl_job *job, const fl_frame *frame)
{
    return job && job->width == frame->width && job->height == frame->height &&
           (job->allocation != NULL) == frame->params.is_adaptive;
}

/* Room for fl_render_display's rows. The owner's alone: no lock. */
static bool reserve_rows(fl_render *render, uint32_t width, fl_diags *diags)
{
    size_t floats = fl_display_floats(width);
    if (floats <= render->row_floats)
        return true;
    float *rows = realloc(render->rows, floats * sizeof *rows);
    if (!rows)
        return fl_out_of_memory(diags, "the display");
    render->rows = rows;
    render->row_floats = floats;
    return true;
}

/* A new job beside those that stay, within the memory limit. */
static fl_job *allocate_job(const fl_render *render, const fl_frame *frame, bool is_abandoning,
                            fl_diags *diags)
{
    size_t needed = 0, limit = render->options.memory_limit_bytes;
    bool is_countable =
        fl_job_bytes(frame->width, frame->height, frame->params.is_adaptive, &needed);
    const fl_job *stays[] = {
        render->shown, is_abandoning || render->current == render->shown ? NULL : render->current};
    for (size_t i = 0; i < FL_COUNT_OF(stays); i++)
        if (stays[i])
            is_countable &= !__builtin_add_overflow(needed, stays[i]->bytes, &needed);
    if (!is_countable || needed > limit) {
        fl_environment_error(diags,
                             "rendering %u x %u pixels needs %zu bytes, the memory limit is %zu",
                             frame->width, frame->height, needed, limit);
        return NULL;
    }
    fl_job *job = fl_job_create(frame->width, frame->height, frame->params.is_adaptive);
    if (!job)
        fl_environment_error(diags, "out of memory: rendering %u x %u pixels needs %zu bytes",
                             frame->width, frame->height, needed);
    return job;
}

/* Find a job of the frame's size among those not in use. */
static fl_job *reuse_job(fl_render *render, const fl_frame *frame, bool is_abandoning,
                         fl_trash *trash)
{
    fl_job **free_jobs[] = {&render->pending_job, &render->spare,
                            is_abandoning ? &render->current : NULL};
    for (size_t i = 0; i < FL_COUNT_OF(free_jobs); i++) {
        if (!free_jobs[i] || !fits(*free_jobs[i], frame))
            continue;
        fl_job *job = *free_jobs[i];
        *free_jobs[i] = NULL;
        if (job->frame)
            trash->frames[trash->frame_count++] = job->frame;
        job->frame = NULL;
        return job;
    }
    return NULL;
}

/* The lock is held. Takes the reference to `frame` when true. */
static bool restart(fl_render *render, fl_frame *frame, fl_trash *trash, fl_diags *diags)
{
    const fl_job *current = render->current;
    bool has_picture = !current || fl_schedule_complete_ranks(current->schedule) > 0;
    bool is_pending = !has_picture && render->state == FL_RENDER_RUNNING;
    /* Begin at once although nothing of the current generation was seen: it will not be. */
    bool is_abandoning = !has_picture && !is_pending;
    bool inherits = is_pending && fits(render->shown, frame);

    fl_job *job = NULL;
    if (!inherits) {
        job = reuse_job(render, frame, is_abandoning, trash);
        if (!job) {
            fl_render_drop_spare(render, trash);
            job = allocate_job(render, frame, is_abandoning, diags);
        }
        if (!job)
            return false;
    }
    if (render->pending_frame)
        trash->frames[trash->frame_count++] = render->pending_frame;
    render->pending_frame = NULL;
    fl_render_retire(render, render->pending_job, trash);
    render->pending_job = NULL;
    render->newest_generation++;
    render->requested_at = fl_render_now();
    if (is_pending) {
        render->pending_frame = frame;
        render->pending_job = job;
        return true;
    }
    if (is_abandoning)
        fl_render_retire(render, render->current, trash);
    fl_render_begin(render, job, frame);
    return true;
}

bool fl_render_restart(fl_render *render, fl_compiled *scene, const fl_params *params,
                       fl_diags *diags)
{
    fl_frame *frame = fl_frame_create(scene, params, diags);
    if (!frame)
        return false;
    fl_trash trash = {0};
    bool is_done = reserve_rows(render, frame->width, diags);
    if (is_done) {
        pthread_mutex_lock(&render->lock);
        is_done = restart(render, frame, &trash, diags);
        pthread_mutex_unlock(&render->lock);
    }
    if (!is_done)
        fl_frame_release(frame);
    fl_trash_empty(&trash);
    return is_done;
}

/* Where a job keeps its frame, and the pending one; the lock is held. */
enum { FRAME_SLOTS = 3 };

static void frame_slots(fl_render *render, fl_frame **out_slots[FRAME_SLOTS])
{
    out_slots[0] = render->current ? &render->current->frame : NULL;
    out_slots[1] = render->shown && render->shown != render->current ? &render->shown->frame : NULL;
    out_slots[2] = &render->pending_frame;
}

bool fl_render_replace_scene(fl_render *render, fl_compiled *scene, fl_diags *diags)
{
    fl_frame **slots[FRAME_SLOTS], *old[FRAME_SLOTS] = {NULL}, *next[FRAME_SLOTS] = {NULL};
    fl_trash trash = {0};
    bool ok = true;
    pthread_mutex_lock(&render->lock);
    frame_slots(render, slots);
    for (int i = 0; i < FRAME_SLOTS; i++)
        if (slots[i] && *slots[i] && scene->base && (*slots[i])->scene->base == scene->base)
            old[i] = fl_frame_retain(*slots[i]);
    pthread_mutex_unlock(&render->lock);

    for (int i = 0; i < FRAME_SLOTS && ok; i++)
        ok = !old[i] || (next[i] = fl_frame_create(scene, &old[i]->params, diags)) != NULL;

    /* A frame may have moved on meanwhile, from pending to current, or be gone. */
    pthread_mutex_lock(&render->lock);
    frame_slots(render, slots);
    for (int i = 0; i < FRAME_SLOTS && ok; i++)
        for (int k = 0; k < FRAME_SLOTS; k++)
            if (old[k] && slots[i] && *slots[i] == old[k]) {
                trash.frames[trash.frame_count++] = *slots[i];
                *slots[i] = fl_frame_retain(next[k]);
                break;
            }
    pthread_mutex_unlock(&render->lock);
    fl_trash_empty(&trash);
    for (int i = 0; i < FRAME_SLOTS; i++) {
        fl_frame_release(old[i]);
        fl_frame_release(next[i]);
    }
    return ok;
}

void fl_render_set_limits(fl_render *render, const fl_render_limits *limits)
{
    pthread_mutex_lock(&render->lock);
    render->limits = *limits;
    fl_render_update(render);
    pthread_cond_signal(&render->work);
    pthread_mutex_unlock(&render->lock);
}

void fl_render_set_paused(fl_render *render, bool is_paused)
{
    pthread_mutex_lock(&render->lock);
    render->is_paused = is_paused;
    fl_render_update(render);
    pthread_mutex_unlock(&render->lock);
}

/* --- Looking -----------------------------------------------------------------------------------
 */

/* The lock is held. */
static void fill_progress(const fl_render *render, const fl_job *job, fl_progress *out_progress)
{
    *out_progress = (fl_progress){
        .state = render->state,
        .newest_generation = render->newest_generation,
        .cancel_seconds = render->cancel_seconds,
    };
    if (!job)
        return;
    out_progress->generation = job->generation;
    out_progress->width = job->width;
    out_progress->height = job->height;
    out_progress->complete_samples = fl_schedule_complete_samples(job->schedule);
    out_progress->begun_samples = fl_schedule_begun_samples(job->schedule);
    uint64_t samples = fl_schedule_total_samples(job->schedule);
    if (job->allocation) {
        samples += fl_allocation_samples(job->allocation);
        out_progress->begun_samples =
            fl_max_u32(out_progress->begun_samples, fl_allocation_begun_samples(job->allocation));
    }
    out_progress->is_adaptive = job->allocation != NULL;
    out_progress->mean_samples = (double)samples / ((double)job->width * job->height);
    out_progress->complete_ranks = fl_schedule_complete_ranks(job->schedule);
    out_progress->seconds = fl_job_seconds(render, job);
    out_progress->cpu_seconds = job->cpu_seconds;
    out_progress->first_picture_seconds = job->first_picture_seconds;
    out_progress->first_sample_seconds = job->first_sample_seconds;
    memcpy(out_progress->cost_seconds, job->cost_seconds, sizeof job->cost_seconds);
    out_progress->counts = job->counts;
    uint32_t known = out_progress->complete_samples;
    if (job->allocation && known >= FL_ALLOCATION_BLOCK)
        known = (uint32_t)out_progress->mean_samples;
    fl_estimate_read(job->estimate, known, &out_progress->error);
}

void fl_render_progress(fl_render *render, fl_progress *out_progress)
{
    pthread_mutex_lock(&render->lock);
    render->is_notified = false;
    fill_progress(render, render->current, out_progress);
    pthread_mutex_unlock(&render->lock);
}

bool fl_render_has_sample(fl_render *render, uint64_t generation)
{
    pthread_mutex_lock(&render->lock);
    const fl_job *job = render->shown;
    bool has_sample =
        job && job->generation >= generation && fl_schedule_complete_samples(job->schedule) > 0;
    pthread_mutex_unlock(&render->lock);
    return has_sample;
}

bool fl_render_wait(fl_render *render, double seconds)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    double whole = seconds < 0.0 ? 0.0 : floor(fl_min(seconds, 1e9));
    double part = seconds < 0.0 ? 0.0 : fl_min(seconds, 1e9) - whole;
    until.tv_sec += (time_t)whole;
    until.tv_nsec += (long)(part * 1e9);
    if (until.tv_nsec >= 1000000000L) {
        until.tv_sec++;
        until.tv_nsec -= 1000000000L;
    }
    pthread_mutex_lock(&render->lock);
    int error = 0;
    while (render->state == FL_RENDER_RUNNING && error != ETIMEDOUT)
        error = seconds < 0.0 ? pthread_cond_wait(&render->stopped, &render->lock)
                              : pthread_cond_timedwait(&render->stopped, &render->lock, &until);
    bool is_done = render->state == FL_RENDER_DONE;
    pthread_mutex_unlock(&render->lock);
    return is_done;
}

/* Copy rows of the shown picture. False: it is no longer that of `generation`. */
static bool copy_rows(fl_render *render, uint64_t generation, uint32_t begin, uint32_t end,
                      float *out_rgb)
{
    pthread_mutex_lock(&render->lock);
    const fl_job *job = render->shown;
    bool is_same = job->generation == generation;
    if (is_same)
        for (uint32_t y = begin; y < end; y++)
            fl_film_row(job->film, 0, y, job->width,
                        out_rgb + (size_t)3 * (y - begin) * job->width);
    pthread_mutex_unlock(&render->lock);
    return is_same;
}

/* Progress and revision of the shown picture; 0 x 0 without one. */
static uint64_t look(fl_render *render, fl_progress *out_progress)
{
    pthread_mutex_lock(&render->lock);
    render->is_notified = false;
    fill_progress(render, render->shown, out_progress);
    uint64_t revision = render->revision;
    pthread_mutex_unlock(&render->lock);
    return revision;
}

static bool copy_picture(fl_render *render, const fl_progress *picture, float *out_rgb)
{
    for (uint32_t y = 0; y < picture->height; y += FL_BAND_ROWS) {
        uint32_t end = fl_min_u32(y + FL_BAND_ROWS, picture->height);
        if (!copy_rows(render, picture->generation, y, end,
                       out_rgb + (size_t)3 * picture->width * y))
            return false;
    }
    return true;
}

bool fl_render_display(fl_render *render, uint64_t *revision, const fl_tonemap *tonemap,
                       uint8_t *out_rgba, size_t capacity_bytes, fl_progress *out_progress)
{
    for (;;) { /* Again only when another generation became the picture amid the copy. */
        uint64_t newest = look(render, out_progress);
        size_t pixels = (size_t)out_progress->width * out_progress->height;
        if (pixels == 0 || newest == *revision || capacity_bytes < 4 * pixels)
            return false;
        if (fl_display_picture(render, out_progress, tonemap, out_rgba)) {
            *revision = newest;
            return true;
        }
    }
}

bool fl_render_mean(fl_render *render, float *out_rgb, size_t capacity_floats,
                    fl_progress *out_progress)
{
    for (;;) {
        look(render, out_progress);
        size_t pixels = (size_t)out_progress->width * out_progress->height;
        if (pixels == 0 || capacity_floats < 3 * pixels)
            return false;
        if (copy_picture(render, out_progress, out_rgb))
            return true;
    }
}

static void copy_samples(const fl_job *job, uint32_t begin, uint32_t end, float *out_values)
{
    for (uint32_t y = begin; y < end; y++)
        for (uint32_t x = 0; x < job->width; x++) {
            uint32_t samples;
            fl_film_samples_row(job->film, x, y, 1, &samples);
            *out_values++ = (float)samples;
        }
}

/* The error is that of squares: each is asked for once. */
static void copy_error(const fl_job *job, uint32_t begin, uint32_t end, float *out_values)
{
    uint32_t complete = fl_schedule_complete_samples(job->schedule);
    for (uint32_t y = begin; y < end; y++)
        for (uint32_t x = 0; x < job->width; x++, out_values++) {
            if (y % FL_SQUARE_SIDE != 0)
                *out_values = *(out_values - job->width);
            else if (x % FL_SQUARE_SIDE != 0)
                *out_values = *(out_values - 1);
            else
                *out_values = (float)fl_estimate_square_rmse(job->estimate, x, y, complete);
        }
}

/* Rows of a map, if `generation` is still the picture. */
static bool copy_map_rows(fl_render *render, uint64_t generation, fl_render_map map, uint32_t begin,
                          uint32_t end, float *out_values)
{
    pthread_mutex_lock(&render->lock);
    const fl_job *job = render->shown;
    bool is_same = job && job->generation == generation;
    if (is_same)
        (map == FL_RENDER_SAMPLES ? copy_samples : copy_error)(job, begin, end, out_values);
    pthread_mutex_unlock(&render->lock);
    return is_same;
}

static bool copy_map(fl_render *render, const fl_progress *picture, fl_render_map map,
                     float *out_values)
{
    for (uint32_t y = 0; y < picture->height; y += FL_BAND_ROWS)
        if (!copy_map_rows(render, picture->generation, map, y,
                           fl_min_u32(y + FL_BAND_ROWS, picture->height),
                           out_values + (size_t)picture->width * y))
            return false;
    return true;
}

bool fl_render_copy_map(fl_render *render, fl_render_map map, float *out_values,
                        size_t capacity_floats, fl_progress *out_progress)
{
    for (;;) {
        pthread_mutex_lock(&render->lock); /* Not a look(): nothing of it is shown. */
        fill_progress(render, render->shown, out_progress);
        pthread_mutex_unlock(&render->lock);
        size_t pixels = (size_t)out_progress->width * out_progress->height;
        if (pixels == 0 || pixels > capacity_floats)
            return false;
        if (copy_map(render, out_progress, map, out_values))
            return true;
    }
}

bool fl_render_pixel(fl_render *render, uint32_t x, uint32_t y, float out_rgb[3],
                     uint32_t *out_samples, double *out_rmse)
{
    pthread_mutex_lock(&render->lock);
    const fl_job *job = render->shown;
    bool is_there = job && x < job->width && y < job->height;
    if (is_there) {
        fl_film_row(job->film, x, y, 1, out_rgb);
        fl_film_samples_row(job->film, x, y, 1, out_samples);
        *out_rmse = fl_estimate_square_rmse(job->estimate, x, y,
                                            fl_schedule_complete_samples(job->schedule));
    }
    pthread_mutex_unlock(&render->lock);
    return is_there;
}
