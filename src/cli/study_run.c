/* SPDX-License-Identifier: MIT */
#include "cli/study_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum {
    REFERENCE_FIRST = 4,   /* Times the samples of the longest curve. */
    SEED_REFERENCE = 1000, /* Seeds of rounds are below. */
};
#define REFERENCE_SHARE 0.1 /* Of the best measured RMSE: the aim. */
#define BUDGET_SHARE    0.5 /* The most of the budget that references take. */

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static uint32_t log2_of(uint32_t x)
{
    uint32_t k = 0;
    while (x >>= 1)
        k++;
    return k;
}

uint32_t study_levels_of(const study_config *config)
{
    return log2_of(config->samples_max) + 1;
}

static study_measure *slot(const study *s, uint32_t config, uint32_t round, uint32_t level)
{
    return &s->measures[((size_t)config * s->settings.repeats + round) * s->levels + level];
}

const study_measure *study_at(const study *s, uint32_t config, uint32_t round, uint32_t level)
{
    return slot(s, config, round, level);
}

/* True: stop now, and why is noted. `share`: of the budget that may be used up. */
static bool should_stop(study *s, double begin_s, double share)
{
    if (s->settings.should_stop && s->settings.should_stop())
        s->was_interrupted = true;
    bool is_over = s->settings.budget_s > 0.0 && now_s() - begin_s > share * s->settings.budget_s;
    if (is_over && share == 1.0)
        s->ran_out_of_budget = true;
    return s->was_interrupted || is_over;
}

/* --- One render ------------------------------------------------------------------------------- */

typedef enum outcome { REACHED, STOPPED, FAILED } outcome;

static outcome render_to(study *s, fl_render *render, uint32_t samples, double begin_s,
                         double share, fl_progress *out_progress)
{
    if (should_stop(s, begin_s, share))
        return STOPPED;
    fl_render_set_limits(render, &(fl_render_limits){.samples = samples});
    while (!fl_render_wait(render, 0.1)) {
        fl_render_progress(render, out_progress);
        if (out_progress->state == FL_RENDER_FAILED) {
            fl_out_of_memory(s->scene->diags, "rendering");
            return FAILED;
        }
        if (should_stop(s, begin_s, share)) {
            fl_render_set_paused(render, true);
            return STOPPED;
        }
    }
    fl_render_progress(render, out_progress);
    return REACHED;
}

/* The picture in the full size: in `out` directly, or by way of scratch. */
static bool take(study *s, fl_render *render, const study_config *config, float *out)
{
    size_t floats = (size_t)3 * s->width * s->height;
    bool is_full = config->scale == 1.0;
    fl_progress p;
    if (!fl_render_mean(render, is_full ? out : s->scratch[1], floats, &p))
        return fl_environment_error(s->scene->diags, "nothing was rendered");
    if (!is_full)
        study_resize(s->scratch[1], p.width, p.height, out, s->width, s->height);
    return true;
}

static bool add_to_sum(study *s, study_sum *sum, const float *picture, const float *reference1,
                       const float *reference2)
{
    size_t pixels = (size_t)s->width * s->height;
    if (!sum->rgb)
        sum->rgb = calloc(3 * pixels, sizeof(float));
    if (!sum->rgb)
        return fl_out_of_memory(s->scene->diags, "the pictures");
    for (size_t i = 0; i < 3 * pixels; i++)
        sum->rgb[i] += picture[i];
    sum->count++;
    sum->mse += study_product_mse(picture, reference1, reference2, pixels);
    return true;
}

/* The last picture of a curve, in scratch[0]. */
static bool add_last(study *s, uint32_t index)
{
    float *picture = s->scratch[0];
    size_t floats = (size_t)3 * s->width * s->height;
    const study_reference *truth = study_truth(s);
    if (!add_to_sum(s, &s->pictures[index], picture, truth->rgb[0], truth->rgb[1]))
        return false;
    if (index == 0)
        memcpy(s->base_picture, picture, floats * sizeof *picture);
    if (!s->plan.configs[index].is_biased)
        return true;
    for (size_t i = 0; i < floats; i++)
        picture[i] -= s->base_picture[i];
    return add_to_sum(s, &s->differences[index], picture, s->shift[0], s->shift[1]);
}

