/* SPDX-License-Identifier: MIT */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/pipeline.h"
#include "core/schedule.h"

enum { WORKERS_MAX = 9 };

/* Workers that take and return units in a random order, and what each pixel has. */
typedef struct play {
    fl_schedule *schedule;
    uint32_t width, height, worker_count, random;
    fl_work out[WORKERS_MAX];
    bool is_out[WORKERS_MAX];
    uint32_t *samples; /* Per pixel, committed. */
    uint8_t *is_held;  /* Per pixel: part of a unit that is out. */
    uint32_t last_rank;
} play;

static uint32_t draw(play *p, uint32_t below)
{
    p->random = fl_hash_step(p->random, 1);
    return p->random % below;
}

static void play_init(play *p, uint32_t w, uint32_t h, uint32_t workers, uint32_t seed)
{
    *p = (play){.schedule = fl_schedule_create(w, h),
                .width = w,
                .height = h,
                .worker_count = workers,
                .random = seed};
    p->samples = calloc((size_t)w * h, sizeof *p->samples);
    p->is_held = calloc((size_t)w * h, 1);
    assert_true(p->schedule && p->samples && p->is_held);
}

static void play_deinit(play *p)
{
    fl_schedule_destroy(p->schedule);
    free(p->samples);
    free(p->is_held);
}

/* Ranks go out, and are complete, one by one, then 4 and then 16 together. */
static uint32_t ranks_together(uint32_t rank)
{
    return rank < 4 ? 1 : rank < 16 ? 4 : 16;
}

static uint32_t pixels_of(const fl_work *work, uint16_t *x, uint16_t *y)
{
    uint32_t count = fl_work_pixels(work, 0, 0, x, y);
    assert_in_range(count, 1, FL_UNIT_PIXELS);
    return count;
}

static bool worker_takes(play *p, uint32_t worker)
{
    static uint16_t x[FL_UNIT_PIXELS], y[FL_UNIT_PIXELS];
    fl_work *work = &p->out[worker];
    bool has_work = fl_schedule_has_work(p->schedule);
    assert_int_equal(has_work, fl_schedule_next(p->schedule, work));
    if (!has_work)
        return false;
    p->is_out[worker] = true;
    if (work->sample == 0) { /* Ranks go out in order. */
        assert_true(work->rank >= p->last_rank);
        p->last_rank = work->rank;
    }
    for (uint32_t i = 0, n = pixels_of(work, x, y); i < n; i++) {
        size_t at = (size_t)y[i] * p->width + x[i];
        assert_true(x[i] < p->width && y[i] < p->height);
        assert_false(p->is_held[at]);
        p->is_held[at] = 1;
        assert_int_equal(p->samples[at], work->sample);
        if (work->sample == 0)
            assert_in_range(fl_bayer_rank(x[i], y[i]), work->rank,
                            work->rank + ranks_together(work->rank) - 1);
    }
    return true;
}

static void worker_returns(play *p, uint32_t worker)
{
    static uint16_t x[FL_UNIT_PIXELS], y[FL_UNIT_PIXELS];
    const fl_work *work = &p->out[worker];
    fl_rect rect;
    bool is_even = fl_schedule_commit(p->schedule, work, &rect);
    for (uint32_t i = 0, n = pixels_of(work, x, y); i < n; i++) {
        size_t at = (size_t)y[i] * p->width + x[i];
        p->is_held[at] = 0;
        p->samples[at]++;
    }
    p->is_out[worker] = false;
    if (!is_even)
        return;
    for (uint32_t py = rect.y0; py < rect.y1; py++)
        for (uint32_t px = rect.x0; px < rect.x1; px++)
            assert_int_equal(p->samples[(size_t)py * p->width + px], work->sample + 1);
}

