/* SPDX-License-Identifier: MIT
 *
 * The hard cases of the certified solver: parts of a piece on which neither monotony nor a box
 * decides. One source, no vectors, so it is compiled once; its answers do not depend on the
 * instruction set.
 */
#define FL_W 1
#include "core/revolve_root.h"

enum { MAX_STEPS = 400, STACK = 96, MAX_M = FL_REVOLVE_MAX_DEGREE };

typedef struct range {
    double lo, hi;
} range;

static range range_of(const double *v, uint32_t count)
{
    range r = {v[0], v[0]};
    for (uint32_t i = 1; i < count; i++) {
        r.lo = fl_min(r.lo, v[i]);
        r.hi = fl_max(r.hi, v[i]);
    }
    return r;
}

static range range_mul(range a, range b)
{
    double v[4] = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi};
    return range_of(v, 4);
}

/* Absolute values of a quantity known to keep its sign up to rounding. */
static range range_abs(range a)
{
    range r = {fl_min(fabs(a.lo), fabs(a.hi)), fl_max(fabs(a.lo), fabs(a.hi))};
    if (a.lo < 0.0 && a.hi > 0.0)
        r.lo = 0.0;
    return r;
}

/* Bernstein coefficients of c'(t) on [a, b]; n of them for degree n. */
static void hodograph(const double *c, uint32_t n, double a, double b, double *out)
{
    double h = b - a;
    if (n == 3) {
        double s = 2.0 * c[2], p = 3.0 * c[3];
        out[0] = c[1] + a * (s + a * p);
        out[1] = c[1] + c[2] * (a + b) + p * a * b;
        out[2] = c[1] + b * (s + b * p);
        return;
    }
    uint32_t m = n - 1;
    for (uint32_t k = 0; k <= m; k++)
        out[k] = (double)(k + 1) * c[k + 1];
    for (uint32_t k = 0; k < m; k++) /* powers of t - a */
        for (uint32_t i = m; i-- > k;)
            out[i] += a * out[i + 1];
    double scale = 1.0, binomial = 1.0;
    for (uint32_t k = 1; k <= m; k++) { /* powers of the local parameter over binomials */
        scale *= h;
        binomial = binomial * (double)(m - k + 1) / (double)k;
        out[k] *= scale / binomial;
    }
    for (uint32_t k = 1; k <= m; k++) /* their sums are the Bernstein coefficients */
        for (uint32_t i = m; i >= k; i--)
            out[i] += out[i - 1];
}

/* A part of a piece with what the certificates share. */
typedef struct part {
    const knot *lo, *hi;
    double x1[MAX_M], y1[MAX_M]; /* hodographs */
    double h;
} part;

/* s' = (x / s) x': the quotient as two factors, so that s may be 0; through the axis it is 1 at the
 * pole too. */
typedef struct ratio {
    double x, s;
} ratio;

static ratio ratio_at(const cut *r, const knot *end)
{
    return r->c > 0.0 ? (ratio){end->x, end->s} : (ratio){1.0, 1.0};
}

/* Range of s e' = g x x' - s_l y' s over the hodograph, with x / s at either end: e' lies between
 * the quotients by those s. One sign: e is monotone. */
static range slope_range(const cut *r, const side *a, const part *p, ratio end)
{
    range out = {HUGE_VAL, -HUGE_VAL};
    for (uint32_t i = 0; i < a->n; i++) {
        double f = a->g * end.x * p->x1[i] - r->s_l * p->y1[i] * end.s;
        out.lo = fl_min(out.lo, f);
        out.hi = fl_max(out.hi, f);
    }
    return out;
}

/* Whether e, of one sign at both ends, stays away from 0 by the mean value theorem, or is flat to
 * rounding. */
static bool stays_away(const cut *r, const part *p, range e1)
{
    double lo = p->lo->e, hi = p->hi->e;
    if (p->h * fl_max(fabs(e1.lo), fabs(e1.hi)) <= 4.0 * r->tiny)
        return true;
    if (lo < 0.0) {
        lo = -lo;
        hi = -hi;
        e1 = (range){-e1.hi, -e1.lo};
    }
    if (e1.lo >= 0.0 || e1.hi <= 0.0)
        return true;
    /* The lowest point between a fall at e1.lo and a rise at e1.hi. */
    double at = (lo - hi + e1.hi * p->h) / (e1.hi - e1.lo);
    return lo + e1.lo * at > 0.0;
}

/* Whether the cut curve is convex on the part: x s^2 (x'y'' - x''y') + c^2 y' x'^2 keeps its sign.
 */
static bool is_part_convex(const cut *r, const side *a, const part *p)
{
    double x2[MAX_M], y2[MAX_M], m = (double)(a->n - 1) / p->h;
    for (uint32_t i = 0; i + 1 < a->n; i++) {
        x2[i] = (p->x1[i + 1] - p->x1[i]) * m;
        y2[i] = (p->y1[i + 1] - p->y1[i]) * m;
    }
    range x1 = range_of(p->x1, a->n), y1 = range_of(p->y1, a->n);
    range first = range_mul(x1, range_of(y2, a->n - 1)),
          second = range_mul(range_of(x2, a->n - 1), y1);
    range bend = range_abs((range){first.lo - second.hi, first.hi - second.lo});
    x1 = range_abs(x1);
    y1 = range_abs(y1);
    double v0 = p->lo->x * p->lo->s * p->lo->s, v1 = p->hi->x * p->hi->s * p->hi->s,
           c2 = r->c * r->c;
    double bend_lo = fl_min(v0, v1) * bend.lo, bend_hi = fl_max(v0, v1) * bend.hi;
    double turn_lo = c2 * y1.lo * x1.lo * x1.lo, turn_hi = c2 * y1.hi * x1.hi * x1.hi;
    return bend_hi <= turn_lo || turn_hi <= bend_lo;
}

