/* SPDX-License-Identifier: MIT */
#include "cli/study_work.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    FIRST = 4,             /* Times the samples of the longest curve. */
    SEED_REFERENCE = 1000, /* Seeds of rounds are below. */
};
#define AIM 0.1 /* Of the best measured RMSE. */

/* The two come from samplers of different make, so that an error of either would show between them:
 * both are right on average, whatever is measured against them. */
static bool reference_open(study *s, const fl_params *params, study_reference *r)
{
    static const fl_sampler samplers[2] = {FL_SAMPLER_SOBOL, FL_SAMPLER_PADDED};
    r->best = (double)INFINITY;
    for (uint32_t i = 0; i < 2; i++) {
        fl_render_options options = {.thread_count = s->settings.threads};
        fl_params p = *params;
        p.sampler = samplers[i];
        p.is_adaptive = false;
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

bool study_references_open(study *s)
{
    fl_params deep = study_deep_params(&s->scene->params);
    const fl_params *base = &s->scene->params;
    s->has_deep =
        study_has_branches(s->scene->compiled) &&
        (deep.depth_limit != base->depth_limit || deep.weight_threshold != base->weight_threshold);
    return reference_open(s, base, &s->own) && (!s->has_deep || reference_open(s, &deep, &s->deep));
}

static void reference_close(study_reference *r)
{
    for (uint32_t i = 0; i < 2; i++) {
        fl_render_destroy(r->renders[i]);
        free(r->rgb[i]);
    }
    *r = (study_reference){0};
}

void study_references_close(study *s)
{
    reference_close(&s->own);
    reference_close(&s->deep);
}

static study_outcome reference_render(study *s, study_reference *r, uint32_t samples, double share,
                                      double *done)
{
    char what[48];
    double part = samples - r->samples;
    uint64_t dropped = 0;
    snprintf(what, sizeof what, "references of %u samples", samples);
    for (uint32_t i = 0; i < 2; i++) {
        fl_progress p;
        study_stage_set(s, what, *done, part);
        study_outcome o = study_render_to(s, r->renders[i], samples, share, &p);
        if (o != STUDY_REACHED)
            return o;
        dropped += p.counts.dropped_branches;
        *done += part;
    }
    r->dropped_branches = dropped;
    return STUDY_REACHED;
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

/* All references alike: with the same samples in both truths their difference is known much better
 * than either. */
study_outcome study_references_grow(study *s, uint32_t samples, double share)
{
    double done = 0.0;
    study_stage_begin(s, (double)(samples - s->own.samples) * (s->has_deep ? 4 : 2));
    study_outcome o = reference_render(s, &s->own, samples, share, &done);
    if (o == STUDY_REACHED && s->has_deep)
        o = reference_render(s, &s->deep, samples, share, &done);
    if (o != STUDY_REACHED)
        return o;
    bool ok = reference_take(s, &s->own, samples) &&
              (!s->has_deep || reference_take(s, &s->deep, samples));
    return ok ? STUDY_REACHED : STUDY_FAILED;
}

static uint32_t limit(const study *s)
{
    uint32_t factor = s->settings.reference_factor;
    return s->settings.samples_max * (factor ? factor : STUDY_REFERENCE_FACTOR);
}

uint32_t study_references_first(const study *s)
{
    return fl_min_u32(s->settings.samples_max * FIRST, limit(s));
}

bool study_reference_is_good(const study_reference *r)
{
    return r->rmse <= AIM * r->best;
}

bool study_references_finish(study *s)
{
    while (!(study_reference_is_good(&s->own) &&
             (!s->has_deep || study_reference_is_good(&s->deep))) &&
           s->own.samples < limit(s)) {
        study_outcome o = study_references_grow(s, 2 * s->own.samples, STUDY_REFERENCE_SHARE);
        if (o != STUDY_REACHED)
            return o == STUDY_STOPPED;
    }
    return true;
}

/* What pictures are held against side by side: the mean of the two halves of the truth. */
static bool make_flip(study *s)
{
    size_t pixels = (size_t)s->width * s->height;
    const study_reference *truth = study_truth(s);
    for (size_t i = 0; i < 3 * pixels; i++)
        s->scratch[0][i] = (truth->rgb[0][i] + truth->rgb[1][i]) / 2.0f;
    s->flip =
        study_flip_create(s->scratch[0], s->width, s->height, s->scene->params.camera.exposure_ev);
    return s->flip || fl_out_of_memory(s->scene->diags, "the comparison");
}

bool study_references_compare(study *s)
{
    size_t pixels = (size_t)s->width * s->height;
    double sum = 0.0;
    for (size_t i = 0; s->has_deep && i < 3 * pixels; i++) {
        for (uint32_t k = 0; k < 2; k++)
            s->shift[k][i] = s->deep.rgb[k][i] - s->own.rgb[k][i];
        sum += (double)s->shift[0][i] * (double)s->shift[1][i];
    }
    s->truncation_rmse = sqrt(fl_max(0.0, sum / (3.0 * (double)pixels)));
    return make_flip(s);
}
