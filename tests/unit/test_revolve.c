/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "core/revolve.h"

#define TURN 6.283185307179586

typedef struct shape {
    fl_arena arena;
    fl_revolve *revolve;
} shape;

static bool try_build(shape *s, const double (*p)[2], uint32_t segments, uint32_t degree,
                      char *message, size_t message_bytes)
{
    fl_diags diags = {0};
    *s = (shape){0};
    fl_profile profile = {.segment_count = segments, .degree = degree};
    profile.points =
        fl_arena_alloc(&s->arena, (size_t)segments * (degree + 1), sizeof *profile.points);
    assert_non_null(profile.points);
    for (size_t i = 0; i < (size_t)segments * (degree + 1); i++)
        profile.points[i] = fl_v3(p[i][0], p[i][1], 0.0);
    s->revolve = fl_revolve_build(&s->arena, &profile, &diags);
    assert_int_equal(diags.error_count, s->revolve ? 0 : 1);
    snprintf(message, message_bytes, "%s", s->revolve ? "" : diags.items[0].message);
    fl_diags_deinit(&diags);
    return s->revolve != NULL;
}

static void build(shape *s, const double (*p)[2], uint32_t segments, uint32_t degree)
{
    char message[256];
    if (!try_build(s, p, segments, degree, message, sizeof message))
        fail_msg("%s", message);
}

static bool shoot(const shape *s, fl_vec3 o, fl_vec3 d, double u_min, double u_max,
                  fl_revolve_hit *hit)
{
    double oo[3] = {o.x, o.y, o.z}, dd[3] = {d.x, d.y, d.z};
    bool found = fl_revolve_nearest(s->revolve, oo, dd, u_min, u_max, FL_REVOLVE_ROBUST, hit);
    assert_int_equal(fl_revolve_any(s->revolve, oo, dd, u_min, u_max, FL_REVOLVE_ROBUST), found);
    return found;
}

static fl_revolve_point resolve(const shape *s, fl_vec3 o, fl_vec3 d, const fl_revolve_hit *hit)
{
    double oo[3] = {o.x, o.y, o.z}, dd[3] = {d.x, d.y, d.z};
    fl_revolve_point point;
    fl_revolve_resolve(s->revolve, oo, dd, hit, &point);
    assert_true(fabs(fl_v3_length(point.normal) - 1.0) < 1e-12);
    assert_true(point.u > 0.0 && point.u <= 1.0 && point.v >= 0.0 && point.v <= 1.0);
    return point;
}

/* Radius 2 around the axis, height 0 to 3. */
static const double tube[][2] = {{2, 0}, {2, 3}};
/* A cone with its tip up at (0, 1). */
static const double cone[][2] = {{1, -1}, {0, 1}};
#define K 0.5522847498307936
static const double torus[][2] = {
    {3, 0}, {3, K},  {2 + K, 1},  {2, 1},  {2, 1},  {2 - K, 1},  {1, K},  {1, 0},
    {1, 0}, {1, -K}, {2 - K, -1}, {2, -1}, {2, -1}, {2 + K, -1}, {3, -K}, {3, 0}};
static const double cusp[][2] = {{0.5, 0}, {1.5, 1}, {0.5, 1}, {1.5, 0}};
static const double vase[][2] = {{0.4, 0.0}, {1.5, 0.7}, {0.0, 1.5}, {0.6, 2.2}};

