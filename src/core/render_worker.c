/* SPDX-License-Identifier: MIT */
#include "core/render_state.h"

#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "core/ticks.h"

static double thread_cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A unit on its way through a worker. */
typedef struct errand {
    uint64_t generation;
    fl_work work;
    fl_unit unit;
    fl_counts counts;
    double cpu_seconds; /* Of the thread since its last unit. */
    bool is_allocated;  /* A unit of adaptive sampling; its pixels are already listed. */
    uint32_t tile;      /* Of the allocation. */
    bool is_complete, is_out_of_memory;
} errand;

/* The next unit of the schedule, or of adaptive sampling once that has no more. */
static bool find_unit(fl_worker *worker, const fl_job *job, errand *out_errand)
{
    out_errand->is_allocated = false;
    if (fl_schedule_next(job->schedule, &out_errand->work))
        return true;
    if (!job->allocation)
        return false;
    out_errand->is_allocated = true;
    out_errand->unit.count =
        fl_allocation_next(job->allocation, job->film, job->frame->x0, job->frame->y0, worker->x,
                           worker->y, &out_errand->work.sample, &out_errand->tile);
    return out_errand->unit.count > 0;
}

static bool has_unit(const fl_job *job)
{
    return fl_schedule_has_work(job->schedule) ||
           (job->allocation && fl_allocation_has_units(job->allocation));
}

/* Take a unit and what is needed to do it without the lock. */
static bool take(fl_worker *worker, errand *out_errand, fl_trash *trash)
{
    fl_render *render = worker->render;
    fl_job *job = render->current;
    if (render->state != FL_RENDER_RUNNING || !find_unit(worker, job, out_errand))
        return false;
    render->out_units++;
    out_errand->generation = job->generation;
    if (worker->frame != job->frame) {
        if (worker->frame)
            trash->frames[trash->frame_count++] = worker->frame;
        worker->frame = fl_frame_retain(job->frame);
    }
    if (render->parked > 0 && has_unit(job))
        pthread_cond_signal(&render->work);
    return true;
}

static void run(fl_worker *worker, errand *e)
{
    e->unit.x = worker->x;
    e->unit.y = worker->y;
    e->unit.sample = e->work.sample;
    if (!e->is_allocated)
        e->unit.count =
            fl_work_pixels(&e->work, worker->frame->x0, worker->frame->y0, worker->x, worker->y);
    e->counts = (fl_counts){0};
    e->is_out_of_memory = false;
    e->is_complete =
        fl_pipeline_run(worker->frame, &e->unit, worker->workspace, &worker->render->generation,
                        e->generation, &e->counts, &e->is_out_of_memory);
    double cpu_now = thread_cpu_seconds();
    e->cpu_seconds = cpu_now - worker->cpu_seconds_seen;
    worker->cpu_seconds_seen = cpu_now;
}

/* CPU seconds of a unit, and of what its worker did before it since the last one, by stage: ticks
 * give the shares alone, since a clock that goes on while others have the processor says no more.
 */
static void add_seconds(fl_job *job, double cpu_seconds, const fl_cost_ticks *ticks)
{
    uint64_t all = 0;
    job->cpu_seconds += cpu_seconds;
    for (int i = 0; i < FL_COST_COUNT; i++)
        all += ticks->of[i];
    for (int i = 0; i < FL_COST_COUNT && all > 0; i++)
        job->cost_seconds[i] += cpu_seconds * ((double)ticks->of[i] / (double)all);
}

/* Put the samples into the film and see what that completes. */
static void commit(fl_worker *worker, const errand *e, fl_trash *trash)
{
    fl_render *render = worker->render;
    fl_job *job = render->current;
    fl_film_add(job->film, &e->unit, fl_workspace_result(worker->workspace), worker->frame->x0,
                worker->frame->y0);
    fl_counts_add(&job->counts, &e->counts);
    add_seconds(job, e->cpu_seconds, fl_workspace_ticks(worker->workspace));
    if (job->allocation)
        fl_allocation_add(job->allocation, &e->unit, fl_workspace_result(worker->workspace),
                          worker->frame->x0, worker->frame->y0);
    fl_rect rect;
    if (e->is_allocated)
        fl_allocation_commit(job->allocation, e->tile, e->unit.count);
    else if (fl_schedule_commit(job->schedule, &e->work, &rect))
        fl_estimate_capture(job->estimate, job->film, &rect, e->work.sample + 1);
    bool is_picture = job != render->shown && fl_schedule_complete_ranks(job->schedule) > 0;
    bool is_first_sample =
        job->first_sample_seconds <= 0.0 && fl_schedule_complete_samples(job->schedule) > 0;
    if (is_picture)
        job->first_picture_seconds = fl_render_now() - job->requested_at;
    if (is_first_sample) {
        job->first_sample_seconds = fl_render_now() - job->requested_at;
        render->is_notified = false; /* The owner hears of that, whenever it looked last. */
    }
    if (is_picture)
        fl_render_show_current(render, trash);
    if (job == render->shown)
        render->revision++;
}

