/* SPDX-License-Identifier: MIT
 *
 * Layer 4: one ray at a time in double, for `--precision double`: what the float kernels round away
 * shows as the difference. The same rules (decisions 3, 4, 8, 13) on the doubles of the geometry;
 * vertices of meshes are floats there and are taken as they are. Structures are those of the
 * kernels: their boxes are wide enough for floats, so for doubles too.
 *
 * Nearest is least (t as double, object, prim). Any thread.
 */
#ifndef FL_DOUBLE_TRACE_H
#define FL_DOUBLE_TRACE_H

#include "core/stream.h"

/** o + t d with 0 < t < t_max, in the space of fl_geometry; d has any length. */
typedef struct fl_double_ray {
    fl_vec3 o, d;
    double t_max;
    uint32_t source_object, source_prim; /**< FL_NONE: starts on nothing. */
} fl_double_ray;

typedef struct fl_double_hit {
    double t;
    uint32_t object, prim;
    union {
        double weight[3];       /**< Triangles: of the corners, >= 0, sum 1. */
        fl_revolve_hit revolve; /**< Surfaces of revolution. */
    } at;
} fl_double_hit;

/** The surface at a hit, world space relative to the geometry's origin. */
typedef struct fl_double_surface {
    fl_vec3 p, ng, ns; /**< As fl_surface. */
    double u, v;
    double offset; /**< A leaving ray starts this far along +-ng: 16 roundings of a double. */
} fl_double_surface;

/** False: nothing is hit. */
bool fl_double_nearest(const fl_geometry *geometry, const fl_double_ray *ray,
                       fl_isect_context *context, fl_double_hit *out_hit);
/** Whether anything is hit. */
bool fl_double_any(const fl_geometry *geometry, const fl_double_ray *ray,
                   fl_isect_context *context);

/** Solve the surface at a hit of the ray. needs_uv: u and v are wanted, else they are 0. O(1). */
void fl_double_resolve(const fl_geometry *geometry, const fl_double_ray *ray,
                       const fl_double_hit *hit, bool needs_uv, fl_double_surface *out_surface);

/** The ray in the space of an instance; *instance NULL: the ray itself. */
fl_double_ray fl_double_ray_to(const fl_instance *instance, const fl_double_ray *ray);

#endif
