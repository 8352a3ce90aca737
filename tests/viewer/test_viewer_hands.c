/* SPDX-License-Identifier: MIT
 *
 * Two hands at once, and what stays put while they move: speed keys with the mouse, a region's end,
 * a focus that was pulled, a pivot that is near, a light that is far out of bounds, a scene that is
 * saved meanwhile.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/camera.h"
#include "viewer/input.h"

static vw_state state_of_test(void)
{
    static const fl_light light = {.kind = FL_LIGHT_POINT, .color = {1, 0.5, 0.25}, .samples = 1};
    fl_params params = {.camera = {.center = {0, 0, 5},
                                   .direction = {0, 0, -1},
                                   .up = {0, 1, 0},
                                   .fov_deg = 40,
                                   .aperture = 0.1,
                                   .focus = 5},
                        .width = 640,
                        .height = 480,
                        .lights = &light,
                        .light_count = 1};
    vw_state state = {.follows_window = true};
    vw_state_init(&state, &params, NULL, 64);
    return state;
}

static vw_dirty key(vw_input *input, vw_state *state, int code, int action)
{
    return vw_input_event(input, state,
                          &(vw_event){.kind = VW_EVENT_KEY, .code = code, .action = action}, 0);
}

static vw_dirty button(vw_input *input, vw_state *state, int action)
{
    vw_event event = {.kind = VW_EVENT_BUTTON, .code = GLFW_MOUSE_BUTTON_LEFT, .action = action};
    return vw_input_event(input, state, &event, 0);
}

static vw_dirty cursor(vw_input *input, vw_state *state, double x)
{
    return vw_input_event(input, state, &(vw_event){.kind = VW_EVENT_CURSOR, .x = x, .y = 9.0}, 0);
}

static void run(vw_state *state, const char *name, double x, double y)
{
    vw_command_run(vw_command_named(name), state, (vw_amount){x, y});
}

/* Shift and Alt are the speed of a flight; the mouse turns and focuses as without them. */
static void the_mouse_works_while_flying_fast_and_slow(void **unused)
{
    (void)unused;
    static const int keys[] = {GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_ALT};
    for (size_t i = 0; i < FL_COUNT_OF(keys); i++) {
        vw_state state = state_of_test();
        vw_input input = {0};
        key(&input, &state, keys[i], GLFW_PRESS);
        key(&input, &state, GLFW_KEY_W, GLFW_PRESS);
        cursor(&input, &state, 100.0);
        assert_int_equal(button(&input, &state, GLFW_PRESS), VW_DIRTY_NONE);
        assert_int_equal(cursor(&input, &state, 120.0), VW_DIRTY_CAMERA);
        assert_true(state.look.camera.direction.x > 0.0);
        button(&input, &state, GLFW_RELEASE);
        vw_event wheel = {.kind = VW_EVENT_SCROLL, .y = 1.0};
        assert_int_equal(vw_input_event(&input, &state, &wheel, 0), VW_DIRTY_CAMERA);
        assert_true(state.look.camera.focus > 5.0);
        /* At rest they are part of the chord again. */
        key(&input, &state, GLFW_KEY_W, GLFW_RELEASE);
        assert_int_equal(button(&input, &state, GLFW_PRESS), i ? VW_DIRTY_NONE : VW_DIRTY_PICK);
    }
}

static void a_region_that_is_drawn_turns_no_camera(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    vw_input input = {0};
    cursor(&input, &state, 100.0);
    key(&input, &state, GLFW_KEY_Z, GLFW_PRESS);
    button(&input, &state, GLFW_PRESS);
    cursor(&input, &state, 200.0);
    key(&input, &state, GLFW_KEY_Z, GLFW_RELEASE);
    assert_int_equal(cursor(&input, &state, 300.0), VW_DIRTY_NONE);
    assert_true(state.look.camera.direction.x == 0.0);
    button(&input, &state, GLFW_RELEASE);
    button(&input, &state, GLFW_PRESS);
    assert_int_equal(cursor(&input, &state, 310.0), VW_DIRTY_CAMERA);
    /* Another key that is held ends no drag. */
    key(&input, &state, GLFW_KEY_SPACE, GLFW_PRESS);
    key(&input, &state, GLFW_KEY_SPACE, GLFW_RELEASE);
    assert_int_equal(cursor(&input, &state, 320.0), VW_DIRTY_CAMERA);
}

