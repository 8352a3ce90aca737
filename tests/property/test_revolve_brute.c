/* SPDX-License-Identifier: MIT
 *
 * Surfaces of revolution against a brute force that shares nothing with the solver: the profile as
 * a polyline of cone frustums, each met by the quadratic formula. And the preprocessing against
 * arbitrary control points. test_revolve_brute [ROUNDS]    default 150 profiles of 200 rays
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/revolve.h"
#include "support/property.h"

enum { FINE = 400, MAX_SEGMENTS = 6, RAYS = 200 };

static uint32_t rounds = 150;

static uint32_t draw_int(property *p, uint32_t count)
{
    return (uint32_t)property_below(p, count);
}

static fl_vec3 draw_point(property *p, double reach)
{
    fl_vec3 v;
    v.x = property_between(p, -reach, reach);
    v.y = property_between(p, -reach, reach);
    v.z = property_between(p, -reach, reach);
    return v;
}

/* The profile as given, and its polyline. */
typedef struct shape {
    fl_vec3 points[MAX_SEGMENTS * (FL_REVOLVE_MAX_DEGREE + 1)];
    fl_profile profile;
    double x[MAX_SEGMENTS * FINE + 1], y[MAX_SEGMENTS * FINE + 1];
    int count;
    double size;
} shape;

static fl_vec3 bezier(const fl_vec3 *p, uint32_t n, double t)
{
    fl_vec3 w[FL_REVOLVE_MAX_DEGREE + 1];
    memcpy(w, p, (n + 1) * sizeof *w);
    for (uint32_t k = n; k > 0; k--)
        for (uint32_t i = 0; i < k; i++)
            w[i] = fl_v3_add(fl_v3_scale(w[i], 1 - t), fl_v3_scale(w[i + 1], t));
    return w[0];
}

/* Joined segments with control points in a box around part of the axis. */
static void draw_shape(property *p, shape *s)
{
    uint32_t degree = 1 + draw_int(p, FL_REVOLVE_MAX_DEGREE);
    uint32_t segments = 1 + draw_int(p, MAX_SEGMENTS);
    s->profile = (fl_profile){.points = s->points, .segment_count = segments, .degree = degree};
    for (uint32_t i = 0; i < segments * (degree + 1); i++) {
        s->points[i].x = property_between(p, -0.4, 1.0);
        s->points[i].y = property_between(p, -1.0, 1.0);
        s->points[i].z = 0.0;
    }
    for (uint32_t i = 1; i < segments; i++)
        s->points[i * (degree + 1)] = s->points[i * (degree + 1) - 1];
    s->count = 0;
    for (uint32_t i = 0; i < segments; i++) {
        for (int k = i ? 1 : 0; k <= FINE; k++) {
            fl_vec3 at = bezier(s->points + i * (degree + 1), degree, (double)k / FINE);
            s->x[s->count] = at.x;
            s->y[s->count++] = at.y;
        }
    }
    s->size = 2.0;
}

/* The nearest u > 0 on the frustum between polyline points i and i + 1, with the cosine there;
 * HUGE_VAL: none. */
static double frustum(const shape *s, int i, fl_vec3 o, fl_vec3 d, double *out_cosine)
{
    double x0 = s->x[i], y0 = s->y[i], hx = s->x[i + 1] - x0, hy = s->y[i + 1] - y0;
    /* |o_xz + u d_xz|^2 hy^2 = (x0 hy + (o_y + u d_y - y0) hx)^2, one equation for cones, tubes and
     * discs. */
    double m0 = x0 * hy + (o.y - y0) * hx, m1 = d.y * hx;
    double a = (d.x * d.x + d.z * d.z) * hy * hy - m1 * m1;
    double b = (o.x * d.x + o.z * d.z) * hy * hy - m0 * m1;
    double c = (o.x * o.x + o.z * o.z) * hy * hy - m0 * m0;
    double best = HUGE_VAL, disc = b * b - a * c;
    if (!(disc >= 0.0))
        return best;
    double q = -(b + copysign(sqrt(disc), b)), roots[2] = {q / a, c / q};
    for (int k = 0; k < 2; k++) {
        double u = roots[k], y = o.y + u * d.y,
               rho = sqrt(pow(o.x + u * d.x, 2) + pow(o.z + u * d.z, 2));
        double v = fabs(hy) > fabs(hx) ? (y - y0) / hy : -1.0;
        if (fabs(hy) <= fabs(hx)) { /* by radius; x may change its sign on the way */
            double v1 = (rho - x0) / hx, v2 = (-rho - x0) / hx;
            v = fabs(y0 + v1 * hy - y) < fabs(y0 + v2 * hy - y) ? v1 : v2;
        }
        if (!(u > 0.0 && u < best && v >= 0.0 && v <= 1.0))
            continue;
        double x = x0 + v * hx, radial = ((o.x + u * d.x) * d.x + (o.z + u * d.z) * d.z) / rho *
                                         (x < 0 ? -1.0 : 1.0);
        if (fabs(fabs(x) - rho) > 1e-6 || fabs(y0 + v * hy - y) > 1e-6)
            continue; /* the mirrored cone */
        *out_cosine = fabs(radial * hy - d.y * hx) / sqrt(hx * hx + hy * hy) / fl_v3_length(d);
        best = u;
    }
    return best;
}

