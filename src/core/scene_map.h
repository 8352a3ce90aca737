/* SPDX-License-Identifier: MIT
 *
 * Layer 2: a whole scene at another size and place: what the stability suite and the viewer's
 * stress lens do to it. The picture stays the same.
 */
#ifndef FL_SCENE_MAP_H
#define FL_SCENE_MAP_H

#include "core/scene.h"

/** Replace every point p of the scene, in place, by scale * p + offset: objects, transforms,
 * curves, meshes (copied: others may share them), camera and views with focus, aperture and width
 * of the view, lights with radius and attenuation, textures of planes. Directions, angles and
 * colours stay.
 *
 * `scale` is above 0 and finite, `offset` finite. With a power of two and no offset every number is
 * scaled exactly and the film is the same bytes, as long as no float overflows or underflows;
 * otherwise it differs by rounding. With an offset, meshes, surfaces of revolution and textured
 * planes that had no transform get one.
 *
 * The scene must not be in use by anyone else. False, the scene unchanged in what it shows or half
 * mapped and fit only to be destroyed: out of memory, or scale or offset out of range. O(scene). */
bool fl_scene_map(fl_scene *scene, double scale, fl_vec3 offset, fl_diags *diags);

#endif
