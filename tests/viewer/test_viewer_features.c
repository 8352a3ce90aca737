/* SPDX-License-Identifier: MIT
 *
 * Undo, bookmarks, cameras as text, racking, and pictures that open again.
 */
#include "viewer_kit.h"

#include <math.h>

#include "io/image_file.h"

static void undo_and_redo_walk_the_same_looks(void **unused)
{
    (void)unused;
    static const int keys[] = {GLFW_KEY_RIGHT_BRACKET,
                               GLFW_KEY_PERIOD,
                               GLFW_KEY_L,
                               GLFW_KEY_K,
                               GLFW_KEY_D,
                               GLFW_KEY_B,
                               GLFW_KEY_X,
                               GLFW_KEY_O,
                               GLFW_KEY_TAB};
    enum { STEPS = FL_COUNT_OF(keys) };
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    vw_look looks[STEPS + 1] = {session.state.look};
    uint64_t ms = 0;
    for (size_t i = 0; i < STEPS; i++) {
        tap(&session, keys[i], 0, ms += 1000);
        looks[i + 1] = session.state.look;
        assert_false(i != STEPS - 1 && vw_look_is_same(&looks[i], &looks[i + 1]));
    }
    for (size_t i = STEPS; i-- > 0;) {
        /* Exposure, cap and orbit about what is in focus are no other picture. */
        bool is_other = keys[i] != GLFW_KEY_B && keys[i] != GLFW_KEY_X && keys[i] != GLFW_KEY_TAB;
        vw_dirty dirty = tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, ms += 10);
        assert_int_equal((dirty & VW_DIRTY_CAMERA) != 0, is_other);
        assert_true(vw_look_is_same(&looks[i], &session.state.look));
    }
    assert_int_equal(session.state.mode, VW_MODE_FLY);
    assert_false(tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, ms += 10) & VW_DIRTY_CAMERA);
    for (size_t i = 1; i <= STEPS; i++) {
        tap(&session, GLFW_KEY_Y, GLFW_MOD_CONTROL, ms += 10);
        assert_true(vw_look_is_same(&looks[i], &session.state.look));
    }
    assert_int_equal(session.state.mode, VW_MODE_ORBIT);
    /* A change forgets what was undone. */
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, ms += 10);
    tap(&session, GLFW_KEY_K, 0, ms += 1000);
    assert_false(tap(&session, GLFW_KEY_Y, GLFW_MOD_CONTROL, ms += 10) & VW_DIRTY_CAMERA);
    vw_session_close(&session);
}

static void a_gesture_is_one_step(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, VIEWER_TEST_SCENE);
    vw_look before = session.state.look;
    for (uint64_t i = 0; i < 3 * VW_HISTORY_MAX; i++) {
        vw_event wheel = {.kind = VW_EVENT_SCROLL, .y = 1.0};
        vw_session_answer(&session, vw_input_event(&session.input, &session.state, &wheel, 10 * i),
                          &diags);
    }
    assert_int_equal(session.history.past_count, 1);
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 100000);
    assert_true(vw_look_is_same(&before, &session.state.look));
    /* However many steps, the memory is the same, and the latest are kept. */
    for (uint64_t i = 0; i < 2 * VW_HISTORY_MAX; i++)
        tap(&session, GLFW_KEY_B, i % 40 < 20 ? 0 : GLFW_MOD_SHIFT, 200000 + 1000 * i);
    assert_int_equal(session.history.past_count, VW_HISTORY_MAX);
    vw_session_close(&session);
}

static void flying_and_looking_is_one_step(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    vw_look before = session.state.look;
    vw_event key = {.kind = VW_EVENT_KEY, .code = GLFW_KEY_W, .action = GLFW_PRESS};
    vw_event button = {.kind = VW_EVENT_BUTTON, .action = GLFW_PRESS};
    send(&session, &key, 0);
    send(&session, &button, 0);
    for (uint64_t i = 1; i < 60; i++) {
        vw_event cursor = {.kind = VW_EVENT_CURSOR, .x = (double)i};
        send(&session, &cursor, 20 * i);
        vw_event nothing = {.kind = VW_EVENT_SCALE, .x = 1.0};
        send(&session, &nothing, 20 * i + 10);
    }
    assert_int_equal(session.history.past_count, 1);
    tap(&session, GLFW_KEY_RIGHT_BRACKET, 0, 1210); /* Not motion: a step between two. */
    send(&session, &(vw_event){.kind = VW_EVENT_SCALE, .x = 1.0}, 1230);
    assert_int_equal(session.history.past_count, 3);
    for (uint64_t i = 0; i < 3; i++) {
        key.action = GLFW_RELEASE;
        send(&session, &key, 1235);
        tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 1240 + i);
    }
    assert_true(vw_look_is_same(&before, &session.state.look));
    vw_session_close(&session);
}

