/* SPDX-License-Identifier: MIT */
#include "render_kit.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>

enum { W = 100, H = 77, X0 = 8, Y0 = 3 };

static const uint32_t thread_counts[] = {1, 2, 3, 7};

static void any_number_of_threads_gives_the_same_bytes(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {5, 300}, {64, 64}, {W, H}, {200, 150}};
    for (size_t t = 0; t < FL_COUNT_OF(thread_counts); t++) {
        fl_render *render = kit_render(thread_counts[t]);
        for (size_t i = 0; i < FL_COUNT_OF(sizes); i++) {
            uint32_t w = sizes[i][0], h = sizes[i][1];
            kit_limit(render, 18);
            kit_restart(render, 77, X0, Y0, w, h);
            assert_true(fl_render_wait(render, -1.0));
            kit_assert_film(render, 77, X0, Y0, w, h, 18);
        }
        fl_render_destroy(render);
    }
}

static void restart_adaptive(fl_render *render, uint32_t seed)
{
    fl_diags diags = {0};
    fl_params params = fake_params(seed, X0, Y0, W, H);
    params.is_adaptive = true;
    assert_true(fl_render_restart(render, NULL, &params, &diags));
    fake_poke();
}

/* Every pixel holds the mean of a whole number of blocks of its own samples, `about` in the mean.
 */
static void assert_adaptive_film(fl_render *render, uint32_t seed, double about, float *out_mean)
{
    static float samples[W * H];
    fl_progress progress;
    assert_true(fl_render_mean(render, out_mean, 3 * W * H, &progress));
    assert_true(fl_render_copy_map(render, FL_RENDER_SAMPLES, samples, W * H, &progress));
    assert_true(progress.is_adaptive && progress.error.is_known);
    assert_true(fabs(progress.mean_samples / about - 1.0) < 0.03);
    uint64_t sum = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        float want[3];
        uint32_t n = (uint32_t)samples[i];
        assert_true(n >= 16 && n % 16 == 0);
        fake_mean(seed, X0 + i % W, Y0 + i / W, 1, 1, n, want);
        assert_memory_equal(out_mean + 3 * i, want, sizeof want);
        sum += n;
    }
    assert_int_equal(progress.counts.samples, sum);
}

static void adaptive_films_are_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    static float first[3 * W * H], mean[3 * W * H];
    for (size_t t = 0; t < FL_COUNT_OF(thread_counts); t++) {
        fl_render *render = kit_render(thread_counts[t]);
        kit_limit(render, 50);
        restart_adaptive(render, 5);
        assert_true(fl_render_wait(render, -1.0));
        assert_adaptive_film(render, 5, 50, t ? mean : first);
        if (t)
            assert_memory_equal(mean, first, sizeof first);
        kit_limit(render, 90);
        assert_true(fl_render_wait(render, -1.0));
        assert_adaptive_film(render, 5, 90, mean);
        fl_render_destroy(render);
    }
}

/* Amid rounds and plans, from even to adaptive and back. */
static void adaptive_renders_restart_and_end_anywhere(void **state)
{
    (void)state;
    static float mean[3 * W * H];
    fl_render *render = kit_render(3);
    for (uint32_t round = 0; round < 12; round++) {
        kit_limit(render, 64);
        fake_permit(200 + 90 * round);
        restart_adaptive(render, round);
        fake_await_waiting(1);
        if (round % 3 == 0) {
            fake_permit(UINT64_MAX);
            kit_limit(render, 2);
            kit_restart(render, round, X0, Y0, W, H);
            assert_true(fl_render_wait(render, -1.0));
            kit_assert_film(render, round, X0, Y0, W, H, 2);
        }
    }
    restart_adaptive(render, 77);
    fake_permit(UINT64_MAX);
    assert_true(fl_render_wait(render, -1.0));
    assert_adaptive_film(render, 77, 64, mean);
    fl_render_set_limits(render, &(fl_render_limits){0});
    restart_adaptive(render, 3);
    fl_render_destroy(render);
}

