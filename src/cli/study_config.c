/* SPDX-License-Identifier: MIT */
#include "cli/study_config.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    BRUTE_FORCE_TRIANGLES = 1000, /* `none` is measured up to here (decision 26). */
    EXACT_SAMPLES = 16,           /* Knobs that change the price but no picture need no more. */
    SLOW_SAMPLES = 16,            /* Ten times dearer, and known by its floor. */
    BRUTE_FORCE_SAMPLES = 4
};

const char *const study_knob_names[STUDY_KNOB_COUNT] = {
    "baseline", "sampler", "light-samples",  "depth",   "weight-threshold",
    "scale",    "accel",   "revolve-solver", "adaptive", "precision"};

static const char *const sampler_names[] = {"sobol", "random", "padded", "stratified"};
static const char *const accel_names[] = {"bvh", "octree", "none"};

bool study_knobs_parse(const char *text, uint32_t *out_knobs, char word[STUDY_NAME_BYTES])
{
    *out_knobs = 0;
    while (*text) {
        size_t length = strcspn(text, ",");
        uint32_t knob = STUDY_SAMPLER;
        while (knob < STUDY_KNOB_COUNT && (strlen(study_knob_names[knob]) != length ||
                                           strncmp(study_knob_names[knob], text, length) != 0))
            knob++;
        if (knob == STUDY_KNOB_COUNT) {
            snprintf(word, STUDY_NAME_BYTES, "%.*s", (int)fl_min_u32((uint32_t)length, 32), text);
            return false;
        }
        *out_knobs |= 1u << knob;
        text += length + (text[length] == ',');
    }
    return true;
}

bool study_has_branches(const fl_compiled *compiled)
{
    return compiled->needs & (FL_NEED_REFLECTION | FL_NEED_REFRACTION);
}

fl_params study_deep_params(const fl_params *params)
{
    fl_params deep = *params;
    deep.depth_limit = fl_max_u32(params->depth_limit, STUDY_DEEP_BOUNCES);
    deep.weight_threshold = fl_min(params->weight_threshold, STUDY_DEEP_THRESHOLD);
    return deep;
}

/* A copy of the baseline to move a knob of. */
static study_config *add(study_plan *plan, study_knob knob, const char *value)
{
    FL_ASSERT(plan->count < STUDY_CONFIGS_MAX);
    study_config *c = &plan->configs[plan->count++];
    *c = plan->configs[0];
    c->knob = knob;
    c->compiled = fl_compiled_retain(plan->configs[0].compiled);
    snprintf(c->name, sizeof c->name, "%s=%s", study_knob_names[knob], value);
    return c;
}

static void add_samplers(study_plan *plan)
{
    for (uint32_t i = 0; i < FL_COUNT_OF(sampler_names); i++)
        if (i != plan->configs[0].params.sampler)
            add(plan, STUDY_SAMPLER, sampler_names[i])->params.sampler = (fl_sampler)i;
}

static void add_light_samples(study_plan *plan, const cli_scene *scene)
{
    static const uint32_t values[] = {1, 2, 4, 16};
    uint32_t disks = 0, own = 0;
    for (uint32_t i = 0; i < scene->params.light_count; i++) {
        const fl_light *light = &scene->params.lights[i];
        if (light->kind != FL_LIGHT_DISK || !(light->radius > 0.0))
            continue;
        uint32_t number = scene->params.light_samples ? scene->params.light_samples
                          : light->samples            ? light->samples
                                           : fl_max_u32(scene->params.light_samples_default, 1);
        own = disks++ && own != number ? 0 : number; /* 0: they differ, so every value is another */
    }
    for (uint32_t i = 0; disks && i < FL_COUNT_OF(values); i++) {
        char text[16];
        snprintf(text, sizeof text, "%u", values[i]);
        if (values[i] != own)
            add(plan, STUDY_LIGHT_SAMPLES, text)->params.light_samples = values[i];
    }
}

static void add_depths(study_plan *plan)
{
    static const uint32_t values[] = {0, 1, 2, 3, 5, 8, 12};
    for (uint32_t i = 0; i < FL_COUNT_OF(values); i++) {
        char text[16];
        snprintf(text, sizeof text, "%u", values[i]);
        if (values[i] == plan->configs[0].params.depth_limit)
            continue;
        study_config *c = add(plan, STUDY_DEPTH, text);
        c->params.depth_limit = values[i];
        c->is_biased = true;
    }
}

