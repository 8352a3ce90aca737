/* SPDX-License-Identifier: MIT
 *
 * Asking for measurements when the state wants them and the picture can spare the time, and keeping
 * what comes.
 */
#include <stdio.h>
#include <stdlib.h>

#include "viewer/session.h"

enum {
    TRIAL_SAMPLES = 16,
    TRIAL_PIXELS = 128 * 128,
    STRESS_SAMPLES = 1,
    PICTURE_SAMPLES_FIRST = 4, /* The picture itself comes first. */
    NOISE_SAMPLES_MAX = 64     /* The noise of more is split alike, and takes long. */
};

#define SCALE_SMALL 1e-3
#define SCALE_LARGE 1e6
#define FOCUS_NEAR  1e-6
#define FOCUS_FAR   1e9

void vw_insight_deinit(vw_insight *insight)
{
    vw_lab_destroy(insight->lab);
    vw_lab_answer_deinit(&insight->answer);
    free(insight->rays_text);
    free(insight->rays_lines);
    *insight = (vw_insight){0};
}

static vw_lab_kind wanted_kind(const vw_state *state)
{
    if (state->stress != VW_STRESS_OFF)
        return VW_LAB_STRESS;
    if (state->panel == VW_PANEL_NOISE)
        return VW_LAB_NOISE;
    return state->panel == VW_PANEL_NEEDS || state->panel == VW_PANEL_TRADE ? VW_LAB_TRIALS
                                                                            : VW_LAB_NOTHING;
}

/* A frame of these parameters joins the question. */
static void add_frame(vw_session *session, vw_lab_question *question, const char *name,
                      const fl_params *params, fl_diags *diags)
{
    FL_ASSERT(question->frame_count < VW_TRIALS_MAX);
    fl_frame *frame = fl_frame_create(session->scene.compiled, params, diags);
    if (!frame)
        return;
    snprintf(question->names[question->frame_count], VW_TRIAL_NAME, "%s", name);
    question->frames[question->frame_count++] = frame;
}

/* The same view in few enough pixels. */
static void shrink(fl_params *params)
{
    uint32_t side = 1;
    while ((uint64_t)params->width * params->height / ((uint64_t)side * side) > TRIAL_PIXELS)
        side++;
    params->width = fl_max_u32(params->width / side, 1);
    params->height = fl_max_u32(params->height / side, 1);
    params->crop_x = params->crop_y = params->crop_w = params->crop_h = 0;
}

/* One step of each knob that leaves the picture what it is, or nearly. */
static void add_knobs(vw_session *session, vw_lab_question *question, fl_params *params,
                      fl_diags *diags)
{
    char name[VW_TRIAL_NAME];
    const fl_frame_plan plan = question->frames[0]->plan;
    bool has_soft_light = false;
    for (uint32_t i = 0; i < question->frames[0]->light_count; i++)
        has_soft_light |= question->frames[0]->lights[i].draws;
    uint32_t own = params->light_samples;
    uint32_t m = own ? own : session->state.scene_light_samples;
    if (has_soft_light) {
        params->light_samples = 2 * m;
        snprintf(name, sizeof name, "light samples %u", 2 * m);
        add_frame(session, question, name, params, diags);
        params->light_samples = m / 2;
        snprintf(name, sizeof name, "light samples %u", m / 2);
        if (m > 1)
            add_frame(session, question, name, params, diags);
        params->light_samples = own;
    }
    if (!plan.has_reflection && !plan.has_refraction)
        return;
    uint32_t depth = params->depth_limit;
    params->depth_limit = depth - 1;
    snprintf(name, sizeof name, "depth %u", depth - 1);
    add_frame(session, question, name, params, diags);
    params->depth_limit = depth + 1;
    snprintf(name, sizeof name, "depth %u", depth + 1);
    if (depth < FL_DEPTH_MAX)
        add_frame(session, question, name, params, diags);
    params->depth_limit = depth;
}

/* The picture without one of its features. */
static void add_features(vw_session *session, vw_lab_question *question, const fl_params *params,
                         fl_diags *diags)
{
    const fl_frame_plan plan = question->frames[0]->plan;
    fl_params less = *params;
    less.camera.aperture = 0.0;
    if (plan.samples_lens)
        add_frame(session, question, "lens", &less, diags);
    less = *params;
    less.exact.no_shadows = true;
    if (plan.has_shadows)
        add_frame(session, question, "shadows", &less, diags);
    less = *params;
    less.light_samples = 1;
    bool has_many = false;
    for (uint32_t i = 0; i < question->frames[0]->light_count; i++)
        has_many |= question->frames[0]->lights[i].samples > 1;
    if (has_many)
        add_frame(session, question, "more light samples", &less, diags);
    less = *params;
    less.depth_limit = 0;
    if (plan.has_reflection || plan.has_refraction)
        add_frame(session, question,
                  plan.has_refraction ? plan.has_reflection ? "mirrors and glass" : "glass"
                                      : "mirrors",
                  &less, diags);
    less = *params;
    less.light_count = 0;
    if (plan.has_lights)
        add_frame(session, question, "all lights", &less, diags);
}

