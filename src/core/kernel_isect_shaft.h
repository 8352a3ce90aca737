/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private: what a whole chunk of rays may reach, as one interval of origins, directions
 * and lengths, against the boxes of a scene's objects, eight at a time. It skips only objects whose
 * box no ray of the chunk meets by the slab test (kernel_isect.h), so hits are the same.
 */
#ifndef FL_KERNEL_ISECT_SHAFT_H
#define FL_KERNEL_ISECT_SHAFT_H

#include "core/kernel_isect.h"

/** Rays o + t d with o_lo <= o <= o_hi, inverse_* the inverses of the least and the greatest d. */
typedef struct shaft {
    float o_lo[3], o_hi[3], inverse_lo[3], inverse_hi[3];
    float t_max;
} shaft;

/** Objects that some ray of a chunk may meet, by kind and in order of their numbers. */
typedef struct nearby {
    uint32_t index[FL_OBJECT_BVH_MIN];
    uint32_t spheres, squares, revolutions, count; /* Where each kind ends, and all: instances. */
} nearby;

/* Finite, as in slabs_of. */
FL_INLINE float shaft_inverse(float d)
{
    float inverse = 1.0f / d;
    return fabsf(inverse) < 1e37f ? inverse : copysignf(1e37f, d);
}

FL_INLINE shaft shaft_of(const chunk *c, float origin_pad)
{
    shaft s;
    fl_wf lo[6], hi[6], t = fl_wf_set(0.0f);
    for (int k = 0; k < 6; k++) {
        lo[k] = fl_wf_set(INFINITY);
        hi[k] = fl_wf_set(-INFINITY);
    }
    /* A ray that is not a number meets nothing and does not count: it is the first operand. */
    for (uint32_t i = 0; i < c->count; i += FL_W) {
        t = fl_wf_max(fl_wf_load(c->t + i), t);
        for (int a = 0; a < 3; a++) {
            fl_wf o = fl_wf_load(c->o[a] + i), d = fl_wf_load(c->d[a] + i);
            lo[a] = fl_wf_min(o, lo[a]);
            hi[a] = fl_wf_max(o, hi[a]);
            lo[3 + a] = fl_wf_min(d, lo[3 + a]);
            hi[3 + a] = fl_wf_max(d, hi[3 + a]);
        }
    }
    float largest = 0.0f;
    for (int a = 0; a < 3; a++) {
        s.o_lo[a] = fl_wf_least(lo[a]);
        s.o_hi[a] = fl_wf_most(hi[a]);
        s.inverse_lo[a] = shaft_inverse(fl_wf_least(lo[3 + a]));
        s.inverse_hi[a] = shaft_inverse(fl_wf_most(hi[3 + a]));
        largest = -s.o_lo[a] > largest ? -s.o_lo[a] : largest;
        largest = s.o_hi[a] > largest ? s.o_hi[a] : largest;
    }
    for (int a = 0; a < 3; a++) {
        s.o_lo[a] -= largest * origin_pad;
        s.o_hi[a] += largest * origin_pad;
    }
    s.t_max = fl_wf_most(t);
    return s;
}

/* Boxes that a ray of the shaft may meet: bits. Along each axis the greatest d must bring the
 * greatest o to lo or beyond, and the least d the least o to hi or below. */
FL_INLINE uint32_t shaft_meet(const shaft *s, const fl_entry_boxes *boxes)
{
    uint32_t bits = 0;
    for (int at = 0; at < 8; at += FL_W) {
        fl_wf near = fl_wf_set(0.0f), far = fl_wf_set(s->t_max);
        for (int a = 0; a < 3; a++) {
            fl_wf to_lo = (fl_wf_load(boxes->lo[a] + at) - s->o_hi[a]) * s->inverse_hi[a];
            fl_wf to_hi = (fl_wf_load(boxes->hi[a] + at) - s->o_lo[a]) * s->inverse_lo[a];
            if (s->inverse_hi[a] > 0.0f)
                near = fl_wf_max(to_lo, near);
            else
                far = fl_wf_min(to_lo, far);
            if (s->inverse_lo[a] > 0.0f)
                far = fl_wf_min(to_hi, far);
            else
                near = fl_wf_max(to_hi, near);
        }
        bits |= fl_wm_bits(near <= far) << at;
    }
    return bits;
}

FL_INLINE void find_nearby(const fl_geometry *g, const chunk *c, nearby *out)
{
    const shaft s = shaft_of(c, g->entry_origin_pad);
    const uint32_t count = g->bounded_entry_count;
    out->spheres = out->squares = out->revolutions = out->count = 0;
    for (uint32_t first = 0; first < count; first += 8) {
        uint32_t bits = shaft_meet(&s, &g->entry_boxes[first / 8]);
        bits &= (1u << fl_min_u32(count - first, 8)) - 1u;
        for (; bits; bits &= bits - 1) {
            const fl_entry *entry = &g->entries[first + (uint32_t)__builtin_ctz(bits)];
            out->index[out->count++] = entry->index;
            if (entry->is_instance)
                continue;
            if (entry->kind == FL_OBJECT_SPHERE)
                out->spheres = out->count;
            if (entry->kind != FL_OBJECT_REVOLUTION)
                out->squares = out->count;
            out->revolutions = out->count;
        }
    }
}

#endif
