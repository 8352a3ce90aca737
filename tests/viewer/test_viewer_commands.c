/* SPDX-License-Identifier: MIT
 *
 * State, commands and input without a window: no chord is bound twice; every command changes what
 * it should and nothing else; bounds hold and say so; motion depends on log time alone.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "io/state_text.h"
#include "viewer/camera.h"
#include "viewer/input.h"
#include "viewer/viewer.h"
#include "viewer/words.h"

/* Groups of fields; a command may write some of them only. */
enum {
    POSE = 1 << 0,
    FOCUS = 1 << 1,
    APERTURE = 1 << 2,
    FOV = 1 << 3,
    EXPOSURE = 1 << 4,
    DEPTH = 1 << 5,
    LIGHT = 1 << 6,
    CAP = 1 << 7,
    SPEED = 1 << 8,
    MODE = 1 << 9,
    WINDOW = 1 << 10,
    PAUSE = 1 << 11,
    PICK = 1 << 12,
    MESSAGE = 1 << 13,
    ARMED = 1 << 14,
    SLOT = 1 << 15,
    SHOWN = 1 << 16,
    RACK = 1 << 17,
    PANEL = 1 << 18,
    LAMP = 1 << 19,
    OTHER = 1 << 20
};

static fl_params params_of_test(void)
{
    static const fl_light light = {.kind = FL_LIGHT_DISK,
                                   .direction = {0, -1, 0},
                                   .radius = 1.0,
                                   .color = {1, 0.5, 0.25},
                                   .samples = 4};
    return (fl_params){.camera = {.center = {0, 0, 5},
                                  .direction = {0, 0, -1},
                                  .up = {0, 1, 0},
                                  .fov_deg = 40,
                                  .aperture = 0.1,
                                  .focus = 5,
                                  .ortho_size = 2},
                       .width = 640,
                       .height = 480,
                       .depth_limit = 5,
                       .lights = &light,
                       .light_count = 1};
}

static vw_state state_of_test(void)
{
    fl_params params = params_of_test();
    vw_state state = {.follows_window = true};
    vw_state_init(&state, &params, NULL, 64);
    return state;
}

