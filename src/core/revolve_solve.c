/* SPDX-License-Identifier: MIT
 *
 * The certified solver, compiled once per instruction set (wide.h). Vectors only skip: every box
 * and bound is padded beyond float rounding, and whatever remains is decided in scalar double, so
 * hits are the same bits everywhere.
 */
#include "core/revolve_root.h"

enum { ROOM = 32 }; /* candidates kept in order before they are tried */

#define LEN_MIN 1e-100 /* squared lengths of directions outside are scaled first */
#define LEN_MAX 1e100
#define FAR     1e60 /* in units: rays from beyond hit nothing that rounding leaves meaningful */

/* Rays in their cut planes, structure of arrays. */
typedef struct frames {
    double c[FL_REVOLVE_PACKET], k[FL_REVOLVE_PACKET], s_l[FL_REVOLVE_PACKET],
        d_y[FL_REVOLVE_PACKET];
    double w0[FL_REVOLVE_PACKET], per_u[FL_REVOLVE_PACKET];
} frames;

/* A number as the sum of two of 26 digits, for Dekker's exact product. Plain operations only: a
 * fused multiply-add would give the same bits, but not every machine has one. */
typedef struct halves {
    fl_wd all, hi, lo;
} halves;

FL_INLINE halves halves_of(fl_wd a)
{
    fl_wd t = 134217729.0 * a, hi = t - (t - a);
    return (halves){a, hi, a - hi};
}

/* a b - c d with an error of about two roundings: both products are taken exactly. */
FL_INLINE fl_wd difference(const halves *a, const halves *b, const halves *c, const halves *d)
{
    fl_wd p = a->all * b->all, q = c->all * d->all;
    fl_wd p_low = ((a->hi * b->hi - p) + a->hi * b->lo + a->lo * b->hi) + a->lo * b->lo;
    fl_wd q_low = ((c->hi * d->hi - q) + c->hi * d->lo + c->lo * d->hi) + c->lo * d->lo;
    return (p - q) + (p_low - q_low);
}

/* One bit per lane of a mask of doubles. */
FL_INLINE uint32_t lane_bits(fl_wl mask)
{
    uint32_t bits = 0;
    for (int lane = 0; lane < FL_WD; lane++)
        bits |= (uint32_t)(mask[lane] & 1) << lane;
    return bits;
}

/* Constants of a ray in the box test: g = |d_y|; the bounds of q are widened by the pad. */
typedef struct cull {
    fl_wf c, g, s_l, k_lo, k_hi, d_y, w_min;
    bool down; /* d_y < 0: the sides change roles */
} cull;

typedef struct candidate {
    float w;       /* a lower bound of w in the piece's box */
    uint32_t code; /* 2 piece + (sigma < 0) */
} candidate;

/* Power of two that brings the direction's largest component near 1. */
static double direction_scale(double dx, double dy, double dz)
{
    double m = fl_max(fabs(dx), fl_max(fabs(dy), fabs(dz)));
    if (m < 0x1p-1000)
        return 0x1p1000;
    return m > 0x1p1000 ? 0x1p-1000 : 1.0 / fl_revolve_power_above(m);
}

/* The FL_WD rays from lane `i` on in their cut planes. Returns the lanes that may meet the bounding
 * cylinder; *out_odd: those whose direction must be scaled first. */