static void a_rack_is_one_step(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    vw_state_focus_at(&session.state, 2.0);
    vw_state_focus_at(&session.state, 8.0);
    send(&session, &(vw_event){.kind = VW_EVENT_SCALE, .x = 1.0}, 500);
    tap(&session, GLFW_KEY_G, 0, 1000);
    uint32_t steps = session.history.past_count;
    for (uint64_t ms = 1016; ms < 3200; ms += 16)
        send(&session, &(vw_event){.kind = VW_EVENT_SCALE, .x = 1.0}, ms);
    assert_true(session.state.look.camera.focus == 2.0);
    assert_int_equal(session.history.past_count, steps + 1);
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 4000);
    assert_true(session.state.look.camera.focus == 8.0);
    vw_session_close(&session);
}

/* Samples are thrown away for another picture only (decision 15). */
static void what_is_rendered_is_not_begun_again(void **unused)
{
    (void)unused;
    static const struct {
        int key, mods;
        bool is_other;
    } taps[] = {
        {GLFW_KEY_B, 0, false},
        {GLFW_KEY_Z, GLFW_MOD_CONTROL, false},
        {GLFW_KEY_X, 0, false},
        {GLFW_KEY_R, 0, false},
        {GLFW_KEY_TAB, 0, false},
        {GLFW_KEY_TAB, 0, false},
        {GLFW_KEY_5, GLFW_MOD_CONTROL, false},
        {GLFW_KEY_5, 0, false},
        {GLFW_KEY_RIGHT_BRACKET, 0, true},
        {GLFW_KEY_5, 0, true},
        {GLFW_KEY_RIGHT_BRACKET, 0, true},
        {GLFW_KEY_R, 0, true},
        {GLFW_KEY_R, 0, false},
    };
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, VIEWER_TEST_SCENE);
    session.is_replay = true; /* Bookmarks stay in memory. */
    assert_true(vw_session_restart(&session, &diags));
    for (size_t i = 0; i < FL_COUNT_OF(taps); i++) {
        vw_dirty dirty = tap(&session, taps[i].key, taps[i].mods, 1000 * (i + 1));
        assert_true(dirty != VW_DIRTY_NONE);
        if (((dirty & VW_DIRTY_CAMERA) != 0) != taps[i].is_other)
            fail_msg("input %zu", i);
    }
    /* What could not be had is asked for again. */
    session.state.look.camera.aperture = -1.0;
    assert_false(vw_session_restart(&session, &diags));
    assert_false(vw_session_is_asked(&session));
    fl_diags_deinit(&diags);
    session.state.look = session.state.start;
    assert_true(tap(&session, GLFW_KEY_R, 0, 90000) & VW_DIRTY_CAMERA);
    vw_session_close(&session);
}

static void what_reset_forgets_comes_back(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    tap(&session, GLFW_KEY_RIGHT_BRACKET, 0, 1000);
    double aperture = session.state.look.camera.aperture;
    tap(&session, GLFW_KEY_O, 0, 2000);
    tap(&session, GLFW_KEY_EQUAL, 0, 2500);
    tap(&session, GLFW_KEY_R, 0, 3000);
    assert_true(session.state.speed == 1.0);
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 4000);
    assert_true(session.state.speed == 2.0);
    tap(&session, GLFW_KEY_Y, GLFW_MOD_CONTROL, 5000);
    assert_true(session.state.speed == 1.0);
    /* A speed that was set since is not taken away. */
    tap(&session, GLFW_KEY_MINUS, 0, 6000);
    for (uint64_t i = 0; i < 2; i++)
        tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 7000 + i);
    assert_true(session.state.speed == 0.5);
    tap(&session, GLFW_KEY_Y, GLFW_MOD_CONTROL, 8000);
    tap(&session, GLFW_KEY_O, 0, 9000);
    assert_true(session.state.look.camera.aperture == aperture);
    vw_session_close(&session);
}

