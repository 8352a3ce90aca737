/* SPDX-License-Identifier: MIT
 *
 * Handlers of the scene's lights: which one, how bright, what colour, how large, where.
 */
#include <stdio.h>

#include "viewer/camera.h"
#include "viewer/command_run.h"

#define INTENSITY_STEP  1.189207115002721 /* A quarter stop: 2^(1/4). */
#define INTENSITY_LEAST 1e-6
#define INTENSITY_MOST  1e9
#define WARMTH_STEP     1.05 /* Red over blue changes by its square. */
#define RADIUS_STEP     1.189207115002721
#define RADIUS_FIRST    0.05 /* Of a point-like disk, in scene scales. */
#define NUDGE           0.02 /* Scene scales. */

static fl_light *selected(vw_state *state)
{
    if (state->look.light_count > 0)
        return &state->look.lights[state->light];
    vw_state_say(state, "no light to edit: the scene has none, or more than %d", VW_LIGHTS_MAX);
    return NULL;
}

static bool is_off(const vw_state *state)
{
    fl_vec3 c = state->look.lights[state->light].color, lit = state->look.lit_colors[state->light];
    return c.x == 0.0 && c.y == 0.0 && c.z == 0.0 && (lit.x != 0.0 || lit.y != 0.0 || lit.z != 0.0);
}

static void describe(const vw_state *state, char *out, size_t out_bytes)
{
    const fl_light *light = &state->look.lights[state->light];
    fl_vec3 c = state->look.lit_colors[state->light];
    char radius[32] = "", line[24] = "";
    if (light->kind == FL_LIGHT_DISK)
        snprintf(radius, sizeof radius, ", radius %.3g", light->radius);
    if (light->loc.line)
        snprintf(line, sizeof line, ", line %u", light->loc.line);
    snprintf(out, out_bytes, "light %u/%u%s: %.3g %.3g %.3g%s%s", state->light + 1,
             state->look.light_count, line, c.x, c.y, c.z, is_off(state) ? ", off" : "", radius);
}

static void say_light(vw_state *state)
{
    char text[VW_MESSAGE_MAX];
    describe(state, text, sizeof text);
    vw_state_say(state, "%s", text);
}

vw_dirty vw_run_light_select(vw_state *state, vw_amount amount)
{
    uint32_t count = state->look.light_count;
    if (!selected(state))
        return VW_DIRTY_WINDOW;
    state->light = (state->light + (amount.x > 0.0 ? 1 : count - 1)) % count;
    say_light(state);
    return VW_DIRTY_WINDOW;
}

static vw_dirty set_color(vw_state *state, fl_vec3 color, bool is_on)
{
    state->look.lit_colors[state->light] = color;
    state->look.lights[state->light].color = is_on ? color : fl_v3(0.0, 0.0, 0.0);
    say_light(state);
    return VW_DIRTY_LIGHT;
}

vw_dirty vw_run_light_switch(vw_state *state, vw_amount amount)
{
    (void)amount;
    if (!selected(state))
        return VW_DIRTY_WINDOW;
    return set_color(state, state->look.lit_colors[state->light], is_off(state));
}

vw_dirty vw_run_light_intensity(vw_state *state, vw_amount amount)
{
    if (!selected(state))
        return VW_DIRTY_WINDOW;
    fl_vec3 color = state->look.lit_colors[state->light];
    color = fl_v3_scale(color, amount.x > 0.0 ? INTENSITY_STEP : 1.0 / INTENSITY_STEP);
    double most = fl_max(fabs(color.x), fl_max(fabs(color.y), fabs(color.z)));
    /* A scene's own light may be outside: it may come back. */
    if (amount.x > 0.0 ? !(most > 0.0 && most < INTENSITY_MOST) : !(most > INTENSITY_LEAST)) {
        vw_state_say(state, "the light is at its bound");
        return VW_DIRTY_WINDOW;
    }
    return set_color(state, color, true);
}

