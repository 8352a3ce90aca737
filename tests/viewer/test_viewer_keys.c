/* SPDX-License-Identifier: MIT
 *
 * Other keys for commands: what the file says is what the keys do, the help says so, and no chord
 * reaches two commands.
 */
#include "viewer_kit.h"

#include <math.h>

#include "viewer/keymap.h"
#include "viewer/words.h"

static const struct {
    const char *text;
    uint32_t line, column;
    const char *message;
} wrong[] = {
    {"forwards = W S\n", 1, 1, "unknown command 'forwards'; did you mean 'forward'?"},
    {"# fine\n\nforward W\n", 3, 9, "expected '=' after 'forward'"},
    {"forward =\n", 1, 10, "expected a chord or none"},
    {"pause = Ctrl+PAUS\n", 1, 14, "unknown key 'PAUS'; did you mean 'PAUSE'?"},
    {"look = lefty\n", 1, 8, "unknown button 'lefty'"},
    {"fov = W\n", 1, 7, "expected wheel, found 'W'"},
    {"pause = P O\n", 1, 11, "'pause' takes 1 chord at most"},
    {"forward = Shift+UP\n", 1, 11, "'forward' takes keys alone"},
    {"print = F1\nprint = none\n", 2, 1, "'print' was given in line 1"},
    {"pause = O\n", 1, 1, "a chord of 'pause' belongs to 'lens' too"},
    {"lens = none\npause = O\nprint = Ctrl+D\nquit = Shift+W\n", 4, 1,
     "a chord of 'quit' belongs to 'forward' too"},
};

static void errors_stand_at_their_place(void **unused)
{
    (void)unused;
    static vw_keymap keymap, table;
    vw_keymap_init(&table);
    for (size_t i = 0; i < FL_COUNT_OF(wrong); i++) {
        fl_diags diags = {0};
        vw_keymap_init(&keymap);
        assert_false(
            vw_keymap_parse(&keymap, wrong[i].text, strlen(wrong[i].text), "keys", &diags));
        assert_int_equal(diags.error_count, 1);
        const fl_diag *d = &diags.items[0];
        if (d->loc.line != wrong[i].line || d->loc.column != wrong[i].column ||
            !strstr(d->message, wrong[i].message))
            fail_msg("'%s': %u:%u: %s", wrong[i].text, d->loc.line, d->loc.column, d->message);
        assert_memory_equal(&keymap, &table, sizeof table);
        fl_diags_deinit(&diags);
    }
}

static void no_chord_reaches_two_commands(void **unused)
{
    (void)unused;
    static vw_keymap keymap;
    size_t first = 0, second = 0;
    vw_keymap_init(&keymap);
    if (vw_keymap_find_conflict(&keymap, &first, &second))
        fail_msg("%s and %s", vw_commands[first].name, vw_commands[second].name);
    /* Any chord moved onto any other is found, and said at its line. */
    for (size_t i = 0; i < vw_command_count; i++) {
        vw_keymap_init(&keymap);
        keymap.bindings[i][0] = keymap.bindings[(i + 1) % vw_command_count][0];
        assert_true(vw_keymap_find_conflict(&keymap, &first, &second));
    }
}

static void keys_do_what_the_file_says(void **unused)
{
    (void)unused;
    static const char text[] = "# mine\n"
                               "forward = KP_8 KP_2\n"
                               "light-intensity = w s\n"
                               "focus-at = Alt+left  # with the other hand\n"
                               "exposure = ctrl+b Ctrl+SHIFT+B\n"
                               "pause = none\n"
                               "aperture = / ;\n";
    char path[256], keys[VW_KEYS_MAX];
    write_file("keys", text, path);
    vw_options options = viewer_test_options();
    options.keys_path = path;
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    fl_vec3 before = session.state.look.camera.center;
    tap(&session, GLFW_KEY_KP_2, 0, 10);
    assert_true(session.state.look.camera.center.z > before.z);
    assert_true(tap(&session, GLFW_KEY_W, 0, 20) != VW_DIRTY_NONE);
    assert_false(vw_lights_are_same(&session.state.look, &session.state.start));
    double ev = session.state.look.camera.exposure_ev;
    assert_int_equal(tap(&session, GLFW_KEY_B, 0, 30), VW_DIRTY_NONE);
    tap(&session, GLFW_KEY_B, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT, 40);
    assert_true(session.state.look.camera.exposure_ev < ev);
    tap(&session, GLFW_KEY_P, 0, 50);
    assert_false(session.state.is_paused);
    double aperture = session.state.look.camera.aperture;
    tap(&session, GLFW_KEY_SEMICOLON, 0, 60);
    assert_true(session.state.look.camera.aperture > aperture);
    const vw_command *exposure = vw_command_named("exposure");
    vw_words_keys(exposure, session.state.keymap, NULL, keys);
    assert_string_equal(keys, "Ctrl+B  Ctrl+Shift+B");
    vw_words_keys(exposure, NULL, NULL, keys);
    assert_string_equal(keys, "B  Shift+B");
    vw_session_close(&session);
    /* A file that is asked for and broken, or not there, is an error, and no session opens. */
    write_file("keys", "forwards = W\n", path);
    for (int i = 0; i < 2; i++) {
        fl_diags diags = {0};
        assert_false(vw_session_open(&session, &options, VIEWER_TEST_SCENE, 0, 0, &diags));
        assert_int_equal(diags.error_count, 1);
        fl_diags_deinit(&diags);
        vw_session_close(&session);
        unlink(path);
    }
}

