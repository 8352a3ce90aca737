/* SPDX-License-Identifier: MIT */
#include "fake_pipeline.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

#include "core/frame.h"

struct fl_workspace {
    fl_unit_result result;
    float rgb[3][FL_UNIT_PIXELS];
    uint8_t is_valid[FL_UNIT_PIXELS];
    fl_cost_ticks ticks;
};

static pthread_mutex_t gate_lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t gate_opens = PTHREAD_COND_INITIALIZER, gate_waits = PTHREAD_COND_INITIALIZER;
static uint64_t permits = UINT64_MAX;
static uint32_t waiting;
static bool should_fail;

bool fake_sample(uint32_t seed, uint32_t x, uint32_t y, uint32_t index, float out_rgb[3])
{
    uint32_t h = fl_hash_step(fl_hash_step(seed, y << 16 | x), index);
    for (uint32_t c = 0; c < 3; c++)
        out_rgb[c] = (float)(fl_hash_step(h, c) >> 8) * 0x1p-24f;
    return (h & 63u) != 0;
}

void fake_mean(uint32_t seed, uint32_t x0, uint32_t y0, uint32_t w, uint32_t h, uint32_t samples,
               float *out_rgb)
{
    for (uint32_t i = 0; i < w * h; i++) {
        double sum[3] = {0}, block[3] = {0};
        uint32_t valid = 0;
        for (uint32_t s = 0; s < samples; s++) {
            float rgb[3];
            if (fake_sample(seed, x0 + i % w, y0 + i / w, s, rgb)) {
                valid++;
                for (int c = 0; c < 3; c++)
                    block[c] += (double)rgb[c];
            }
            for (int c = 0; c < 3 && s % 16 == 15; c++) {
                sum[c] += block[c];
                block[c] = 0.0;
            }
        }
        for (int c = 0; c < 3; c++)
            out_rgb[3 * i + (uint32_t)c] = valid ? (float)((sum[c] + block[c]) / valid) : 0.0f;
    }
}

void fake_permit(uint64_t units)
{
    pthread_mutex_lock(&gate_lock);
    permits = units;
    pthread_cond_broadcast(&gate_opens);
    pthread_mutex_unlock(&gate_lock);
}

void fake_await_waiting(uint32_t count)
{
    pthread_mutex_lock(&gate_lock);
    while (waiting < count)
        pthread_cond_wait(&gate_waits, &gate_lock);
    pthread_mutex_unlock(&gate_lock);
}

void fake_poke(void)
{
    pthread_mutex_lock(&gate_lock);
    pthread_cond_broadcast(&gate_opens);
    pthread_mutex_unlock(&gate_lock);
}

void fake_fail_next(void)
{
    pthread_mutex_lock(&gate_lock);
    should_fail = true;
    pthread_mutex_unlock(&gate_lock);
}

static bool is_stale(const atomic_uint_least64_t *generation, uint64_t wanted)
{
    return atomic_load_explicit(generation, memory_order_relaxed) != wanted;
}

/* True when the unit may go on. */
static bool pass_gate(const atomic_uint_least64_t *generation, uint64_t wanted, bool *out_of_memory)
{
    pthread_mutex_lock(&gate_lock);
    waiting++;
    pthread_cond_broadcast(&gate_waits);
    while (permits == 0 && !is_stale(generation, wanted))
        pthread_cond_wait(&gate_opens, &gate_lock);
    waiting--;
    bool passes = permits > 0;
    if (passes && permits != UINT64_MAX)
        permits--;
    if (passes && should_fail) {
        *out_of_memory = true;
        should_fail = passes = false;
    }
    pthread_mutex_unlock(&gate_lock);
    return passes;
}

bool fl_pipeline_run(const fl_frame *frame, const fl_unit *unit, fl_workspace *workspace,
                     const atomic_uint_least64_t *generation, uint64_t wanted, fl_counts *counts,
                     bool *out_of_memory)
{
    if (!pass_gate(generation, wanted, out_of_memory))
        return false;
    for (uint32_t i = 0; i < unit->count; i++) {
        if (i % 64 == 0 && is_stale(generation, wanted))
            return false;
        float rgb[3];
        bool is_valid = fake_sample(frame->params.seed, unit->x[i], unit->y[i], unit->sample, rgb);
        for (int c = 0; c < 3; c++)
            workspace->rgb[c][i] = is_valid ? rgb[c] : NAN;
        workspace->is_valid[i] = is_valid;
        counts->invalid_samples += !is_valid;
    }
    counts->samples += unit->count;
    return true;
}

fl_cost_ticks *fl_workspace_ticks(fl_workspace *workspace)
{
    workspace->ticks.of[FL_COST_NEAREST]++;
    return &workspace->ticks;
}

void fl_counts_add(fl_counts *sum, const fl_counts *part)
{
    sum->samples += part->samples;
    sum->invalid_samples += part->invalid_samples;
}

fl_workspace *fl_workspace_create(void)
{
    fl_workspace *workspace = calloc(1, sizeof *workspace);
    if (workspace)
        workspace->result = (fl_unit_result){workspace->rgb[0], workspace->rgb[1],
                                             workspace->rgb[2], workspace->is_valid};
    return workspace;
}

void fl_workspace_destroy(fl_workspace *workspace)
{
    free(workspace);
}

const fl_unit_result *fl_workspace_result(const fl_workspace *workspace)
{
    return &workspace->result;
}

fl_params fake_params(uint32_t seed, uint32_t x0, uint32_t y0, uint32_t w, uint32_t h)
{
    return (fl_params){.seed = seed,
                       .width = x0 + w,
                       .height = y0 + h,
                       .crop_x = x0,
                       .crop_y = y0,
                       .crop_w = w,
                       .crop_h = h};
}

fl_frame *fl_frame_create(fl_compiled *scene, const fl_params *params, fl_diags *diags)
{
    (void)scene;
    if (params->crop_w == 0) {
        fl_error(diags, (fl_loc){0}, "nothing to render");
        return NULL;
    }
    fl_frame *frame = calloc(1, sizeof *frame);
    if (!frame)
        return NULL;
    fl_ref_init(&frame->ref);
    frame->params = *params;
    frame->x0 = params->crop_x;
    frame->y0 = params->crop_y;
    frame->width = params->crop_w;
    frame->height = params->crop_h;
    return frame;
}

fl_frame *fl_frame_retain(fl_frame *frame)
{
    fl_ref_retain(&frame->ref);
    return frame;
}

void fl_frame_release(fl_frame *frame)
{
    if (frame && fl_ref_release(&frame->ref))
        free(frame);
}