static void test_tube(void **state)
{
    (void)state;
    shape s;
    fl_revolve_hit hit;
    build(&s, tube, 1, 1);
    fl_vec3 o = fl_v3(-5, 1, 0), d = fl_v3(2, 0, 0);
    assert_true(shoot(&s, o, d, 0.0, HUGE_VAL, &hit));
    assert_true(fabs(hit.u - 1.5) < 1e-15 && hit.segment == 0 && fabs(hit.t - 1.0 / 3.0) < 1e-15);
    fl_revolve_point p = resolve(&s, o, d, &hit);
    assert_true(fabs(p.position.x + 2) < 1e-15 && fabs(p.position.y - 1) < 1e-15 &&
                p.position.z == 0);
    assert_true(p.normal.x < -0.999999 && fabs(p.u - 0.5) < 1e-15 && fabs(p.v - 1.0 / 3.0) < 1e-15);
    assert_true(p.scale == 3.0);
    assert_true(shoot(&s, o, d, 1.6, HUGE_VAL, &hit) && fabs(hit.u - 3.5) < 1e-15);
    assert_false(shoot(&s, o, d, 3.6, HUGE_VAL, &hit));
    assert_false(shoot(&s, o, d, 0.0, 1.4, &hit));
    assert_false(shoot(&s, o, fl_v3(-1, 0, 0), 0.0, HUGE_VAL, &hit));
    assert_true(shoot(&s, o, fl_v3(-1, 0, 0), -HUGE_VAL, 0.0, &hit) &&
                hit.u == -7.0); /* behind, nearest is least u */
    assert_false(shoot(&s, fl_v3(0, 1, 0), fl_v3(0, 1, 0), 0.0, HUGE_VAL, &hit));
    assert_false(
        shoot(&s, fl_v3(2, -1, 0), fl_v3(0, 1, 0), 0.0, HUGE_VAL, &hit)); /* along the wall */
    fl_box box = fl_revolve_bounds(s.revolve);
    assert_true(box.lo.x <= -2 && box.hi.z >= 2 && box.lo.y <= 0 && box.hi.y >= 3);
    assert_true(box.hi.x - 2 < 1e-14 && box.hi.y - 3 < 1e-14);
    fl_arena_deinit(&s.arena);
}

static void test_texture_runs_against_the_angle(void **state)
{
    (void)state;
    shape s;
    fl_revolve_hit hit;
    build(&s, tube, 1, 1);
    for (int i = 1; i < 16; i++) {
        double turn = i / 16.0;
        fl_vec3 d = fl_v3(cos(TURN * turn), 0, sin(TURN * turn)), o = fl_v3(0, 2, 0);
        assert_true(shoot(&s, o, d, 0.0, HUGE_VAL, &hit));
        fl_revolve_point p = resolve(&s, o, d, &hit);
        assert_true(fabs(p.u - (1.0 - turn)) < 1e-14 && fabs(p.v - 2.0 / 3.0) < 1e-15);
        assert_true(fl_v3_dot(p.normal, d) > 0.999999); /* outward, seen from inside */
    }
    fl_arena_deinit(&s.arena);
}

static void test_poles_and_cusps_have_normals(void **state)
{
    (void)state;
    shape s;
    fl_revolve_hit hit;
    build(&s, cone, 1, 1);
    fl_vec3 o = fl_v3(0, 5, 0), d = fl_v3(0, -1, 0);
    if (shoot(&s, o, d, 0.0, HUGE_VAL, &hit)) /* the tip itself: a hit or a touch, but finite */
        assert_true(resolve(&s, o, d, &hit).normal.y > 0.999);
    o = fl_v3(1e-9, 5, 0);
    assert_true(shoot(&s, o, d, 0.0, HUGE_VAL, &hit));
    assert_true(fabs(resolve(&s, o, d, &hit).normal.y - 1 / sqrt(5)) < 1e-9);
    fl_arena_deinit(&s.arena);

    build(&s, cusp, 1, 3);
    o = fl_v3(-4, 0.75, 0);
    d = fl_v3(1, 0, 0);
    for (double y = 0.7499999; y < 0.7500001; y += 1e-8) {
        o.y = y;
        if (shoot(&s, o, d, 0.0, HUGE_VAL, &hit))
            assert_true(fl_v3_is_finite(resolve(&s, o, d, &hit).normal));
    }
    fl_arena_deinit(&s.arena);
}

