/* SPDX-License-Identifier: MIT
 *
 * From measured variances and costs to shares and advice.
 */
#include "core/noise_state.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/math64.h"

/* A change of light samples that buys less than this is no advice. */
#define GAIN_MIN 1.05
/* The error falls like n^-0.6: the prior of estimate.h. */
#define ERROR_RATE 0.6

/* Standard error of the ratio of configuration k's mean to that of configuration 0. */
static double ratio_error(const fl_noise *noise, uint32_t k)
{
    const fl_noise_sums *s = &noise->sums[k], *s0 = &noise->sums[0];
    double ratio = s->v / s0->v;
    double square = s->v_v - 2.0 * ratio * s->v_v0 + ratio * ratio * s0->v_v;
    return sqrt(fl_max(square, 0.0)) / s0->v;
}

static void read_sources(const fl_noise *noise, fl_noise_split *out)
{
    double total = noise->sums[0].v, alone = 0.0, shares = 0.0;
    for (uint32_t s = 0; s < noise->source_count; s++) {
        fl_noise_source *source = &out->sources[s];
        source->alone = noise->sums[1 + 2 * s].v / total;
        source->held = noise->sums[2 + 2 * s].v / total;
        source->share = fl_max(0.5 * (source->alone + 1.0 - source->held), 0.0);
        double a = ratio_error(noise, 1 + 2 * s), h = ratio_error(noise, 2 + 2 * s);
        source->share_error = 0.5 * sqrt(a * a + h * h);
        alone += source->alone;
        shares += source->share;
    }
    for (uint32_t s = 0; s < noise->source_count && shares > 0.0; s++) {
        out->sources[s].share /= shares;
        out->sources[s].share_error /= shares;
    }
    out->joint = fl_max(1.0 - alone, 0.0);
}

static double lights_share(const fl_noise_split *split)
{
    double share = 0.0;
    for (uint32_t s = 0; s < split->source_count; s++)
        if (split->sources[s].kind == FL_NOISE_LIGHT || split->sources[s].kind == FL_NOISE_DEEPER)
            share += split->sources[s].share;
    return share;
}

static void read_costs(const fl_noise *noise, fl_noise_split *out)
{
    double path = noise->cost_seconds[0] / (double)noise->cost_paths[0];
    out->path_seconds = path;
    if (noise->disk_lights == 0)
        return;
    double extra_paths = (double)noise->cost_paths[1] * FL_NOISE_EXTRA_LIGHT_SAMPLES;
    double one_more = (noise->cost_seconds[1] / (double)noise->cost_paths[1] - path) /
                      FL_NOISE_EXTRA_LIGHT_SAMPLES;
    double rays = ((double)noise->cost_shadows[1] - (double)noise->cost_shadows[0]) / extra_paths;
    out->light_samples = (double)noise->light_samples / noise->disk_lights;
    one_more = fl_max(one_more, 0.0); /* Less than nothing is the clock's noise. */
    out->path_seconds = fl_max(path - one_more * out->light_samples, 0.1 * path);
    out->shadows_per_path = fl_max(rays, 0.0);
    out->shadow_seconds = rays > 0.0 ? one_more / rays : 0.0;
}

/* The least of (V_path + V_light / r) (c_path + c_light r) over the factor r on light samples. */
static void read_best_light_samples(fl_noise_split *out)
{
    double light = lights_share(out), path = 1.0 - light, m = out->light_samples;
    double light_cost = out->shadow_seconds * out->shadows_per_path * m,
           path_cost = out->path_seconds;
    out->light_samples_best = m;
    out->light_samples_gain = 1.0;
    if (m <= 0.0 || out->variance <= 0.0)
        return;
    double cheapest = fl_max(path * light_cost, 1e-6 * light * path_cost);
    double factor = cheapest > 0.0 ? sqrt(path_cost * light / cheapest) : 1.0;
    double best = fl_clamp(floor(factor * m + 0.5), 1.0, FL_NOISE_LIGHT_SAMPLES_MAX);
    double r = best / m;
    double now = path_cost + light_cost;
    double then = (path + light / r) * (path_cost + light_cost * r);
    out->light_samples_best = best;
    out->light_samples_gain = then > 0.0 ? sqrt(now / then) : 1.0;
}

