/* SPDX-License-Identifier: MIT
 *
 * What the rows of the command table do and show: the handlers and the formatters of live values.
 * Private to the table.
 */
#ifndef VW_COMMAND_RUN_H
#define VW_COMMAND_RUN_H

#include "viewer/command.h"

typedef vw_dirty vw_run_fn(vw_state *state, vw_amount amount);
typedef void vw_value_fn(const vw_state *state, char out[VW_VALUE_MAX]);

/* Moving. */
vw_run_fn vw_run_forward, vw_run_strafe, vw_run_rise, vw_run_speed, vw_run_look, vw_run_pan,
    vw_run_dolly;
vw_run_fn vw_run_orbit, vw_run_orbit_at, vw_run_reset, vw_run_print, vw_run_paste, vw_run_undo, vw_run_redo,
    vw_run_recall, vw_run_store;
/* Lens. */
vw_run_fn vw_run_focus, vw_run_focus_at, vw_run_focus_through, vw_run_assist, vw_run_rack,
    vw_run_rack_time, vw_run_aperture, vw_run_lens, vw_run_fov;
/* Picture. */
vw_run_fn vw_run_region, vw_run_light_samples, vw_run_sample_cap, vw_run_depth, vw_run_exposure, vw_run_pause;
vw_run_fn vw_run_layer, vw_run_pin, vw_run_compare, vw_run_flip, vw_run_inspect;
/* Understand. */
vw_run_fn vw_run_rays, vw_run_noise, vw_run_light_auto, vw_run_needs, vw_run_trade, vw_run_stress;
vw_run_fn vw_run_light_select, vw_run_light_switch, vw_run_light_intensity, vw_run_light_warmth,
    vw_run_light_radius, vw_run_light_side, vw_run_light_rise, vw_run_light_push;
/* Program. */
vw_run_fn vw_run_help, vw_run_hud, vw_run_snapshot, vw_run_reload, vw_run_escape, vw_run_quit;

vw_value_fn vw_value_speed, vw_value_mode, vw_value_focus, vw_value_aperture, vw_value_fov;
vw_value_fn vw_value_light_samples, vw_value_sample_cap, vw_value_depth, vw_value_exposure,
    vw_value_pause;
vw_value_fn vw_value_light;
vw_value_fn vw_value_hud, vw_value_assist, vw_value_rack, vw_value_layer, vw_value_compare,
    vw_value_inspect;
vw_value_fn vw_value_noise, vw_value_light_auto, vw_value_needs, vw_value_trade, vw_value_stress;

#endif
