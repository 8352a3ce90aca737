/* SPDX-License-Identifier: MIT
 *
 * Other keys for commands: what the file says is what the keys do, the help says so, and no chord
 * reaches two commands.
 */
#include "viewer_kit.h"

#include <math.h>

#include "viewer/keymap.h"
#include "viewer/log.h"
#include "viewer/pad.h"
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
    {"forward = LEFT_SHIFT\n", 1, 11, "'LEFT_SHIFT' goes with other keys"},
    {"pause = Ctrl+Right_Alt\n", 1, 14, "'Right_Alt' goes with other keys"},
    {"region = left_control\n", 1, 10, "'left_control' goes with other keys"},
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

static void every_button_has_a_name(void **unused)
{
    (void)unused;
    static const char text[] = "focus-at = 8\npan = Alt+4\nlook = middle\n";
    static vw_keymap keymap;
    char keys[VW_KEYS_MAX];
    fl_diags diags = {0};
    vw_keymap_init(&keymap);
    assert_true(vw_keymap_parse(&keymap, text, strlen(text), "keys", &diags));
    static const char *const expected[][2] = {
        {"focus-at", "button 8 click"}, {"pan", "Alt+button 4 drag"}, {"look", "middle drag"}};
    for (size_t i = 0; i < FL_COUNT_OF(expected); i++) {
        vw_words_keys(vw_command_named(expected[i][0]), &keymap, NULL, keys);
        assert_string_equal(keys, expected[i][1]);
    }
}

static const char *german_label(vw_platform *platform, int key)
{
    (void)platform;
    return key == GLFW_KEY_Y ? "z" : key == GLFW_KEY_Z ? "y" : NULL;
}