static bool is_same(fl_vec3 a, fl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static int changed_groups(const vw_state *a, const vw_state *b)
{
    const fl_camera *x = &a->look.camera, *y = &b->look.camera;
    int groups = 0;
    groups |= is_same(x->center, y->center) && is_same(x->direction, y->direction) &&
                      is_same(x->up, y->up)
                  ? 0
                  : POSE;
    groups |= x->focus == y->focus ? 0 : FOCUS;
    groups |= x->aperture == y->aperture && a->saved_aperture == b->saved_aperture ? 0 : APERTURE;
    groups |= x->fov_deg == y->fov_deg && x->ortho_size == y->ortho_size ? 0 : FOV;
    groups |= x->exposure_ev == y->exposure_ev ? 0 : EXPOSURE;
    groups |= a->look.depth_limit == b->look.depth_limit ? 0 : DEPTH;
    groups |= a->look.light_samples == b->look.light_samples ? 0 : LIGHT;
    groups |= a->look.sample_cap == b->look.sample_cap ? 0 : CAP;
    groups |= a->speed == b->speed ? 0 : SPEED;
    groups |= a->mode == b->mode && is_same(a->pivot, b->pivot) ? 0 : MODE;
    groups |= a->help_page == b->help_page && a->is_hud_shown == b->is_hud_shown ? 0 : WINDOW;
    groups |= a->is_paused == b->is_paused ? 0 : PAUSE;
    groups |= a->pick_x == b->pick_x && a->pick_y == b->pick_y ? 0 : PICK;
    groups |= a->message_until_ms == b->message_until_ms && strcmp(a->message, b->message) == 0
                  ? 0
                  : MESSAGE;
    groups |= a->quit_armed_ms == b->quit_armed_ms ? 0 : ARMED;
    groups |= a->slot == b->slot ? 0 : SLOT;
    groups |= a->layer == b->layer && a->assist == b->assist && a->compare == b->compare &&
                      a->is_flipped == b->is_flipped && a->is_inspecting == b->is_inspecting
                  ? 0
                  : SHOWN;
    groups |= a->rack_left == b->rack_left && a->rack_to == b->rack_to &&
                      a->rack_seconds == b->rack_seconds &&
                      memcmp(a->rack_focus, b->rack_focus, sizeof a->rack_focus) == 0
                  ? 0
                  : RACK;
    groups |= a->panel == b->panel && a->stress == b->stress && a->rays_x == b->rays_x &&
                      a->rays_y == b->rays_y && a->rays_sample == b->rays_sample
                  ? 0
                  : PANEL;
    groups |= vw_lights_are_same(&a->look, &b->look) ? 0 : LAMP;
    bool is_rest_same =
        a->light == b->light && x->projection == y->projection && x->blades == y->blades &&
        x->blade_rotation_deg == y->blade_rotation_deg && a->width == b->width &&
        a->height == b->height && a->picture_width == b->picture_width &&
        a->picture_height == b->picture_height && a->picture_x == b->picture_x &&
        a->picture_y == b->picture_y && a->picture_scale == b->picture_scale &&
        a->now_ms == b->now_ms && a->scene_scale == b->scene_scale &&
        a->scene_light_samples == b->scene_light_samples &&
        a->follows_window == b->follows_window && is_same(a->scene_center, b->scene_center) &&
        memcmp(&a->start, &b->start, sizeof a->start) == 0;
    return groups | (is_rest_same ? 0 : OTHER);
}

/* For each command: the fields that an ordinary use changes, all of them and no other, and the bits
 * it returns. */
static const struct {
    const char *name;
    int groups;
    unsigned dirty;
} expectations[] = {
    {"forward", POSE, VW_DIRTY_CAMERA},
    {"strafe", POSE, VW_DIRTY_CAMERA},
    {"rise", POSE, VW_DIRTY_CAMERA},
    {"speed", SPEED, VW_DIRTY_WINDOW},
    {"look", POSE, VW_DIRTY_CAMERA},
    {"pan", POSE, VW_DIRTY_CAMERA},
    {"dolly", POSE, VW_DIRTY_CAMERA},
    {"orbit", MODE | MESSAGE, VW_DIRTY_CAMERA},
    {"orbit-at", 0, VW_DIRTY_ORBIT_AT},
    {"reset", 0, VW_DIRTY_CAMERA | VW_DIRTY_TONEMAP | VW_DIRTY_LIMITS},
    {"print", MESSAGE, VW_DIRTY_PRINT},
    {"paste", 0, VW_DIRTY_PASTE},
    {"undo", 0, VW_DIRTY_UNDO},
    {"redo", 0, VW_DIRTY_REDO},
    {"recall", SLOT, VW_DIRTY_RECALL},
    {"store", SLOT, VW_DIRTY_STORE},
    {"focus", FOCUS, VW_DIRTY_CAMERA},
    {"focus-at", PICK, VW_DIRTY_PICK},
    {"focus-through", PICK, VW_DIRTY_PICK_THROUGH},
    {"assist", SHOWN | MESSAGE, VW_DIRTY_SHOW},
    {"rack", MESSAGE, VW_DIRTY_WINDOW},
    {"rack-time", RACK, VW_DIRTY_WINDOW},
    {"aperture", APERTURE, VW_DIRTY_CAMERA},
    {"lens", APERTURE | MESSAGE, VW_DIRTY_CAMERA},
    {"fov", FOV, VW_DIRTY_CAMERA},
    {"region", 0, VW_DIRTY_WINDOW},
    {"light", MESSAGE, VW_DIRTY_WINDOW},
    {"light-switch", LAMP | MESSAGE, VW_DIRTY_LIGHT},
    {"light-intensity", LAMP | MESSAGE, VW_DIRTY_LIGHT},
    {"light-warmth", LAMP | MESSAGE, VW_DIRTY_LIGHT},
    {"light-radius", LAMP | MESSAGE, VW_DIRTY_CAMERA},
    {"light-side", LAMP | MESSAGE, VW_DIRTY_CAMERA},
    {"light-rise", LAMP | MESSAGE, VW_DIRTY_CAMERA},
    {"light-push", LAMP | MESSAGE, VW_DIRTY_CAMERA},
    {"light-samples", LIGHT, VW_DIRTY_CAMERA},
    {"sample-cap", CAP, VW_DIRTY_LIMITS},
    {"depth", DEPTH, VW_DIRTY_CAMERA},
    {"exposure", EXPOSURE, VW_DIRTY_TONEMAP},
    {"pause", PAUSE, VW_DIRTY_LIMITS},
    {"pin", 0, VW_DIRTY_PIN},
    {"compare", SHOWN | MESSAGE, VW_DIRTY_SHOW | VW_DIRTY_COMPARE},
    {"flip", SHOWN, VW_DIRTY_SHOW | VW_DIRTY_COMPARE},
    {"layer", SHOWN, VW_DIRTY_SHOW},
    {"inspect", SHOWN, VW_DIRTY_WINDOW},
    {"rays", PANEL, VW_DIRTY_RAYS},
    {"noise", PANEL, VW_DIRTY_SHOW},
    {"light-auto", MESSAGE, VW_DIRTY_WINDOW},
    {"needs", PANEL, VW_DIRTY_SHOW},
    {"trade", PANEL, VW_DIRTY_SHOW},
    {"stress", PANEL | MESSAGE, VW_DIRTY_SHOW},
    {"help", WINDOW, VW_DIRTY_WINDOW},
    {"hud", WINDOW, VW_DIRTY_WINDOW},
    {"snapshot", 0, VW_DIRTY_SNAPSHOT},
    {"reload", 0, VW_DIRTY_SCENE},
    {"escape", ARMED | MESSAGE, VW_DIRTY_WINDOW},
    {"quit", 0, VW_DIRTY_QUIT},
};

static void every_command_changes_its_fields_only(void **unused)
{
    (void)unused;
    assert_int_equal(FL_COUNT_OF(expectations), vw_command_count);
    for (size_t i = 0; i < vw_command_count; i++) {
        assert_string_equal(expectations[i].name, vw_commands[i].name);
        for (const vw_binding *b = vw_commands[i].bindings; b->kind != VW_BIND_NONE; b++) {
            vw_state before = state_of_test(), after;
            before.layer = VW_LAYER_COUNT; /* Unlike any that a key asks for. */
            after = before;
            vw_dirty dirty = vw_command_run(&vw_commands[i], &after, (vw_amount){b->factor, 0.5});
            int groups = changed_groups(&before, &after);
            if (groups != expectations[i].groups || (unsigned)dirty != expectations[i].dirty)
                fail_msg("%s by %g: changed %x, expected %x; dirty %x, expected %x",
                         vw_commands[i].name, b->factor, (unsigned)groups,
                         (unsigned)expectations[i].groups, (unsigned)dirty, expectations[i].dirty);
        }
    }
}

static void no_chord_is_bound_twice(void **unused)
{
    (void)unused;
    enum { CHORDS_MAX = 512 };
    struct {
        vw_binding_kind kind;
        int code, mods;
        const char *name;
    } chords[CHORDS_MAX];
    size_t count = 0;
    static const int hold_mods[] = {0, GLFW_MOD_SHIFT, GLFW_MOD_ALT, GLFW_MOD_SHIFT | GLFW_MOD_ALT};
    for (size_t i = 0; i < vw_command_count; i++) {
        for (const vw_binding *b = vw_commands[i].bindings; b->kind != VW_BIND_NONE; b++) {
            bool is_hold = b->kind == VW_BIND_HOLD;
            for (size_t m = 0; m < (is_hold ? FL_COUNT_OF(hold_mods) : 1); m++) {
                /* A hold takes its key from presses; a click and a drag share buttons only by
                 * modifiers. */
                vw_binding_kind kind = is_hold || b->kind == VW_BIND_WHILE ? VW_BIND_PRESS
                                       : b->kind == VW_BIND_CLICK          ? VW_BIND_DRAG
                                                                           : b->kind;
                assert_true(count < CHORDS_MAX);
                chords[count].kind = kind;
                chords[count].code = b->code;
                chords[count].mods = is_hold ? hold_mods[m] : b->mods;
                chords[count].name = vw_commands[i].name;
                for (size_t j = 0; j < count; j++)
                    if (chords[j].kind == kind && chords[j].code == b->code &&
                        chords[j].mods == chords[count].mods)
                        fail_msg("%s and %s are bound to the same input (%d, %d)", chords[j].name,
                                 chords[count].name, b->code, chords[count].mods);
                count++;
            }
        }
    }
}

static void run(vw_state *state, const char *name, double amount)
{
    const vw_command *command = vw_command_named(name);
    assert_non_null(command);
    vw_command_run(command, state, (vw_amount){amount, 0.0});
}

static void bounds_hold_and_are_said(void **unused)
{
    (void)unused;
    static const char *const names[] = {"speed",         "focus",      "aperture", "fov",
                                        "light-samples", "sample-cap", "depth",    "exposure"};
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        for (int direction = -1; direction <= 1; direction += 2) {
            vw_state state = state_of_test();
            for (int step = 0; step < 5000; step++)
                run(&state, names[i], direction);
            const fl_camera *camera = &state.look.camera;
            assert_true(camera->aperture >= 0.0 && isfinite(camera->aperture));
            assert_true(camera->focus > 0.0);
            assert_true(camera->fov_deg >= VW_FOV_MIN_DEG && camera->fov_deg <= VW_FOV_MAX_DEG);
            assert_true(fabs(camera->exposure_ev) <= VW_EXPOSURE_MAX_EV);
            assert_in_range(state.look.light_samples, 0, VW_LIGHT_SAMPLES_MAX);
            assert_in_range(state.look.sample_cap, 1, VW_SAMPLE_CAP_MAX);
            assert_in_range(state.look.depth_limit, 0, FL_DEPTH_MAX);
            if (!vw_state_message(&state))
                fail_msg("%s stops at its bound without a word", names[i]);
        }
    }
}

