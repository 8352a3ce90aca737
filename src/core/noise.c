/* SPDX-License-Identifier: MIT */
#include "core/noise_state.h"

#include <stdlib.h>
#include <time.h>

enum { GRID = 32 }; /* A round's pixels: one in each of GRID x GRID parts of the picture. */

#define PLACE_SEED 0x6e6f6973u

static double thread_cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint32_t source_bit(const fl_noise_source *source)
{
    static const uint32_t bits[] = {[FL_NOISE_PIXEL] = FL_FREEZE_PIXEL,
                                    [FL_NOISE_LENS] = FL_FREEZE_LENS,
                                    [FL_NOISE_DEEPER] = FL_FREEZE_DEEPER};
    return source->kind == FL_NOISE_LIGHT ? fl_freeze_light(source->light) : bits[source->kind];
}

static void add_source(fl_noise *noise, fl_noise_kind kind, uint32_t light)
{
    noise->sources[noise->source_count++] = (fl_noise_source){.kind = kind, .light = light};
}

/* Sampling sets in use. */
static void find_sources(fl_noise *noise)
{
    const fl_frame *frame = noise->frame;
    const fl_frame_plan *plan = &frame->plan;
    for (uint32_t l = 0; l < frame->light_count; l++)
        if (frame->lights[l].draws) {
            noise->disk_lights++;
            noise->light_samples += frame->lights[l].samples;
        }
    if (plan->samples_pixel)
        add_source(noise, FL_NOISE_PIXEL, 0);
    if (plan->samples_lens)
        add_source(noise, FL_NOISE_LENS, 0);
    if (noise->disk_lights > 0 && (plan->has_reflection || plan->has_refraction))
        add_source(noise, FL_NOISE_DEEPER, 0);
    for (uint32_t l = 0; l < frame->light_count; l++)
        if (frame->lights[l].draws && l < FL_FREEZE_LIGHTS_MAX)
            add_source(noise, FL_NOISE_LIGHT, l);
    noise->config_count = 1 + 2 * noise->source_count;
}

fl_noise *fl_noise_create(fl_compiled *scene, const fl_params *params, uint32_t samples,
                          fl_diags *diags)
{
    FL_ASSERT(samples >= 4 && (samples & (samples - 1)) == 0);
    fl_noise *noise = calloc(1, sizeof *noise);
    if (!noise) {
        fl_out_of_memory(diags, "the noise measurement");
        return NULL;
    }
    noise->samples = samples;
    noise->frame = fl_frame_create(scene, params, diags);
    if (!noise->frame) {
        fl_noise_destroy(noise);
        return NULL;
    }
    find_sources(noise);
    size_t values = (size_t)noise->config_count * FL_NOISE_PIXELS;
    noise->workspace = fl_workspace_create();
    noise->round_values = malloc(values * sizeof *noise->round_values);
    if (!noise->workspace || !noise->round_values) {
        fl_out_of_memory(diags, "the noise measurement");
        fl_noise_destroy(noise);
        return NULL;
    }
    return noise;
}

void fl_noise_destroy(fl_noise *noise)
{
    if (!noise)
        return;
    fl_frame_release(noise->frame);
    fl_workspace_destroy(noise->workspace);
    free(noise->round_values);
    free(noise);
}

/* One of the places [begin, end) by hash. */
static uint32_t place(uint32_t hash, uint32_t begin, uint32_t end)
{
    return begin + (uint32_t)((uint64_t)hash * (end - begin) >> 32);
}

static void choose_pixels(fl_noise *noise)
{
    const fl_frame *f = noise->frame;
    uint32_t columns = fl_min_u32(f->width, GRID), rows = fl_min_u32(f->height, GRID), n = 0;
    uint32_t seed = fl_hash_step(fl_hash_step(f->params.seed, PLACE_SEED), noise->round);
    for (uint32_t r = 0; r < rows; r++)
        for (uint32_t c = 0; c < columns; c++, n++) {
            uint32_t h = fl_hash_step(seed, n);
            uint32_t x = place(h, c * f->width / columns, (c + 1) * f->width / columns);
            uint32_t y =
                place(fl_hash_step(h, 1), r * f->height / rows, (r + 1) * f->height / rows);
            noise->x[n] = (uint16_t)(f->x0 + x);
            noise->y[n] = (uint16_t)(f->y0 + y);
        }
    noise->pixel_count = n;
}

