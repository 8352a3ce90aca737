/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/estimate.h"
#include "noise_film.h"

#define TRUTH 10.0

enum { W = 70, H = 50, SAMPLES_MAX = 256 };

/* A film whose mean after n samples is base + error(n), the error of each pixel falling like n^-p:
 * what low-discrepancy points do, with noise that is independent between doublings. */
typedef struct world {
    fl_film *film;
    fl_estimate *estimate;
    uint32_t samples, seed;
    double p;
} world;

static noise_unit unit;

static double falling(const void *context, uint32_t x, uint32_t y, uint32_t sample,
                      uint32_t channel)
{
    const world *w = context;
    uint32_t hash = fl_hash_step(fl_hash_step(w->seed, y * W + x), channel);
    return TRUTH + noise_at_rate(hash, sample, w->p);
}

static double independent(const void *context, uint32_t x, uint32_t y, uint32_t sample,
                          uint32_t channel)
{
    (void)context;
    uint32_t hash = fl_hash_step(fl_hash_step(5, y * W + x), channel);
    return TRUTH + noise_of(fl_hash_step(hash, sample));
}

/* One sample of all pixels. */
static void add_sample_of(world *w, noise_value *value)
{
    fl_unit added;
    fl_unit_result result;
    for (uint32_t y = 0; y < H; y++) {
        noise_list_row(&unit, 0, y, W);
        noise_add(&unit, w->samples, value, w, w->film, 0, 0, &added, &result);
    }
    w->samples++;
}

static void add_sample(world *w)
{
    add_sample_of(w, falling);
}

static void capture_all(world *w)
{
    const fl_rect parts[] = {{32, 16, W, H}, {0, 0, 32, 16}, {0, 16, 32, H}, {32, 0, W, 16}};
    for (size_t i = 0; i < FL_COUNT_OF(parts); i++)
        fl_estimate_capture(w->estimate, w->film, &parts[i], w->samples);
}

static void world_init(world *w, double p, uint32_t seed)
{
    *w = (world){fl_film_create(W, H), fl_estimate_create(W, H, false), 0, seed, p};
    assert_true(w->film && w->estimate);
}

static void world_deinit(world *w)
{
    fl_film_destroy(w->film);
    fl_estimate_destroy(w->estimate);
}

/* By the definition, from the differences of independent errors: V = n^-2p + (n/2)^-2p. */
static double expected(double p, uint32_t n, double used_p)
{
    double v = pow(n, -2.0 * p) + pow(n / 2.0, -2.0 * p);
    return sqrt(v) * pow(2.0, 0.5 - used_p);
}

static void it_is_the_snapshot_rule(void **state)
{
    (void)state;
    const double exponents[] = {0.5, 0.62, 0.7, 1.4};
    for (size_t i = 0; i < FL_COUNT_OF(exponents); i++) {
        world w;
        world_init(&w, exponents[i], 17);
        while (w.samples < SAMPLES_MAX) {
            add_sample(&w);
            capture_all(&w);
            fl_error_estimate e;
            fl_estimate_read(w.estimate, w.samples, &e);
            assert_int_equal(e.is_known, w.samples >= 4);
            if ((w.samples & (w.samples - 1)) != 0 || !e.is_known)
                continue;
            double p = w.samples < 8 ? 0.6 : exponents[i];
            assert_true(fabs(e.exponent - p) < 0.02); /* 10,500 values: V to 1 %, p to 0.01. */
            assert_true(fabs(e.rmse / expected(exponents[i], w.samples, e.exponent) - 1.0) < 0.03);
            assert_true(e.low <= e.rmse * 0.8 + 1e-12 && e.high >= e.rmse * 1.2 - 1e-12);
            assert_true(e.samples == w.samples);
        }
        world_deinit(&w);
    }
}

static void errors_of_independent_samples_are_within_the_interval(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.5, 99);
    uint32_t inside = 0, total = 0;
    while (w.samples < SAMPLES_MAX) {
        add_sample_of(&w, independent);
        capture_all(&w);
        fl_error_estimate e;
        fl_estimate_read(w.estimate, w.samples, &e);
        if (!e.is_known)
            continue;
        double truth = noise_rmse(w.film, TRUTH);
        total++;
        inside += e.low <= truth && truth <= e.high;
    }
    assert_int_equal(inside, total);
    world_deinit(&w);
}

static void the_next_stop_is_the_least_count_within_the_target(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.6, 3);
    assert_int_equal(fl_estimate_next_stop(w.estimate, 0, 0.1), 4);
    while (w.samples < 64) {
        add_sample(&w);
        capture_all(&w);
        uint32_t n = w.samples, k = 1;
        while (2 * k <= n)
            k *= 2;
        for (double target = 0.01; target < 2.0; target *= 1.1) {
            uint32_t stop = fl_estimate_next_stop(w.estimate, n, target), want = k;
            fl_error_estimate e;
            for (; want < 2 * k; want++) {
                fl_estimate_read(w.estimate, want, &e);
                if (e.rmse <= target)
                    break;
            }
            assert_int_equal(stop, n < 4 ? 4 : want);
        }
    }
    world_deinit(&w);
}

