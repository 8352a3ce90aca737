/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private: up to 64 rays down a mesh's hierarchy together, each node carrying the set of
 * rays that may meet it. At every node the cheapest of three tests is used:
 *
 *   beam    all rays as one interval of origins and directions against eight children: rays that go
 *           the same way along each axis. Its children are tested again, exactly, when their turn
 *           comes - except inner ones where all rays have one origin, for which the interval is
 *           nearly exact as long as boxes are larger than the beam;
 *   group   FL_W rays against one box, or against one triangle after the other;
 *   ray     one ray against eight boxes, or against the eight triangles of a leaf.
 *
 * A test skips only what a single ray's test would skip, and the triangle test is the same in each,
 * so hits are the same. Many rays together keep the processor busy where a single ray must wait for
 * each node before it knows the next, and a node is fetched once for all.
 */
#ifndef FL_KERNEL_ISECT_STREAM_H
#define FL_KERNEL_ISECT_STREAM_H

#include "core/kernel_isect_leaf.h"

enum {
    PACKET_RAYS_MIN = 4, /* Fewer go alone. */
    GROUP_RAYS_MIN = 6   /* Fewer rays in a group of eight are tested one by one. */
};

/* --- Boxes ----------------------------------------------------------------------------------- */

typedef struct packet_visit {
    uint64_t lanes;
    uint32_t child;
    uint32_t box; /* Of the child, for an exact test: node * 8 + place; FL_NONE: was tested. */
    float near;   /* No ray is nearer. 0 for any hit, which takes them as they come. */
} packet_visit;

/* Children of `node` that any ray may meet, as bits. */
FL_INLINE uint32_t beam_meet_node(const packet *p, const fl_bvh_node *node, float out_near[8])
{
    uint32_t bits = 0, any = (uint32_t)__builtin_ctzll(p->lanes);
    for (int at = 0; at < 8; at += FL_W) {
        fl_wf near = fl_wf_set(0.0f), far = fl_wf_set(INFINITY);
        for (int a = 0; a < 3; a++) {
            int down = (int)(p->down[a] >> any & 1u);
            fl_wf enter = fl_wf_load(node->plane[2 * a + down] + at) - p->beam_enter[a];
            fl_wf leave = fl_wf_load(node->plane[2 * a + 1 - down] + at) - p->beam_leave[a];
            near = fl_wf_max(fl_wf_min(enter * p->beam_least[a], enter * p->beam_most[a]), near);
            far = fl_wf_min(fl_wf_max(leave * p->beam_least[a], leave * p->beam_most[a]), far);
        }
        fl_wf_store(out_near + at, near);
        bits |= fl_wm_bits(near <= far) << at;
    }
    return bits;
}

/* Rays of a beam that may meet box `box`. */
static inline uint64_t groups_meet_box(const packet *p, uint64_t lanes, const fl_bvh *bvh,
                                       uint32_t box)
{
    const fl_bvh_node *node = &bvh->nodes[box / 8];
    uint32_t k = box % 8, any = (uint32_t)__builtin_ctzll(p->lanes);
    fl_wf enter[3], leave[3];
    for (int a = 0; a < 3; a++) {
        int down = (int)(p->down[a] >> any & 1u);
        enter[a] = fl_wf_set(node->plane[2 * a + down][k]);
        leave[a] = fl_wf_set(node->plane[2 * a + 1 - down][k]);
    }
    return groups_meet_planes(p, lanes, enter, leave);
}

/* Rays to which something at `near` could matter. */
static inline uint64_t groups_beyond(const packet *p, uint64_t lanes, float near)
{
    uint64_t beyond = 0;
    for (uint64_t left = lanes; left;) {
        uint32_t i = (uint32_t)__builtin_ctzll(left) / FL_W * FL_W;
        left &= ~((uint64_t)FL_W_ALL << i);
        beyond |= (uint64_t)fl_wm_bits(fl_wf_load(p->t + i) >= near) << i;
    }
    return beyond & lanes;
}

/* Rays [first, first + 32) of `lanes`, one by one: bits of those that may meet each child are added
 * to out_lanes, the least distances lowered to theirs (which any hit does without). Those that go
 * the same way find the planes in registers. */
