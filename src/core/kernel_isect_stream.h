/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private: up to 32 rays down a mesh's hierarchy together, each node carrying the set of
 * rays that may meet it. The tests are those of a single ray, one by one, so hits are the same; but
 * they are independent of each other, where a single ray must wait for each node before it knows
 * the next, and a node is fetched once for all.
 */
#ifndef FL_KERNEL_ISECT_STREAM_H
#define FL_KERNEL_ISECT_STREAM_H

#include "core/kernel_isect_mesh.h"

enum {
    STREAM_RAYS = 32,
    STREAM_RAYS_MIN = 4, /* Fewer go alone. */
    BEAM_RAYS_MIN = 8    /* Fewer are tested one by one. */
};

typedef struct stream_visit {
    float near; /* Of the nearest of its rays. */
    uint32_t child, lanes;
} stream_visit;

/* Which of `lanes` may meet which child: out_lanes[k] of child k, and the least distance among
 * them. */
FL_INLINE void stream_meet_node(const ray *rays, const stream_visit *v, const fl_bvh_node *node,
                                uint32_t out_lanes[8], float out_near[8])
{
    fl_wu met[8 / FL_W];
    fl_wf least[8 / FL_W];
    for (int h = 0; h < 8 / FL_W; h++) {
        met[h] = fl_wu_set(0);
        least[h] = fl_wf_set(INFINITY);
    }
    for (uint32_t lanes = v->lanes; lanes; lanes &= lanes - 1) {
        int i = __builtin_ctz(lanes);
        const ray *r = &rays[i];
        if (v->near > r->t)
            continue;
        for (int h = 0; h < 8 / FL_W; h++) {
            fl_wf near = fl_wf_set(0.0f), far = fl_wf_set(r->t);
            for (int a = 0; a < 3; a++) {
                const float *enter = node->plane[2 * a + r->down[a]] + h * FL_W;
                const float *leave = node->plane[2 * a + 1 - r->down[a]] + h * FL_W;
                near = fl_wf_max((fl_wf_load(enter) - r->enter_o[a]) * r->inverse[a], near);
                far = fl_wf_min((fl_wf_load(leave) - r->leave_o[a]) * r->inverse[a], far);
            }
            fl_wm meets = near <= far;
            met[h] |= (fl_wu)meets & fl_wu_set(1u << i);
            least[h] = fl_wf_min(fl_wf_select(meets, near, least[h]), least[h]);
        }
    }
    for (int h = 0; h < 8 / FL_W; h++) {
        fl_wu_store(out_lanes + h * FL_W, met[h]);
        fl_wf_store(out_near + h * FL_W, least[h]);
    }
}

/* Rays of one origin that go the same way along each axis: between the least and the greatest
 * inverse direction. */
typedef struct beam {
    float enter_o[3], leave_o[3], least[3], most[3];
    int down[3];
} beam;

/* False: they are not such rays. */
static inline bool beam_of(const ray *rays, uint32_t lanes, beam *out)
{
    const ray *first = &rays[__builtin_ctz(lanes)];
    for (int a = 0; a < 3; a++) {
        out->enter_o[a] = first->enter_o[a];
        out->leave_o[a] = first->leave_o[a];
        out->least[a] = out->most[a] = first->inverse[a];
        out->down[a] = first->down[a];
    }
    for (; lanes; lanes &= lanes - 1) {
        const ray *r = &rays[__builtin_ctz(lanes)];
        for (int a = 0; a < 3; a++) {
            if (r->enter_o[a] != first->enter_o[a] || r->down[a] != first->down[a])
                return false;
            out->least[a] = r->inverse[a] < out->least[a] ? r->inverse[a] : out->least[a];
            out->most[a] = r->inverse[a] > out->most[a] ? r->inverse[a] : out->most[a];
        }
    }
    return true;
}

/* Which children any ray of the beam may meet, all its rays then counting as meeting them. Rounding
 * is monotone, so each ray's own distances lie between those of the beam. */
FL_INLINE void beam_meet_node(const beam *b, uint32_t lanes, const fl_bvh_node *node,
                              uint32_t out_lanes[8], float out_near[8])
{
    for (int at = 0; at < 8; at += FL_W) {
        fl_wf near = fl_wf_set(0.0f), far = fl_wf_set(INFINITY);
        for (int a = 0; a < 3; a++) {
            fl_wf enter = fl_wf_load(node->plane[2 * a + b->down[a]] + at) - b->enter_o[a];
            fl_wf leave = fl_wf_load(node->plane[2 * a + 1 - b->down[a]] + at) - b->leave_o[a];
            near = fl_wf_max(fl_wf_min(enter * b->least[a], enter * b->most[a]), near);
            far = fl_wf_min(fl_wf_max(leave * b->least[a], leave * b->most[a]), far);
        }
        fl_wu_store(out_lanes + at, (fl_wu)(near <= far) & lanes);
        fl_wf_store(out_near + at, near);
    }
}

