/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private: one ray against a mesh, through its hierarchy or all of its packs.
 *
 * The triangle test is watertight [Woop, Benthin, Wald 2013]: corners are translated to the ray's
 * origin and sheared so that the ray is an axis; signs of three edge functions decide. In float,
 * plain multiply and subtract never gets a sign wrong, it can only yield 0. So floats decide where
 * no edge is 0, and doubles where one is: products of floats are exact in double, hence so are the
 * signs, and two triangles agree about their common edge. Either way t, a mean of the corners'
 * depths with weights of one sign, lies within the triangle's own depth however thin it is. That is
 * what lets boxes cull (FL_BOX_PAD).
 *
 * The test is written once for FL_W lanes, which are eight triangles of one ray or eight rays of
 * one triangle: the same bits.
 */
#ifndef FL_KERNEL_ISECT_MESH_H
#define FL_KERNEL_ISECT_MESH_H

#include "core/kernel_isect.h"

/** What the triangle test needs of one ray, and what it found. */
typedef struct needle {
    float o[3], d_z;
    float shear_x, shear_y, inverse_z; /* Along kx and ky for a step along kz; 1 / d there. */
    int kx, ky, kz;                    /* kz: the axis in which d is largest. */
    float t;                           /* Nearest so far; for any-hit -1 once blocked. */
    uint32_t object, prim;
    uint32_t source_object, source_prim;
} needle;

/** A single ray in the space of a mesh. */
typedef struct ray {
    float enter_o[3], leave_o[3], inverse[3]; /* As in slabs. */
    int down[3];                              /* 1 where the ray descends. */
    needle n;
} ray;

/** What all rays that meet a mesh have in common. */
typedef struct mesh_target {
    const fl_tri_mesh *mesh;
    uint32_t object; /* Of all faces, unless they have their own. */
    fl_isect_counts *counts;
} mesh_target;

/* --- Triangles ------------------------------------------------------------------------------- */

/** Sheared corners of FL_W pairs of ray and triangle. */
typedef struct corners {
    fl_wf x[3], y[3], z[3];
} corners;

FL_INLINE fl_wf least_of(fl_wf a, fl_wf b, fl_wf c)
{
    return fl_wf_min(fl_wf_min(a, b), c);
}

FL_INLINE fl_wf most_of(fl_wf a, fl_wf b, fl_wf c)
{
    return fl_wf_max(fl_wf_max(a, b), c);
}

/* From so many packs on they do not fit into the second cache. */
enum { STEADY_PACKS = 2048 };

/* Lanes that are hit for certain, with t; lanes for doubles to decide in *out_doubt: where an edge
 * is 0, or the area of a size that squares badly. NaN corners are neither.
 * is_steady: t is found for nothing rather than asking first whether a line through any triangle is
 * there, which half of the leaves say yes to: where a pack comes from afar the guess is wrong often
 * and found out late, and until then nothing of the next ray is done. */
FL_INLINE fl_wm corners_meet(const corners *c, fl_wf inverse_z, fl_wf *out_t, fl_wm *out_doubt,
                             const bool is_steady)
{
    fl_wf u = c->x[2] * c->y[1] - c->y[2] * c->x[1];
    fl_wf v = c->x[0] * c->y[2] - c->y[0] * c->x[2];
    fl_wf w = c->x[1] * c->y[0] - c->y[1] * c->x[0];
    fl_wf least = least_of(u, v, w), most = most_of(u, v, w);
    fl_wm maybe = (least >= 0.0f) | (most <= 0.0f);
    *out_doubt = fl_wi_set(0);
    *out_t = fl_wf_set(-1.0f);
    if (!(is_steady && FL_W > 1) && !fl_wm_any(maybe))
        return maybe;
    fl_wf area = u + v + w, size = fl_wf_abs(area), share = 1.0f / area;
    fl_wm sure = ((least > 0.0f) | (most < 0.0f)) & (size > 1e-25f) & (size < 1e25f);
    fl_wf depth = u * share * c->z[0] + v * share * c->z[1] + w * share * c->z[2];
    *out_t = depth * inverse_z;
    *out_doubt = maybe & ~sure;
    return sure;
}

/* Decide one pair in doubles. */
static __attribute__((noinline)) bool corners_decide(const corners *c, int i, float d_z,
                                                     float *out_t)
{
    double x[3], y[3], z[3];
    for (int k = 0; k < 3; k++) {
        x[k] = (double)c->x[k][i];
        y[k] = (double)c->y[k][i];
        z[k] = (double)c->z[k][i];
    }
    double u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2],
           w = x[1] * y[0] - y[1] * x[0];
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0))
        return false;
    double area = u + v + w;
    if (area == 0.0)
        return false;
    *out_t = (float)((u * z[0] + v * z[1] + w * z[2]) / (area * (double)d_z));
    return *out_t > 0.0f;
}

FL_INLINE void needle_accept(needle *r, const mesh_target *target, float t, uint32_t face,
                             const bool is_any)
{
    if (!(t <= r->t))
        return;
    uint32_t object = target->object, prim = face;
    if (target->mesh->face_object) {
        object = target->mesh->face_object[face];
        prim = 0;
    }
    if (object == r->source_object && prim == r->source_prim)
        return;
    if (is_any) {
        if (t < r->t)
            r->t = -1.0f;
        return;
    }
    if (t < r->t || object < r->object || (object == r->object && prim < r->prim)) {
        r->t = t;
        r->object = object;
        r->prim = prim;
    }
}