FL_INLINE void rays_meet_node(const packet *p, uint32_t lanes, uint32_t first,
                              const fl_bvh_node *node, uint32_t out_lanes[8], float out_near[8],
                              const bool is_any)
{
    while (lanes) {
        uint32_t same = lanes, one = first + (uint32_t)__builtin_ctz(lanes);
        if (!p->is_alike)
            same &= (uint32_t)(packet_alike(p, one) >> first);
        lanes &= ~same;
        size_t down[3];
        for (int a = 0; a < 3; a++)
            down[a] = p->down[a] >> one & 1u;
        for (int h = 0; h < 8; h += FL_W) {
            fl_wf enter[3], leave[3], least = fl_wf_load(out_near + h);
            fl_wu met = fl_wu_load(out_lanes + h);
            for (int a = 0; a < 3; a++) {
                enter[a] = fl_wf_load(node->plane[2 * a] + h + 8 * down[a]);
                leave[a] = fl_wf_load(node->plane[2 * a] + h + 8 - 8 * down[a]);
            }
            for (uint32_t left = same; left; left &= left - 1) {
                uint32_t k = (uint32_t)__builtin_ctz(left), i = first + k;
                fl_wf near = fl_wf_set(0.0f), far = fl_wf_set(p->t[i]);
                for (int a = 0; a < 3; a++) {
                    fl_wf inverse = fl_wf_set(p->inverse[a][i]);
                    near = fl_wf_max((enter[a] - p->enter_o[a][i]) * inverse, near);
                    far = fl_wf_min((leave[a] - p->leave_o[a][i]) * inverse, far);
                }
                fl_wm meets = near <= far;
                met |= (fl_wu)meets & fl_wu_set(1u << k);
                if (!is_any)
                    least = fl_wf_min(fl_wf_select(meets, near, least), least);
            }
            fl_wu_store(out_lanes + h, met);
            if (!is_any)
                fl_wf_store(out_near + h, least);
        }
    }
}

/* What a visit will read, on its way from memory while others take their turn. Leaves of a mesh are
 * packs. */
FL_INLINE void packet_fetch(const fl_bvh *bvh, const fl_tri_pack *packs, uint32_t child)
{
    const char *first;
    if (!(child & FL_BVH_LEAF))
        first = (const char *)&bvh->nodes[child];
    else if (packs)
        first = (const char *)&packs[FL_BVH_LEAF_INDEX(child)];
    else
        return;
    for (int line = 0; line < (child & FL_BVH_LEAF ? 5 : 4); line++)
        __builtin_prefetch(first + 64 * line);
}

/* Add a visit in order of distance, the nearest on top; places below `base` stay. */
FL_INLINE uint32_t packet_push(packet_visit *stack, uint32_t base, uint32_t height, packet_visit v)
{
    uint32_t i = height;
    for (; i > base && stack[i - 1].near < v.near; i--)
        stack[i] = stack[i - 1];
    stack[i] = v;
    return height + 1;
}

FL_INLINE uint32_t packet_push_beam(const packet *p, uint64_t lanes, uint32_t index,
                                    const fl_bvh *bvh, const fl_tri_pack *packs,
                                    packet_visit *stack, uint32_t height, const bool is_any)
{
    const fl_bvh_node *node = &bvh->nodes[index];
    _Alignas(32) float near[8];
    uint32_t base = height;
    for (uint32_t bits = beam_meet_node(p, node, near); bits; bits &= bits - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(bits);
        packet_visit v = {lanes, node->child[k], index * 8 + k, is_any ? 0.0f : near[k]};
        packet_fetch(bvh, packs, v.child);
        height = packet_push(stack, base, height, v);
    }
    return height;
}