static void a_raised_cap_goes_on_and_a_lowered_one_keeps(void **state)
{
    (void)state;
    fl_render *render = kit_render(3);
    kit_limit(render, 5);
    kit_restart(render, 1, X0, Y0, W, H);
    assert_true(fl_render_wait(render, -1.0));
    kit_assert_film(render, 1, X0, Y0, W, H, 5);
    kit_limit(render, 33);
    assert_true(fl_render_wait(render, -1.0));
    kit_assert_film(render, 1, X0, Y0, W, H, 33);
    kit_limit(render, 2);
    assert_true(fl_render_wait(render, -1.0));
    kit_assert_film(render, 1, X0, Y0, W, H, 33);
    fl_render_destroy(render);
}

static void a_lowered_cap_amid_the_work_ends_even(void **state)
{
    (void)state;
    fl_render *render = kit_render(3);
    for (uint32_t round = 0; round < 20; round++) {
        kit_limit(render, 0);
        fake_permit(40 + 23 * round);
        kit_restart(render, round, X0, Y0, W, H);
        fake_await_waiting(1);
        kit_limit(render, 1);
        fake_permit(UINT64_MAX);
        assert_true(fl_render_wait(render, -1.0));
        fl_progress progress;
        fl_render_progress(render, &progress);
        kit_assert_film(render, round, X0, Y0, W, H, progress.complete_samples);
    }
    fl_render_destroy(render);
}

static void pauses_leave_the_bytes_alone(void **state)
{
    (void)state;
    fl_render *render = kit_render(2);
    kit_limit(render, 20);
    kit_restart(render, 9, X0, Y0, W, H);
    for (int i = 0; i < 200; i++)
        fl_render_set_paused(render, i % 2 == 0);
    fl_render_set_paused(render, true);
    fl_progress progress;
    fl_render_progress(render, &progress);
    if (progress.state != FL_RENDER_DONE) {
        assert_int_equal(progress.state, FL_RENDER_PAUSED);
        assert_false(fl_render_wait(render, -1.0)); /* At once. */
    }
    fl_render_set_paused(render, false);
    assert_true(fl_render_wait(render, -1.0));
    kit_assert_film(render, 9, X0, Y0, W, H, 20);
    fl_render_destroy(render);
}

/* What one render left, another goes on with: any number of threads, any amount of work done. */
static void a_checkpoint_goes_on_to_the_same_bytes(void **state)
{
    (void)state;
    static const uint32_t permits[] = {65, 90, 300, 1000};
    for (size_t i = 0; i < FL_COUNT_OF(permits); i++) {
        void *data = NULL;
        size_t bytes = 0;
        fl_diags diags = {0};
        fl_render *render = kit_render(thread_counts[i]);
        kit_limit(render, 40);
        fake_permit(permits[i]);
        kit_restart(render, 5, X0, Y0, W, H);
        fake_await_waiting(1);
        fake_permit(UINT64_MAX); /* Units that are out come back. */
        assert_true(fl_render_checkpoint(render, &data, &bytes, &diags));
        fl_progress before, after;
        fl_render_progress(render, &before);
        assert_true(fl_render_wait(render, -1.0)); /* The hold is over. */
        kit_assert_film(render, 5, X0, Y0, W, H, 40);
        fl_render_destroy(render);

        render = kit_render(thread_counts[FL_COUNT_OF(permits) - 1 - i]);
        kit_limit(render, 1);
        fl_params params = fake_params(5, X0, Y0, W, H);
        assert_non_null(data);
        assert_true(fl_render_resume(render, NULL, &params, data, bytes, &diags));
        assert_true(fl_render_wait(render, -1.0));
        fl_render_progress(render, &after);
        assert_true(after.counts.samples >= W * H && after.complete_ranks == FL_BAYER_RANKS);
        kit_limit(render, 40);
        assert_true(fl_render_wait(render, -1.0));
        kit_assert_film(render, 5, X0, Y0, W, H, 40);
        void *again = NULL, *whole = NULL;
        size_t again_bytes, whole_bytes;
        assert_true(fl_render_checkpoint(render, &again, &again_bytes, &diags));
        fl_render_progress(render, &after);
        fl_render_destroy(render);

        render = kit_render(2); /* Error estimate and counts as without the break, too. */
        kit_limit(render, 40);
        kit_restart(render, 5, X0, Y0, W, H);
        assert_true(fl_render_wait(render, -1.0));
        fl_render_progress(render, &before);
        assert_true(fl_render_checkpoint(render, &whole, &whole_bytes, &diags));
        assert_memory_equal(&before.error, &after.error, sizeof before.error);
        assert_memory_equal(&before.counts, &after.counts, sizeof before.counts);
        assert_int_equal(again_bytes, whole_bytes);
        fl_render_destroy(render);
        assert_int_equal(diags.count, 0);
        free(data);
        free(again);
        free(whole);
    }
}

