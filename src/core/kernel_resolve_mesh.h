/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private to kernel_resolve.c: FL_WD rays and their winners in double, and triangles.
 */
#ifndef FL_KERNEL_RESOLVE_MESH_H
#define FL_KERNEL_RESOLVE_MESH_H

#include "core/stream.h"
#include "core/wide_math.h"

/* An origin moved by this many roundings of its largest coordinate, and of the size of what its
 * neighbours are made of, is on the side it was moved to for every test. A test's own error is at
 * most 14 such roundings (geometry.h). */
#define OFFSET_ROUNDINGS 16.0

/** FL_WD vectors. The functions are those of vec.h, operation for operation, but for
 * vec_unit: fl_v3_normalize scales first. */
typedef struct vec {
    fl_wd x, y, z;
} vec;

/** Rays of the stream whose winners are solved alike, wherever they stand in it. */
typedef struct run {
    const fl_geometry *geometry;
    fl_isect_context *context;
    const fl_instance *instance; /**< NULL: baked. */
    const uint32_t *ray;         /**< Ascending. */
    uint32_t count;
    bool needs_uv;
} run;

/** FL_WD rays, everything in the space of the winner. */
typedef struct block {
    uint32_t at[FL_WD]; /**< In the stream; what is missing at the end of a run repeats its last. */
    bool is_dense;      /**< at[] are neighbours. */
    bool has_one_entry;
    vec o, d; /**< Exactly transformed. */
    fl_wd t;  /**< As the float test found it. */
    uint32_t entry[FL_WD], prim[FL_WD];
} block;

typedef struct solution {
    vec p, ng, ns;
    fl_wd u, v;
    fl_wd size;
    double roundings; /**< offset = roundings * epsilon * (|p| and size, in world units). */
} solution;

FL_INLINE vec vec_add(vec a, vec b)
{
    return (vec){a.x + b.x, a.y + b.y, a.z + b.z};
}

