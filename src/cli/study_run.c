/* SPDX-License-Identifier: MIT */
#include "cli/study_work.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEED_WARM_UP = 999, LOAD_BYTES = 64 }; /* Seeds of rounds are below. */

double study_load_average(void)
{
    char text[LOAD_BYTES];
    double load = -1.0;
    FILE *file = fopen("/proc/loadavg", "r");
    if (!file)
        return load;
    if (fgets(text, sizeof text, file) && !fl_number_parse(text, text + strlen(text), &load))
        load = -1.0;
    fclose(file);
    return load;
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
static bool should_stop(study *s, double share)
{
    if (s->settings.should_stop && s->settings.should_stop())
        s->was_interrupted = true;
    bool is_over =
        s->settings.budget_s > 0.0 && cli_wall_seconds() - s->begin_s > share * s->settings.budget_s;
    if (is_over && share == STUDY_WHOLE_BUDGET)
        s->ran_out_of_budget = true;
    return s->was_interrupted || is_over;
}

/* --- Progress --------------------------------------------------------------------------------- */

void study_stage_begin(study *s, double total)
{
    s->stage = (study_stage){.begin_s = cli_wall_seconds(), .total = total};
}

void study_stage_set(study *s, const char *what, double done, double part)
{
    s->stage.done = done;
    s->stage.part = part;
    snprintf(s->stage.what, sizeof s->stage.what, "%s", what);
}

/* share: of the part that is being rendered. */
static void show(const study *s, double share)
{
    const study_stage *t = &s->stage;
    if (!s->settings.shows_progress || !(t->total > 0.0))
        return;
    double done = fl_clamp((t->done + share * t->part) / t->total, 0.0, 1.0);
    double gone = cli_wall_seconds() - t->begin_s;
    char bar[25], left[48] = "";
    for (uint32_t i = 0; i < 24; i++)
        bar[i] = i < 24.0 * done ? '#' : '.';
    bar[24] = 0;
    if (done > 0.02)
        snprintf(left, sizeof left, ", about %.0f s left", gone / done * (1.0 - done));
    fprintf(stderr, "\r[%s] %3.0f %% %s%s\033[K", bar, 100.0 * done, t->what, left);
}

/* --- One render ------------------------------------------------------------------------------- */

study_outcome study_render_to(study *s, fl_render *render, uint32_t samples, double share,
                              fl_progress *out_progress)
{
    if (should_stop(s, share))
        return STUDY_STOPPED;
    fl_render_progress(render, out_progress);
    double from = fl_min(out_progress->mean_samples, samples - 1.0);
    show(s, 0.0);
    fl_render_set_limits(render, &(fl_render_limits){.samples = samples});
    while (!fl_render_wait(render, 0.1)) {
        fl_render_progress(render, out_progress);
        if (out_progress->state == FL_RENDER_FAILED) {
            fl_out_of_memory(s->scene->diags, "rendering");
            return STUDY_FAILED;
        }
        show(s, fl_max(0.0, out_progress->mean_samples - from) / (samples - from));
        if (should_stop(s, share)) {
            fl_render_set_paused(render, true);
            return STUDY_STOPPED;
        }
    }
    fl_render_progress(render, out_progress);
    return STUDY_REACHED;
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
    double square = 0.0;
    for (size_t i = 0; i < 3 * pixels; i++) {
        sum->rgb[i] += picture[i];
        square += (double)picture[i] * (double)picture[i];
    }
    sum->count++;
    sum->square += square / (3.0 * (double)pixels);
    sum->mse += study_product_mse(picture, reference1, reference2, pixels);
    return true;
}

/* What biased configurations will be held against: the baseline's picture, in scratch[0]. */
static void keep_base(study *s, uint32_t level)
{
    if (s->base_pictures[level])
        memcpy(s->base_pictures[level], s->scratch[0],
               (size_t)3 * s->width * s->height * sizeof(float));
}

/* The last picture of a curve, in scratch[0]. */
static bool add_last(study *s, uint32_t index)
{
    float *picture = s->scratch[0];
    size_t floats = (size_t)3 * s->width * s->height;
    const study_reference *truth = study_truth(s);
    if (!add_to_sum(s, &s->pictures[index], picture, truth->rgb[0], truth->rgb[1]))
        return false;
    if (!s->plan.configs[index].is_biased)
        return true;
    const float *base = s->base_pictures[study_levels_of(&s->plan.configs[index]) - 1];
    for (size_t i = 0; i < floats; i++)
        picture[i] -= base[i];
    return add_to_sum(s, &s->differences[index], picture, s->shift[0], s->shift[1]);
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
    if (s->flip)
        out->flip = study_flip_mean(s->flip, picture);
}

/* What the references have to be good for. */
static void note_best(study *s, const study_config *config, const study_measure *m)
{
    if (m->error.mse > 0.0)
        s->deep.best = fl_min(s->deep.best, sqrt(m->error.mse));
    if (m->noise.mse > 0.0 && !config->is_biased)
        s->own.best = fl_min(s->own.best, sqrt(m->noise.mse));
}

static bool begin(study *s, const study_config *config, const fl_params *params)
{
    fl_render_set_paused(s->render, false);
    fl_render_set_limits(s->render, &(fl_render_limits){.samples = 1});
    return fl_render_restart(s->render, config->compiled, params, s->scene->diags);
}

/* One curve. round: settings.repeats stands for the warm-up, which is measured for the references'
 * sake only. */
static study_outcome run_curve(study *s, uint32_t index, uint32_t round)
{
    const study_config *config = &s->plan.configs[index];
    bool is_warm_up = round == s->settings.repeats;
    fl_params params = config->params;
    params.seed = fl_hash_step(params.seed, is_warm_up ? SEED_WARM_UP : round);
    params.strata = 1;
    if (!begin(s, config, &params))
        return STUDY_FAILED;
    double load = study_load_average();
    for (uint32_t level = 0; level < study_levels_of(config); level++) {
        fl_progress p;
        /* Strata have to know how many samples there will be: a picture of its own for each. */
        params.strata = 1u << level;
        if (level && params.sampler == FL_SAMPLER_STRATIFIED && !begin(s, config, &params))
            return STUDY_FAILED;
        study_outcome o = study_render_to(s, s->render, 1u << level, STUDY_WHOLE_BUDGET, &p);
        if (o != STUDY_REACHED)
            return o;
        if (!take(s, s->render, config, s->scratch[0]))
            return STUDY_FAILED;
        study_measure m;
        measure(s, config, s->scratch[0], &p, &m);
        m.load = load;
        if (is_warm_up) {
            note_best(s, config, &m);
            continue;
        }
        *slot(s, index, round, level) = m;
        if (index == 0)
            keep_base(s, level);
        if (level + 1 == study_levels_of(config) && !add_last(s, index))
            return STUDY_FAILED;
    }
    return STUDY_REACHED;
}

/* All configurations once. `expected`: seconds that each will take, NULL: not known. `before`: what
 * was expected of the rounds that are done. out_seconds: what each took. */
static study_outcome run_round(study *s, uint32_t round, const double *expected, double before,
                               double *out_seconds)
{
    char number[40] = "warm-up", what[STUDY_NAME_BYTES + 48];
    if (round < s->settings.repeats)
        snprintf(number, sizeof number, "round %u of %u", round + 1, s->settings.repeats);
    for (uint32_t i = 0; i < s->plan.count; i++) {
        double begin_s = cli_wall_seconds(), part = expected ? expected[i] : 1.0;
        snprintf(what, sizeof what, "%s, %s", number, s->plan.configs[i].name);
        study_stage_set(s, what, before, 0.0);
        study_outcome o = run_curve(s, i, round);
        if (o != STUDY_REACHED)
            return o;
        before += part;
        if (out_seconds)
            out_seconds[i] = cli_wall_seconds() - begin_s;
    }
    return STUDY_REACHED;
}

/* All configurations in turn, as often as asked for. False: an error. */
static bool run_rounds(study *s, const double *expected)
{
    double round_s = 0.0;
    for (uint32_t i = 0; i < s->plan.count; i++)
        round_s += expected ? expected[i] : 1.0;
    study_stage_begin(s, round_s * s->settings.repeats);
    for (uint32_t round = 0; round < s->settings.repeats; round++) {
        study_outcome o = run_round(s, round, expected, round_s * round, NULL);
        if (o != STUDY_REACHED)
            return o == STUDY_STOPPED;
        s->rounds = round + 1;
    }
    return true;
}

static bool allocate(study *s)
{
    size_t floats = (size_t)3 * s->width * s->height;
    size_t count = (size_t)s->plan.count * s->settings.repeats * s->levels;
    s->measures = calloc(count, sizeof *s->measures);
    s->shift[0] = calloc(floats, sizeof(float));
    s->shift[1] = calloc(floats, sizeof(float));
    bool ok = s->measures && s->shift[0] && s->shift[1];
    for (uint32_t i = 0; i < s->plan.count; i++) {
        uint32_t last = study_levels_of(&s->plan.configs[i]) - 1;
        if (s->plan.configs[i].is_biased && !s->base_pictures[last])
            ok = (s->base_pictures[last] = malloc(floats * sizeof(float))) && ok;
    }
    for (uint32_t i = 0; i < FL_COUNT_OF(s->scratch); i++)
        ok = (s->scratch[i] = malloc(floats * sizeof(float))) && ok;
    return ok || fl_out_of_memory(s->scene->diags, "the study");
}

static bool run_all(study *s)
{
    double expected[STUDY_CONFIGS_MAX];
    study_outcome o = study_references_grow(s, study_references_first(s), STUDY_WHOLE_BUDGET);
    if (o != STUDY_REACHED)
        return o == STUDY_STOPPED;
    if (s->settings.skips_warm_up) {
        s->own.best = s->deep.best = 0.0; /* Not known: as good as can be. */
    } else {
        study_stage_begin(s, s->plan.count);
        o = run_round(s, s->settings.repeats, NULL, 0.0, expected);
    }
    if (o != STUDY_REACHED)
        return o == STUDY_STOPPED;
    if (!study_references_finish(s))
        return false;
    return s->was_interrupted || (study_references_compare(s) &&
                                  run_rounds(s, s->settings.skips_warm_up ? NULL : expected));
}

bool study_run(cli_scene *scene, const study_settings *settings, uint32_t knobs, study *out)
{
    const fl_params *p = &scene->params;
    out->begin_s = cli_wall_seconds();
    out->load = study_load_average();
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
        allocate(out) && study_references_open(out) && run_all(out);
    if (out->settings.shows_progress)
        fputc('\n', stderr);
    out->seconds = cli_wall_seconds() - out->begin_s;
    return ok;
}

void study_close(study *s)
{
    fl_render_destroy(s->render);
    study_references_close(s);
    study_flip_destroy(s->flip);
    for (uint32_t i = 0; i < s->plan.count; i++) {
        free(s->pictures[i].rgb);
        free(s->differences[i].rgb);
    }
    study_plan_close(&s->plan);
    free(s->measures);
    for (uint32_t i = 0; i < STUDY_LEVELS_MAX; i++)
        free(s->base_pictures[i]);
    free(s->shift[0]);
    free(s->shift[1]);
    for (uint32_t i = 0; i < FL_COUNT_OF(s->scratch); i++)
        free(s->scratch[i]);
    *s = (study){0};
}
