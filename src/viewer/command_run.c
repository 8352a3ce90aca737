/* SPDX-License-Identifier: MIT */
#include "viewer/command_run.h"

#include <string.h>

#include "viewer/camera.h"

/* Scene scales a second at speed 1: to what is in focus in about four seconds. */
#define FLY_RATE 0.25
/* Binary logarithms of 1.02 and 1.05, the steps of focus and field of view. */
#define LOG2_FOCUS_STEP 0.028569152196770894
#define LOG2_FOV_STEP   0.070389327891398
/* A third of a stop: the lens's area by 2^(1/3), its radius by 2^(1/6). */
#define APERTURE_STEP 1.122462048309373
/* The first opening of a pinhole, in scene scales: visible, not yet a blur. */
#define APERTURE_FIRST   0.005
#define EXPOSURE_STEP_EV 0.25

static double fly_step(const vw_state *state, double amount)
{
    return amount * FLY_RATE * state->scene_scale * state->speed;
}

vw_dirty vw_run_forward(vw_state *state, vw_amount amount)
{
    vw_camera_fly(state, 0.0, 0.0, fly_step(state, amount.x));
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_strafe(vw_state *state, vw_amount amount)
{
    vw_camera_fly(state, fly_step(state, amount.x), 0.0, 0.0);
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_rise(vw_state *state, vw_amount amount)
{
    vw_camera_fly(state, 0.0, fly_step(state, amount.x), 0.0);
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_speed(vw_state *state, vw_amount amount)
{
    double speed = amount.x > 0.0 ? state->speed * 2.0 : state->speed / 2.0;
    if (speed > VW_SPEED_MAX || speed < 1.0 / VW_SPEED_MAX)
        vw_state_say(state, "speed is at its bound, \303\227%g", state->speed);
    else
        state->speed = speed;
    return VW_DIRTY_WINDOW;
}

/* The corner of a rectangle, held within the picture. */
static void set_corner(const vw_state *state, double x, double y, double out[2])
{
    out[0] = fl_clamp(x, 0.0, (double)state->picture_width);
    out[1] = fl_clamp(y, 0.0, (double)state->picture_height);
}

static vw_dirty end_region(vw_state *state)
{
    enum { SMALLEST = 4 };
    const double *a = state->region_from, *b = state->region_to;
    uint32_t rect[4];
    for (int i = 0; i < 2; i++) {
        rect[i] = (uint32_t)fl_min(a[i], b[i]);
        rect[2 + i] = (uint32_t)ceil(fl_max(a[i], b[i])) - rect[i];
    }
    bool was_dragged = state->is_region_dragged;
    state->is_region_armed = state->is_region_dragged = false;
    if (was_dragged && rect[2] >= SMALLEST && rect[3] >= SMALLEST) {
        memcpy(state->look.region, rect, sizeof rect);
        vw_state_say(state, "region of %u \303\227 %u pixels", rect[2], rect[3]);
        return VW_DIRTY_CAMERA;
    }
    if (state->look.region[2] == 0) {
        vw_state_say(state, "hold and drag to render a region");
        return VW_DIRTY_WINDOW;
    }
    memset(state->look.region, 0, sizeof state->look.region);
    vw_state_say(state, "the whole picture");
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_region(vw_state *state, vw_amount amount)
{
    if (amount.x == 0.0)
        return end_region(state);
    state->is_region_armed = true;
    return VW_DIRTY_WINDOW;
}

vw_dirty vw_run_look(vw_state *state, vw_amount amount)
{
    if (state->is_region_armed) {
        if (!state->is_region_dragged)
            set_corner(state, state->cursor_x - amount.x, state->cursor_y - amount.y,
                       state->region_from);
        state->is_region_dragged = true;
        set_corner(state, state->cursor_x, state->cursor_y, state->region_to);
        return VW_DIRTY_WINDOW;
    }
    vw_camera_look(state, amount.x, amount.y);
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_pan(vw_state *state, vw_amount amount)
{
    vw_camera_pan(state, amount.x, amount.y);
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_dolly(vw_state *state, vw_amount amount)
{
    vw_camera_dolly(state, amount.y);
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_orbit(vw_state *state, vw_amount amount)
{
    (void)amount;
    vw_camera_toggle_orbit(state);
    if (state->mode == VW_MODE_ORBIT)
        state->look.camera.focus = vw_camera_working_depth(state);
    vw_state_say(state, state->mode == VW_MODE_ORBIT ? "orbit" : "fly");
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_orbit_at(vw_state *state, vw_amount amount)
{
    (void)state;
    (void)amount;
    return VW_DIRTY_ORBIT_AT;
}

vw_dirty vw_run_reset(vw_state *state, vw_amount amount)
{
    (void)amount;
    state->look = state->start;
    state->mode = VW_MODE_FLY;
    state->speed = 1.0;
    state->saved_aperture = 0.0;
    state->rack_left = 0;
    return (vw_dirty)(VW_DIRTY_CAMERA | VW_DIRTY_TONEMAP | VW_DIRTY_LIMITS);
}

vw_dirty vw_run_print(vw_state *state, vw_amount amount)
{
    (void)amount;
    vw_state_say(state, "camera copied");
    return VW_DIRTY_PRINT;
}

vw_dirty vw_run_paste(vw_state *state, vw_amount amount)
{
    (void)state;
    (void)amount;
    return VW_DIRTY_PASTE;
}

vw_dirty vw_run_undo(vw_state *state, vw_amount amount)
{
    (void)state;
    (void)amount;
    return VW_DIRTY_UNDO;
}

vw_dirty vw_run_redo(vw_state *state, vw_amount amount)
{
    (void)state;
    (void)amount;
    return VW_DIRTY_REDO;
}

static void set_slot(vw_state *state, vw_amount amount)
{
    state->slot = (uint32_t)fl_clamp(amount.x, 1.0, (double)VW_SLOT_COUNT);
}

vw_dirty vw_run_recall(vw_state *state, vw_amount amount)
{
    set_slot(state, amount);
    return VW_DIRTY_RECALL;
}

vw_dirty vw_run_store(vw_state *state, vw_amount amount)
{
    set_slot(state, amount);
    return VW_DIRTY_STORE;
}

/* With a pinhole the focus changes no pixel. */
static vw_dirty lens_dirty(const vw_state *state)
{
    return state->look.camera.aperture > 0.0 ? VW_DIRTY_CAMERA : VW_DIRTY_WINDOW;
}

vw_dirty vw_run_focus(vw_state *state, vw_amount amount)
{
    double *focus = &state->look.camera.focus;
    double factor = fl_d_exp2(fl_clamp(amount.x, -100.0, 100.0) * LOG2_FOCUS_STEP);
    double nearest = 1e-6 * state->scene_scale, farthest = VW_FOCUS_RANGE * state->scene_scale;
    if (isinf(*focus)) {
        if (amount.x >= 0.0) {
            vw_state_say(state, "focus is at infinity");
            return VW_DIRTY_WINDOW;
        }
        *focus = farthest;
    } else if (*focus * factor > farthest && amount.x > 0.0) {
        *focus = (double)INFINITY;
    } else if (*focus * factor < nearest && amount.x < 0.0) {
        vw_state_say(state, "focus is at its nearest, %.3g", *focus);
        return VW_DIRTY_WINDOW;
    } else {
        *focus *= factor;
    }
    return lens_dirty(state);
}

vw_dirty vw_run_focus_at(vw_state *state, vw_amount amount)
{
    state->pick_x = amount.x;
    state->pick_y = amount.y;
    return VW_DIRTY_PICK;
}

vw_dirty vw_run_focus_through(vw_state *state, vw_amount amount)
{
    state->pick_x = amount.x;
    state->pick_y = amount.y;
    return VW_DIRTY_PICK_THROUGH;
}

/* Open a pinhole to a lens; one that was never focused takes what it looks at. */
static void open_lens(vw_state *state, double aperture)
{
    fl_camera *camera = &state->look.camera;
    if (isinf(camera->focus))
        camera->focus = vw_camera_working_depth(state);
    camera->aperture = aperture;
}

vw_dirty vw_run_aperture(vw_state *state, vw_amount amount)
{
    fl_camera *camera = &state->look.camera;
    if (camera->aperture == 0.0) {
        if (amount.x < 0.0) {
            vw_state_say(state, "the aperture is closed: a pinhole");
            return VW_DIRTY_WINDOW;
        }
        open_lens(state, APERTURE_FIRST * state->scene_scale);
        return VW_DIRTY_CAMERA;
    }
    double aperture = camera->aperture;
    for (int i = 0; i < (int)fabs(amount.x); i++)
        aperture = amount.x > 0.0 ? aperture * APERTURE_STEP : aperture / APERTURE_STEP;
    if (aperture > VW_APERTURE_RANGE * state->scene_scale && amount.x > 0.0) {
        vw_state_say(state, "the aperture is at its widest, %.3g", camera->aperture);
        return VW_DIRTY_WINDOW;
    }
    /* Far below visible: closed. */
    camera->aperture = aperture < 1e-6 * state->scene_scale ? 0.0 : aperture;
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_lens(vw_state *state, vw_amount amount)
{
    (void)amount;
    fl_camera *camera = &state->look.camera;
    if (camera->aperture > 0.0) {
        state->saved_aperture = camera->aperture;
        camera->aperture = 0.0;
        vw_state_say(state, "pinhole");
    } else {
        open_lens(state, state->saved_aperture > 0.0 ? state->saved_aperture
                                                     : APERTURE_FIRST * state->scene_scale);
        vw_state_say(state, "lens of radius %.3g", camera->aperture);
    }
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_fov(vw_state *state, vw_amount amount)
{
    fl_camera *camera = &state->look.camera;
    double factor = fl_d_exp2(fl_clamp(-amount.x, -100.0, 100.0) * LOG2_FOV_STEP);
    if (camera->projection == FL_ORTHOGRAPHIC) {
        double size = camera->ortho_size * factor;
        if (size > 1e-6 * state->scene_scale && size < 1e6 * state->scene_scale)
            camera->ortho_size = size;
        else
            vw_state_say(state, "the view is at its bound, %.3g high", camera->ortho_size);
        return VW_DIRTY_CAMERA;
    }
    double fov_deg = fl_clamp(camera->fov_deg * factor, VW_FOV_MIN_DEG, VW_FOV_MAX_DEG);
    if (fov_deg == VW_FOV_MIN_DEG || fov_deg == VW_FOV_MAX_DEG)
        vw_state_say(state, "field of view is at its bound, %g\302\260", fov_deg);
    if (fov_deg == camera->fov_deg)
        return VW_DIRTY_WINDOW;
    camera->fov_deg = fov_deg;
    return VW_DIRTY_CAMERA;
}

/* Double or halve within [1, most]; false after saying that the bound is reached. */
static bool scale_count(vw_state *state, uint32_t *count, double direction, uint32_t most,
                        const char *what)
{
    uint32_t next = direction > 0.0 ? (*count > most / 2 ? most : *count * 2) : *count / 2;
    if (next < 1 || next == *count || (direction > 0.0 && *count >= most)) {
        vw_state_say(state, "%s: %u is the %s", what, *count, direction > 0.0 ? "most" : "least");
        return false;
    }
    *count = next;
    return true;
}

vw_dirty vw_run_light_samples(vw_state *state, vw_amount amount)
{
    uint32_t count =
        state->look.light_samples ? state->look.light_samples : state->scene_light_samples;
    if (!scale_count(state, &count, amount.x, VW_LIGHT_SAMPLES_MAX, "light samples"))
        return VW_DIRTY_WINDOW;
    state->look.light_samples = count;
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_sample_cap(vw_state *state, vw_amount amount)
{
    if (!scale_count(state, &state->look.sample_cap, amount.x, VW_SAMPLE_CAP_MAX,
                     "samples to stop at"))
        return VW_DIRTY_WINDOW;
    return VW_DIRTY_LIMITS;
}

vw_dirty vw_run_depth(vw_state *state, vw_amount amount)
{
    uint32_t *depth = &state->look.depth_limit;
    if (amount.x > 0.0 ? *depth >= FL_DEPTH_MAX : *depth == 0) {
        vw_state_say(state, "depth: %u is the %s", *depth, amount.x > 0.0 ? "most" : "least");
        return VW_DIRTY_WINDOW;
    }
    *depth = amount.x > 0.0 ? *depth + 1 : *depth - 1;
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_exposure(vw_state *state, vw_amount amount)
{
    double ev = state->look.camera.exposure_ev + amount.x * EXPOSURE_STEP_EV;
    if (fabs(ev) > VW_EXPOSURE_MAX_EV) {
        vw_state_say(state, "exposure is at its bound, %+g EV", state->look.camera.exposure_ev);
        return VW_DIRTY_WINDOW;
    }
    state->look.camera.exposure_ev = ev;
    return VW_DIRTY_TONEMAP;
}

vw_dirty vw_run_pause(vw_state *state, vw_amount amount)
{
    (void)amount;
    state->is_paused = !state->is_paused;
    return VW_DIRTY_LIMITS;
}

vw_dirty vw_run_help(vw_state *state, vw_amount amount)
{
    (void)amount;
    state->help_page = (state->help_page + 1) % (VW_HELP_PAGES + 1);
    state->message_until_ms = 0; /* It would stand in front. */
    return VW_DIRTY_WINDOW;
}

vw_dirty vw_run_hud(vw_state *state, vw_amount amount)
{
    (void)amount;
    state->is_hud_shown = !state->is_hud_shown;
    return VW_DIRTY_WINDOW;
}

vw_dirty vw_run_snapshot(vw_state *state, vw_amount amount)
{
    (void)state;
    (void)amount;
    return VW_DIRTY_SNAPSHOT;
}

vw_dirty vw_run_reload(vw_state *state, vw_amount amount)
{
    (void)state;
    (void)amount;
    return VW_DIRTY_SCENE;
}

vw_dirty vw_run_escape(vw_state *state, vw_amount amount)
{
    (void)amount;
    if (state->has_error) {
        state->has_error = false;
        return VW_DIRTY_WINDOW;
    }
    if (state->help_page > 0) {
        state->help_page = 0;
        return VW_DIRTY_WINDOW;
    }
    if (state->panel != VW_PANEL_NONE || state->stress != VW_STRESS_OFF) {
        state->panel = VW_PANEL_NONE;
        state->stress = VW_STRESS_OFF;
        return VW_DIRTY_SHOW;
    }
    if (state->now_ms < state->quit_armed_ms)
        return VW_DIRTY_QUIT;
    state->quit_armed_ms = state->now_ms + VW_QUIT_MS;
    vw_state_say(state, "press Esc again to quit");
    return VW_DIRTY_WINDOW;
}

vw_dirty vw_run_quit(vw_state *state, vw_amount amount)
{
    (void)state;
    (void)amount;
    return VW_DIRTY_QUIT;
}