FL_INLINE uint32_t packet_push_rays(const packet *p, uint64_t lanes, uint32_t index,
                                    const fl_bvh *bvh, const fl_tri_pack *packs,
                                    packet_visit *stack, uint32_t height, const bool is_any)
{
    const fl_bvh_node *node = &bvh->nodes[index];
    _Alignas(32) float near[8];
    _Alignas(32) uint32_t met[2][8] = {{0}, {0}};
    uint32_t base = height;
    for (int k = 0; k < 8; k++)
        near[k] = is_any ? 0.0f : INFINITY;
    if ((uint32_t)lanes)
        rays_meet_node(p, (uint32_t)lanes, 0, node, met[0], near, is_any);
    if ((uint32_t)(lanes >> 32))
        rays_meet_node(p, (uint32_t)(lanes >> 32), 32, node, met[1], near, is_any);
    uint32_t bits = 0;
    for (int h = 0; h < 8; h += FL_W)
        bits |= fl_wm_bits((fl_wm)((fl_wu_load(met[0] + h) | fl_wu_load(met[1] + h)) != 0)) << h;
    for (; bits; bits &= bits - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(bits);
        uint64_t both = met[0][k] | (uint64_t)met[1][k] << 32;
        packet_fetch(bvh, packs, node->child[k]);
        height = packet_push(stack, base, height,
                             (packet_visit){both, node->child[k], FL_NONE, near[k]});
    }
    return height;
}

/* --- The walk -------------------------------------------------------------------------------- */

static inline uint32_t group_count(uint64_t lanes)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < CHUNK_RAYS; i += 8)
        count += (lanes >> i & 255u) != 0;
    return count;
}

/* What is done with the rays that come to a leaf. For any hit it adds to packet.blocked. */
typedef void packet_leaf(packet *p, uint64_t lanes, const void *context, uint32_t child);

/* Returns the number of node visits by rays. `leaf` is known where this is inlined. */
FL_INLINE uint64_t packet_walk(packet *p, const fl_bvh *bvh, const fl_tri_pack *packs,
                               packet_leaf *leaf, const void *context, const bool is_any)
{
    packet_visit stack[FL_BVH_STACK_MAX];
    uint32_t height = 0;
    uint64_t node_visits = 0;
    bool is_loose = false; /* Few rays of the beam passed the last exact test. */
    packet_find_beam(p);
    stack[height++] = (packet_visit){p->lanes, 0, FL_NONE, 0.0f};
    while (height > 0) {
        packet_visit v = stack[--height];
        bool is_leaf = v.child & FL_BVH_LEAF;
        if (v.box != FL_NONE && (is_leaf || is_loose || !p->has_one_origin)) {
            if (is_any)
                v.lanes &= ~p->blocked;
            uint32_t before = (uint32_t)__builtin_popcountll(v.lanes);
            v.lanes = groups_meet_box(p, v.lanes, bvh, v.box);
            is_loose = (uint32_t)__builtin_popcountll(v.lanes) * 4 < before;
        } else {
            v.lanes = is_any ? v.lanes & ~p->blocked : groups_beyond(p, v.lanes, v.near);
        }
        if (!v.lanes)
            continue;
        if (is_leaf) {
            leaf(p, v.lanes, context, v.child);
            continue;
        }
        uint32_t count = (uint32_t)__builtin_popcountll(v.lanes);
        node_visits += count;
        if (p->has_beam && FL_W > 1 && count >= GROUP_RAYS_MIN * group_count(v.lanes))
            height = packet_push_beam(p, v.lanes, v.child, bvh, packs, stack, height, is_any);
        else
            height = packet_push_rays(p, v.lanes, v.child, bvh, packs, stack, height, is_any);
    }
    return node_visits;
}

/* A few rays of the packet, each alone. */
static inline void packet_walk_alone(packet *p, const mesh_target *target, const bool is_any)
{
    for (uint64_t left = p->lanes; left; left &= left - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(left);
        ray r = {.n = packet_needle(p, i)};
        for (int a = 0; a < 3; a++) {
            r.enter_o[a] = p->enter_o[a][i];
            r.leave_o[a] = p->leave_o[a][i];
            r.inverse[a] = p->inverse[a][i];
            r.down[a] = (int)(p->down[a] >> i & 1u);
        }
        ray_walk(&r, target, is_any);
        packet_take(p, i, &r.n);
    }
}

#endif