static void test_errors(void **state)
{
    (void)state;
    static const double nan_point[][2] = {{1, 0}, {(double)NAN, 1}},
                        inf_point[][2] = {{1, 0}, {1, HUGE_VAL}};
    static const double huge[][2] = {{1, 0}, {1e300, 1}}, small[][2] = {{1e-300, 0}, {0, 1e-300}};
    static const double point[][2] = {{1, 1}, {1, 1}}, axis[][2] = {{0, 0}, {0, 1}},
                        zero[][2] = {{0, 0}, {0, 0}};
    static const double many[17][2] = {{1, 1}};
    struct {
        const double (*p)[2];
        uint32_t segments, degree;
        const char *part;
    } cases[] = {{nan_point, 1, 1, "not finite"}, {inf_point, 1, 1, "not finite"},
                 {huge, 1, 1, "at most"},         {small, 1, 1, "too small"},
                 {point, 1, 1, "no area"},        {axis, 1, 1, "no area"},
                 {zero, 1, 1, "too small"},       {many, 1, 16, "degree"},
                 {many, 1, 0, "degree"},          {tube, 0, 1, "segments"}};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        shape s;
        char message[256];
        assert_false(
            try_build(&s, cases[i].p, cases[i].segments, cases[i].degree, message, sizeof message));
        if (!strstr(message, cases[i].part))
            fail_msg("case %zu says: %s", i, message);
        fl_arena_deinit(&s.arena);
    }
    fl_arena arena = {0};
    fl_diags diags = {0};
    fl_profile profile = {.segment_count = FL_REVOLVE_MAX_SEGMENTS + 1, .degree = 3};
    assert_null(fl_revolve_build(&arena, &profile, &diags));
    fl_diags_deinit(&diags);
    fl_arena_deinit(&arena);
}

static void test_strange_rays(void **state)
{
    (void)state;
    shape s;
    fl_revolve_hit hit;
    build(&s, torus, 4, 3);
    assert_false(shoot(&s, fl_v3(0, 0, 0), fl_v3(0, 0, 0), 0.0, HUGE_VAL, &hit));
    assert_false(shoot(&s, fl_v3((double)NAN, 0, 0), fl_v3(1, 0, 0), 0.0, HUGE_VAL, &hit));
    assert_false(shoot(&s, fl_v3(0, 0, 0), fl_v3((double)NAN, 1, 0), 0.0, HUGE_VAL, &hit));
    assert_false(shoot(&s, fl_v3(1e300, 0, 0), fl_v3(-1, 0, 0), 0.0, HUGE_VAL, &hit));
    /* Directions of any length: the same hit, u scaled. */
    for (int e = -1000; e <= 1000; e += 20) {
        double f = ldexp(1.0, e);
        assert_true(shoot(&s, fl_v3(-5, 0.1, 0.2), fl_v3(f, 0, 0), 0.0, HUGE_VAL, &hit));
        assert_true(fabs(hit.u * f - 2.0118) < 1e-3);
    }
    fl_arena_deinit(&s.arena);
}

/* From the hole of a torus through the tube: four crossings, all found one after the other. */
static void test_torus_is_hit_again(void **state)
{
    (void)state;
    shape s;
    build(&s, torus, 4, 3);
    for (int i = 0; i < 1000; i++) {
        double a = TURN * i / 1000.0, u = 0.0;
        fl_vec3 o = fl_v3(-9 * cos(a), 0.3 * sin(7 * a), -9 * sin(a)),
                d = fl_v3(cos(a), 0.0, sin(a));
        fl_revolve_hit hit;
        int count = 0;
        for (; count < 9 && shoot(&s, o, d, u, HUGE_VAL, &hit); count++) {
            fl_revolve_point p = resolve(&s, o, d, &hit);
            assert_true((fl_v3_dot(p.normal, d) < 0) ==
                        (count % 2 == 0)); /* enters, leaves, enters, leaves */
            double side = fl_v3_dot(p.normal, d) < 0 ? -1.0 : 1.0,
                   step = 16 * 0x1p-53 * p.scale * side;
            fl_revolve_hit again;
            fl_vec3 from = fl_v3_mad(p.position, p.normal, step);
            bool more = shoot(&s, from, d, 0.0, HUGE_VAL, &again);
            assert_int_equal(more, count < 3);
            u = hit.u * (1 + 1e-12);
        }
        assert_int_equal(count, 4);
    }
    fl_arena_deinit(&s.arena);
}