static void a_damaged_checkpoint_is_refused_and_the_render_begins_anew(void **state)
{
    (void)state;
    fl_diags diags = {0};
    void *data = NULL, *nothing = &diags;
    size_t bytes = 0, no_bytes = 1;
    fl_render *render = kit_render(2);
    assert_true(fl_render_checkpoint(render, &nothing, &no_bytes, &diags));
    assert_true(nothing == NULL && no_bytes == 0); /* No samples, nothing to keep. */
    kit_limit(render, 3);
    kit_restart(render, 5, X0, Y0, W, H);
    assert_true(fl_render_wait(render, -1.0));
    assert_true(fl_render_checkpoint(render, &data, &bytes, &diags));
    fl_render_destroy(render);
    uint8_t *copy = malloc(bytes);
    assert_non_null(copy);
    for (uint32_t round = 0; round < 5; round++) {
        memcpy(copy, data, bytes);
        size_t length = round == 0 ? bytes - 1 : round == 1 ? 7 : bytes;
        if (round == 2)
            copy[0] ^= 1; /* Another version of the format. */
        if (round == 3)
            copy[4]++;  /* Another width. */
        if (round == 4) /* More invalid samples than samples. */
            memset(copy + bytes - (W * H * 3 * sizeof(float)) - 35 * sizeof(double) * 2 - 64, 255,
                   64);
        render = kit_render(2);
        kit_limit(render, 3);
        fl_params params = fake_params(6, X0, Y0, W, H);
        assert_false(fl_render_resume(render, NULL, &params, copy, length, &diags));
        assert_int_equal(diags.error_count, round + 1);
        assert_true(fl_render_wait(render, -1.0));
        kit_assert_film(render, 6, X0, Y0, W, H, 3);
        fl_render_destroy(render);
    }
    free(copy);
    free(data);
    fl_diags_deinit(&diags);
}

static void an_empty_render_has_nothing(void **state)
{
    (void)state;
    fl_render *render = kit_render(2);
    fl_progress progress;
    uint64_t revision = 0;
    float rgb[3];
    uint8_t rgba[4];
    assert_false(fl_render_wait(render, -1.0));
    assert_false(fl_render_mean(render, rgb, 3, &progress));
    assert_false(fl_render_display(render, &revision, &(fl_tonemap){0}, rgba, 4, &progress));
    assert_int_equal(progress.width, 0);
    assert_int_equal(progress.state, FL_RENDER_EMPTY);
    fl_render_destroy(render);
    fl_render_destroy(NULL);
}

/* The fake's noise is uniform on [0, 1]: variance 1/12, falling like 1/n. */
static void noise_stops_at_the_same_sample_for_all_threads(void **state)
{
    (void)state;
    uint32_t stopped_at = 0;
    for (size_t t = 0; t < FL_COUNT_OF(thread_counts); t++) {
        fl_render *render = kit_render(thread_counts[t]);
        fl_render_set_limits(render, &(fl_render_limits){.noise_rmse = 0.06});
        kit_restart(render, 4, X0, Y0, W, H);
        assert_true(fl_render_wait(render, -1.0));
        fl_progress progress;
        fl_render_progress(render, &progress);
        if (stopped_at == 0)
            stopped_at = progress.complete_samples;
        assert_int_equal(progress.complete_samples, stopped_at);
        assert_true(progress.error.is_known && progress.error.rmse <= 0.06);
        double truth = sqrt(1.0 / 12.0 / (progress.complete_samples * 63.0 / 64.0));
        assert_true(progress.error.low <= truth && truth <= progress.error.high);
        kit_assert_film(render, 4, X0, Y0, W, H, stopped_at);
        /* A tighter target goes on, a looser one does not. */
        fl_render_set_limits(render, &(fl_render_limits){.noise_rmse = 0.5});
        assert_true(fl_render_wait(render, -1.0));
        kit_assert_film(render, 4, X0, Y0, W, H, stopped_at);
        fl_render_set_limits(render, &(fl_render_limits){.noise_rmse = 0.03});
        assert_true(fl_render_wait(render, -1.0));
        fl_render_progress(render, &progress);
        assert_true(progress.complete_samples > 3 * stopped_at);
        kit_assert_film(render, 4, X0, Y0, W, H, progress.complete_samples);
        fl_render_destroy(render);
    }
    assert_in_range(stopped_at, 17, 40);
}

