/* SPDX-License-Identifier: MIT
 *
 * A region is rendered alone: the same bytes as in the whole, shown where it belongs, saved as what
 * it is.
 */
#include "viewer_kit.h"

static void drag(vw_session *session, double x0, double y0, double x1, double y1, uint64_t ms)
{
    vw_event events[] = {
        {.kind = VW_EVENT_KEY, .code = GLFW_KEY_Z, .action = GLFW_PRESS},
        {.kind = VW_EVENT_CURSOR, .x = x0, .y = y0},
        {.kind = VW_EVENT_BUTTON, .code = GLFW_MOUSE_BUTTON_LEFT, .action = GLFW_PRESS},
        {.kind = VW_EVENT_CURSOR, .x = x1, .y = y1},
        {.kind = VW_EVENT_BUTTON, .code = GLFW_MOUSE_BUTTON_LEFT, .action = GLFW_RELEASE},
        {.kind = VW_EVENT_KEY, .code = GLFW_KEY_Z, .action = GLFW_RELEASE},
    };
    for (size_t i = 0; i < FL_COUNT_OF(events); i++)
        send(session, &events[i], ms + i);
}

static float *film_of(vw_session *session, uint32_t samples, fl_progress *out_progress)
{
    fl_diags diags = {0};
    session->exact_samples = samples;
    vw_session_set_limits(session);
    assert_true(vw_session_restart(session, &diags));
    assert_true(fl_render_wait(session->render, -1.0));
    float *rgb = vw_session_mean(session, out_progress, &diags);
    assert_non_null(rgb);
    return rgb;
}

static void a_region_is_part_of_the_whole(void **unused)
{
    (void)unused;
    char picture[256];
    path_in_folder("region.png", picture);
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    fl_progress progress;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    float *whole = film_of(&session, 3, &progress);
    assert_int_equal(progress.width, 96);
    assert_true(vw_session_refresh(&session, &diags));
    vw_look before = session.state.look;
    drag(&session, 70, 50, 40.5, 19.5, 100); /* From any corner; pixels that are touched count. */
    static const uint32_t want[4] = {40, 19, 30, 31};
    assert_memory_equal(session.state.look.region, want, sizeof want);
    assert_true(session.state.look.camera.direction.x == before.camera.direction.x);
    float *part = film_of(&session, 3, &progress);
    assert_int_equal(progress.width, 30);
    assert_int_equal(progress.height, 31);
    for (uint32_t y = 0; y < 31; y++)
        assert_memory_equal(part + 3 * 30 * y, whole + 3 * (96 * (19 + y) + 40), 12 * 30);
    /* In the window it lies in the picture, which is dimmed. */
    assert_true(vw_session_refresh(&session, &diags));
    uint32_t width, height;
    const uint8_t *window = vw_session_window(&session, &width, &height);
    assert_int_equal(width, 96);
    assert_int_equal(height, 64);
    assert_memory_equal(window + 4 * (96 * 19 + 40), vw_session_shown(&session), 4 * 30);
    assert_true(window[4 * (96 * 60 + 5)] < 86);
    /* Picks are of the window's picture, with a region as without. */
    for (int i = 0; i < 2; i++) {
        session.state.pick_x = 36.0;
        session.state.pick_y = 40.0;
        session.state.look.camera.focus = 1.0;
        vw_session_pick(&session, &diags);
        static double focus;
        assert_true(i == 0 || session.state.look.camera.focus == focus);
        focus = session.state.look.camera.focus;
        if (i == 0)
            drag(&session, 1, 1, 2, 2, 1000); /* A tap: all of it again. */
        assert_int_equal(session.state.look.region[2], 0);
        if (i == 0)
            session.state.look.camera.focus = before.camera.focus;
    }
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 4000);
    assert_memory_equal(session.state.look.region, want, sizeof want);
    session.state.look.camera = before.camera;
    free(part);
    part = film_of(&session, 3, &progress);
    assert_true(vw_session_save(&session, picture, part, &progress, &diags));
    vw_session_close(&session);
    /* The saved picture is the region, and opens as it. */
    open_session(&session, &options, picture);
    free(whole);
    whole = film_of(&session, 3, &progress);
    assert_int_equal(progress.width, 30);
    assert_memory_equal(whole, part, (size_t)12 * 30 * 31);
    free(whole);
    free(part);
    vw_session_close(&session);
}

static void after_another_region_the_first_is_dimmed_too(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    fl_progress progress;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    free(film_of(&session, 1, &progress));
    assert_true(vw_session_refresh(&session, &diags));
    static const double corners[2][4] = {{10, 10, 30, 30}, {50, 20, 80, 50}};
    for (int i = 0; i < 2; i++) {
        const double *c = corners[i];
        drag(&session, c[0], c[1], c[2], c[3], 100 + 100 * (uint64_t)i);
        free(film_of(&session, 1, &progress));
        assert_true(vw_session_refresh(&session, &diags));
        uint32_t width, height;
        const uint8_t *window = vw_session_window(&session, &width, &height);
        assert_int_equal(width, 96);
        for (uint32_t y = 0; y < 64; y++)
            for (uint32_t x = 0; x < 96; x++) {
                bool is_inside = x >= c[0] && x <= c[2] && y >= c[1] && y <= c[3];
                const uint8_t *pixel = window + 4 * (96 * y + x);
                assert_true(is_inside || (pixel[0] < 86 && pixel[1] < 86 && pixel[2] < 86));
                assert_int_equal(pixel[3], 255);
            }
    }
    vw_session_close(&session);
}

static void a_region_survives_any_window(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    fl_progress progress;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    drag(&session, 60, 30, 500, 500, 100);
    static const uint32_t sizes[][2] = {{80, 40}, {20, 20}, {96, 64}, {300, 200}};
    static const uint32_t parts[][2] = {{20, 10}, {20, 20}, {36, 34}, {36, 34}};
    for (size_t i = 0; i < FL_COUNT_OF(sizes); i++) {
        vw_event resize = {.kind = VW_EVENT_RESIZE, .width = sizes[i][0], .height = sizes[i][1]};
        send(&session, &resize, 200 + i);
        free(film_of(&session, 1, &progress));
        assert_int_equal(progress.width, parts[i][0]);
        assert_int_equal(progress.height, parts[i][1]);
        assert_true(vw_session_refresh(&session, &diags));
        uint32_t width, height;
        assert_non_null(vw_session_window(&session, &width, &height));
        assert_int_equal(width, sizes[i][0]);
        assert_int_equal(height, sizes[i][1]);
    }
    vw_session_close(&session);
}

static int finish(void **unused)
{
    (void)unused;
    return remove_files((const char *const[]){"region.png"}, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_region_is_part_of_the_whole),
        cmocka_unit_test(after_another_region_the_first_is_dimmed_too),
        cmocka_unit_test(a_region_survives_any_window),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
