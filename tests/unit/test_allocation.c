/* SPDX-License-Identifier: MIT
 *
 * Adaptive sampling by itself: who gets how much, in whole blocks, about the goal, and an error
 * readout that stays right.
 */
#include "core/allocation.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/math64.h"

enum { W = 70, H = 50, X0 = 3, Y0 = 5 };

/* Independent samples around 0.5; their spread is a function of the column. */
typedef struct world {
    fl_film *film;
    fl_estimate *estimate;
    fl_allocation *allocation;
    double spread_left, spread_right;
} world;

static uint16_t xs[FL_UNIT_PIXELS], ys[FL_UNIT_PIXELS];
static float rgb[3][FL_UNIT_PIXELS];
static uint8_t is_valid[FL_UNIT_PIXELS];

static float value(const world *w, uint32_t x, uint32_t y, uint32_t sample, uint32_t channel)
{
    uint32_t h = fl_hash_step(fl_hash_step(fl_hash_step(y << 16 | x, sample), channel), 99);
    double noise = ((double)(h >> 8) * 0x1p-24 - 0.5) * sqrt(12.0);
    return (float)(0.5 + (x - X0 < W / 2 ? w->spread_left : w->spread_right) * noise);
}

/* Sample the listed pixels. */
static void add_unit(world *w, uint32_t count, uint32_t sample)
{
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < 3; c++)
            rgb[c][i] = value(w, xs[i], ys[i], sample, c);
    memset(is_valid, 1, sizeof is_valid);
    fl_unit unit = {xs, ys, count, sample};
    fl_unit_result result = {rgb[0], rgb[1], rgb[2], is_valid};
    fl_film_add(w->film, &unit, &result, X0, Y0);
    fl_allocation_add(w->allocation, &unit, &result, X0, Y0);
}

static void world_init(world *w, double left, double right)
{
    *w = (world){fl_film_create(W, H), fl_estimate_create(W, H, true), fl_allocation_create(W, H),
                 left, right};
    assert_true(w->film && w->estimate && w->allocation);
    for (uint32_t s = 0; s < FL_ALLOCATION_BLOCK; s++) {
        assert_false(fl_allocation_has_work(w->allocation));
        for (uint32_t y = 0; y < H; y++) {
            for (uint32_t x = 0; x < W; x++) {
                xs[x] = (uint16_t)(X0 + x);
                ys[x] = (uint16_t)(Y0 + y);
            }
            add_unit(w, W, s);
        }
        fl_estimate_capture(w->estimate, w->film, &(fl_rect){0, 0, W, H}, s + 1);
    }
}

static void world_deinit(world *w)
{
    fl_film_destroy(w->film);
    fl_estimate_destroy(w->estimate);
    fl_allocation_destroy(w->allocation);
}

/* Until there is no more to do, `out` units at a time being on their way. */
static void run(world *w, uint32_t goal)
{
    fl_allocation_set_goal(w->allocation, goal);
    while (fl_allocation_has_work(w->allocation)) {
        uint32_t sample, tile;
        uint32_t count = fl_allocation_next(w->allocation, w->film, X0, Y0, xs, ys, &sample, &tile);
        if (count == 0) {
            assert_true(fl_allocation_must_plan(w->allocation));
            fl_allocation_plan(w->allocation, w->film, w->estimate);
            continue;
        }
        assert_true(count <= FL_UNIT_PIXELS);
        assert_false(fl_allocation_must_plan(w->allocation));
        add_unit(w, count, sample);
        fl_allocation_commit(w->allocation, tile, count);
    }
}

/* Mean number of samples of the columns [begin, end); every number is whole blocks. */
static double mean_samples(const world *w, uint32_t begin, uint32_t end)
{
    uint64_t sum = 0;
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = begin; x < end; x++) {
            uint32_t n;
            fl_film_samples_row(w->film, x, y, 1, &n);
            assert_true(n >= FL_ALLOCATION_BLOCK && n % FL_ALLOCATION_BLOCK == 0);
            sum += n;
        }
    return (double)sum / ((double)(end - begin) * H);
}

static double true_rmse(const world *w)
{
    static float mean[3 * W * H];
    fl_film_mean(w->film, mean);
    double sum = 0.0;
    for (size_t i = 0; i < FL_COUNT_OF(mean); i++)
        sum += ((double)mean[i] - 0.5) * ((double)mean[i] - 0.5);
    return sqrt(sum / (3.0 * W * H));
}