/* --- References ------------------------------------------------------------------------------- */

static bool reference_open(study *s, const fl_params *params, study_reference *r)
{
    r->best = (double)INFINITY;
    for (uint32_t i = 0; i < 2; i++) {
        fl_render_options options = {.thread_count = s->settings.threads};
        fl_params p = *params;
        p.sampler = FL_SAMPLER_SOBOL;
        p.seed = fl_hash_step(params->seed, SEED_REFERENCE + i);
        r->renders[i] = fl_render_create(&options, s->scene->diags);
        r->rgb[i] = malloc((size_t)3 * s->width * s->height * sizeof(float));
        if (!r->rgb[i])
            return fl_out_of_memory(s->scene->diags, "the references");
        if (!r->renders[i])
            return false;
        fl_render_set_limits(r->renders[i], &(fl_render_limits){.samples = 1});
        if (!fl_render_restart(r->renders[i], s->scene->compiled, &p, s->scene->diags))
            return false;
    }
    return true;
}

static void reference_close(study_reference *r)
{
    for (uint32_t i = 0; i < 2; i++) {
        fl_render_destroy(r->renders[i]);
        free(r->rgb[i]);
    }
    *r = (study_reference){0};
}

static outcome reference_render(study *s, study_reference *r, uint32_t samples, double begin_s,
                                double share)
{
    uint64_t dropped = 0;
    for (uint32_t i = 0; i < 2; i++) {
        fl_progress p;
        outcome o = render_to(s, r->renders[i], samples, begin_s, share, &p);
        if (o != REACHED)
            return o;
        dropped += p.counts.dropped_branches;
    }
    r->dropped_branches = dropped;
    return REACHED;
}

static bool reference_take(study *s, study_reference *r, uint32_t samples)
{
    size_t pixels = (size_t)s->width * s->height;
    for (uint32_t i = 0; i < 2; i++) {
        fl_progress p;
        if (!fl_render_mean(r->renders[i], r->rgb[i], 3 * pixels, &p))
            return fl_environment_error(s->scene->diags, "nothing was rendered");
    }
    r->samples = samples;
    r->rmse = sqrt(study_reference_mse(r->rgb[0], r->rgb[1], pixels));
    return true;
}

/* All references to `samples`: with the same samples in both truths their difference is known much
 * better than either. STOPPED leaves them as they were. */
static outcome references_grow(study *s, uint32_t samples, double begin_s, double share)
{
    if (s->settings.shows_progress)
        fprintf(stderr, "\rreferences: %u samples ...                              ", samples);
    outcome o = reference_render(s, &s->own, samples, begin_s, share);
    if (o == REACHED && s->has_deep)
        o = reference_render(s, &s->deep, samples, begin_s, share);
    if (o != REACHED)
        return o;
    bool ok = reference_take(s, &s->own, samples) &&
              (!s->has_deep || reference_take(s, &s->deep, samples));
    return ok ? REACHED : FAILED;
}

static uint32_t reference_limit(const study *s)
{
    uint32_t factor = s->settings.reference_factor;
    return s->settings.samples_max * (factor ? factor : STUDY_REFERENCE_FACTOR);
}

static bool is_good(const study_reference *r)
{
    return r->rmse <= REFERENCE_SHARE * r->best;
}

/* Double until they are good enough, the most is reached, or half the budget is gone. */
static bool references_finish(study *s, double begin_s)
{
    while (!(is_good(&s->own) && (!s->has_deep || is_good(&s->deep))) &&
           s->own.samples < reference_limit(s)) {
        outcome o = references_grow(s, 2 * s->own.samples, begin_s, BUDGET_SHARE);
        if (o != REACHED)
            return o == STOPPED;
    }
    return true;
}

