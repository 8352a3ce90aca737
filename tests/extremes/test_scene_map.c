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
    } maps[] = {{1e-6, {0, 0, 0}}, {1e6, {0, 0, 0}}, {3.0, {0, 0, 0}}, {1.0, {1000, -2000, 500}}};
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(powers_of_two_are_the_same_bytes),
        cmocka_unit_test(other_scales_and_places_differ_by_rounding),
        cmocka_unit_test(meshes_and_views_are_carried_along),
        cmocka_unit_test(nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