static void a_gamepad_flies(void **unused)
{
    (void)unused;
    for (const vw_pad_binding *b = vw_pad_bindings; b->command; b++) {
        assert_non_null(vw_command_named(b->command));
        for (const vw_pad_binding *other = b + 1; other->command; other++)
            assert_false(other->is_axis == b->is_axis && other->code == b->code);
    }
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, VIEWER_TEST_SCENE);
    fl_camera before = session.state.look.camera;
    vw_event stick = {.kind = VW_EVENT_AXIS, .code = GLFW_GAMEPAD_AXIS_LEFT_Y, .x = -1.0};
    send(&session, &stick, 1000);
    assert_true(vw_input_is_moving(&session.input));
    vw_input_advance(&session.input, &session.state, 2000);
    /* A stick that is pushed as far as it goes flies as the key does. */
    fl_vec3 by_stick = session.state.look.camera.center;
    stick.x = 0.0;
    send(&session, &stick, 2000);
    assert_false(vw_input_is_moving(&session.input));
    session.state.look.camera = before;
    vw_event key = {.kind = VW_EVENT_KEY, .code = GLFW_KEY_W, .action = GLFW_PRESS};
    send(&session, &key, 3000);
    key.action = GLFW_RELEASE;
    send(&session, &key, 4000);
    assert_true(fl_v3_length(fl_v3_sub(by_stick, session.state.look.camera.center)) < 1e-12);
    assert_true(by_stick.z < before.center.z);
    /* Half way is a quarter as fast, pressed it is four times as fast. */
    for (int i = 0; i < 2; i++) {
        session.state.look.camera = before;
        vw_event thumb = {.kind = VW_EVENT_PAD,
                          .code = GLFW_GAMEPAD_BUTTON_LEFT_THUMB,
                          .action = i ? GLFW_PRESS : GLFW_RELEASE};
        send(&session, &thumb, 5000 + 2000 * (uint64_t)i);
        stick.x = -0.5;
        send(&session, &stick, 5000 + 2000 * (uint64_t)i);
        stick.x = 0.0;
        send(&session, &stick, 6000 + 2000 * (uint64_t)i);
        double part =
            (before.center.z - session.state.look.camera.center.z) / (before.center.z - by_stick.z);
        assert_true(fabs(part - (i ? 1.0 : 0.25)) < 1e-9);
    }
    /* The right stick turns to where it points. */
    session.state.look.camera = before;
    stick = (vw_event){.kind = VW_EVENT_AXIS, .code = GLFW_GAMEPAD_AXIS_RIGHT_X, .x = 1.0};
    send(&session, &stick, 9000);
    vw_event lost = {.kind = VW_EVENT_FOCUS};
    send(&session, &lost, 9500);
    assert_true(session.state.look.camera.direction.x > 0.1);
    assert_false(vw_input_is_moving(&session.input));
    /* A focuses on the middle, B takes it back. */
    double focus = session.state.look.camera.focus;
    vw_event button = {.kind = VW_EVENT_PAD, .code = GLFW_GAMEPAD_BUTTON_A, .action = GLFW_PRESS};
    session.state.look.camera = before;
    send(&session, &lost, 20000);
    send(&session, &button, 21000);
    assert_true(session.state.look.camera.focus != focus);
    button.code = GLFW_GAMEPAD_BUTTON_B;
    send(&session, &button, 22000);
    assert_true(session.state.look.camera.focus == focus);
    vw_session_close(&session);
}

static int finish(void **unused)
{
    (void)unused;
    return remove_files((const char *const[]){"keys"}, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_stand_at_their_place),
        cmocka_unit_test(no_chord_reaches_two_commands),
        cmocka_unit_test(keys_do_what_the_file_says),
        cmocka_unit_test(a_gamepad_flies),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
