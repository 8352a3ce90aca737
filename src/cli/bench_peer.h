/* SPDX-License-Identifier: MIT
 *
 * What a module with another ray tracer offers to `firstlight bench --against NAME`: it is the
 * shared library firstlight-NAME.so beside the program, which exports one `bench_peer` called
 * bench_peer_module. Nothing of it is linked into the program. All calls come from one thread.
 */
#ifndef CLI_BENCH_PEER_H
#define CLI_BENCH_PEER_H

#include "core/firstlight.h"

typedef struct bench_peer {
    const char *name;
    /** Ways to trace a set of rays: names, and how many. */
    const char *const *modes;
    uint32_t mode_count;
    /** Build over triangles, which must outlive it: 3 floats a position (and one float of slack
     * behind the last), 3 indices a face. *out_seconds: of building, CPU time of this process by
     * one thread, wall time by more. is_robust: no ray slips through an edge. config: settings of
     * its own, possibly "". NULL: failed. */
    void *(*build)(const float *position, uint32_t position_count, const uint32_t *index,
                   uint32_t face_count, bool is_robust, uint32_t thread_count, const char *config,
                   double *out_seconds);
    void (*destroy)(void *scene);
    /** Lay rays out as mode `mode` likes them. NULL: out of memory. */
    void *(*load)(const fl_rays *rays, uint32_t mode, bool is_any);
    void (*unload)(void *set);
    /** Forget what was found; then trace. */
    void (*reset)(void *set);
    void (*trace)(void *scene, void *set);
    /** What ray i found: t (any hit: 0 or infinite) and the face. */
    float (*result)(const void *set, uint32_t i, uint32_t *out_face);
} bench_peer;

#endif
