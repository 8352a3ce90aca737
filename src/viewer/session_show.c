/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "io/image_file.h"
#include "viewer/session.h"

/* Values behind the pixels that the state wants to see; -1: none. */
static int wanted_kind(const vw_state *state)
{
    static const int kinds[VW_LAYER_COUNT] = {[VW_LAYER_BEAUTY] = -1,
                                              [VW_LAYER_DEPTH] = FL_AOV_DEPTH,
                                              [VW_LAYER_NORMAL] = FL_AOV_NORMAL,
                                              [VW_LAYER_ALBEDO] = FL_AOV_ALBEDO,
                                              [VW_LAYER_SAMPLES] = -1,
                                              [VW_LAYER_ERROR] = -1,
                                              [VW_LAYER_COST] = FL_AOV_COST,
                                              [VW_LAYER_BLUR] = FL_AOV_DEPTH,
                                              [VW_LAYER_OBJECTS] = FL_AOV_OBJECT,
                                              [VW_LAYER_BRANCH] = FL_AOV_BRANCH};
    if (state->layer != VW_LAYER_BEAUTY)
        return kinds[state->layer];
    if (state->look.camera.aperture == 0.0 || state->assist == VW_ASSIST_OFF)
        return -1;
    return state->assist == VW_ASSIST_BAND ? FL_AOV_DEPTH : VW_GUIDE_RANGEFINDER;
}

static void pin_deinit(vw_pin *pin)
{
    free(pin->rgb);
    free(pin->rgba);
    *pin = (vw_pin){0};
}

void vw_show_deinit(vw_show *show)
{
    vw_guide_destroy(show->guide);
    free(show->picture.values);
    free(show->rgba);
    free(show->values);
    pin_deinit(&show->pin);
    *show = (vw_show){0};
}

void vw_show_ask(vw_session *session, fl_diags *diags)
{
    vw_show *show = &session->show;
    int kind = wanted_kind(&session->state);
    show->is_asked = true;
    show->wish_kind = kind;
    if (kind < 0)
        return;
    if (!show->guide)
        show->guide = vw_guide_create(session->notify, session->notify_context, diags);
    fl_params params;
    vw_state_params(&session->state, &session->scene.params, &params);
    fl_frame *frame = show->guide ? fl_frame_create(session->scene.compiled, &params, diags) : NULL;
    if (!frame)
        return;
    show->wish = vw_guide_ask(show->guide, frame, kind);
    fl_frame_release(frame);
}

bool vw_show_take(vw_session *session)
{
    vw_show *show = &session->show;
    return show->guide && vw_guide_take(show->guide, &show->picture) && show->wish_kind >= 0;
}

/* The values that the state wants are here and fit the picture; older ones of the same kind do
 * until newer come. */
static bool has_values(const vw_session *session)
{
    const vw_guide_picture *picture = &session->show.picture;
    return picture->values && picture->kind == wanted_kind(&session->state) &&
           picture->width == session->progress.width && picture->height == session->progress.height;
}

static bool has_pin(const vw_session *session)
{
    const vw_pin *pin = &session->show.pin;
    return pin->rgb && !session->mix.unit && pin->width == session->progress.width &&
           pin->height == session->progress.height;
}

void vw_show_explain_pin(vw_session *session)
{
    const vw_pin *pin = &session->show.pin;
    const fl_progress *shown = &session->progress;
    if (!pin->rgb)
        vw_state_say(&session->state, "pin a picture first (V)");
    else if (session->mix.unit)
        vw_state_say(&session->state, "a preview is not compared");
    else if (!has_pin(session))
        vw_state_say(&session->state, "pinned: %u \303\227 %u pixels; this picture: %u \303\227 %u",
                     pin->width, pin->height, shown->width, shown->height);
}

static void tonemap_pin(vw_session *session)
{
    vw_pin *pin = &session->show.pin;
    fl_tonemap tonemap = vw_session_tonemap(session, &session->state);
    if (pin->exposure_ev == tonemap.exposure_ev)
        return;
    pin->exposure_ev = tonemap.exposure_ev;
    fl_tonemap_rgba8(&tonemap, pin->rgb, (size_t)pin->width * pin->height, pin->rgba);
}

