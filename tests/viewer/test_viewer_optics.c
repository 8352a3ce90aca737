/* SPDX-License-Identifier: MIT
 *
 * Focus through mirrors and glass, sharpness and what stands behind the pixels: against the laws of
 * optics, single picks and the render's own counts. What is shown never touches the film.
 */
#include "viewer_kit.h"

#include <math.h>

#include "viewer/camera.h"

/* The focus that a click through the middle of the picture gives. */
static double focus_through(const char *objects, double aperture, double x_px)
{
    static const char head[] =
        "firstlight 1\nPerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 30\n"
        "  width 100 height 100 aperture %g focus 2 }\n"
        "Lights { numLights 1 PointLight { position 0 4 4 color 1 1 1 } }\n"
        "Materials { numMaterials 3\n"
        "  Material { diffuseColor 0.8 0.8 0.8 }\n"
        "  Material { diffuseColor 0 0 0 reflect 0.9 }\n"
        "  Material { diffuseColor 0 0 0 refract 0.9 refractionIndex 1.5 } }\n%s";
    char text[2048], path[256];
    snprintf(text, sizeof text, head, aperture, objects);
    write_file("optics.txt", text, path);
    vw_options options = viewer_test_options();
    fl_diags diags = {0};
    vw_session session;
    open_session(&session, &options, path);
    session.state.pick_x = x_px;
    session.state.pick_y = 50.0;
    vw_session_pick_through(&session, &diags);
    double focus = session.state.look.camera.focus;
    vw_session_close(&session);
    return focus;
}

#define FAR_WALL "MaterialIndex 0 Square { corner -40 -40 9 u 0 80 0 v 80 0 0 }\n"

static void focus_is_found_in_mirrors_and_glass(void **unused)
{
    (void)unused;
    static const char mirror[] = "Group { numObjects 2\n" FAR_WALL
                                 "MaterialIndex 1 Square { corner -9 -9 0 u 18 0 0 v 0 18 0 } }";
    /* A flat mirror: 5 there and 9 back, for any lens and off the axis too. */
    assert_true(fabs(focus_through(mirror, 0.1, 50.0) - 14.0) < 1e-3);
    assert_true(fabs(focus_through(mirror, 1.0, 50.0) - 14.0) < 1e-3);
    assert_true(fabs(focus_through(mirror, 0.1, 80.0) - 14.0) < 1e-3);
    assert_true(fabs(focus_through(mirror, 0.0, 50.0) - 14.0) < 2e-2);
    /* A mirror ball of radius r: the image of what is s away lies s r / (2 s + r) behind it. */
    static const char ball[] =
        "Group { numObjects 2\n" FAR_WALL "MaterialIndex 1 Sphere { center 0 0 0 radius 1 } }";
    assert_true(fabs(focus_through(ball, 0.01, 50.0) - (4.0 + 8.0 / 17.0)) < 2e-3);
    /* A slab of thickness t brings what is behind it nearer by t (1 - 1 / n). */
    static const char slab[] = "Group { numObjects 3\n"
                               "MaterialIndex 0 Square { corner -20 -20 -5 u 40 0 0 v 0 40 0 }\n"
                               "MaterialIndex 2 Square { corner -9 -9 2 u 18 0 0 v 0 18 0 }\n"
                               "Square { corner -9 -9 0 u 0 18 0 v 18 0 0 } }";
    assert_true(fabs(focus_through(slab, 0.02, 50.0) - (10.0 - 2.0 / 3.0)) < 2e-3);
    /* Neither mirror nor glass: its own depth. Nothing at all: as it was. */
    static const char wall[] = "Group { numObjects 1\n"
                               "MaterialIndex 0 Square { corner -9 -9 0 u 18 0 0 v 0 18 0 } }";
    assert_true(fabs(focus_through(wall, 0.1, 50.0) - 5.0) < 1e-5);
    static const char sky[] = "Group { numObjects 1\n"
                              "MaterialIndex 1 Square { corner -9 -9 0 u 18 0 0 v 0 18 0 } }";
    assert_true(focus_through(sky, 0.1, 50.0) == 2.0);
}