/* Distance of a point in the half plane (rho, y) from the polyline. */
static double distance(const shape *s, double rho, double y)
{
    double best = HUGE_VAL;
    for (int i = 0; i + 1 < s->count; i++) {
        for (int mirror = 0; mirror < 2; mirror++) {
            double f = mirror ? -1.0 : 1.0, hx = f * (s->x[i + 1] - s->x[i]),
                   hy = s->y[i + 1] - s->y[i];
            double px = rho - f * s->x[i], py = y - s->y[i], h2 = hx * hx + hy * hy;
            double v = h2 > 0 ? fl_clamp((px * hx + py * hy) / h2, 0.0, 1.0) : 0.0;
            best = fl_min(best, sqrt(pow(px - v * hx, 2) + pow(py - v * hy, 2)));
        }
    }
    return best;
}

/* What the polyline sweeps out, but for a factor of pi. */
static double area(const shape *s)
{
    double sum = 0.0;
    for (int i = 0; i + 1 < s->count; i++)
        sum += fabs(s->x[i] + s->x[i + 1]) * hypot(s->x[i + 1] - s->x[i], s->y[i + 1] - s->y[i]);
    return sum;
}

/* Every hit lies on the surface; no clear crossing of the polyline lies in front of it. Polyline
 * and curve are some 1e-4 apart (15^2 / 8 of the step squared), which a cosine above 0.05 turns
 * into at most 2e-3 along the ray: a ray may begin between the two. */
static bool check_ray(property *test, const shape *s, const fl_revolve *revolve, fl_vec3 o,
                      fl_vec3 d)
{
    const double gap = 2e-4 * s->size;
    double oo[3] = {o.x, o.y, o.z}, dd[3] = {d.x, d.y, d.z}, length = fl_v3_length(d), cosine = 0.0;
    fl_revolve_hit hit = {.u = HUGE_VAL};
    bool is_hit = fl_revolve_nearest(revolve, oo, dd, 0.0, HUGE_VAL, FL_REVOLVE_ROBUST, &hit);
    if (is_hit) {
        fl_vec3 p = fl_v3_mad(o, d, hit.u),
                q = bezier(s->points + hit.segment * (s->profile.degree + 1), s->profile.degree,
                           hit.t);
        double rho = sqrt(p.x * p.x + p.z * p.z);
        bool is_in_range = hit.u > 0.0 && hit.t >= 0.0 && hit.t <= 1.0;
        bool is_on_curve = fabs(rho - fabs(q.x)) < 1e-13 && fabs(p.y - q.y) < 1e-13;
        if (!is_in_range || !is_on_curve || !(distance(s, rho, p.y) < gap))
            return property_fail(test, "a hit beside the surface: u %.17g, t %.17g", hit.u, hit.t);
    }
    for (int i = 0; i + 1 < s->count; i++) {
        double u = frustum(s, i, o, d, &cosine);
        bool is_clear = cosine > 0.05 && u * length * cosine > 2 * gap;
        if (is_clear && (hit.u - u) * length * cosine > 2 * gap && i > 4 && i + 6 < s->count) {
            /* The polyline's own corners may graze where the curve does not: the ray must pass from
             * side to side. */
            double a = 0.0, b = 0.0;
            double before = frustum(s, i - 1, o, d, &a), after = frustum(s, i + 1, o, d, &b);
            if (before == HUGE_VAL && after == HUGE_VAL)
                return property_fail(test, "missed a crossing at u %.9g, cosine %g; answer %.9g", u,
                                     cosine, hit.u);
        }
    }
    return true;
}

static bool agrees_with_brute_force(property *p, void *data)
{
    static shape s;
    fl_arena arena = {0};
    fl_diags diags = {0};
    (void)data;
    draw_shape(p, &s);
    fl_revolve *revolve = fl_revolve_build(&arena, &s.profile, &diags);
    bool holds =
        revolve || area(&s) < 1e-9 || property_fail(p, "refused: %s", diags.items[0].message);
    uint32_t count = revolve ? (uint32_t)property_given(p, RAYS, RAYS + 1) : 0;
    for (uint32_t i = 0; holds && i < count; i++) {
        property_mark(p);
        bool is_near = draw_int(p, 2);
        fl_vec3 o = draw_point(p, is_near ? 0.8 : 3.0), d = draw_point(p, 0.8);
        d = is_near ? d : fl_v3_sub(d, o);
        if (draw_int(p, 7) == 6)
            d.y = 0.0;
        holds = check_ray(p, &s, revolve, o, d);
    }
    fl_diags_deinit(&diags);
    fl_arena_deinit(&arena);
    return holds;
}

