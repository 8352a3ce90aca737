/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private to the intersection kernels: rays as the tests see them, and the rule of the
 * nearest hit. Included by kernel_isect.c after FL_W and FL_ISA are set; one copy an instruction
 * set.
 *
 * Rays go through in chunks of 64, primitives of the scene's own arrays meet FL_W rays at a time (a
 * bundle), meshes are walked ray by ray. The arithmetic of a test does not depend on FL_W, so hits
 * do not either.
 */
#ifndef FL_KERNEL_ISECT_H
#define FL_KERNEL_ISECT_H

#include "core/octree.h"
#include "core/stream.h"
#include "core/wide.h"

enum { CHUNK_RAYS = 64 };

/** Up to 64 rays and what was found so far. Pointers into streams, or into transformed copies. */
typedef struct chunk {
    const float *o[3], *d[3];
    float *t; /**< Nearest so far, at first t_max; for any-hit -1 once blocked. */
    uint32_t *object, *prim;
    fl_revolve_hit *root; /**< NULL: not kept. */
    const uint32_t *source_object, *source_prim;
    uint32_t count; /**< Rounded up to a multiple of FL_W. */
} chunk;

/** What a kernel works on; passed down by pointer. is_any is a constant at every call that matters.
 */
typedef struct job {
    const fl_geometry *geometry;
    fl_isect_context *context;
} job;

/** FL_W rays in the space of a primitive. */
typedef struct bundle {
    fl_wf o[3], d[3];
} bundle;

/** What the slab test needs of FL_W rays, or of one ray in all lanes. Sides as in
 * fl_bvh_node.plane: a ray with d >= 0 enters at lo. Positive d: t = (plane - o) / d; the origin is
 * moved by the widening of the boxes. */
typedef struct slabs {
    fl_wf enter_o[3], leave_o[3], inverse[3];
} slabs;

FL_INLINE fl_wf dot(const fl_wf a[3], const fl_wf b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

FL_INLINE bundle bundle_load(const chunk *c, uint32_t i)
{
    bundle b;
    for (int a = 0; a < 3; a++) {
        b.o[a] = fl_wf_load(c->o[a] + i);
        b.d[a] = fl_wf_load(c->d[a] + i);
    }
    return b;
}

FL_INLINE bundle bundle_transform(const float m[12], const bundle *b)
{
    bundle r;
    for (int a = 0; a < 3; a++) {
        const float *row = m + 4 * a;
        r.o[a] = row[0] * b->o[0] + row[1] * b->o[1] + row[2] * b->o[2] + row[3];
        r.d[a] = row[0] * b->d[0] + row[1] * b->d[1] + row[2] * b->d[2];
    }
    return r;
}

/** Lanes whose search is not over. */
FL_INLINE fl_wm chunk_alive(const chunk *c, uint32_t i)
{
    return fl_wf_load(c->t + i) > 0.0f;
}

FL_INLINE fl_wm chunk_starts_on(const chunk *c, uint32_t i, uint32_t object)
{
    return (fl_wm)(fl_wu_load(c->source_object + i) == object);
}

/** Enter hits of prim 0 of `object` at t where 0 < t, t < t_max and (t, object) is least. NaN is no
 * hit. Returns the lanes entered. */
FL_INLINE fl_wm chunk_accept(chunk *c, uint32_t i, fl_wf t, uint32_t object, const bool is_any)
{
    fl_wf best = fl_wf_load(c->t + i);
    fl_wm closer = (t > 0.0f) & (t < best);
    if (!is_any)
        closer |= (t == best) & (t > 0.0f) & (fl_wm)(fl_wu_load(c->object + i) > object);
    if (!fl_wm_any(closer))
        return closer;
    if (is_any) {
        fl_wf_store(c->t + i, fl_wf_select(closer, fl_wf_set(-1.0f), best));
        return closer;
    }
    fl_wf_store(c->t + i, fl_wf_select(closer, t, best));
    fl_wu_store(c->object + i, fl_wu_select(closer, fl_wu_set(object), fl_wu_load(c->object + i)));
    fl_wu_store(c->prim + i, fl_wu_select(closer, fl_wu_set(0), fl_wu_load(c->prim + i)));
    return closer;
}

FL_INLINE slabs slabs_of(const bundle *b, float origin_pad)
{
    slabs s;
    fl_wf pad = fl_wf_max(fl_wf_max(fl_wf_abs(b->o[0]), fl_wf_abs(b->o[1])), fl_wf_abs(b->o[2]));
    pad = pad * origin_pad;
    for (int a = 0; a < 3; a++) {
        /* A zero (or tiny) component must give a finite inverse: 0 * inf would be NaN. */
        fl_wf inverse = 1.0f / b->d[a];
        fl_wf largest = fl_wf_copysign(fl_wf_set(1e37f), b->d[a]);
        s.inverse[a] = fl_wf_select(fl_wf_abs(inverse) < 1e37f, inverse, largest);
        fl_wf signed_pad = fl_wf_copysign(pad, b->d[a]);
        s.enter_o[a] = b->o[a] + signed_pad;
        s.leave_o[a] = b->o[a] - signed_pad;
    }
    return s;
}

/** FL_W rays against one box, on both counts conservatively: may the ray meet it at 0 < t <= best?
 */
FL_INLINE fl_wm slabs_meet(const slabs *s, const float lo[3], const float hi[3], fl_wf best,
                           fl_wf *out_near)
{
    fl_wf near = fl_wf_set(0.0f), far = best;
    for (int a = 0; a < 3; a++) {
        fl_wm down = (fl_wm)s->inverse[a] < 0;
        fl_wf l = fl_wf_set(lo[a]), h = fl_wf_set(hi[a]);
        fl_wf enter = (fl_wf_select(down, h, l) - s->enter_o[a]) * s->inverse[a];
        fl_wf leave = (fl_wf_select(down, l, h) - s->leave_o[a]) * s->inverse[a];
        near = fl_wf_max(enter, near);
        far = fl_wf_min(leave, far);
    }
    *out_near = near;
    return near <= far;
}

#endif