static void limits_of_sharpness_are_where_the_blur_is_a_pixel(void **unused)
{
    (void)unused;
    for (int i = 1; i < 60; i++) {
        fl_camera camera = {.aperture = 0.01 * i, .focus = 0.3 * i, .fov_deg = 2.0 + 2.0 * i};
        double near, far;
        assert_true(vw_sharp_limits(&camera, 640, 1.0, &near, &far));
        assert_true(near > 0.0 && near < camera.focus && far > camera.focus);
        assert_true(fabs(vw_blur_px(&camera, 640, near) + 1.0) < 1e-9);
        assert_true(!isfinite(far) || fabs(vw_blur_px(&camera, 640, far) - 1.0) < 1e-9);
        assert_true(fabs(vw_blur_px(&camera, 640, camera.focus)) < 1e-9);
        /* Decision 10, as it stands there. */
        double z = 1.7 * camera.focus, f_px = 640.0 / (2.0 * tan(camera.fov_deg * VW_PI / 360.0));
        double want = 2.0 * camera.aperture * (z - camera.focus) / (z * camera.focus) * f_px;
        assert_true(fabs(vw_blur_px(&camera, 640, z) / want - 1.0) < 1e-9);
    }
    fl_camera pinhole = {.focus = 1.0, .fov_deg = 40.0};
    double near, far;
    assert_false(vw_sharp_limits(&pinhole, 640, 1.0, &near, &far));
}

static void what_stands_behind_pixels_is_what_a_pick_finds(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, VIEWER_TEST_SCENE);
    fl_frame *frame = fl_frame_create(session.scene.compiled, &session.scene.params, &diags);
    enum { WIDTH = 96, HEIGHT = 64 };
    static float depth[WIDTH * HEIGHT * 3], object[WIDTH * HEIGHT * 3], normal[WIDTH * HEIGHT * 3];
    fl_aov_grid grid = {.step = 1, .width = WIDTH, .height = HEIGHT};
    assert_true(fl_aov_eval(frame, FL_AOV_DEPTH, NULL, &grid, depth));
    assert_true(fl_aov_eval(frame, FL_AOV_OBJECT, NULL, &grid, object));
    assert_true(fl_aov_eval(frame, FL_AOV_NORMAL, NULL, &grid, normal));
    uint32_t hits = 0;
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        fl_pick pick;
        assert_true(fl_trace_pick(frame, i % WIDTH + 0.5, i / WIDTH + 0.5, &pick));
        hits += pick.is_hit;
        if (!pick.is_hit) {
            assert_true(isinf(depth[3 * i]) && object[3 * i] == 0.0f);
            continue;
        }
        assert_true(fabs((double)depth[3 * i] / pick.depth - 1.0) < 1e-5);
        assert_true(object[3 * i] == (float)(pick.object + 1));
        fl_vec3 n = {(double)normal[3 * i], (double)normal[3 * i + 1], (double)normal[3 * i + 2]};
        assert_true(fl_v3_length(fl_v3_sub(n, pick.normal)) < 1e-4);
    }
    assert_true(hits > 1000);
    /* The cost of all pixels is what the render counts for one sample of each. */
    static float cost[WIDTH * HEIGHT * 3];
    assert_true(fl_aov_eval(frame, FL_AOV_COST, NULL, &grid, cost));
    double rays = 0.0;
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        rays += (double)cost[3 * i];
    session.exact_samples = 1;
    vw_session_set_limits(&session);
    assert_true(vw_session_restart(&session, &diags));
    assert_true(fl_render_wait(session.render, -1.0));
    fl_progress progress;
    fl_render_progress(session.render, &progress);
    const fl_counts *c = &progress.counts;
    assert_true(rays ==
                (double)(c->camera_rays + c->shadow_rays + c->reflect_rays + c->refract_rays));
    fl_frame_release(frame);
    vw_session_close(&session);
}

