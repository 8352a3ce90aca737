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

#include "core/kernel_isect_mesh.h"

enum {
    PACKET_RAYS_MIN = 4, /* Fewer go alone. */
    GROUP_GAIN = 4,      /* A ray against a pack costs half as many tests of a group. */
    GROUP_RAYS_MIN = 3,  /* Fewer rays in a group of eight are tested one by one. */
    GROUPS = CHUNK_RAYS / FL_W
};

/** Rays of a chunk in the space of a mesh. Sets of rays are bits. */
typedef struct packet {
    const float *o[3], *d[3];
    float *t;
    uint32_t *object, *prim;
    const uint32_t *source_object, *source_prim;
    uint64_t lanes;           /* Rays that are here. */
    uint64_t down[3];         /* Rays that descend along each axis. */
    uint64_t z_is_1, z_is_2;  /* Rays whose kz is 1, 2. */
    bool has_beam;            /* All go the same way along each axis, and along the same kz. */
    bool has_one_origin, has_source;
    float beam_enter[3], beam_leave[3], beam_least[3], beam_most[3];
    float beam_shear[4];      /* With one origin: least and most along kx, then along ky. */
    _Alignas(64) float enter_o[3][CHUNK_RAYS], leave_o[3][CHUNK_RAYS], inverse[3][CHUNK_RAYS];
    _Alignas(64) float shear_x[CHUNK_RAYS], shear_y[CHUNK_RAYS], inverse_z[CHUNK_RAYS];
} packet;

/** FL_W rays from place i on: `b` as a bundle in the space of the mesh, `s` their slabs. */
FL_INLINE void packet_put(packet *p, uint32_t i, const bundle *b, const slabs *s, fl_wm here)
{
    fl_wf x = fl_wf_abs(b->d[0]), y = fl_wf_abs(b->d[1]), z = fl_wf_abs(b->d[2]);
    fl_wm is_2 = (z >= x) & (z >= y), is_1 = ~is_2 & (y >= x);
    fl_wf d_z = fl_wf_select(is_2, b->d[2], fl_wf_select(is_1, b->d[1], b->d[0]));
    fl_wf d_x = fl_wf_select(is_2, b->d[0], fl_wf_select(is_1, b->d[2], b->d[1]));
    fl_wf d_y = fl_wf_select(is_2, b->d[1], fl_wf_select(is_1, b->d[0], b->d[2]));
    fl_wf_store(p->shear_x + i, d_x / d_z);
    fl_wf_store(p->shear_y + i, d_y / d_z);
    fl_wf_store(p->inverse_z + i, 1.0f / d_z);
    p->z_is_1 |= (uint64_t)fl_wm_bits(is_1) << i;
    p->z_is_2 |= (uint64_t)fl_wm_bits(is_2) << i;
    for (int a = 0; a < 3; a++) {
        fl_wf_store(&p->enter_o[a][i], s->enter_o[a]);
        fl_wf_store(&p->leave_o[a][i], s->leave_o[a]);
        fl_wf_store(&p->inverse[a][i], s->inverse[a]);
        p->down[a] |= (uint64_t)fl_wm_bits(s->inverse[a] < 0.0f) << i;
    }
    p->lanes |= (uint64_t)fl_wm_bits(here) << i;
    p->has_source |= fl_wm_any((fl_wm)(fl_wu_load(p->source_object + i) != FL_NONE));
}

FL_INLINE fl_wm group_of_bits(uint32_t bits)
{
    return ((fl_wi_iota() * 0 + 1) << fl_wi_iota() & (int32_t)bits) != 0;
}

FL_INLINE uint32_t group_bits(uint64_t lanes, uint32_t i)
{
    return (uint32_t)(lanes >> i) & FL_W_ALL;
}

/* Least and greatest of an array over the rays that are here. */
FL_INLINE void packet_range(const packet *p, const float *array, float *out_least, float *out_most)
{
    fl_wf least = fl_wf_set(INFINITY), most = fl_wf_set(-INFINITY);
    for (uint32_t i = 0; i < CHUNK_RAYS; i += FL_W) {
        uint32_t bits = group_bits(p->lanes, i);
        if (!bits)
            continue;
        fl_wm here = group_of_bits(bits);
        fl_wf x = fl_wf_load(array + i);
        least = fl_wf_min(fl_wf_select(here, x, least), least);
        most = fl_wf_max(fl_wf_select(here, x, most), most);
    }
    *out_least = least[0];
    *out_most = most[0];
    for (int k = 1; k < FL_W; k++) {
        *out_least = least[k] < *out_least ? least[k] : *out_least;
        *out_most = most[k] > *out_most ? most[k] : *out_most;
    }
}