bool fl_noise_read(const fl_noise *noise, fl_noise_split *out_split)
{
    *out_split = (fl_noise_split){.source_count = noise->source_count,
                                  .samples = noise->samples,
                                  .rounds = noise->round,
                                  .pixels = noise->pixels};
    if (noise->round == 0)
        return false;
    memcpy(out_split->sources, noise->sources, sizeof noise->sources);
    out_split->variance = noise->sums[0].v / (double)noise->pixels;
    if (out_split->variance > 0.0)
        read_sources(noise, out_split);
    read_costs(noise, out_split);
    read_best_light_samples(out_split);
    return true;
}

double fl_noise_rmse(const fl_noise_split *split)
{
    return sqrt(split->variance) * fl_d_exp2(0.5 - ERROR_RATE);
}

void fl_noise_source_name(const fl_noise_source *source, char out_name[FL_NOISE_NAME_BYTES])
{
    static const char *const names[] = {[FL_NOISE_PIXEL] = "edges",
                                        [FL_NOISE_LENS] = "lens",
                                        [FL_NOISE_DEEPER] = "lights in reflections"};
    if (source->kind == FL_NOISE_LIGHT)
        snprintf(out_name, FL_NOISE_NAME_BYTES, "light %u", (unsigned)source->light + 1);
    else
        snprintf(out_name, FL_NOISE_NAME_BYTES, "%s", names[source->kind]);
}

/* Numbers of the sources, largest share first. */
static void rank_sources(const fl_noise_split *split, uint32_t order[FL_NOISE_SOURCES_MAX])
{
    for (uint32_t i = 0; i < split->source_count; i++) {
        uint32_t at = i;
        for (; at > 0 && split->sources[order[at - 1]].share < split->sources[i].share; at--)
            order[at] = order[at - 1];
        order[at] = i;
    }
}

/* Append like printf; what does not fit is cut. */
FL_PRINTF(3, 4)
static void append(char *text, size_t bytes, const char *format, ...)
{
    size_t used = strlen(text);
    va_list args;
    va_start(args, format);
    vsnprintf(text + used, bytes - used, format, args);
    va_end(args);
}

static void append_knob(const fl_noise_split *split, char *text, size_t bytes)
{
    double best = split->light_samples_best, now = split->light_samples;
    bool turns_lights = split->light_samples_gain >= GAIN_MIN && best != now;
    if (turns_lights)
        append(text, bytes, ": light samples %s to %.0f: %.2f times the error in the same time",
               best > now ? "up" : "down", best, 1.0 / split->light_samples_gain);
    else
        append(text, bytes, ": raise samples: twice as many give about %.2f times the error",
               fl_d_exp2(-ERROR_RATE));
}

void fl_noise_advice(const fl_noise_split *split, char out_text[FL_NOISE_ADVICE_BYTES])
{
    enum { SHOWN = 4 }; /* And only what would not read as 0 %. */
    out_text[0] = 0;
    if (split->rounds == 0 || split->source_count == 0 || split->variance <= 0.0) {
        append(out_text, FL_NOISE_ADVICE_BYTES,
               split->rounds == 0 ? "noise not measured yet"
                                  : "no noise: every sample is the same");
        return;
    }
    uint32_t order[FL_NOISE_SOURCES_MAX];
    rank_sources(split, order);
    for (uint32_t i = 0; i < split->source_count && i < SHOWN; i++) {
        const fl_noise_source *source = &split->sources[order[i]];
        if (source->share < 0.005)
            break;
        char name[FL_NOISE_NAME_BYTES];
        fl_noise_source_name(source, name);
        append(out_text, FL_NOISE_ADVICE_BYTES, "%s%.0f %% %s", i ? ", " : "",
               100.0 * source->share, name);
    }
    append_knob(split, out_text, FL_NOISE_ADVICE_BYTES);
}