static void time_stops_with_an_even_film(void **state)
{
    (void)state;
    fl_render *render = kit_render(2);
    fl_render_set_limits(render, &(fl_render_limits){.seconds = 1e-9});
    kit_restart(render, 3, X0, Y0, W, H);
    assert_true(fl_render_wait(render, -1.0));
    kit_assert_film(render, 3, X0, Y0, W, H, 1);
    fl_render_set_limits(render, &(fl_render_limits){.seconds = 0.02});
    assert_true(fl_render_wait(render, -1.0));
    fl_progress progress;
    fl_render_progress(render, &progress);
    assert_true(progress.seconds >= 0.02);
    kit_assert_film(render, 3, X0, Y0, W, H, progress.complete_samples);
    fl_render_destroy(render);
}

static void the_old_picture_stays_until_rank_0_of_the_new_one(void **state)
{
    (void)state;
    fl_render *render = kit_render(1); /* So that permits go to ranks in order. */
    kit_limit(render, 3);
    kit_restart(render, 10, X0, Y0, W, H);
    assert_true(fl_render_wait(render, -1.0));
    fake_permit(0);
    kit_restart(render, 11, X0, Y0, W / 2, H / 2); /* Another size. */
    fake_await_waiting(1);
    kit_assert_film(render, 10, X0, Y0, W, H, 3);
    fl_progress progress;
    fl_render_progress(render, &progress);
    assert_int_equal(progress.generation, 2);
    assert_int_equal(progress.complete_ranks, 0);
    fake_permit(1); /* The picture is one cell: rank 0 is one unit. */
    fake_await_waiting(1);
    do
        fl_render_progress(render, &progress);
    while (progress.complete_ranks == 0);
    static uint8_t rgba[4 * W * H];
    uint64_t revision = 0;
    assert_true(
        fl_render_display(render, &revision, &(fl_tonemap){0}, rgba, sizeof rgba, &progress));
    assert_int_equal(progress.generation, 2);
    assert_int_equal(progress.width, W / 2);
    for (uint32_t y = 0; y < H / 2; y++) /* Holes show the pixel of rank 0. */
        for (uint32_t x = 0; x < W / 2; x++)
            assert_memory_equal(rgba + 4 * (y * (W / 2) + x),
                                rgba + 4 * ((y & ~7u) * (W / 2) + (x & ~7u)), 4);
    fake_permit(UINT64_MAX);
    assert_true(fl_render_wait(render, -1.0));
    kit_assert_film(render, 11, X0, Y0, W / 2, H / 2, 3);
    fl_render_destroy(render);
}

static void each_picture_gets_its_rank_0_and_the_newest_wins(void **state)
{
    (void)state;
    fl_render *render = kit_render(1); /* So that permits go to ranks in order. */
    kit_limit(render, 2);
    for (uint32_t round = 0; round < 10; round++) {
        fake_permit(0);
        uint32_t w = round % 2 ? W : W / 2; /* With and without a film to take over. */
        kit_restart(render, 100, 0, 0, W, H);
        fake_await_waiting(1);
        for (uint32_t i = 0; i < 5; i++)
            kit_restart(render, 200 + i, 0, 0, i < 4 ? W / 2 : w, H);
        fl_progress before, after;
        fl_render_progress(render, &before);
        assert_int_equal(before.newest_generation, before.generation + 5);
        assert_int_equal(before.complete_ranks, 0);
        fake_permit(1); /* Rank 0 of seed 100: then the last restart begins, none between. */
        do
            fl_render_progress(render, &after);
        while (after.generation == before.generation);
        assert_int_equal(after.generation, before.newest_generation);
        static float rgb[3 * W * H], sample[3];
        assert_true(fl_render_mean(render, rgb, FL_COUNT_OF(rgb),
                                   &after)); /* Seed 100 is what is seen now. */
        assert_int_equal(after.generation, before.generation);
        assert_int_equal(after.complete_ranks, 1);
        if (fake_sample(100, 8, 8, 0, sample))
            assert_memory_equal(rgb + 3 * (8 * W + 8), sample, sizeof sample);
        fake_poke();
        fake_permit(UINT64_MAX);
        assert_true(fl_render_wait(render, -1.0));
        kit_assert_film(render, 204, 0, 0, w, H, 2);
    }
    fl_render_destroy(render);
}

