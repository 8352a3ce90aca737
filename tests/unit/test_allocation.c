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

#include "noise_film.h"

enum { W = 70, H = 50, X0 = 3, Y0 = 5 };

#define TRUTH 0.5

/* Samples around TRUTH, whose kind and spread are a function of the column. */
typedef enum kind {
    KIND_INDEPENDENT,
    KIND_HALF_INVALID, /* In the right half every other sample. */
    KIND_ALTERNATING,  /* In the right half one up, one down: of even numbers nothing is left. */
    KIND_NET           /* The error falls like n^-1.4. */
} kind;

typedef struct world {
    uint32_t width, height;
    fl_film *film;
    fl_estimate *estimate;
    fl_allocation *allocation;
    kind kind;
    double spread_left, spread_right;
} world;

static noise_unit unit;

static double value(const void *context, uint32_t x, uint32_t y, uint32_t sample, uint32_t channel)
{
    const world *w = context;
    uint32_t hash = fl_hash_step(fl_hash_step(99, y << 16 | x), channel);
    bool is_right = x - X0 >= w->width / 2;
    double spread = is_right ? w->spread_right : w->spread_left;
    if (w->kind == KIND_NET)
        return TRUTH + spread * noise_at_rate(hash, sample, 1.4);
    if (is_right && w->kind == KIND_ALTERNATING)
        return TRUTH + spread * (sample % 2 ? 1.0 : -1.0);
    if (is_right && w->kind == KIND_HALF_INVALID && sample % 2)
        return (double)NAN;
    return TRUTH + spread * noise_of(fl_hash_step(hash, sample));
}

/* Sample the listed pixels. */
static void add_unit(world *w, uint32_t sample)
{
    fl_unit added;
    fl_unit_result result;
    noise_add(&unit, sample, value, w, w->film, X0, Y0, &added, &result);
    fl_allocation_add(w->allocation, &added, &result, X0, Y0);
}

static void world_begin(world *w)
{
    w->film = fl_film_create(w->width, w->height);
    w->estimate = fl_estimate_create(w->width, w->height, true);
    w->allocation = fl_allocation_create(w->width, w->height);
    assert_true(w->film && w->estimate && w->allocation);
    for (uint32_t s = 0; s < FL_ALLOCATION_BLOCK; s++) {
        assert_false(fl_allocation_has_work(w->allocation));
        for (uint32_t y = 0; y < w->height; y++) {
            noise_list_row(&unit, X0, Y0 + y, w->width);
            add_unit(w, s);
        }
        fl_estimate_capture(w->estimate, w->film, &(fl_rect){0, 0, w->width, w->height}, s + 1);
    }
}

static void world_init(world *w, double left, double right)
{
    *w = (world){.width = W, .height = H, .spread_left = left, .spread_right = right};
    world_begin(w);
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
        uint32_t count =
            fl_allocation_next(w->allocation, w->film, X0, Y0, unit.x, unit.y, &sample, &tile);
        if (count == 0) {
            assert_true(fl_allocation_must_plan(w->allocation));
            fl_allocation_plan(w->allocation, w->film, w->estimate);
            continue;
        }
        assert_true(count <= FL_UNIT_PIXELS);
        assert_false(fl_allocation_must_plan(w->allocation));
        unit.count = count;
        add_unit(w, sample);
        fl_allocation_commit(w->allocation, tile, count);
    }
}

/* Mean number of samples of the columns [begin, end); every number is whole blocks. */
static double mean_samples(const world *w, uint32_t begin, uint32_t end)
{
    uint64_t sum = 0;
    for (uint32_t y = 0; y < w->height; y++)
        for (uint32_t x = begin; x < end; x++) {
            uint32_t n;
            fl_film_samples_row(w->film, x, y, 1, &n);
            assert_true(n >= FL_ALLOCATION_BLOCK && n % FL_ALLOCATION_BLOCK == 0);
            sum += n;
        }
    return (double)sum / ((double)(end - begin) * w->height);
}

static void assert_within(double got, double low, double high)
{
    if (!(got >= low && got <= high))
        fail_msg("%g is not within %g and %g", got, low, high);
}

static void assert_even(const world *w, uint32_t samples)
{
    for (uint32_t y = 0; y < w->height; y++)
        for (uint32_t x = 0; x < w->width; x++) {
            uint32_t n;
            fl_film_samples_row(w->film, x, y, 1, &n);
            assert_int_equal(n, samples);
        }
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
    assert_even(&w, 48);
    world_deinit(&w);
}

/* Spreads above 1, as of lamps that are seen, once made every pixel of the rest want thousands. */
static void great_spreads_keep_to_the_goal(void **state)
{
    (void)state;
    world w;
    world_init(&w, 20.0, 400.0);
    run(&w, 64);
    assert_within(mean_samples(&w, 0, W), 62, 66);
    world_deinit(&w);
}

/* Where samples are spread but their means are right, more of them buy nothing. */
static void spread_that_leaves_no_error_gets_no_more(void **state)
{
    (void)state;
    world w = {.width = W, .height = H, .kind = KIND_ALTERNATING};
    w.spread_left = 0.05;
    w.spread_right = 0.4;
    world_begin(&w);
    run(&w, 48);
    assert_even(&w, 48);
    world_deinit(&w);
}

static void whole_nets_are_not_broken_up(void **state)
{
    (void)state;
    world w = {.width = W, .height = H, .kind = KIND_NET};
    w.spread_left = 0.01;
    w.spread_right = 0.4;
    world_begin(&w);
    run(&w, 64);
    assert_even(&w, 64);
    world_deinit(&w);
}

/* Samples that were dropped say nothing about the spread of the others. */
static void invalid_samples_hide_no_spread(void **state)
{
    (void)state;
    world w = {.width = W, .height = H, .kind = KIND_HALF_INVALID};
    w.spread_left = 0.1;
    w.spread_right = 0.3;
    world_begin(&w);
    run(&w, 256);
    double left = mean_samples(&w, 0, W / 2 - 2), right = mean_samples(&w, W / 2 + 2, W);
    assert_within(right / left, 2.7, 3.3);
    world_deinit(&w);
}

static void pictures_of_one_pixel_and_one_row_work(void **state)
{
    (void)state;
    const uint32_t sides[][2] = {{1, 1}, {1, 40}, {40, 1}};
    for (size_t i = 0; i < FL_COUNT_OF(sides); i++) {
        world w = {.width = sides[i][0], .height = sides[i][1]};
        w.spread_left = w.spread_right = 0.2;
        world_begin(&w);
        run(&w, 8); /* Fewer than what there is. */
        assert_even(&w, FL_ALLOCATION_BLOCK);
        run(&w, 64);
        assert_within(mean_samples(&w, 0, w.width), 60, 68);
        world_deinit(&w);
    }
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
        assert_within(e.rmse / noise_rmse(w.film, TRUTH), 0.85, 1.15);
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
        cmocka_unit_test(great_spreads_keep_to_the_goal),
        cmocka_unit_test(spread_that_leaves_no_error_gets_no_more),
        cmocka_unit_test(whole_nets_are_not_broken_up),
        cmocka_unit_test(invalid_samples_hide_no_spread),
        cmocka_unit_test(pictures_of_one_pixel_and_one_row_work),
        cmocka_unit_test(the_error_stays_right),
        cmocka_unit_test(a_raised_goal_goes_on),
        cmocka_unit_test(a_target_error_says_when_to_stop),
        cmocka_unit_test(memory_is_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