/* The whole picture of an object does not depend on its size. */
static void test_scale(void **state)
{
    (void)state;
    enum { SIDE = 400 };
    static uint8_t mask[3][SIDE * SIDE];
    const double scales[3] = {1e-6, 1.0, 1e6};
    for (int k = 0; k < 3; k++) {
        double p[4][2], f = scales[k];
        shape s;
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 2; j++)
                p[i][j] = f * vase[i][j];
        build(&s, (const double(*)[2])p, 1, 3);
        for (int i = 0; i < SIDE * SIDE; i++) {
            fl_vec3 d = fl_v3((i % SIDE + 0.5) / SIDE - 0.5, (i / SIDE + 0.5) / SIDE - 0.7, 1.6);
            fl_revolve_hit hit;
            mask[k][i] = shoot(&s, fl_v3(0.1 * f, 1.8 * f, -4 * f), d, 0.0, HUGE_VAL, &hit);
        }
        fl_arena_deinit(&s.arena);
    }
    assert_memory_equal(mask[0], mask[1], sizeof mask[0]);
    assert_memory_equal(mask[2], mask[1], sizeof mask[0]);
}

/* Single rays, packets and every instruction set of this machine: the same bits. */
static void test_packets_and_instruction_sets_agree(void **state)
{
    (void)state;
    shape s;
    build(&s, torus, 4, 3);
    uint32_t h = 12345;
    for (int round = 0; round < 4000; round++) {
        fl_revolve_packet rays;
        double *lanes[6] = {rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz};
        uint32_t mask = (h = fl_lowbias32(h + 1)) & 0xff, found[FL_ISA_COUNT] = {0};
        fl_revolve_hit hits[FL_ISA_COUNT][FL_REVOLVE_PACKET];
        for (int i = 0; i < FL_REVOLVE_PACKET; i++) {
            for (int k = 0; k < 6; k++)
                lanes[k][i] = ((h = fl_lowbias32(h + 1)) >> 8) * 0x1p-22 - 2.0;
            if (i % 5 == 0)
                rays.dy[i] = rays.dx[i] = 0.0;
            rays.u_min[i] = 0.0;
            rays.u_max[i] = 3.0;
        }
        for (int isa = 0; isa < FL_ISA_COUNT; isa++) {
            if (!fl_cpu_has((fl_isa)isa))
                continue;
            fl_revolve_set_isa(s.revolve, (fl_isa)isa);
            found[isa] = fl_revolve_nearest8(s.revolve, &rays, mask, FL_REVOLVE_ROBUST, hits[isa]);
            assert_int_equal(found[isa], found[FL_ISA_SCALAR]);
            assert_int_equal(found[isa],
                             fl_revolve_any8(s.revolve, &rays, mask, FL_REVOLVE_ROBUST));
            assert_int_equal(found[isa] & ~fl_revolve_reject8(s.revolve, &rays, mask), 0);
            for (int i = 0; i < FL_REVOLVE_PACKET; i++) {
                double o[3] = {rays.ox[i], rays.oy[i], rays.oz[i]},
                       d[3] = {rays.dx[i], rays.dy[i], rays.dz[i]};
                fl_revolve_hit one;
                if (!(mask >> i & 1))
                    continue;
                bool is_hit =
                    fl_revolve_nearest(s.revolve, o, d, 0.0, 3.0, FL_REVOLVE_ROBUST, &one);
                assert_int_equal(is_hit, found[isa] >> i & 1);
                if (is_hit) {
                    assert_true(one.u == hits[isa][i].u && one.t == hits[isa][i].t);
                    assert_true(one.u == hits[FL_ISA_SCALAR][i].u &&
                                one.local == hits[FL_ISA_SCALAR][i].local);
                }
            }
        }
    }
    fl_arena_deinit(&s.arena);
}