FL_INLINE uint32_t set_up(const fl_revolve *v, const fl_revolve_packet *rays, int i, frames *out,
                          uint32_t *out_odd)
{
    const fl_wd center = fl_wd_set(v->y_center), radius = fl_wd_set(v->radius),
                zero = fl_wd_set(0.0);
    const fl_wd mid = fl_wd_set(0.5 * (v->y_lo + v->y_hi)), half = v->y_hi - mid;
    fl_wd ox = fl_wd_load(rays->ox + i) * v->unit, oz = fl_wd_load(rays->oz + i) * v->unit;
    fl_wd height = fl_wd_load(rays->oy + i) * v->unit, oy = height - center, back = oy + center;
    fl_wd oy_low = (height - back) + (center - (back - oy));
    fl_wd dx = fl_wd_load(rays->dx + i), dy = fl_wd_load(rays->dy + i),
          dz = fl_wd_load(rays->dz + i);
    fl_wd l2 = dx * dx + dz * dz, d2 = l2 + dy * dy, length = fl_wd_sqrt(d2),
          inverse = 1.0 / length;
    halves hox = halves_of(ox), hoy = halves_of(oy), hoz = halves_of(oz);
    halves hdx = halves_of(dx), hdy = halves_of(dy), hdz = halves_of(dz);
    fl_wd l = fl_wd_sqrt(l2), inverse_l = 1.0 / l, hx = dx * inverse_l, hz = dz * inverse_l;
    fl_wd s_l = l * inverse, d_y = dy * inverse, p0 = ox * hx + oz * hz;
    fl_wd c = fl_wd_abs(difference(&hox, &hdz, &hoz, &hdx)) * inverse_l;
    fl_wd k = (hx * difference(&hox, &hdy, &hdx, &hoy) + hz * difference(&hoz, &hdy, &hdz, &hoy)) *
                  inverse -
              s_l * oy_low;
    /* Vertical rays are cut through the axis and the ray. */
    fl_wl vertical = l2 <= 1e-180 * d2;
    fl_wd rho = fl_wd_sqrt(ox * ox + oz * oz);
    d_y = fl_wd_select(vertical, fl_wd_copysign(fl_wd_set(1.0), dy), d_y);
    s_l = fl_wd_select(vertical, zero, s_l);
    c = fl_wd_select(vertical, zero, c);
    p0 = fl_wd_select(vertical, rho, p0);
    k = fl_wd_select(vertical, d_y * rho, k);
    fl_wd w0 = s_l * p0 + d_y * oy, per_u = length * v->unit, slope = fl_wd_abs(d_y);
    fl_wd s = fl_wd_sqrt(fl_wd_max((radius - c) * (radius + c), zero));
    fl_wd reach = s_l * s + slope * half + fl_wd_abs(d_y * mid) + 1e-15 * fl_wd_abs(w0);
    fl_wl is_in = (c <= radius) & (fl_wd_abs(k + s_l * mid) <= slope * s + s_l * half) &
                  (w0 + fl_wd_load(rays->u_min + i) * per_u <= reach) &
                  (w0 + fl_wd_load(rays->u_max + i) * per_u >= -reach) &
                  (fl_wd_abs(ox) + fl_wd_abs(oy) + fl_wd_abs(oz) < FAR);
    fl_wl is_plain = (d2 > LEN_MIN) & (d2 < LEN_MAX);
    fl_wd_store(out->c + i, c);
    fl_wd_store(out->k + i, k);
    fl_wd_store(out->s_l + i, s_l);
    fl_wd_store(out->d_y + i, d_y);
    fl_wd_store(out->w0 + i, w0);
    fl_wd_store(out->per_u + i, per_u);
    *out_odd = lane_bits(~is_plain);
    return lane_bits(is_in & is_plain);
}

FL_INLINE void set_up_cull(cull *f, const cut *r)
{
    double w_min = r->w0 + r->u_min * r->per_u;
    f->c = fl_wf_set((float)r->c);
    f->g = fl_wf_set((float)fabs(r->d_y));
    f->s_l = fl_wf_set((float)r->s_l);
    f->d_y = fl_wf_set((float)r->d_y);
    f->k_lo = fl_wf_set((float)(r->k - FL_REVOLVE_PAD));
    f->k_hi = fl_wf_set((float)(r->k + FL_REVOLVE_PAD));
    /* Boxes lie within 4 of the axis' middle: beyond 64 nothing changes, and float cannot overflow.
     */
    w_min = fl_clamp(w_min, -64.0, 64.0);
    f->w_min = fl_wf_set((float)(w_min - 4.0 * FL_REVOLVE_PAD - 1e-15 * fabs(r->w0)));
    f->down = r->d_y < 0.0;
}

/* Test the boxes of a group on both sides of the axis. Returns bit i for box i on side +1, bit 8 +
 * i on side -1; out_w: lower bounds of w in the same order. */