static void assert_within(double got, double low, double high)
{
    if (!(got >= low && got <= high))
        fail_msg("%g is not within %g and %g", got, low, high);
}

static void the_noisy_half_gets_the_samples(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.001, 0.2);
    run(&w, 64);
    assert_within(mean_samples(&w, 0, W), 62, 66);
    assert_within(mean_samples(&w, 0, W / 2 - 2), 16, 17);
    assert_within(mean_samples(&w, W / 2 + 2, W), 104, 116);
    assert_int_equal(fl_allocation_samples(w.allocation),
                     (uint64_t)((mean_samples(&w, 0, W) - 16.0) * W * H + 0.5));
    world_deinit(&w);
}

/* n proportional to the spread, once the goal leaves room for it. */
static void samples_are_proportional_to_the_spread(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.1, 0.3);
    run(&w, 256);
    assert_within(mean_samples(&w, 0, W), 250, 262);
    double left = mean_samples(&w, 0, W / 2 - 2), right = mean_samples(&w, W / 2 + 2, W);
    assert_within(right / left, 2.8, 3.2);
    world_deinit(&w);
}

static void without_noise_all_get_the_same(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.0, 0.0);
    run(&w, 48);
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            uint32_t n;
            fl_film_samples_row(w.film, x, y, 1, &n);
            assert_int_equal(n, 48);
        }
    world_deinit(&w);
}

/* The predicted error is the true one although pixels have unlike numbers of samples; independent
 * samples have p = 0.5, the prior's 0.6 would be 7 % off. */
static void the_error_stays_right(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.05, 0.3);
    fl_error_estimate e;
    fl_estimate_read(w.estimate, 40, &e); /* Amid the first round: from the even samples. */
    assert_true(e.is_known && e.samples == 40.0);
    for (uint32_t goal = 32; goal <= 256; goal *= 2) {
        run(&w, goal);
        fl_estimate_read(w.estimate, goal, &e);
        assert_true(e.is_known);
        assert_within(e.rmse / true_rmse(&w), 0.85, 1.15);
        assert_within(e.samples / goal, 0.97, 1.03);
    }
    world_deinit(&w);
}

/* The goal may be raised later; the film is then that of the larger goal when rounds agree. */
static void a_raised_goal_goes_on(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.1, 0.3);
    run(&w, 16);
    assert_within(mean_samples(&w, 0, W), 16, 16);
    run(&w, 32);
    assert_within(mean_samples(&w, 0, W), 31, 33);
    run(&w, 20);
    assert_within(mean_samples(&w, 0, W), 31, 33);
    run(&w, 128);
    assert_within(mean_samples(&w, 0, W), 125, 131);
    world_deinit(&w);
}

static void a_target_error_says_when_to_stop(void **state)
{
    (void)state;
    world w;
    world_init(&w, 0.1, 0.3);
    run(&w, 64);
    fl_error_estimate e;
    fl_estimate_read(w.estimate, 1, &e); /* At the end of the round. */
    assert_true(fl_estimate_next_stop(w.estimate, 64, 1.01 * e.rmse) <= (uint32_t)e.samples);
    uint32_t next = fl_estimate_next_stop(w.estimate, 64, 0.9 * e.rmse);
    assert_true(next > e.samples && next < 2.0 * e.samples);
    assert_int_equal(fl_estimate_next_stop(w.estimate, 64, 0.01 * e.rmse),
                     (uint32_t)(2.0 * e.samples));
    world_deinit(&w);
}

static void memory_is_counted(void **state)
{
    (void)state;
    size_t bytes = 0;
    assert_true(fl_allocation_bytes(640, 480, &bytes));
    assert_true(bytes >= (size_t)640 * 480 * 16);
    assert_false(fl_allocation_bytes(UINT32_MAX, UINT32_MAX, &bytes));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_noisy_half_gets_the_samples),
        cmocka_unit_test(samples_are_proportional_to_the_spread),
        cmocka_unit_test(without_noise_all_get_the_same),
        cmocka_unit_test(the_error_stays_right),
        cmocka_unit_test(a_raised_goal_goes_on),
        cmocka_unit_test(a_target_error_says_when_to_stop),
        cmocka_unit_test(memory_is_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