/* Push the children that any ray meets, farthest first; returns the new height. */
FL_INLINE uint32_t stream_push(stream_visit *stack, uint32_t height, const fl_bvh_node *node,
                               const uint32_t lanes[8], const float near[8])
{
    uint32_t base = height;
    for (int k = 0; k < 8; k++) {
        if (!lanes[k])
            continue;
        uint32_t i = height++;
        for (; i > base && stack[i - 1].near < near[k]; i--)
            stack[i] = stack[i - 1];
        stack[i] = (stream_visit){near[k], node->child[k], lanes[k]};
    }
    return height;
}

/* Rays of a visit that have found nothing nearer than it. */
static inline uint32_t lanes_beyond(const ray *rays, const stream_visit *v)
{
    uint32_t beyond = 0;
    for (uint32_t lanes = v->lanes; lanes; lanes &= lanes - 1) {
        int i = __builtin_ctz(lanes);
        beyond |= (uint32_t)(rays[i].t >= v->near) << i;
    }
    return beyond;
}

/** Rays `lanes` of `rays`. */
static inline void stream_walk(ray *rays, uint32_t lanes, const mesh_target *target,
                               const bool is_any)
{
    const fl_bvh *bvh = target->mesh->bvh;
    stream_visit stack[FL_BVH_STACK_MAX];
    uint64_t node_visits = 0, primitive_tests = 0;
    beam b;
    bool is_beam = beam_of(rays, lanes, &b);
    uint32_t alive = lanes, height = 0;
    stack[height++] = (stream_visit){0.0f, 0, lanes};
    while (height > 0) {
        stream_visit v = stack[--height];
        if (is_any)
            v.lanes &= alive;
        if (!(v.child & FL_BVH_LEAF)) {
            _Alignas(32) float near[8];
            _Alignas(32) uint32_t met[8];
            const fl_bvh_node *node = &bvh->nodes[v.child];
            uint32_t count = (uint32_t)__builtin_popcount(v.lanes);
            if (is_beam && !node->has_leaf && count >= BEAM_RAYS_MIN) {
                v.lanes = lanes_beyond(rays, &v);
                if (!v.lanes)
                    continue;
                beam_meet_node(&b, v.lanes, node, met, near);
            } else {
                stream_meet_node(rays, &v, node, met, near);
            }
            height = stream_push(stack, height, node, met, near);
            node_visits += count;
            continue;
        }
        const fl_tri_pack *pack = &target->mesh->packs[FL_BVH_LEAF_INDEX(v.child)];
        for (; v.lanes; v.lanes &= v.lanes - 1) {
            int i = __builtin_ctz(v.lanes);
            if (v.near > rays[i].t)
                continue;
            primitive_tests += FL_BVH_LEAF_COUNT(v.child);
            ray_meet_pack(&rays[i], target, pack, is_any);
            if (is_any && rays[i].t < 0.0f)
                alive &= ~(1u << i);
        }
    }
    target->counts->node_visits += node_visits;
    target->counts->primitive_tests += primitive_tests;
}

/** Rays `lanes` of the chunk, given in the mesh's space by o and d, with their slabs in
 * boxes[enter, leave, inverse per axis], against a mesh. */
FL_INLINE void chunk_meet_mesh(chunk *c, uint64_t lanes, const float *const o[3],
                               const float *const d[3], float (*const boxes)[CHUNK_RAYS],
                               const mesh_target *target, const bool is_any)
{
    ray rays[STREAM_RAYS];
    for (uint32_t first = 0; first < CHUNK_RAYS; first += STREAM_RAYS) {
        uint32_t part = (uint32_t)(lanes >> first);
        for (uint32_t left = part; left; left &= left - 1) {
            uint32_t k = (uint32_t)__builtin_ctz(left), i = first + k;
            ray *r = &rays[k];
            for (int a = 0; a < 3; a++) {
                r->enter_o[a] = boxes[a][i];
                r->leave_o[a] = boxes[3 + a][i];
                r->inverse[a] = boxes[6 + a][i];
            }
            ray_init(r, (float[]){o[0][i], o[1][i], o[2][i]}, (float[]){d[0][i], d[1][i], d[2][i]});
            r->t = c->t[i];
            r->object = c->object[i];
            r->prim = c->prim[i];
            r->source_object = c->source_object[i];
            r->source_prim = c->source_prim[i];
        }
        if (target->mesh->bvh && __builtin_popcount(part) >= STREAM_RAYS_MIN)
            stream_walk(rays, part, target, is_any);
        else
            for (uint32_t left = part; left; left &= left - 1)
                ray_walk(&rays[__builtin_ctz(left)], target, is_any);
        for (; part; part &= part - 1) {
            uint32_t k = (uint32_t)__builtin_ctz(part), i = first + k;
            c->t[i] = rays[k].t;
            c->object[i] = rays[k].object;
            c->prim[i] = rays[k].prim;
        }
    }
}

#endif