FL_INLINE uint32_t cull_group(const cull *f, const fl_revolve_group *group, float w_max,
                              float out_w[16])
{
    const fl_wf zero = fl_wf_set(0.0f), limit = fl_wf_set(w_max);
    uint32_t plus = 0, minus = 0;
    for (int i = 0; i < FL_REVOLVE_GROUP; i += FL_W) {
        fl_wf x_lo = fl_wf_load(group->xlo + i), x_hi = fl_wf_load(group->xhi + i);
        fl_wf y_lo = fl_wf_load(group->ylo + i), y_hi = fl_wf_load(group->yhi + i);
        fl_wf s_lo = fl_wf_sqrt(fl_wf_max((x_lo - f->c) * (x_lo + f->c), zero));
        fl_wf s_hi = fl_wf_sqrt(fl_wf_max((x_hi - f->c) * (x_hi + f->c), zero));
        s_lo = fl_wf_select(x_lo > f->c, s_lo, zero);
        fl_wf q_lo = f->s_l * y_lo + f->k_lo, q_hi = f->s_l * y_hi + f->k_hi;
        fl_wf a_lo = f->g * s_lo, a_hi = f->g * s_hi;
        fl_wf w0 = f->d_y * y_lo, w1 = f->d_y * y_hi, w_lo = fl_wf_min(w0, w1),
              w_hi = fl_wf_max(w0, w1);
        fl_wf p_lo = f->s_l * s_lo, p_hi = f->s_l * s_hi;
        fl_wm reached = x_hi >= f->c;
        fl_wm with = reached & (a_hi >= q_lo) & (a_lo <= q_hi); /* the side where g = |d_y| */
        fl_wm against = reached & (a_hi >= -q_hi) & (a_lo <= -q_lo);
        fl_wf plus_w = p_lo + w_lo, minus_w = w_lo - p_hi;
        fl_wm in_plus = (p_hi + w_hi >= f->w_min) & (plus_w <= limit);
        fl_wm in_minus = (w_hi - p_lo >= f->w_min) & (minus_w <= limit);
        plus |= fl_wm_bits((f->down ? against : with) & in_plus) << i;
        minus |= fl_wm_bits((f->down ? with : against) & in_minus) << i;
        fl_wf_store(out_w + i, plus_w);
        fl_wf_store(out_w + 8 + i, minus_w);
    }
    return plus | minus << 8;
}

/* Whether all of a piece's w between two knots lie within the ray's limits: s and y are monotone
 * there. */
FL_INLINE bool is_within(const cut *r, const side *a, const knot *lo, const knot *hi)
{
    double p0 = r->s_l * (a->sigma * lo->s), p1 = r->s_l * (a->sigma * hi->s);
    double h0 = r->d_y * lo->y, h1 = r->d_y * hi->y;
    double pad = 4.0 * FL_REVOLVE_PAD + 1e-15 * fabs(r->w0);
    return fl_min(p0, p1) + fl_min(h0, h1) > r->w0 + r->u_min * r->per_u + pad &&
           fl_max(p0, p1) + fl_max(h0, h1) < r->w - pad;
}

/* One piece on one side. Most pieces are decided here by the signs of e at the ends: e is monotone,
 * or the boxes of g s and q are apart, or the cut curve is convex. */
FL_INLINE void try_degree(cut *r, const fl_revolve *v, uint32_t code, uint32_t n)
{
    const double *piece = fl_revolve_piece(v, code >> 1), *end = piece + 2 * n + 2;
    side a = {piece, piece + n + 1,          n, code >> 1, code & 1 ? -1.0 : 1.0,
              0.0,   v->is_convex[code >> 1]};
    a.g = a.sigma * r->d_y;
    knot lo = cut_knot(r, a.g, 0.0, piece[0], piece[n + 1]),
         hi = cut_knot(r, a.g, 1.0, end[0], end[1]);
    if (lo.x < r->c && hi.x < r->c)
        return;
    bool is_cut = lo.x < r->c || hi.x < r->c;
    /* An end inside radius c stands for the point at c, where e = -q, as long as q has one sign. */
    if (is_cut && (lo.q > 0.0) != (hi.q > 0.0)) {
        cut_clip(r, &a, &lo, &hi);
        is_cut = false;
    }
    double a0 = a.g * lo.s, a1 = a.g * hi.s;
    bool same = !cut_crosses(&lo, &hi), monotone = (a1 - a0) * (hi.q - lo.q) <= 0.0;
    if (same &&
        (monotone || fl_max(a0, a1) < fl_min(lo.q, hi.q) || fl_min(a0, a1) > fl_max(lo.q, hi.q)))
        return;
    if (!same && r->any &&
        is_within(r, &a, &lo, &hi)) { /* There is a root; where does not matter. */
        r->found = true;
        return;
    }
    if (!same && (monotone || a.is_convex)) {
        double t = cut_root(r, &a, &lo, &hi, is_cut);
        if (is_cut && fl_revolve_poly(a.px, n, t) <
                          r->c) { /* q is 0 to rounding where the piece enters radius c */
            cut_clip(r, &a, &lo, &hi);
            t = lo.s > 0.0 ? hi.t : lo.t;
        }
        cut_accept(r, &a, t);
        return;
    }
    if (is_cut)
        cut_clip(r, &a, &lo, &hi);
    fl_revolve_search(r, &a, lo, hi);
}