/* Letters with Ctrl are found by what the keyboard prints, keys alone by their place. */
static void letters_with_control_are_those_printed(void **unused)
{
    (void)unused;
    assert_int_equal(vw_key_of_label(GLFW_KEY_Y, "z"), GLFW_KEY_Z);
    assert_int_equal(vw_key_of_label(GLFW_KEY_Q, "A"), GLFW_KEY_A);
    assert_int_equal(vw_key_of_label(GLFW_KEY_SEMICOLON, "m"), GLFW_KEY_M);
    assert_int_equal(vw_key_of_label(GLFW_KEY_1, "&"), GLFW_KEY_1);
    assert_int_equal(vw_key_of_label(GLFW_KEY_Z, NULL), GLFW_KEY_Z);
    assert_int_equal(vw_key_of_label(GLFW_KEY_Z, ""), GLFW_KEY_Z);
    assert_int_equal(vw_key_of_label(GLFW_KEY_Z, "\321\217"), GLFW_KEY_Z);
    static const vw_platform_ops ops = {.key_label = german_label};
    vw_platform platform = {.ops = &ops};
    char keys[VW_KEYS_MAX];
    vw_words_keys(vw_command_named("undo"), NULL, &platform, keys);
    assert_string_equal(keys, "Ctrl+Z");
    vw_words_keys(vw_command_named("region"), NULL, &platform, keys);
    assert_string_equal(keys, "Y");
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

/* What the pad says, by way of the log, to where the camera goes. */
static void a_made_up_gamepad_says_what_a_real_one_would(void **unused)
{
    (void)unused;
    enum { LX = GLFW_GAMEPAD_AXIS_LEFT_X, LY = GLFW_GAMEPAD_AXIS_LEFT_Y };
    GLFWgamepadstate told = {0}, raw = {0};
    raw.axes[GLFW_GAMEPAD_AXIS_LEFT_TRIGGER] = raw.axes[GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER] = -1.0f;
    vw_event_queue queue = {0};
    vw_event event;
    vw_pad_tell(&told, NULL, &queue);
    vw_pad_tell(&told, &raw, &queue);
    /* Rest is a disk: worn sticks do not creep, and both axes of one together are not at rest. */
    raw.axes[LX] = 0.1f;
    raw.axes[LY] = -0.1f;
    vw_pad_tell(&told, &raw, &queue);
    assert_int_equal(queue.count, 0);
    raw.axes[LX] = 0.14f;
    raw.axes[LY] = -0.9f;
    vw_pad_tell(&told, &raw, &queue);
    assert_int_equal(queue.count, 2);
    assert_true(vw_event_pop(&queue, &event) && event.code == LX && event.x == 4.0 / 32.0);
    assert_true(vw_event_pop(&queue, &event) && event.code == LY && event.x == -28.0 / 32.0);
    /* The same again is no news; nor is a tremble. */
    raw.axes[LY] = -0.905f;
    vw_pad_tell(&told, &raw, &queue);
    assert_int_equal(queue.count, 0);
    /* Corners of square gates, broken numbers of drivers: never beyond 1. */
    raw.axes[LX] = 1.0f;
    raw.axes[LY] = 1.5f;
    vw_pad_tell(&told, &raw, &queue);
    while (vw_event_pop(&queue, &event))
        assert_true(fabs(event.x) <= 1.0 && event.x > 0.5);
    /* Triggers rest at -1. */
    raw.axes[LX] = raw.axes[LY] = 0.0f;
    raw.axes[GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER] = 1.0f;
    raw.buttons[GLFW_GAMEPAD_BUTTON_B] = GLFW_PRESS;
    vw_pad_tell(&told, &raw, &queue);
    assert_int_equal(queue.count, 4);
    for (int i = 0; i < 2; i++)
        assert_true(vw_event_pop(&queue, &event) && event.x == 0.0 && !signbit(event.x));
    assert_true(vw_event_pop(&queue, &event) && event.x == 1.0);
    assert_true(vw_event_pop(&queue, &event) && event.kind == VW_EVENT_PAD &&
                event.code == GLFW_GAMEPAD_BUTTON_B && event.action == GLFW_PRESS);
    /* Another window had the keyboard: what is still pushed is told again, what is pressed not. */
    vw_pad_forget_sticks(&told);
    vw_pad_tell(&told, &raw, &queue);
    assert_int_equal(queue.count, 1);
    assert_true(vw_event_pop(&queue, &event) && event.x == 1.0);
    /* Unplugged: everything is let go. */
    vw_pad_tell(&told, NULL, &queue);
    assert_int_equal(queue.count, 2);
    while (vw_event_pop(&queue, &event))
        assert_true(event.x == 0.0);
    /* One without triggers in its mapping: at rest it flies nowhere. */
    raw = (GLFWgamepadstate){0};
    vw_pad_tell(&told, &raw, &queue);
    assert_int_equal(queue.count, 0);
    vw_event_queue_deinit(&queue);
}

/* The log of a made-up pad moves the camera to the same bytes as the pad did, whatever the pace at
 * which it was asked. */
static void a_gamepad_is_recorded(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    fl_camera cameras[3];
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    vw_log_write_header(file, 96, 64, VIEWER_TEST_SCENE);
    for (int run = 0; run < 3; run++) {
        vw_session session;
        open_session(&session, &options, VIEWER_TEST_SCENE);
        GLFWgamepadstate told = {0}, raw = {0};
        vw_event_queue queue = {0};
        vw_event event;
        for (uint64_t ms = 0; ms < 2000 && run < 2; ms += run ? 5 : 16) {
            /* Told at the same times: between them it is only asked in vain. */
            uint64_t phase = ms / 400;
            raw.axes[GLFW_GAMEPAD_AXIS_LEFT_Y] = ms % 400 ? raw.axes[1] : -0.2f * (float)phase;
            raw.axes[GLFW_GAMEPAD_AXIS_RIGHT_X] = ms % 400 ? raw.axes[2] : 0.25f * (float)phase;
            vw_pad_tell(&told, &raw, &queue);
            while (vw_event_pop(&queue, &event)) {
                send(&session, &event, ms);
                if (run == 0)
                    vw_log_write_event(file, ms, &event);
            }
            vw_input_advance(&session.input, &session.state, ms);
        }
        if (run == 2) {
            vw_log log;
            fl_diags diags = {0};
            vw_log_write_quit(file, 2000);
            fclose(file);
            assert_true(vw_log_parse(text, bytes, "pad.log", &log, &diags));
            assert_true(log.entry_count > 8);
            for (size_t i = 0; i < log.entry_count; i++)
                if (log.entries[i].kind == VW_LOG_EVENT)
                    send(&session, &log.entries[i].event, log.entries[i].ms);
            vw_log_deinit(&log);
        }
        vw_input_advance(&session.input, &session.state, 2000);
        cameras[run] = session.state.look.camera;
        vw_event_queue_deinit(&queue);
        vw_session_close(&session);
    }
    free(text);
    assert_memory_equal(&cameras[0].center, &cameras[1].center, sizeof cameras[0].center);
    assert_memory_equal(&cameras[0].center, &cameras[2].center, sizeof cameras[0].center);
    assert_memory_equal(&cameras[0].direction, &cameras[2].direction, sizeof cameras[0].direction);
    assert_true(cameras[0].direction.x > 0.1);
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
        cmocka_unit_test(every_button_has_a_name),
        cmocka_unit_test(letters_with_control_are_those_printed),
        cmocka_unit_test(a_gamepad_flies),
        cmocka_unit_test(a_made_up_gamepad_says_what_a_real_one_would),
        cmocka_unit_test(a_gamepad_is_recorded),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
