/* SPDX-License-Identifier: MIT
 *
 * Layer 3: surfaces of revolution: a planar profile of Bezier segments turned about the y axis
 * (docs/revolution.md). Everything here is in object space and double, whatever the renderer's
 * precision; the same bits with every instruction set.
 *
 * A ray is o + u d with d of any length above 0. A hit is a root with u_min < u < u_max. Rays that
 * lie in the surface, or touch it without crossing, count as misses there.
 */
#ifndef FL_REVOLVE_H
#define FL_REVOLVE_H

#include "core/arena.h"
#include "core/cpu.h"
#include "core/diag.h"
#include "core/scene.h"
#include "core/vec.h"

/** Newton's iteration from so many starts a segment, the baseline, which misses some hits; 0: the
 * certified solver, which finds the nearest root, always. */
typedef uint32_t fl_revolve_solver;

enum { FL_REVOLVE_ROBUST = 0, FL_REVOLVE_NEWTON = 8, FL_REVOLVE_MAX_STARTS = 64 };

enum { FL_REVOLVE_MAX_DEGREE = 15, FL_REVOLVE_MAX_SEGMENTS = 10000, FL_REVOLVE_PACKET = 8 };

/** A preprocessed profile: immutable, lives in the arena it was built in. */
typedef struct fl_revolve fl_revolve;

/** Where a ray meets the surface. */
typedef struct fl_revolve_hit {
    double u;
    double t;         /**< Parameter within the segment, in [0, 1]. */
    uint32_t segment; /**< Of the profile as given. */
    uint32_t sheet;   /**< For fl_revolve_resolve alone: the piece. */
    double local;     /**< Likewise: parameter within the piece. */
} fl_revolve_hit;

/** The surface at a hit. */
typedef struct fl_revolve_point {
    fl_vec3
        position; /**< On the surface: radius and height come from the profile, not from the ray. */
    fl_vec3
        normal; /**< Unit, finite at poles and cusps; outward for a profile that bounds a solid. */
    double u,
        v; /**< Texture: u in (0, 1] runs against the angle from +x to +z, v in [0, 1] along y. */
    double scale; /**< Size S of the object. A leaving ray starts 16 e S along the normal, e the
                     unit roundoff of the type its origin is stored in. */
} fl_revolve_point;

/** Eight rays sharing a profile, structure of arrays; lanes outside a mask may hold anything. */
typedef struct fl_revolve_packet {
    double ox[FL_REVOLVE_PACKET], oy[FL_REVOLVE_PACKET], oz[FL_REVOLVE_PACKET];
    double dx[FL_REVOLVE_PACKET], dy[FL_REVOLVE_PACKET], dz[FL_REVOLVE_PACKET];
    double u_min[FL_REVOLVE_PACKET], u_max[FL_REVOLVE_PACKET];
} fl_revolve_packet;

/** Split the profile into pieces the solver can certify. Copies what it needs. NULL after an error
 * in `diags`: a degree or a number of segments out of range, a coordinate that is not finite, a
 * size outside 1e-200 to 1e200, no area at all, no memory. O(segments * degree^3). */
fl_revolve *fl_revolve_build(fl_arena *arena, const fl_profile *profile, fl_diags *diags);

/** Use the code for `isa` (which fl_cpu_has) from now on; build chose the best. Not while others
 * use it. */
void fl_revolve_set_isa(fl_revolve *revolve, fl_isa isa);

/** Bounds of the surface, rounded outward. */
fl_box fl_revolve_bounds(const fl_revolve *revolve);

/** Pieces after preprocessing, for reports. */
uint32_t fl_revolve_piece_count(const fl_revolve *revolve);

/** The nearest hit with u in (u_min, u_max). False: none, and *out_hit is untouched. Any thread. */
bool fl_revolve_nearest(const fl_revolve *revolve, const double o[3], const double d[3],
                        double u_min, double u_max, fl_revolve_solver solver,
                        fl_revolve_hit *out_hit);

/** Whether anything is hit with u in (u_min, u_max); returns at the first root found. Any thread.
 */
bool fl_revolve_any(const fl_revolve *revolve, const double o[3], const double d[3], double u_min,
                    double u_max, fl_revolve_solver solver);

/** Lanes of `mask` whose ray may meet the bounding cylinder of the surface: one test for the whole
 * packet. */
uint32_t fl_revolve_reject8(const fl_revolve *revolve, const fl_revolve_packet *rays,
                            uint32_t mask);

/** fl_revolve_nearest for the lanes of `mask`: the lanes hit, whose out_hits[] are set; others are
 * untouched. The same answers, bit for bit, as one by one. */
uint32_t fl_revolve_nearest8(const fl_revolve *revolve, const fl_revolve_packet *rays,
                             uint32_t mask, fl_revolve_solver solver,
                             fl_revolve_hit out_hits[FL_REVOLVE_PACKET]);

/** fl_revolve_any for the lanes of `mask`: the lanes blocked. */
uint32_t fl_revolve_any8(const fl_revolve *revolve, const fl_revolve_packet *rays, uint32_t mask,
                         fl_revolve_solver solver);

/** The surface at a hit of the ray that found it. Any thread. */
void fl_revolve_resolve(const fl_revolve *revolve, const double o[3], const double d[3],
                        const fl_revolve_hit *hit, fl_revolve_point *out_point);

#endif
