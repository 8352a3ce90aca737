/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/state_text.h"
#include "viewer/camera.h"
#include "viewer/session.h"

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static fl_frame *frame_of(vw_session *session, fl_params *out_params, fl_diags *diags)
{
    vw_state_params(&session->state, &session->scene.params, out_params);
    return fl_frame_create(session->scene.compiled, out_params, diags);
}

vw_dirty vw_session_pick(vw_session *session, fl_diags *diags)
{
    enum { SIDE = 5 };
    vw_state *state = &session->state;
    fl_params params;
    fl_frame *frame = frame_of(session, &params, diags);
    if (!frame)
        return VW_DIRTY_NONE;
    double depths[SIDE * SIDE];
    size_t count = 0;
    double left, top;
    vw_state_origin(state, &params, &left, &top);
    left += state->pick_x - SIDE / 2;
    top += state->pick_y - SIDE / 2;
    for (int i = 0; i < SIDE * SIDE; i++) {
        fl_pick pick;
        if (!fl_trace_pick(frame, left + i % SIDE, top + i / SIDE, &pick)) {
            fl_out_of_memory(diags, "picking");
            break;
        }
        if (pick.is_hit && pick.depth > 0.0)
            depths[count++] = pick.depth;
    }
    fl_frame_release(frame);
    qsort(depths, count, sizeof depths[0], compare_doubles);
    return vw_state_focus_at(state, count ? depths[count / 2] : 0.0);
}

vw_dirty vw_session_pick_through(vw_session *session, fl_diags *diags)
{
    vw_state *state = &session->state;
    fl_params params;
    fl_frame *frame = frame_of(session, &params, diags);
    if (!frame)
        return VW_DIRTY_NONE;
    double focus = 0.0, x, y;
    fl_trace_seen seen;
    vw_state_origin(state, &params, &x, &y);
    if (!fl_trace_focus(frame, x + state->pick_x, y + state->pick_y, &focus, &seen))
        fl_out_of_memory(diags, "picking");
    fl_frame_release(frame);
    vw_dirty dirty = vw_state_focus_at(state, focus);
    if (focus > 0.0 && seen.bounces > 0)
        vw_state_say(state, "focus at %.4g, %s by %u surface%s", focus,
                     seen.refracted ? "seen through glass" : "mirrored", seen.bounces,
                     seen.bounces > 1 ? "s" : "");
    return dirty;
}

static vw_dirty orbit_at(vw_session *session, fl_diags *diags)
{
    vw_state *state = &session->state;
    fl_params params;
    fl_frame *frame = frame_of(session, &params, diags);
    if (!frame)
        return VW_DIRTY_NONE;
    fl_pick pick = {0};
    double x, y;
    vw_state_origin(state, &params, &x, &y);
    if (!fl_trace_pick(frame, x + state->cursor_x, y + state->cursor_y, &pick))
        fl_out_of_memory(diags, "picking");
    fl_frame_release(frame);
    if (!pick.is_hit || !vw_camera_orbit_at(state, pick.position)) {
        vw_state_say(state, pick.is_hit ? "that cannot be orbited: it lies along the camera's up"
                                        : "nothing there to orbit");
        return VW_DIRTY_WINDOW;
    }
    state->rack_left = 0;
    vw_state_say(state, "orbit at %.4g", state->look.camera.focus);
    return VW_DIRTY_CAMERA;
}

static vw_dirty take_camera(vw_state *state, const fl_camera *camera)
{
    uint32_t width = state->look.camera.width, height = state->look.camera.height;
    state->look.camera = *camera;
    state->look.camera.width = width;
    state->look.camera.height = height;
    state->mode = VW_MODE_FLY;
    state->rack_left = 0;
    return (vw_dirty)(VW_DIRTY_CAMERA | VW_DIRTY_TONEMAP);
}