static void views_show_without_touching_the_film(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, VIEWER_TEST_SCENE);
    session.exact_samples = 8;
    vw_session_set_limits(&session);
    assert_true(vw_session_restart(&session, &diags));
    assert_true(fl_render_wait(session.render, -1.0));
    assert_true(vw_session_refresh(&session, &diags));
    size_t bytes = (size_t)96 * 64 * 4;
    uint8_t *plain = malloc(bytes), *before = malloc(bytes);
    memcpy(plain, vw_session_shown(&session), bytes);
    memcpy(before, plain, bytes);
    for (int layer = VW_LAYER_BEAUTY; layer < VW_LAYER_COUNT; layer++) {
        bool is_last = layer == VW_LAYER_BRANCH;
        int key = is_last ? GLFW_KEY_F8 : GLFW_KEY_F2 + layer;
        assert_true(tap(&session, key, is_last ? GLFW_MOD_SHIFT : 0, 10) & VW_DIRTY_SHOW);
        assert_int_equal(session.state.layer, layer);
        vw_session_settle(&session, &diags);
        assert_true(vw_session_refresh(&session, &diags));
        const uint8_t *shown = vw_session_shown(&session);
        assert_int_equal(memcmp(shown, before, bytes) == 0, layer == VW_LAYER_BEAUTY);
        memcpy(before, shown, bytes);
        char notes[512];
        vw_session_notes(&session, notes, sizeof notes);
        assert_int_equal(strlen(notes) > 0, layer != VW_LAYER_BEAUTY);
    }
    tap(&session, GLFW_KEY_F2, 0, 10);
    /* The band, then the rangefinder, then nothing. */
    for (int i = 0; i < 3; i++) {
        tap(&session, GLFW_KEY_F, 0, 10);
        vw_session_settle(&session, &diags);
        assert_true(vw_session_refresh(&session, &diags));
        assert_int_equal(memcmp(vw_session_shown(&session), plain, bytes) == 0, i == 2);
    }
    /* Pinned, a picture differs from itself by nothing. */
    tap(&session, GLFW_KEY_V, 0, 10);
    assert_true(vw_session_refresh(&session, &diags));
    assert_true(session.show.has_difference && session.show.difference.largest == 0.0);
    session.exact_samples = 9;
    vw_session_set_limits(&session);
    assert_true(fl_render_wait(session.render, -1.0));
    assert_true(vw_session_refresh(&session, &diags));
    assert_true(session.show.difference.largest > 0.0 &&
                session.show.difference.rmse < session.show.difference.largest);
    vw_event space = {.kind = VW_EVENT_KEY, .code = GLFW_KEY_SPACE, .action = GLFW_PRESS};
    vw_session_answer(&session, vw_input_event(&session.input, &session.state, &space, 20), &diags);
    assert_true(vw_session_refresh(&session, &diags));
    assert_memory_equal(vw_session_shown(&session), plain, bytes);
    space.action = GLFW_RELEASE;
    vw_session_answer(&session, vw_input_event(&session.input, &session.state, &space, 30), &diags);
    assert_true(vw_session_refresh(&session, &diags));
    assert_memory_not_equal(vw_session_shown(&session), plain, bytes);
    /* A picture of another size is not compared, and no number says otherwise. */
    session.state.look.region[2] = session.state.look.region[3] = 16;
    assert_true(vw_session_restart(&session, &diags));
    assert_true(fl_render_wait(session.render, -1.0));
    assert_true(vw_session_refresh(&session, &diags));
    assert_false(session.show.has_difference);
    assert_int_equal(diags.error_count, 0);
    free(plain);
    free(before);
    vw_session_close(&session);
}

static void a_hundred_wishes_end_in_the_last(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, VIEWER_TEST_SCENE);
    vw_guide *guide = vw_guide_create(NULL, NULL, &diags);
    assert_non_null(guide);
    vw_guide_picture picture = {0};
    uint64_t wish = 0;
    for (int i = 0; i < 100; i++) {
        fl_params params = session.scene.params;
        params.width = 40 + (uint32_t)i;
        fl_frame *frame = fl_frame_create(session.scene.compiled, &params, &diags);
        wish = vw_guide_ask(guide, frame, i % (VW_GUIDE_RANGEFINDER + 1));
        fl_frame_release(frame);
        vw_guide_take(guide, &picture);
    }
    vw_guide_wait(guide);
    vw_guide_take(guide, &picture);
    assert_int_equal(picture.wish, wish);
    assert_int_equal(picture.width, 139);
    assert_false(picture.is_coarse);
    free(picture.values);
    vw_guide_destroy(guide);
    vw_session_close(&session);
}

static int remove_folder(void **unused)
{
    (void)unused;
    char path[256];
    path_in_folder("optics.txt", path);
    unlink(path);
    return rmdir(folder);
}

/* A picture from a file is compared with as one that was pinned: saved and named, it differs by
 * nothing as floats, by the rounding of bytes as bytes. */
