/* SPDX-License-Identifier: MIT
 *
 * The cost of a ray grows like the logarithm of what the scene holds: by counts, which are the same
 * on every machine. A tenfold scene may add no more than a constant number of visits and tests.
 */
#include "cli/bench_run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static bench_growth_row measure(bench_growth of, uint32_t count)
{
    fl_diags diags = {0};
    const bench_setup setup = {.rounds = 1, .side = 128, .diags = &diags};
    bench_growth_row row;
    assert_true(bench_growth_measure(&setup, of, count, &row));
    print_message("%u %s: %.2f nodes, %.2f tests a ray\n", count, bench_growth_names[of],
                  row.node_visits, row.primitive_tests);
    fl_diags_deinit(&diags);
    return row;
}

/* `visits`, `tests`: that a tenfold count may add at most. */
static void grows_by(bench_growth of, uint32_t first, uint32_t last, double visits, double tests)
{
    bench_growth_row before = measure(of, first);
    for (uint32_t count = first * 10; count <= last; count *= 10) {
        bench_growth_row now = measure(of, count);
        assert_true(now.node_visits > 0.0 && now.primitive_tests > 0.0);
        assert_true(now.node_visits - before.node_visits < visits);
        assert_true(now.primitive_tests - before.primitive_tests < tests);
        before = now;
    }
}

static void spheres_cost_their_logarithm(void **state)
{
    (void)state;
    grows_by(BENCH_SPHERES, 100, 100000, 3.5, 6.0);
}

static void triangles_cost_their_logarithm(void **state)
{
    (void)state;
    grows_by(BENCH_TRIANGLES, 1000, 100000, 3.5, 1.0);
}

static void instances_cost_their_logarithm(void **state)
{
    (void)state;
    grows_by(BENCH_INSTANCES, 10, 10000, 6.5, 3.5);
}

/* A shadow ray for each light and hit, and each costs the same. */
static void lights_cost_their_number(void **state)
{
    (void)state;
    bench_growth_row few = measure(BENCH_LIGHTS, 10), many = measure(BENCH_LIGHTS, 100);
    double ratio = (many.rays_per_pixel - 1.0) / (few.rays_per_pixel - 1.0);
    print_message("tenfold lights: %.2f times the shadow rays\n", ratio);
    assert_true(ratio > 9.5 && ratio < 10.5);
    assert_true(many.node_visits <= few.node_visits * 1.1); /* So few spheres have no nodes. */
    assert_true(many.primitive_tests < few.primitive_tests * 1.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_cost_their_logarithm),
        cmocka_unit_test(triangles_cost_their_logarithm),
        cmocka_unit_test(instances_cost_their_logarithm),
        cmocka_unit_test(lights_cost_their_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