static void test_brute_force(void **state)
{
    (void)state;
    printf("%u profiles of %d rays\n", rounds, RAYS);
    /* A direction of length 4e-9, which a cut plane padded too little misses. */
    static const uint64_t tiny[] = {
        [1] = 2, [9] = 0x8000000000000, [15] = 0x4000000000000, [26] = 1, [29] = 0x800000};
    const property_case kept[] = {PROPERTY_CASE(tiny)};
    property_run(agrees_with_brute_force, NULL, 20, rounds, kept, FL_COUNT_OF(kept));
}

static double strange_value(property *p)
{
    static const double values[] = {0,      -0.0,   1,      -1,    0.5,   1e-300,
                                    1e300,  -1e300, 1e-17,  1e150, 1e199, 1e-199,
                                    1e-100, 1e100,  5e-324, 3,     1e-8,  1e8};
    return values[draw_int(p, FL_COUNT_OF(values))];
}

/* A shot at every piece of luck: a hit must be finite, in range and near its circle. */
static bool shoot_strange(property *test, const fl_revolve *revolve, double size)
{
    fl_box box = fl_revolve_bounds(revolve);
    double mid = 0.5 * box.lo.y + 0.5 * box.hi.y, o[3], d[3];
    bool is_plain = draw_int(test, 3);
    for (int k = 0; k < 3; k++) {
        o[k] = (k == 1 ? mid : 0.0) + size * property_between(test, -2, 2);
        d[k] = is_plain ? property_between(test, -1, 1) : strange_value(test);
    }
    fl_revolve_hit hit;
    if (!fl_revolve_nearest(revolve, o, d, 0.0, HUGE_VAL, FL_REVOLVE_ROBUST, &hit))
        return true;
    fl_revolve_point p;
    fl_revolve_resolve(revolve, o, d, &hit, &p);
    double off = 0.0, at[3] = {p.position.x, p.position.y, p.position.z};
    for (int k = 0; k < 3; k++)
        off = fl_max(off, fabs(o[k] + hit.u * d[k] - at[k]));
    bool is_in_range = hit.u > 0.0 && hit.t >= 0.0 && hit.t <= 1.0;
    bool is_finite = fl_v3_is_finite(p.position) && fabs(fl_v3_length(p.normal) - 1.0) < 1e-9;
    return (is_in_range && is_finite && off <= 1e-12 * (size + fabs(mid))) ||
           property_fail(test, "a hit at u %g, t %g, %g off its ray", hit.u, hit.t, off);
}

typedef struct outcomes {
    long built, refused;
} outcomes;

static bool arbitrary_points_do_no_harm(property *p, void *data)
{
    outcomes *outcome = data;
    fl_vec3 points[4 * (FL_REVOLVE_MAX_DEGREE + 1)];
    uint32_t degree = 1 + draw_int(p, FL_REVOLVE_MAX_DEGREE), segments = 1 + draw_int(p, 4);
    fl_profile profile = {.points = points, .segment_count = segments, .degree = degree};
    uint32_t kind = draw_int(p, 4);
    double radius = 0.0, lo = HUGE_VAL, hi = -HUGE_VAL;
    for (uint32_t i = 0; i < segments * (degree + 1); i++) {
        points[i].x = strange_value(p);
        points[i].y = strange_value(p);
        points[i].z = 0.0;
        if (kind == 1 && i > 0 && draw_int(p, 3)) /* runs of equal points */
            points[i] = points[i - 1];
        if (kind == 2) {
            points[i].x = draw_int(p, 3) - 1.0;
            points[i].y = draw_int(p, 3) - 1.0;
        }
        if (kind == 3 && draw_int(p, 60) == 59)
            points[i].x = draw_int(p, 2) ? (double)NAN : HUGE_VAL;
        radius = fl_max(fabs(points[i].x), radius);
        lo = fl_min(points[i].y, lo);
        hi = fl_max(points[i].y, hi);
    }
    fl_arena arena = {0};
    fl_diags diags = {0};
    fl_revolve *revolve = fl_revolve_build(&arena, &profile, &diags);
    bool holds = diags.error_count == (revolve ? 0 : 1) || property_fail(p, "not one error");
    uint32_t shots = revolve ? (uint32_t)property_given(p, 20, 21) : 0;
    for (uint32_t i = 0; holds && i < shots; i++) {
        property_mark(p);
        holds = shoot_strange(p, revolve, fl_max(radius, hi - lo));
    }
    outcome->built += revolve != NULL;
    outcome->refused += revolve == NULL;
    fl_diags_deinit(&diags);
    fl_arena_deinit(&arena);
    return holds;
}

static void test_arbitrary_control_points(void **state)
{
    (void)state;
    outcomes outcome = {0};
    property_run(arbitrary_points_do_no_harm, &outcome, 21, 40 * rounds, NULL, 0);
    printf("%ld built, %ld refused\n", outcome.built, outcome.refused);
    assert_true(outcome.built > 0 && outcome.refused > 0);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        rounds = (uint32_t)strtoul(argv[1], NULL, 10);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_brute_force),
        cmocka_unit_test(test_arbitrary_control_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