/* Lights in scene text, when they are as many and of the same kinds. */
static bool read_lights(const char *text, vw_look *look)
{
    static const char first[] = "firstlight 1\n";
    const char *block = text ? strstr(text, "Lights {") : NULL;
    char whole[sizeof first + VW_PATH_MAX + FL_LIGHT_TEXT_MAX];
    int bytes = block ? snprintf(whole, sizeof whole, "%s%s", first, block) : 0;
    if (bytes <= 0 || (size_t)bytes >= sizeof whole)
        return false;
    fl_diags diags = {0};
    fl_scene *scene =
        fl_scene_parse(whole, (size_t)bytes, "lights", &(fl_parse_options){0}, NULL, &diags);
    fl_diags_deinit(&diags);
    bool fits = scene && scene->light_count > 0 && scene->light_count == look->light_count;
    for (uint32_t i = 0; fits && i < look->light_count; i++)
        fits = scene->lights[i].kind == look->lights[i].kind;
    for (uint32_t i = 0; fits && i < look->light_count; i++) {
        fl_loc loc = look->lights[i].loc;
        look->lights[i] = scene->lights[i];
        look->lights[i].loc = loc;
    }
    if (fits)
        vw_look_take_lit_colors(look);
    fl_scene_destroy(scene);
    return fits;
}

vw_dirty vw_session_paste(vw_session *session, const char *text)
{
    vw_state *state = &session->state;
    fl_camera camera = state->look.camera;
    fl_params params;
    fl_diags diags = {0};
    bool is_found = text && fl_camera_read_text(text, strlen(text), &camera);
    vw_state_params(state, &session->scene.params, &params);
    params.camera = camera;
    bool is_legal = is_found && fl_params_check(&params, &diags);
    fl_diags_deinit(&diags);
    if (!is_legal) {
        vw_state_say(state, is_found ? "the camera in the clipboard is out of bounds"
                                     : "no camera in the clipboard");
        return VW_DIRTY_WINDOW;
    }
    vw_dirty dirty = take_camera(state, &camera);
    bool has_lights = read_lights(text, &state->look);
    vw_state_say(state, "%s",
                 has_lights                 ? "camera and lights pasted"
                 : strstr(text, "Lights {") ? "camera pasted; its lights do not fit this scene"
                                            : "camera pasted");
    vw_history_note(&session->history, state, NULL, false);
    return dirty;
}

size_t vw_session_copy(const vw_session *session, char *out, size_t out_bytes)
{
    char options[FL_STATE_TEXT_MAX], block[FL_STATE_TEXT_MAX];
    const fl_camera *camera = &session->state.look.camera;
    fl_camera_options_text(camera, options, sizeof options);
    fl_camera_scene_text(camera, NULL, block, sizeof block);
    int length = snprintf(out, out_bytes, "# %s\n%s", options, block);
    size_t done = length > 0 ? (size_t)length : 0;
    const vw_state *state = &session->state;
    if (vw_lights_are_same(&state->look, &state->start))
        return done;
    bool has_room = done < out_bytes;
    return done + fl_lights_scene_text(state->look.lights, state->look.light_count,
                                       has_room ? out + done : NULL,
                                       has_room ? out_bytes - done : 0);
}

static vw_dirty recall(vw_session *session)
{
    vw_state *state = &session->state;
    const fl_camera *camera = vw_bookmarks_find(&session->bookmarks, state->slot);
    if (!camera) {
        vw_state_say(state, "bookmark %u is empty (Ctrl+%u sets it)", state->slot, state->slot);
        return VW_DIRTY_WINDOW;
    }
    vw_dirty dirty = take_camera(state, camera);
    /* A bookmark without lights has the scene's. */
    const char *lights = vw_bookmarks_lights(&session->bookmarks, state->slot);
    vw_look_take_lights(&state->look, &state->start);
    if (fl_lights_read(lights, state->look.lights, state->look.light_count))
        vw_look_take_lit_colors(&state->look);
    vw_state_say(state, "bookmark %u", state->slot);
    return dirty;
}

static vw_dirty store(vw_session *session, fl_diags *diags)
{
    vw_state *state = &session->state;
    char lights[FL_LIGHT_TEXT_MAX] = "";
    if (!vw_lights_are_same(&state->look, &state->start))
        fl_lights_text(state->look.lights, state->look.light_count, lights);
    if (vw_bookmarks_store(&session->bookmarks, state->slot, &state->look.camera, lights,
                           session->is_replay ? NULL : session->scene_path, diags))
        vw_state_say(state, "bookmark %u set", state->slot);
    return VW_DIRTY_WINDOW;
}