static void check_sums(const play *p)
{
    uint32_t least = UINT32_MAX, ranks = 64;
    uint64_t total = 0;
    for (uint32_t y = 0; y < p->height; y++)
        for (uint32_t x = 0; x < p->width; x++) {
            uint32_t n = p->samples[(size_t)y * p->width + x];
            least = fl_min_u32(least, n);
            total += n;
            if (n == 0)
                ranks = fl_min_u32(ranks, fl_bayer_rank(x, y));
        }
    assert_int_equal(fl_schedule_total_samples(p->schedule), total);
    assert_int_equal(fl_schedule_complete_samples(p->schedule), least);
    assert_int_equal(fl_schedule_complete_ranks(p->schedule),
                     ranks / ranks_together(ranks) * ranks_together(ranks));
}

/* Until nothing is left to do and nothing is out, or `steps` are over. A worker with a unit may be
 * slow for long. */
static void play_on(play *p, uint64_t steps)
{
    for (bool is_alive = true; is_alive && steps > 0; steps--) {
        uint32_t worker = draw(p, p->worker_count);
        if (!p->is_out[worker])
            worker_takes(p, worker);
        else if (worker > 0 || draw(p, 50) == 0)
            worker_returns(p, worker);
        if (steps % 64 == 0)
            check_sums(p);
        is_alive = fl_schedule_has_work(p->schedule);
        for (uint32_t i = 0; i < p->worker_count; i++)
            is_alive |= p->is_out[i];
    }
    check_sums(p);
}

static void assert_even(const play *p, uint32_t samples)
{
    for (uint32_t i = 0; i < p->width * p->height; i++)
        assert_int_equal(p->samples[i], samples);
}

static const uint32_t sizes[][2] = {{1, 1},    {3, 70},    {8, 8},    {64, 64},
                                    {100, 77}, {129, 130}, {300, 257}};

static void every_pixel_gets_its_samples_in_order(void **state)
{
    (void)state;
    for (size_t i = 0; i < FL_COUNT_OF(sizes); i++)
        for (uint32_t workers = 1; workers <= WORKERS_MAX; workers += 2) {
            play p;
            play_init(&p, sizes[i][0], sizes[i][1], workers, 1234 + workers);
            fl_schedule_set_cap(p.schedule, 6);
            play_on(&p, UINT64_MAX);
            assert_even(&p, 6);
            fl_schedule_set_cap(p.schedule, 9); /* Raising the cap goes on. */
            play_on(&p, UINT64_MAX);
            assert_even(&p, 9);
            fl_schedule_set_cap(p.schedule, 2); /* Lowering it below changes nothing. */
            assert_false(fl_schedule_has_work(p.schedule));
            play_deinit(&p);
        }
}

static void a_cap_amid_the_work_ends_even(void **state)
{
    (void)state;
    for (uint32_t steps = 1; steps < 2000; steps += 97) {
        play p;
        play_init(&p, 100, 77, 5, steps);
        play_on(&p, steps);
        fl_schedule_set_cap(p.schedule, 1);
        uint32_t furthest = 1;
        for (uint32_t w = 0; w < 5; w++)
            if (p.is_out[w])
                furthest = fl_max_u32(furthest, p.out[w].sample + 1);
        for (uint32_t i = 0; i < 100 * 77; i++)
            furthest = fl_max_u32(furthest, p.samples[i]);
        play_on(&p, UINT64_MAX);
        assert_even(&p, furthest);
        play_deinit(&p);
    }
}

static void a_reset_forgets_all(void **state)
{
    (void)state;
    play p;
    play_init(&p, 150, 90, 3, 7);
    play_on(&p, 300);
    fl_schedule_reset(p.schedule);
    memset(p.samples, 0, sizeof *p.samples * 150 * 90);
    memset(p.is_held, 0, 150 * 90);
    memset(p.is_out, 0, sizeof p.is_out);
    p.last_rank = 0;
    fl_schedule_set_cap(p.schedule, 3);
    play_on(&p, UINT64_MAX);
    assert_even(&p, 3);
    play_deinit(&p);
}