FL_INLINE vec vec_sub(vec a, vec b)
{
    return (vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

FL_INLINE vec vec_scale(vec a, fl_wd s)
{
    return (vec){a.x * s, a.y * s, a.z * s};
}

FL_INLINE vec vec_mad(vec a, vec b, fl_wd s)
{
    return (vec){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

FL_INLINE fl_wd vec_dot(vec a, vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

FL_INLINE vec vec_cross(vec a, vec b)
{
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

FL_INLINE fl_wd vec_max_abs(vec a)
{
    return fl_wd_max(fl_wd_max(fl_wd_abs(a.x), fl_wd_abs(a.y)), fl_wd_abs(a.z));
}

FL_INLINE vec vec_select(fl_wl m, vec a, vec b)
{
    return (vec){fl_wd_select(m, a.x, b.x), fl_wd_select(m, a.y, b.y), fl_wd_select(m, a.z, b.z)};
}

FL_INLINE bool is_any(fl_wl m)
{
    return fl_wl_bits(m) != 0;
}

/** Unit vectors; where the squares of lengths leave the range of doubles, with care. 0 stays 0. */
FL_INLINE vec vec_unit(vec a)
{
    fl_wd square = vec_dot(a, a);
    fl_wl is_odd = ~((fl_wl)(square > 1e-200) & (fl_wl)(square < 1e200));
    vec unit = vec_scale(a, 1.0 / fl_wd_sqrt(square));
    if (!is_any(is_odd))
        return unit;
    fl_wd scale = vec_max_abs(a);
    vec near = {a.x / scale, a.y / scale, a.z / scale};
    near = vec_scale(near, 1.0 / fl_wd_sqrt(vec_dot(near, near)));
    near = vec_select((fl_wl)(scale > 0.0), near, a);
    return vec_select(is_odd, near, unit);
}

/* --- Triangles ------------------------------------------------------------------------------- */

/* The corners of each lane's triangle in an array of xyz. */
FL_INLINE void gather_corners(const float *xyz, const uint32_t *index, const uint32_t face[FL_WD],
                              vec out[3])
{
    for (int k = 0; k < 3; k++) {
        uint32_t at[FL_WD];
        for (int l = 0; l < FL_WD; l++)
            at[l] = 3 * index[3 * (size_t)face[l] + (size_t)k];
        out[k] = (vec){fl_wd_gather_floats(xyz, at), fl_wd_gather_floats(xyz + 1, at),
                       fl_wd_gather_floats(xyz + 2, at)};
    }
}

/* Weights of the corners where the ray meets the triangle's plane, pushed back into the triangle:
 * at least 0, sum 1. */
FL_INLINE void corner_weights(const vec corner[3], const block *b, fl_wd out_weight[3])
{
    const vec d = b->d;
    fl_wd size = vec_max_abs(d), x[3], y[3], zero = fl_wd_set(0.0);
    /* kz is the axis in which d is largest, kx and ky come after it. */
    fl_wl z_is_x = (fl_wl)(fl_wd_abs(d.x) == size);
    fl_wl z_is_y = (fl_wl)(fl_wd_abs(d.y) == size) & ~z_is_x;
#define ALONG(v, a, b, c) fl_wd_select(z_is_x, (v).a, fl_wd_select(z_is_y, (v).b, (v).c))
    fl_wd inverse = 1.0 / ALONG(d, x, y, z);
    fl_wd shear_x = ALONG(d, y, z, x) * inverse, shear_y = ALONG(d, z, x, y) * inverse;
    for (int k = 0; k < 3; k++) {
        vec v = vec_sub(corner[k], b->o);
        fl_wd depth = ALONG(v, x, y, z);
        x[k] = ALONG(v, y, z, x) - shear_x * depth;
        y[k] = ALONG(v, z, x, y) - shear_y * depth;
    }
#undef ALONG
    fl_wd weight[3] = {x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2],
                       x[1] * y[0] - y[1] * x[0]};
    fl_wl is_back = (fl_wl)(weight[0] + weight[1] + weight[2] < zero);
    fl_wd sign = fl_wd_select(is_back, fl_wd_set(-1.0), fl_wd_set(1.0)), sum = zero;
    for (int k = 0; k < 3; k++) {
        weight[k] = fl_wd_max(sign * weight[k], zero);
        sum += weight[k];
    }
    fl_wd share = 1.0 / sum;
    for (int k = 0; k < 3; k++)
        out_weight[k] = fl_wd_select((fl_wl)(sum > zero), weight[k] * share, fl_wd_set(1.0 / 3.0));
}

FL_INLINE vec blend(const vec v[3], const fl_wd weight[3])
{
    return vec_mad(vec_mad(vec_scale(v[0], weight[0]), v[1], weight[1]), v[2], weight[2]);
}

FL_INLINE void mesh_normal(const fl_tri_mesh *mesh, const uint32_t face[FL_WD],
                           const fl_wd weight[3], solution *s)
{
    vec normal[3];
    fl_wl is_smooth = (fl_wl)(fl_wd_set(0.0) == 0.0);
    gather_corners(mesh->normal, mesh->normal_index, face, normal);
    for (int k = 0; k < 3; k++)
        is_smooth &= (fl_wl)(vec_max_abs(normal[k]) > 0.0);
    vec ns = vec_unit(blend(normal, weight));
    is_smooth &= (fl_wl)(vec_max_abs(ns) > 0.0);
    s->ns = vec_select(is_smooth, ns, s->ns);
}

FL_INLINE void mesh_uv(const fl_tri_mesh *mesh, const uint32_t face[FL_WD], const fl_wd weight[3],
                       solution *s)
{
    for (int l = 0; l < FL_WD; l++) {
        const uint32_t *at = mesh->uv_index + 3 * (size_t)face[l];
        if (at[0] == FL_NONE || at[1] == FL_NONE || at[2] == FL_NONE)
            continue;
        for (int k = 0; k < 3; k++) {
            s->u[l] += weight[k][l] * (double)mesh->uv[2 * (size_t)at[k]];
            s->v[l] += weight[k][l] * (double)mesh->uv[2 * (size_t)at[k] + 1];
        }
    }
}

FL_INLINE void solve_triangles(const run *r, const block *b, solution *s)
{
    const fl_tri_mesh *mesh = &r->geometry->meshes[r->instance->index];
    const uint32_t *face = mesh->face_object ? b->entry : b->prim;
    vec corner[3];
    fl_wd weight[3];
    gather_corners(mesh->position, mesh->index, face, corner);
    corner_weights(corner, b, weight);
    vec n = vec_unit(vec_cross(vec_sub(corner[1], corner[0]), vec_sub(corner[2], corner[0])));
    fl_wl is_flat = ~(fl_wl)(vec_max_abs(n) > 0.0);
    if (is_any(is_flat))
        n = vec_select(is_flat, vec_scale(vec_unit(b->d), fl_wd_set(-1.0)), n);
    s->p = blend(corner, weight);
    s->ng = s->ns = n;
    if (mesh->normal)
        mesh_normal(mesh, face, weight, s);
    if (r->needs_uv && mesh->uv)
        mesh_uv(mesh, face, weight, s);
}

#endif
