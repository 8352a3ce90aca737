/* SPDX-License-Identifier: MIT
 *
 * What explains the picture: the tree of rays of a click, the meter of needs, the trade curve and
 * the stress lens. Counts are exact and asserted; times never are.
 */
#include "viewer_kit.h"

#include <math.h>

#include "viewer/words.h"

/* Render to exactly that many samples and have everything that is wanted measured. */
static void settle(vw_session *session, uint32_t samples)
{
    fl_diags diags = {0};
    session->exact_samples = samples;
    vw_session_set_limits(session);
    assert_true(vw_session_restart(session, &diags));
    assert_true(fl_render_wait(session->render, -1.0));
    vw_session_refresh(session, &diags);
    vw_session_settle(session, &diags);
    vw_session_refresh(session, &diags);
    assert_int_equal(diags.error_count, 0);
}

static void click(vw_session *session, double x, double y, int mods, uint64_t ms)
{
    vw_event move = {.kind = VW_EVENT_CURSOR, .x = x, .y = y};
    vw_event press = {.kind = VW_EVENT_BUTTON,
                      .code = GLFW_MOUSE_BUTTON_LEFT,
                      .action = GLFW_PRESS,
                      .mods = mods};
    vw_event release = press;
    release.action = GLFW_RELEASE;
    send(session, &move, ms);
    send(session, &press, ms);
    send(session, &release, ms);
}

static const vw_board_row *row_named(const vw_board *board, const char *label)
{
    for (uint32_t i = 0; i < board->row_count; i++)
        if (strcmp(board->rows[i].label, label) == 0)
            return &board->rows[i];
    return NULL;
}

static const vw_trial *trial_named(const vw_session *session, const char *name)
{
    const vw_lab_answer *answer = &session->insight.answer;
    for (uint32_t i = 0; i < answer->trial_count; i++)
        if (strcmp(answer->trials[i].name, name) == 0)
            return &answer->trials[i];
    fail_msg("there is no trial '%s'", name);
    return NULL;
}

static void a_click_prints_the_rays_of_a_sample(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    vw_board board;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    settle(&session, 3);
    assert_false(vw_session_board(&session, &board));
    float film[3], sum[3] = {0.0f, 0.0f, 0.0f};
    uint32_t samples;
    double rmse;
    assert_true(fl_render_pixel(session.render, 60, 30, film, &samples, &rmse));
    /* Three clicks are the pixel's three samples: their mean is the film's value. */
    double total[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < 3; i++) {
        click(&session, 60.5, 30.25, GLFW_MOD_CONTROL, 100 * i);
        uint32_t sample;
        assert_int_equal(sscanf(session.insight.rays_text, "pixel 60 30, sample %u: %g %g %g,",
                                &sample, &sum[0], &sum[1], &sum[2]),
                         4);
        assert_int_equal(sample, i);
        for (int c = 0; c < 3; c++)
            total[c] += (double)sum[c];
    }
    for (int c = 0; c < 3; c++)
        assert_true((float)(total[c] / 3.0) == film[c]);
    assert_non_null(strstr(session.insight.rays_text, "hits sphere 3, three.txt:"));
    assert_non_null(strstr(session.insight.rays_text, "reflect weight"));
    assert_true(vw_session_board(&session, &board));
    assert_non_null(strstr(board.title, "pixel 60 30, sample 2"));
    assert_non_null(strstr(board.rows[0].label, "camera: sphere 3, three.txt:"));
    /* Another pixel begins anew; outside nothing happens; Esc closes. */
    click(&session, 10.5, 30.25, GLFW_MOD_CONTROL, 500);
    assert_int_equal(session.state.rays_sample, 0);
    click(&session, -10.0, 30.25, GLFW_MOD_CONTROL, 600);
    assert_int_equal(session.state.rays_x, 10);
    tap(&session, GLFW_KEY_ESCAPE, 0, 700);
    assert_false(vw_session_board(&session, &board));
    assert_null(session.insight.lab);
    vw_session_close(&session);
}