static bool packet_has_one_origin(const packet *p)
{
    uint32_t any = (uint32_t)__builtin_ctzll(p->lanes);
    uint64_t others = 0;
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < CHUNK_RAYS; i += FL_W)
            if (group_bits(p->lanes, i))
                others |= (uint64_t)fl_wm_bits(fl_wf_load(p->o[a] + i) != p->o[a][any]) << i;
    return (others & p->lanes) == 0;
}

/* Which way the rays go decides which of a box's planes they enter and leave by, and so which ends
 * of the interval of origins bound the distances. */
static inline void packet_find_beam(packet *p)
{
    uint64_t is_1 = p->z_is_1 & p->lanes, is_2 = p->z_is_2 & p->lanes;
    p->has_beam = (is_1 == 0 || is_1 == p->lanes) && (is_2 == 0 || is_2 == p->lanes);
    for (int a = 0; a < 3; a++) {
        uint64_t down = p->down[a] & p->lanes;
        p->has_beam &= down == 0 || down == p->lanes;
    }
    p->has_one_origin = p->has_beam && packet_has_one_origin(p);
    if (!p->has_beam)
        return;
    uint32_t any = (uint32_t)__builtin_ctzll(p->lanes);
    for (int a = 0; a < 3; a++) {
        packet_range(p, p->inverse[a], &p->beam_least[a], &p->beam_most[a]);
        p->beam_enter[a] = p->enter_o[a][any];
        p->beam_leave[a] = p->leave_o[a][any];
        if (p->has_one_origin)
            continue;
        float enter[2], leave[2];
        packet_range(p, p->enter_o[a], &enter[0], &enter[1]);
        packet_range(p, p->leave_o[a], &leave[0], &leave[1]);
        bool is_down = p->down[a] & p->lanes;
        p->beam_enter[a] = enter[is_down ? 0 : 1];
        p->beam_leave[a] = leave[is_down ? 1 : 0];
    }
    if (p->has_one_origin) {
        packet_range(p, p->shear_x, &p->beam_shear[0], &p->beam_shear[1]);
        packet_range(p, p->shear_y, &p->beam_shear[2], &p->beam_shear[3]);
    }
}

/* --- Triangles ------------------------------------------------------------------------------- */

FL_INLINE int packet_kz(const packet *p, uint32_t i)
{
    return (int)((p->z_is_2 >> i & 1u) * 2 + (p->z_is_1 >> i & 1u));
}

FL_INLINE needle packet_needle(const packet *p, uint32_t i)
{
    needle n = {.o = {p->o[0][i], p->o[1][i], p->o[2][i]},
                .shear_x = p->shear_x[i],
                .shear_y = p->shear_y[i],
                .inverse_z = p->inverse_z[i],
                .kz = packet_kz(p, i),
                .t = p->t[i],
                .object = p->object[i],
                .prim = p->prim[i],
                .source_object = p->source_object[i],
                .source_prim = p->source_prim[i]};
    n.kx = n.kz == 2 ? 0 : n.kz + 1;
    n.ky = n.kx == 2 ? 0 : n.kx + 1;
    n.d_z = p->d[n.kz][i];
    return n;
}

FL_INLINE void packet_take(packet *p, uint32_t i, const needle *n)
{
    p->t[i] = n->t;
    p->object[i] = n->object;
    p->prim[i] = n->prim;
}