static void a_restart_while_paused_is_taken_at_once(void **state)
{
    (void)state;
    fl_render *render = kit_render(2);
    kit_limit(render, 2);
    fl_render_set_paused(render, true);
    for (uint32_t i = 0; i < 10; i++)
        kit_restart(render, i, 0, 0, i % 3 ? W : W / 2, H);
    fl_progress progress;
    fl_render_progress(render, &progress);
    assert_int_equal(progress.generation, 10);
    assert_int_equal(progress.newest_generation, 10);
    fl_render_set_paused(render, false);
    assert_true(fl_render_wait(render, -1.0));
    kit_assert_film(render, 9, 0, 0, W / 2, H, 2);
    fl_render_destroy(render);
}

static void too_large_a_film_is_refused_and_the_old_one_stays(void **state)
{
    (void)state;
    fl_diags diags = {0};
    size_t film;
    assert_true(fl_film_bytes(W, H, &film));
    fl_render_options options = {.thread_count = 2, .memory_limit_bytes = 4 * film};
    fl_render *render = fl_render_create(&options, &diags);
    assert_non_null(render);
    kit_limit(render, 2);
    kit_restart(render, 1, 0, 0, W, H);
    assert_true(fl_render_wait(render, -1.0));
    fl_params params = fake_params(2, 0, 0, 4 * W, H);
    assert_false(fl_render_restart(render, NULL, &params, &diags));
    assert_int_equal(diags.error_count, 1);
    assert_int_equal(diags.items[0].cause, FL_CAUSE_ENVIRONMENT);
    assert_non_null(strstr(diags.items[0].message, "400 x 77 pixels needs "));
    kit_assert_film(render, 1, 0, 0, W, H, 2);
    params.crop_w = 0; /* Refused by the frame. */
    assert_false(fl_render_restart(render, NULL, &params, &diags));
    kit_assert_film(render, 1, 0, 0, W, H, 2);
    for (uint32_t i = 0; i < 5; i++) { /* Two films are all it takes. */
        kit_restart(render, 3 + i, 0, 0, W, H);
        assert_true(fl_render_wait(render, -1.0));
    }
    kit_assert_film(render, 7, 0, 0, W, H, 2);
    fl_diags_deinit(&diags);
    fl_render_destroy(render);
}

static void a_worker_without_memory_fails_the_render_until_restart(void **state)
{
    (void)state;
    fl_render *render = kit_render(3);
    kit_limit(render, 4);
    fake_fail_next();
    kit_restart(render, 1, 0, 0, W, H);
    assert_false(fl_render_wait(render, -1.0));
    fl_progress progress;
    fl_render_progress(render, &progress);
    assert_int_equal(progress.state, FL_RENDER_FAILED);
    kit_restart(render, 2, 0, 0, W, H);
    assert_true(fl_render_wait(render, -1.0));
    kit_assert_film(render, 2, 0, 0, W, H, 4);
    fl_render_destroy(render);
}

typedef struct listener {
    pthread_mutex_t lock;
    pthread_cond_t called;
    uint32_t calls;
} listener;

static void hear(void *context)
{
    listener *l = context;
    pthread_mutex_lock(&l->lock);
    l->calls++;
    pthread_cond_signal(&l->called);
    pthread_mutex_unlock(&l->lock);
}