/* --- Runs ------------------------------------------------------------------------------------- */

static void measure(study *s, const study_config *config, const float *picture,
                    const fl_progress *p, study_measure *out)
{
    size_t pixels = (size_t)s->width * s->height;
    *out = (study_measure){.is_there = true,
                           .cpu_s = p->cpu_seconds,
                           .wall_s = p->seconds,
                           .counts = p->counts,
                           .predicted = p->error};
    const study_reference *truth = study_truth(s);
    study_error_measure(picture, truth->rgb[0], truth->rgb[1], pixels, s->scratch[2], &out->error);
    out->noise = out->error;
    if (s->has_deep && !config->is_biased)
        study_error_measure(picture, s->own.rgb[0], s->own.rgb[1], pixels, s->scratch[2],
                            &out->noise);
}

/* One curve. round: settings.repeats stands for the warm-up, which is measured for the references'
 * sake only. */
static outcome run_curve(study *s, uint32_t index, uint32_t round, double begin_s)
{
    const study_config *config = &s->plan.configs[index];
    bool is_warm_up = round == s->settings.repeats;
    fl_params params = config->params;
    params.seed = fl_hash_step(params.seed, is_warm_up ? SEED_REFERENCE - 1 : round);
    fl_render_set_paused(s->render, false);
    fl_render_set_limits(s->render, &(fl_render_limits){.samples = 1});
    if (!fl_render_restart(s->render, config->compiled, &params, s->scene->diags))
        return FAILED;
    for (uint32_t level = 0; level < study_levels_of(config); level++) {
        fl_progress p;
        outcome o = render_to(s, s->render, 1u << level, begin_s, 1.0, &p);
        if (o != REACHED)
            return o;
        if (!take(s, s->render, config, s->scratch[0]))
            return FAILED;
        study_measure m;
        measure(s, config, s->scratch[0], &p, &m);
        if (is_warm_up) {
            if (m.error.mse > 0.0)
                s->deep.best = fl_min(s->deep.best, sqrt(m.error.mse));
            if (m.noise.mse > 0.0 && !config->is_biased)
                s->own.best = fl_min(s->own.best, sqrt(m.noise.mse));
            continue;
        }
        *slot(s, index, round, level) = m;
        if (level + 1 == study_levels_of(config) && !add_last(s, index))
            return FAILED;
    }
    return REACHED;
}

static void show_runs(const study *s, uint32_t done, double runs_begin_s)
{
    uint32_t total = s->plan.count * (s->settings.repeats + 1);
    double gone = now_s() - runs_begin_s, left = done ? gone / done * (total - done) : 0.0;
    char bar[31];
    for (uint32_t i = 0; i < 30; i++)
        bar[i] = i < 30 * done / total ? '#' : '.';
    bar[30] = 0;
    fprintf(stderr, "\r[%s] %u of %u runs, about %.0f s left      ", bar, done, total, left);
}

/* All configurations in turn, `count` rounds from `first` on. False: an error. */
static bool run_rounds(study *s, uint32_t first, uint32_t count, double begin_s)
{
    double runs_begin_s = now_s();
    for (uint32_t round = first; round < first + count; round++) {
        for (uint32_t i = 0; i < s->plan.count; i++) {
            if (s->settings.shows_progress)
                show_runs(s, (round - first) * s->plan.count + i, runs_begin_s);
            outcome o = run_curve(s, i, round, begin_s);
            if (o != REACHED)
                return o == STOPPED;
        }
        if (round < s->settings.repeats)
            s->rounds = round + 1;
    }
    return true;
}

