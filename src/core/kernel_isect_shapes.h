/* SPDX-License-Identifier: MIT
 *
 * Layer 4, private: FL_W rays against one plane, sphere, patch or surface of revolution. Each
 * returns t, or something that is not above 0 (or NaN) for no hit.
 */
#ifndef FL_KERNEL_ISECT_SHAPES_H
#define FL_KERNEL_ISECT_SHAPES_H

#include "core/kernel_isect.h"

/* A plane is not met by a ray that starts on it: decision 13. */
FL_INLINE fl_wf hit_plane(const fl_planes *p, uint32_t k, const bundle *b, fl_wm own)
{
    fl_wf n[3] = {fl_wf_set(p->nx[k]), fl_wf_set(p->ny[k]), fl_wf_set(p->nz[k])};
    fl_wf t = (p->d[k] - dot(n, b->o)) / dot(n, b->d);
    return fl_wf_select(own, fl_wf_set(-1.0f), t);
}

/* Lanes of `own` whose ray left its sphere to the inside. Its origin was moved to the side that it
 * leaves to by four roundings of the largest coordinate (kernel_resolve.c); rounding takes back 2 sqrt(3)
 * of them at most, and in double nothing is added to that, so the side is certain where the slope
 * is not. `exact`: to the space of the sphere, or NULL. */
static __attribute__((noinline)) fl_wm starts_inside(const fl_spheres *s, uint32_t k,
                                                     const bundle *world, const fl_affine *exact,
                                                     fl_wm own)
{
    fl_wm inside = fl_wi_set(0);
    double square = s->radius[k] * s->radius[k];
    for (uint32_t lanes = fl_wm_bits(own); lanes; lanes &= lanes - 1) {
        int i = __builtin_ctz(lanes);
        fl_vec3 o = fl_v3((double)world->o[0][i], (double)world->o[1][i], (double)world->o[2][i]);
        if (exact)
            o = fl_affine_point(exact, o);
        o = fl_v3_sub(o, s->center[k]);
        inside[i] = fl_v3_dot(o, o) < square ? -1 : 0;
    }
    return inside;
}

/* Distance of the centre to the line by the perpendicular vector l, not by the discriminant's
 * difference of large squares, and both roots without cancellation [Haines, Gunther,
 * Akenine-Moller, Ray Tracing Gems, chapter 7]. A ray that starts on the sphere and goes inward
 * leaves it by the exact chord, however short. */
FL_INLINE fl_wf hit_sphere(const fl_spheres *s, uint32_t k, const bundle *b, const bundle *world,
                           const fl_affine *exact, fl_wm own)
{
    const fl_wf none = fl_wf_set(-1.0f);
    fl_wf f[3] = {b->o[0] - s->cx[k], b->o[1] - s->cy[k], b->o[2] - s->cz[k]};
    fl_wf square = fl_wf_set(s->r[k]) * s->r[k];
    fl_wf dd = dot(b->d, b->d), fd = -dot(f, b->d), middle = fd / dd;
    fl_wf l[3] = {f[0] + middle * b->d[0], f[1] + middle * b->d[1], f[2] + middle * b->d[2]};
    fl_wf rest = square - dot(l, l);
    fl_wm meets = rest >= 0.0f;
    if (!fl_wm_any(meets | own)) /* Most bundles are done here, without most of the divisions. */
        return none;
    fl_wf root = fl_wf_sqrt(dd * fl_wf_max(rest, fl_wf_set(0.0f)));
    fl_wf q = fd + fl_wf_copysign(root, fd);
    fl_wf t0 = (dot(f, f) - square) / q, t1 = q / dd;
    fl_wf first = fl_wf_min(t0, t1), last = fl_wf_max(t0, t1);
    fl_wf t = fl_wf_select(first > 0.0f, first, last);
    t = fl_wf_select(meets, t, none);
    if (fl_wm_any(own)) {
        fl_wf chord = fl_wf_select(middle > 0.0f, middle + middle, fl_wf_set(0x1p-126f));
        t = fl_wf_select(own, fl_wf_select(starts_inside(s, k, world, exact, own), chord, -chord),
                         t);
    }
    return t;
}

