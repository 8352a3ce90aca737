/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/film.h"
#include "core/schedule.h"
#include "fake_pipeline.h"

enum { W = 21, H = 13, X0 = 100, Y0 = 7, SEED = 5 };

/* Sample `sample` of the pixels of a rectangle of the film. */
static void add(fl_film *film, fl_rect rect, uint32_t step, uint32_t sample)
{
    static uint16_t x[FL_UNIT_PIXELS], y[FL_UNIT_PIXELS];
    static float r[FL_UNIT_PIXELS], g[FL_UNIT_PIXELS], b[FL_UNIT_PIXELS];
    static uint8_t is_valid[FL_UNIT_PIXELS];
    fl_work work = {rect, step, sample, 0, 0};
    fl_unit unit = {x, y, fl_work_pixels(&work, X0, Y0, x, y), sample};
    fl_unit_result result = {r, g, b, is_valid};
    for (uint32_t i = 0; i < unit.count; i++) {
        float rgb[3];
        is_valid[i] = fake_sample(SEED, x[i], y[i], sample, rgb);
        r[i] = is_valid[i] ? rgb[0] : NAN;
        g[i] = is_valid[i] ? rgb[1] : INFINITY;
        b[i] = rgb[2];
    }
    fl_film_add(film, &unit, &result, X0, Y0);
}

static const fl_rect whole = {0, 0, W, H};

static void assert_mean_is(const fl_film *film, uint32_t samples)
{
    static float got[3 * W * H], want[3 * W * H];
    fl_film_mean(film, got);
    fake_mean(SEED, X0, Y0, W, H, samples, want);
    assert_memory_equal(got, want, sizeof got);
    assert_int_equal(fl_film_complete_samples(film), samples);
    assert_int_equal(fl_film_covered_pixels(film), samples ? W * H : 0);
}

static void the_mean_is_that_of_blocks_of_16(void **state)
{
    (void)state;
    fl_film *film = fl_film_create(W, H);
    assert_mean_is(film, 0);
    for (uint32_t s = 0; s < 70; s++) {
        add(film, whole, 1, s);
        assert_mean_is(film, s + 1);
    }
    fl_film_destroy(film);
}

static void blocks_of_16_are_not_a_plain_sum(void **state)
{
    (void)state;
    uint32_t differing = 0;
    for (uint32_t x = 0; x < 200; x++) {
        double plain = 0.0, blocks = 0.0;
        for (uint32_t s = 0, k = 0; s < 64; s += 16) {
            double block = 0.0;
            for (k = s; k < s + 16; k++) {
                float rgb[3];
                fake_sample(SEED, x, 0, k, rgb);
                float value = rgb[0] * rgb[1] * 0x1p-20f + (k % 3 == 0 ? 1e9f : 1e-3f);
                plain += (double)value;
                block += (double)value;
            }
            blocks += block;
        }
        differing += plain != blocks;
    }
    assert_true(differing > 0); /* Otherwise the test above proves nothing about the order. */
}

static void pixels_may_go_at_their_own_pace(void **state)
{
    (void)state;
    fl_film *film = fl_film_create(W, H);
    for (uint32_t s = 0; s < 20; s++)
        add(film, (fl_rect){0, 0, 10, H}, 1, s);
    assert_int_equal(fl_film_complete_samples(film), 0);
    assert_int_equal(fl_film_covered_pixels(film), 10 * H);
    for (uint32_t s = 0; s < 20; s++)
        add(film, (fl_rect){10, 0, W, H}, 1, s);
    assert_mean_is(film, 20);
    fl_film_destroy(film);
}

static void a_cleared_film_is_empty_and_starts_over(void **state)
{
    (void)state;
    fl_film *film = fl_film_create(W, H);
    for (uint32_t s = 0; s < 17; s++)
        add(film, whole, 1, s);
    fl_film_clear(film);
    assert_mean_is(film, 0);
    static float rgb[3 * W * H];
    static uint8_t rgba[4 * W * H];
    assert_int_equal(fl_film_rows_covered(film, 0, H, rgb, rgba), 0);
    fl_film_fill_holes(rgba, W, H);
    for (size_t i = 0; i < FL_COUNT_OF(rgba); i++)
        assert_int_equal(rgba[i], i % 4 == 3 ? 255 : 0);
    add(film, (fl_rect){0, 3, W, 4}, 1, 0);
    assert_int_equal(fl_film_covered_pixels(film), W);
    fl_film_clear(film);
    for (uint32_t s = 0; s < 3; s++)
        add(film, whole, 1, s);
    assert_mean_is(film, 3);
    fl_film_destroy(film);
}