/* The selected light has another colour. The same light again: another sum of what there is. */
static unsigned mix_light(vw_session *session, unsigned dirty)
{
    vw_state *state = &session->state;
    if (!vw_mix_is_possible(session->scene.compiled))
        return VW_DIRTY_CAMERA;
    bool goes_on = state->is_mixing && session->mix.unit && session->mix.light == state->light &&
                   !(dirty & (VW_DIRTY_CAMERA | VW_DIRTY_SCENE));
    state->is_mixing = true;
    state->mix_until_ms = state->now_ms + VW_MIX_MS;
    return goes_on ? VW_DIRTY_TONEMAP : VW_DIRTY_CAMERA;
}

/* One gesture is one step. All that moves is one: keys that are held take turns with the mouse. */
static void note_step(vw_session *session)
{
    static const vw_command motion = {.name = "motion"};
    const vw_input *input = &session->input;
    bool is_racking = session->state.rack_left > 0;
    bool is_motion = input->last_kind == VW_BIND_HOLD || input->last_kind == VW_BIND_DRAG;
    bool is_gesture = is_motion || input->last_kind == VW_BIND_WHEEL || is_racking ||
                      session->was_racking || (input->last && input->last->repeats);
    session->was_racking = is_racking;
    vw_history_note(&session->history, &session->state, is_motion ? &motion : input->last,
                    is_gesture);
}

vw_dirty vw_session_answer(vw_session *session, vw_dirty dirty, fl_diags *diags)
{
    vw_state *state = &session->state;
    unsigned all = dirty;
    if (dirty & VW_DIRTY_PICK)
        all |= vw_session_pick(session, diags);
    if (dirty & VW_DIRTY_PICK_THROUGH)
        all |= vw_session_pick_through(session, diags);
    if (dirty & VW_DIRTY_ORBIT_AT)
        all |= orbit_at(session, diags);
    if (dirty & VW_DIRTY_RECALL)
        all |= recall(session);
    if (dirty & VW_DIRTY_STORE)
        all |= store(session, diags);
    if ((dirty & VW_DIRTY_PIN) && session->mix.unit)
        vw_state_say(state, "a preview is not pinned");
    else if (dirty & VW_DIRTY_PIN)
        all |= vw_show_toggle_pin(session, diags);
    if (dirty & VW_DIRTY_COMPARE)
        vw_show_explain_pin(session);
    if (dirty & VW_DIRTY_RAYS)
        all |= vw_insight_rays(session, diags);
    note_step(session); /* Before undo: what the events so far did is a step of its own. */
    if (dirty & VW_DIRTY_UNDO)
        all |= vw_history_undo(&session->history, state);
    if (dirty & VW_DIRTY_REDO)
        all |= vw_history_redo(&session->history, state);
    session->input.is_racking = state->rack_left > 0;
    if (all & VW_DIRTY_LIGHT) {
        all = (all & ~(unsigned)VW_DIRTY_LIGHT) | mix_light(session, all);
    } else if (state->is_mixing && (state->now_ms >= state->mix_until_ms ||
                                    (all & (VW_DIRTY_CAMERA | VW_DIRTY_SCENE)))) {
        state->is_mixing = false;
        all |= VW_DIRTY_CAMERA;
    }
    if ((all & VW_DIRTY_CAMERA) && vw_session_is_asked(session))
        all = (all & ~(unsigned)VW_DIRTY_CAMERA) | VW_DIRTY_WINDOW;
    else if (all & VW_DIRTY_CAMERA)
        vw_session_note_asked(session);
    if (all & (VW_DIRTY_CAMERA | VW_DIRTY_SHOW | VW_DIRTY_SCENE))
        session->show.is_asked = false;
    if (session->error_text && !state->has_error)
        vw_session_clear_error(session); /* Esc took it away. */
    session->show.is_stale |= (all & VW_DIRTY_SHOW) != 0;
    return (vw_dirty)all;
}
