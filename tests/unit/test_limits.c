/* SPDX-License-Identifier: MIT
 *
 * Limits that no other test crosses: one more than allowed is refused with a sentence that names
 * the limit, and what is allowed is not.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/firstlight.h"
#include "support/scene_dump.h"

enum { TEXT_BYTES = 4 << 20 };

/* `before`, then `count` times `format` with its number, then `after`. From malloc. */
static char *repeat(const char *before, const char *format, uint32_t count, const char *after)
{
    char *text = malloc(TEXT_BYTES);
    assert_non_null(text);
    int bytes = snprintf(text, TEXT_BYTES, "firstlight 1\n%s", before);
    for (uint32_t i = 0; i < count; i++) {
        char number[16];
        const char *gap = strchr(format, '@');
        snprintf(number, sizeof number, "%u", i);
        bytes += snprintf(text + bytes, TEXT_BYTES - (size_t)bytes, "%.*s%s%s\n",
                          (int)(gap - format), format, number, gap + 1);
    }
    snprintf(text + bytes, TEXT_BYTES - (size_t)bytes, "%s", after);
    return text;
}

static void expect(char *text, const char *message)
{
    fl_diags diags = {0};
    fake_files files;
    fake_files_init(&files);
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), "limits", &(fl_parse_options){0}, &files.files, &diags);
    if (message) {
        assert_null(scene);
        assert_true(diags.count > 0);
        assert_string_equal(diags.items[0].message, message);
        assert_int_equal(diags.items[0].cause, FL_CAUSE_INPUT);
    } else {
        assert_non_null(scene);
    }
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    free(text);
}

static void test_views(void **state)
{
    (void)state;
    static const char view[] = "View v@ { center 0 0 1 direction 0 0 -1 up 0 1 0 angle 9 }";
    expect(repeat("", view, FL_VIEWS_MAX, ""), NULL);
    expect(repeat("", view, FL_VIEWS_MAX + 1, ""),
           "a scene text holds at most 256 views, this one 257");
}

static void test_files(void **state)
{
    (void)state;
    static const char mesh[] = "TriangleMesh { file m@ }", material[] = "Material { texture t@ }";
    expect(repeat("Group {", mesh, FL_FILES_MAX, "}"), NULL);
    expect(repeat("Group {", mesh, FL_FILES_MAX + 1, "}"),
           "a scene names at most 4096 different meshes");
    expect(repeat("Materials {", material, FL_FILES_MAX, "}"), NULL);
    expect(repeat("Materials {", material, FL_FILES_MAX + 1, "}"),
           "a scene names at most 4096 different pictures");
}

static void test_picture_memory(void **state)
{
    (void)state;
    static const char text[] =
        "firstlight 1\nPerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n";
    fl_diags diags = {0};
    fl_params params;
    fl_scene *scene =
        fl_scene_parse(text, sizeof text - 1, "s", &(fl_parse_options){0}, NULL, &diags);
    fl_compiled *compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, &diags);
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = 1}, &diags);
    assert_non_null(render);
    fl_params_from_scene(&params, scene, false);
    params.width = params.height = FL_SIDE_MAX;
    assert_false(fl_render_restart(render, compiled, &params, &diags));
    char needs[] = "rendering 16384 x 16384 pixels needs ";
    assert_memory_equal(diags.items[0].message, needs, sizeof needs - 1);
    assert_non_null(strstr(diags.items[0].message, "the memory limit is 8589934592"));
    assert_int_equal(diags.items[0].cause, FL_CAUSE_ENVIRONMENT);
    fl_render_destroy(render);
    fl_compiled_release(compiled);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_views), cmocka_unit_test(test_files),
                                       cmocka_unit_test(test_picture_memory)};
    return cmocka_run_group_tests_name("limits", tests, NULL, NULL);
}
