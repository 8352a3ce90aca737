/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private: rays of a packet against the triangles of a leaf: FL_W rays against one
 * triangle after the other where rays stay together, else one ray against eight triangles. The test
 * is the same (corners_meet).
 */
#ifndef FL_KERNEL_ISECT_LEAF_H
#define FL_KERNEL_ISECT_LEAF_H

#include "core/kernel_isect_packet.h"

enum { GROUP_GAIN = 3 }; /* A ray against a pack costs half as many tests of a group of eight. */

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
        p->blocked |= (uint64_t)fl_wm_bits(closer) << i;
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
        fl_wm hit = corners_meet(&c, inverse_z, &t, &doubt, false) & here;
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

/* Ray i hits `face` at t, which is not beyond its nearest. */
FL_INLINE void packet_accept(packet *p, uint32_t i, const mesh_target *target, float t,
                             uint32_t face, const bool is_any)
{
    uint32_t object = target->object, prim = face;
    if (target->mesh->face_object) {
        object = target->mesh->face_object[face];
        prim = 0;
    }
    if (object == p->source_object[i] && prim == p->source_prim[i])
        return;
    if (is_any) {
        p->t[i] = -1.0f;
        p->blocked |= (uint64_t)1 << i;
    } else if (t < p->t[i] || object < p->object[i] ||
               (object == p->object[i] && prim < p->prim[i])) {
        p->t[i] = t;
        p->object[i] = object;
        p->prim[i] = prim;
    }
}

/* Ray i against a pack of which floats cannot decide all. Rare, so it starts again. */
static __attribute__((noinline)) void packet_meet_pack_doubtful(packet *p, uint32_t i,
                                                                const mesh_target *target,
                                                                const fl_tri_pack *pack,
                                                                const bool is_any)
{
    needle n = packet_needle(p, i);
    needle_meet_pack(&n, target, pack, is_any);
    packet_take(p, i, &n);
    if (is_any && n.t < 0.0f)
        p->blocked |= (uint64_t)1 << i;
}

/* Ray i against the eight triangles, corners along axes `k`: most of the time none is near. */
FL_INLINE void packet_meet_pack_alone(packet *p, uint32_t i, const mesh_target *target,
                                      const fl_tri_pack *pack, const int k[3], const bool is_steady,
                                      const bool is_any)
{
    const float o[3] = {p->turned_o[0][i], p->turned_o[1][i], p->turned_o[2][i]};
    for (int at = 0; at < 8; at += FL_W) {
        fl_wf t;
        fl_wm doubt;
        corners c = pack_corners(pack, at, k, o, p->shear_x[i], p->shear_y[i]);
        fl_wm sure = corners_meet(&c, fl_wf_set(p->inverse_z[i]), &t, &doubt, is_steady);
        if (!is_steady && !fl_wm_any(sure | doubt))
            continue;
        if (fl_wm_any(doubt)) {
            packet_meet_pack_doubtful(p, i, target, pack, is_any);
            return;
        }
        fl_wf best = fl_wf_set(p->t[i]);
        uint32_t hits = fl_wm_bits(sure & (t > 0.0f) & (is_any ? t < best : t <= best));
        for (; hits; hits &= hits - 1) {
            int lane = __builtin_ctz(hits);
            if (is_any || t[lane] <= p->t[i])
                packet_accept(p, i, target, t[lane], pack->face[at + lane], is_any);
        }
    }
}

/* Rays one by one against the eight triangles: most of the time none is near. Those with the same
 * kz find the corners in the same place. is_steady: as in corners_meet. */
FL_INLINE void rays_meet_pack(packet *p, uint64_t lanes, const mesh_target *target,
                              const fl_tri_pack *pack, bool is_steady, const bool is_any)
{
    while (lanes) {
        uint32_t one = (uint32_t)__builtin_ctzll(lanes);
        int kz = packet_kz(p, one), kx = kz == 2 ? 0 : kz + 1, ky = kx == 2 ? 0 : kx + 1;
        uint64_t same = lanes;
        if (!p->has_beam)
            same &= kz == 2 ? p->z_is_2 : kz == 1 ? p->z_is_1 : ~(p->z_is_1 | p->z_is_2);
        lanes &= ~same;
        const int k[3] = {kx, ky, kz};
        for (; same; same &= same - 1) {
            uint32_t i = (uint32_t)__builtin_ctzll(same);
            if (is_steady)
                packet_meet_pack_alone(p, i, target, pack, k, true, is_any);
            else
                packet_meet_pack_alone(p, i, target, pack, k, false, is_any);
        }
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
    uint64_t alone = lanes;
    bool is_steady = target->mesh->pack_count >= STEADY_PACKS && (is_any || !p->has_beam);
    bool may_group = p->has_beam && FL_W > 1 && !is_steady &&
                     (uint32_t)__builtin_popcountll(lanes) * GROUP_GAIN * (8 / FL_W) > 2 * count;
    for (uint64_t left = may_group ? lanes : 0; left;) {
        uint32_t first = (uint32_t)__builtin_ctzll(left) / FL_W * FL_W;
        uint32_t bits = group_bits(left, first);
        left &= ~((uint64_t)FL_W_ALL << first);
        if ((uint32_t)__builtin_popcount(bits) * GROUP_GAIN * (8 / FL_W) <= 2 * count)
            continue;
        alone &= ~((uint64_t)FL_W_ALL << first);
        if (p->has_one_origin)
            group_meet_pack(p, first, bits, target, pack, triangles, &v, is_any);
        else
            group_meet_pack(p, first, bits, target, pack, triangles, NULL, is_any);
    }
    rays_meet_pack(p, alone, target, pack, is_steady, is_any);
}

#endif
