/* SPDX-License-Identifier: MIT
 *
 * Moving a camera by hand: flying, looking, orbiting, panning, and the depth that such motion is
 * scaled by. Pure.
 */
#ifndef VW_CAMERA_H
#define VW_CAMERA_H

#include "viewer/state.h"

#define VW_PI 3.14159265358979323846

/** Unit vectors of a camera: where it looks, what is right and what is up in its picture. */
typedef struct vw_basis {
    fl_vec3 forward, right, up;
} vw_basis;

vw_basis vw_camera_basis(const fl_camera *camera);

/** Move by so many scene units in the camera's own directions; orbiting, around and towards the
 * pivot. */
void vw_camera_fly(vw_state *state, double right, double up, double forward);

/** Turn the view by a drag of dx, dy picture pixels: flying, what was under the cursor keeps under
 * it mirrored (the view follows the mouse); orbiting, a drag across the picture's height turns by
 * 180 degrees. Never over the pole. */
void vw_camera_look(vw_state *state, double dx_px, double dy_px);

/** Shift so that what is in focus follows the cursor. */
void vw_camera_pan(vw_state *state, double dx_px, double dy_px);

/** Forward by a drag upwards: orbiting, multiplicative; flying, a picture's height is one working
 * depth. */
void vw_camera_dolly(vw_state *state, double dy_px);

/** Enter or leave orbiting. The pivot is what is in focus straight ahead, or as far as the scene's
 * middle. */
void vw_camera_toggle_orbit(vw_state *state);

/** Orbit `point`: the camera turns to it. False: it stands in it, or would look along its own up;
 * nothing changed. */
bool vw_camera_orbit_at(vw_state *state, fl_vec3 point);

/** Distance ahead at which pan and dolly are true to the cursor: the focus if it is sensible, else
 * the scene's middle. */
double vw_camera_working_depth(const vw_state *state);

#endif
