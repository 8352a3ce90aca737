/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private: up to 64 rays through an octree together. Mirrored into the first octant, every
 * ray meets the octants of a cell in an order that ascending numbers respect: number k of the
 * mirrored cell is octant k ^ mirror of the true one. So rays are taken in sets with one mirror,
 * and octants pushed in descending order. Tests skip only what a single ray's test would skip.
 */
#ifndef FL_KERNEL_ISECT_OCTREE_H
#define FL_KERNEL_ISECT_OCTREE_H

#include "core/kernel_isect_leaf.h"

enum { OCTREE_RAYS_MIN = 8 }; /* Fewer go alone. */

typedef struct octant_visit {
    uint64_t lanes;
    uint32_t child;
    uint32_t octant; /* node * 8 + number of the true cell. */
    float near;      /* No ray of the beam is nearer. */
} octant_visit;

/* Numbers of mirrored octants that a beam may meet, as bits: distances of the halves along each
 * axis, put together. A beam of one ray is tested exactly as it is. */
FL_INLINE uint32_t beam_meet_octants(const packet *p, const fl_octree_node *node, uint32_t mirror,
                                     const bool is_single, float out_near[8])
{
    float near[3][2], far[3][2];
    uint32_t bits = 0;
    for (int a = 0; a < 3; a++)
        for (int h = 0; h < 2; h++) {
            int flip = mirror >> a & 1u ? 3 : 0; /* 3 - k is k ^ 3. */
            float enter = node->plane[a][h ^ flip] - p->beam_enter[a];
            float leave = node->plane[a][(h + 2) ^ flip] - p->beam_leave[a];
            near[a][h] = enter * p->beam_least[a];
            far[a][h] = leave * p->beam_least[a];
            if (is_single)
                continue;
            float enter_most = enter * p->beam_most[a], leave_most = leave * p->beam_most[a];
            near[a][h] = enter_most < near[a][h] ? enter_most : near[a][h];
            far[a][h] = leave_most > far[a][h] ? leave_most : far[a][h];
        }
    for (int at = 0; at < 8; at += FL_W) {
        fl_wf in = fl_wf_set(0.0f), out = fl_wf_set(INFINITY);
        for (int a = 0; a < 3; a++) {
            fl_wm upper = ((fl_wi_iota() + at) & fl_wi_set(1 << a)) != 0;
            in = fl_wf_max(fl_wf_select(upper, fl_wf_set(near[a][1]), fl_wf_set(near[a][0])), in);
            out = fl_wf_min(fl_wf_select(upper, fl_wf_set(far[a][1]), fl_wf_set(far[a][0])), out);
        }
        fl_wf_store(out_near + at, in);
        bits |= fl_wm_bits(in <= out) << at;
    }
    return bits;
}

/* Rays that may meet an octant before what they hit so far. */
static inline uint64_t groups_meet_octant(const packet *p, uint64_t lanes, const fl_octree *tree,
                                          uint32_t octant, uint32_t mirror)
{
    const fl_octree_node *node = &tree->nodes[octant / 8];
    fl_wf enter[3], leave[3];
    for (int a = 0; a < 3; a++) {
        uint32_t h = (octant ^ mirror) >> a & 1u, flip = mirror >> a & 1u ? 3 : 0;
        enter[a] = fl_wf_set(node->plane[a][h ^ flip]);
        leave[a] = fl_wf_set(node->plane[a][(h + 2) ^ flip]);
    }
    return groups_meet_planes(p, lanes, enter, leave);
}

FL_INLINE void packet_meet_cell(packet *p, uint64_t lanes, const mesh_target *target,
                                uint32_t child, const bool is_any)
{
    const fl_octree_leaf *leaf = &target->mesh->octree->leaves[child & ~FL_BVH_LEAF];
    for (uint32_t at = 0; at < leaf->count; at += 8) {
        uint32_t count = fl_min_u32(leaf->count - at, 8);
        packet_meet_pack(p, lanes, target,
                         FL_BVH_LEAF | (count - 1) << 28 | (leaf->first_pack + at / 8), is_any);
    }
}

/* Rays with one mirror. */
FL_INLINE void mirrored_walk(packet *p, uint32_t mirror, const mesh_target *target,
                             const bool is_single, const bool is_any)
{
    const fl_octree *tree = target->mesh->octree;
    octant_visit stack[FL_OCTREE_STACK_MAX + 1];
    uint32_t height = 0, any = (uint32_t)__builtin_ctzll(p->lanes);
    stack[height++] = (octant_visit){p->lanes, tree->root, FL_NONE, 0.0f};
    while (height > 0) {
        octant_visit v = stack[--height];
        if (is_single)
            v.lanes = p->t[any] >= v.near ? v.lanes : 0;
        else if (v.octant != FL_NONE)
            v.lanes = groups_meet_octant(p, v.lanes, tree, v.octant, mirror);
        if (!v.lanes)
            continue;
        if (v.child & FL_BVH_LEAF) {
            packet_meet_cell(p, v.lanes, target, v.child, is_any);
            continue;
        }
        const fl_octree_node *node = &tree->nodes[v.child];
        target->counts->node_visits += (uint32_t)__builtin_popcountll(v.lanes);
        _Alignas(32) float near[8];
        for (uint32_t bits = beam_meet_octants(p, node, mirror, is_single, near); bits;) {
            uint32_t k = 31u - (uint32_t)__builtin_clz(bits), octant = k ^ mirror;
            bits &= ~(1u << k);
            if (node->child[octant] != FL_NONE)
                stack[height++] =
                    (octant_visit){v.lanes, node->child[octant], v.child * 8 + octant, near[k]};
        }
    }
}

/* Ray i as a beam of its own. */
static inline void packet_single_beam(packet *p, uint32_t i)
{
    p->lanes = (uint64_t)1 << i;
    p->has_beam = p->has_one_origin = false; /* So it meets eight triangles at a time. */
    for (int a = 0; a < 3; a++) {
        p->beam_enter[a] = p->enter_o[a][i];
        p->beam_leave[a] = p->leave_o[a][i];
        p->beam_least[a] = p->beam_most[a] = p->inverse[a][i];
    }
}

/* All rays, in sets that go the same way and have their largest component along the same axis. */
FL_INLINE void packet_walk_octree(packet *p, const mesh_target *target, const bool is_any)
{
    for (uint64_t left = p->lanes; left; left &= ~p->lanes) {
        uint32_t any = (uint32_t)__builtin_ctzll(left), mirror = 0;
        const uint64_t kinds[5] = {p->down[0], p->down[1], p->down[2], p->z_is_1, p->z_is_2};
        p->lanes = left;
        for (uint32_t k = 0; k < 5; k++) {
            bool is_set = kinds[k] >> any & 1u;
            p->lanes &= is_set ? kinds[k] : ~kinds[k];
            mirror |= (uint32_t)(is_set && k < 3) << k;
        }
        if (__builtin_popcountll(p->lanes) < OCTREE_RAYS_MIN) {
            packet_single_beam(p, any);
            mirrored_walk(p, mirror, target, true, is_any);
        } else {
            packet_find_beam(p);
            mirrored_walk(p, mirror, target, false, is_any);
        }
    }
}

#endif