static void bookmarks_stay_beside_the_scene(void **unused)
{
    (void)unused;
    char scene[256], views[300];
    static const char text[] =
        "firstlight 1\nPerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 40 }\n"
        "View door { center 1 0 5 direction 0 0 -1 up 0 1 0 angle 30 }\n"
        "View 3 { center 3 0 5 direction 0 0 -1 up 0 1 0 angle 30 }\n";
    write_file("marks.txt", text, scene);
    snprintf(views, sizeof views, "%s.views", scene);
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, scene);
    tap(&session, GLFW_KEY_3, 0, 100);
    assert_true(session.state.look.camera.center.x == 3.0);
    tap(&session, GLFW_KEY_1, 0, 1000);
    assert_true(session.state.look.camera.center.x == 1.0);
    assert_false(tap(&session, GLFW_KEY_9, 0, 2000) & VW_DIRTY_CAMERA);
    session.state.look.camera.center.x = 0.1;
    session.state.look.camera.aperture = 1.0 / 3.0;
    session.state.look.camera.focus = (double)INFINITY;
    session.state.look.camera.blades = 7;
    fl_camera kept = session.state.look.camera;
    tap(&session, GLFW_KEY_9, GLFW_MOD_CONTROL, 3000);
    assert_int_equal(access(views, R_OK), 0);
    vw_session_close(&session);
    open_session(&session, &options, scene);
    tap(&session, GLFW_KEY_9, 0, 100);
    vw_look a = session.state.look, b = a;
    b.camera = kept;
    assert_true(vw_look_is_same(&a, &b));
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 200);
    assert_true(session.state.look.camera.center.x == 0.0);
    vw_session_close(&session);
    /* A file with errors is said, not fatal, and not written over. */
    write_file("marks.txt.views", "firstlight 1\nView 1 { centre 0 }\n", views);
    open_session(&session, &options, scene);
    assert_non_null(strstr(session.error_text, "marks.txt.views:2"));
    fl_diags diags = {0};
    session.state.slot = 2;
    vw_session_answer(&session, VW_DIRTY_STORE, &diags);
    assert_int_equal(diags.error_count, 1);
    fl_diags_deinit(&diags);
    vw_session_close(&session);
    /* A replay writes nothing. */
    unlink(views);
    open_session(&session, &options, scene);
    session.is_replay = true;
    tap(&session, GLFW_KEY_2, GLFW_MOD_CONTROL, 100);
    assert_int_not_equal(access(views, F_OK), 0);
    vw_session_close(&session);
}

static char *read_whole(const char *path)
{
    fl_diags diags = {0};
    size_t bytes;
    char *text = fl_file_load(path, "file", 1 << 20, (fl_loc){0}, &diags, &bytes);
    assert_non_null(text);
    return text;
}

/* What a hand, or another window, has put into the file stays there, byte for byte. */
static void storing_a_bookmark_replaces_that_alone(void **unused)
{
    (void)unused;
    static const char before[] = "firstlight 1\n"
                                 "# mine # View 2 { is not one } # lights 2 nor these\n"
                                 "View door{center 1 0 5 direction 0 0 -1 up 0 1 0 angle 30}",
                      second[] = " View 2\n{ # {\n  center 2 0 5 direction 0 0 -1 up 0 1 0\n"
                                 "  angle 30 }",
                      lights[] = "# lights 2 nothing\n", after[] = " # behind\n",
                      other[] = "View 7 { center 7 0 5 direction 0 0 -1 up 0 1 0 angle 30 }";
    char scene[256], views[256], text[2048];
    write_file("marks.txt",
               "firstlight 1\nPerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 40 "
               "}\n",
               scene);
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, scene);
    /* Written while the window is open. */
    snprintf(text, sizeof text, "%s%s%s%s%s", before, second, after, lights, other);
    write_file("marks.txt.views", text, views);
    session.state.look.camera.center.x = 22.0;
    tap(&session, GLFW_KEY_2, GLFW_MOD_CONTROL, 100);
    session.state.look.camera.center.x = 33.0;
    tap(&session, GLFW_KEY_3, GLFW_MOD_CONTROL, 200);
    char *now = read_whole(views);
    assert_memory_equal(now, before, strlen(before));
    assert_memory_equal(now + strlen(before), " View 2 {\n    center 22 ", 24);
    assert_null(strstr(now + strlen(before), "lights"));
    char *rest = strstr(now, "}\n # behind\nView 7 {");
    assert_non_null(rest);
    rest = strstr(rest, other);
    assert_memory_equal(rest + strlen(other), "\nView 3 {\n    center 33 ", 24);
    assert_null(strstr(rest + strlen(other) + 2, "View"));
    /* The other window's is there as well. */
    tap(&session, GLFW_KEY_7, 0, 300);
    assert_true(session.state.look.camera.center.x == 7.0);
    /* The same again: the same bytes; with lights: their line, once. */
    session.state.look.camera.center.x = 33.0;
    session.state.look.camera.fov_deg = 40.0;
    tap(&session, GLFW_KEY_3, GLFW_MOD_CONTROL, 400);
    char *again = read_whole(views);
    assert_string_equal(now, again);
    free(now);
    free(again);
    fl_diags diags = {0};
    fl_camera camera = session.state.look.camera;
    for (int i = 0; i < 2; i++)
        assert_true(vw_bookmarks_store(&session.bookmarks, 2, &camera, "0 1 2", scene, &diags));
    now = read_whole(views);
    rest = strstr(now, "}\n# lights 2 0 1 2\n # behind\n");
    assert_non_null(rest);
    assert_null(strstr(rest + 5, "lights"));
    free(now);
    /* A broken file is left alone; once it is mended, what was stored meanwhile comes too. */
    write_file("marks.txt.views", "firstlight 1\nView 1 { centre 0 }\n", views);
    camera.center.x = 5.0;
    assert_false(vw_bookmarks_store(&session.bookmarks, 5, &camera, "", scene, &diags));
    fl_diags_deinit(&diags);
    write_file("marks.txt.views", before, views);
    assert_true(vw_bookmarks_store(&session.bookmarks, 6, &camera, "", scene, &diags));
    now = read_whole(views);
    assert_non_null(strstr(now, "View 5 {\n    center 5 "));
    assert_non_null(strstr(now, "View 6 {\n    center 5 "));
    assert_null(strstr(now, "View 2 {\n"));
    assert_null(vw_bookmarks_find(&session.bookmarks, 2));
    free(now);
    unlink(views);
    vw_session_close(&session);
}