static void add_thresholds(study_plan *plan)
{
    static const uint32_t inverses[] = {8, 32, 128, 1024, 8192, 0};
    for (uint32_t i = 0; i < FL_COUNT_OF(inverses); i++) {
        char text[16] = "0";
        double value = inverses[i] ? 1.0 / inverses[i] : 0.0;
        if (inverses[i])
            snprintf(text, sizeof text, "1/%u", inverses[i]);
        if (value == plan->configs[0].params.weight_threshold)
            continue;
        study_config *c = add(plan, STUDY_WEIGHT, text);
        c->params.weight_threshold = value;
        c->is_biased = true;
    }
}

static void add_scales(study_plan *plan)
{
    static const uint32_t divisors[] = {2, 4};
    for (uint32_t i = 0; i < FL_COUNT_OF(divisors); i++) {
        char text[16];
        snprintf(text, sizeof text, "1/%u", divisors[i]);
        study_config *c = add(plan, STUDY_SCALE, text);
        c->params.width = fl_max_u32(1, c->params.width / divisors[i]);
        c->params.height = fl_max_u32(1, c->params.height / divisors[i]);
        c->scale = 1.0 / divisors[i];
        c->is_biased = true;
    }
}

static bool add_accel(study_plan *plan, const cli_scene *scene, fl_pool *pool, const char *name,
                      fl_accel accel, uint32_t octree_height, uint32_t samples_max)
{
    const fl_compiled *base = plan->configs[0].compiled;
    study_config *c = add(plan, STUDY_ACCEL, name);
    fl_compile_options options = {
        .accel = accel, .has_isa = true, .isa = base->isa, .octree_height = octree_height};
    fl_compiled_release(c->compiled);
    c->compiled = fl_compile(scene->scene, &options, pool, scene->diags);
    c->samples_max = fl_min_u32(c->samples_max, samples_max);
    return c->compiled != NULL;
}

static bool add_accels(study_plan *plan, const cli_scene *scene, uint32_t threads)
{
    fl_pool *pool = fl_pool_create(threads, scene->diags);
    bool ok = pool != NULL;
    static const uint32_t heights[] = {3, 4, 5, 6, 8};
    for (uint32_t i = 0; ok && i < FL_COUNT_OF(heights); i++) {
        char name[24];
        snprintf(name, sizeof name, "octree-%u", heights[i]);
        ok = add_accel(plan, scene, pool, name, FL_ACCEL_OCTREE, heights[i], EXACT_SAMPLES);
    }
    fl_accel own = scene->compiled->geometry.accel;
    if (ok && own != FL_ACCEL_BVH)
        ok = add_accel(plan, scene, pool, "bvh", FL_ACCEL_BVH, 0, EXACT_SAMPLES);
    if (ok && own != FL_ACCEL_NONE && scene->compiled->triangle_count <= BRUTE_FORCE_TRIANGLES)
        ok = add_accel(plan, scene, pool, "none", FL_ACCEL_NONE, 0, BRUTE_FORCE_SAMPLES);
    fl_pool_destroy(pool);
    return ok;
}

static void solver_text(fl_revolve_solver solver, char out[24])
{
    if (solver == FL_REVOLVE_ROBUST)
        snprintf(out, 24, "robust");
    else
        snprintf(out, 24, "newton-%u", solver);
}

static void add_solvers(study_plan *plan, uint32_t samples_max)
{
    static const fl_revolve_solver values[] = {FL_REVOLVE_ROBUST, 2, 4, FL_REVOLVE_NEWTON, 16};
    for (uint32_t i = 0; i < FL_COUNT_OF(values); i++) {
        char text[24];
        solver_text(values[i], text);
        if (values[i] == plan->configs[0].params.solver)
            continue;
        study_config *c = add(plan, STUDY_SOLVER, text);
        c->params.solver = values[i];
        c->is_biased = true; /* Newton loses hits. */
        if (values[i] != FL_REVOLVE_ROBUST)
            c->samples_max = fl_min_u32(samples_max, SLOW_SAMPLES);
    }
}

/* Where samples go follows what was seen: right in the limit only. */
static void add_adaptive(study_plan *plan)
{
    bool is_on = plan->configs[0].params.is_adaptive;
    study_config *c = add(plan, STUDY_ADAPTIVE, is_on ? "off" : "on");
    c->params.is_adaptive = !is_on;
    c->is_biased = true;
}