static void focus_comes_back_from_infinity(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    for (int i = 0; i < 5000; i++)
        run(&state, "focus", 1.0);
    assert_true(isinf(state.look.camera.focus));
    run(&state, "focus", -1.0);
    assert_true(isfinite(state.look.camera.focus));
}

static void opening_a_pinhole_takes_scale_and_focus_from_the_scene(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    state.look.camera.aperture = 0.0;
    state.look.camera.focus = (double)INFINITY;
    state.scene_scale = 1000.0;
    run(&state, "aperture", 1.0);
    assert_true(state.look.camera.aperture == 5.0);
    assert_true(isfinite(state.look.camera.focus));
    double opened = state.look.camera.aperture;
    run(&state, "lens", 1.0);
    assert_true(state.look.camera.aperture == 0.0);
    run(&state, "lens", 1.0);
    assert_true(state.look.camera.aperture == opened);
}

static void a_pinhole_does_not_restart_for_focus(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    state.look.camera.aperture = 0.0;
    vw_dirty dirty = vw_command_run(vw_command_named("focus"), &state, (vw_amount){1.0, 0.0});
    assert_int_equal(dirty, VW_DIRTY_WINDOW);
    assert_int_equal(vw_state_focus_at(&state, 2.0), VW_DIRTY_WINDOW);
    assert_true(state.look.camera.focus == 2.0);
    vw_state_focus_at(&state, 0.0);
    assert_true(state.look.camera.focus == 2.0);
}