static void the_inspector_knows_the_pixel(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    char notes[1024], want[64], error[24];
    float rgb[3];
    uint32_t samples;
    double rmse;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    tap(&session, GLFW_KEY_I, 0, 100);
    vw_event move = {.kind = VW_EVENT_CURSOR, .x = 60.5, .y = 30.25};
    send(&session, &move, 200);
    settle(&session, 8);
    vw_session_notes(&session, notes, sizeof notes);
    assert_true(fl_render_pixel(session.render, 60, 30, rgb, &samples, &rmse));
    assert_true(samples == 8 && rmse > 0.0);
    snprintf(want, sizeof want, "pixel 60 30: %.4g %.4g %.4g, 8 samples\n", (double)rgb[0],
             (double)rgb[1], (double)rgb[2]);
    assert_non_null(strstr(notes, want));
    vw_words_percent(rmse, error);
    snprintf(want, sizeof want, "\nerror %s, in its", error);
    assert_non_null(strstr(notes, want));
    assert_non_null(strstr(notes, "\nsphere 3, three.txt:39"));
    /* Blur by the depth that stands beside it. */
    double depth, blur;
    assert_int_equal(sscanf(strstr(notes, "depth "), "depth %lg  blur %lg px", &depth, &blur), 2);
    double exact = fabs(vw_blur_px(&session.state.look.camera, 64, depth));
    assert_true(fabs(blur - exact) < 0.02 * exact + 0.01);
    vw_session_close(&session);
}

static void the_meter_says_what_the_scene_needs(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    vw_board board;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    tap(&session, GLFW_KEY_M, 0, 100);
    settle(&session, 4);
    assert_true(vw_session_board(&session, &board));
    assert_non_null(strstr(board.rows[0].label, "uses spheres, patches,"));
    assert_non_null(row_named(&board, "nearest"));
    double shares = 0.0;
    for (uint32_t i = 0; i < board.row_count; i++)
        for (int k = 0; k < FL_COST_COUNT; k++)
            if (strcmp(board.rows[i].label, fl_cost_names[k]) == 0)
                shares += board.rows[i].bar;
    assert_true(shares > 0.9 && shares < 1.001);
    /* The picture is small enough to be measured whole: 16 samples of all pixels. */
    const vw_trial *now = trial_named(&session, "now");
    assert_int_equal(session.insight.answer.trial_count, 5);
    assert_true(trial_named(&session, "all lights")->rays <
                trial_named(&session, "shadows")->rays + 1e-9);
    assert_true(trial_named(&session, "mirrors and glass")->rays < now->rays);
    assert_true(trial_named(&session, "lens")->change > 0.0);
    assert_non_null(row_named(&board, "shadows"));
    assert_non_null(row_named(&board, "mirrors and glass"));
    /* Rays are those of a render of the same pixels, to the last one. */
    double rays = now->rays;
    fl_params params;
    fl_diags diags = {0};
    vw_state_params(&session.state, &session.scene.params, &params);
    params.seed = fl_lowbias32(params.seed + 2);
    fl_render_set_limits(session.render, &(fl_render_limits){.samples = 16});
    assert_true(fl_render_restart(session.render, session.scene.compiled, &params, &diags));
    assert_true(fl_render_wait(session.render, -1.0));
    fl_progress progress;
    fl_render_progress(session.render, &progress);
    const fl_counts *c = &progress.counts;
    uint64_t all = c->camera_rays + c->shadow_rays + c->reflect_rays + c->refract_rays;
    assert_true(rays == (double)all / (96.0 * 64.0 * 16.0));
    vw_session_close(&session);
}

static void the_noise_is_split_and_light_samples_offered(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    vw_board board;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    tap(&session, GLFW_KEY_N, GLFW_MOD_SHIFT, 50);
    assert_int_equal(session.state.look.light_samples, 0);
    tap(&session, GLFW_KEY_N, 0, 100);
    settle(&session, 16);
    /* What the window shows is what the core says when it is asked the same. */
    fl_params params;
    fl_diags diags = {0};
    fl_noise_split want;
    vw_state_params(&session.state, &session.scene.params, &params);
    fl_noise *noise = fl_noise_create(session.scene.compiled, &params, 16, &diags);
    assert_non_null(noise);
    while (fl_noise_rounds(noise) < FL_NOISE_ROUNDS)
        assert_true(fl_noise_step(noise));
    assert_true(fl_noise_read(noise, &want));
    fl_noise_destroy(noise);
    const fl_noise_split *got = &session.insight.answer.noise;
    assert_int_equal(got->rounds, FL_NOISE_ROUNDS);
    assert_int_equal(got->source_count, want.source_count);
    assert_true(vw_session_board(&session, &board));
    double sum = 0.0;
    for (uint32_t i = 0; i < want.source_count; i++) {
        char name[FL_NOISE_NAME_BYTES];
        assert_true(got->sources[i].share == want.sources[i].share);
        fl_noise_source_name(&want.sources[i], name);
        assert_true(row_named(&board, name)->bar == want.sources[i].share);
        sum += want.sources[i].share;
    }
    assert_true(fabs(sum - 1.0) < 1e-9);
    /* Later, the noise of more samples; the old answer stands until then. */
    settle(&session, 32);
    assert_int_equal(session.insight.answer.noise.samples, 32);
    /* Shift+N takes the number that is shown; undo gives it back. */
    uint32_t best = session.state.light_samples_best;
    assert_true(best >= 1);
    session.state.light_samples_best = best = best == 1 ? 3 : best;
    assert_true(tap(&session, GLFW_KEY_N, GLFW_MOD_SHIFT, 5000) & VW_DIRTY_CAMERA);
    assert_int_equal(session.state.look.light_samples, best);
    assert_false(tap(&session, GLFW_KEY_N, GLFW_MOD_SHIFT, 9000) & VW_DIRTY_CAMERA);
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 13000);
    assert_int_equal(session.state.look.light_samples, 0);
    vw_session_close(&session);
}

