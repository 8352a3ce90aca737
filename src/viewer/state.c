/* SPDX-License-Identifier: MIT */
#include "viewer/state.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *const vw_layer_names[VW_LAYER_COUNT] = {
    "beauty", "depth", "normal", "albedo", "samples", "error", "cost", "blur", "objects", "branch"};
const char *const vw_stress_names[VW_STRESS_COUNT] = {
    "off",        "double",        "scene \303\2271e-3", "scene \303\2271e6",
    "aperture 0", "aperture huge", "focus 1e-6",         "focus 1e9"};

static uint32_t largest_light_samples(const fl_params *params)
{
    uint32_t largest = 1;
    for (uint32_t i = 0; i < params->light_count; i++)
        if (params->lights[i].kind == FL_LIGHT_DISK && params->lights[i].radius > 0.0)
            largest = fl_max_u32(largest, params->lights[i].samples);
    return largest;
}

static void set_scene(vw_state *state, const fl_params *params, const fl_compiled *compiled,
                      uint32_t sample_cap)
{
    state->start = (vw_look){.camera = params->camera,
                             .depth_limit = params->depth_limit,
                             .light_samples = params->light_samples,
                             .sample_cap = sample_cap};
    if (params->light_count <= VW_LIGHTS_MAX)
        state->start.light_count = params->light_count;
    for (uint32_t i = 0; i < state->start.light_count; i++) {
        state->start.lights[i] = params->lights[i];
        state->start.lit_colors[i] = params->lights[i].color;
    }
    state->scene_light_samples = largest_light_samples(params);
    double extent = compiled ? compiled->geometry.extent : 1.0, focus = params->camera.focus;
    state->scene_scale = isfinite(extent) && extent > 0.0 ? extent : 1.0;
    /* A wide floor says little about the size of what is looked at; where the scene is focused says
     * more. */
    if (focus > 1e-3 * state->scene_scale && focus < state->scene_scale)
        state->scene_scale = focus;
    state->scene_center = compiled ? compiled->geometry.origin : fl_v3(0.0, 0.0, 0.0);
}