static uint32_t mask_of(const fl_noise *noise, uint32_t config)
{
    if (config == 0 || config >= noise->config_count)
        return 0;
    uint32_t own = source_bit(&noise->sources[(config - 1) / 2]);
    return config % 2 == 0 ? own : ~own;
}

static void add_light_samples(fl_frame *frame, int32_t more)
{
    for (uint32_t l = 0; l < frame->light_count; l++)
        if (frame->lights[l].draws)
            frame->lights[l].samples += (uint32_t)more;
}

/* One sample of the round's pixels; `is_extra`: with more light samples. */
static bool run_unit(fl_noise *noise, bool is_extra)
{
    fl_unit unit = {noise->x, noise->y, noise->pixel_count, noise->sample};
    fl_counts counts = {0};
    bool out_of_memory = false;
    if (is_extra)
        add_light_samples(noise->frame, FL_NOISE_EXTRA_LIGHT_SAMPLES);
    noise->frame->params.frozen = mask_of(noise, noise->config);
    double begun = thread_cpu_seconds();
    bool is_done =
        fl_pipeline_run(noise->frame, &unit, noise->workspace, NULL, 0, &counts, &out_of_memory);
    double seconds = thread_cpu_seconds() - begun;
    if (is_extra)
        add_light_samples(noise->frame, -FL_NOISE_EXTRA_LIGHT_SAMPLES);
    if ((noise->config == 0 && noise->sample < FL_NOISE_COST_SAMPLES) || is_extra) {
        noise->cost_seconds[is_extra] += seconds;
        noise->cost_shadows[is_extra] += counts.shadow_rays;
        noise->cost_paths[is_extra] += noise->pixel_count;
    }
    return is_done;
}

static void add_samples(fl_noise *noise)
{
    const fl_unit_result *r = fl_workspace_result(noise->workspace);
    double(*half)[3] = noise->halves[noise->sample >= noise->samples / 2];
    for (uint32_t i = 0; i < noise->pixel_count; i++) {
        half[i][0] += (double)r->r[i];
        half[i][1] += (double)r->g[i];
        half[i][2] += (double)r->b[i];
    }
}

/* The snapshot rule, pixel by pixel: the mean of all less that of the first half, squared. */
static void end_config(fl_noise *noise)
{
    double *values = noise->round_values + (size_t)noise->config * FL_NOISE_PIXELS;
    for (uint32_t i = 0; i < noise->pixel_count; i++) {
        double sum = 0.0;
        for (int c = 0; c < 3; c++) {
            double d = (noise->halves[1][i][c] - noise->halves[0][i][c]) / (double)noise->samples;
            sum += d * d;
            noise->halves[0][i][c] = noise->halves[1][i][c] = 0.0;
        }
        values[i] = sum / 3.0;
    }
}

static void end_round(fl_noise *noise)
{
    const double *base = noise->round_values;
    for (uint32_t k = 0; k < noise->config_count; k++) {
        const double *v = noise->round_values + (size_t)k * FL_NOISE_PIXELS;
        for (uint32_t i = 0; i < noise->pixel_count; i++) {
            noise->sums[k].v += v[i];
            noise->sums[k].v_v += v[i] * v[i];
            noise->sums[k].v_v0 += v[i] * base[i];
        }
    }
    noise->pixels += noise->pixel_count;
    noise->round++;
    noise->config = 0;
}

/* Samples that the present configuration wants. */
static uint32_t wanted_samples(const fl_noise *noise)
{
    return noise->config < noise->config_count ? noise->samples : FL_NOISE_COST_SAMPLES;
}

bool fl_noise_step(fl_noise *noise)
{
    if (noise->config == 0 && noise->sample == 0)
        choose_pixels(noise);
    bool is_extra = noise->config == noise->config_count;
    if (!run_unit(noise, is_extra))
        return false;
    if (!is_extra)
        add_samples(noise);
    noise->steps++;
    if (++noise->sample < wanted_samples(noise))
        return true;
    noise->sample = 0;
    if (!is_extra)
        end_config(noise);
    noise->config++;
    uint32_t last = noise->config_count + (noise->disk_lights > 0 ? 1 : 0);
    if (noise->config == last)
        end_round(noise);
    return true;
}

uint32_t fl_noise_rounds(const fl_noise *noise)
{
    return noise->round;
}

uint32_t fl_noise_round_steps(const fl_noise *noise)
{
    return noise->config_count * noise->samples +
           (noise->disk_lights > 0 ? FL_NOISE_COST_SAMPLES : 0);
}

uint64_t fl_noise_steps(const fl_noise *noise)
{
    return noise->steps;
}