static void try_cubic(cut *r, const fl_revolve *v, uint32_t code)
{
    try_degree(r, v, code, 3);
}

static void try_higher(cut *r, const fl_revolve *v, uint32_t code)
{
    try_degree(r, v, code, v->degree);
}

/* Try candidates from near to far until the bound of the next lies behind the best root. */
FL_INLINE void try_all(cut *r, const fl_revolve *v, const candidate *list, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if ((double)list[i].w - 4.0 * FL_REVOLVE_PAD > r->w)
            return;
        if (v->degree == 3)
            try_cubic(r, v, list[i].code);
        else
            try_higher(r, v, list[i].code);
    }
}

/* Try the pieces of a group in any order until one is hit. */
FL_INLINE void try_any(cut *r, const fl_revolve *v, uint32_t bits, uint32_t first)
{
    for (; bits && !r->found; bits &= bits - 1) {
        uint32_t bit = (uint32_t)__builtin_ctz(bits);
        uint32_t code = 2 * (first + (bit & 7)) + (bit >> 3);
        if (v->degree == 3)
            try_cubic(r, v, code);
        else
            try_higher(r, v, code);
    }
}

FL_INLINE float limit_of(const cut *r)
{
    return (float)(fl_clamp(r->w, -64.0, 64.0) + 4.0 * FL_REVOLVE_PAD + 1e-15 * fabs(r->w0));
}

/* Add the bits of a group to the ordered list, trying it out whenever it is full. */
FL_INLINE uint32_t collect(cut *r, const fl_revolve *v, uint32_t bits, uint32_t first,
                           const float w[16], candidate *list, uint32_t count)
{
    while (bits) {
        uint32_t bit = (uint32_t)__builtin_ctz(bits), at = count;
        bits &= bits - 1;
        for (; at > 0 && list[at - 1].w > w[bit]; at--)
            list[at] = list[at - 1];
        list[at] = (candidate){w[bit], 2 * (first + (bit & 7)) + (bit >> 3)};
        if (++count == ROOM) {
            try_all(r, v, list, count);
            count = 0;
        }
    }
    return count;
}

/* Solve a ray that has been set up. */
FL_INLINE void solve(cut *r, const fl_revolve *v)
{
    cull f;
    candidate list[ROOM];
    float w[16];
    uint32_t count = 0;
    uint32_t pending[FL_REVOLVE_LEVELS * FL_REVOLVE_GROUP][2],
        top = 0; /* groups to look into: level, index */
    set_up_cull(&f, r);
    for (uint32_t i = 0; i < v->group_count[v->first_level]; i++) {
        pending[0][0] = v->first_level;
        pending[0][1] = i;
        top = 1;
        while (top > 0) {
            uint32_t level = pending[--top][0], index = pending[top][1];
            uint32_t bits = cull_group(&f, &v->groups[level][index], limit_of(r), w);
            if (level == 0 && r->any) {
                try_any(r, v, bits, index * FL_REVOLVE_GROUP);
                if (r->found)
                    return;
                continue;
            }
            if (level == 0) {
                count = collect(r, v, bits, index * FL_REVOLVE_GROUP, w, list, count);
                continue;
            }
            for (bits = (bits | bits >> 8) & 0xff; bits; bits &= bits - 1) {
                pending[top][0] = level - 1;
                pending[top++][1] = index * FL_REVOLVE_GROUP + (uint32_t)__builtin_ctz(bits);
            }
        }
    }
    try_all(r, v, list, count);
}

