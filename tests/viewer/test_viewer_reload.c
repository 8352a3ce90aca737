/* SPDX-License-Identifier: MIT
 *
 * Scenes and saved pictures that are read again while they are looked at: what the user changed
 * stays, what the file changed comes, undo mixes the two up nowhere.
 */
#include "viewer_kit.h"

static void write_scene(uint32_t lights, const char *color, const char *center, char out_path[256])
{
    char text[8192];
    int bytes = snprintf(text, sizeof text,
                         "firstlight 1\nPerspectiveCamera { center %s direction 0 0 -1 up 0 1 0\n"
                         "angle 40 width 32 height 24 aperture 0.1 focus 5 }\n"
                         "Lights { numLights %u\n",
                         center, lights);
    for (uint32_t i = 0; i < lights; i++)
        bytes += snprintf(text + bytes, sizeof text - (size_t)bytes,
                          "PointLight { position %u 4 4 color %s }\n", i, color);
    snprintf(text + bytes, sizeof text - (size_t)bytes,
             "}\nMaterials { numMaterials 1 Material { diffuseColor 1 1 1 } }\n"
             "Group { numObjects 1 MaterialIndex 0 Sphere { center 0 0 0 radius 1 } }\n");
    write_file("live.txt", text, out_path);
}

static void read_again(vw_session *session)
{
    fl_diags diags = {0};
    if (!vw_session_reload(session, &diags) || !vw_session_restart(session, &diags))
        fail_msg("%s", diags.items[0].message);
}

static void undo(vw_session *session, uint64_t ms)
{
    fl_diags diags = {0};
    tap(session, GLFW_KEY_Z, GLFW_MOD_CONTROL, ms);
    if (!vw_session_restart(session, &diags))
        fail_msg("%s", diags.items[0].message);
}

static void undo_takes_back_nothing_of_the_file(void **unused)
{
    (void)unused;
    char path[256];
    vw_options options = viewer_test_options();
    vw_session session;
    write_scene(1, "1 1 1", "0 0 5", path);
    open_session(&session, &options, path);
    tap(&session, GLFW_KEY_O, 0, 1000);
    tap(&session, GLFW_KEY_O, 0, 3000);
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 5000);
    write_scene(1, "0.2 0.4 0.8", "0 0 5", path);
    read_again(&session);
    tap(&session, GLFW_KEY_Y, GLFW_MOD_CONTROL, 6000);
    assert_true(session.state.look.camera.aperture == 0.1);
    assert_true(session.state.look.lights[0].color.z == 0.8);
    undo(&session, 7000);
    assert_true(session.state.look.camera.aperture == 0.0);
    undo(&session, 8000);
    assert_true(session.state.look.camera.aperture == 0.1);
    assert_true(session.state.look.lights[0].color.z == 0.8);
    assert_true(vw_look_is_same(&session.state.look, &session.state.start));
    vw_session_close(&session);
}

/* To other numbers of lights, and to more than can be edited. */
static void lights_may_come_and_go(void **unused)
{
    (void)unused;
    static const uint32_t counts[] = {3, VW_LIGHTS_MAX, VW_LIGHTS_MAX + 4, 2};
    char path[256];
    vw_options options = viewer_test_options();
    vw_session session;
    write_scene(1, "1 1 1", "0 0 5", path);
    open_session(&session, &options, path);
    uint64_t ms = 0;
    for (size_t i = 0; i < FL_COUNT_OF(counts); i++) {
        tap(&session, GLFW_KEY_RIGHT_BRACKET, 0, ms += 1000);
        tap(&session, GLFW_KEY_K, 0, ms += 1000);
        write_scene(counts[i], "1 1 1", "0 0 5", path);
        read_again(&session);
        undo(&session, ms += 1000);
        fl_params params;
        vw_state_params(&session.state, &session.scene.params, &params);
        assert_int_equal(params.light_count, counts[i]);
        bool is_edited = params.lights == session.state.look.lights;
        assert_int_equal(is_edited, counts[i] <= VW_LIGHTS_MAX);
    }
    /* Looks of another scene's lights are never taken. */
    session.state.look.light_count = 1;
    fl_params params;
    vw_state_params(&session.state, &session.scene.params, &params);
    assert_ptr_equal(params.lights, session.scene.params.lights);
    vw_session_close(&session);
}

