/* SPDX-License-Identifier: MIT
 *
 * Handlers of what explains the picture. Boards and the stress lens share one thread that measures:
 * one at a time.
 */
#include <stdio.h>

#include "viewer/command_run.h"

static vw_dirty toggle(vw_state *state, vw_panel panel)
{
    state->panel = state->panel == panel ? VW_PANEL_NONE : panel;
    state->stress = VW_STRESS_OFF;
    return VW_DIRTY_SHOW;
}

vw_dirty vw_run_rays(vw_state *state, vw_amount amount)
{
    double x = floor(amount.x), y = floor(amount.y);
    if (!(x >= 0.0 && y >= 0.0 && x < (double)state->picture_width &&
          y < (double)state->picture_height))
        return VW_DIRTY_WINDOW;
    bool is_again = state->panel == VW_PANEL_RAYS && state->rays_x == (uint32_t)x &&
                    state->rays_y == (uint32_t)y;
    state->rays_sample = is_again ? state->rays_sample + 1 : 0;
    state->rays_x = (uint32_t)x;
    state->rays_y = (uint32_t)y;
    state->panel = VW_PANEL_RAYS;
    return VW_DIRTY_RAYS;
}

vw_dirty vw_run_noise(vw_state *state, vw_amount amount)
{
    (void)amount;
    return toggle(state, VW_PANEL_NOISE);
}

vw_dirty vw_run_light_auto(vw_state *state, vw_amount amount)
{
    (void)amount;
    uint32_t best = fl_min_u32(state->light_samples_best, VW_LIGHT_SAMPLES_MAX);
    uint32_t own = state->look.light_samples;
    if (best == 0) {
        vw_state_say(state, "N measures what is best first");
        return VW_DIRTY_WINDOW;
    }
    vw_state_say(state, "%u light sample%s a hit, as measured", best, best == 1 ? "" : "s");
    if (best == (own ? own : state->scene_light_samples))
        return VW_DIRTY_WINDOW;
    state->look.light_samples = best;
    return VW_DIRTY_CAMERA;
}

vw_dirty vw_run_needs(vw_state *state, vw_amount amount)
{
    (void)amount;
    return toggle(state, VW_PANEL_NEEDS);
}

vw_dirty vw_run_trade(vw_state *state, vw_amount amount)
{
    (void)amount;
    return toggle(state, VW_PANEL_TRADE);
}

vw_dirty vw_run_stress(vw_state *state, vw_amount amount)
{
    int step = amount.x < 0.0 ? VW_STRESS_COUNT - 1 : 1;
    state->stress = (vw_stress)(((int)state->stress + step) % VW_STRESS_COUNT);
    if (state->panel != VW_PANEL_RAYS)
        state->panel = VW_PANEL_NONE;
    vw_state_say(state, "stress lens: %s", vw_stress_names[state->stress]);
    return VW_DIRTY_SHOW;
}

static void on_off(bool is_on, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", is_on ? "on" : "off");
}

void vw_value_noise(const vw_state *state, char out[VW_VALUE_MAX])
{
    on_off(state->panel == VW_PANEL_NOISE, out);
}

void vw_value_light_auto(const vw_state *state, char out[VW_VALUE_MAX])
{
    if (state->light_samples_best)
        snprintf(out, VW_VALUE_MAX, "%u", state->light_samples_best);
    else
        snprintf(out, VW_VALUE_MAX, "?");
}

void vw_value_needs(const vw_state *state, char out[VW_VALUE_MAX])
{
    on_off(state->panel == VW_PANEL_NEEDS, out);
}

void vw_value_trade(const vw_state *state, char out[VW_VALUE_MAX])
{
    on_off(state->panel == VW_PANEL_TRADE, out);
}

void vw_value_stress(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", vw_stress_names[state->stress]);
}