/* Index of the control vector of the hodograph along the tangent at an end: the first that is not
 * lost in rounding, which at a cusp is not the outermost. */
static uint32_t tangent_at(const part *p, uint32_t n, uint32_t first, int step)
{
    double size = 0.0;
    for (uint32_t i = 0; i < n; i++)
        size = fl_max(size, fabs(p->x1[i]) + fabs(p->y1[i]));
    uint32_t at = first;
    for (uint32_t i = 1; i < n && fabs(p->x1[at]) + fabs(p->y1[at]) <= 1e-13 * size; i++)
        at += (uint32_t)step;
    return at;
}

/* For a convex part with one sign at both ends: whether it certainly stays on its side of the line.
 * `*out_split` is where to cut it otherwise. The slopes are s e', of the sign of e'. */
static bool convex_stays(const cut *r, const side *a, const part *p, double *out_split)
{
    const knot *lo = p->lo, *hi = p->hi;
    uint32_t i = tangent_at(p, a->n, 0, 1), j = tangent_at(p, a->n, a->n - 1, -1);
    ratio from = ratio_at(r, lo), to = ratio_at(r, hi);
    double f0 = a->g * from.x * p->x1[i] - r->s_l * p->y1[i] * from.s;
    double f1 = a->g * to.x * p->x1[j] - r->s_l * p->y1[j] * to.s;
    double away = lo->e < 0.0 ? -1.0 : 1.0;
    if (!(away * f0 < 0.0 && away * f1 > 0.0))
        return true; /* monotone, or bulging away */
    double v = f0 / (f0 - f1);
    *out_split = lo->t + p->h * fl_clamp(v, 0.1, 0.9);
    /* The tangents at the ends, directions (sigma x x', y' s), meet at e0 + along f0: the curve
     * stays on the ends' side of that point. */
    double tx0 = a->sigma * from.x * p->x1[i], ty0 = p->y1[i] * from.s;
    double tx1 = a->sigma * to.x * p->x1[j], ty1 = p->y1[j] * to.s;
    double cx = a->sigma * (hi->s - lo->s), cy = hi->y - lo->y;
    double along = (cx * ty1 - cy * tx1) / (tx0 * ty1 - ty0 * tx1);
    return along >= 0.0 && away * (lo->e + along * f0) > -4.0 * r->tiny;
}

/* One or no root for certain (true; then roots exist iff the signs differ), or where to cut. */
static bool is_decided(const cut *r, const side *a, part *p, double *out_split)
{
    const knot *lo = p->lo, *hi = p->hi;
    bool same = !cut_crosses(lo, hi);
    double a0 = a->g * lo->s, a1 = a->g * hi->s;
    if ((a1 - a0) * (hi->q - lo->q) <= 0.0)
        return true; /* g s and -q run the same way */
    if (same && (fl_max(a0, a1) < fl_min(lo->q, hi->q) || fl_min(a0, a1) > fl_max(lo->q, hi->q)))
        return true;
    p->h = hi->t - lo->t;
    *out_split = 0.5 * (lo->t + hi->t);
    if (!(p->h > 1e-10))
        return true;
    hodograph(a->px, a->n, lo->t, hi->t, p->x1);
    hodograph(a->py, a->n, lo->t, hi->t, p->y1);
    ratio from = ratio_at(r, lo), to = ratio_at(r, hi);
    range f0 = slope_range(r, a, p, from), f1 = slope_range(r, a, p, to);
    if ((f0.lo >= 0.0 && f1.lo >= 0.0) || (f0.hi <= 0.0 && f1.hi <= 0.0))
        return true;
    if (from.s > 0.0 && to.s > 0.0) {
        range e1 = {fl_min(f0.lo / from.s, f1.lo / to.s), fl_max(f0.hi / from.s, f1.hi / to.s)};
        if (same ? stays_away(r, p, e1) : p->h * fl_max(-e1.lo, e1.hi) <= 4.0 * r->tiny)
            return true;
    }
    if (!a->is_convex && !is_part_convex(r, a, p))
        return false;
    return !same || convex_stays(r, a, p, out_split);
}

void fl_revolve_search(cut *r, const side *a, knot lo, knot hi)
{
    knot stack[STACK][2];
    uint32_t top = 1;
    stack[0][0] = lo;
    stack[0][1] = hi;
    for (int step = 0; top > 0 && !(r->any && r->found); step++) {
        part p;
        double split = 0.0;
        lo = stack[--top][0];
        hi = stack[top][1];
        p.lo = &lo;
        p.hi = &hi;
        if (is_decided(r, a, &p, &split) || step >= MAX_STEPS || top + 2 > STACK) {
            if (cut_crosses(&lo, &hi))
                cut_accept(r, a, cut_root(r, a, &lo, &hi, false));
            continue;
        }
        knot mid = cut_knot(r, a->g, split, fl_revolve_poly(a->px, a->n, split),
                            fl_revolve_poly(a->py, a->n, split));
        stack[top][0] = lo;
        stack[top++][1] = mid;
        stack[top][0] = mid;
        stack[top++][1] = hi;
    }
}