static void reset_undoes_everything(void **unused)
{
    (void)unused;
    vw_state state = state_of_test(), start = state;
    for (size_t i = 0; i < vw_command_count; i++)
        if (strcmp(vw_commands[i].name, "reset") != 0)
            vw_command_run(&vw_commands[i], &state, (vw_amount){1.0, 3.0});
    run(&state, "reset", 1.0);
    assert_memory_equal(&state.look.camera.center, &start.look.camera.center, sizeof(fl_vec3));
    int left = changed_groups(&start, &state);
    assert_int_equal(
        left & ~(WINDOW | PAUSE | PICK | MESSAGE | ARMED | MODE | SLOT | SHOWN | RACK | PANEL), 0);
    assert_int_equal(state.mode, VW_MODE_FLY);
}

static void orbit_keeps_its_pivot_and_focus(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    run(&state, "orbit", 1.0);
    fl_vec3 pivot = state.pivot;
    uint32_t seed = 1;
    printf("seed %u\n", seed);
    for (int i = 0; i < 500; i++) {
        seed = fl_lowbias32(seed + 1);
        vw_amount amount = {(double)(seed & 255) - 128.0, (double)(seed >> 8 & 255) - 128.0};
        vw_command_run(vw_command_named("look"), &state, amount);
        const fl_camera *camera = &state.look.camera;
        fl_vec3 to_pivot = fl_v3_sub(pivot, camera->center);
        assert_true(fabs(fl_v3_length(to_pivot) - 5.0) < 1e-9);
        assert_true(fl_v3_length(fl_v3_sub(fl_v3_normalize(to_pivot), camera->direction)) < 1e-9);
        assert_true(fabs(fl_v3_length(camera->direction) - 1.0) < 1e-12);
        /* Never over the pole: right stays right. */
        assert_true(fl_v3_length(fl_v3_cross(camera->direction, camera->up)) > 0.005);
    }
}