static void views_of_a_reloaded_scene_are_the_new_ones(void **unused)
{
    (void)unused;
    static const char text[] =
        "firstlight 1\nPerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 40 }\n"
        "View %d { center %d 0 5 direction 0 0 -1 up 0 1 0 angle 30 }\n";
    char scene[256], now[512];
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    for (int i = 3; i <= 4; i++) {
        snprintf(now, sizeof now, text, i, i);
        write_file("marks.txt", now, scene);
        if (i == 3)
            open_session(&session, &options, scene);
        else
            assert_true(vw_session_load(&session, scene, &diags));
        if (i == 3)
            assert_true(vw_bookmarks_store(&session.bookmarks, 1, &session.state.look.camera, "",
                                           NULL, &diags));
        assert_true(vw_bookmarks_find(&session.bookmarks, (uint32_t)i)->center.x == i);
        assert_null(vw_bookmarks_find(&session.bookmarks, (uint32_t)(7 - i)));
        assert_non_null(vw_bookmarks_find(&session.bookmarks, 1)); /* Stored, not the scene's. */
    }
    vw_session_close(&session);
}

static void a_pin_that_is_not_seen_is_explained(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    vw_state *state = &session.state;
    tap(&session, GLFW_KEY_SPACE, 0, 10);
    assert_string_equal(vw_state_message(state), "pin a picture first (V)");
    tap(&session, GLFW_KEY_V, GLFW_MOD_SHIFT, 5000);
    assert_string_equal(vw_state_message(state), "pin a picture first (V)");
    session.show.pin.rgb = calloc(12, sizeof(float));
    session.show.pin.rgba = calloc(4, 4);
    session.show.pin.width = session.show.pin.height = 2;
    session.progress.width = 3;
    session.progress.height = 4;
    tap(&session, GLFW_KEY_SPACE, 0, 10000);
    assert_string_equal(vw_state_message(state),
                        "pinned: 2 \303\227 2 pixels; this picture: 3 \303\227 4");
    session.progress.width = session.progress.height = 2;
    tap(&session, GLFW_KEY_SPACE, 0, 20000);
    assert_null(vw_state_message(state));
    vw_session_close(&session);
}