static void orbiting_keeps_a_focus_that_was_pulled(void **unused)
{
    (void)unused;
    for (int is_pulled = 0; is_pulled < 2; is_pulled++) {
        vw_state state = state_of_test();
        run(&state, "orbit", 1.0, 0.0);
        if (is_pulled)
            run(&state, "focus", 10.0, 0.0);
        double pulled = state.look.camera.focus;
        for (int i = 0; i < 100; i++) {
            run(&state, "look", 7.0, 3.0);
            run(&state, "pan", 2.0, 5.0);
            run(&state, "strafe", 0.01, 0.0);
            run(&state, "forward", 0.01, 0.0);
            run(&state, "dolly", 0.0, -1.0);
        }
        fl_vec3 way = fl_v3_sub(state.pivot, state.look.camera.center);
        double focus = state.look.camera.focus;
        assert_true(fl_v3_length(way) < 4.9);
        assert_true(is_pulled ? focus == pulled : fabs(focus - fl_v3_length(way)) < 1e-9);
    }
}

/* As Enter on what is right before the camera leaves it. */
static void forward_never_moves_back(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    double near = 1e-5 * state.scene_scale, last = near;
    assert_true(vw_camera_orbit_at(&state, fl_v3(0.0, 0.0, 5.0 - near)));
    for (int i = 0; i < 5; i++) {
        vw_camera_fly(&state, 0.0, 0.0, 0.01);
        double distance = fl_v3_length(fl_v3_sub(state.pivot, state.look.camera.center));
        assert_true(distance > 0.0 && distance <= last * (1.0 + 1e-9));
        last = distance;
    }
    vw_camera_fly(&state, 0.0, 0.0, -0.5);
    assert_true(fl_v3_length(fl_v3_sub(state.pivot, state.look.camera.center)) > 0.4);
    vw_camera_fly(&state, 0.0, 0.0, 10.0);
    assert_true(fabs(fl_v3_length(fl_v3_sub(state.pivot, state.look.camera.center)) -
                     1e-3 * state.scene_scale) < 1e-9);
}

/* A scene may have lights beyond the bounds of the keys: they come back by them. */
static void lights_come_back_from_beyond_their_bounds(void **unused)
{
    (void)unused;
    for (int up = -1; up <= 1; up += 2) {
        vw_state state = state_of_test();
        fl_vec3 *color = &state.look.lights[0].color;
        *color = state.look.lit_colors[0] = fl_v3_scale(*color, up > 0 ? 1e-9 : 1e12);
        double before = color->x;
        run(&state, "light-intensity", -up, 0.0);
        assert_true(color->x == before);
        assert_string_equal(vw_state_message(&state), "the light is at its bound");
        run(&state, "light-intensity", up, 0.0);
        assert_true(up > 0 ? color->x > before : color->x < before);
        state.look.lit_colors[0] = fl_v3(0.0, 0.0, 0.0); /* Black stays black, and says so. */
        run(&state, "light-intensity", up, 0.0);
        assert_string_equal(vw_state_message(&state), "the light is at its bound");
    }
}

/* A scene that is saved with another camera: each part of it that was not changed by hand follows.
 */
static void an_edited_scene_changes_what_the_hand_did_not(void **unused)
{
    (void)unused;
    static const char *const commands[] = {"forward", "fov", "aperture", "focus", "exposure"};
    for (size_t i = 0; i < FL_COUNT_OF(commands); i++) {
        vw_state state = state_of_test();
        fl_camera before = state.look.camera;
        run(&state, commands[i], 1.0, 0.0);
        fl_camera mine = state.look.camera;
        fl_params params = {.camera = before, .width = 640, .height = 480};
        params.camera.center.x = 1.0;
        params.camera.fov_deg = 20.0;
        params.camera.aperture = 0.3;
        params.camera.focus = 9.0;
        params.camera.exposure_ev = -2.0;
        vw_state_rebase(&state, &params, NULL, 64);
        const fl_camera *want[] = {&params.camera, &params.camera, &params.camera, &params.camera,
                                   &params.camera},
                        *now = &state.look.camera;
        want[i] = &mine;
        assert_memory_equal(&now->center, &want[0]->center, sizeof now->center);
        assert_true(now->fov_deg == want[1]->fov_deg);
        assert_true(now->aperture == want[2]->aperture);
        assert_true(now->focus == want[3]->focus);
        assert_true(now->exposure_ev == want[4]->exposure_ev);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mouse_works_while_flying_fast_and_slow),
        cmocka_unit_test(a_region_that_is_drawn_turns_no_camera),
        cmocka_unit_test(orbiting_keeps_a_focus_that_was_pulled),
        cmocka_unit_test(forward_never_moves_back),
        cmocka_unit_test(lights_come_back_from_beyond_their_bounds),
        cmocka_unit_test(an_edited_scene_changes_what_the_hand_did_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