static void pan_follows_the_cursor(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    fl_vec3 before = state.look.camera.center;
    vw_camera_pan(&state, 480.0, 0.0);
    /* A drag across the height moves what is in focus by the height of the view there. */
    double height = 2.0 * 5.0 * tan(20.0 * VW_PI / 180.0);
    assert_true(fabs(before.x - state.look.camera.center.x - height) < 1e-9);
}

static vw_dirty key(vw_input *input, vw_state *state, int code, int action, uint64_t ms)
{
    return vw_input_event(input, state,
                          &(vw_event){.kind = VW_EVENT_KEY, .code = code, .action = action}, ms);
}

static void motion_depends_on_log_time_alone(void **unused)
{
    (void)unused;
    vw_state a = state_of_test(), b = a;
    vw_input in_a = {0}, in_b = {0};
    key(&in_a, &a, GLFW_KEY_W, GLFW_PRESS, 105);
    key(&in_b, &b, GLFW_KEY_W, GLFW_PRESS, 105);
    for (uint64_t ms = 106; ms < 900; ms += 7)
        vw_input_advance(&in_a, &a, ms);
    key(&in_a, &a, GLFW_KEY_W, GLFW_RELEASE, 905);
    key(&in_b, &b, GLFW_KEY_W, GLFW_RELEASE, 905);
    assert_memory_equal(&a.look.camera.center, &b.look.camera.center, sizeof(fl_vec3));
    /* 48 steps of 1/60 s at a quarter of the scene's scale a second. */
    assert_true(fabs(5.0 - a.look.camera.center.z - 48.0 / 60.0 * 0.25 * a.scene_scale) < 1e-9);
    assert_false(vw_input_is_moving(&in_a));
}

static void a_tap_moves_one_step_and_shift_four(void **unused)
{
    (void)unused;
    vw_state a = state_of_test(), b = a;
    vw_input in_a = {0}, in_b = {0};
    key(&in_a, &a, GLFW_KEY_D, GLFW_PRESS, 1);
    key(&in_a, &a, GLFW_KEY_D, GLFW_RELEASE, 2);
    key(&in_b, &b, GLFW_KEY_LEFT_SHIFT, GLFW_PRESS, 0);
    key(&in_b, &b, GLFW_KEY_D, GLFW_PRESS, 1);
    key(&in_b, &b, GLFW_KEY_D, GLFW_RELEASE, 2);
    assert_true(a.look.camera.center.x > 0.0);
    assert_true(fabs(b.look.camera.center.x - 4.0 * a.look.camera.center.x) < 1e-12);
}

static void control_s_saves_and_does_not_fly(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    vw_input input = {0};
    key(&input, &state, GLFW_KEY_LEFT_CONTROL, GLFW_PRESS, 0);
    assert_int_equal(key(&input, &state, GLFW_KEY_S, GLFW_PRESS, 10), VW_DIRTY_SNAPSHOT);
    assert_false(vw_input_is_moving(&input));
    key(&input, &state, GLFW_KEY_LEFT_CONTROL, GLFW_RELEASE, 20);
    key(&input, &state, GLFW_KEY_S, GLFW_PRESS, 30);
    assert_true(vw_input_is_moving(&input));
    vw_input_event(&input, &state, &(vw_event){.kind = VW_EVENT_FOCUS}, 40);
    assert_false(vw_input_is_moving(&input));
}

static void escape_twice_quits_in_time(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    vw_input input = {0};
    key(&input, &state, GLFW_KEY_F1, GLFW_PRESS, 0);
    assert_int_equal(key(&input, &state, GLFW_KEY_ESCAPE, GLFW_PRESS, 1000), VW_DIRTY_WINDOW);
    assert_int_equal(state.help_page, 0);
    assert_int_equal(key(&input, &state, GLFW_KEY_ESCAPE, GLFW_PRESS, 2000), VW_DIRTY_WINDOW);
    assert_int_equal(key(&input, &state, GLFW_KEY_ESCAPE, GLFW_PRESS, 2000 + VW_QUIT_MS),
                     VW_DIRTY_WINDOW);
    assert_int_equal(key(&input, &state, GLFW_KEY_ESCAPE, GLFW_PRESS, 2100 + VW_QUIT_MS),
                     VW_DIRTY_QUIT);
}

static void escape_takes_an_error_away_first(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    state.has_error = true;
    run(&state, "escape", 1.0);
    assert_false(state.has_error);
    assert_int_equal(state.quit_armed_ms, 0);
    run(&state, "escape", 1.0);
    assert_int_not_equal(state.quit_armed_ms, 0);
}

