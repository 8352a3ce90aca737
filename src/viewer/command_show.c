/* SPDX-License-Identifier: MIT
 *
 * Handlers of what is shown and of racking the focus.
 */
#include <stdio.h>

#include "viewer/command_run.h"
#include "viewer/input.h"

#define RACK_SECONDS_MIN 0.5
#define RACK_SECONDS_MAX 16.0

static const char *const assist_names[VW_ASSIST_COUNT] = {"off", "band", "rangefinder"};
static const char *const compare_names[VW_COMPARE_COUNT] = {"off", "wipe", "difference"};

vw_dirty vw_run_assist(vw_state *state, vw_amount amount)
{
    (void)amount;
    state->assist = (vw_assist)((state->assist + 1) % VW_ASSIST_COUNT);
    if (state->assist != VW_ASSIST_OFF && state->look.camera.aperture == 0.0)
        vw_state_say(state, "a pinhole: everything is sharp");
    else
        vw_state_say(state, "focus help: %s", assist_names[state->assist]);
    return VW_DIRTY_SHOW;
}

vw_dirty vw_run_rack(vw_state *state, vw_amount amount)
{
    (void)amount;
    double focus = state->look.camera.focus, *picked = state->rack_focus;
    if (!(picked[0] > 0.0) || !(picked[1] > 0.0) || !isfinite(focus)) {
        vw_state_say(state, "pick two points first (Shift and click)");
        return VW_DIRTY_WINDOW;
    }
    /* To whichever of the two is farther from here. */
    double up = focus > picked[0] ? focus / picked[0] : picked[0] / focus;
    double down = focus > picked[1] ? focus / picked[1] : picked[1] / focus;
    state->rack_from = focus;
    state->rack_to = up > down ? picked[0] : picked[1];
    state->rack_ticks = (uint32_t)(state->rack_seconds * VW_TICKS_PER_SECOND);
    state->rack_left = state->rack_ticks;
    return VW_DIRTY_WINDOW;
}

vw_dirty vw_run_rack_time(vw_state *state, vw_amount amount)
{
    (void)amount;
    state->rack_seconds *= 2.0;
    if (state->rack_seconds > RACK_SECONDS_MAX)
        state->rack_seconds = RACK_SECONDS_MIN;
    return VW_DIRTY_WINDOW;
}

vw_dirty vw_run_layer(vw_state *state, vw_amount amount)
{
    state->layer = (vw_layer)fl_clamp(amount.x, 0.0, VW_LAYER_COUNT - 1.0);
    return VW_DIRTY_SHOW;
}

vw_dirty vw_run_inspect(vw_state *state, vw_amount amount)
{
    (void)amount;
    state->is_inspecting = !state->is_inspecting;
    return VW_DIRTY_WINDOW;
}

vw_dirty vw_run_pin(vw_state *state, vw_amount amount)
{
    (void)state;
    (void)amount;
    return VW_DIRTY_PIN;
}

vw_dirty vw_run_compare(vw_state *state, vw_amount amount)
{
    (void)amount;
    state->compare = (vw_compare)((state->compare + 1) % VW_COMPARE_COUNT);
    vw_state_say(state, "compare: %s", compare_names[state->compare]);
    return state->compare == VW_COMPARE_OFF ? VW_DIRTY_SHOW
                                            : (vw_dirty)(VW_DIRTY_SHOW | VW_DIRTY_COMPARE);
}

vw_dirty vw_run_flip(vw_state *state, vw_amount amount)
{
    state->is_flipped = amount.x != 0.0;
    return state->is_flipped ? (vw_dirty)(VW_DIRTY_SHOW | VW_DIRTY_COMPARE) : VW_DIRTY_SHOW;
}

void vw_value_assist(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", assist_names[state->assist]);
}

void vw_value_rack(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%g s", state->rack_seconds);
}

void vw_value_layer(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", vw_layer_names[state->layer]);
}

void vw_value_compare(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", compare_names[state->compare]);
}

void vw_value_inspect(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", state->is_inspecting ? "on" : "off");
}
