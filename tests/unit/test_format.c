/* SPDX-License-Identifier: MIT
 *
 * Formatting: the same scene, in our dialect, with its comments. Over real files: test_wild.c.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/format.h"
#include "support/scene_dump.h"

#ifndef FL_SOURCE_DIR
#define FL_SOURCE_DIR "."
#endif
#define SCENES FL_SOURCE_DIR "/tests/scene"

static char *format(const char *text, bool is_lenient)
{
    fl_diags diags = {0};
    fl_parse_options options = {.is_lenient = is_lenient};
    size_t bytes = 0;
    char *formatted = fl_scene_format(text, strlen(text), "a", &options, &bytes, &diags);
    assert_true((formatted == NULL) == (diags.error_count > 0));
    if (formatted)
        assert_int_equal(bytes, strlen(formatted));
    fl_diags_deinit(&diags);
    return formatted;
}

static char *dump_of(const char *text, bool is_lenient)
{
    fl_diags diags = {0};
    fake_files fake;
    fake_files_init(&fake);
    fl_parse_options options = {.is_lenient = is_lenient};
    fl_scene *scene = fl_scene_parse(text, strlen(text), "a", &options, &fake.files, &diags);
    char *dump = scene ? scene_dump(scene) : NULL;
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    return dump;
}

static void assert_same_scene(const char *text, bool is_lenient)
{
    char *formatted = format(text, is_lenient);
    assert_non_null(formatted);
    char *want = dump_of(text, is_lenient), *got = dump_of(formatted, false);
    assert_non_null(want);
    assert_non_null(got);
    assert_string_equal(got, want);
    char *again = format(formatted, false);
    assert_string_equal(again, formatted);
    free(again);
    free(formatted);
    free(want);
    free(got);
}

static void assert_formats_to(const char *text, const char *expected)
{
    char *formatted = format(text, false);
    assert_non_null(formatted);
    assert_string_equal(formatted, expected);
    free(formatted);
    assert_same_scene(text, false);
}

static void test_layout(void **state)
{
    (void)state;
    assert_formats_to("firstlight 1 # first\n"
                      "# about the group\n"
                      "Group{numObjects 1 # one\n"
                      "  # before\n\n\n"
                      "  Transform { Scale 1.0 +2 3e0 # big\n"
                      "    # inside\n"
                      "    RevSurface { profile BezierCurve { controls [1 0 0] # a\n"
                      "    [ 2 1.50 0 ] } } # end\n"
                      "  }\n"
                      "}\n"
                      "# last",
                      "firstlight 1 # first\n"
                      "# about the group\n"
                      "Group {\n"
                      "    numObjects 1 # one\n"
                      "    # before\n"
                      "\n"
                      "    Transform {\n"
                      "        Scale 1 2 3 # big\n"
                      "        # inside\n"
                      "        RevSurface {\n"
                      "            profile\n"
                      "            BezierCurve {\n"
                      "                controls\n"
                      "                    [ 1 0 0 ]\n"
                      "                    [ 2 1.5 0 ] # a\n"
                      "            }\n"
                      "        } # end\n"
                      "    }\n"
                      "}\n"
                      "# last\n");
}

static void test_empty(void **state)
{
    (void)state;
    assert_formats_to("firstlight 1", "firstlight 1\n");
    assert_formats_to("firstlight 1\n  # only this", "firstlight 1\n# only this\n");
}

static void test_courses_in_our_words(void **state)
{
    (void)state;
    assert_formats_to("OrthographicCamera { center 0 0 1 direction 0 0 -1 up 0 1 0 size 5 }\n"
                      "Materials { numMaterials 1 PhongMaterial { # glass\n"
                      "transparentColor 1 1 1 exponent 9 } }\n"
                      "Group { numObjects 1 MaterialIndex 0\n"
                      "TriangleMesh { obj_file a.obj } }",
                      "firstlight 1\n"
                      "\n"
                      "OrthographicCamera {\n"
                      "    center 0 0 1\n"
                      "    direction 0 0 -1\n"
                      "    up 0 1 0\n"
                      "    size 5\n"
                      "}\n"
                      "\n"
                      "Materials {\n"
                      "    numMaterials 1\n"
                      "    PhongMaterial {\n"
                      "        diffuseColor 1 1 1\n"
                      "        shininess 9\n"
                      "        refract 1 1 1\n"
                      "        # glass\n"
                      "    }\n"
                      "}\n"
                      "\n"
                      "Group {\n"
                      "    numObjects 1\n"
                      "    MaterialIndex 0\n"
                      "    TriangleMesh {\n"
                      "        obj_file a.obj\n"
                      "        normals flat\n"
                      "    }\n"
                      "}\n"
                      "\n"
                      "Background {\n"
                      "    ambientLight 1 1 1\n"
                      "}\n");
}

static void test_m12(void **state)
{
    (void)state;
    char *formatted =
        format("PerspectiveCamera { center 0 0 1 direction 0 0 -1 up 0 1 0 angle 5 }\n"
               "Lights { PointLight { position 0 0 0 color 1 1 1 falloff 2 } }\n"
               "Materials { Material { specularColor 1 1 1 refractionIndex 3 bump b.bmp } }",
               false);
    assert_non_null(formatted);
    static const char *const lines[] = {"attenuation 0 0 2\n", "reflect 0.25 0.25 0.25\n",
                                        "refract 0.75 0.75 0.75\n", "refractionIndex 3\n",
                                        "# bump b.bmp\n"};
    for (size_t i = 0; i < FL_COUNT_OF(lines); i++)
        assert_non_null(strstr(formatted, lines[i]));
    free(formatted);
}

/* What a lenient reader leaves out is left out, and the counts are right again. */
static void test_lenient(void **state)
{
    (void)state;
    static const char text[] =
        "PerspectiveCamera { center 0 0 1 direction 0 0 -1 up 0 1 0 angle 5 width 3 height 3 glow "
        "1 }\n"
        "Materials { numMaterials 5 Glow { color 0 1 0 } Material { } }\n"
        "Group { numObjects 9 Torus { } MaterialIndex 0 Transform { Scale 1 1 1 Torus { } }\n"
        "Transform { Scale 2 2 2 Sphere { center 0 0 0 radius 1 speed 3 } } }";
    char *formatted = format(text, true);
    assert_non_null(strstr(formatted, "numObjects 1\n"));
    assert_non_null(strstr(formatted, "numMaterials 2\n"));
    assert_null(strstr(formatted, "Torus"));
    free(formatted);
    assert_same_scene(text, true);
    assert_null(format(text, false));
}