/* The winner's entries of FL_W rays, where `hit` at t is nearest so far. */
FL_INLINE void group_accept(packet *p, uint32_t i, const mesh_target *target, uint32_t face,
                            fl_wm hit, fl_wf t, const bool is_any)
{
    uint32_t object = target->object, prim = face;
    if (target->mesh->face_object) {
        object = target->mesh->face_object[face];
        prim = 0;
    }
    if (p->has_source)
        hit &= ~((fl_wm)(fl_wu_load(p->source_object + i) == object) &
                 (fl_wm)(fl_wu_load(p->source_prim + i) == prim));
    fl_wf best = fl_wf_load(p->t + i);
    fl_wm closer = hit & (t < best);
    if (is_any) {
        fl_wf_store(p->t + i, fl_wf_select(closer, fl_wf_set(-1.0f), best));
        return;
    }
    fl_wu old_object = fl_wu_load(p->object + i), old_prim = fl_wu_load(p->prim + i);
    fl_wm ties = hit & (t == best);
    if (fl_wm_any(ties))
        closer |= ties & ((fl_wm)(old_object > object) |
                          ((fl_wm)(old_object == object) & (fl_wm)(old_prim > prim)));
    fl_wf_store(p->t + i, fl_wf_select(closer, t, best));
    fl_wu_store(p->object + i, fl_wu_select(closer, fl_wu_set(object), old_object));
    fl_wu_store(p->prim + i, fl_wu_select(closer, fl_wu_set(prim), old_prim));
}

/** Corners of a pack along kx, ky and kz as seen from the one origin of all rays. */
typedef struct view {
    _Alignas(64) float moved[3][3][8];
} view;

/* Leave out triangles that lie to one side of all rays between these shears. A ray's own sheared
 * coordinate lies between those at the ends, as rounding is monotone; so where all are above 0, or
 * all below, its edges never have one sign. */
FL_INLINE uint32_t view_cull(const view *v, const float shear[4])
{
    uint32_t kept = 0;
    for (int at = 0; at < 8; at += FL_W) {
        fl_wm beside = fl_wi_set(0);
        for (int a = 0; a < 2; a++) {
            fl_wf least = fl_wf_set(INFINITY), most = fl_wf_set(-INFINITY);
            for (int k = 0; k < 3; k++) {
                fl_wf x = fl_wf_load(v->moved[k][a] + at), z = fl_wf_load(v->moved[k][2] + at);
                fl_wf first = x - shear[2 * a] * z, last = x - shear[2 * a + 1] * z;
                least = fl_wf_min(fl_wf_min(first, last), least);
                most = fl_wf_max(fl_wf_max(first, last), most);
            }
            beside |= (least > 0.0f) | (most < 0.0f);
        }
        kept |= (fl_wm_bits(~beside) & FL_W_ALL) << at;
    }
    return kept;
}

FL_INLINE void view_of(const packet *p, const fl_tri_pack *pack, view *out)
{
    uint32_t any = (uint32_t)__builtin_ctzll(p->lanes);
    int kz = packet_kz(p, any), kx = kz == 2 ? 0 : kz + 1, ky = kx == 2 ? 0 : kx + 1;
    const int axes[3] = {kx, ky, kz};
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) {
            const float *from = pack->corner[k][axes[a]];
            for (int at = 0; at < 8; at += FL_W)
                fl_wf_store(out->moved[k][a] + at, fl_wf_load(from + at) - p->o[axes[a]][any]);
        }
}

/* Rays `bits` of the group at i against some of the triangles, one after the other. `v`: with one
 * origin. */
FL_INLINE void group_meet_pack(packet *p, uint32_t i, uint32_t bits, const mesh_target *target,
                               const fl_tri_pack *pack, uint32_t triangles, const view *v,
                               const bool is_any)
{
    int kz = packet_kz(p, (uint32_t)__builtin_ctzll(p->lanes));
    int kx = kz == 2 ? 0 : kz + 1, ky = kx == 2 ? 0 : kx + 1;
    fl_wf ox = fl_wf_load(p->o[kx] + i), oy = fl_wf_load(p->o[ky] + i);
    fl_wf oz = fl_wf_load(p->o[kz] + i), shear_x = fl_wf_load(p->shear_x + i);
    fl_wf shear_y = fl_wf_load(p->shear_y + i), inverse_z = fl_wf_load(p->inverse_z + i);
    fl_wm here = group_of_bits(bits);
    for (uint32_t left = triangles; left; left &= left - 1) {
        uint32_t n = (uint32_t)__builtin_ctz(left);
        corners c;
        fl_wf t;
        fl_wm doubt;
        for (int k = 0; k < 3; k++) {
            if (v) {
                c.z[k] = fl_wf_set(v->moved[k][2][n]);
                c.x[k] = v->moved[k][0][n] - shear_x * c.z[k];
                c.y[k] = v->moved[k][1][n] - shear_y * c.z[k];
            } else {
                c.z[k] = pack->corner[k][kz][n] - oz;
                c.x[k] = pack->corner[k][kx][n] - ox - shear_x * c.z[k];
                c.y[k] = pack->corner[k][ky][n] - oy - shear_y * c.z[k];
            }
        }
        fl_wm hit = corners_meet(&c, inverse_z, &t, &doubt) & here;
        uint32_t doubts = fl_wm_bits(doubt) & bits;
        if (doubts) {
            const corners kept = c; /* Which leaves c itself in registers. */
            for (; doubts; doubts &= doubts - 1) {
                int lane = __builtin_ctz(doubts);
                float exact;
                if (corners_decide(&kept, lane, p->d[kz][i + (uint32_t)lane], &exact)) {
                    t[lane] = exact;
                    hit[lane] = -1;
                }
            }
        }
        hit &= (t > 0.0f) & (t <= fl_wf_load(p->t + i));
        if (fl_wm_any(hit))
            group_accept(p, i, target, pack->face[n], hit, t, is_any);
    }
}

