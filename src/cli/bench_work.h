/* SPDX-License-Identifier: MIT
 *
 * What `firstlight bench` traces: meshes, and sets of rays of each kind in them.
 */
#ifndef CLI_BENCH_WORK_H
#define CLI_BENCH_WORK_H

#include "core/firstlight.h"

typedef enum bench_kind {
    BENCH_PRIMARY,    /**< Pinhole, one ray through the centre of each pixel. */
    BENCH_LENS,       /**< Thin lens focused on the mesh. */
    BENCH_SHADOW,     /**< From the primary hits to a random point of a disc light; any hit. */
    BENCH_MIRROR,     /**< Primary rays mirrored at the geometric normals. */
    BENCH_INCOHERENT, /**< From the primary hits, cosine distributed. */
    BENCH_KIND_COUNT
} bench_kind;

/** As in the JSON output. */
extern const char *const bench_kind_names[BENCH_KIND_COUNT];

/** Triangles in world space. Owned. */
typedef struct bench_mesh {
    char name[64];
    float *position; /**< 3 * position_count */
    uint32_t *index; /**< 3 * face_count */
    uint32_t position_count, face_count;
} bench_mesh;

/** Read a mesh, scale it to a largest side of 2 around the origin, put a square under it. */
bool bench_mesh_load(const char *path, bench_mesh *out, fl_diags *diags);

/** A sphere with bumps, of about `face_count` triangles. */
bool bench_mesh_sphere(uint32_t face_count, bench_mesh *out, fl_diags *diags);

void bench_mesh_deinit(bench_mesh *mesh);

/** The mesh as scenes have it. The caller's reference; NULL after adding an error. */
fl_mesh *bench_mesh_create(const bench_mesh *mesh, fl_diags *diags);

/** Compile the mesh as a scene of its own; NULL after adding an error. */
fl_compiled *bench_mesh_compile(const bench_mesh *mesh, const fl_compile_options *options,
                                fl_pool *pool, fl_diags *diags);

/** The same of what bench_mesh_create gave. */
fl_compiled *bench_mesh_compile_copy(fl_mesh *copy, const char *name,
                                     const fl_compile_options *options, fl_pool *pool,
                                     fl_diags *diags);

/** Rays of one kind with room for their hits, all in one piece of memory. */
typedef struct bench_rays {
    bench_kind kind;
    fl_rays rays;
    fl_hits hits;
    uint32_t *blocked;
    void *memory;
} bench_rays;

/** Generate one kind for `side` x `side` pixels, which go in blocks of 4x2 within tiles of 8x8. For
 * all but the first two kinds `primary` must hold its hits. False: out of memory. */
bool bench_rays_create(const bench_mesh *mesh, const fl_compiled *scene, bench_kind kind,
                       uint32_t side, const bench_rays *primary, bench_rays *out);
void bench_rays_deinit(bench_rays *rays);

/** Trace them once with our kernels. */
void bench_rays_trace(const fl_compiled *scene, bench_rays *rays, fl_isect_counts *counts);

#endif
