/* SPDX-License-Identifier: MIT
 *
 * The figures of a study on made-up numbers whose truth is known.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "cli/study_figures.h"
#include "cli/study_flip.h"

enum { PIXELS = 4096, VALUES = 3 * PIXELS, SEED = 71 };

static float truth[VALUES], picture[VALUES], first[VALUES], second[VALUES], scratch[VALUES];

static double uniform(uint32_t seed, uint32_t i)
{
    return (double)(fl_hash_step(seed, i) >> 8) * 0x1p-24;
}

/* Mean 0, variance 1. */
static double noise(uint32_t seed, uint32_t i)
{
    return (uniform(seed, i) - 0.5) * sqrt(12.0);
}

static void fill(float *out, double offset, double deviation, uint32_t seed)
{
    for (uint32_t i = 0; i < VALUES; i++)
        out[i] = (float)((double)truth[i] + offset + deviation * noise(seed, i));
}

static int begin(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < VALUES; i++)
        truth[i] = (float)(0.2 + uniform(SEED, i));
    print_message("seed %d\n", SEED);
    return 0;
}

/* A reference that is half as noisy as the picture would add 12 % to a plain RMSE. */
static void noisy_references_do_not_inflate_the_error(void **state)
{
    (void)state;
    double sum = 0.0, plain = 0.0;
    for (uint32_t round = 0; round < 16; round++) {
        study_error e;
        fill(picture, 0.0, 0.02, 100 + round);
        fill(first, 0.0, 0.01, 200 + round);
        fill(second, 0.0, 0.01, 300 + round);
        study_error_measure(picture, first, second, PIXELS, scratch, &e);
        sum += e.mse / 16.0;
        for (uint32_t i = 0; i < VALUES; i++)
            plain += pow((double)picture[i] - (double)first[i], 2.0) / VALUES / 16.0;
        double own = sqrt(study_reference_mse(first, second, PIXELS));
        assert_true(fabs(own / (0.01 / sqrt(2.0)) - 1.0) < 0.02);
    }
    assert_true(fabs(sqrt(sum) / 0.02 - 1.0) < 0.01);
    assert_true(sqrt(plain) / 0.02 > 1.1);
}

static void a_reference_has_no_error_against_itself(void **state)
{
    (void)state;
    study_error e;
    fill(first, 0.0, 0.01, 1);
    fill(second, 0.0, 0.01, 2);
    study_error_measure(first, first, second, PIXELS, scratch, &e);
    assert_true(e.mse == 0.0 && e.relative_mse == 0.0);
    study_error_measure(first, first, first, PIXELS, scratch, &e);
    assert_true(e.largest == 0.0 && e.p999 == 0.0 && e.bias == 0.0);
}

static void offsets_and_outliers_show(void **state)
{
    (void)state;
    study_error e;
    memcpy(picture, truth, sizeof truth);
    for (uint32_t i = 0; i < VALUES; i++)
        picture[i] += 0.25f;
    picture[77] = truth[77] + 3.0f;
    study_error_measure(picture, truth, truth, PIXELS, scratch, &e);
    assert_true(fabs(e.largest - 3.0) < 1e-6);
    assert_true(fabs(e.p999 - 0.25) < 1e-6);
    assert_true(fabs(e.bias - (0.25 + 2.75 / VALUES)) < 1e-6);
}

static void pairs_of_pictures_find_the_floor_under_the_noise(void **state)
{
    (void)state;
    enum { COUNT = 8 };
    static float sum[VALUES];
    const double floors[] = {0.0, 0.005, 0.02};
    for (size_t k = 0; k < FL_COUNT_OF(floors); k++) {
        double mse = 0.0;
        memset(sum, 0, sizeof sum);
        fill(first, 0.0, 0.002, 11);
        fill(second, 0.0, 0.002, 12);
        for (uint32_t round = 0; round < COUNT; round++) {
            fill(picture, 0.0, 0.03, 400 + round);
            for (uint32_t i = 0; i < VALUES; i++) {
                picture[i] += (float)(floors[k] * (i % 2 ? 1.0 : -1.0));
                sum[i] += picture[i];
            }
            mse += study_product_mse(picture, first, second, PIXELS);
        }
        double floor2 = study_floor_mse(sum, COUNT, mse, first, second, PIXELS);
        /* The products of independent noise average to 0 with deviation 0.03^2 sqrt(2 / (8 * 7 *
         * 12288)), and twice floor times noise over the root of all; five of them are allowed. */
        double spread = 0.03 * 0.03 * sqrt(2.0 / (COUNT * (COUNT - 1) * (double)VALUES)) +
                        2.0 * floors[k] * 0.03 / sqrt((double)COUNT * VALUES) +
                        0.002 * 0.002 / sqrt((double)VALUES);
        assert_true(fabs(floor2 - floors[k] * floors[k]) < 5.0 * spread);
    }
}

