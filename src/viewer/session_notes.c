/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "viewer/session.h"
#include "viewer/words.h"

typedef struct lines {
    char *out;
    size_t bytes, length;
} lines;

static void line(lines *l, const char *format, ...) FL_PRINTF(2, 3);

static void line(lines *l, const char *format, ...)
{
    if (l->length + 2 >= l->bytes)
        return;
    if (l->length > 0)
        l->out[l->length++] = '\n';
    va_list args;
    va_start(args, format);
    int length = vsnprintf(l->out + l->length, l->bytes - l->length, format, args);
    va_end(args);
    l->length += length > 0 ? (size_t)length : 0;
    if (l->length >= l->bytes)
        l->length = l->bytes - 1;
}

static const char *distance(double value, char out[32])
{
    snprintf(out, 32, isfinite(value) ? "%.4g" : "\342\210\236", value);
    return out;
}

static void layer_line(const vw_session *session, lines *l)
{
    const vw_show *show = &session->show;
    const vw_state *state = &session->state;
    const char *name = vw_layer_names[state->layer];
    if (!show->is_composed)
        line(l, "%s: on its way", name);
    else if (state->layer == VW_LAYER_DEPTH)
        line(l, "%s: %.4g (bright) to %.4g", name, show->low, show->high);
    else if (state->layer == VW_LAYER_COST)
        line(l, "%s: up to %.0f rays a sample", name, show->high);
    else if (state->layer == VW_LAYER_SAMPLES)
        line(l, "%s: %.0f to %.0f", name, show->low, show->high);
    else if (state->layer == VW_LAYER_ERROR)
        line(l,
             show->high > 0.0 ? "%s: up to %.2g, in squares of 16 pixels"
                              : "%s: known from 4 samples on",
             name, show->high);
    else if (state->layer == VW_LAYER_BRANCH)
        line(l, "%s: most light from here (yellow), a mirror (blue), glass (green)", name);
    else if (state->layer == VW_LAYER_BLUR)
        line(l, "%s: white below 1 pixel; orange nearer, blue farther", name);
    else
        line(l, "%s", name);
}

static void stress_line(const vw_session *session, lines *l)
{
    const vw_insight *insight = &session->insight;
    const vw_lab_answer *answer = &insight->answer;
    const char *name = vw_stress_names[session->state.stress];
    if (!vw_insight_has(insight, VW_LAB_STRESS)) {
        line(l, "stress, %s: being rendered", name);
    } else if (answer->error[0]) {
        line(l, "stress, %s: %s", name, answer->error);
    } else {
        line(l, "stress, %s: %u of %u pixels changed, at most by %.3g", name, insight->changed,
             answer->width * answer->height, insight->largest);
        line(l, "%u differ at all; sample 0, the same points", insight->touched);
    }
}

static void sharp_line(const vw_session *session, lines *l, uint32_t height_px)
{
    double near, far;
    char a[32], b[32];
    if (vw_sharp_limits(&session->state.look.camera, height_px, 1.0, &near, &far))
        line(l, "sharp to a pixel from %s to %s", distance(near, a), distance(far, b));
    else
        line(l, "sharp to a pixel everywhere");
}

static void pick_lines(vw_session *session, lines *l, const fl_params *params, const fl_pick *pick)
{
    if (!pick->is_hit) {
        line(l, "nothing");
        return;
    }
    char a[32];
    line(l, "depth %s  blur %.2g px", distance(pick->depth, a),
         fabs(vw_blur_px(&params->camera, params->height, pick->depth)));
    char name[160];
    fl_object_text(session->scene.compiled, pick->object, name, sizeof name);
    line(l, "%s", name);
}

static void pixel_lines(vw_session *session, lines *l)
{
    const vw_state *state = &session->state;
    double x = floor(state->cursor_x), y = floor(state->cursor_y);
    float rgb[3];
    uint32_t samples;
    double rmse, left, top;
    uint32_t region[4] = {0};
    vw_state_region(state, region);
    double in_x = x - region[0], in_y = y - region[1]; /* Of what is rendered. */
    if (in_x < 0.0 || in_y < 0.0 || in_x >= (double)session->progress.width ||
        in_y >= (double)session->progress.height ||
        !fl_render_pixel(session->render, (uint32_t)in_x, (uint32_t)in_y, rgb, &samples, &rmse))
        return;
    line(l, "pixel %.0f %.0f: %.4g %.4g %.4g, %u samples", x, y, (double)rgb[0], (double)rgb[1],
         (double)rgb[2], samples);
    char error[24];
    vw_words_percent(rmse, error);
    if (rmse > 0.0)
        line(l, "error %s, in its square of 16 pixels", error);
    fl_params params;
    fl_pick pick;
    fl_diags diags = {0};
    vw_state_params(state, &session->scene.params, &params);
    fl_frame *frame = fl_frame_create(session->scene.compiled, &params, &diags);
    vw_state_origin(state, &params, &left, &top);
    if (frame && fl_trace_pick(frame, x + 0.5 + left, y + 0.5 + top, &pick))
        pick_lines(session, l, &params, &pick);
    fl_frame_release(frame);
    fl_diags_deinit(&diags);
}

void vw_session_notes(vw_session *session, char *out, size_t out_bytes)
{
    lines l = {.out = out, .bytes = out_bytes};
    const vw_state *state = &session->state;
    const vw_show *show = &session->show;
    out[0] = 0;
    fl_params params;
    vw_state_params(state, &session->scene.params, &params);
    uint32_t region[4];
    if (vw_state_region(state, region)) {
        char keys[VW_KEYS_MAX];
        vw_words_keys(vw_command_named("region"), state->keymap, NULL, keys);
        line(&l, "region %u x %u at %u, %u; tap %s for all", region[2], region[3], region[0],
             region[1], keys[0] ? keys : "its key");
    }
    if (state->is_mixing)
        line(&l, "preview of light %u", state->light + 1);
    if (state->layer != VW_LAYER_BEAUTY)
        layer_line(session, &l);
    if (state->stress != VW_STRESS_OFF)
        stress_line(session, &l);
    if (state->assist != VW_ASSIST_OFF || state->layer == VW_LAYER_BLUR)
        sharp_line(session, &l, params.height);
    if (show->pin.rgb && show->has_difference && show->pin.samples == 0)
        line(&l, "pinned file; rmse %.3g, at most %.3g", show->difference.rmse,
             show->difference.largest);
    else if (show->pin.rgb && show->has_difference)
        line(&l, "pinned at %u samples; rmse %.3g, at most %.3g", show->pin.samples,
             show->difference.rmse, show->difference.largest);
    else if (show->pin.rgb)
        line(&l, "pinned at %u x %u pixels", show->pin.width, show->pin.height);
    if (state->is_inspecting)
        pixel_lines(session, &l);
}