static bool allocate(study *s)
{
    size_t floats = (size_t)3 * s->width * s->height;
    size_t count = (size_t)s->plan.count * s->settings.repeats * s->levels;
    s->measures = calloc(count, sizeof *s->measures);
    s->base_picture = malloc(floats * sizeof(float));
    s->shift[0] = calloc(floats, sizeof(float));
    s->shift[1] = calloc(floats, sizeof(float));
    bool ok = s->measures && s->base_picture && s->shift[0] && s->shift[1];
    for (uint32_t i = 0; i < FL_COUNT_OF(s->scratch); i++)
        ok = (s->scratch[i] = malloc(floats * sizeof(float))) && ok;
    return ok || fl_out_of_memory(s->scene->diags, "the study");
}

static bool open_references(study *s)
{
    fl_params deep = study_deep_params(&s->scene->params);
    const fl_params *base = &s->scene->params;
    s->has_deep =
        study_has_branches(s->scene->compiled) &&
        (deep.depth_limit != base->depth_limit || deep.weight_threshold != base->weight_threshold);
    return reference_open(s, base, &s->own) && (!s->has_deep || reference_open(s, &deep, &s->deep));
}

/* Both truths have the same seeds: their difference is known better than either. */
static void compare_truths(study *s)
{
    size_t pixels = (size_t)s->width * s->height;
    double sum = 0.0;
    for (size_t i = 0; s->has_deep && i < 3 * pixels; i++) {
        for (uint32_t k = 0; k < 2; k++)
            s->shift[k][i] = s->deep.rgb[k][i] - s->own.rgb[k][i];
        sum += (double)s->shift[0][i] * (double)s->shift[1][i];
    }
    s->truncation_rmse = sqrt(fl_max(0.0, sum / (3.0 * (double)pixels)));
}

static bool run_all(study *s, double begin_s)
{
    uint32_t first = fl_min_u32(s->settings.samples_max * REFERENCE_FIRST, reference_limit(s));
    outcome o = references_grow(s, first, begin_s, 1.0);
    if (o != REACHED)
        return o == STOPPED;
    if (s->settings.skips_warm_up)
        s->own.best = s->deep.best = 0.0; /* Not known: as good as can be. */
    else if (!run_rounds(s, s->settings.repeats, 1, begin_s))
        return false;
    if (!s->was_interrupted && !references_finish(s, begin_s))
        return false;
    if (!s->was_interrupted)
        compare_truths(s);
    return s->was_interrupted || run_rounds(s, 0, s->settings.repeats, begin_s);
}

bool study_run(cli_scene *scene, const study_settings *settings, uint32_t knobs, study *out)
{
    double begin_s = now_s();
    const fl_params *p = &scene->params;
    out->scene = scene;
    out->settings = *settings;
    out->settings.shows_progress = settings->shows_progress && isatty(STDERR_FILENO);
    out->width = p->crop_w ? p->crop_w : p->width;
    out->height = p->crop_w ? p->crop_h : p->height;
    out->levels = log2_of(settings->samples_max) + 1;
    out->deep.best = out->own.best = (double)INFINITY;
    fl_render_options options = {.thread_count = settings->threads};
    out->render = fl_render_create(&options, scene->diags);
    bool ok =
        out->render &&
        study_plan_build(scene, knobs, settings->samples_max, settings->threads, &out->plan) &&
        allocate(out) && open_references(out) && run_all(out, begin_s);
    if (out->settings.shows_progress)
        fputc('\n', stderr);
    out->seconds = now_s() - begin_s;
    return ok;
}

void study_close(study *s)
{
    fl_render_destroy(s->render);
    reference_close(&s->own);
    reference_close(&s->deep);
    for (uint32_t i = 0; i < s->plan.count; i++) {
        free(s->pictures[i].rgb);
        free(s->differences[i].rgb);
    }
    study_plan_close(&s->plan);
    free(s->measures);
    free(s->base_picture);
    free(s->shift[0]);
    free(s->shift[1]);
    for (uint32_t i = 0; i < FL_COUNT_OF(s->scratch); i++)
        free(s->scratch[i]);
    *s = (study){0};
}
