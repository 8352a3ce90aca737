/* SPDX-License-Identifier: MIT
 *
 * The baseline: the method of the classic course project, Newton's iteration on
 *     h(t) = sqrt(A (y(t) - B)^2 + C) - |x(t)|
 * from the middles of equal parts of every segment, nothing skipped. Kept as it is so that
 * the trade stays measurable; its misses are its own (docs/revolution.md).
 */
#include "core/revolve_impl.h"

enum { MAX_STEPS = 20 };

#define FLAT 1e-4 /* |d_y| / |d| below which y(t) = o_y is solved first */

typedef struct ray {
    double ox, oy, oz, dx, dy, dz; /* in units, y relative to y_center */
    double q;                      /* dx^2 + dz^2 */
    double a, b, c;                /* of h */
    bool is_flat;
} ray;

/* Newton on y(t) = oy. */
static bool solve_height(const ray *r, const double *cy, uint32_t n, double *t)
{
    for (int step = 0; step < MAX_STEPS; step++) {
        double slope, value = fl_revolve_poly_slope(cy, n, *t, &slope) - r->oy;
        if (fabs(value) < 1e-13)
            return true;
        *t -= value / slope;
        if (!(*t > -0.5 && *t < 1.5))
            return false;
    }
    return false;
}

/* Newton on h. */
static bool solve_radius(const ray *r, const double *cx, const double *cy, uint32_t n, double *t)
{
    for (int step = 0; step < MAX_STEPS; step++) {
        double x1, y1, x = fl_revolve_poly_slope(cx, n, *t, &x1),
                       y = fl_revolve_poly_slope(cy, n, *t, &y1) - r->b;
        double root = sqrt(r->a * y * y + r->c), value = root - fabs(x);
        if (fabs(value) < 1e-13)
            return true;
        *t -= value / (r->a * y * y1 / root - copysign(x1, x * x1));
        if (!(*t > -0.5 && *t < 1.5))
            return false;
    }
    return false;
}

/* Of a horizontal ray: the distances to radius |x|, the nearer first. */
static int horizontal(const ray *r, double x, double *out_u)
{
    double m = r->ox * r->dx + r->oz * r->dz, cross = r->ox * r->dz - r->oz * r->dx;
    double inside = r->q * x * x - cross * cross;
    if (!(inside >= 0.0))
        return 0;
    out_u[0] = (-m - sqrt(inside)) / r->q;
    out_u[1] = (-m + sqrt(inside)) / r->q;
    return 2;
}

static int solve_start(const ray *r, const double *cx, const double *cy, uint32_t n, double *t,
                       double *out_u)
{
    if (r->is_flat && !solve_height(r, cy, n, t))
        return 0;
    double guess = *t;
    if (r->dy != 0.0 && solve_radius(r, cx, cy, n, t)) {
        if (*t < 0.0 || *t > 1.0)
            return 0;
        out_u[0] = (fl_revolve_poly(cy, n, *t) - r->oy) / r->dy;
        return 1;
    }
    *t = guess;
    return r->is_flat && guess >= 0.0 && guess <= 1.0
               ? horizontal(r, fl_revolve_poly(cx, n, guess), out_u)
               : 0;
}

/* The piece that holds parameter t of a segment, for fl_revolve_resolve. */
static void find_piece(const fl_revolve *revolve, fl_revolve_hit *hit)
{
    for (uint32_t i = 0; i < revolve->piece_count; i++) {
        const double *range = fl_revolve_piece(revolve, i) + revolve->stride - 2;
        if (revolve->segment[i] == hit->segment && hit->t <= range[0] + range[1]) {
            hit->sheet = i;
            hit->local = fl_clamp((hit->t - range[0]) / range[1], 0.0, 1.0);
            return;
        }
    }
}

bool fl_revolve_newton(const fl_revolve *revolve, const double o[3], const double d[3],
                       double u_min, double u_max, uint32_t starts, fl_revolve_hit *out_hit)
{
    ray r = {.ox = o[0] * revolve->unit,
             .oy = o[1] * revolve->unit - revolve->y_center,
             .oz = o[2] * revolve->unit,
             .dx = d[0] * revolve->unit,
             .dy = d[1] * revolve->unit,
             .dz = d[2] * revolve->unit};
    r.q = r.dx * r.dx + r.dz * r.dz;
    double m = r.ox * r.dx + r.oz * r.dz, cross = r.ox * r.dz - r.oz * r.dx;
    r.is_flat = fabs(r.dy) < FLAT * sqrt(r.q + r.dy * r.dy);
    r.a = r.q / (r.dy * r.dy);
    r.b = r.q > 0.0 ? r.oy - r.dy * m / r.q : 0.0;
    r.c = r.q > 0.0 ? cross * cross / r.q : r.ox * r.ox + r.oz * r.oz;
    uint32_t n = revolve->newton_degree;
    bool found = false;
    for (uint32_t s = 0; s < revolve->segment_count; s++) {
        const double *cx = revolve->newton + (size_t)s * 2 * (n + 1), *cy = cx + n + 1;
        for (uint32_t start = 0; start < starts; start++) {
            double t = (start + 0.5) / starts, u[2];
            int count = solve_start(&r, cx, cy, n, &t, u);
            for (int i = 0; i < count; i++) {
                if (u[i] > u_min && u[i] < u_max) {
                    u_max = u[i];
                    *out_hit = (fl_revolve_hit){.u = u[i], .t = t, .segment = s};
                    found = true;
                }
            }
        }
    }
    if (found)
        find_piece(revolve, out_hit);
    return found;
}