/* Corners of FL_W triangles of a pack, from place `at` on, for one ray; o along kx, ky and kz. */
FL_INLINE corners pack_corners(const fl_tri_pack *pack, int at, const int k[3], const float o[3],
                               float shear_x, float shear_y)
{
    corners c;
    for (int n = 0; n < 3; n++) {
        c.z[n] = fl_wf_load(&pack->corner[n][k[2]][at]) - o[2];
        c.x[n] = fl_wf_load(&pack->corner[n][k[0]][at]) - o[0] - shear_x * c.z[n];
        c.y[n] = fl_wf_load(&pack->corner[n][k[1]][at]) - o[1] - shear_y * c.z[n];
    }
    return c;
}

/* Enter the hits among FL_W triangles: lanes `sure` at t, lanes `doubts` if doubles say so. */
FL_INLINE void needle_accept_all(needle *r, const mesh_target *target, const corners *c,
                                 const uint32_t *face, fl_wf t, uint32_t sure, uint32_t doubts,
                                 const bool is_any)
{
    for (; sure; sure &= sure - 1) {
        int i = __builtin_ctz(sure);
        needle_accept(r, target, t[i], face[i], is_any);
    }
    if (!doubts)
        return;
    const corners kept = *c; /* Which leaves c itself in registers. */
    for (; doubts; doubts &= doubts - 1) {
        int i = __builtin_ctz(doubts);
        float exact;
        if (corners_decide(&kept, i, r->d_z, &exact))
            needle_accept(r, target, exact, face[i], is_any);
    }
}

/** One ray against the eight triangles of a pack. */
FL_INLINE void needle_meet_pack(needle *r, const mesh_target *target, const fl_tri_pack *pack,
                                const bool is_any)
{
    const int k[3] = {r->kx, r->ky, r->kz};
    const float o[3] = {r->o[r->kx], r->o[r->ky], r->o[r->kz]};
    for (int at = 0; at < 8; at += FL_W) {
        fl_wf t;
        fl_wm doubt;
        corners c = pack_corners(pack, at, k, o, r->shear_x, r->shear_y);
        fl_wm sure = corners_meet(&c, fl_wf_set(r->inverse_z), &t, &doubt, false);
        uint32_t lanes = fl_wm_bits(sure & (t > 0.0f) & (t <= r->t));
        needle_accept_all(r, target, &c, pack->face + at, t, lanes, fl_wm_bits(doubt), is_any);
    }
}

/* --- Hierarchy of boxes ---------------------------------------------------------------------- */

typedef struct visit {
    float near;
    uint32_t child;
} visit;

/* Children of `node` that the ray may meet at 0 < t <= r->t, as bits; distances to out_near. */
FL_INLINE uint32_t ray_meet_node(const ray *r, const fl_bvh_node *node, float out_near[8])
{
    uint32_t bits = 0;
    for (int at = 0; at < 8; at += FL_W) {
        fl_wf near = fl_wf_set(0.0f), far = fl_wf_set(r->n.t);
        for (int a = 0; a < 3; a++) {
            const float *enter = node->plane[2 * a + r->down[a]];
            const float *leave = node->plane[2 * a + 1 - r->down[a]];
            near = fl_wf_max((fl_wf_load(enter + at) - r->enter_o[a]) * r->inverse[a], near);
            far = fl_wf_min((fl_wf_load(leave + at) - r->leave_o[a]) * r->inverse[a], far);
        }
        fl_wf_store(out_near + at, near);
        bits |= fl_wm_bits(near <= far) << at;
    }
    return bits;
}

/* Push the children of `bits`, farthest first; returns the new height. */
static inline uint32_t push_sorted(visit *stack, uint32_t height, const fl_bvh_node *node,
                                   const float near[8], uint32_t bits)
{
    uint32_t base = height;
    for (; bits; bits &= bits - 1) {
        int k = __builtin_ctz(bits);
        uint32_t i = height++;
        for (; i > base && stack[i - 1].near < near[k]; i--)
            stack[i] = stack[i - 1];
        stack[i] = (visit){near[k], node->child[k]};
    }
    return height;
}

static inline void ray_walk_bvh(ray *r, const mesh_target *target, const bool is_any)
{
    const fl_bvh *bvh = target->mesh->bvh;
    const fl_tri_pack *packs = target->mesh->packs;
    visit stack[FL_BVH_STACK_MAX];
    uint32_t height = 0, child = 0;
    for (;;) {
        if (child & FL_BVH_LEAF) {
            target->counts->primitive_tests += FL_BVH_LEAF_COUNT(child);
            needle_meet_pack(&r->n, target, &packs[FL_BVH_LEAF_INDEX(child)], is_any);
            if (is_any && r->n.t < 0.0f)
                return;
        } else {
            _Alignas(32) float near[8];
            const fl_bvh_node *node = &bvh->nodes[child];
            uint32_t bits = ray_meet_node(r, node, near);
            target->counts->node_visits++;
            if (bits && (bits & (bits - 1)) == 0) {
                child = node->child[__builtin_ctz(bits)];
                continue;
            }
            height = push_sorted(stack, height, node, near, bits);
        }
        do {
            if (height == 0)
                return;
            child = stack[--height].child;
        } while (stack[height].near > r->n.t);
    }
}

/* --- All of them ----------------------------------------------------------------------------- */

static void ray_walk_all(ray *r, const mesh_target *target, const bool is_any)
{
    const fl_tri_mesh *mesh = target->mesh;
    for (uint32_t k = 0; k < mesh->pack_count; k++) {
        needle_meet_pack(&r->n, target, &mesh->packs[k], is_any);
        if (is_any && r->n.t < 0.0f)
            break;
    }
    target->counts->primitive_tests += mesh->face_count;
}

FL_INLINE void ray_walk(ray *r, const mesh_target *target, const bool is_any)
{
    if (target->mesh->bvh)
        ray_walk_bvh(r, target, is_any);
    else
        ray_walk_all(r, target, is_any);
}

#endif