static bool is_same_point(fl_vec3 a, fl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Fit a picture into the framebuffer, centred, without distortion. */
static void fit_picture(vw_state *state, uint32_t picture_width, uint32_t picture_height)
{
    state->picture_width = picture_width;
    state->picture_height = picture_height;
    double across = (double)state->width / (double)picture_width;
    double down = (double)state->height / (double)picture_height;
    state->picture_scale = fl_min(across, down);
    /* Whole pixels of offset: at scale 1 the picture's pixels are the window's. */
    state->picture_x =
        floor(((double)state->width - state->picture_scale * (double)picture_width) / 2.0);
    state->picture_y =
        floor(((double)state->height - state->picture_scale * (double)picture_height) / 2.0);
}

static bool is_same_pose(const fl_camera *a, const fl_camera *b)
{
    return is_same_point(a->center, b->center) && is_same_point(a->direction, b->direction) &&
           is_same_point(a->up, b->up);
}

static bool is_same_field(const fl_camera *a, const fl_camera *b)
{
    return a->projection == b->projection && a->fov_deg == b->fov_deg &&
           a->ortho_size == b->ortho_size;
}

static bool is_same_opening(const fl_camera *a, const fl_camera *b)
{
    return a->aperture == b->aperture && a->blades == b->blades &&
           a->blade_rotation_deg == b->blade_rotation_deg;
}

static bool is_same_camera(const fl_camera *a, const fl_camera *b)
{
    return is_same_pose(a, b) && is_same_field(a, b) && is_same_opening(a, b) &&
           a->focus == b->focus && a->exposure_ev == b->exposure_ev;
}

/* Part by part: who has only made it brighter sees an angle that is edited in the file. */
static void rebase_camera(fl_camera *camera, const fl_camera *before, const fl_camera *start)
{
    fl_camera own = *camera;
    *camera = *start;
    if (!is_same_pose(&own, before)) {
        camera->center = own.center;
        camera->direction = own.direction;
        camera->up = own.up;
    }
    if (!is_same_field(&own, before)) {
        camera->projection = own.projection;
        camera->fov_deg = own.fov_deg;
        camera->ortho_size = own.ortho_size;
    }
    if (!is_same_opening(&own, before)) {
        camera->aperture = own.aperture;
        camera->blades = own.blades;
        camera->blade_rotation_deg = own.blade_rotation_deg;
    }
    if (own.focus != before->focus)
        camera->focus = own.focus;
    if (own.exposure_ev != before->exposure_ev)
        camera->exposure_ev = own.exposure_ev;
}

bool vw_lights_are_same(const vw_look *a, const vw_look *b)
{
    bool is_same = a->light_count == b->light_count;
    for (uint32_t i = 0; is_same && i < a->light_count; i++) {
        const fl_light *p = &a->lights[i], *q = &b->lights[i];
        is_same = p->kind == q->kind && is_same_point(p->position, q->position) &&
                  is_same_point(p->direction, q->direction) && p->radius == q->radius &&
                  is_same_point(p->color, q->color) &&
                  is_same_point(a->lit_colors[i], b->lit_colors[i]);
    }
    return is_same;
}

bool vw_look_is_same(const vw_look *a, const vw_look *b)
{
    return is_same_camera(&a->camera, &b->camera) && a->depth_limit == b->depth_limit &&
           a->light_samples == b->light_samples && a->sample_cap == b->sample_cap &&
           memcmp(a->region, b->region, sizeof a->region) == 0 && vw_lights_are_same(a, b);
}

/* The picture that the parameters ask for, in a window that may have another size. */
static void set_picture(vw_state *state, const fl_params *params, bool wants_follow)
{
    bool is_cropped = params->crop_w != 0;
    state->follows_window =
        wants_follow && !is_cropped && params->camera_model == FL_CAMERA_VERTICAL_FOV;
    uint32_t width = is_cropped ? params->crop_w : params->width,
             height = is_cropped ? params->crop_h : params->height;
    if (state->width == 0 || state->height == 0) {
        state->width = width;
        state->height = height;
    }
    if (state->follows_window)
        fit_picture(state, fl_min_u32(state->width, FL_SIDE_MAX),
                    fl_min_u32(state->height, FL_SIDE_MAX));
    else
        fit_picture(state, width, height);
}

void vw_state_init(vw_state *state, const fl_params *params, const fl_compiled *compiled,
                   uint32_t sample_cap)
{
    bool wants_follow = state->follows_window;
    *state = (vw_state){.width = state->width,
                        .height = state->height,
                        .now_ms = state->now_ms,
                        .keymap = state->keymap,
                        .text_scale = state->text_scale,
                        .is_hidden = state->is_hidden,
                        .mode = VW_MODE_FLY,
                        .speed = 1.0,
                        .rack_seconds = 2.0,
                        .is_hud_shown = true};
    set_scene(state, params, compiled, sample_cap);
    state->look = state->start;
    set_picture(state, params, wants_follow);
}

void vw_look_take_lights(vw_look *look, const vw_look *from)
{
    look->light_count = from->light_count;
    memcpy(look->lights, from->lights, sizeof look->lights);
    memcpy(look->lit_colors, from->lit_colors, sizeof look->lit_colors);
}

void vw_look_take_lit_colors(vw_look *look)
{
    for (uint32_t i = 0; i < look->light_count; i++) {
        fl_vec3 color = look->lights[i].color;
        if (color.x != 0.0 || color.y != 0.0 || color.z != 0.0)
            look->lit_colors[i] = color;
    }
}

bool vw_look_rebase(vw_look *look, const vw_look *before, const vw_look *start)
{
    bool is_moved = is_same_pose(&look->camera, &before->camera) &&
                    !is_same_pose(&before->camera, &start->camera);
    rebase_camera(&look->camera, &before->camera, &start->camera);
    if (look->depth_limit == before->depth_limit)
        look->depth_limit = start->depth_limit;
    if (look->light_samples == before->light_samples)
        look->light_samples = start->light_samples;
    if (look->sample_cap == before->sample_cap)
        look->sample_cap = start->sample_cap;
    if (vw_lights_are_same(look, before) || look->light_count != start->light_count)
        vw_look_take_lights(look, start);
    return is_moved;
}

void vw_state_rebase(vw_state *state, const fl_params *params, const fl_compiled *compiled,
                     uint32_t sample_cap)
{
    vw_look before = state->start;
    set_scene(state, params, compiled, sample_cap);
    if (vw_look_rebase(&state->look, &before, &state->start))
        state->mode = VW_MODE_FLY; /* What was orbited may be elsewhere. */
    state->light = fl_min_u32(state->light, fl_max_u32(state->look.light_count, 1) - 1);
    set_picture(state, params, state->follows_window);
}

void vw_state_params(const vw_state *state, const fl_params *base, fl_params *out_params)
{
    *out_params = *base;
    out_params->camera = state->look.camera;
    out_params->depth_limit = state->look.depth_limit;
    out_params->light_samples = state->look.light_samples;
    if (state->look.light_count > 0 && state->look.light_count == base->light_count)
        out_params->lights = state->look.lights;
    if (state->follows_window) {
        out_params->width = state->picture_width;
        out_params->height = state->picture_height;
    }
    uint32_t region[4];
    if (vw_state_region(state, region)) {
        out_params->crop_x += region[0];
        out_params->crop_y += region[1];
        out_params->crop_w = region[2];
        out_params->crop_h = region[3];
    }
}

bool vw_state_region(const vw_state *state, uint32_t out_rect[4])
{
    const uint32_t *r = state->look.region;
    if (r[2] == 0 || r[0] >= state->picture_width || r[1] >= state->picture_height)
        return false;
    memcpy(out_rect, r, 4 * sizeof *r);
    out_rect[2] = fl_min_u32(r[2], state->picture_width - r[0]);
    out_rect[3] = fl_min_u32(r[3], state->picture_height - r[1]);
    return true;
}

void vw_state_origin(const vw_state *state, const fl_params *params, double *out_x, double *out_y)
{
    uint32_t region[4] = {0};
    vw_state_region(state, region);
    *out_x = (double)params->crop_x - (double)region[0];
    *out_y = (double)params->crop_y - (double)region[1];
}

void vw_state_say(vw_state *state, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(state->message, sizeof state->message, format, args);
    va_end(args);
    state->message_until_ms = state->now_ms + VW_MESSAGE_MS;
}

const char *vw_state_message(const vw_state *state)
{
    return state->now_ms < state->message_until_ms ? state->message : NULL;
}

vw_dirty vw_state_focus_at(vw_state *state, double depth)
{
    if (!(depth > 0.0) || !isfinite(depth)) {
        vw_state_say(state, "nothing there to focus on");
        return VW_DIRTY_WINDOW;
    }
    state->look.camera.focus = depth;
    state->rack_left = 0;
    state->rack_focus[0] = state->rack_focus[1];
    state->rack_focus[1] = depth;
    vw_state_say(state, "focus at %.4g", depth);
    return state->look.camera.aperture > 0.0 ? VW_DIRTY_CAMERA : VW_DIRTY_WINDOW;
}

vw_dirty vw_state_resize(vw_state *state, uint32_t width, uint32_t height)
{
    if (width == 0 || height == 0)
        return VW_DIRTY_NONE;
    bool is_same = width == state->width && height == state->height;
    state->width = width;
    state->height = height;
    if (!state->follows_window || is_same) {
        fit_picture(state, state->picture_width, state->picture_height);
        return VW_DIRTY_WINDOW;
    }
    fit_picture(state, fl_min_u32(width, FL_SIDE_MAX), fl_min_u32(height, FL_SIDE_MAX));
    return (vw_dirty)(VW_DIRTY_WINDOW | VW_DIRTY_CAMERA);
}

vw_dirty vw_state_rack_step(vw_state *state)
{
    FL_ASSERT(state->rack_left > 0);
    state->rack_left--;
    double t = 1.0 - (double)state->rack_left / (double)state->rack_ticks;
    /* Slow at both ends, and by factors, as a hand turns the ring. */
    double eased = t * t * (3.0 - 2.0 * t);
    double octaves = fl_d_log2(state->rack_to) - fl_d_log2(state->rack_from);
    state->look.camera.focus =
        state->rack_left ? state->rack_from * fl_d_exp2(eased * octaves) : state->rack_to;
    return state->look.camera.aperture > 0.0 ? VW_DIRTY_CAMERA : VW_DIRTY_WINDOW;
}
