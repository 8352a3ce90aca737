/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private: up to 64 rays in the space of a mesh, ready for its hierarchy, and the interval
 * of origins and directions that holds them all.
 */
#ifndef FL_KERNEL_ISECT_PACKET_H
#define FL_KERNEL_ISECT_PACKET_H

#include "core/kernel_isect_mesh.h"

/** Rays of a chunk in the space of a mesh. Sets of rays are bits. */
typedef struct packet {
    const float *o[3], *d[3];
    float *t;
    uint32_t *object, *prim;
    const uint32_t *source_object, *source_prim;
    uint64_t lanes;          /* Rays that are here. */
    uint64_t blocked;        /* Any hit: rays whose search is over. */
    uint64_t down[3];        /* Rays that descend along each axis. */
    uint64_t z_is_1, z_is_2; /* Rays whose kz is 1, 2. */
    bool is_alike;           /* All go the same way along each axis, */
    bool has_beam;           /* and along the same kz. */
    bool has_one_origin, has_source;
    float beam_enter[3], beam_leave[3], beam_least[3], beam_most[3];
    float beam_shear[4]; /* With one origin: least and most along kx, then along ky. */
    _Alignas(64) float enter_o[3][CHUNK_RAYS], leave_o[3][CHUNK_RAYS], inverse[3][CHUNK_RAYS];
    _Alignas(64) float turned_o[3][CHUNK_RAYS]; /* Along kx, ky, kz. */
    _Alignas(64) float shear_x[CHUNK_RAYS], shear_y[CHUNK_RAYS], inverse_z[CHUNK_RAYS];
} packet;

/** FL_W rays from place i on: `b` as a bundle in the space of the mesh, `s` their slabs. */
FL_INLINE void packet_put(packet *p, uint32_t i, const bundle *b, const slabs *s, fl_wm here)
{
    fl_wf x = fl_wf_abs(b->d[0]), y = fl_wf_abs(b->d[1]), z = fl_wf_abs(b->d[2]);
    fl_wm is_2 = (z >= x) & (z >= y), is_1 = ~is_2 & (y >= x);
    fl_wf d[3];
    for (int a = 0; a < 3; a++) {
        int on_0 = a == 2 ? 0 : a + 1, on_1 = on_0 == 2 ? 0 : on_0 + 1; /* For kz 0 and 1. */
        d[a] = fl_wf_select(is_2, b->d[a], fl_wf_select(is_1, b->d[on_1], b->d[on_0]));
        fl_wf_store(&p->turned_o[a][i],
                    fl_wf_select(is_2, b->o[a], fl_wf_select(is_1, b->o[on_1], b->o[on_0])));
    }
    fl_wf_store(p->shear_x + i, d[0] / d[2]);
    fl_wf_store(p->shear_y + i, d[1] / d[2]);
    fl_wf_store(p->inverse_z + i, 1.0f / d[2]);
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

/* All rays, here or not, that descend along the same axes as ray i. */
FL_INLINE uint64_t packet_alike(const packet *p, uint32_t i)
{
    uint64_t unlike = 0;
    for (int a = 0; a < 3; a++)
        unlike |= p->down[a] ^ (0 - (p->down[a] >> i & 1u));
    return ~unlike;
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
    p->is_alike = true;
    for (int a = 0; a < 3; a++) {
        uint64_t down = p->down[a] & p->lanes;
        p->is_alike &= down == 0 || down == p->lanes;
    }
    p->has_beam = p->is_alike && (is_1 == 0 || is_1 == p->lanes) && (is_2 == 0 || is_2 == p->lanes);
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

/** Of the rays `lanes`, which go the same way along each axis, those that may meet a box with these
 * planes, FL_W at a time: the one slab test of boxes and cells. */
FL_INLINE uint64_t groups_meet_planes(const packet *p, uint64_t lanes, const fl_wf enter[3],
                                      const fl_wf leave[3])
{
    uint64_t met = 0;
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

#endif
