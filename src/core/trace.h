/* SPDX-License-Identifier: MIT
 *
 * Layer 8: single rays and batches, for picking, tests and benchmarks.
 */
#ifndef FL_TRACE_H
#define FL_TRACE_H

#include "core/frame.h"
#include "core/stream.h"

typedef struct fl_pick {
    bool is_hit;
    double depth;     /**< Along the viewing axis, scene units: what `focus` means. */
    double distance;  /**< Euclidean. */
    fl_vec3 position; /**< World. */
    fl_vec3 normal;   /**< Geometric, unit, towards the viewer. */
    uint32_t object, prim;
    fl_loc loc; /**< The object's place in the scene text; valid while the compiled scene lives. */
} fl_pick;

/** What the pinhole ray through (x, y) sees; pixel coordinates of the whole picture, (0.5, 0.5) is
 * the centre of the top left pixel. False: out of memory. Any thread. O(log primitives). */
bool fl_trace_pick(const fl_frame *frame, double x_px, double y_px, fl_pick *out_pick);

/** Nearest hits of many rays (world space) by the compiled scene's kernels, in stream-sized pieces.
 * Arrays of `count`: origin and direction as xyz triples; out_* may be NULL, as may `counts`, to
 * which work is added. Misses: t infinite, object FL_NONE. Any thread. False: out of memory. */
bool fl_trace_nearest(const fl_compiled *scene, const float *origins, const float *directions,
                      size_t count, float *out_t, uint32_t *out_object, uint32_t *out_prim,
                      fl_isect_counts *counts);

/** Whether anything at all is hit before t_max (in lengths of the direction; NULL: at any
 * distance), like shadow rays. out_blocked: 1 or 0 each. False: out of memory. */
bool fl_trace_any(const fl_compiled *scene, const float *origins, const float *directions,
                  const float *t_max, size_t count, uint32_t *out_blocked, fl_isect_counts *counts);

#endif
