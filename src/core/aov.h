/* SPDX-License-Identifier: MIT
 *
 * Layer 8: what stands behind the pixels besides light: one float picture of what the ray through
 * each pixel's centre and one point of the lens meets first. No noise, no anti-aliasing: pixel by
 * pixel the truth about one ray.
 */
#ifndef FL_AOV_H
#define FL_AOV_H

#include "core/frame.h"

/** Three floats a pixel; where nothing is hit: 0, depth +infinity. */
typedef enum fl_aov {
    FL_AOV_DEPTH,  /**< Distance along the viewing axis, scene units, in all three: what `focus`
                      means. */
    FL_AOV_NORMAL, /**< Shading normal towards the viewer, world space, unit. */
    FL_AOV_ALBEDO, /**< Diffuse colour, texture included, linear. */
    FL_AOV_OBJECT, /**< Number of the object in the scene's order from 1; of the primitive; 0. */
    FL_AOV_SHAPE,  /**< Albedo lit from the eye: enough to recognise things. Linear. */
    FL_AOV_COST,   /**< Of sample 0 with the real lens and lights: rays, nodes visited, primitives
                        tested. Slower by what a sample costs. */
    FL_AOV_BRANCH, /**< Of sample 0 likewise: kind of the ray that adds most to it, fl_ray_kind + 1,
                      0: all is black; its level; the greatest level reached. */
    FL_AOV_COUNT
} fl_aov;

/** Short names: "depth", "normal", "albedo", "object", "shape", "cost", "branch". */
extern const char *const fl_aov_names[FL_AOV_COUNT];

/** Every step-th pixel from (x0, y0) on, counted in the rendered part; the pixel in the middle of
 * its step x step cell, at the edges the last one, stands for all of it. */
typedef struct fl_aov_grid {
    uint32_t x0, y0, step, width, height; /**< width, height: values, not pixels. */
} fl_aov_grid;

/** Evaluate; out_values: 3 * width * height floats. `lens`: the point of the aperture through which
 * the rays go, in units of its radius; NULL: its centre (a pinhole). Any thread. False: out of
 * memory. */
bool fl_aov_eval(const fl_frame *frame, fl_aov kind, const double lens[2], const fl_aov_grid *grid,
                 float *out_values);

#endif