static void cameras_read_back_from_both_texts(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    uint32_t seed = 5;
    printf("seed %u\n", seed);
    for (int round = 0; round < 200; round++) {
        double v[12];
        for (int i = 0; i < 12; i++)
            v[i] = ldexp((double)(seed = fl_lowbias32(seed + 1)) - 2e9, -30);
        fl_camera *camera = &session.state.look.camera, blank = {0};
        camera->center = fl_v3(v[0], v[1], v[2]);
        camera->direction = fl_v3(v[3], v[4], v[5] - 4.0);
        camera->up = fl_v3(v[6] / 9.0, 1.0, v[8] / 9.0);
        camera->fov_deg = 20.0 + v[9];
        camera->aperture = fabs(v[10]);
        camera->focus = round % 3 ? 5.0 + v[11] : (double)INFINITY;
        camera->blades = round % 2 ? 6 : 0;
        vw_look want = session.state.look, got = want;
        char text[2 * FL_STATE_TEXT_MAX];
        size_t length = vw_session_copy(&session, text, sizeof text);
        assert_true(length < sizeof text);
        got.camera = blank;
        assert_true(fl_camera_read_text(text, length, &got.camera));
        got.camera.width = want.camera.width;
        got.camera.height = want.camera.height;
        got.camera.ortho_size = want.camera.ortho_size;
        assert_true(vw_look_is_same(&want, &got));
        length = fl_camera_options_text(camera, text, sizeof text);
        got.camera.center.x = got.camera.aperture = got.camera.focus = 77.0;
        assert_true(fl_camera_read_text(text, length, &got.camera));
        assert_true(got.camera.center.x == camera->center.x);
        assert_true(got.camera.aperture == camera->aperture && got.camera.focus == camera->focus);
        fl_vec3 off = fl_v3_sub(got.camera.direction, camera->direction);
        assert_true(fl_v3_length(off) < 1e-14 * 8.0);
    }
    static const char *const wrong[] = {"",
                                        "nothing",
                                        "--camera '1 2 3'",
                                        "View",
                                        "firstlight 1",
                                        "--camera '0 0 0 0 0 0 0 1 0 40'",
                                        "\xff\xff{{{{",
                                        "--camera '0 0 0  0 0 1  0 1 0  400'"};
    vw_look before = session.state.look;
    vw_history_begin(&session.history, &session.state, true);
    for (size_t i = 0; i < FL_COUNT_OF(wrong); i++) {
        assert_false(vw_session_paste(&session, wrong[i]) & VW_DIRTY_CAMERA);
        assert_true(vw_look_is_same(&before, &session.state.look));
    }
    assert_true(vw_session_paste(&session, "  --camera '0 0 9  0 0 0  0 1 0  40' --focus inf") &
                VW_DIRTY_CAMERA);
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 10);
    assert_true(vw_look_is_same(&before, &session.state.look));
    vw_session_close(&session);
}

static void racking_arrives_on_time_and_exactly(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    vw_state *state = &session.state;
    tap(&session, GLFW_KEY_G, 0, 10);
    assert_false(vw_input_is_moving(&session.input)); /* Nothing was picked yet. */
    vw_state_focus_at(state, 2.0);
    vw_state_focus_at(state, 8.0);
    tap(&session, GLFW_KEY_G, 0, 1000);
    assert_true(vw_input_is_moving(&session.input));
    double last = 8.0;
    for (uint64_t ms = 1001; ms < 2990; ms += 13) {
        vw_input_advance(&session.input, state, ms);
        assert_true(state->look.camera.focus <= last && state->look.camera.focus > 2.0);
        last = state->look.camera.focus;
    }
    vw_input_advance(&session.input, state, 3017);
    assert_true(state->look.camera.focus == 2.0);
    assert_false(vw_input_is_moving(&session.input));
    tap(&session, GLFW_KEY_G, 0, 4000);
    vw_input_advance(&session.input, state, 5000);
    assert_true(fabs(state->look.camera.focus - 4.0) < 1e-3); /* Half way, by factors. */
    vw_input_advance(&session.input, state, 60000);
    assert_true(state->look.camera.focus == 8.0);
    vw_session_close(&session);
}

/* Render the session's state to exactly that many samples and save it. */
static void save_state(vw_session *session, uint32_t samples, const char *path,
                       char out_sha256[FL_SHA256_HEX + 1])
{
    fl_diags diags = {0};
    session->exact_samples = samples;
    vw_session_set_limits(session);
    assert_true(vw_session_restart(session, &diags));
    assert_true(fl_render_wait(session->render, -1.0));
    fl_progress progress;
    float *rgb = vw_session_mean(session, &progress, &diags);
    assert_non_null(rgb);
    fl_digest_sha256(rgb, (size_t)progress.width * progress.height * 12, out_sha256);
    if (!vw_session_save(session, path, rgb, &progress, &diags))
        fail_msg("%s", diags.items[0].message);
    free(rgb);
}

