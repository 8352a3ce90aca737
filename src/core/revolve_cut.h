/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to revolve_solve*.c: the ray in its cut plane.
 *
 * The vertical plane through the ray cuts the surface in the curve (p, y) = (+-s(t), y(t)), s = sqrt(x^2 - c^2),
 * c the distance of ray and axis, and the ray is the line d_y p - s_l y = k there (d_y, s_l: vertical and
 * horizontal part of the unit direction). On side sigma = +-1 the roots of
 *     e(t) = g s(t) - q(t),   g = sigma d_y,   q = s_l y(t) + k
 * are the hits; e is a true distance, nothing is divided by d_y. 0 counts as positive everywhere.
 */
#ifndef FL_REVOLVE_CUT_H
#define FL_REVOLVE_CUT_H

#include "core/revolve_impl.h"
#include "core/wide.h"

typedef struct cut {
    double c, k, s_l, d_y;
    double w0, per_u, u_per_w; /* w = s_l p + d_y y = w0 + u per_u along the ray; u_per_w = 1 / per_u */
    double u_min;
    double tiny; /* 2^-53 S */
    bool any;    /* the first root will do */
    bool found;
    /* Best root so far: u and w are limits while there is none. */
    double u, w, local;
    uint32_t piece;
} cut;

/* A point of a piece as the ray sees it. */
typedef struct knot {
    double t, x, y, s, q, e;
} knot;

/* A candidate: a piece on one side of the axis. px, py: coefficients of degree n. */
typedef struct side {
    const double *px, *py;
    uint32_t n, piece;
    double sigma, g;
    bool is_convex;
} side;

FL_INLINE double cut_s(const cut *r, double x)
{
    double s2 = (x - r->c) * (x + r->c);
    return x > r->c ? sqrt(s2) : 0.0;
}

FL_INLINE knot cut_knot(const cut *r, double g, double t, double x, double y)
{
    double s = cut_s(r, x), q = r->s_l * y + r->k;
    return (knot){t, x, y, s, q, g * s - q};
}

/* Whether e changes sign between two knots. */
FL_INLINE bool cut_crosses(const knot *a, const knot *b)
{
    return (a->e < 0.0) != (b->e < 0.0);
}

/* Record the root at parameter t of a side if it is the nearest so far in range. */
FL_INLINE void cut_accept(cut *r, const side *a, double t)
{
    double x = fl_revolve_poly(a->px, a->n, t), y = fl_revolve_poly(a->py, a->n, t);
    double s = cut_s(r, x), slope = fabs(r->d_y), p = a->sigma * s;
    /* Where s is badly determined by x, the line gives p. */
    if (slope * x > s && slope * slope * x > r->tiny)
        p = (r->s_l * y + r->k) / r->d_y;
    double w = r->s_l * p + r->d_y * y, u = (w - r->w0) * r->u_per_w;
    if (u > r->u_min && u < r->u) {
        r->found = true;
        r->u = u;
        r->w = w;
        r->local = t;
        r->piece = a->piece;
    }
}

/* The root between two knots whose e differ in sign, where there is just one: Newton's iteration kept in the
 * bracket. Where s varies more than q the iteration runs on g^2 s^2 - q^2, a polynomial, which has the sign of e up
 * to that of g when g and q agree, and else e has the sign of g. `by_square` forces that. */