static void fits_give_back_what_was_put_in(void **state)
{
    (void)state;
    double samples[10], mse[10], rmse[10];
    for (uint32_t k = 0; k < 10; k++) {
        samples[k] = pow(2.0, k);
        mse[k] = 0.003 * 0.003 + pow(0.1 * pow(samples[k], -0.6), 2.0);
        rmse[k] = 0.1 * pow(samples[k], -0.62);
    }
    study_fit fit = study_fit_floor(samples, mse, 10, 0.6);
    assert_true(fit.is_known);
    assert_true(fabs(fit.floor / 0.003 - 1.0) < 1e-9 && fabs(fit.scale / 0.1 - 1.0) < 1e-9);
    for (uint32_t k = 0; k < 10; k++)
        mse[k] = rmse[k] * rmse[k];
    fit = study_fit_rate(samples, mse, 10);
    assert_true(fabs(fit.rate - 0.62) < 1e-9 && fabs(fit.scale / 0.1 - 1.0) < 1e-9);
    assert_true(fit.floor == 0.0);
    assert_true(study_fit_floor(samples, mse, 10, 0.62).floor < 1e-6);
    assert_true(fabs(study_slope_of(samples, rmse, 10) + 0.62) < 1e-12);
    assert_false(study_fit_rate(samples, mse, 3).is_known);
    mse[2] = 0.0;
    assert_false(study_fit_rate(samples, mse, 10).is_known);
    assert_true(isnan(study_slope_of(samples, rmse, 1)));
}

static void intervals_cover_the_truth_as_often_as_they_say(void **state)
{
    (void)state;
    uint32_t inside = 0, significant = 0, rounds = 4000;
    for (uint32_t round = 0; round < rounds; round++) {
        double values[5], base[5];
        for (uint32_t i = 0; i < 5; i++) {
            base[i] = 1.0 + uniform(SEED, round * 10 + i);
            /* Nearly normal: the sum of four. */
            double e = 0.0;
            for (uint32_t k = 0; k < 4; k++)
                e += 0.05 * noise(SEED + 1 + k, round * 10 + i);
            values[i] = base[i] * exp(log(1.3) + e);
        }
        study_ratio r = study_ratio_of(values, base, 5);
        assert_true(r.is_known && r.has_interval);
        inside += r.low <= 1.3 && 1.3 <= r.high;
        significant += r.is_significant;
    }
    double share = (double)inside / rounds; /* Deviation 0.0034. */
    assert_true(fabs(share - 0.95) < 0.015);
    assert_true(significant > rounds / 2);
    double one[] = {2.0}, zero[] = {0.0};
    assert_false(study_ratio_of(one, one, 1).has_interval);
    assert_false(study_ratio_of(zero, one, 1).is_known);
    assert_false(study_ratio_of(one, one, 0).is_known);
}

static void quantiles_of_student(void **state)
{
    (void)state;
    assert_true(fabs(study_t_quantile(4) - 2.7764) < 1e-4);
    assert_true(fabs(study_t_quantile(21) - 2.0796) < 1e-3);
    assert_true(fabs(study_t_quantile(60) - 2.0003) < 1e-3);
    assert_true(fabs(study_t_quantile(100000) - 1.95996) < 1e-3);
}

static void spreads(void **state)
{
    (void)state;
    double values[] = {5.0, 1.0, 2.0, 4.0, 3.0};
    study_spread s = study_spread_of(values, 5);
    assert_true(s.count == 5 && s.mean == 3.0 && s.median == 3.0 && s.lowest == 1.0);
    assert_true(s.quartile1 == 2.0 && s.quartile3 == 4.0);
    assert_true(fabs(s.standard_error - sqrt(2.5 / 5.0)) < 1e-12);
    assert_int_equal(study_spread_of(values, 0).count, 0);
    study_root root = study_root_of(&(study_spread){.mean = 0.04, .standard_error = 0.004});
    assert_true(fabs(root.value - 0.2) < 1e-12 && fabs(root.standard_error - 0.01) < 1e-12);
    root = study_root_of(&(study_spread){.mean = -0.04, .standard_error = 0.004});
    assert_true(root.value == 0.0 && root.standard_error == 0.0);
}

/* A ramp stays a ramp away from the edges, a constant stays itself, the same size changes nothing.
 */