static void prepare_stress(vw_session *session, vw_lab_question *question, fl_params *params,
                           fl_diags *diags)
{
    const vw_state *state = &session->state;
    fl_camera *camera = &params->camera;
    double size = state->scene_scale;
    question->samples = STRESS_SAMPLES;
    add_frame(session, question, "", params, diags);
    switch (state->stress) {
    case VW_STRESS_DOUBLE:
        params->precision =
            params->precision == FL_PRECISION_DOUBLE ? FL_PRECISION_FLOAT : FL_PRECISION_DOUBLE;
        break;
    case VW_STRESS_SMALL:
        question->scale = SCALE_SMALL;
        break;
    case VW_STRESS_LARGE:
        question->scale = SCALE_LARGE;
        break;
    case VW_STRESS_PINHOLE:
        camera->aperture = 0.0;
        break;
    case VW_STRESS_WIDE:
        camera->aperture = size;
        break;
    case VW_STRESS_NEAR:
        camera->focus = FOCUS_NEAR * size;
        break;
    case VW_STRESS_FAR:
        camera->focus = FOCUS_FAR * size;
        break;
    case VW_STRESS_OFF:
    case VW_STRESS_COUNT:
        break;
    }
    if (question->scale > 0.0) {
        question->loader = &session->options->loader;
        snprintf(question->path, sizeof question->path, "%s", session->source_path);
        question->state = session->state;
        question->base = session->scene.params;
        return;
    }
    fl_diags why = {0};
    add_frame(session, question, "", params, &why);
    if (question->frame_count < 2)
        snprintf(question->error, sizeof question->error, "%s",
                 why.count ? why.items[0].message : "out of memory");
    fl_diags_deinit(&why);
}

/* The power of two of samples that the picture has come to, within bounds. */
static uint32_t noise_samples(const fl_progress *progress)
{
    uint32_t samples = PICTURE_SAMPLES_FIRST;
    while (samples < NOISE_SAMPLES_MAX && 2 * samples <= progress->complete_samples)
        samples *= 2;
    return samples;
}

/* Returns the number of the question; 0: none could be asked. */
static uint64_t ask(vw_session *session, vw_lab_kind kind, fl_diags *diags)
{
    vw_insight *insight = &session->insight;
    if (!insight->lab && kind == VW_LAB_NOTHING)
        return 0;
    if (!insight->lab)
        insight->lab = vw_lab_create(session->notify, session->notify_context, diags);
    if (!insight->lab)
        return 0;
    vw_lab_question question = {.kind = kind, .samples = TRIAL_SAMPLES};
    fl_params params;
    vw_state_params(&session->state, &session->scene.params, &params);
    if (kind == VW_LAB_NOISE) {
        question.samples = noise_samples(&session->progress);
        add_frame(session, &question, "", &params, diags);
    } else if (kind == VW_LAB_STRESS) {
        prepare_stress(session, &question, &params, diags);
    } else if (kind == VW_LAB_TRIALS) {
        shrink(&params);
        add_frame(session, &question, "now", &params, diags);
        if (question.frame_count == 0)
            return 0;
        if (session->state.panel == VW_PANEL_TRADE)
            add_knobs(session, &question, &params, diags);
        else
            add_features(session, &question, &params, diags);
    }
    uint64_t wish = vw_lab_ask(insight->lab, &question);
    for (uint32_t i = 0; i < question.frame_count; i++)
        fl_frame_release(question.frames[i]);
    return wish;
}

/* Ask, or drop, what the state wants, once for each picture; where the noise comes from, again as
 * it grows finer: the answer so far fits until then. */
