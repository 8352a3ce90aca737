/* SPDX-License-Identifier: MIT
 *
 * A thousand restarts in a row, as a mouse gives them, with looks, pauses and resizes in between.
 */
#include "render_kit.h"

#include <time.h>

enum { RESTARTS = 1000, SIDE = KIT_IS_SLOW ? 48 : 160 };

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static uint32_t draw(uint32_t *random, uint32_t below)
{
    *random = fl_hash_step(*random, 1);
    return *random % below;
}

/* What is shown is never older than what was shown, and never mixes generations. */
static void look(fl_render *render, uint64_t *last_generation, float *rgb, size_t floats)
{
    fl_progress p;
    if (!fl_render_mean(render, rgb, floats, &p))
        return;
    assert_true(p.generation >= *last_generation);
    *last_generation = p.generation;
    uint32_t seed = (uint32_t)p.generation, differing = 0; /* Restart number n has seed n. */
    assert_true(p.complete_ranks > 0);
    if (p.mean_samples >= 1.0)
        return;
    for (uint32_t i = 0; i < p.width * p.height; i++) { /* Sample 0 of this seed, or none. */
        float want[3];
        const float *got = rgb + 3 * i;
        bool is_valid = fake_sample(seed, i % p.width, i / p.width, 0, want);
        bool is_black = got[0] == 0.0f && got[1] == 0.0f && got[2] == 0.0f;
        /* Amid the copy work goes on, so some may be beyond sample 0; those of rank 0 are all
         * there. */
        if (fl_bayer_rank(i % p.width, i / p.width) == 0)
            assert_true(!is_valid || !is_black);
        differing += !is_black && (!is_valid || memcmp(got, want, sizeof want) != 0);
    }
    fl_progress after;
    fl_render_progress(render, &after);
    if (after.generation == p.generation && after.complete_samples == 0 && after.mean_samples < 0.5)
        assert_int_equal(differing, 0);
}

static void storm(uint32_t threads, bool resizes)
{
    uint32_t random = 42 + threads;
    printf("seed %u, %u threads%s\n", random, threads, resizes ? ", resizing" : "");
    fl_render *render = kit_render(threads);
    size_t floats = (size_t)3 * SIDE * SIDE;
    float *rgb = malloc(floats * sizeof *rgb);
    assert_non_null(rgb);
    uint64_t generation = 0;
    uint32_t w = SIDE, h = SIDE;
    double worst = 0.0, sum = 0.0;
    for (uint32_t i = 1; i <= RESTARTS; i++) {
        if (resizes && draw(&random, 3) == 0) {
            w = 1 + draw(&random, SIDE);
            h = 1 + draw(&random, SIDE);
        }
        fl_diags diags = {0};
        fl_params params = fake_params(i, 0, 0, w, h);
        double begin = now_ms();
        bool is_done = fl_render_restart(render, NULL, &params, &diags);
        double took = now_ms() - begin;
        assert_true(is_done);
        worst = worst > took ? worst : took;
        sum += took;
        uint32_t what = draw(&random, 8);
        if (what == 0)
            look(render, &generation, rgb, floats);
        else if (what == 1)
            fl_render_wait(render, 0.0005);
        else if (what == 2)
            fl_render_set_paused(render, true);
        else if (what == 3)
            kit_limit(render, draw(&random, 3));
        fl_render_set_paused(render, false);
    }
    kit_limit(render, 3);
    assert_true(fl_render_wait(render, -1.0));
    fl_progress p;
    fl_render_progress(render, &p);
    assert_int_equal(p.generation, RESTARTS);
    kit_assert_film(render, RESTARTS, 0, 0, w, h, p.complete_samples);
    printf("restart call: mean %.4f ms, worst %.3f ms; last cancel %.4f ms\n", sum / RESTARTS,
           worst, 1e3 * p.cancel_seconds);
    free(rgb);
    fl_render_destroy(render);
}

static void one_thread(void **state)
{
    (void)state;
    storm(1, false);
}

static void two_threads(void **state)
{
    (void)state;
    storm(2, false);
}

static void seven_threads_resizing(void **state)
{
    (void)state;
    storm(7, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_thread),
        cmocka_unit_test(two_threads),
        cmocka_unit_test(seven_threads_resizing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
