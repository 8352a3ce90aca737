/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to revolve_solve.c and revolve_certify.c: roots known to be single, by Newton's
 * iteration kept in a bracket.
 */
#ifndef FL_REVOLVE_ROOT_H
#define FL_REVOLVE_ROOT_H

#include "core/revolve_cut.h"

/* What the iteration runs on at some t: f with slope m / scale. By e itself, or by square:
 *     (g^2 s^2 - q^2) sign g,
 * a polynomial that has the sign of e where g and q agree in sign; elsewhere e has the sign of g.
 */
typedef struct cut_value {
    double f, m, scale;
    double small;  /* |f| up to this is a root to rounding */
    bool negative; /* e < 0 */
    bool agrees;   /* f stands for e, not for the other side of the axis */
} cut_value;

FL_INLINE cut_value cut_value_at(const cut *r, const side *a, double t, bool by_square)
{
    const double g = a->g, c = r->c, near = 1.5 * r->tiny;
    double x1, y1, x = fl_revolve_poly_slope(a->px, a->n, t, &x1);
    double y = fl_revolve_poly_slope(a->py, a->n, t, &y1);
    double q = r->s_l * y + r->k, s2 = (x - c) * (x + c);
    if (by_square) {
        double g2 = g * fabs(g), sign = g < 0.0 ? -1.0 : 1.0, f = g2 * s2 - sign * q * q;
        double m = 2.0 * (g2 * x * x1 - sign * q * r->s_l * y1);
        bool agrees = g * q > 0.0;
        return (cut_value){f, m, 1.0, 2.0 * near * fabs(q), agrees ? f < 0.0 : g < 0.0, agrees};
    }
    double s = x > c ? sqrt(s2) : 0.0, f = g * s - q;
    return (cut_value){f, g * x * x1 - r->s_l * y1 * s, s, near, f < 0.0, true};
}

/* f and its slope at a knot. */
FL_INLINE double cut_end(const cut *r, const side *a, const knot *k, bool by_square,
                         double *out_slope)
{
    const double g = a->g;
    double x1, y1;
    fl_revolve_poly_slope(a->px, a->n, k->t, &x1);
    fl_revolve_poly_slope(a->py, a->n, k->t, &y1);
    if (by_square) {
        double g2 = g * fabs(g), sign = g < 0.0 ? -1.0 : 1.0;
        *out_slope = 2.0 * (g2 * k->x * x1 - sign * k->q * r->s_l * y1);
        return g2 * ((k->x - r->c) * (k->x + r->c)) - sign * k->q * k->q;
    }
    *out_slope = g * k->x * x1 / k->s - r->s_l * y1;
    return k->e;
}

/* Whether a knot is a root to rounding, with f crossing there the way it does between the ends
 * (rise: f at the far end minus f at the near one). Such a root is the node, as for the neighbour.
 */
FL_INLINE bool cut_is_node(const cut *r, const side *a, const knot *k, bool by_square, double rise,
                           double slope)
{
    return fabs(k->e) <= 1.5 * r->tiny && k->x >= r->c && rise * slope > 0.0 &&
           (!by_square || a->g * k->q > 0.0);
}

/* The root between two knots whose e differ in sign, where there is just one. `by_square` forces
 * that form, for a knot inside radius c; it is also taken where s varies more than q. */
FL_INLINE double cut_root(const cut *r, const side *a, const knot *lo, const knot *hi,
                          bool by_square)
{
    const bool lo_negative = lo->e < 0.0;
    double from = lo->t, to = hi->t, h = to - from, m0, m1;
    by_square = by_square || fabs(a->g * (hi->s - lo->s)) > fabs(hi->q - lo->q);
    double f0 = cut_end(r, a, lo, by_square, &m0), f1 = cut_end(r, a, hi, by_square, &m1);
    double df = f1 - f0, v = -f0 / df, v1 = 1.0 - v;
    if (cut_is_node(r, a, lo, by_square, df, m0))
        return from;
    if (cut_is_node(r, a, hi, by_square, df, m1))
        return to;
    /* Start: the cubic t(f) through both ends with their slopes; else the secant. */
    double t = from + h * (v * v * (3.0 - 2.0 * v)) + df * v * v1 * (v1 / m0 - v / m1);
    if (!(t > from && t < to) || fabs(m0) > 1e100 || fabs(m1) > 1e100)
        t = from + h * v;
    if (!(t > from && t < to))
        t = 0.5 * (from + to);
    double last = h, last_m = 0.0;
    bool was_newton = false;
    for (int step = 0; step < 100; step++) {
        cut_value e = cut_value_at(r, a, t, by_square);
        bool crosses = e.agrees && (e.m > 0.0) == lo_negative;
        if (e.agrees && fabs(e.f) <= e.small) {
            if (crosses)
                return t;
            e.negative =
                (t - lo->t < hi->t - t) == lo_negative; /* still at the end it leaves: noise */
        }
        *(e.negative == lo_negative ? &from : &to) = t;
        double next = t - e.f * e.scale / e.m, move = fabs(next - t);
        bool is_newton = crosses && e.scale > 0.0 && next > from && next < to && 2.0 * move <= last;
        if (!is_newton) {
            next = 0.5 * (from + to);
            move = fabs(next - t);
            if (!(next > from && next < to))
                return t;
        }
        t = next;
        /* The next error is about f'' / 2 f' times the square of this one. */
        bool is_last = is_newton && was_newton && move < 1e-4 &&
                       fabs(e.m - last_m * e.scale) * move * move <= 0x1p-53 * fabs(e.m) * last;
        if (is_last || move <= 0x1p-52 * t)
            return t;
        last = move;
        last_m = e.m / e.scale;
        was_newton = is_newton;
    }
    return t;
}

/* The knot where a piece passes radius c, in the place of its end that lies inside: there s = 0,
 * whatever the side. lo, hi: the ends of the piece. */
static inline void cut_clip(const cut *r, const side *a, knot *lo, knot *hi)
{
    knot *inner = lo->x < r->c ? lo : hi;
    const knot *outer = lo->x < r->c ? hi : lo;
    double in = inner->t, out = outer->t, last = 1.0, last_m = 0.0;
    double t = in + (out - in) * ((r->c - inner->x) / (outer->x - inner->x));
    bool was_newton = false;
    for (int step = 0; step < 100; step++) {
        double m, f = fl_revolve_poly_slope(a->px, a->n, t, &m) - r->c;
        if (f < 0.0)
            in = t;
        else
            out = t;
        if (fabs(f) <= 0.5 * r->tiny)
            break;
        double next = t - f / m, move = fabs(next - t);
        bool is_newton = (next - in) * (next - out) < 0.0 && 2.0 * move <= last;
        if (!is_newton) {
            next = 0.5 * (in + out);
            move = fabs(next - t);
            if (next == in || next == out)
                break;
        }
        t = next;
        if (move <= 0x1p-53 * t || (is_newton && was_newton && move < 1e-4 &&
                                    fabs(m - last_m) * move * move <= 0x1p-54 * fabs(m) * last))
            break;
        last = move;
        last_m = m;
        was_newton = is_newton;
    }
    /* Rounding must not turn the sign that both sides were told. */
    double y = fl_revolve_poly(a->py, a->n, t), q = r->s_l * y + r->k;
    q = fl_clamp(q, fl_min(lo->q, hi->q), fl_max(lo->q, hi->q));
    *inner = (knot){t, r->c, y, 0.0, q, -q};
}

#endif
