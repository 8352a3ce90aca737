/* SPDX-License-Identifier: MIT
 *
 * Whole sessions from logs, on the real render: a snapshot's bytes depend on the log alone, not on
 * how often it runs, on threads or on what was looked at before; wrong files end in a message.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "viewer/session.h"
#include "viewer_loader.h"

static char folder[] = "firstlight-replay-XXXXXX";

static void path_in_folder(const char *name, char out[256])
{
    snprintf(out, 256, "%s/%s", folder, name);
}

static void write_log(const char *lines)
{
    char path[256];
    path_in_folder("a.log", path);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "firstlight-log 1 96x64 %s\n", VIEWER_TEST_SCENE);
    /* %s in the lines stands for the folder. */
    for (const char *c = lines; *c; c++) {
        if (*c == '%')
            fputs(folder, file);
        else
            fputc(*c, file);
    }
    fclose(file);
}

/* Replay; the report's snapshots are compared by the caller. */
static bool replay(bool is_measuring, uint32_t threads, vw_replay_report *report, fl_diags *diags)
{
    char path[256];
    path_in_folder("a.log", path);
    vw_options options = viewer_test_options();
    options.thread_count = threads;
    return vw_replay_run(&options, path, is_measuring, report, diags);
}

static void replay_well(bool is_measuring, uint32_t threads, vw_replay_report *report)
{
    fl_diags diags = {0};
    if (!replay(is_measuring, threads, report, &diags))
        fail_msg("%s", diags.count ? diags.items[0].message : "no message");
    assert_int_equal(diags.error_count, 0);
    fl_diags_deinit(&diags);
}

static const char *const session_lines =
    "10 key W press\n200 key W release\n210 button LEFT press\n220 cursor 10 5\n230 cursor 20 -4\n"
    "240 button LEFT release\n250 scroll 0 2\n260 key RIGHT_BRACKET press\n260 key RIGHT_BRACKET "
    "release\n"
    "300 cursor 30 40\n301 button LEFT press SHIFT\n302 button LEFT release\n310 resize 80 50\n"
    "320 key B press\n320 key B release\n400 snapshot %/one.png 3\n410 snapshot %/two.exr 5\n"
    "420 snapshot %/three.png 3\n430 key L press\n440 snapshot %/four.png 2\n500 quit\n600 "
    "snapshot %/never.png 1\n";

static void replays_give_the_same_bytes(void **unused)
{
    (void)unused;
    vw_replay_report first, again;
    write_log(session_lines);
    replay_well(false, 1, &first);
    assert_int_equal(first.snapshot_count, 4);
    static const struct {
        bool is_measuring;
        uint32_t threads;
    } ways[] = {{false, 1}, {false, 3}, {true, 2}};
    for (size_t w = 0; w < FL_COUNT_OF(ways); w++) {
        replay_well(ways[w].is_measuring, ways[w].threads, &again);
        assert_int_equal(again.snapshot_count, first.snapshot_count);
        assert_int_equal(again.input_count, first.input_count);
        for (size_t i = 0; i < first.snapshot_count; i++)
            assert_string_equal(again.snapshots[i].film_sha256, first.snapshots[i].film_sha256);
        if (ways[w].is_measuring)
            assert_true(again.first.p50 > 0.0 && again.first.p50 <= again.first.p99 &&
                        again.full.p99 >= again.first.p50);
        vw_replay_report_deinit(&again);
    }
    /* Three samples are three samples, before or after five. */
    assert_string_equal(first.snapshots[0].film_sha256, first.snapshots[2].film_sha256);
    assert_string_not_equal(first.snapshots[0].film_sha256, first.snapshots[1].film_sha256);
    char path[256];
    path_in_folder("three.png", path);
    assert_int_equal(access(path, R_OK), 0);
    path_in_folder("never.png", path);
    assert_int_not_equal(access(path, F_OK), 0);
    vw_replay_report_deinit(&first);
}

