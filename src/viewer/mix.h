/* SPDX-License-Identifier: MIT
 *
 * While the colour of a light is edited the picture is the sum of two: the rest, by the session's
 * own render, and that light alone at unit colour, by a second one. Radiance is linear in the
 * colour, and where rays go does not depend on it, so that a new colour is a new sum and no new ray
 * (decision 15). For the display only.
 */
#ifndef VW_MIX_H
#define VW_MIX_H

#include "viewer/state.h"

/** Zero-initialise. */
typedef struct vw_mix {
    fl_render *unit; /**< NULL: nothing is mixed. */
    uint32_t light;
    uint64_t generations[2]; /**< Of the rest and the unit; older pictures are something else. */
    float *rgb[2], *samples; /**< The two means; samples a pixel. */
    size_t pixels;           /**< Room in each. */
} vw_mix;

/** Where the light's own share of the picture cannot be told from the rest. */
bool vw_mix_is_possible(const fl_compiled *scene);

/** Begin both pictures. `params`: of the whole. `options`: of the second render, created when
 * missing. */
bool vw_mix_restart(vw_mix *mix, fl_render *rest, fl_compiled *scene, const fl_params *params,
                    uint32_t light, const fl_render_options *options, fl_diags *diags);

/** Mix what there is by `color` into mix->rgb[0]: progress.width x height, of which progress is the
 * slower of the two. False: one of them is not there yet, or no memory. */
bool vw_mix_take(vw_mix *mix, fl_render *rest, fl_vec3 color, fl_progress *out_progress);

/** Stops and joins the second render's workers. */
void vw_mix_end(vw_mix *mix);

#endif