FL_INLINE double cut_root(const cut *r, const side *a, const knot *lo, const knot *hi, bool by_square)
{
    const double *px = a->px, *py = a->py, g = a->g, g2 = g * fabs(g), s_l = r->s_l, c = r->c;
    const bool lo_negative = lo->e < 0.0;
    double from = lo->t, to = hi->t, f0, f1, x1, y1;
    double slope_x0, slope_y0, slope_x1, slope_y1, m0, m1;
    fl_revolve_poly_slope(px, a->n, from, &slope_x0);
    fl_revolve_poly_slope(py, a->n, from, &slope_y0);
    fl_revolve_poly_slope(px, a->n, to, &slope_x1);
    fl_revolve_poly_slope(py, a->n, to, &slope_y1);
    by_square = by_square || fabs(g * (hi->s - lo->s)) > fabs(hi->q - lo->q);
    double sign = g < 0.0 ? -1.0 : 1.0; /* g2 carries the sign of g, so the sign of q^2 must follow */
    if (by_square) {
        f0 = g2 * ((lo->x - c) * (lo->x + c)) - sign * lo->q * lo->q;
        f1 = g2 * ((hi->x - c) * (hi->x + c)) - sign * hi->q * hi->q;
        m0 = 2.0 * (g2 * lo->x * slope_x0 - sign * lo->q * s_l * slope_y0);
        m1 = 2.0 * (g2 * hi->x * slope_x1 - sign * hi->q * s_l * slope_y1);
    } else {
        f0 = lo->e;
        f1 = hi->e;
        m0 = g * lo->x * slope_x0 / lo->s - s_l * slope_y0;
        m1 = g * hi->x * slope_x1 / hi->s - s_l * slope_y1;
    }
    /* A root at a node to rounding: take the node, as the neighbour would. */
    const double near = 1.5 * r->tiny;
    if (fabs(lo->e) <= near && lo->x >= c && (f1 - f0) * m0 > 0.0 && (!by_square || g * lo->q > 0.0))
        return from;
    if (fabs(hi->e) <= near && hi->x >= c && (f1 - f0) * m1 > 0.0 && (!by_square || g * hi->q > 0.0))
        return to;
    /* Start: the cubic t(f) through both ends with their slopes; else the secant. */
    double df = f1 - f0, v = -f0 / df, v1 = 1.0 - v, h = to - from;
    double t = from + h * (v * v * (3.0 - 2.0 * v)) + df * v * v1 * (v1 / m0 - v / m1);
    if (!(t > from && t < to) || fabs(m0) > 1e100 || fabs(m1) > 1e100)
        t = from + h * v;
    if (!(t > from && t < to))
        t = 0.5 * (from + to);
    double last = h, last_m = 0.0;
    bool was_newton = false;
    for (int step = 0; step < 100; step++) {
        double x = fl_revolve_poly_slope(px, a->n, t, &x1), y = fl_revolve_poly_slope(py, a->n, t, &y1);
        double q = s_l * y + r->k, s2 = (x - c) * (x + c), f, m, small, scale = 1.0; /* slope of f: m / scale */
        bool negative, agrees = true;
        if (by_square) {
            f = g2 * s2 - sign * q * q;
            m = 2.0 * (g2 * x * x1 - sign * q * s_l * y1);
            agrees = g * q > 0.0; /* else f may vanish for the other side */
            negative = agrees ? f < 0.0 : g < 0.0;
            small = 2.0 * near * fabs(q);
        } else {
            double s = x > c ? sqrt(s2) : 0.0;
            f = g * s - q;
            m = g * x * x1 - s_l * y1 * s;
            scale = s;
            negative = f < 0.0;
            small = near;
        }
        bool crosses = agrees && (m > 0.0) == lo_negative;
        if (agrees && fabs(f) <= small) {
            if (crosses)
                return t;
            negative = (t - lo->t < hi->t - t) == lo_negative; /* still at the end it leaves: noise */
        }
        if (negative == lo_negative)
            from = t;
        else
            to = t;
        double next = t - f * scale / m, move = fabs(next - t);
        bool is_newton = crosses && scale > 0.0 && next > from && next < to && 2.0 * move <= last;
        if (!is_newton) {
            next = 0.5 * (from + to);
            move = fabs(next - t);
            if (!(next > from && next < to))
                return t;
        }
        t = next;
        /* The next error is about f'' / 2 f' times the square of this one. */
        if (move <= 0x1p-52 * t || (is_newton && was_newton && move < 1e-4 &&
                                fabs(m - last_m * scale) * move * move <= 0x1p-53 * fabs(m) * last))
            return t;
        last = move;
        last_m = m / scale;
        was_newton = is_newton;
    }
    return t;
}

/* The knot where a piece passes radius c, in the place of its end that lies inside: there s = 0, whatever the
 * side. lo, hi: the ends of the piece. */
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

/** All roots of a side between two knots, recorded by cut_accept: halves until each part is certified to hold
 *  one root or none (revolve_certify.c). */
void fl_revolve_search(cut *r, const side *a, knot lo, knot hi);

#endif