static void drag_click_and_wheel_reach_their_commands(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    vw_input input = {0};
    vw_event cursor = {.kind = VW_EVENT_CURSOR, .x = 100, .y = 50};
    assert_int_equal(vw_input_event(&input, &state, &cursor, 0), VW_DIRTY_NONE);
    vw_event button = {.kind = VW_EVENT_BUTTON,
                       .code = GLFW_MOUSE_BUTTON_LEFT,
                       .action = GLFW_PRESS,
                       .mods = GLFW_MOD_SHIFT};
    assert_int_equal(vw_input_event(&input, &state, &button, 1), VW_DIRTY_PICK);
    assert_true(state.pick_x == 100.0 && state.pick_y == 50.0);
    button.mods = 0;
    vw_input_event(&input, &state, &button, 2);
    cursor.x = 120;
    assert_int_equal(vw_input_event(&input, &state, &cursor, 3), VW_DIRTY_CAMERA);
    assert_true(state.look.camera.direction.x > 0.0);
    button.action = GLFW_RELEASE;
    vw_input_event(&input, &state, &button, 4);
    cursor.x = 140;
    assert_int_equal(vw_input_event(&input, &state, &cursor, 5), VW_DIRTY_NONE);
    vw_event wheel = {.kind = VW_EVENT_SCROLL, .y = 1.0};
    assert_int_equal(vw_input_event(&input, &state, &wheel, 6), VW_DIRTY_CAMERA);
    assert_true(state.look.camera.focus > 5.0);
    wheel.mods = GLFW_MOD_CONTROL;
    vw_input_event(&input, &state, &wheel, 7);
    assert_true(state.look.camera.fov_deg < 40.0);
}

static void resize_follows_or_fits(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    assert_int_equal(vw_state_resize(&state, 640, 480), VW_DIRTY_WINDOW);
    assert_int_equal(vw_state_resize(&state, 800, 300), VW_DIRTY_WINDOW | VW_DIRTY_CAMERA);
    assert_int_equal(state.picture_width, 800);
    fl_params params = params_of_test();
    vw_state fixed = {0};
    vw_state_init(&fixed, &params, NULL, 64);
    assert_int_equal(vw_state_resize(&fixed, 1280, 1200), VW_DIRTY_WINDOW);
    assert_int_equal(fixed.picture_width, 640);
    assert_true(fixed.picture_scale == 2.0 && fixed.picture_x == 0.0 && fixed.picture_y == 120.0);
}

static void controls_page_names_every_command(void **unused)
{
    (void)unused;
    char page[16384];
    size_t bytes = vw_controls_markdown(page, sizeof page);
    assert_true(bytes < sizeof page && strlen(page) == bytes);
    assert_int_equal(vw_controls_markdown(NULL, 0), bytes);
    for (size_t i = 0; i < vw_command_count; i++)
        assert_non_null(strstr(page, vw_commands[i].help));
}

static void camera_options_name_the_camera(void **unused)
{
    (void)unused;
    vw_state state = state_of_test();
    char text[512];
    fl_camera_options_text(&state.look.camera, text, sizeof text);
    assert_string_equal(text,
                        "--camera '0 0 5  0 0 4  0 1 0  40' --aperture 0.1 --focus 5 --exposure 0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_command_changes_its_fields_only),
        cmocka_unit_test(no_chord_is_bound_twice),
        cmocka_unit_test(bounds_hold_and_are_said),
        cmocka_unit_test(focus_comes_back_from_infinity),
        cmocka_unit_test(opening_a_pinhole_takes_scale_and_focus_from_the_scene),
        cmocka_unit_test(a_pinhole_does_not_restart_for_focus),
        cmocka_unit_test(reset_undoes_everything),
        cmocka_unit_test(orbit_keeps_its_pivot_and_focus),
        cmocka_unit_test(pan_follows_the_cursor),
        cmocka_unit_test(motion_depends_on_log_time_alone),
        cmocka_unit_test(a_tap_moves_one_step_and_shift_four),
        cmocka_unit_test(control_s_saves_and_does_not_fly),
        cmocka_unit_test(escape_twice_quits_in_time),
        cmocka_unit_test(escape_takes_an_error_away_first),
        cmocka_unit_test(drag_click_and_wheel_reach_their_commands),
        cmocka_unit_test(resize_follows_or_fits),
        cmocka_unit_test(controls_page_names_every_command),
        cmocka_unit_test(camera_options_name_the_camera),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
