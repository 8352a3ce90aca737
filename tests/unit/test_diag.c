/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <string.h>

#include "core/diag.h"

static const char scene[] = "Group {\n\tSphere {\r\n    radious 0.5\n\xc3\xa9 x\n}";

static void assert_format(const fl_diag *diag, const char *expected)
{
    char text[512];
    size_t bytes = fl_diag_format(diag, text, sizeof text);
    assert_string_equal(text, expected);
    assert_int_equal(bytes, strlen(expected));
}

static void test_located(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_diags_set_text(&diags, "a.scene", scene, strlen(scene));
    assert_false(fl_error(&diags, (fl_loc){"a.scene", 3, 5, 7}, "unknown key '%s'", "radious"));
    fl_note(&diags, (fl_loc){"a.scene", 2, 2, 6}, "this 'Sphere' begins here");
    fl_warning(&diags, (fl_loc){"a.scene", 4, 4, 0}, "after two bytes that are one letter");
    assert_int_equal(diags.count, 3);
    assert_int_equal(diags.error_count, 1);
    assert_int_equal(diags.warning_count, 1);
    assert_format(&diags.items[0], "a.scene:3:5: error: unknown key 'radious'\n"
                                   "    3 |     radious 0.5\n"
                                   "      |     ^~~~~~~");
    assert_format(&diags.items[1], "a.scene:2:2: note: this 'Sphere' begins here\n"
                                   "    2 | \tSphere {\n"
                                   "      | \t^~~~~~");
    assert_format(&diags.items[2], "a.scene:4:4: warning: after two bytes that are one letter\n"
                                   "    4 | \xc3\xa9 x\n"
                                   "      |   ^");
    assert_int_equal(diags.items[0].cause, FL_CAUSE_INPUT);
    fl_diags_deinit(&diags);
    assert_int_equal(diags.count, 0);
}

static void test_places_without_text(void **state)
{
    (void)state;
    fl_diags diags = {0};
    char name[] = "b.obj";
    fl_diags_set_text(&diags, "a.scene", scene, strlen(scene));
    fl_error(&diags, (fl_loc){name, 3, 1, 1}, "another file");
    fl_error(&diags, (fl_loc){.file = name}, "the file as a whole");
    fl_error(&diags, (fl_loc){"a.scene", 99, 1, 1}, "no such line");
    fl_error(&diags, (fl_loc){"a.scene", 1, 99, 1}, "no such column");
    fl_out_of_memory(&diags, "the tree");
    name[0] = 'x'; /* the list keeps its own copy */
    assert_format(&diags.items[0], "b.obj:3:1: error: another file");
    assert_format(&diags.items[1], "b.obj: error: the file as a whole");
    assert_format(&diags.items[2], "a.scene:99:1: error: no such line");
    assert_format(&diags.items[3], "a.scene:1:99: error: no such column");
    assert_format(&diags.items[4], "error: out of memory for the tree");
    assert_int_equal(diags.items[4].cause, FL_CAUSE_ENVIRONMENT);
    fl_diags_deinit(&diags);
}

static void test_caret_at_the_end(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_diags_set_text(&diags, "a", "Group {", 7);
    fl_error(&diags, (fl_loc){"a", 1, 8, 0}, "the text ends");
    fl_error(&diags, (fl_loc){"a", 1, 7, 500}, "too long");
    assert_format(&diags.items[0],
                  "a:1:8: error: the text ends\n    1 | Group {\n      |        ^");
    assert_format(&diags.items[1], "a:1:7: error: too long\n    1 | Group {\n      |       ^");
    fl_diags_deinit(&diags);
}

static void test_bounded(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_loc loc = {"a", 1, 1, 1};
    for (int i = 0; i < FL_DIAGS_MAX + 10; i++)
        fl_error(&diags, loc, "error %d", i);
    fl_warning(&diags, loc, "no room");
    fl_note(&diags, loc, "no room either");
    assert_int_equal(diags.count, FL_DIAGS_MAX);
    assert_int_equal(diags.error_count, FL_DIAGS_MAX + 10);
    assert_int_equal(diags.dropped_count, 11);
    assert_string_equal(diags.items[FL_DIAGS_MAX - 1].message, "error 31");
    fl_diags_deinit(&diags);
}

/* A list full of warnings still shows an error that comes later. */
static void test_errors_displace_warnings(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_loc loc = {"a", 1, 1, 1};
    for (int i = 0; i < FL_DIAGS_MAX / 2; i++) {
        fl_warning(&diags, loc, "warning %d", i);
        fl_note(&diags, loc, "note %d", i);
    }
    fl_error(&diags, loc, "the error");
    assert_int_equal(diags.count, FL_DIAGS_MAX - 1);
    assert_int_equal(diags.dropped_count, 1);
    assert_string_equal(diags.items[FL_DIAGS_MAX - 2].message, "the error");
    assert_string_equal(diags.items[FL_DIAGS_MAX - 3].message, "note 14");
    fl_diags_deinit(&diags);
}

static void test_cut_and_cleaned(void **state)
{
    (void)state;
    fl_diags diags = {0};
    char name[2000];
    memset(name, 'x', sizeof name);
    name[sizeof name - 1] = '\0';
    name[3] = '\x1b';
    fl_error(&diags, (fl_loc){"a", 1, 1, 1}, "name %s", name);
    assert_int_equal(strlen(diags.items[0].message), 511);
    assert_memory_equal(diags.items[0].message, "name xxx?xxx", 12);
    char small[10];
    assert_true(fl_diag_format(&diags.items[0], small, sizeof small) > 500);
    assert_string_equal(small, "a:1:1: er");
    assert_true(fl_diag_format(&diags.items[0], NULL, 0) > 500);
    fl_diags_deinit(&diags);
}

static void test_nearest_name(void **state)
{
    (void)state;
    static const char *const names[] = {"radius", "center", "Sphere", "Scale", "up", "u"};
    static const struct {
        const char *word, *nearest;
    } cases[] = {
        {"radious", "radius"}, {"raduis", "radius"}, {"RADIUS", NULL},  {"Radius", "radius"},
        {"cemtre", "center"},  {"sphere", "Sphere"}, {"pu", "up"},      {"x", NULL},
        {"scale", "Scale"},    {"", NULL},           {"texture", NULL}, {"uu", "up"}};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        const char *got =
            fl_nearest_name(cases[i].word, strlen(cases[i].word), names, FL_COUNT_OF(names));
        if (!cases[i].nearest)
            assert_null(got);
        else
            assert_string_equal(got, cases[i].nearest);
    }
    char word[300];
    memset(word, 'r', sizeof word);
    assert_null(fl_nearest_name(word, sizeof word, names, FL_COUNT_OF(names)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_located),
                                       cmocka_unit_test(test_places_without_text),
                                       cmocka_unit_test(test_caret_at_the_end),
                                       cmocka_unit_test(test_bounded),
                                       cmocka_unit_test(test_errors_displace_warnings),
                                       cmocka_unit_test(test_cut_and_cleaned),
                                       cmocka_unit_test(test_nearest_name)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
