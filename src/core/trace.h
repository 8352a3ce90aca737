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

enum { FL_TRACE_BOUNCES_MAX = 16 };

/** What is seen in a mirror or through glass: the end of one path along specular branches. */
typedef struct fl_trace_seen {
    fl_vec3 position;   /**< World. */
    double first_depth; /**< Of the first surface, along the viewing axis. */
    double length;      /**< Of the whole path. */
    uint32_t object;    /**< FL_NONE: the path left the scene. */
    uint32_t bounces;   /**< 0: the first surface is neither mirror nor glass. */
    uint32_t refracted; /**< Bit per bounce: 1 through, 0 reflected. */
} fl_trace_seen;

/** The focus distance that makes sharp what is seen at (x_px, y_px) along the heavier specular
 * branch of each surface: the one for which four rays from the edge of the lens, on the same path,
 * end most tightly together. For a flat mirror that is the unfolded distance, for a ball that of
 * its image. *out_focus 0: nothing is seen there, or no focus gathers it. False: out of memory. Any
 * thread. Some 800 rays. */
bool fl_trace_focus(const fl_frame *frame, double x_px, double y_px, double *out_focus,
                    fl_trace_seen *out_seen);

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

/** The same for streams that the caller has laid out (stream.h), in the space of the geometry:
 * nothing is copied or allocated. Adds the work to *counts unless that is NULL. Any thread. */
void fl_trace_stream_nearest(const fl_compiled *scene, const fl_rays *rays, fl_hits *out_hits,
                             fl_isect_counts *counts);
void fl_trace_stream_any(const fl_compiled *scene, const fl_rays *rays, uint32_t *out_blocked,
                         fl_isect_counts *counts);

#endif
