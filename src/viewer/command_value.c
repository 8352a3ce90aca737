/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "viewer/command_run.h"

void vw_value_speed(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "\303\227%g", state->speed);
}

void vw_value_mode(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", state->mode == VW_MODE_ORBIT ? "orbit" : "fly");
}

void vw_value_focus(const vw_state *state, char out[VW_VALUE_MAX])
{
    if (isinf(state->look.camera.focus))
        snprintf(out, VW_VALUE_MAX, "\342\210\236");
    else
        snprintf(out, VW_VALUE_MAX, "%.4g", state->look.camera.focus);
}

void vw_value_aperture(const vw_state *state, char out[VW_VALUE_MAX])
{
    if (state->look.camera.aperture > 0.0)
        snprintf(out, VW_VALUE_MAX, "%.3g", state->look.camera.aperture);
    else
        snprintf(out, VW_VALUE_MAX, "pinhole");
}

void vw_value_fov(const vw_state *state, char out[VW_VALUE_MAX])
{
    if (state->look.camera.projection == FL_ORTHOGRAPHIC)
        snprintf(out, VW_VALUE_MAX, "%.4g high", state->look.camera.ortho_size);
    else
        snprintf(out, VW_VALUE_MAX, "%.3g\302\260", state->look.camera.fov_deg);
}

void vw_value_light_samples(const vw_state *state, char out[VW_VALUE_MAX])
{
    uint32_t own = state->look.light_samples;
    snprintf(out, VW_VALUE_MAX, "%u", own ? own : state->scene_light_samples);
}

void vw_value_sample_cap(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%u", state->look.sample_cap);
}

void vw_value_depth(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%u", state->look.depth_limit);
}

void vw_value_exposure(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%+.2f EV", state->look.camera.exposure_ev);
}

void vw_value_pause(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", state->is_paused ? "paused" : "running");
}

void vw_value_hud(const vw_state *state, char out[VW_VALUE_MAX])
{
    snprintf(out, VW_VALUE_MAX, "%s", state->is_hud_shown ? "shown" : "hidden");
}