static void steps_that_became_one_are_one(void **unused)
{
    (void)unused;
    char path[256];
    vw_options options = viewer_test_options();
    vw_session session;
    write_scene(1, "1 1 1", "0 0 5", path);
    open_session(&session, &options, path);
    tap(&session, GLFW_KEY_K, 0, 1000);
    tap(&session, GLFW_KEY_UP, 0, 3000);
    tap(&session, GLFW_KEY_UP, 0, 5000);
    write_scene(2, "1 1 1", "0 0 5", path);
    read_again(&session); /* The lights are the file's: nothing of theirs can be undone. */
    uint32_t depth = session.state.look.depth_limit;
    undo(&session, 7000);
    assert_int_not_equal(session.state.look.depth_limit, depth);
    vw_session_close(&session);
}

static void what_was_orbited_may_be_elsewhere(void **unused)
{
    (void)unused;
    char path[256];
    vw_options options = viewer_test_options();
    vw_session session;
    write_scene(1, "1 1 1", "0 0 5", path);
    open_session(&session, &options, path);
    tap(&session, GLFW_KEY_TAB, 0, 1000);
    write_scene(1, "0.5 1 1", "0 0 5", path);
    read_again(&session);
    assert_int_equal(session.state.mode, VW_MODE_ORBIT); /* Nothing else than a colour. */
    write_scene(1, "1 1 1", "3 0 9", path);
    read_again(&session);
    assert_int_equal(session.state.mode, VW_MODE_FLY);
    assert_true(session.state.look.camera.center.x == 3.0);
    vw_session_close(&session);
}

static void an_opened_picture_stays_where_it_was_taken(void **unused)
{
    (void)unused;
    char scene[256], picture[256];
    fl_diags diags = {0};
    fl_progress progress;
    vw_options options = viewer_test_options();
    vw_session session;
    write_scene(1, "1 1 1", "0 0 5", scene);
    path_in_folder("taken.png", picture);
    open_session(&session, &options, scene);
    tap(&session, GLFW_KEY_D, 0, 1000);
    tap(&session, GLFW_KEY_K, 0, 2000);
    vw_state_resize(&session.state, 40, 20);
    session.exact_samples = 3;
    vw_session_set_limits(&session);
    assert_true(vw_session_restart(&session, &diags));
    assert_true(fl_render_wait(session.render, -1.0));
    float *rgb = vw_session_mean(&session, &progress, &diags);
    assert_true(vw_session_save(&session, picture, rgb, &progress, &diags));
    free(rgb);
    vw_session_close(&session);

    open_session(&session, &options, picture);
    assert_string_equal(session.source_path, picture);
    assert_string_equal(session.scene_path, scene);
    vw_look before = session.state.look;
    write_scene(1, "0.2 1 1", "0 0 5", scene);
    read_again(&session);
    assert_string_equal(session.scene_path, scene);
    assert_true(session.state.look.lights[0].color.x == 0.2);
    before.lights[0] = session.state.look.lights[0];
    before.lit_colors[0] = session.state.look.lit_colors[0];
    assert_true(vw_look_is_same(&before, &session.state.look));
    assert_int_equal(session.state.look.sample_cap, 3);
    fl_params params;
    vw_state_params(&session.state, &session.scene.params, &params);
    assert_int_equal(params.width, 40);
    /* Opened by hand once more it is where it was taken, whatever was done. */
    tap(&session, GLFW_KEY_D, 0, 3000);
    assert_false(vw_look_is_same(&before, &session.state.look));
    assert_true(vw_session_load(&session, picture, &diags));
    assert_true(vw_look_is_same(&before, &session.state.look));
    /* The scene itself is another thing to open: its own camera, and the usual number of samples.
     */
    assert_true(vw_session_load(&session, scene, &diags));
    assert_true(session.state.look.camera.center.x == 0.0);
    assert_int_equal(session.state.look.sample_cap, VW_SAMPLES_DEFAULT);
    vw_session_close(&session);
}

/* Whatever the keys are, and whichever are down. */
static void changed_files_need_no_key(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    vw_event shift = {.kind = VW_EVENT_KEY, .code = GLFW_KEY_LEFT_SHIFT, .action = GLFW_PRESS};
    send(&session, &shift, 10);
    vw_event reload = {.kind = VW_EVENT_RELOAD};
    assert_int_equal(send(&session, &reload, 20), VW_DIRTY_SCENE);
    vw_session_close(&session);
}

static int finish(void **unused)
{
    (void)unused;
    return remove_files((const char *const[]){"live.txt", "taken.png"}, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(undo_takes_back_nothing_of_the_file),
        cmocka_unit_test(lights_may_come_and_go),
        cmocka_unit_test(steps_that_became_one_are_one),
        cmocka_unit_test(what_was_orbited_may_be_elsewhere),
        cmocka_unit_test(an_opened_picture_stays_where_it_was_taken),
        cmocka_unit_test(changed_files_need_no_key),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