static void a_saved_picture_opens_where_it_was(void **unused)
{
    (void)unused;
    static const char *const names[] = {"state.png", "state.exr"};
    vw_options options = viewer_test_options();
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        vw_session session, again;
        char path[256], copy[256], first[FL_SHA256_HEX + 1], second[FL_SHA256_HEX + 1];
        path_in_folder(names[i], path);
        path_in_folder(i ? "again.exr" : "again.png", copy);
        open_session(&session, &options, VIEWER_TEST_SCENE);
        static const int keys[] = {GLFW_KEY_D,     GLFW_KEY_E, GLFW_KEY_RIGHT_BRACKET,
                                   GLFW_KEY_COMMA, GLFW_KEY_L, GLFW_KEY_K,
                                   GLFW_KEY_B};
        for (size_t k = 0; k < FL_COUNT_OF(keys); k++)
            tap(&session, keys[k], 0, 1000 * k);
        vw_state_resize(&session.state, 77, 51);
        save_state(&session, 3, path, first);
        open_session(&again, &options, path);
        assert_string_equal(again.scene_path, VIEWER_TEST_SCENE);
        assert_int_equal(again.state.look.sample_cap, 3);
        vw_look look = again.state.look;
        look.sample_cap = session.state.look.sample_cap;
        assert_true(vw_look_is_same(&look, &session.state.look));
        save_state(&again, again.state.look.sample_cap, copy, second);
        assert_string_equal(first, second);
        vw_session_close(&again);
        /* Dropped on a window that shows something else, of another size. */
        open_session(&again, &options, VIEWER_TEST_SCENE);
        vw_state_resize(&again.state, 200, 200);
        fl_diags diags = {0};
        assert_true(vw_session_load(&again, path, &diags));
        assert_int_equal(again.state.width, 200);
        save_state(&again, again.state.look.sample_cap, copy, second);
        assert_string_equal(first, second);
        vw_session_close(&again);
        vw_session_close(&session);
    }
}

static void other_pictures_are_refused(void **unused)
{
    (void)unused;
    char path[256];
    path_in_folder("plain.png", path);
    uint8_t pixel[3] = {1, 2, 3};
    fl_image image = {.width = 1, .height = 1, .format = FL_PIXEL_SRGB8, .pixels = pixel};
    fl_diags diags = {0};
    fl_saved_state state;
    assert_true(fl_image_save(path, &image, NULL, 0, &diags));
    assert_false(fl_saved_state_load(path, &state, &diags));
    assert_non_null(strstr(diags.items[0].message, "does not say how it was made"));
    fl_saved_state_deinit(&state);
    fl_diags_deinit(&diags);
    const fl_image_text texts[] = {{"firstlight:scene", "nowhere.txt"},
                                   {"firstlight:view", "View a { }"},
                                   {"firstlight:settings", "size -1 x"},
                                   {"firstlight:samples", "3"}};
    assert_true(fl_image_save(path, &image, texts, FL_COUNT_OF(texts), &diags));
    assert_false(fl_saved_state_load(path, &state, &diags));
    assert_non_null(strstr(diags.items[0].message, "damaged"));
    fl_saved_state_deinit(&state);
    fl_diags_deinit(&diags);
    assert_false(fl_saved_state_is_for("scene.txt"));
    assert_true(fl_saved_state_is_for("a/b.EXR"));
}

static int remove_folder(void **unused)
{
    (void)unused;
    static const char *const names[] = {"marks.txt", "marks.txt.views", "state.png", "state.exr",
                                        "again.png", "again.exr",       "plain.png"};
    return remove_files(names, FL_COUNT_OF(names));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(undo_and_redo_walk_the_same_looks),
        cmocka_unit_test(a_gesture_is_one_step),
        cmocka_unit_test(flying_and_looking_is_one_step),
        cmocka_unit_test(a_rack_is_one_step),
        cmocka_unit_test(what_is_rendered_is_not_begun_again),
        cmocka_unit_test(what_reset_forgets_comes_back),
        cmocka_unit_test(bookmarks_stay_beside_the_scene),
        cmocka_unit_test(storing_a_bookmark_replaces_that_alone),
        cmocka_unit_test(views_of_a_reloaded_scene_are_the_new_ones),
        cmocka_unit_test(a_pin_that_is_not_seen_is_explained),
        cmocka_unit_test(cameras_read_back_from_both_texts),
        cmocka_unit_test(racking_arrives_on_time_and_exactly),
        cmocka_unit_test(a_saved_picture_opens_where_it_was),
        cmocka_unit_test(other_pictures_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