static inline void packet_meet_pack(packet *p, uint64_t lanes, const mesh_target *target,
                                    uint32_t child, const bool is_any)
{
    const fl_tri_pack *pack = &target->mesh->packs[FL_BVH_LEAF_INDEX(child)];
    uint32_t count = FL_BVH_LEAF_COUNT(child);
    view v;
    uint32_t triangles = (1u << count) - 1u;
    target->counts->primitive_tests += count * (uint32_t)__builtin_popcountll(lanes);
    if (p->has_one_origin) {
        view_of(p, pack, &v);
        triangles &= view_cull(&v, p->beam_shear);
        count = (uint32_t)__builtin_popcount(triangles);
        if (!count)
            return;
    }
    while (lanes) {
        uint32_t first = (uint32_t)__builtin_ctzll(lanes) / FL_W * FL_W;
        uint32_t bits = group_bits(lanes, first);
        lanes &= ~((uint64_t)FL_W_ALL << first);
        if (p->has_beam && FL_W > 1 &&
            (uint32_t)__builtin_popcount(bits) * GROUP_GAIN * (8 / FL_W) > 2 * count) {
            if (p->has_one_origin)
                group_meet_pack(p, first, bits, target, pack, triangles, &v, is_any);
            else
                group_meet_pack(p, first, bits, target, pack, triangles, NULL, is_any);
            continue;
        }
        for (; bits; bits &= bits - 1) {
            uint32_t i = first + (uint32_t)__builtin_ctz(bits);
            needle n = packet_needle(p, i);
            needle_meet_pack(&n, target, pack, is_any);
            packet_take(p, i, &n);
        }
    }
}

/* --- Boxes ----------------------------------------------------------------------------------- */