static void history_leaves_no_trace(void **unused)
{
    (void)unused;
    vw_replay_report moved, still;
    write_log("1 key D press\n300 key D release\n310 key O press\n320 key K press\n330 key P "
              "press\n340 key TAB press\n"
              "350 resize 70 70\n360 resize 96 64\n370 key R press\n400 snapshot %/moved.exr 4\n");
    replay_well(true, 2, &moved);
    write_log("400 snapshot %/still.exr 4\n");
    replay_well(false, 2, &still);
    assert_string_equal(moved.snapshots[0].film_sha256, still.snapshots[0].film_sha256);
    vw_replay_report_deinit(&moved);
    vw_replay_report_deinit(&still);
}

static bool load_adaptive(void *context, const char *path, vw_scene *out, fl_diags *diags)
{
    bool is_loaded = viewer_test_load(context, path, out, diags);
    out->params.is_adaptive = true;
    return is_loaded;
}

/* A snapshot on the way changes nothing of a later one, wherever the samples went till then. */
static void uneven_samples_leave_no_trace_either(void **unused)
{
    (void)unused;
    vw_replay_report reports[2];
    vw_options options = viewer_test_options();
    options.loader.load = load_adaptive;
    for (int i = 0; i < 2; i++) {
        char path[256];
        fl_diags diags = {0};
        path_in_folder("a.log", path);
        write_log(i ? "1 snapshot %/still.exr 48\n"
                    : "1 snapshot %/moved.exr 20\n2 snapshot %/still.exr 48\n");
        assert_true(vw_replay_run(&options, path, false, &reports[i], &diags));
    }
    assert_int_equal(reports[0].snapshots[0].samples, 20);
    assert_int_equal(reports[0].snapshots[1].samples, 48);
    assert_string_equal(reports[0].snapshots[1].film_sha256, reports[1].snapshots[0].film_sha256);
    for (int i = 0; i < 2; i++)
        vw_replay_report_deinit(&reports[i]);
}

static void expect_failure(const char *lines, const char *message)
{
    vw_replay_report report;
    fl_diags diags = {0};
    write_log(lines);
    assert_false(replay(false, 1, &report, &diags));
    assert_true(diags.error_count > 0);
    if (!strstr(diags.items[0].message, message))
        fail_msg("expected '%s', got '%s'", message, diags.items[0].message);
    vw_replay_report_deinit(&report);
    fl_diags_deinit(&diags);
}

static void failures_are_said(void **unused)
{
    (void)unused;
    expect_failure("1 kei W press\n", "did you mean 'key'?");
    expect_failure("1 drop %/none.txt\n", "none.txt");
    expect_failure("1 snapshot %/none/a.png 1\n", "none/a.png");
    expect_failure("1 snapshot %/a.unknown 1\n", "a.unknown");
}

static bool interrupted_at_once(void)
{
    return true;
}

static void quitting_in_the_middle_is_clean(void **unused)
{
    (void)unused;
    fl_diags diags = {0};
    vw_options options = viewer_test_options();
    for (int i = 0; i < 20; i++) {
        vw_session session;
        assert_true(vw_session_open(&session, &options, VIEWER_TEST_SCENE, 0, 0, &diags));
        assert_true(vw_session_start(&session, NULL, NULL, &diags));
        assert_true(vw_session_restart(&session, &diags));
        for (int refresh = 0; refresh < i; refresh++)
            vw_session_refresh(&session, &diags);
        vw_session_close(&session);
    }
    options.was_interrupted = interrupted_at_once;
    char path[256];
    path_in_folder("a.log", path);
    write_log("1 key W press\n100000 quit\n");
    vw_replay_report report;
    assert_false(vw_replay_run(&options, path, true, &report, &diags));
    assert_int_equal(diags.error_count, 0);
    vw_replay_report_deinit(&report);
}

