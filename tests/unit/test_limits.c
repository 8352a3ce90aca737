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

/* A ray of light through `count` panes of clear glass, in both precisions. */
static void expect_light(uint32_t count, float expected, uint64_t stopped)
{
    fl_diags diags = {0};
    char *text = repeat("Render { depth 0 transparentShadows 1 }\n"
                        "PerspectiveCamera { center 0 -0.5 2 direction 0 -0.5 -2 up 0 1 0 angle 5 "
                        "width 1 height 1 }\n"
                        "Lights { DirectionalLight { direction 0 -1 0 color 1 1 1 } }\n"
                        "Materials { Material { } Material { diffuseColor 0 0 0 refract 1 1 1 } }\n"
                        "Group { Square { corner -9 -1 9 u 18 0 0 v 0 0 -18 } MaterialIndex 1\n",
                        "Square { corner -9 @ 9 u 18 0 0 v 0 0 -18 }", count, "}");
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), "panes", &(fl_parse_options){0}, NULL, &diags);
    assert_non_null(scene);
    fl_compiled *compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, &diags);
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = 1}, &diags);
    assert_non_null(render);
    fl_render_set_limits(render, &(fl_render_limits){.samples = 1});
    fl_params params;
    fl_params_from_scene(&params, scene, false);
    for (int is_double = 0; is_double < 2; is_double++) {
        float rgb[3];
        fl_progress progress;
        params.precision = is_double ? FL_PRECISION_DOUBLE : FL_PRECISION_FLOAT;
        assert_true(fl_render_restart(render, compiled, &params, &diags));
        assert_true(fl_render_wait(render, -1.0));
        assert_true(fl_render_mean(render, rgb, 3, &progress));
        assert_true(rgb[0] == expected);
        assert_int_equal(progress.counts.shadow_rays, 1);
        assert_int_equal(progress.counts.stopped_shadow_rays, stopped);
    }
    fl_render_destroy(render);
    fl_compiled_release(compiled);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    free(text);
}

static void test_shadow_surfaces(void **state)
{
    (void)state;
    expect_light(FL_SHADOW_SURFACES_MAX, 1.0f, 0);
    expect_light(FL_SHADOW_SURFACES_MAX + 1, 0.0f, 1);
}

/* --- Memory of files, from files that are not there ------------------------------------------ */

typedef struct large_files {
    uint32_t face_count;
    uint32_t image_side;
    uint32_t loaded;
} large_files;

static bool find_large(void *context, const char *scene_path, const char *reference, char *out_path,
                       size_t out_bytes)
{
    (void)context, (void)scene_path;
    return snprintf(out_path, out_bytes, "%s", reference) < (int)out_bytes;
}

/* Only the counts are large. */
static fl_mesh *load_large_mesh(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)path, (void)loc, (void)diags;
    large_files *files = context;
    fl_mesh *mesh = fl_mesh_create();
    assert_non_null(mesh);
    mesh->face_count = files->face_count;
    files->loaded++;
    return mesh;
}

static fl_image *load_large_image(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)path, (void)loc, (void)diags;
    large_files *files = context;
    fl_image *image = fl_image_create(1, 1, FL_PIXEL_FLOAT);
    assert_non_null(image);
    image->width = image->height = files->image_side;
    files->loaded++;
    return image;
}

static void expect_large(large_files *from, char *text, uint32_t loaded, const char *message)
{
    fl_diags diags = {0};
    const fl_files files = {from, find_large, load_large_mesh, load_large_image};
    from->loaded = 0;
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), "large", &(fl_parse_options){0}, &files, &diags);
    assert_int_equal(from->loaded, loaded);
    assert_int_equal(diags.error_count, message ? 1 : 0);
    assert_true(!scene == (message != NULL));
    if (message) {
        assert_string_equal(diags.items[0].message, message);
        assert_int_equal(diags.items[0].cause, FL_CAUSE_INPUT);
        assert_true(diags.items[0].loc.line > 1);
    }
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    free(text);
}

static void test_scene_memory(void **state)
{
    (void)state;
    static const char mesh[] = "TriangleMesh { file m@ }", image[] = "Material { texture t@ }";
    /* A file that alone takes a fourth: four fit, the fifth does not, the sixth is not read. */
    const uint64_t fourth = FL_SCENE_MEMORY_LIMIT / 4;
    const uint32_t face_bytes = sizeof(fl_face) + FL_FACE_MEMORY_ESTIMATE;
    large_files files = {.face_count = (uint32_t)(fourth / face_bytes), .image_side = 26754};
    assert_int_equal(FL_SCENE_MEMORY_LIMIT, 34359738368);
    expect_large(&files, repeat("Group {", mesh, 4, "}"), 4, NULL);
    expect_large(&files, repeat("Group {", mesh, 6, "}"), 5,
                 "with 'm4' the meshes and pictures of the scene need 42949672390 bytes of memory, "
                 "at most 34359738368");
    expect_large(&files, repeat("Materials {", image, 4, "}"), 4, NULL);
    expect_large(&files, repeat("Materials {", image, 6, "}"), 5,
                 "with 't4' the meshes and pictures of the scene need 42946590960 bytes of memory, "
                 "at most 34359738368");
    expect_large(
        &files,
        repeat("Materials { Material { texture t } } Group { MaterialIndex 0 ", mesh, 5, "}"), 5,
        "with 'm3' the meshes and pictures of the scene need 42949056104 bytes of memory, "
        "at most 34359738368");
}

static void test_faces(void **state)
{
    (void)state;
    large_files files = {.face_count = FL_FACES_MAX};
    static const char text[] = "firstlight 1\nGroup { TriangleMesh { file m } }";
    expect_large(&files, strcpy(malloc(sizeof text), text), 1, NULL);
    files.face_count++;
    expect_large(&files, strcpy(malloc(sizeof text), text), 1,
                 "mesh 'm' is too large: 268435457 triangles, at most 268435456");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_views),          cmocka_unit_test(test_files),
        cmocka_unit_test(test_picture_memory), cmocka_unit_test(test_shadow_surfaces),
        cmocka_unit_test(test_scene_memory),   cmocka_unit_test(test_faces)};
    return cmocka_run_group_tests_name("limits", tests, NULL, NULL);
}