typedef struct packet_visit {
    uint64_t lanes;
    uint32_t child;
    uint32_t box; /* Of the child, for an exact test: node * 8 + place; FL_NONE: was tested. */
    float near;   /* No ray is nearer. */
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
    uint64_t met = 0;
    fl_wf enter[3], leave[3];
    for (int a = 0; a < 3; a++) {
        int down = (int)(p->down[a] >> any & 1u);
        enter[a] = fl_wf_set(node->plane[2 * a + down][k]);
        leave[a] = fl_wf_set(node->plane[2 * a + 1 - down][k]);
    }
    for (uint64_t left = lanes; left;) {
        uint32_t i = (uint32_t)__builtin_ctzll(left) / FL_W * FL_W;
        left &= ~((uint64_t)FL_W_ALL << i);
        fl_wf near = fl_wf_set(0.0f), far = fl_wf_load(p->t + i);
        for (int a = 0; a < 3; a++) {
            fl_wf inverse = fl_wf_load(&p->inverse[a][i]);
            near = fl_wf_max((enter[a] - fl_wf_load(&p->enter_o[a][i])) * inverse, near);
            far = fl_wf_min((leave[a] - fl_wf_load(&p->leave_o[a][i])) * inverse, far);
        }
        met |= (uint64_t)fl_wm_bits(near <= far) << i;
    }
    return met & lanes;
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
 * to out_lanes, the least distances lowered to theirs. */
FL_INLINE void rays_meet_node(const packet *p, uint32_t lanes, uint32_t first,
                              const fl_bvh_node *node, uint32_t out_lanes[8], float out_near[8])
{
    fl_wu met[8 / FL_W < 1 ? 1 : 8 / FL_W];
    fl_wf least[8 / FL_W];
    for (int h = 0; h < 8 / FL_W; h++) {
        met[h] = fl_wu_set(0);
        least[h] = fl_wf_load(out_near + h * FL_W);
    }
    for (; lanes; lanes &= lanes - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(lanes), i = first + k;
        for (int h = 0; h < 8 / FL_W; h++) {
            fl_wf near = fl_wf_set(0.0f), far = fl_wf_set(p->t[i]);
            for (int a = 0; a < 3; a++) {
                size_t down = p->down[a] >> i & 1u;
                const float *planes = node->plane[2 * a] + h * FL_W;
                fl_wf enter = fl_wf_load(planes + 8 * down) - p->enter_o[a][i];
                fl_wf leave = fl_wf_load(planes + 8 - 8 * down) - p->leave_o[a][i];
                near = fl_wf_max(enter * p->inverse[a][i], near);
                far = fl_wf_min(leave * p->inverse[a][i], far);
            }
            fl_wm meets = near <= far;
            met[h] |= (fl_wu)meets & fl_wu_set(1u << k);
            least[h] = fl_wf_min(fl_wf_select(meets, near, least[h]), least[h]);
        }
    }
    for (int h = 0; h < 8 / FL_W; h++) {
        fl_wu_store(out_lanes + h * FL_W, met[h]);
        fl_wf_store(out_near + h * FL_W, least[h]);
    }
}

/* What a visit will read, on its way from memory while others take their turn. */
FL_INLINE void packet_fetch(const mesh_target *target, uint32_t child)
{
    const char *first = child & FL_BVH_LEAF
                            ? (const char *)&target->mesh->packs[FL_BVH_LEAF_INDEX(child)]
                            : (const char *)&target->mesh->bvh->nodes[child];
    for (int line = 0; line < 4; line++)
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
                                    const mesh_target *target, packet_visit *stack, uint32_t height)
{
    const fl_bvh_node *node = &target->mesh->bvh->nodes[index];
    _Alignas(32) float near[8];
    uint32_t base = height;
    for (uint32_t bits = beam_meet_node(p, node, near); bits; bits &= bits - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(bits);
        packet_visit v = {lanes, node->child[k], index * 8 + k, near[k]};
        packet_fetch(target, v.child);
        height = packet_push(stack, base, height, v);
    }
    return height;
}

FL_INLINE uint32_t packet_push_rays(const packet *p, uint64_t lanes, uint32_t index,
                                    const mesh_target *target, packet_visit *stack, uint32_t height)
{
    const fl_bvh_node *node = &target->mesh->bvh->nodes[index];
    _Alignas(32) float near[8];
    _Alignas(32) uint32_t met[2][8] = {{0}, {0}};
    uint32_t base = height;
    for (int k = 0; k < 8; k++)
        near[k] = INFINITY;
    if ((uint32_t)lanes)
        rays_meet_node(p, (uint32_t)lanes, 0, node, met[0], near);
    if ((uint32_t)(lanes >> 32))
        rays_meet_node(p, (uint32_t)(lanes >> 32), 32, node, met[1], near);
    for (uint32_t k = 0; k < 8; k++) {
        uint64_t both = met[0][k] | (uint64_t)met[1][k] << 32;
        if (!both)
            continue;
        packet_fetch(target, node->child[k]);
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

FL_INLINE void packet_walk(packet *p, const mesh_target *target, const bool is_any)
{
    const fl_bvh *bvh = target->mesh->bvh;
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
            uint32_t before = (uint32_t)__builtin_popcountll(v.lanes);
            v.lanes = groups_meet_box(p, v.lanes, bvh, v.box);
            is_loose = (uint32_t)__builtin_popcountll(v.lanes) * 4 < before;
        } else {
            v.lanes = groups_beyond(p, v.lanes, v.near);
        }
        if (!v.lanes)
            continue;
        if (is_leaf) {
            packet_meet_pack(p, v.lanes, target, v.child, is_any);
            continue;
        }
        uint32_t count = (uint32_t)__builtin_popcountll(v.lanes);
        node_visits += count;
        if (p->has_beam && FL_W > 1 && count >= GROUP_RAYS_MIN * group_count(v.lanes))
            height = packet_push_beam(p, v.lanes, v.child, target, stack, height);
        else
            height = packet_push_rays(p, v.lanes, v.child, target, stack, height);
    }
    target->counts->node_visits += node_visits;
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
