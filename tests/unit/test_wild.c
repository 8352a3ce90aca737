/* SPDX-License-Identifier: MIT
 *
 * Scene files that others wrote for their courses: what a course's parser reads, ours reads, in
 * that course's dialect; the rest parses or gives a located error; and what parses survives
 * formatting unchanged. Needs the shared data; skipped without it.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/format.h"
#include "support/scene_dump.h"

#ifndef FL_SHARED_DIR
#define FL_SHARED_DIR "../shared"
#endif
#define WILD FL_SHARED_DIR "/scenes-wild/"

enum { LINE_BYTES = 1024, FIELDS = 6 };

typedef struct tally {
    unsigned scenes, course, course_strict, course_lenient, course_failed;
    unsigned other, other_strict, other_lenient, formatted;
} tally;

static char *read_file(const char *path, size_t *out_bytes)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    fseek(file, 0, SEEK_END);
    long bytes = ftell(file);
    rewind(file);
    char *text = malloc((size_t)bytes + 1);
    *out_bytes = text ? fread(text, 1, (size_t)bytes, file) : 0;
    fclose(file);
    return text;
}

static void print_diags(const fl_diags *diags)
{
    char text[1024];
    for (uint32_t i = 0; i < diags->count && i < 4; i++) {
        fl_diag_format(&diags->items[i], text, sizeof text);
        print_message("  %s\n", text);
    }
}

/* Parse, format, parse: the same scene; format again: the same text. */
static void check_format(const char *text, size_t bytes, const char *path, bool is_lenient,
                         const fl_scene *scene, const fl_files *files)
{
    fl_parse_options options = {.is_lenient = is_lenient}, strict = {0};
    fl_diags diags = {0};
    size_t ours_bytes = 0, again_bytes = 0;
    char *ours = fl_scene_format(text, bytes, path, &options, &ours_bytes, &diags);
    assert_non_null(ours);
    fl_diags_deinit(&diags);
    fl_scene *back = fl_scene_parse(ours, ours_bytes, path, &strict, files, &diags);
    if (!back)
        print_diags(&diags);
    assert_non_null(back);
    assert_int_equal(back->dialect, FL_DIALECT_FIRSTLIGHT);
    char *want = scene_dump(scene), *got = scene_dump(back);
    if (strcmp(want, got) != 0)
        print_message("%s changed by formatting\n", path);
    assert_string_equal(want, got);
    char *again = fl_scene_format(ours, ours_bytes, path, &strict, &again_bytes, &diags);
    assert_non_null(again);
    assert_string_equal(again, ours);
    free(want);
    free(got);
    free(ours);
    free(again);
    fl_scene_destroy(back);
    fl_diags_deinit(&diags);
}

/* Whether it parsed. Wrong texts must say where they are wrong; *out_is_procedural: the first error
 * is about a procedural material, the one thing of the courses that we do not draw. */
static bool try_parse(const char *text, size_t bytes, const char *path, bool is_lenient,
                      fl_dialect *out_dialect, bool *out_is_procedural, tally *t)
{
    fake_files fake;
    fake_files_init(&fake);
    fl_diags diags = {0};
    fl_parse_options options = {.is_lenient = is_lenient};
    fl_scene *scene = fl_scene_parse(text, bytes, path, &options, &fake.files, &diags);
    bool is_parsed = scene != NULL;
    if (scene) {
        assert_int_equal(diags.error_count, 0);
        *out_dialect = scene->dialect;
        check_format(text, bytes, path, is_lenient, scene, &fake.files);
        t->formatted++;
        fl_scene_destroy(scene);
    } else {
        assert_true(diags.error_count > 0);
        uint32_t first = 0;
        while (diags.items[first].severity != FL_ERROR)
            first++;
        assert_true(diags.items[first].loc.line > 0 && diags.items[first].loc.column > 0);
        assert_string_equal(diags.items[first].loc.file, path);
        *out_is_procedural = strstr(diags.items[first].message, "procedural material");
        if (getenv("FL_WILD_VERBOSE")) {
            print_message("%s%s\n", path, is_lenient ? " (lenient)" : "");
            print_diags(&diags);
        }
    }
    fl_diags_deinit(&diags);
    return is_parsed;
}

/* Whether the dialect is one of the course parsers that read the file ("mit12+mit04"). */
static bool is_read_by(const char *readers, fl_dialect dialect)
{
    static const char *const names[FL_DIALECT_COUNT] = {"-", "pa", "mit04", "mit12"};
    return strstr(readers, names[dialect]) != NULL;
}

static void check_scene(const char *path, const char *readers, tally *t)
{
    char full[2 * LINE_BYTES];
    size_t bytes = 0;
    snprintf(full, sizeof full, "%s%s", WILD, path);
    char *text = read_file(full, &bytes);
    assert_non_null(text);
    bool is_course = strncmp(readers, "extended", 8) != 0;
    fl_dialect dialect = FL_DIALECT_FIRSTLIGHT;
    bool is_procedural = false, ignored;
    bool is_strict = try_parse(text, bytes, path, false, &dialect, &is_procedural, t);
    bool is_lenient = is_strict || try_parse(text, bytes, path, true, &dialect, &ignored, t);
    if (is_course && is_lenient && !is_read_by(readers, dialect))
        fail_msg("%s: read as %s, but it is for %s", path, fl_dialect_names[dialect], readers);
    t->scenes++;
    t->course += is_course;
    t->course_strict += is_course && is_strict;
    t->course_lenient += is_course && is_lenient && !is_strict;
    t->other += !is_course;
    t->other_strict += !is_course && is_strict;
    t->other_lenient += !is_course && is_lenient && !is_strict;
    if (is_course && !is_strict && !is_procedural)
        fail_msg("%s: not read for another reason than a procedural material", path);
    if (is_course && !is_lenient)
        fail_msg("%s: not read even leniently", path);
    free(text);
}

static void test_wild_scenes(void **state)
{
    (void)state;
    FILE *index = fopen(WILD "INDEX.tsv", "r");
    if (!index)
        skip();
    char line[LINE_BYTES];
    tally t = {0};
    while (fgets(line, sizeof line, index)) {
        char *fields[FIELDS] = {line};
        for (int i = 1; i < FIELDS; i++) {
            fields[i] = strchr(fields[i - 1], '\t');
            assert_non_null(fields[i]);
            *fields[i]++ = '\0';
        }
        if (strcmp(fields[1], "scene") == 0)
            check_scene(fields[0], fields[3], &t);
    }
    fclose(index);
    print_message("%u scenes; %u read by a course parser: %u strict, %u lenient; %u others: "
                  "%u strict, %u lenient; %u formatted\n",
                  t.scenes, t.course, t.course_strict, t.course_lenient, t.other, t.other_strict,
                  t.other_lenient, t.formatted);
    assert_int_equal(t.scenes, 912);
    assert_int_equal(t.course, 397);
    assert_int_equal(t.course_strict, 357);
    assert_int_equal(t.course_lenient, 40);
    assert_int_equal(t.other, 515);
    assert_int_equal(t.other_strict, 4);
    assert_int_equal(t.other_lenient, 471);
    assert_int_equal(t.formatted, 872);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_wild_scenes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