static void test_newton_finds_plain_hits(void **state)
{
    (void)state;
    shape s;
    build(&s, vase, 1, 3);
    int hits = 0, found = 0;
    for (int i = 0; i < 10000; i++) {
        double o[3] = {0.1, 1.8, -4}, d[3] = {i % 100 / 100.0 - 0.5, i / 100 / 100.0 - 0.7, 1.6};
        fl_revolve_hit a, b;
        if (!fl_revolve_nearest(s.revolve, o, d, 0.0, HUGE_VAL, FL_REVOLVE_ROBUST, &a))
            continue;
        hits++;
        if (fl_revolve_nearest(s.revolve, o, d, 0.0, HUGE_VAL, FL_REVOLVE_NEWTON, &b) &&
            fabs(a.u - b.u) < 1e-9) {
            fl_revolve_point p, q;
            fl_revolve_resolve(s.revolve, o, d, &a, &p);
            fl_revolve_resolve(s.revolve, o, d, &b, &q);
            assert_true(fl_v3_length(fl_v3_sub(p.position, q.position)) < 1e-8);
            found++;
        }
    }
    assert_true(hits > 1000 && found > hits * 95 / 100);
    fl_arena_deinit(&s.arena);
}

/* The knob does something: one start a segment loses hits that eight find, and 64 lose none of
 * those. */
static void test_newton_finds_more_from_more_starts(void **state)
{
    (void)state;
    static const fl_revolve_solver starts[] = {1, FL_REVOLVE_NEWTON, FL_REVOLVE_MAX_STARTS};
    uint32_t hits[3] = {0};
    shape s;
    build(&s, vase, 1, 3);
    for (int i = 0; i < 10000; i++) {
        double o[3] = {0.1, 1.8, -4}, d[3] = {i % 100 / 100.0 - 0.5, i / 100 / 100.0 - 0.7, 1.6};
        fl_revolve_hit hit;
        for (int k = 0; k < 3; k++)
            hits[k] += fl_revolve_any(s.revolve, o, d, 0.0, HUGE_VAL, starts[k]) &&
                       fl_revolve_nearest(s.revolve, o, d, 0.0, HUGE_VAL, starts[k], &hit);
    }
    print_message("hits from 1, 8 and 64 starts: %u, %u, %u\n", hits[0], hits[1], hits[2]);
    assert_true(hits[0] > 1000 && hits[0] < hits[1] && hits[1] <= hits[2]);
    fl_arena_deinit(&s.arena);
}

/* As many pieces as allowed: built in seconds, and hit. */
static void test_ten_thousand_segments(void **state)
{
    (void)state;
    enum { N = FL_REVOLVE_MAX_SEGMENTS };
    static double p[2 * N][2];
    shape s;
    for (int i = 0; i < N; i++) {
        p[2 * i][0] = 1.0 + 0.2 * (i & 1);
        p[2 * i + 1][0] = 1.0 + 0.2 * ((i + 1) & 1);
        p[2 * i][1] = i * 2.0 / N;
        p[2 * i + 1][1] = (i + 1) * 2.0 / N;
    }
    build(&s, (const double(*)[2])p, N, 1);
    assert_true(fl_revolve_piece_count(s.revolve) >= N);
    for (int i = 0; i < 2000; i++) {
        fl_revolve_hit hit;
        fl_vec3 o = fl_v3(-4, 1.0 + 0.4 * cos(i), 0.3),
                d = fl_v3(1, 0.1 * sin(i * 3), 0.05 * sin(i));
        assert_true(shoot(&s, o, d, 0.0, HUGE_VAL, &hit));
        fl_revolve_point q = resolve(&s, o, d, &hit);
        assert_true(fl_v3_length(fl_v3_sub(q.position, fl_v3_mad(o, d, hit.u))) < 1e-14);
    }
    fl_arena_deinit(&s.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tube),
        cmocka_unit_test(test_texture_runs_against_the_angle),
        cmocka_unit_test(test_poles_and_cusps_have_normals),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_strange_rays),
        cmocka_unit_test(test_torus_is_hit_again),
        cmocka_unit_test(test_scale),
        cmocka_unit_test(test_packets_and_instruction_sets_agree),
        cmocka_unit_test(test_newton_finds_plain_hits),
        cmocka_unit_test(test_newton_finds_more_from_more_starts),
        cmocka_unit_test(test_ten_thousand_segments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