/* Warmer or cooler at the same luminance. */
vw_dirty vw_run_light_warmth(vw_state *state, vw_amount amount)
{
    if (!selected(state))
        return VW_DIRTY_WINDOW;
    static const fl_vec3 luminance = {0.2126, 0.7152, 0.0722};
    fl_vec3 before = state->look.lit_colors[state->light], color = before;
    double step = amount.x > 0.0 ? WARMTH_STEP : 1.0 / WARMTH_STEP;
    color.x *= step;
    color.z /= step;
    double y = fl_v3_dot(color, luminance);
    if (y > 0.0)
        color = fl_v3_scale(color, fl_v3_dot(before, luminance) / y);
    return set_color(state, color, true);
}

vw_dirty vw_run_light_radius(vw_state *state, vw_amount amount)
{
    fl_light *light = selected(state);
    if (!light)
        return VW_DIRTY_WINDOW;
    if (light->kind != FL_LIGHT_DISK) {
        vw_state_say(state, "only disk lights have a radius");
        return VW_DIRTY_WINDOW;
    }
    double radius = light->radius * (amount.x > 0.0 ? RADIUS_STEP : 1.0 / RADIUS_STEP);
    if (light->radius == 0.0 && amount.x > 0.0)
        radius = RADIUS_FIRST * state->scene_scale;
    if (radius < 1e-4 * state->scene_scale)
        radius = 0.0;
    if (radius == light->radius || radius > 1e3 * state->scene_scale) {
        vw_state_say(state, "the radius is at its bound, %.3g", light->radius);
        return VW_DIRTY_WINDOW;
    }
    light->radius = radius;
    say_light(state);
    return VW_DIRTY_CAMERA;
}

/* Along the picture's axes: what the eye sees is what moves. A directional light turns. */
static vw_dirty nudge(vw_state *state, double right, double up, double away)
{
    fl_light *light = selected(state);
    if (!light)
        return VW_DIRTY_WINDOW;
    const fl_camera *camera = &state->look.camera;
    fl_vec3 forward = fl_v3_normalize(camera->direction);
    fl_vec3 across = fl_v3_normalize(fl_v3_cross(forward, camera->up));
    fl_vec3 step = fl_v3_add(
        fl_v3_scale(across, right),
        fl_v3_add(fl_v3_scale(fl_v3_cross(across, forward), up), fl_v3_scale(forward, away)));
    if (light->kind == FL_LIGHT_DIRECTIONAL) {
        light->direction = fl_v3_normalize(fl_v3_sub(light->direction, fl_v3_scale(step, NUDGE)));
        vw_state_say(state, "light %u/%u shines along %.3g %.3g %.3g", state->light + 1,
                     state->look.light_count, light->direction.x, light->direction.y,
                     light->direction.z);
        return VW_DIRTY_CAMERA;
    }
    light->position = fl_v3_add(light->position, fl_v3_scale(step, NUDGE * state->scene_scale));
    vw_state_say(state, "light %u/%u at %.4g %.4g %.4g", state->light + 1, state->look.light_count,
                 light->position.x, light->position.y, light->position.z);
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_light_side(vw_state *state, vw_amount amount)
{
    return nudge(state, amount.x, 0.0, 0.0);
}

vw_dirty vw_run_light_rise(vw_state *state, vw_amount amount)
{
    return nudge(state, 0.0, amount.x, 0.0);
}

vw_dirty vw_run_light_push(vw_state *state, vw_amount amount)
{
    return nudge(state, 0.0, 0.0, amount.x);
}

void vw_value_light(const vw_state *state, char out[VW_VALUE_MAX])
{
    if (state->look.light_count == 0) {
        snprintf(out, VW_VALUE_MAX, "none");
        return;
    }
    snprintf(out, VW_VALUE_MAX, "%u/%u%s", state->light + 1, state->look.light_count,
             is_off(state) ? " off" : "");
}
