/* SPDX-License-Identifier: MIT
 *
 * fl_scene_map: whole scenes at other sizes and places give the same picture. The scenes are those
 * of tests/bytes, which use every feature that reaches a pixel.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "extremes/extreme_kit.h"

enum { SAMPLES = 4 };

static void render_mapped(film *out, const test_scene *test, double scale, fl_vec3 offset)
{
    fl_diags diags = {0};
    fl_scene *scene = film_parse(test->text, test->name);
    assert_non_null(scene);
    if (scale != 1.0 || fl_v3_max_abs(offset) > 0.0)
        assert_true(fl_scene_map(scene, scale, offset, &diags));
    fl_params params = film_params(test, scene);
    assert_true(film_render(out, scene, &params, SAMPLES));
    fl_diags_deinit(&diags);
    fl_scene_destroy(scene);
}

/* Every number is scaled exactly: so is every step of the arithmetic, and the film is the same
 * bytes. */
static void powers_of_two_are_the_same_bytes(void **state)
{
    static const double scales[] = {0x1p-20, 0x1p-3, 0x1p20};
    (void)state;
    for (uint32_t i = 0; i < test_scene_count; i++) {
        film plain, other;
        render_mapped(&plain, &test_scenes[i], 1.0, fl_v3(0, 0, 0));
        for (size_t k = 0; k < FL_COUNT_OF(scales); k++) {
            double largest;
            render_mapped(&other, &test_scenes[i], scales[k], fl_v3(0, 0, 0));
            uint32_t differ = film_differ(&other, &plain, 0.0, &largest);
            if (memcmp(other.rgb, plain.rgb,
                       (size_t)plain.width * plain.height * 3 * sizeof *plain.rgb) != 0)
                fail_msg("%s at %g: %u pixels differ, by up to %g", test_scenes[i].name, scales[k],
                         differ, largest);
            film_free(&other);
        }
        film_free(&plain);
    }
}

/* Elsewhere a few pixels on edges see the other side of them; no more than that. The most are 21 of
 * 1920, where triangles lie on one another. far_away is left out: seen from 1e6 away in floats
 * whose steps are 1/16 there, its own picture is rounding already. */
static void other_scales_and_places_differ_by_rounding(void **state)
{
    static const struct {
        double scale;
        fl_vec3 offset;
    } maps[] = {{1e-6, {0, 0, 0}},
                {1e6, {0, 0, 0}},
                {3.0, {0, 0, 0}},
                {1.0, {1000, -2000, 500}},
                {1.0, {1e7, -2e7, 5e6}}};
    (void)state;
    for (uint32_t i = 0; i < test_scene_count; i++) {
        film plain, other;
        if (strcmp(test_scenes[i].name, "far_away") == 0)
            continue;
        render_mapped(&plain, &test_scenes[i], 1.0, fl_v3(0, 0, 0));
        for (size_t k = 0; k < FL_COUNT_OF(maps); k++) {
            double largest;
            render_mapped(&other, &test_scenes[i], maps[k].scale, maps[k].offset);
            assert_int_equal(other.counts.invalid_samples, plain.counts.invalid_samples);
            uint32_t pixels = plain.width * plain.height;
            uint32_t differ = film_differ(&other, &plain, 1e-3, &largest);
            if (differ > pixels / 64)
                fail_msg("%s at %g + %g: %u of %u pixels differ, by up to %g", test_scenes[i].name,
                         maps[k].scale, maps[k].offset.x, differ, pixels, largest);
            film_free(&other);
        }
        film_free(&plain);
    }
}

static void meshes_and_views_are_carried_along(void **state)
{
    (void)state;
    static const char text[] =
        "firstlight 1\nPerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 40 "
        "aperture 0.1 focus 4 }\n"
        "Lights { DiskLight { position 1 2 3 direction 0 -1 0 radius 0.5 color 1 1 1 attenuation "
        "0.5 0.1 0.02 } }\n"
        "Materials { Material { diffuseColor 1 1 1 } }\n"
        "Group { MaterialIndex 0 TriangleMesh { file ring.obj } Plane { normal 0 2 0 offset -1 } "
        "}\n";
    fl_diags diags = {0};
    fl_scene *scene = film_parse(text, "carried");
    assert_non_null(scene);
    fl_mesh *mesh = fl_mesh_retain(scene->meshes[0].mesh);
    assert_true(fl_scene_map(scene, 4.0, fl_v3(1, 2, 3), &diags));
    fl_vec3 old = mesh->positions[0], new = scene->meshes[0].mesh->positions[0];
    assert_true(new.x == 4.0 * old.x &&new.y == 4.0 * old.y &&new.z == 4.0 * old.z);
    const fl_affine *m = &scene->transforms[scene->objects[0].transform];
    assert_true(m->m[0][3] == 1.0 && m->m[1][3] == 2.0 && m->m[2][3] == 3.0);
    assert_true(scene->camera.center.z == 23.0 && scene->camera.focus == 16.0 &&
                scene->camera.aperture == 0.4);
    assert_true(scene->lights[0].radius == 2.0 && scene->lights[0].attenuation[1] == 0.1 / 4.0 &&
                scene->lights[0].attenuation[2] == 0.02 / 16.0);
    /* 2 y = -1 becomes 2 y = 2 (4 * -0.5 + 2). */
    assert_true(scene->objects[1].as.plane.offset == 0.0);
    fl_mesh_release(mesh);
    fl_scene_destroy(scene);
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    static const double scales[] = {0.0, -1.0, HUGE_VAL};
    fl_scene *scene = film_parse(test_scenes[0].text, test_scenes[0].name);
    assert_non_null(scene);
    for (size_t k = 0; k < FL_COUNT_OF(scales); k++) {
        fl_diags diags = {0};
        assert_false(fl_scene_map(scene, scales[k], fl_v3(0, 0, 0), &diags));
        assert_int_equal(diags.count, 1);
        fl_diags_deinit(&diags);
    }
    fl_scene_destroy(scene);
}