vw_dirty vw_show_toggle_pin(vw_session *session, fl_diags *diags)
{
    vw_show *show = &session->show;
    bool was_pinned = show->pin.rgb != NULL;
    pin_deinit(&show->pin);
    show->has_difference = false;
    if (was_pinned) {
        vw_state_say(&session->state, "nothing pinned");
        return VW_DIRTY_SHOW;
    }
    if (session->revision == 0) {
        vw_state_say(&session->state, "there is no picture yet");
        return VW_DIRTY_WINDOW;
    }
    fl_progress progress;
    float *rgb = vw_session_mean(session, &progress, diags);
    uint8_t *rgba = rgb ? malloc((size_t)progress.width * progress.height * 4) : NULL;
    if (!rgba) {
        if (rgb)
            fl_out_of_memory(diags, "the pinned picture");
        free(rgb);
        return VW_DIRTY_WINDOW;
    }
    show->pin = (vw_pin){.rgb = rgb,
                         .rgba = rgba,
                         .exposure_ev = (double)INFINITY,
                         .width = progress.width,
                         .height = progress.height,
                         .samples = progress.complete_samples};
    vw_state_say(&session->state, "pinned at %u samples; Space shows it",
                 progress.complete_samples);
    return VW_DIRTY_SHOW;
}

/* Linear values of a picture; 8 bits are what a screen showed with that exposure. */
static void linear_of(const fl_image *image, double exposure_ev, float *out_rgb)
{
    size_t count = (size_t)3 * image->width * image->height;
    float scale = image->format == FL_PIXEL_FLOAT ? 1.0f : (float)fl_d_exp2(-exposure_ev);
    for (size_t i = 0; i < count; i++)
        out_rgb[i] = scale * fl_image_linear(image, i);
}

bool vw_show_load_pin(vw_session *session, const char *path, fl_diags *diags)
{
    fl_image *image = fl_image_load(path, (fl_loc){0}, diags);
    if (!image)
        return false;
    size_t pixels = (size_t)image->width * image->height;
    float *rgb = malloc(pixels * 3 * sizeof *rgb);
    uint8_t *rgba = malloc(pixels * 4);
    if (rgb && rgba) {
        linear_of(image, session->state.look.camera.exposure_ev, rgb);
        session->show.pin = (vw_pin){.rgb = rgb,
                                     .rgba = rgba,
                                     .exposure_ev = (double)INFINITY,
                                     .width = image->width,
                                     .height = image->height};
    } else {
        free(rgb);
        free(rgba);
        fl_out_of_memory(diags, "the pinned picture");
    }
    fl_image_release(image);
    return session->show.pin.rgb != NULL;
}

static bool reserve(vw_show *show, size_t pixels)
{
    if (pixels <= show->pixels)
        return true;
    uint8_t *rgba = realloc(show->rgba, pixels * 4);
    if (rgba)
        show->rgba = rgba;
    float *values = realloc(show->values, pixels * 3 * sizeof *values);
    if (values)
        show->values = values;
    if (rgba && values)
        show->pixels = pixels;
    return rgba && values;
}

/* A layer that the render itself knows. False: not there yet. */
static bool compose_map(vw_session *session, vw_paint *paint, size_t pixels)
{
    vw_show *show = &session->show;
    fl_progress progress;
    fl_render_map map =
        session->state.layer == VW_LAYER_SAMPLES ? FL_RENDER_SAMPLES : FL_RENDER_ERROR;
    if (!fl_render_copy_map(session->render, map, show->values, pixels, &progress) ||
        progress.width != session->progress.width || progress.height != session->progress.height)
        return false;
    vw_paint_range(paint, show->values, 1, pixels);
    vw_paint_layer(paint, session->state.layer, show->values, pixels, show->rgba);
    return true;
}