FL_INLINE void store_hit(const cut *r, const fl_revolve *v, fl_revolve_hit *out)
{
    const double *range = fl_revolve_piece(v, r->piece) + v->stride - 2;
    out->u = r->u;
    out->local = r->local;
    out->t = fl_min(range[0] + range[1] * r->local, 1.0);
    out->sheet = r->piece;
    out->segment = v->segment[r->piece];
}

/* Rays that may meet the bounding cylinder, for FL_WD lanes from `i` on: bits. The tests of set_up
 * without their divisions, times |d| and the horizontal length of d, and padded for plain products.
 */
FL_INLINE uint32_t reach_bits(const fl_revolve *v, const fl_revolve_packet *rays, int i)
{
    fl_wd unit = fl_wd_set(v->unit), half = fl_wd_set(0.5 * (v->y_hi - v->y_lo));
    fl_wd mid = fl_wd_set(0.5 * (v->y_hi + v->y_lo) + v->y_center);
    fl_wd ox = fl_wd_load(rays->ox + i) * unit, oy = fl_wd_load(rays->oy + i) * unit - mid;
    fl_wd oz = fl_wd_load(rays->oz + i) * unit;
    fl_wd dx = fl_wd_load(rays->dx + i), dy = fl_wd_load(rays->dy + i),
          dz = fl_wd_load(rays->dz + i);
    fl_wd l2 = dx * dx + dz * dz, d2 = l2 + dy * dy, slope = fl_wd_abs(dy);
    fl_wd pad = 1e-6 + 4e-15 * (fl_wd_abs(ox) + fl_wd_abs(oy) + fl_wd_abs(oz) + fabs(v->y_center));
    fl_wd radius = v->radius + pad, cross = ox * dz - oz * dx;
    half += pad;
    fl_wd inside = l2 * radius * radius - cross * cross;
    fl_wd s = fl_wd_sqrt(fl_wd_max(inside, fl_wd_set(0.0)));
    fl_wd k = dx * (ox * dy - dx * oy) + dz * (oz * dy - dz * oy);
    fl_wd w = ox * dx + oz * dz + oy * dy, per_u = d2 * unit;
    fl_wd reach = s + slope * half + (fl_wd_abs(dx) + slope + fl_wd_abs(dz)) * pad;
    fl_wl out = (inside < 0.0) |
                (fl_wd_abs(k) > slope * (s + (fl_wd_abs(dx) + fl_wd_abs(dz)) * pad) + l2 * half) |
                (w + fl_wd_load(rays->u_min + i) * per_u > reach) |
                (w + fl_wd_load(rays->u_max + i) * per_u < -reach);
    /* Directions whose squares leave the normal range are set_up's business. */
    out &= (d2 > LEN_MIN) & (d2 < LEN_MAX) & (l2 > 1e-180 * d2);
    return lane_bits(~out);
}

static uint32_t reject8(const fl_revolve *v, const fl_revolve_packet *rays, uint32_t mask)
{
    uint32_t bits = 0;
    for (int i = 0; i < FL_REVOLVE_PACKET; i += FL_WD)
        if (mask >> i & ((1u << FL_WD) - 1u))
            bits |= reach_bits(v, rays, i) << i;
    return bits & mask;
}

static uint32_t nearest8(const fl_revolve *v, const fl_revolve_packet *rays, uint32_t mask,
                         fl_revolve_hit *out_hits);