static void holes_take_the_corner_of_the_smallest_cell(void **state)
{
    (void)state;
    fl_film *film = fl_film_create(W, H);
    static float mean[3 * W * H], covered[3 * W * H];
    static uint8_t want[4 * W * H], got[4 * W * H];
    for (uint32_t step = 8; step >= 1; step /= 2) { /* Ranks 0; 0-3; 0-15; all. */
        fl_film_clear(film);
        add(film, whole, step, 0);
        fl_film_mean(film, mean);
        uint32_t count = fl_film_rows_covered(film, 0, H, covered, got), next = 0;
        for (uint32_t y = 0; y < H; y++)
            for (uint32_t x = 0; x < W; x++) {
                uint8_t *pixel = got + 4 * (y * W + x);
                const uint8_t *from = want + 4 * ((y - y % step) * W + x - x % step);
                bool has_sample = x % step == 0 && y % step == 0;
                assert_int_equal(pixel[3], has_sample ? 255 : 0);
                if (has_sample) {
                    uint32_t id = y * W + x;
                    memcpy(want + 4 * id, &(uint32_t){id | 0xff000000u}, 4);
                    memcpy(pixel, want + 4 * id, 4);
                    assert_memory_equal(covered + 3 * next, mean + 3 * id, 3 * sizeof *mean);
                    next++;
                } else {
                    memcpy(want + 4 * (y * W + x), from, 4);
                }
            }
        assert_int_equal(next, count);
        fl_film_fill_holes(got, W, 8);
        fl_film_fill_holes(got + 4 * 8 * W, W, H - 8);
        assert_memory_equal(got, want, sizeof want);
    }
    fl_film_destroy(film);
}

static void a_pixel_without_valid_samples_is_black(void **state)
{
    (void)state;
    fl_film *film = fl_film_create(1, 1);
    uint16_t zero = 0;
    float nan = NAN, one = 1.0f, rgb[3];
    uint8_t is_valid = 0;
    fl_unit unit = {&zero, &zero, 1, 0};
    fl_unit_result result = {&nan, &nan, &nan, &is_valid};
    fl_film_add(film, &unit, &result, 0, 0);
    fl_film_mean(film, rgb);
    assert_true(rgb[0] == 0.0f && rgb[1] == 0.0f && rgb[2] == 0.0f);
    assert_int_equal(fl_film_complete_samples(film), 1);
    unit.sample = 1;
    is_valid = 1;
    result = (fl_unit_result){&one, &one, &one, &is_valid};
    fl_film_add(film, &unit, &result, 0, 0);
    fl_film_mean(film, rgb);
    assert_true(rgb[0] == 1.0f && rgb[1] == 1.0f && rgb[2] == 1.0f); /* Not 0.5. */
    fl_film_destroy(film);
}

static void sizes_are_counted_and_do_not_overflow(void **state)
{
    (void)state;
    size_t bytes = 0;
    assert_true(fl_film_bytes(640, 640, &bytes));
    assert_true(bytes >= (size_t)640 * 640 * 56 && bytes < (size_t)640 * 640 * 57);
    assert_false(fl_film_bytes(UINT32_MAX, UINT32_MAX, &bytes));
    assert_null(fl_film_create(UINT32_MAX, UINT32_MAX));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mean_is_that_of_blocks_of_16),
        cmocka_unit_test(blocks_of_16_are_not_a_plain_sum),
        cmocka_unit_test(pixels_may_go_at_their_own_pace),
        cmocka_unit_test(a_cleared_film_is_empty_and_starts_over),
        cmocka_unit_test(holes_take_the_corner_of_the_smallest_cell),
        cmocka_unit_test(a_pixel_without_valid_samples_is_black),
        cmocka_unit_test(sizes_are_counted_and_do_not_overflow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
