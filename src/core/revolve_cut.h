/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to revolve_solve*.c: the ray in its cut plane.
 *
 * The vertical plane through the ray cuts the surface in the curve (p, y) = (+-s(t), y(t)), s =
 * sqrt(x^2 - c^2), c the distance of ray and axis, and the ray is the line d_y p - s_l y = k there
 * (d_y, s_l: vertical and horizontal part of the unit direction). On side sigma = +-1 the roots of
 *     e(t) = g s(t) - q(t),   g = sigma d_y,   q = s_l y(t) + k
 * are the hits; e is a true distance, nothing is divided by d_y. 0 counts as positive everywhere.
 */
#ifndef FL_REVOLVE_CUT_H
#define FL_REVOLVE_CUT_H

#include "core/revolve_impl.h"
#include "core/wide.h"

typedef struct cut {
    double c, k, s_l, d_y;
    double w0, per_u,
        u_per_w; /* w = s_l p + d_y y = w0 + u per_u along the ray; u_per_w = 1 / per_u */
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

/** All roots of a side between two knots, recorded by cut_accept: halves until each part is
 * certified to hold one root or none (revolve_certify.c). */
void fl_revolve_search(cut *r, const side *a, knot lo, knot hi);

#endif
