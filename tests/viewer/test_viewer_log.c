/* SPDX-License-Identifier: MIT
 *
 * The log: what is written reads back as it was, and each wrong line is an error at its place.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/log.h"

#define HEAD "firstlight-log 1 640x480 a scene.txt\n"

static const struct {
    const char *text;
    uint32_t line, column;
    const char *message;
} wrong[] = {
    {"", 1, 1, "expected 'firstlight-log"},
    {"hello\n", 1, 1, "expected 'firstlight-log"},
    {"firstlight-log 2 1x1 s\n", 1, 16, "expected version 1, found '2'"},
    {"firstlight-log 1 640 s\n", 1, 18, "expected a size"},
    {"firstlight-log 1 640x s\n", 1, 18, "expected a size"},
    {"firstlight-log 1 0x480 s\n", 1, 18, "the sides must be 1 to 16384"},
    {"firstlight-log 1 640x480\n", 1, 25, "expected a scene, found the end of the line"},
    {HEAD "x key W press\n", 2, 1, "expected a time"},
    {HEAD "-1 key W press\n", 2, 1, "expected a time"},
    {HEAD "9 key W press\n8 key W release\n", 3, 1, "time goes back: 8 ms after 9 ms"},
    {HEAD "1 keys W press\n", 2, 3, "unknown event 'keys'; did you mean 'key'?"},
    {HEAD "1\n", 2, 2, "expected key, button"},
    {HEAD "1 key\n", 2, 6, "expected key"},
    {HEAD "1 key LEFT_SHFT press\n", 2, 7, "unknown key 'LEFT_SHFT'; did you mean 'LEFT_SHIFT'?"},
    {HEAD "1 key W\n", 2, 8, "expected press, release or repeat, found the end"},
    {HEAD "1 key W push\n", 2, 9, "expected press, release or repeat, found 'push'"},
    {HEAD "1 key W press HYPER\n", 2, 15, "expected SHIFT"},
    {HEAD "1 button LEFTY press\n", 2, 10, "unknown button 'LEFTY'; did you mean 'LEFT'?"},
    {HEAD "1 button LEFT repeat\n", 2, 15, "expected press or release"},
    {HEAD "1 cursor 3\n", 2, 11, "expected the cursor's y"},
    {HEAD "1 cursor 3 4 5\n", 2, 14, "expected the end of the line, found '5'"},
    {HEAD "1 cursor nan 4\n", 2, 10, "the cursor's x must be"},
    {HEAD "1 scroll 0 1e9\n", 2, 12, "the scroll's y must be"},
    {HEAD "1 resize 0 10\n", 2, 10, "the width must be 1 to 16384, got 0"},
    {HEAD "1 axis LEFT_Q 1\n", 2, 8, "unknown axis 'LEFT_Q'"},
    {HEAD "1 axis LEFT_X 1.5\n", 2, 15, "the axis must be -1 to 1"},
    {HEAD "1 pad START repeat\n", 2, 13, "expected press or release"},
    {HEAD "1 drop\n", 2, 7, "expected a file"},
    {HEAD "1 snapshot out.png\n", 2, 12, "expected a file and a number of samples"},
    {HEAD "1 snapshot out.png 0\n", 2, 20, "the number of samples must be 1"},
    {HEAD "1 reload now\n", 2, 10, "expected the end of the line"},
    {HEAD "1 quit now\n", 2, 8, "expected the end of the line"},
};

static void wrong_lines_are_located(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < FL_COUNT_OF(wrong); i++) {
        fl_diags diags = {0};
        vw_log log;
        assert_false(vw_log_parse(wrong[i].text, strlen(wrong[i].text), "a.log", &log, &diags));
        assert_int_equal(diags.error_count, 1);
        const fl_diag *d = &diags.items[0];
        if (d->loc.line != wrong[i].line || d->loc.column != wrong[i].column ||
            !strstr(d->message, wrong[i].message) || strcmp(d->loc.file, "a.log") != 0)
            fail_msg("case %zu: got %s:%u:%u: %s", i, d->loc.file, d->loc.line, d->loc.column,
                     d->message);
        fl_diags_deinit(&diags);
    }
}

static void all_errors_are_reported(void **unused)
{
    (void)unused;
    const char *text = HEAD "1 kee W press\n2 key WW press\n3 quit\n";
    fl_diags diags = {0};
    vw_log log;
    assert_false(vw_log_parse(text, strlen(text), "a.log", &log, &diags));
    assert_int_equal(diags.error_count, 2);
    assert_null(log.entries);
    fl_diags_deinit(&diags);
}

static void names_may_carry_prefixes_and_any_case(void **unused)
{
    (void)unused;
    const char *text = HEAD
        "# a comment\r\n\n1 key GLFW_KEY_PAGE_UP GLFW_PRESS GLFW_MOD_SHIFT\r\n1 key f12 Release\n"
        "1 button MOUSE_BUTTON_2 press ALT CONTROL\n2 snapshot my out.png 16";
    fl_diags diags = {0};
    vw_log log;
    assert_true(vw_log_parse(text, strlen(text), "a.log", &log, &diags));
    assert_int_equal(log.entry_count, 4);
    assert_string_equal(log.scene, "a scene.txt");
    assert_int_equal(log.entries[0].event.code, GLFW_KEY_PAGE_UP);
    assert_int_equal(log.entries[0].event.mods, GLFW_MOD_SHIFT);
    assert_int_equal(log.entries[1].event.code, GLFW_KEY_F12);
    assert_int_equal(log.entries[1].event.action, GLFW_RELEASE);
    assert_int_equal(log.entries[2].event.code, GLFW_MOUSE_BUTTON_RIGHT);
    assert_int_equal(log.entries[2].event.mods, GLFW_MOD_ALT | GLFW_MOD_CONTROL);
    assert_string_equal(log.entries[3].file, "my out.png");
    assert_int_equal(log.entries[3].samples, 16);
    vw_log_deinit(&log);
}

static void what_is_written_reads_back(void **unused)
{
    (void)unused;
    static const vw_event events[] = {
        {.kind = VW_EVENT_KEY,
         .code = GLFW_KEY_LEFT_BRACKET,
         .action = GLFW_REPEAT,
         .mods = GLFW_MOD_SHIFT},
        {.kind = VW_EVENT_BUTTON, .code = GLFW_MOUSE_BUTTON_MIDDLE, .action = GLFW_RELEASE},
        {.kind = VW_EVENT_CURSOR, .x = 0.1, .y = -317.0625},
        {.kind = VW_EVENT_SCROLL,
         .y = -0.30000000000000004,
         .mods = GLFW_MOD_CONTROL | GLFW_MOD_SUPER},
        {.kind = VW_EVENT_RESIZE, .width = 1, .height = 16384},
        {.kind = VW_EVENT_DROP, .path = "/some where/b.scene"},
        {.kind = VW_EVENT_RELOAD},
        {.kind = VW_EVENT_FOCUS},
        {.kind = VW_EVENT_AXIS, .code = GLFW_GAMEPAD_AXIS_LEFT_Y, .x = -0.53125},
        {.kind = VW_EVENT_PAD, .code = GLFW_GAMEPAD_BUTTON_DPAD_UP, .action = GLFW_PRESS},
        {.kind = VW_EVENT_ICONIFY, .action = GLFW_PRESS},
        {.kind = VW_EVENT_ICONIFY, .action = GLFW_RELEASE},
        {.kind = VW_EVENT_SCALE, .x = 1.5},
    };
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    vw_log_write_header(file, 640, 480, "a b.txt");
    for (size_t i = 0; i < FL_COUNT_OF(events); i++)
        vw_log_write_event(file, 10 * i, &events[i]);
    vw_log_write_snapshot(file, 200, "s t.exr", 7);
    vw_log_write_quit(file, 201);
    fclose(file);
    fl_diags diags = {0};
    vw_log log;
    assert_true(vw_log_parse(text, bytes, "a.log", &log, &diags));
    assert_int_equal(log.entry_count, FL_COUNT_OF(events) + 2);
    for (size_t i = 0; i < FL_COUNT_OF(events); i++) {
        const vw_event *got = &log.entries[i].event;
        assert_int_equal(log.entries[i].ms, 10 * i);
        assert_int_equal(got->kind, events[i].kind);
        assert_int_equal(got->code, events[i].code);
        assert_int_equal(got->action, events[i].action);
        assert_int_equal(got->mods, events[i].mods);
        assert_true(got->x == events[i].x && got->y == events[i].y);
        assert_int_equal(got->width, events[i].width);
        assert_int_equal(got->height, events[i].height);
        assert_string_equal(got->path, events[i].path);
    }
    assert_int_equal(log.entries[FL_COUNT_OF(events) + 1].kind, VW_LOG_QUIT);
    vw_log_deinit(&log);
    free(text);
}

static void every_name_finds_its_code(void **unused)
{
    (void)unused;
    int known = 0;
    for (int key = 0; key <= GLFW_KEY_LAST; key++) {
        const char *name = vw_key_name(key);
        known += name != NULL;
        if (name)
            assert_int_equal(vw_key_find(name, strlen(name)), key);
    }
    assert_int_equal(known, 120);
}

static void any_bytes_are_survived(void **unused)
{
    (void)unused;
    uint32_t seed = 7;
    print_message("seed %u\n", seed);
    static const char pieces[] =
        "firstlight-log 1 9x9 s\n1 key W press snapshot drop 2 quit \r\t#\0\xff";
    for (int round = 0; round < 3000; round++) {
        char text[96];
        size_t bytes = fl_lowbias32(++seed) % sizeof text;
        for (size_t i = 0; i < bytes; i++)
            text[i] = pieces[fl_lowbias32(++seed) % (sizeof pieces - 1)];
        if (round & 1 && bytes > 24)
            memcpy(text, "firstlight-log 1 9x9 s\n1 ", 24);
        fl_diags diags = {0};
        vw_log log;
        bool is_fine = vw_log_parse(text, bytes, "a.log", &log, &diags);
        assert_true(is_fine == (diags.error_count == 0));
        vw_log_deinit(&log);
        fl_diags_deinit(&diags);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_lines_are_located),
        cmocka_unit_test(all_errors_are_reported),
        cmocka_unit_test(names_may_carry_prefixes_and_any_case),
        cmocka_unit_test(what_is_written_reads_back),
        cmocka_unit_test(every_name_finds_its_code),
        cmocka_unit_test(any_bytes_are_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