static void the_trade_curve_shows_where_the_picture_is(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    vw_board board;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    tap(&session, GLFW_KEY_T, 0, 100);
    settle(&session, 16);
    assert_true(vw_session_board(&session, &board));
    assert_true(board.has_plot && board.plot.count >= 1 && board.plot.has_forecast);
    uint32_t last = board.plot.count - 1;
    assert_true(board.plot.y[last] == 100.0 * session.progress.error.rmse);
    assert_non_null(row_named(&board, "half that"));
    /* Twice the shadow rays, and less noise; no more bounces, and another picture. */
    const vw_trial *now = trial_named(&session, "now");
    const vw_trial *more = trial_named(&session, "light samples 2");
    assert_true(more->rays > now->rays && more->rmse < now->rmse);
    assert_true(trial_named(&session, "depth 4")->rays <= now->rays);
    assert_true(trial_named(&session, "depth 6")->rays >= now->rays);
    assert_true(trial_named(&session, "depth 4")->change > 0.0);
    assert_true(now->change == 0.0);
    assert_non_null(row_named(&board, "light samples 2"));
    /* Measured: two seeds, no prediction. Both say the same within their own spread. */
    double ratio = now->rmse / session.progress.error.rmse;
    assert_true(ratio > 0.5 && ratio < 2.0);
    /* The same question has the same answer. */
    vw_trial before = *now;
    tap(&session, GLFW_KEY_T, 0, 200);
    settle(&session, 16);
    tap(&session, GLFW_KEY_T, 0, 300);
    settle(&session, 16);
    now = trial_named(&session, "now");
    assert_true(now->rays == before.rays && now->rmse == before.rmse);
    vw_session_close(&session);
}

static void the_stress_lens_finds_what_changes(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    char notes[1024];
    open_session(&session, &options, VIEWER_TEST_SCENE);
    for (int stress = 1; stress < VW_STRESS_COUNT; stress++) {
        tap(&session, GLFW_KEY_J, 0, 100 * (uint64_t)stress);
        settle(&session, 4);
        const vw_insight *insight = &session.insight;
        assert_int_equal(session.state.stress, stress);
        assert_string_equal(insight->answer.error, "");
        assert_int_equal(insight->answer.width, 96);
        assert_true(isfinite(insight->largest));
        vw_session_notes(&session, notes, sizeof notes);
        char want[160];
        snprintf(want, sizeof want, "stress, %s: %u of 6144 pixels changed, at most by",
                 vw_stress_names[stress], insight->changed);
        if (!strstr(notes, want))
            fail_msg("expected '%s' in '%s'", want, notes);
        /* More digits, or another size, are the same picture but for rounding; another lens is
         * another picture. */
        if (stress == VW_STRESS_DOUBLE || stress == VW_STRESS_SMALL || stress == VW_STRESS_LARGE)
            assert_true(insight->changed < 6144 / 100 && insight->touched > 100);
        else
            assert_true(insight->changed > 100);
        /* What is shown is painted, what is saved is not. */
        assert_true(vw_session_shown(&session) != session.rgba);
    }
    tap(&session, GLFW_KEY_J, 0, 2000);
    assert_int_equal(session.state.stress, VW_STRESS_OFF);
    settle(&session, 4);
    assert_true(vw_session_shown(&session) == session.rgba);
    tap(&session, GLFW_KEY_J, GLFW_MOD_SHIFT, 2100);
    assert_int_equal(session.state.stress, VW_STRESS_COUNT - 1);
    vw_session_close(&session);
}