/* A ball of `radius` at x, and something as far on the other side; how many warnings. */
static uint32_t warnings(double x, double radius, bool in_double, const char *expected)
{
    char text[512];
    fl_diags diags = {0};
    snprintf(text, sizeof text,
             "firstlight 1\nMaterials { Material { } }\nGroup { MaterialIndex 0\n"
             "Sphere { center %.17g 0 0 radius %.17g }\n"
             "Sphere { center -%.17g 0 0 radius %.17g } }\n",
             x, radius, x, 0.1 * x);
    fl_scene *scene = film_parse(text, "far");
    assert_non_null(scene);
    fl_compiled *compiled =
        fl_compile(scene, &(fl_compile_options){.in_double = in_double}, NULL, &diags);
    assert_non_null(compiled);
    uint32_t count = diags.warning_count;
    assert_int_equal(diags.count, count);
    if (count > 0) {
        assert_non_null(strstr(diags.items[0].message, expected));
        assert_non_null(strstr(diags.items[0].message, "--precision double"));
        assert_int_equal(diags.items[0].loc.line, 4);
    }
    fl_compiled_release(compiled);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    return count;
}

/* An object of 8,192 steps of a float is shown well: the ball ends at 2^10, where they are 2^-13.
 */
static void what_floats_cannot_place_is_warned_of(void **state)
{
    (void)state;
    assert_int_equal(warnings(1023.5, 0.5, false, ""), 0);
    assert_int_equal(warnings(1023.6, 0.5, false, "1 object is too small"), 1);
    assert_int_equal(warnings(1023.6e6, 0.5e6, false, "8.19e+03 steps"), 1);
    assert_int_equal(warnings(1e7, 0.5, false, "0.839 steps"), 1);
    assert_int_equal(warnings(1e7, 0.5, true, ""), 0);
}

/* Where it was written, so that nothing but the place can differ. */
static void mean_of(const char *objects, double far, double *out_mean)
{
    char text[1024];
    film picture;
    snprintf(
        text, sizeof text,
        "firstlight 1\nPerspectiveCamera { center %.17g 0 4 direction 0 0 -1 up 0 1 0 angle 40 "
        "}\nLights { PointLight { position %.17g 3 5 color 1 1 1 } }\nMaterials { Material { "
        "diffuseColor 0.7 0.7 0.7 specularColor 0.5 0.5 0.5 shininess 20 } }\nGroup { "
        "MaterialIndex 0 %s Sphere { center %.17g 0 0 radius %.17g } }\n",
        far, far + 2.0, objects, -far - 10.0, 0.01 * far + 1.0);
    fl_scene *scene = film_parse(text, "place");
    fl_params params;
    assert_non_null(scene);
    fl_params_from_scene(&params, scene, false);
    params.width = 24;
    params.height = 18;
    params.precision = FL_PRECISION_DOUBLE;
    assert_true(film_render(&picture, scene, &params, SAMPLES));
    *out_mean = 0.0;
    for (size_t i = 0; i < (size_t)24 * 18 * 3; i++)
        *out_mean += (double)picture.rgb[i];
    film_free(&picture);
    fl_scene_destroy(scene);
}

/* Vertices are rounded near their own mesh, not where floats are a whole unit apart: loose
 * triangles and meshes that need no transform moved by up to 1/2 there (decision 060). */
static void vertices_far_from_all_else_stay_in_place(void **state)
{
    (void)state;
    static const double fars[] = {1e5, 1e7};
    const char *shape = "Triangle { vertex0 %.17g -1 0.3 vertex1 %.17g -0.9 0 vertex2 %.17g 1.1 "
                        "-0.2 }";
    for (size_t i = 0; i < FL_COUNT_OF(fars); i++) {
        char near[256], far[256];
        double x = fars[i], want, got;
        snprintf(near, sizeof near, shape, -1.25, 1.125, 0.375);
        snprintf(far, sizeof far, shape, x - 1.25, x + 1.125, x + 0.375);
        mean_of(near, 0.0, &want);
        mean_of(far, x, &got);
        if (!(fabs(got - want) <= 1e-6 * want))
            fail_msg("at %g the picture's sum is %g, not %g", x, got, want);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(powers_of_two_are_the_same_bytes),
        cmocka_unit_test(other_scales_and_places_differ_by_rounding),
        cmocka_unit_test(meshes_and_views_are_carried_along),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(what_floats_cannot_place_is_warned_of),
        cmocka_unit_test(vertices_far_from_all_else_stay_in_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