static void between_powers_the_error_falls_like_n_to_the_minus_p(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.6, 3);
    while (w.samples < 31) {
        add_sample(&w);
        capture_all(&w);
    }
    fl_error_estimate at_16, at_31;
    fl_estimate_read(w.estimate, 16, &at_16);
    fl_estimate_read(w.estimate, 31, &at_31);
    assert_true(fabs(at_31.rmse / (at_16.rmse * pow(16.0 / 31.0, at_16.exponent)) - 1.0) < 1e-9);
    world_deinit(&w);
}

/* Of 24 points of a net that 32 will make, the error is not that of a net. */
static void within_a_doubling_nets_are_not_trusted(void **state)
{
    (void)state;
    world w;
    world_init(&w, 1.4, 3);
    while (w.samples < 24) {
        add_sample(&w);
        capture_all(&w);
    }
    fl_error_estimate at_16, at_24;
    fl_estimate_read(w.estimate, 16, &at_16);
    fl_estimate_read(w.estimate, 24, &at_24);
    assert_true(at_16.exponent > 1.3);
    assert_true(fabs(at_24.rmse / (at_16.rmse * pow(16.0 / 24.0, 0.75)) - 1.0) < 1e-9);
    world_deinit(&w);
}

static void a_picture_without_noise_has_no_error(void **state)
{
    (void)state;
    world w;
    world_init(&w, 1000.0, 1); /* n^-1000 is nothing from 2 on. */
    while (w.samples < 16) {
        add_sample(&w);
        capture_all(&w);
    }
    fl_error_estimate e;
    fl_estimate_read(w.estimate, 16, &e);
    assert_true(e.is_known && e.rmse < 1e-6 && e.low >= 0.0 && e.exponent >= 0.5 &&
                e.exponent <= 1.5);
    world_deinit(&w);
}

static void a_reset_forgets(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.6, 8);
    fl_error_estimate first, second;
    for (int round = 0; round < 2; round++) {
        while (w.samples < 16) {
            add_sample(&w);
            capture_all(&w);
        }
        fl_estimate_read(w.estimate, 16, round ? &second : &first);
        fl_estimate_reset(w.estimate);
        fl_film_clear(w.film);
        w.samples = 0;
    }
    assert_memory_equal(&first.rmse, &second.rmse, sizeof first.rmse);
    assert_true(first.high == second.high && first.exponent == second.exponent);
    world_deinit(&w);
}

static void forecasts_follow_the_law_with_a_bracket(void **state)
{
    (void)state;
    fl_error_estimate e = {true, 0.04, 0.03, 0.05, 32.0, 0.6};
    fl_error_forecast f;
    assert_true(fl_error_predict(&e, 0.01, &f));
    assert_true(fabs(f.samples - 32.0 * pow(4.0, 1.0 / 0.6)) < 1e-6);
    assert_true(fabs(f.low - 32.0 * pow(4.0, 1.0 / 0.7)) < 1e-6);
    assert_true(fabs(f.high - 32.0 * pow(4.0, 2.0)) < 1e-6);
    assert_true(fl_error_predict(&e, 0.05, &f)); /* Reached. */
    assert_true(f.samples == 32.0 && f.low == 32.0 && f.high == 32.0);
    for (e.exponent = 0.5; e.exponent <= 1.5; e.exponent += 0.05) { /* Room on both sides. */
        assert_true(fl_error_predict(&e, 0.01, &f));
        assert_true(f.low < f.samples && f.samples <= f.high);
        double fast = fmax(0.7, e.exponent + 0.1);
        assert_true(fabs(f.low - 32.0 * pow(4.0, 1.0 / fast)) < 1e-6);
        assert_true(fabs(f.high - 32.0 * pow(4.0, 2.0)) < 1e-6);
    }
    assert_false(fl_error_predict(&e, 0.0, &f));
    assert_false(fl_error_predict(&e, (double)NAN, &f));
    e.is_known = false;
    assert_false(fl_error_predict(&e, 0.01, &f));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_the_snapshot_rule),
        cmocka_unit_test(errors_of_independent_samples_are_within_the_interval),
        cmocka_unit_test(the_next_stop_is_the_least_count_within_the_target),
        cmocka_unit_test(between_powers_the_error_falls_like_n_to_the_minus_p),
        cmocka_unit_test(within_a_doubling_nets_are_not_trusted),
        cmocka_unit_test(a_picture_without_noise_has_no_error),
        cmocka_unit_test(a_reset_forgets),
        cmocka_unit_test(forecasts_follow_the_law_with_a_bracket),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