static void one_call_for_each_look_until_done(void **state)
{
    (void)state;
    listener l = {.lock = PTHREAD_MUTEX_INITIALIZER, .called = PTHREAD_COND_INITIALIZER};
    fl_diags diags = {0};
    fl_render_options options = {.thread_count = 3, .notify = hear, .notify_context = &l};
    fl_render *render = fl_render_create(&options, &diags);
    assert_non_null(render);
    kit_limit(render, 8);
    kit_restart(render, 1, 0, 0, W, H);
    static uint8_t rgba[4 * W * H];
    uint64_t revision = 0;
    fl_progress progress = {0};
    uint32_t looks = 0;
    while (progress.state !=
           FL_RENDER_DONE) { /* As a viewer does: sleep until called, then look. */
        pthread_mutex_lock(&l.lock);
        while (l.calls <= looks)
            pthread_cond_wait(&l.called, &l.lock);
        /* One call, or two when sample 0 has become complete meanwhile. */
        assert_in_range(l.calls, looks + 1, looks + 2);
        pthread_mutex_unlock(&l.lock);
        looks++;
        fl_render_display(render, &revision, &(fl_tonemap){0}, rgba, sizeof rgba, &progress);
    }
    assert_true(l.calls <= looks + 1);
    assert_int_equal(progress.complete_samples, 8);
    assert_false(
        fl_render_display(render, &revision, &(fl_tonemap){0}, rgba, sizeof rgba, &progress));
    static float rgb[3 * W * H];
    static uint8_t want[4 * W * H];
    assert_true(fl_render_mean(render, rgb, FL_COUNT_OF(rgb), &progress));
    fl_tonemap_rgba8(&(fl_tonemap){0}, rgb, W * H, want);
    assert_memory_equal(rgba, want, sizeof want);
    fl_tonemap brighter = {.exposure_ev = 1.5};
    revision = 0; /* For a new exposure: the same film again. */
    assert_true(fl_render_display(render, &revision, &brighter, rgba, sizeof rgba, &progress));
    fl_tonemap_rgba8(&brighter, rgb, W * H, want);
    assert_memory_equal(rgba, want, sizeof want);
    revision = 0;
    assert_false(fl_render_display(render, &revision, &brighter, rgba, sizeof rgba - 1, &progress));
    assert_int_equal(progress.width, W);
    fl_render_destroy(render);
}

/* By one worker, which is given rank 0 first: it is a picture before the sample is complete. */
static void the_first_sample_is_told_to_who_does_not_look(void **state)
{
    (void)state;
    listener l = {.lock = PTHREAD_MUTEX_INITIALIZER, .called = PTHREAD_COND_INITIALIZER};
    fl_diags diags = {0};
    fl_render_options options = {.thread_count = 1, .notify = hear, .notify_context = &l};
    fl_render *render = fl_render_create(&options, &diags);
    assert_non_null(render);
    assert_false(fl_render_has_sample(render, 0));
    kit_limit(render, 8);
    kit_restart(render, 1, 0, 0, W, H);
    assert_true(fl_render_wait(render, -1.0));
    assert_true(fl_render_has_sample(render, 1));
    assert_false(fl_render_has_sample(render, 2));
    fl_render_destroy(render); /* Who calls has called. */
    assert_int_equal(l.calls, 2);
}

/* Mean of the 3 x 3 pixels around, `share` of each neighbour along either axis; the edge repeats.
 */
static void smoothed(const float *rgb, float share, float *out_rgb)
{
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            for (int c = 0; c < 3; c++) {
                double sum = 0.0, weight = 0.0;
                for (int j = -1; j <= 1; j++)
                    for (int i = -1; i <= 1; i++) {
                        int at_x = x + i < 0 ? 0 : x + i >= W ? W - 1 : x + i;
                        int at_y = y + j < 0 ? 0 : y + j >= H ? H - 1 : y + j;
                        double part = (i ? (double)share : 1.0) * (j ? (double)share : 1.0);
                        sum += part * (double)rgb[3 * (at_y * W + at_x) + c];
                        weight += part;
                    }
                out_rgb[3 * (y * W + x) + c] = (float)(sum / weight);
            }
}

