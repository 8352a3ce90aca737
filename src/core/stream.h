/* SPDX-License-Identifier: MIT
 *
 * Layer 4: streams of rays and what kernels say about them. Structure of arrays; every array holds `capacity`
 * entries, a multiple of 8, 64-byte aligned; kernels may read and write up to the next multiple of 8 beyond `count`
 * (entries there hold finite rays with t_max < 0, which hit nothing).
 */
#ifndef FL_STREAM_H
#define FL_STREAM_H

#include <stdatomic.h>

#include "core/cpu.h"
#include "core/geometry.h"

/** Rays o + t d with 0 < t < t_max, in the space of fl_geometry. d has any length. */
typedef struct fl_rays {
    uint32_t count, capacity;
    float *ox, *oy, *oz, *dx, *dy, *dz, *t_max;
    uint32_t *source_object, *source_prim; /**< Surface the ray starts on; FL_NONE: none (decision 13). */
} fl_rays;

/** Make ray i one that starts on no surface; `count` stays. */
static inline void fl_rays_set(fl_rays *rays, uint32_t i, fl_vec3 o, fl_vec3 d, float t_max)
{
    rays->ox[i] = (float)o.x;
    rays->oy[i] = (float)o.y;
    rays->oz[i] = (float)o.z;
    rays->dx[i] = (float)d.x;
    rays->dy[i] = (float)d.y;
    rays->dz[i] = (float)d.z;
    rays->t_max[i] = t_max;
    rays->source_object[i] = rays->source_prim[i] = FL_NONE;
}

/** Nearest hits, index for index with the rays. */
typedef struct fl_hits {
    float *t;
    uint32_t *object; /**< FL_NONE: nothing was hit; t is then +inf. */
    uint32_t *prim;
    fl_revolve_hit *root;    /**< Where surfaces of revolution were hit, by number of the ray in the
                                  search; NULL: not kept, `resolve` finds it again. */
    const uint32_t *root_at; /**< For `resolve`: that number, where the rays moved since. NULL: they did not. */
} fl_hits;

/** The solved surface at each hit; entries of missed rays are unspecified but finite. */
typedef struct fl_surface {
    float *px, *py, *pz;    /**< Point on the surface, re-projected, rounded from double. */
    float *ngx, *ngy, *ngz; /**< Geometric normal, unit, as the shape defines it (outward; counter-clockwise). */
    float *nsx, *nsy, *nsz; /**< Interpolated normal on the side of the geometric one, unit. */
    float *offset;          /**< Move a leaving ray's origin this far along +-ng (error bound, > 0). */
    float *u, *v;           /**< Texture coordinates of decision 11; 0 where the object has no texture. */
} fl_surface;

/** Exact work done, summed over a unit; never used to decide anything. */
typedef struct fl_isect_counts {
    uint64_t node_visits, primitive_tests;
} fl_isect_counts;

/** What a kernel needs besides the scene. One per worker; scratch is the worker's own. */
typedef struct fl_isect_context {
    fl_revolve_solver solver;
    const atomic_uint_least64_t *generation; /**< Stop soon when it differs from `wanted`; NULL: never. */
    uint64_t wanted;
    fl_isect_counts counts;
} fl_isect_context;

static inline bool fl_is_cancelled(const fl_isect_context *context)
{
    return context->generation &&
           atomic_load_explicit(context->generation, memory_order_relaxed) != context->wanted;
}

/** One instruction set's entry points. The kernels check for cancellation every 64 rays and may then return with
 *  unfinished output; callers check again before using it. Thread: any, with its own context and streams. */
typedef struct fl_isect_kernels {
    /** Nearest hit of every ray. */
    void (*nearest)(const fl_geometry *geometry, const fl_rays *rays, fl_hits *out_hits,
                    fl_isect_context *context);
    /** out_blocked[i] = 1 when anything is hit, else 0. */
    void (*any)(const fl_geometry *geometry, const fl_rays *rays, uint32_t *out_blocked,
                fl_isect_context *context);
    /** Solve the winners again in double, once, for all instruction sets the same. needs_uv: per object, whether
     *  texture coordinates are wanted (NULL: for none). */
    void (*resolve)(const fl_geometry *geometry, const fl_rays *rays, const fl_hits *hits,
                    const uint8_t *needs_uv, fl_surface *out_surface, fl_isect_context *context);
} fl_isect_kernels;

extern const fl_isect_kernels fl_isect_kernels_scalar;
#if defined(__x86_64__)
extern const fl_isect_kernels fl_isect_kernels_sse2, fl_isect_kernels_avx2;
#elif defined(__aarch64__)
extern const fl_isect_kernels fl_isect_kernels_neon;
#endif

/** Those of an instruction set that this build has. */
const fl_isect_kernels *fl_isect_kernels_of(fl_isa isa);

#endif