/* A unit has come back. True: the owner should hear of it. */
static bool give_back(fl_worker *worker, const errand *e, fl_trash *trash)
{
    fl_render *render = worker->render;
    if (!render->current || e->generation != render->current->generation) {
        if (--render->stale_units == 0)
            render->cancel_seconds = fl_render_now() - render->begun_at;
        return false;
    }
    if (--render->out_units == 0 && render->is_held)
        pthread_cond_broadcast(&render->stopped);
    uint64_t revision = render->revision;
    if (e->is_complete)
        commit(worker, e, trash);
    else if (e->is_out_of_memory)
        render->has_failed = true;
    fl_render_update(render);
    return render->revision != revision || render->state != FL_RENDER_RUNNING;
}

/* Adaptive sampling, between rounds: a step of planning, short enough for the lock. */
static bool plan(fl_render *render)
{
    fl_job *job = render->current;
    if (render->state != FL_RENDER_RUNNING || render->out_units > 0 || !job->allocation ||
        fl_schedule_has_work(job->schedule) || !fl_allocation_must_plan(job->allocation))
        return false;
    fl_allocation_plan(job->allocation, job->film, job->estimate);
    render->revision++;
    fl_render_update(render);
    return true;
}

/* The unit that was taken, from tracing to the film. True: the owner should hear of it. */
static bool do_unit(fl_worker *worker, errand *e, fl_trash *trash)
{
    fl_render *render = worker->render;
    pthread_mutex_unlock(&render->lock);
    fl_trash_empty(trash);
    run(worker, e);
    pthread_mutex_lock(&render->lock);
    uint64_t begun = fl_ticks();
    bool should_notify = give_back(worker, e, trash);
    *fl_workspace_ticks(worker->workspace) =
        (fl_cost_ticks){.of[FL_COST_FILM] = fl_ticks() - begun}; /* For the next unit. */
    return should_notify;
}

/* Nothing to do: let go of the scene, so that a parked worker keeps nothing alive, and sleep. */
static void park(fl_worker *worker)
{
    fl_render *render = worker->render;
    if (worker->frame) {
        fl_frame *frame = worker->frame;
        worker->frame = NULL;
        pthread_mutex_unlock(&render->lock);
        fl_frame_release(frame);
        pthread_mutex_lock(&render->lock);
        return; /* Look again: something may have come meanwhile. */
    }
    render->parked++;
    pthread_cond_wait(&render->work, &render->lock);
    render->parked--;
}

void *fl_worker_main(void *argument)
{
    fl_worker *worker = argument;
    fl_render *render = worker->render;
    if (render->options.is_low_priority) /* On Linux `who` 0 is this thread alone. */
        setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + 1);
    worker->cpu_seconds_seen = thread_cpu_seconds();
    errand e;
    pthread_mutex_lock(&render->lock);
    while (!render->should_quit) {
        fl_trash trash = {0};
        bool should_notify = false;
        if (take(worker, &e, &trash)) {
            should_notify = do_unit(worker, &e, &trash);
        } else if (plan(render)) {
            should_notify = render->state != FL_RENDER_RUNNING;
            pthread_mutex_unlock(&render->lock); /* Others wait for it between the steps. */
            pthread_mutex_lock(&render->lock);
        } else {
            park(worker);
            continue;
        }
        should_notify &= !render->is_notified;
        render->is_notified |= should_notify;
        bool calls = should_notify && render->options.notify;
        if (calls || trash.frame_count > 0 || trash.job_count > 0) {
            pthread_mutex_unlock(&render->lock);
            if (calls)
                render->options.notify(render->options.notify_context);
            fl_trash_empty(&trash);
            pthread_mutex_lock(&render->lock);
        }
    }
    pthread_mutex_unlock(&render->lock);
    fl_frame_release(worker->frame);
    worker->frame = NULL;
    return NULL;
}