static void ask_if_due(vw_session *session, bool is_urgent, fl_diags *diags)
{
    vw_insight *insight = &session->insight;
    const vw_state *state = &session->state;
    const fl_progress *progress = &session->progress;
    vw_lab_kind kind = wanted_kind(state);
    uint32_t samples = kind == VW_LAB_NOISE ? noise_samples(progress) : 0;
    bool is_same = kind == insight->asked_kind && state->stress == insight->asked_stress &&
                   (kind != VW_LAB_TRIALS || state->panel == insight->asked_panel) &&
                   (kind == VW_LAB_NOTHING || progress->generation == insight->asked_generation);
    bool may_wait = kind != VW_LAB_NOTHING && !is_urgent &&
                    (progress->generation != progress->newest_generation ||
                     progress->complete_samples < PICTURE_SAMPLES_FIRST) &&
                    progress->state != FL_RENDER_DONE;
    if (may_wait || (is_same && samples == insight->asked_samples))
        return;
    insight->asked_kind = kind;
    insight->asked_stress = state->stress;
    insight->asked_panel = state->panel;
    insight->asked_generation = progress->generation;
    insight->asked_samples = samples;
    uint64_t wish = ask(session, kind, diags);
    if (!is_same || wish == 0)
        insight->since = wish;
}

void vw_insight_note(vw_session *session)
{
    vw_insight *insight = &session->insight;
    const fl_progress *progress = &session->progress;
    if (insight->way_generation != progress->generation) {
        insight->way_generation = progress->generation;
        insight->way_count = 0;
    }
    uint32_t last = insight->way_count ? insight->way[insight->way_count - 1].samples : 0;
    if (!progress->error.is_known || insight->way_count == VW_WAY_MAX ||
        progress->complete_samples < 2 * last)
        return;
    insight->way[insight->way_count++] =
        (vw_milestone){progress->seconds, progress->error.rmse, progress->complete_samples};
}

static void sum_up_stress(vw_insight *insight)
{
    const vw_lab_answer *answer = &insight->answer;
    insight->changed = insight->touched = 0;
    insight->largest = 0.0;
    for (size_t i = 0; answer->changes && i < (size_t)answer->width * answer->height; i++) {
        insight->touched += answer->changes[i] > 0.0f;
        insight->changed += answer->changes[i] > (float)VW_VISIBLE_CHANGE;
        insight->largest = fl_max((double)answer->changes[i], insight->largest);
    }
}

bool vw_insight_follow(vw_session *session, bool is_urgent, fl_diags *diags)
{
    vw_insight *insight = &session->insight;
    vw_insight_note(session);
    ask_if_due(session, is_urgent, diags);
    if (!insight->lab || !vw_lab_take(insight->lab, &insight->answer))
        return false;
    sum_up_stress(insight);
    const fl_noise_split *noise = &insight->answer.noise;
    if (vw_insight_has(insight, VW_LAB_NOISE) && noise->light_samples > 0.0)
        session->state.light_samples_best = (uint32_t)floor(noise->light_samples_best + 0.5);
    return true;
}

bool vw_insight_has(const vw_insight *insight, vw_lab_kind kind)
{
    return insight->since != 0 && insight->answer.kind == kind &&
           insight->answer.wish >= insight->since;
}

/* Text of a tree from malloc; NULL: out of memory. */
static char *tree_text(const fl_frame *frame, const fl_raytree *tree, bool is_short)
{
    size_t bytes = fl_raytree_text(frame, tree, is_short, NULL, 0) + 1;
    char *text = malloc(bytes);
    if (text)
        fl_raytree_text(frame, tree, is_short, text, bytes);
    return text;
}

vw_dirty vw_insight_rays(vw_session *session, fl_diags *diags)
{
    vw_insight *insight = &session->insight;
    const vw_state *state = &session->state;
    fl_params params;
    fl_raytree tree = {0};
    vw_state_params(state, &session->scene.params, &params);
    fl_frame *frame = fl_frame_create(session->scene.compiled, &params, diags);
    if (!frame)
        return VW_DIRTY_WINDOW;
    free(insight->rays_text);
    free(insight->rays_lines);
    insight->rays_text = insight->rays_lines = NULL;
    double left, top;
    vw_state_origin(state, &params, &left, &top);
    if (fl_raytree_trace(frame, (uint32_t)left + state->rays_x, (uint32_t)top + state->rays_y,
                         state->rays_sample, &tree) &&
        fl_raytree_find_blockers(frame, &tree)) {
        insight->rays_text = tree_text(frame, &tree, false);
        insight->rays_lines = tree_text(frame, &tree, true);
    }
    if (!insight->rays_text || !insight->rays_lines)
        fl_out_of_memory(diags, "the tree of rays");
    fl_raytree_deinit(&tree);
    fl_frame_release(frame);
    return VW_DIRTY_WINDOW;
}