static void a_thousand_restarts_end_in_the_same_film(void **unused)
{
    (void)unused;
    fl_diags diags = {0};
    vw_options options = viewer_test_options();
    vw_session session;
    assert_true(vw_session_open(&session, &options, VIEWER_TEST_SCENE, 0, 0, &diags));
    assert_true(vw_session_start(&session, NULL, NULL, &diags));
    char hex[2][FL_SHA256_HEX + 1];
    for (int round = 0; round < 2; round++) {
        fl_camera camera = session.state.look.camera;
        for (int i = 0; round > 0 && i < 1000; i++) {
            session.state.look.camera.center.x = 0.001 * i;
            assert_true(vw_session_restart(&session, &diags));
            vw_session_refresh(&session, &diags);
        }
        session.state.look.camera = camera;
        session.exact_samples = 2;
        vw_session_set_limits(&session);
        assert_true(vw_session_restart(&session, &diags));
        assert_true(fl_render_wait(session.render, -1.0));
        fl_progress progress;
        float *rgb = vw_session_mean(&session, &progress, &diags);
        assert_int_equal(progress.complete_samples, 2);
        fl_digest_sha256(rgb, (size_t)progress.width * progress.height * 12, hex[round]);
        free(rgb);
    }
    assert_string_equal(hex[0], hex[1]);
    vw_session_close(&session);
}

static void a_broken_scene_keeps_the_good_one(void **unused)
{
    (void)unused;
    fl_diags diags = {0};
    vw_options options = viewer_test_options();
    vw_session session;
    assert_true(vw_session_open(&session, &options, VIEWER_TEST_SCENE, 0, 0, &diags));
    assert_true(vw_session_start(&session, NULL, NULL, &diags));
    const fl_compiled *before = session.scene.compiled;
    char path[256];
    path_in_folder("broken.txt", path);
    FILE *file = fopen(path, "w");
    fputs("firstlight 1\nPerspectiveCamera { centre 0 0 5 }\n", file);
    fclose(file);
    assert_false(vw_session_load(&session, path, &diags));
    assert_ptr_equal(session.scene.compiled, before);
    assert_string_equal(session.scene_path, VIEWER_TEST_SCENE);
    vw_session_take_error(&session, &diags);
    assert_non_null(strstr(session.error_text, "broken.txt:2:21: error:"));
    assert_true(session.state.has_error);
    session.state.has_error = false; /* As Esc does. */
    vw_session_answer(&session, VW_DIRTY_WINDOW, &diags);
    assert_null(session.error_text);
    session.state.look.camera.center.x = 3.0;
    assert_true(vw_session_load(&session, VIEWER_TEST_SCENE, &diags));
    assert_true(session.state.look.camera.center.x == 3.0);
    assert_true(session.state.start.camera.center.x == 0.0);
    vw_session_close(&session);
}

static void picking_finds_the_plane_depth(void **unused)
{
    (void)unused;
    fl_diags diags = {0};
    vw_options options = viewer_test_options();
    vw_session session;
    assert_true(vw_session_open(&session, &options, VIEWER_TEST_SCENE, 0, 0, &diags));
    session.state.pick_x = 48.0;
    session.state.pick_y = 2.0;
    assert_int_equal(vw_session_pick(&session, &diags), VW_DIRTY_WINDOW);
    assert_true(session.state.look.camera.focus == 6.0); /* the sky */
    /* The floor straight below the centre of the picture: on the axis depth is the distance. */
    session.state.pick_x = 48.0;
    session.state.pick_y = 63.0;
    assert_int_equal(vw_session_pick(&session, &diags), VW_DIRTY_CAMERA);
    double focus = session.state.look.camera.focus;
    assert_true(focus > 2.0 && focus < 6.0);
    vw_session_close(&session);
}

static int make_folder(void **unused)
{
    (void)unused;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **unused)
{
    (void)unused;
    static const char *const names[] = {"a.log",    "one.png",   "two.exr",   "three.png",
                                        "four.png", "moved.exr", "still.exr", "broken.txt"};
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        char path[256];
        path_in_folder(names[i], path);
        unlink(path);
    }
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(replays_give_the_same_bytes),
        cmocka_unit_test(history_leaves_no_trace),
        cmocka_unit_test(uneven_samples_leave_no_trace_either),
        cmocka_unit_test(failures_are_said),
        cmocka_unit_test(quitting_in_the_middle_is_clean),
        cmocka_unit_test(a_thousand_restarts_end_in_the_same_film),
        cmocka_unit_test(a_broken_scene_keeps_the_good_one),
        cmocka_unit_test(picking_finds_the_plane_depth),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