/* The rays of `odd` again, one by one, with directions of a length near 1: u d is (u / f) (f d). */
static uint32_t solve_scaled(const fl_revolve *v, const fl_revolve_packet *rays, uint32_t odd,
                             fl_revolve_hit *out_hits)
{
    uint32_t hits = 0;
    for (; odd; odd &= odd - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(odd);
        double f = direction_scale(rays->dx[i], rays->dy[i], rays->dz[i]);
        double dx = rays->dx[i] * f, dy = rays->dy[i] * f, dz = rays->dz[i] * f,
               d2 = dx * dx + dy * dy + dz * dz;
        fl_revolve_packet one = {
            {rays->ox[i]}, {rays->oy[i]}, {rays->oz[i]},        {dx},
            {dy},          {dz},          {rays->u_min[i] / f}, {rays->u_max[i] / f}};
        fl_revolve_hit hit;
        if (!(d2 > LEN_MIN && d2 < LEN_MAX) || !nearest8(v, &one, 1, &hit))
            continue;
        hit.u *= f;
        if (!(hit.u > rays->u_min[i] && hit.u < rays->u_max[i])) /* beyond the numbers there are */
            continue;
        hits |= 1u << i;
        if (out_hits)
            out_hits[i] = hit;
    }
    return hits;
}

FL_INLINE uint32_t solve8(const fl_revolve *v, const fl_revolve_packet *rays, uint32_t mask,
                          bool is_any, fl_revolve_hit *out_hits)
{
    frames f;
    uint32_t hits = 0, left = reject8(v, rays, mask), odd_lanes = 0;
    for (int i = 0; i < FL_REVOLVE_PACKET; i += FL_WD) {
        uint32_t lanes = ((1u << FL_WD) - 1u) << i, odd = 0;
        if (left & lanes) {
            uint32_t met = set_up(v, rays, i, &f, &odd);
            odd_lanes |= left & odd << i;
            left &= met << i | ~lanes;
        }
    }
    for (; left; left &= left - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(left);
        cut r = {.c = f.c[i],
                 .k = f.k[i],
                 .s_l = f.s_l[i],
                 .d_y = f.d_y[i],
                 .w0 = f.w0[i],
                 .per_u = f.per_u[i]};
        r.u_per_w = 1.0 / r.per_u;
        r.u_min = rays->u_min[i];
        r.u = rays->u_max[i];
        r.w = r.w0 + r.u * r.per_u;
        r.tiny = v->tiny;
        r.any = is_any;
        solve(&r, v);
        if (!r.found)
            continue;
        hits |= 1u << i;
        if (!is_any)
            store_hit(&r, v, &out_hits[i]);
    }
    return odd_lanes ? hits | solve_scaled(v, rays, odd_lanes, out_hits) : hits;
}

static uint32_t nearest8(const fl_revolve *v, const fl_revolve_packet *rays, uint32_t mask,
                         fl_revolve_hit *out_hits)
{
    return solve8(v, rays, mask, false, out_hits);
}

/* A packet of one ray, in as many lanes as are looked at. */
FL_INLINE void splat(fl_revolve_packet *out, const double o[3], const double d[3], double u_min,
                     double u_max)
{
    fl_wd_store(out->ox, fl_wd_set(o[0]));
    fl_wd_store(out->oy, fl_wd_set(o[1]));
    fl_wd_store(out->oz, fl_wd_set(o[2]));
    fl_wd_store(out->dx, fl_wd_set(d[0]));
    fl_wd_store(out->dy, fl_wd_set(d[1]));
    fl_wd_store(out->dz, fl_wd_set(d[2]));
    fl_wd_store(out->u_min, fl_wd_set(u_min));
    fl_wd_store(out->u_max, fl_wd_set(u_max));
}

static bool nearest(const fl_revolve *v, const double o[3], const double d[3], double u_min,
                    double u_max, fl_revolve_hit *out_hit)
{
    fl_revolve_packet one;
    splat(&one, o, d, u_min, u_max);
    return solve8(v, &one, 1, false, out_hit) != 0;
}

static bool any(const fl_revolve *v, const double o[3], const double d[3], double u_min,
                double u_max)
{
    fl_revolve_packet one;
    splat(&one, o, d, u_min, u_max);
    return solve8(v, &one, 1, true, NULL) != 0;
}

static uint32_t any8(const fl_revolve *v, const fl_revolve_packet *rays, uint32_t mask)
{
    return solve8(v, rays, mask, true, NULL);
}

const fl_revolve_ops FL_ISA_NAME(fl_revolve_ops) = {nearest, any, reject8, nearest8, any8};