static void a_slow_worker_holds_up_nobody(void **state)
{
    (void)state;
    play p;
    play_init(&p, 300, 257, 2, 3);
    fl_schedule_set_cap(p.schedule, 50);
    while (p.samples[0] == 0 || fl_schedule_complete_samples(p.schedule) == 0) {
        worker_takes(&p, 1);
        worker_returns(&p, 1);
    }
    assert_true(worker_takes(&p, 0)); /* And keeps it. */
    uint32_t units = 0;
    while (worker_takes(&p, 1)) {
        worker_returns(&p, 1);
        units++;
    }
    uint32_t tiles = ((300 + 31) / 32) * ((257 + 31) / 32);
    assert_true(units >= (tiles - 1) * 48); /* All others got all theirs. */
    worker_returns(&p, 0);
    play_on(&p, UINT64_MAX);
    assert_even(&p, 50);
    play_deinit(&p);
}

static uint64_t distance_from_centre(const fl_work *w, uint32_t width, uint32_t height)
{
    int64_t dx = (int64_t)w->rect.x0 + w->rect.x1 - width,
            dy = (int64_t)w->rect.y0 + w->rect.y1 - height;
    return (uint64_t)(dx * dx + dy * dy);
}

static void the_centre_comes_first(void **state)
{
    (void)state;
    play p;
    play_init(&p, 640, 640, 1, 1);
    fl_work first, later;
    fl_rect rect;
    assert_true(fl_schedule_next(p.schedule, &first));
    fl_schedule_commit(p.schedule, &first, &rect);
    assert_true(distance_from_centre(&first, 640, 640) < 16);
    do {
        assert_true(fl_schedule_next(p.schedule, &later));
        fl_schedule_commit(p.schedule, &later, &rect);
    } while (later.sample == 0);
    assert_true(distance_from_centre(&later, 640, 640) < 100 * 100);
    assert_int_equal(fl_schedule_complete_ranks(p.schedule), 64);
    play_deinit(&p);
}

/* 640 x 640: units of 256 pixels for the first look, then of 1024, as full as later samples'. */
static void the_first_sample_goes_out_in_full_units(void **state)
{
    (void)state;
    static uint16_t x[FL_UNIT_PIXELS], y[FL_UNIT_PIXELS];
    fl_schedule *schedule = fl_schedule_create(640, 640);
    assert_non_null(schedule);
    uint32_t small = 0, full = 0;
    fl_work work;
    while (fl_schedule_next(schedule, &work) && work.sample == 0) {
        uint32_t count = pixels_of(&work, x, y);
        assert_int_equal(count, work.rank < 4 ? 256 : 1024);
        small += count == 256;
        full += count == 1024;
    }
    assert_int_equal(small, 4 * 25);
    assert_int_equal(full, 3 * 25 + 3 * 100);
    fl_schedule_destroy(schedule);
}

static void ranks_are_the_bayer_order(void **state)
{
    (void)state;
    bool seen[64] = {false};
    for (uint32_t y = 0; y < 8; y++)
        for (uint32_t x = 0; x < 8; x++)
            seen[fl_bayer_rank(x, y)] = true;
    for (int i = 0; i < 64; i++)
        assert_true(seen[i]);
    assert_int_equal(fl_bayer_rank(0, 0), 0);
    assert_int_equal(fl_bayer_rank(4, 4), 1);
    assert_int_equal(fl_bayer_rank(4, 0), 2);
    assert_int_equal(fl_bayer_rank(0, 4), 3);
    assert_int_equal(fl_bayer_rank(8, 16), 0);
    for (uint32_t y = 0; y < 8;
         y++) /* The first 16 ranks are every second pixel, the first 4 every fourth. */
        for (uint32_t x = 0; x < 8; x++) {
            assert_int_equal(fl_bayer_rank(x, y) < 16, x % 2 == 0 && y % 2 == 0);
            assert_int_equal(fl_bayer_rank(x, y) < 4, x % 4 == 0 && y % 4 == 0);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pixel_gets_its_samples_in_order),
        cmocka_unit_test(a_cap_amid_the_work_ends_even),
        cmocka_unit_test(a_reset_forgets_all),
        cmocka_unit_test(a_slow_worker_holds_up_nobody),
        cmocka_unit_test(the_centre_comes_first),
        cmocka_unit_test(the_first_sample_goes_out_in_full_units),
        cmocka_unit_test(ranks_are_the_bayer_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
