/* SPDX-License-Identifier: MIT
 *
 * Snapshots ordered at any moment: of the state as it was then, with samples that are whole, so
 * that the file is made again to the last byte by opening it.
 */
#include "viewer_kit.h"

#include <math.h>

#include "io/files.h"
#include "viewer/words.h"

static void open_render(vw_session *session, const vw_options *options, const char *path,
                        bool is_adaptive)
{
    fl_diags diags = {0};
    open_session(session, options, path);
    session->scene.params.is_adaptive |= is_adaptive;
    assert_true(vw_session_restart(session, &diags));
}

/* As the window does, which neither restarts nor adopts meanwhile. */
static uint32_t save_ordered(vw_session *session, const char *path)
{
    fl_diags diags = {0};
    fl_progress progress;
    assert_true(fl_render_wait(session->render, -1.0));
    vw_session_refresh(session, &diags);
    assert_true(vw_session_has_ordered(session));
    assert_true(vw_session_save_ordered(session, path, &progress, &diags));
    assert_int_equal(diags.error_count, 0);
    assert_int_equal(session->exact_samples, 0);
    return vw_words_samples(&progress);
}

static void assert_same_files(const char *a, const char *b)
{
    fl_diags diags = {0};
    size_t bytes[2];
    char *texts[2];
    const char *paths[2] = {a, b};
    for (int i = 0; i < 2; i++) {
        texts[i] = fl_file_load(paths[i], "picture", 1 << 24, (fl_loc){0}, &diags, &bytes[i]);
        assert_non_null(texts[i]);
    }
    assert_int_equal(bytes[0], bytes[1]);
    assert_memory_equal(texts[0], texts[1], bytes[0]);
    free(texts[0]);
    free(texts[1]);
}

/* Order one when the mean is about `mean`, move on, save, open the file and save that. */
static void assert_made_again(bool is_adaptive, double mean)
{
    char path[256], again_path[256];
    vw_session session, again;
    path_in_folder("one.png", path);
    path_in_folder("again.png", again_path);
    vw_options options = viewer_test_options();
    options.limits.samples = 1 << 20;
    open_render(&session, &options, VIEWER_TEST_SCENE, is_adaptive);
    do
        fl_render_progress(session.render, &session.progress);
    while (session.progress.mean_samples < mean);
    vw_state before = session.state;
    vw_session_order_snapshot(&session);
    uint32_t ordered = session.exact_samples;
    assert_true((double)ordered >= mean);
    tap(&session, GLFW_KEY_D, 0, 100);
    tap(&session, GLFW_KEY_B, 0, 200);
    assert_int_equal(save_ordered(&session, path), ordered);
    /* It goes on: it was never done. */
    assert_int_equal(session.progress.state, FL_RENDER_RUNNING);
    options.limits.samples = 0;
    open_render(&again, &options, path, false);
    assert_int_equal(again.state.look.sample_cap, ordered);
    vw_look look = again.state.look;
    look.sample_cap = before.look.sample_cap;
    assert_true(vw_look_is_same(&look, &before.look));
    assert_true(fl_render_wait(again.render, -1.0));
    vw_session_order_snapshot(&again);
    assert_int_equal(save_ordered(&again, again_path), ordered);
    assert_same_files(path, again_path);
    vw_session_close(&again);
    vw_session_close(&session);
}

static void what_is_saved_can_be_made_again(void **unused)
{
    (void)unused;
    static const double means[] = {0.0, 0.3, 1.0, 3.7, 9.2};
    for (size_t i = 0; i < FL_COUNT_OF(means); i++)
        assert_made_again(false, means[i]);
}

static void uneven_samples_are_saved_too(void **unused)
{
    (void)unused;
    static const double means[] = {2.5, 16.0, 20.0, 33.0};
    for (size_t i = 0; i < FL_COUNT_OF(means); i++)
        assert_made_again(true, means[i]);
}

/* Whoever moves on does not wait for a round of thousands of samples. */
static void rounds_can_be_cut_short(void **unused)
{
    (void)unused;
    char path[256];
    vw_session session;
    path_in_folder("one.png", path);
    vw_options options = viewer_test_options();
    options.limits.samples = 1 << 20;
    open_render(&session, &options, VIEWER_TEST_SCENE, true);
    do
        fl_render_progress(session.render, &session.progress);
    while (session.progress.mean_samples < 34.0);
    vw_session_order_snapshot(&session);
    uint32_t ordered = session.exact_samples;
    vw_session_hurry_order(&session);
    fl_render_progress(session.render, &session.progress);
    assert_true(session.exact_samples <= fl_min(ordered, ceil(session.progress.mean_samples)));
    uint32_t saved = save_ordered(&session, path);
    assert_true(saved >= 34 && saved <= ordered);
    assert_int_equal(session.progress.state, FL_RENDER_RUNNING);
    vw_session_close(&session);
}

static void samples_are_counted_where_they_are_uneven(void **unused)
{
    (void)unused;
    vw_status status[VW_STATUS_MAX];
    vw_state state = {.look = {.sample_cap = 4096}};
    fl_progress progress = {.complete_samples = 16, .mean_samples = 99.6, .is_adaptive = true};
    vw_words_status(&state, &progress, status);
    assert_string_equal(status[1].value, "100/4096");
    progress.is_adaptive = false;
    vw_words_status(&state, &progress, status);
    assert_string_equal(status[1].value, "16/4096");
}

static int finish(void **unused)
{
    (void)unused;
    return remove_files((const char *const[]){"one.png", "again.png"}, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_saved_can_be_made_again),
        cmocka_unit_test(uneven_samples_are_saved_too),
        cmocka_unit_test(rounds_can_be_cut_short),
        cmocka_unit_test(samples_are_counted_where_they_are_uneven),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