/* best: nothing beyond it counts. */
FL_INLINE fl_wf hit_patch(const fl_patches *p, uint32_t k, const bundle *b, fl_wm own, fl_wf best)
{
    fl_wf n[3] = {fl_wf_set(p->nx[k]), fl_wf_set(p->ny[k]), fl_wf_set(p->nz[k])};
    fl_wf f[3] = {b->o[0] - p->cx[k], b->o[1] - p->cy[k], b->o[2] - p->cz[k]};
    fl_wf t = -dot(n, f) / dot(n, b->d);
    fl_wm counts = (t > 0.0f) & (t <= best) & ~own;
    if (!fl_wm_any(counts))
        return fl_wf_set(-1.0f);
    for (int a = 0; a < 3; a++)
        f[a] = f[a] + t * b->d[a];
    fl_wf u[3] = {fl_wf_set(p->ax[k]), fl_wf_set(p->ay[k]), fl_wf_set(p->az[k])};
    fl_wf v[3] = {fl_wf_set(p->bx[k]), fl_wf_set(p->by[k]), fl_wf_set(p->bz[k])};
    fl_wf alpha = dot(u, f), beta = dot(v, f);
    fl_wm inside;
    if (p->is_disk[k])
        inside = alpha * alpha + beta * beta <= 1.0f;
    else
        inside = (alpha >= 0.0f) & (alpha <= 1.0f) & (beta >= 0.0f) & (beta <= 1.0f);
    return fl_wf_select(inside & counts, t, fl_wf_set(-1.0f));
}

/* The bound in double below which a root rounds to a float below t_max: where any-hit must agree
 * with nearest. */
static double below_float(float t_max)
{
    if (!(t_max < INFINITY))
        return HUGE_VAL;
    uint32_t bits;
    float previous;
    memcpy(&bits, &t_max, sizeof bits);
    bits--;
    memcpy(&previous, &bits, sizeof bits);
    double middle = 0.5 * ((double)previous + (double)t_max);
    return bits & 1u ? middle : middle * (1.0 + 0x1p-52); /* A tie goes to the even float. */
}

/* Surface number k, which is `object`, against the bundle at i of the chunk. */
static void meet_revolution(const job *j, chunk *c, uint32_t i, const bundle *b, uint32_t k,
                            uint32_t object, const fl_vec3 *shift, const bool is_any)
{
    const fl_revolutions *r = &j->geometry->revolutions;
    fl_wf t = fl_wf_set(-1.0f), near, best = fl_wf_load(c->t + i);
    slabs s = slabs_of(b, FL_ORIGIN_PAD);
    fl_wm meets = slabs_meet(&s, r->bounds[k].lo, r->bounds[k].hi, best, &near);
    uint32_t lanes = fl_wm_bits(meets & (best > 0.0f));
    if (!lanes)
        return;
    fl_revolve_packet rays;
    for (int l = 0; l < FL_W; l++) {
        rays.ox[l] = (double)b->o[0][l] + shift->x;
        rays.oy[l] = (double)b->o[1][l] + shift->y;
        rays.oz[l] = (double)b->o[2][l] + shift->z;
        rays.dx[l] = (double)b->d[0][l];
        rays.dy[l] = (double)b->d[1][l];
        rays.dz[l] = (double)b->d[2][l];
        rays.u_min[l] = 0.0;
        rays.u_max[l] = is_any ? below_float(best[l]) : (double)best[l] * (1.0 + 0x1p-22);
    }
    fl_revolve_solver solver = j->context->solver;
    fl_revolve_hit hits[FL_REVOLVE_PACKET];
    j->context->counts.primitive_tests += (uint64_t)__builtin_popcount(lanes);
    lanes = is_any ? fl_revolve_any8(r->profile[k], &rays, lanes, solver)
                   : fl_revolve_nearest8(r->profile[k], &rays, lanes, solver, hits);
    for (; lanes; lanes &= lanes - 1) {
        int lane = __builtin_ctz(lanes);
        /* Where something blocks does not matter. */
        t[lane] = is_any ? 0x1p-126f : (float)hits[lane].u;
    }
    fl_wm closer = chunk_accept(c, i, t, object, is_any);
    if (is_any || !c->root)
        return;
    for (lanes = fl_wm_bits(closer); lanes; lanes &= lanes - 1)
        c->root[i + (uint32_t)__builtin_ctz(lanes)] = hits[__builtin_ctz(lanes)];
}

#endif