/* The two converge to pictures that differ by the error of floats. */
static void add_precisions(study_plan *plan)
{
    bool is_double = plan->configs[0].params.precision == FL_PRECISION_DOUBLE;
    study_config *c = add(plan, STUDY_PRECISION, is_double ? "float" : "double");
    c->params.precision = is_double ? FL_PRECISION_FLOAT : FL_PRECISION_DOUBLE;
    c->is_biased = true;
}

bool study_plan_build(const cli_scene *scene, uint32_t knobs, uint32_t samples_max,
                      uint32_t threads, study_plan *out_plan)
{
    uint32_t needs = scene->compiled->needs;
    study_config *base = &out_plan->configs[out_plan->count++];
    *base = (study_config){.knob = STUDY_BASELINE,
                           .name = "baseline",
                           .params = scene->params,
                           .compiled = fl_compiled_retain(scene->compiled),
                           .scale = 1.0,
                           .samples_max = samples_max};
    if (knobs >> STUDY_SAMPLER & 1u)
        add_samplers(out_plan);
    if (knobs >> STUDY_LIGHT_SAMPLES & 1u)
        add_light_samples(out_plan, scene);
    if ((knobs >> STUDY_DEPTH & 1u) && study_has_branches(scene->compiled))
        add_depths(out_plan);
    if ((knobs >> STUDY_WEIGHT & 1u) && study_has_branches(scene->compiled))
        add_thresholds(out_plan);
    if ((knobs >> STUDY_SCALE & 1u) && scene->params.crop_w == 0)
        add_scales(out_plan);
    if (knobs >> STUDY_ADAPTIVE & 1u)
        add_adaptive(out_plan);
    if ((knobs >> STUDY_SOLVER & 1u) && (needs & FL_NEED_REVOLUTIONS))
        add_solvers(out_plan, samples_max);
    if (knobs >> STUDY_PRECISION & 1u)
        add_precisions(out_plan);
    bool has_mesh = needs & FL_NEED_TRIANGLES;
    return !(knobs >> STUDY_ACCEL & 1u) || !has_mesh || add_accels(out_plan, scene, threads);
}

/* 1/1024 rather than 0.0009765625. */
static void threshold_text(double value, char out[24])
{
    double inverse = value > 0.0 ? 1.0 / value : 0.0;
    if (inverse >= 2.0 && inverse == floor(inverse))
        snprintf(out, 24, "1/%.0f", inverse);
    else
        snprintf(out, 24, "%g", value);
}

void study_own_name(const study_plan *plan, study_knob knob, char *out, size_t bytes)
{
    const study_config *base = &plan->configs[0];
    const fl_params *p = &base->params;
    char text[24] = "the scene's";
    switch (knob) {
    case STUDY_SAMPLER:
        snprintf(text, sizeof text, "%s", sampler_names[p->sampler]);
        break;
    case STUDY_LIGHT_SAMPLES:
        if (p->light_samples)
            snprintf(text, sizeof text, "%u", p->light_samples);
        break;
    case STUDY_DEPTH:
        snprintf(text, sizeof text, "%u", p->depth_limit);
        break;
    case STUDY_WEIGHT:
        threshold_text(p->weight_threshold, text);
        break;
    case STUDY_SCALE:
        snprintf(text, sizeof text, "1");
        break;
    case STUDY_ACCEL:
        snprintf(text, sizeof text, "%s", accel_names[base->compiled->geometry.accel]);
        break;
    case STUDY_SOLVER:
        solver_text(p->solver, text);
        break;
    case STUDY_ADAPTIVE:
        snprintf(text, sizeof text, "%s", p->is_adaptive ? "on" : "off");
        break;
    case STUDY_PRECISION:
        snprintf(text, sizeof text, "%s", p->precision == FL_PRECISION_DOUBLE ? "double" : "float");
        break;
    default:
        snprintf(out, bytes, "as asked for");
        return;
    }
    snprintf(out, bytes, "%s=%s", study_knob_names[knob], text);
}

void study_plan_close(study_plan *plan)
{
    for (uint32_t i = 0; i < plan->count; i++)
        fl_compiled_release(plan->configs[i].compiled);
    *plan = (study_plan){0};
}