static void resizing_keeps_ramps(void **state)
{
    (void)state;
    static float small[3 * 8 * 6], large[3 * 32 * 24];
    for (uint32_t y = 0; y < 6; y++)
        for (uint32_t x = 0; x < 8; x++) {
            float *p = small + 3 * (y * 8 + x);
            p[0] = (float)((x + 0.5) / 8.0);
            p[1] = (float)((y + 0.5) / 6.0);
            p[2] = 0.75f;
        }
    study_resize(small, 8, 6, large, 32, 24);
    for (uint32_t y = 2; y < 22; y++)
        for (uint32_t x = 2; x < 30; x++) {
            const float *p = large + 3 * (y * 32 + x);
            assert_true(fabs((double)p[0] - (x + 0.5) / 32.0) < 1e-6);
            assert_true(fabs((double)p[1] - (y + 0.5) / 24.0) < 1e-6);
            assert_true(p[2] == 0.75f);
        }
    study_resize(small, 8, 6, large, 8, 6);
    assert_memory_equal(small, large, sizeof small);
    study_resize(small, 1, 1, large, 2, 2);
    assert_memory_equal(large + 9, small, 3 * sizeof(float));
}

/* Mean FLIP of `b` against `a`. */
static double flip_of(const float *a, const float *b, uint32_t side)
{
    study_flip *flip = study_flip_create(a, side, side, 0.0);
    assert_non_null(flip);
    double mean = study_flip_mean(flip, b);
    study_flip_destroy(flip);
    return mean;
}

/* Two flat pictures. */
static double flip_of_colors(const float a[3], const float b[3])
{
    enum { SIDE = 8 };
    float one[3 * SIDE * SIDE], two[3 * SIDE * SIDE];
    for (uint32_t i = 0; i < 3 * SIDE * SIDE; i++) {
        one[i] = a[i % 3];
        two[i] = b[i % 3];
    }
    return flip_of(one, two, SIDE);
}

/* By hand from the formulas of the paper: black and white, and what is farthest apart. */
static void flip_of_flat_pictures(void **state)
{
    (void)state;
    static const float black[3] = {0}, white[3] = {1, 1, 1}, green[3] = {0, 1, 0},
                       blue[3] = {0, 0, 1}, bright[3] = {7, 7, 7};
    assert_true(fabs(flip_of_colors(black, white) - 0.967380) < 1e-4);
    assert_true(fabs(flip_of_colors(green, blue) - 1.0) < 1e-6);
    assert_true(flip_of_colors(blue, blue) == 0.0);
    assert_true(flip_of_colors(white, bright) == 0.0); /* Both are shown as white. */
}

static double pattern(uint32_t x, uint32_t y, uint32_t c, uint32_t k)
{
    return (x * 7 + y * 13 + c * 5 + k * 11 + x * y * 3) % 17 / 16.0;
}

/* The number is that of another program, of two-dimensional filters straight from the paper. */
static void flip_of_patterns(void **state)
{
    (void)state;
    enum { SIDE = 24 };
    static float a[3 * SIDE * SIDE], b[3 * SIDE * SIDE];
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        for (uint32_t c = 0; c < 3; c++) {
            uint32_t x = i % SIDE, y = i / SIDE;
            double value = pattern(x, y, c, 0);
            a[3 * i + c] = (float)value;
            b[3 * i + c] = (float)fl_min(1.0, value * 0.8 + 0.25 * pattern(y, x, c, 3));
        }
    assert_true(fabs(flip_of(a, b, SIDE) - 0.168551) < 1e-5);
    assert_true(fabs(flip_of(b, a, SIDE) - flip_of(a, b, SIDE)) < 1e-6);
    assert_true(flip_of(a, a, SIDE) == 0.0);
}

/* More noise looks worse. */
static void flip_grows_with_noise(void **state)
{
    (void)state;
    double before = 0.0;
    for (uint32_t k = 0; k < 6; k++) {
        fill(picture, 0.0, 0.005 * (1 << k), 900);
        double flip = flip_of(truth, picture, 64);
        assert_true(flip > before && flip < 1.0);
        before = flip;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noisy_references_do_not_inflate_the_error),
        cmocka_unit_test(a_reference_has_no_error_against_itself),
        cmocka_unit_test(offsets_and_outliers_show),
        cmocka_unit_test(pairs_of_pictures_find_the_floor_under_the_noise),
        cmocka_unit_test(fits_give_back_what_was_put_in),
        cmocka_unit_test(intervals_cover_the_truth_as_often_as_they_say),
        cmocka_unit_test(quantiles_of_student),
        cmocka_unit_test(spreads),
        cmocka_unit_test(resizing_keeps_ramps),
        cmocka_unit_test(flip_of_flat_pictures),
        cmocka_unit_test(flip_of_patterns),
        cmocka_unit_test(flip_grows_with_noise),
    };
    return cmocka_run_group_tests(tests, begin, NULL);
}