/* Six times J: focused so near that no lens so wide can be. */
static void a_stress_that_cannot_be_says_so(void **unused)
{
    (void)unused;
    char path[256], notes[1024];
    write_file("wide.txt",
               "firstlight 1\nPerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 40\n"
               "width 16 height 16 aperture 7000 focus 6 }\n"
               "Materials { numMaterials 1 Material { diffuseColor 1 1 1 } }\n"
               "Group { numObjects 1 MaterialIndex 0 Sphere { center 0 0 0 radius 1 } }\n",
               path);
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, path);
    for (uint64_t i = 0; i < VW_STRESS_NEAR; i++)
        tap(&session, GLFW_KEY_J, 0, 100 * i);
    assert_int_equal(session.state.stress, VW_STRESS_NEAR);
    settle(&session, 1);
    vw_session_notes(&session, notes, sizeof notes);
    assert_non_null(strstr(notes, "stress, focus 1e-6: 'aperture' must be at most"));
    vw_session_close(&session);
}

static void nobody_waits_for_measurements(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    fl_diags diags = {0};
    for (int i = 0; i < 12; i++) {
        vw_session session;
        open_session(&session, &options, VIEWER_TEST_SCENE);
        assert_true(vw_session_restart(&session, &diags));
        for (int k = 0; k <= i; k++) {
            static const int keys[] = {GLFW_KEY_T, GLFW_KEY_J, GLFW_KEY_M, GLFW_KEY_J, GLFW_KEY_T};
            tap(&session, keys[k % 5], 0, 10 * (uint64_t)k);
            session.state.look.camera.center.x += 0.01;
            assert_true(vw_session_restart(&session, &diags));
            fl_render_wait(session.render, 0.01);
            vw_session_refresh(&session, &diags);
            if (k == 5)
                vw_session_settle(&session, &diags);
        }
        vw_session_close(&session); /* In the middle of whatever is measured. */
    }
    assert_int_equal(diags.error_count, 0);
}

static int finish(void **unused)
{
    (void)unused;
    return remove_files((const char *const[]){"wide.txt"}, 1);
}

static void signs_of_a_plot_stand_clear_of_each_other(void **unused)
{
    (void)unused;
    enum { LABELS = 8, ROUNDS = 1000 };
    uint32_t seed = 3;
    printf("seed %u\n", seed);
    for (uint32_t round = 0; round < ROUNDS; round++) {
        vw_label labels[LABELS];
        for (uint32_t i = 0; i < LABELS; i++) {
            seed = fl_lowbias32(seed + 1);
            vw_label wanted = {seed % 40 / 7.0, seed / 64 % 300 / 7.0,
                               1.0 + seed / 65536 % 9 / 7.0};
            labels[i] = wanted;
            vw_board_clear_label(labels, i + 1, 12.0);
            assert_true(labels[i].x == wanted.x && labels[i].width == wanted.width);
            bool was_clear = true;
            for (uint32_t j = 0; j < i; j++) {
                bool is_beside = labels[i].x >= labels[j].x + labels[j].width ||
                                 labels[j].x >= labels[i].x + labels[i].width;
                assert_true(is_beside || fabs(labels[i].y - labels[j].y) > 11.999);
                was_clear &= is_beside || fabs(wanted.y - labels[j].y) > 11.999;
            }
            double moved = labels[i].y - wanted.y;
            assert_true(moved >= 0.0 && (was_clear ? moved < 0.001 : moved > 0.0));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_of_a_plot_stand_clear_of_each_other),
        cmocka_unit_test(a_click_prints_the_rays_of_a_sample),
        cmocka_unit_test(the_inspector_knows_the_pixel),
        cmocka_unit_test(the_meter_says_what_the_scene_needs),
        cmocka_unit_test(the_noise_is_split_and_light_samples_offered),
        cmocka_unit_test(the_trade_curve_shows_where_the_picture_is),
        cmocka_unit_test(the_stress_lens_finds_what_changes),
        cmocka_unit_test(a_stress_that_cannot_be_says_so),
        cmocka_unit_test(nobody_waits_for_measurements),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