static void only_the_display_of_the_first_samples_is_smooth(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_render_options options = {.thread_count = 2, .smooths_display = true};
    fl_render *render = fl_render_create(&options, &diags);
    assert_non_null(render);
    for (uint32_t samples = 1; samples <= 2; samples++) {
        static float rgb[3 * W * H], filtered[3 * W * H];
        static uint8_t rgba[4 * W * H], want[4 * W * H];
        kit_limit(render, samples);
        kit_restart(render, 5, 0, 0, W, H);
        assert_true(fl_render_wait(render, -1.0));
        kit_assert_film(render, 5, 0, 0, W, H, samples);
        fl_progress progress;
        uint64_t revision = 0;
        fl_tonemap tonemap = {.exposure_ev = -1.0};
        assert_true(fl_render_display(render, &revision, &tonemap, rgba, sizeof rgba, &progress));
        assert_true(fl_render_mean(render, rgb, FL_COUNT_OF(rgb), &progress));
        /* The fake frame has neither lens nor lights: from the second sample on, as it is. */
        smoothed(rgb, samples == 1 ? 0.25f : 0.0f, filtered);
        fl_tonemap_rgba8(&tonemap, filtered, W * H, want);
        for (size_t i = 0; i < sizeof rgba; i++)
            assert_in_range(rgba[i] + 1 - want[i], samples == 1 ? 0 : 1, samples == 1 ? 2 : 1);
        fl_tonemap_rgba8(&tonemap, rgb, W * H, want);
        assert_int_equal(memcmp(rgba, want, sizeof want) == 0, samples == 2);
    }
    fl_render_destroy(render);
}

static void counts_and_times_are_those_of_the_film(void **state)
{
    (void)state;
    uint64_t invalid = 0;
    for (uint32_t i = 0; i < W * H * 6; i++) {
        float rgb[3];
        invalid += !fake_sample(5, i % W, i / W % H, i / (W * H), rgb);
    }
    assert_true(invalid > 0);
    fl_render *render = kit_render(3);
    kit_limit(render, 6);
    kit_restart(render, 5, 0, 0, W, H);
    assert_true(fl_render_wait(render, -1.0));
    fl_progress p;
    fl_render_progress(render, &p);
    assert_int_equal(p.counts.invalid_samples, invalid);
    assert_int_equal(p.complete_ranks, 64);
    assert_true(p.first_picture_seconds > 0.0 && p.first_picture_seconds <= p.first_sample_seconds);
    assert_true(p.seconds > 0.0 && p.cpu_seconds > 0.0);
    /* The stages share exactly the time there is. */
    double sum = 0.0;
    for (int i = 0; i < FL_COST_COUNT; i++)
        sum += p.cost_seconds[i];
    assert_true(p.cost_seconds[FL_COST_NEAREST] > 0.0);
    assert_true(fabs(sum - p.cpu_seconds) <= 1e-9 * p.cpu_seconds);
    fl_progress later;
    fl_render_progress(render, &later);
    assert_true(later.seconds == p.seconds); /* The clock stands. */
    fl_render_destroy(render);
}

static void quitting_amid_the_work_is_clean(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 30; i++) {
        fl_render *render = kit_render(3);
        kit_restart(render, i, 0, 0, W, H);
        if (i % 3 > 0)
            kit_restart(render, i, 0, 0, W / 2, H);
        if (i % 3 > 1)
            kit_restart(render, i, 0, 0, W, H);
        fl_render_destroy(render);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bytes),
        cmocka_unit_test(adaptive_films_are_the_same_for_any_number_of_threads),
        cmocka_unit_test(adaptive_renders_restart_and_end_anywhere),
        cmocka_unit_test(a_raised_cap_goes_on_and_a_lowered_one_keeps),
        cmocka_unit_test(a_lowered_cap_amid_the_work_ends_even),
        cmocka_unit_test(pauses_leave_the_bytes_alone),
        cmocka_unit_test(a_checkpoint_goes_on_to_the_same_bytes),
        cmocka_unit_test(a_damaged_checkpoint_is_refused_and_the_render_begins_anew),
        cmocka_unit_test(an_empty_render_has_nothing),
        cmocka_unit_test(noise_stops_at_the_same_sample_for_all_threads),
        cmocka_unit_test(time_stops_with_an_even_film),
        cmocka_unit_test(the_old_picture_stays_until_rank_0_of_the_new_one),
        cmocka_unit_test(each_picture_gets_its_rank_0_and_the_newest_wins),
        cmocka_unit_test(a_restart_while_paused_is_taken_at_once),
        cmocka_unit_test(too_large_a_film_is_refused_and_the_old_one_stays),
        cmocka_unit_test(a_worker_without_memory_fails_the_render_until_restart),
        cmocka_unit_test(one_call_for_each_look_until_done),
        cmocka_unit_test(the_first_sample_is_told_to_who_does_not_look),
        cmocka_unit_test(only_the_display_of_the_first_samples_is_smooth),
        cmocka_unit_test(counts_and_times_are_those_of_the_film),
        cmocka_unit_test(quitting_amid_the_work_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
