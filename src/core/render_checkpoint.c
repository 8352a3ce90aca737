/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "core/render_state.h"

/* Changes whenever what a job packs does. */
static const uint32_t pack_version = 2;

static void pack_job(fl_job *job, fl_pack *pack)
{
    fl_pack_check(pack, &pack_version, sizeof pack_version);
    fl_pack_check(pack, &job->width, sizeof job->width);
    fl_pack_check(pack, &job->height, sizeof job->height);
    fl_pack_bytes(pack, &job->counts, sizeof job->counts);
    fl_pack_bytes(pack, &job->cpu_seconds, sizeof job->cpu_seconds);
    fl_pack_bytes(pack, job->cost_seconds, sizeof job->cost_seconds);
    fl_pack_bytes(pack, &job->seconds_before, sizeof job->seconds_before);
    fl_pack_bytes(pack, &job->first_picture_seconds, sizeof job->first_picture_seconds);
    fl_pack_bytes(pack, &job->first_sample_seconds, sizeof job->first_sample_seconds);
    fl_schedule_pack(job->schedule, pack);
    if (pack->has_failed)
        return;
    fl_rect rect;
    uint32_t samples;
    for (uint32_t i = 0; fl_schedule_tile(job->schedule, i, &rect, &samples); i++)
        fl_film_set_samples(job->film, &rect, samples);
    fl_film_pack(job->film, pack);
    fl_estimate_pack(job->estimate, job->schedule, pack);
}

/* The lock is held: no unit is out when this returns. */
static void hold(fl_render *render)
{
    render->is_held = true;
    fl_render_update(render);
    while (render->out_units > 0)
        pthread_cond_wait(&render->stopped, &render->lock);
}

static void go_on(fl_render *render)
{
    render->is_held = false;
    fl_render_update(render);
}

bool fl_render_checkpoint(fl_render *render, void **out_data, size_t *out_bytes, fl_diags *diags)
{
    *out_data = NULL;
    *out_bytes = 0;
    bool is_done = true;
    pthread_mutex_lock(&render->lock);
    hold(render);
    fl_job *job = render->current;
    FL_ASSERT(!job || !job->allocation);
    if (job && fl_schedule_complete_samples(job->schedule) > 0) {
        fl_pack pack = {.mode = FL_PACK_MEASURE};
        pack_job(job, &pack);
        size_t bytes = pack.bytes;
        pack = (fl_pack){.mode = FL_PACK_WRITE, .data = malloc(bytes), .capacity = bytes};
        is_done = pack.data != NULL;
        if (is_done) {
            pack_job(job, &pack);
            FL_ASSERT(!pack.has_failed && pack.bytes == bytes);
            *out_data = pack.data;
            *out_bytes = bytes;
        }
    }
    go_on(render);
    pthread_mutex_unlock(&render->lock);
    return is_done || fl_out_of_memory(diags, "the checkpoint");
}

bool fl_render_resume(fl_render *render, fl_compiled *scene, const fl_params *params,
                      const void *data, size_t bytes, fl_diags *diags)
{
    fl_render_set_paused(render, true);
    bool is_done = fl_render_restart(render, scene, params, diags);
    if (is_done) {
        fl_trash trash = {0};
        fl_pack pack = {.mode = FL_PACK_READ, .data = (uint8_t *)data, .capacity = bytes};
        pthread_mutex_lock(&render->lock);
        fl_job *job = render->current;
        FL_ASSERT(render->out_units == 0 && !render->pending_frame);
        pack_job(job, &pack);
        is_done = !pack.has_failed && pack.bytes == bytes;
        if (is_done) {
            fl_render_show_current(render, &trash);
            render->revision++;
        } else {
            fl_job_reset(job);
        }
        pthread_mutex_unlock(&render->lock);
        fl_trash_empty(&trash);
        if (!is_done)
            fl_environment_error(diags, "the checkpoint does not fit the picture, or is damaged");
    }
    fl_render_set_paused(render, false);
    return is_done;
}