static void a_file_is_pinned(void **unused)
{
    (void)unused;
    static const char *const names[] = {"pin.exr", "pin.png"};
    vw_options options = viewer_test_options();
    options.limits.samples = 2;
    for (int i = 0; i < 2; i++) {
        char path[256];
        path_in_folder(names[i], path);
        vw_session session;
        fl_diags diags = {0};
        fl_progress progress;
        options.pin_path = NULL;
        open_session(&session, &options, VIEWER_TEST_SCENE);
        session.state.look.camera.exposure_ev = -1.0;
        assert_true(vw_session_restart(&session, &diags));
        assert_true(fl_render_wait(session.render, -1.0));
        float *rgb = vw_session_mean(&session, &progress, &diags);
        assert_true(vw_session_save(&session, path, rgb, &progress, &diags));
        free(rgb);
        vw_session_close(&session);
        options.pin_path = path;
        open_session(&session, &options, path); /* The saved state, with its exposure. */
        assert_true(vw_session_restart(&session, &diags));
        assert_true(fl_render_wait(session.render, -1.0));
        assert_true(vw_session_refresh(&session, &diags));
        assert_true(session.show.has_difference);
        assert_true(i == 0 ? session.show.difference.largest == 0.0
                           : session.show.difference.rmse > 0.0 &&
                                 session.show.difference.rmse < 0.01);
        /* V lets it go. */
        tap(&session, GLFW_KEY_V, 0, 100);
        assert_null(session.show.pin.rgb);
        vw_session_close(&session);
        unlink(path);
        assert_false(vw_session_open(&session, &options, VIEWER_TEST_SCENE, 0, 0, &diags));
        assert_true(diags.error_count > 0);
        fl_diags_deinit(&diags);
        vw_session_close(&session);
    }
}

/* Enter over the mirror ball: it comes to the middle, and stays there, sharp, while it is orbited.
 */
static void what_is_under_the_cursor_is_orbited(void **unused)
{
    (void)unused;
    char path[256];
    write_file("optics.txt",
               "firstlight 1\nPerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 30\n"
               "  width 100 height 100 aperture 0.1 focus 2 }\n"
               "Lights { numLights 1 PointLight { position 0 4 4 color 1 1 1 } }\n"
               "Materials { numMaterials 1 Material { diffuseColor 1 1 1 } }\n"
               "Group { numObjects 1 MaterialIndex 0 Sphere { center 0.8 0 0 radius 0.1 } }",
               path);
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, path);
    vw_state *state = &session.state;
    vw_event nowhere = {.kind = VW_EVENT_CURSOR, .x = 10.0, .y = 10.0};
    send(&session, &nowhere, 10);
    vw_look before = state->look;
    assert_false(tap(&session, GLFW_KEY_ENTER, 0, 20) & VW_DIRTY_CAMERA);
    assert_true(vw_look_is_same(&before, &state->look));
    /* 5 tan 15 degrees are 50 pixels. */
    double x_px = 50.0 + 50.0 * 0.8 / (5.0 * 0.26794919243112270);
    vw_event there = {.kind = VW_EVENT_CURSOR, .x = x_px, .y = 50.0};
    send(&session, &there, 30);
    assert_true(tap(&session, GLFW_KEY_ENTER, 0, 40) & VW_DIRTY_CAMERA);
    assert_int_equal(state->mode, VW_MODE_ORBIT);
    fl_vec3 pivot = state->pivot;
    assert_true(fabs(fl_v3_length(fl_v3_sub(pivot, fl_v3(0.8, 0, 0))) - 0.1) < 1e-5);
    for (int i = 0; i < 2; i++) {
        const fl_camera *camera = &state->look.camera;
        fl_vec3 seen = fl_v3_mad(camera->center, camera->direction, camera->focus);
        assert_true(fl_v3_length(fl_v3_sub(seen, pivot)) < 1e-9);
        vw_camera_look(state, 30.0, 10.0);
    }
    assert_false(state->look.camera.center.x == before.camera.center.x);
    vw_session_close(&session);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_is_pinned),
        cmocka_unit_test(what_is_under_the_cursor_is_orbited),
        cmocka_unit_test(focus_is_found_in_mirrors_and_glass),
        cmocka_unit_test(limits_of_sharpness_are_where_the_blur_is_a_pixel),
        cmocka_unit_test(what_stands_behind_pixels_is_what_a_pick_finds),
        cmocka_unit_test(views_show_without_touching_the_film),
        cmocka_unit_test(a_hundred_wishes_end_in_the_last),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