/* What the layer or the focus help makes of the picture. False: the picture as it is. */
static bool compose_layer(vw_session *session, size_t pixels)
{
    vw_show *show = &session->show;
    const vw_state *state = &session->state;
    fl_params params;
    vw_state_params(state, &session->scene.params, &params);
    vw_paint paint = {.camera = &params.camera, .height_px = params.height};
    bool is_there = false;
    if (state->layer == VW_LAYER_SAMPLES || state->layer == VW_LAYER_ERROR) {
        is_there = compose_map(session, &paint, pixels);
    } else if (has_values(session)) {
        const float *values = show->picture.values;
        is_there = true;
        if (state->layer != VW_LAYER_BEAUTY) {
            vw_paint_range(&paint, values, 3, pixels);
            vw_paint_layer(&paint, state->layer, values, pixels, show->rgba);
        } else if (state->assist == VW_ASSIST_BAND) {
            memcpy(show->rgba, session->rgba, pixels * 4);
            vw_paint_band(&paint, values, pixels, show->rgba);
        } else {
            vw_paint_layer(&paint, VW_LAYER_BEAUTY, values, pixels, show->rgba);
        }
    }
    show->low = paint.low;
    show->high = paint.high;
    return is_there;
}

static bool compose_comparison(vw_session *session, bool has_layer, size_t pixels)
{
    vw_show *show = &session->show;
    const vw_state *state = &session->state;
    fl_progress progress;
    tonemap_pin(session);
    bool has_mean = fl_render_mean(session->render, show->values, pixels * 3, &progress) &&
                    progress.width == session->progress.width &&
                    progress.height == session->progress.height;
    bool shows_difference = state->compare == VW_COMPARE_DIFFERENCE && !state->is_flipped;
    show->has_difference = has_mean;
    if (has_mean)
        vw_paint_difference(show->values, show->pin.rgb, pixels,
                            shows_difference ? show->rgba : NULL, &show->difference);
    if (state->is_flipped) {
        memcpy(show->rgba, show->pin.rgba, pixels * 4);
        return true;
    }
    if (state->compare != VW_COMPARE_WIPE)
        return shows_difference ? has_mean : has_layer;
    uint32_t width = session->progress.width;
    uint32_t region[4] = {0};
    vw_state_region(state, region);
    uint32_t edge = (uint32_t)fl_clamp(state->cursor_x - region[0], 0.0, (double)width);
    for (uint32_t y = 0; y < session->progress.height; y++) {
        size_t row = (size_t)y * width * 4;
        if (!has_layer)
            memcpy(show->rgba + row + 4 * edge, session->rgba + row + 4 * edge, 4 * (width - edge));
        memcpy(show->rgba + row, show->pin.rgba + row, 4 * (size_t)edge);
        if (edge > 0 && edge < width)
            memset(show->rgba + row + 4 * (edge - 1), 255, 4);
    }
    return true;
}

static bool has_stress(const vw_session *session)
{
    const vw_lab_answer *answer = &session->insight.answer;
    return session->state.stress != VW_STRESS_OFF &&
           vw_insight_has(&session->insight, VW_LAB_STRESS) && answer->changes &&
           answer->width == session->progress.width && answer->height == session->progress.height;
}

bool vw_show_compose(vw_session *session, fl_diags *diags)
{
    vw_show *show = &session->show;
    size_t pixels = (size_t)session->progress.width * session->progress.height;
    show->is_composed = show->has_difference = false;
    if (pixels == 0 || pixels * 4 > session->rgba_bytes)
        return true;
    bool has_layer = session->state.layer != VW_LAYER_BEAUTY || wanted_kind(&session->state) >= 0;
    if (!has_layer && !has_pin(session) && !has_stress(session))
        return true;
    if (!reserve(show, pixels))
        return fl_out_of_memory(diags, "the view");
    show->is_composed = has_layer && compose_layer(session, pixels);
    if (has_pin(session))
        show->is_composed = compose_comparison(session, show->is_composed, pixels);
    if (has_stress(session)) {
        if (!show->is_composed)
            memcpy(show->rgba, session->rgba, pixels * 4);
        vw_paint_changes(session->insight.answer.changes, pixels, show->rgba);
        show->is_composed = true;
    }
    return true;
}

const uint8_t *vw_session_shown(vw_session *session)
{
    return session->show.is_composed ? session->show.rgba : session->rgba;
}

void vw_session_settle(vw_session *session, fl_diags *diags)
{
    vw_show_ask(session, diags);
    if (session->show.wish_kind >= 0 && session->show.guide)
        vw_guide_wait(session->show.guide);
    fl_render_progress(session->render, &session->progress);
    vw_insight_follow(session, true, diags);
    if (session->insight.lab)
        vw_lab_wait(session->insight.lab);
    if (session->mix.unit)
        fl_render_wait(session->mix.unit, -1.0);
    session->show.is_stale = true;
}