static void test_last_wins(void **state)
{
    (void)state;
    assert_same_scene(
        "PerspectiveCamera { center 0 0 1 direction 0 0 -1 up 0 1 0 angle 5 width 3 height 3 }\n"
        "Lights { DirectionalLight { direction 0 0 1 color 1 1 1 } } Lights { }\n"
        "Materials { Material { shininess 1 } } Materials { Material { shininess 2 "
        "shininess 3 } } Group { Sphere { center 0 0 0 radius 1 } } Group { MaterialIndex 0 "
        "Plane { normal 0 1 0 offset 1 } }",
        false);
}

/* Every scene beside the parser's expectations, where it parses. */
static void test_expectation_scenes(void **state)
{
    (void)state;
    DIR *folder = opendir(SCENES);
    assert_non_null(folder);
    unsigned checked = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        char path[1024], text[65536];
        snprintf(path, sizeof path, "%s/%s", SCENES, entry->d_name);
        FILE *file = strstr(entry->d_name, ".scene") ? fopen(path, "rb") : NULL;
        if (!file)
            continue;
        size_t bytes = fread(text, 1, sizeof text - 1, file);
        text[bytes] = '\0';
        fclose(file);
        char *dump = strlen(text) == bytes ? dump_of(text, true) : NULL;
        if (dump) {
            assert_same_scene(text, true);
            checked++;
        }
        free(dump);
    }
    closedir(folder);
    print_message("%u scenes\n", checked);
    assert_true(checked >= 15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_layout),
                                       cmocka_unit_test(test_empty),
                                       cmocka_unit_test(test_courses_in_our_words),
                                       cmocka_unit_test(test_m12),
                                       cmocka_unit_test(test_lenient),
                                       cmocka_unit_test(test_last_wins),
                                       cmocka_unit_test(test_expectation_scenes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
