/* SPDX-License-Identifier: MIT */
#include "support/isect_world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The message of the only error, at `line`; the scene must not compile. */
static void expect_error(const world *w, uint32_t line, const char *part)
{
    fl_diags diags = {0};
    fl_compile_options options = {.accel = FL_ACCEL_BVH};
    assert_null(fl_compile(&w->scene, &options, NULL, &diags));
    assert_int_equal(diags.error_count, 1);
    assert_int_equal(diags.items[0].loc.line, line);
    if (!strstr(diags.items[0].message, part))
        fail_msg("got '%s'", diags.items[0].message);
    fl_diags_deinit(&diags);
}

static void an_empty_scene_compiles(void **state)
{
    (void)state;
    for (int accel = 0; accel < 3; accel++) {
        world w;
        world_init(&w);
        fl_compiled *c = world_compile(&w, (fl_accel)accel, NULL);
        assert_int_equal(c->needs, 0);
        assert_true(c->geometry.extent == 1.0);
        assert_ptr_equal(fl_compiled_retain(c), c);
        fl_compiled_release(c);
        fl_compiled_release(c);
        fl_compiled_release(NULL);
    }
}

static void a_mesh_is_stored_once(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    uint32_t mesh = world_add_mesh(&w, world_icosphere(1, 0, 1, fl_v3(0, 0, 0)));
    world_random random = {1};
    world_mesh(&w, mesh);
    for (int k = 0; k < 5; k++)
        world_mesh(&w, mesh)->transform =
            world_transform(&w, world_affine(&random, fl_v3(1, 2, 3), fl_v3(k, 0, 0)));
    world_mesh(&w, mesh)->as.mesh.normals = FL_NORMALS_FLAT;
    fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
    assert_int_equal(c->geometry.mesh_count, 2); /* smooth and flat */
    assert_int_equal(c->geometry.instance_count, 7);
    assert_int_equal(c->triangle_count, 160);
    assert_int_equal(c->instanced_triangle_count, 560);
    assert_true(c->geometry.instances[0].is_identity);
    assert_false(c->geometry.instances[1].is_identity);
    assert_non_null(c->geometry.meshes[0].normal);
    assert_null(c->geometry.meshes[1].normal);
    assert_int_equal(c->needs, FL_NEED_TRIANGLES | FL_NEED_TRANSFORMS | FL_NEED_SHADING_NORMALS);
    fl_compiled_release(c);
    world_deinit(&w);
}

static void courses_have_flat_normals(void **state)
{
    static const struct {
        fl_dialect dialect;
        bool is_flat;
    } cases[] = {{FL_DIALECT_FIRSTLIGHT, false},
                 {FL_DIALECT_PA1, true},
                 {FL_DIALECT_M04, true},
                 {FL_DIALECT_M12, false}};
    (void)state;
    for (size_t k = 0; k < FL_COUNT_OF(cases); k++) {
        world w;
        world_init(&w);
        w.scene.dialect = cases[k].dialect;
        world_mesh(&w, world_add_mesh(&w, world_icosphere(0, 0, 1, fl_v3(0, 0, 0))));
        fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
        assert_int_equal(c->geometry.meshes[0].normal == NULL, cases[k].is_flat);
        fl_compiled_release(c);
        world_deinit(&w);
    }
}

static void loose_triangles_become_one_mesh_a_transform(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    world_random random = {2};
    uint32_t transform = world_transform(&w, world_affine(&random, fl_v3(1, 1, 1), fl_v3(1, 0, 0)));
    for (int k = 0; k < 10; k++) {
        world_sphere(&w, fl_v3(k, 0, 0), 1);
        fl_object *t = world_triangle(&w, fl_v3(k, 0, 0), fl_v3(k, 1, 0), fl_v3(k, 0, 1));
        if (k % 2)
            t->transform = transform;
    }
    fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
    assert_int_equal(c->geometry.mesh_count, 2);
    assert_int_equal(c->geometry.instance_count, 2);
    for (uint32_t i = 1; i < 20; i += 2) {
        const fl_instance *instance = &c->geometry.instances[c->geometry.object_instance[i]];
        const fl_tri_mesh *mesh = &c->geometry.meshes[instance->index];
        assert_int_equal(mesh->face_object[c->geometry.object_entry[i]], i);
        assert_int_equal(mesh->face_count, 5);
    }
    fl_compiled_release(c);
    world_deinit(&w);
}

static void the_origin_moves_only_for_scenes_far_away(void **state)
{
    static const struct {
        double x, radius, origin;
    } cases[] = {{0, 1, 0},     {4, 1, 0},       {3, 10, 0},
                 {1e6, 1, 1e6}, {-1e6, 1, -1e6}, {1e15, 1e-3, 1e15}};
    (void)state;
    for (size_t k = 0; k < FL_COUNT_OF(cases); k++) {
        world w;
        world_init(&w);
        world_sphere(&w, fl_v3(cases[k].x, 0, 0), cases[k].radius);
        fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
        assert_true(fabs(c->geometry.origin.x - cases[k].origin) <= 4 * cases[k].radius);
        assert_true(cases[k].origin != 0 || c->geometry.origin.x == 0);
        assert_true(c->geometry.origin.y == 0 && c->geometry.origin.z == 0);
        assert_true(fabs(c->geometry.spheres.center[0].x + c->geometry.origin.x - cases[k].x) == 0);
        fl_compiled_release(c);
    }
}

static void what_does_not_fit_is_an_error_at_its_place(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    world_sphere(&w, fl_v3(0, 0, 0), 1);
    world_sphere(&w, fl_v3(2e18, 0, 0), 1);
    expect_error(&w, 2, "1e18");
    w.objects[1].as.sphere.center.x = 0;
    w.objects[1].as.sphere.radius = 1e-30;
    expect_error(&w, 2, "too small");
    world_init(&w);
    world_square(&w, fl_v3(0, 0, 0), fl_v3(1, 2, 3), fl_v3(-2, -4, -6));
    expect_error(&w, 1, "no area");
    world_init(&w);
    world_plane(&w, fl_v3(0, 0, 0), 1);
    expect_error(&w, 1, "normal");
    world_init(&w);
    fl_affine flat = {{{1, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 1, 0}}};
    world_plane(&w, fl_v3(0, 1, 0), 1);
    world_sphere(&w, fl_v3(0, 0, 0), 1)->transform = world_transform(&w, flat);
    expect_error(&w, 2, "transform");
    world_init(&w);
    world_mesh(&w, world_add_mesh(&w, world_icosphere(0, 0, 1, fl_v3(0, 0, 0))))->as.mesh.normals =
        FL_NORMALS_FILE;
    expect_error(&w, 1, "normals");
    world_deinit(&w);
}

static void shaders_and_textures_are_shared(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    fl_image *image = fl_image_create(2, 2, FL_PIXEL_SRGB8);
    fl_scene_image images[1] = {{.path = "a", .image = image}};
    fl_material materials[2] = {w.material, w.material};
    materials[1].image = 0;
    materials[1].texture_scale[0] = 4;
    materials[1].texture_scale[1] = 0.5;
    materials[1].reflect = fl_v3(0.1, 0, 0);
    w.scene.materials = materials;
    w.scene.material_count = 2;
    w.scene.images = images;
    w.scene.image_count = 1;
    world_plane(&w, fl_v3(0, 1, 0), 0)->material = 1;
    world_sphere(&w, fl_v3(0, 1, 0), 1)->material = 1;
    world_sphere(&w, fl_v3(2, 1, 0), 1)->material = 1;
    world_sphere(&w, fl_v3(4, 1, 0), 1);
    fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
    assert_int_equal(c->shader_count, 3);
    assert_int_equal(c->texture_count, 2);
    const fl_texture *plane = &c->textures[c->shaders[c->object_shader[0]].texture];
    const fl_texture *sphere = &c->textures[c->shaders[c->object_shader[1]].texture];
    assert_true(plane->scale[0] == 0.25f && plane->scale[1] == 2.0f && !plane->clamps_v);
    assert_true(sphere->scale[0] == 4.0f && sphere->scale[1] == 0.5f && sphere->clamps_v);
    assert_int_equal(c->object_shader[1], c->object_shader[2]);
    assert_int_equal(c->shaders[c->object_shader[3]].texture, FL_NONE);
    assert_true(c->object_needs_uv[0] && !c->object_needs_uv[3]);
    assert_int_equal(c->texture_bytes, 12);
    assert_int_equal(c->needs,
                     FL_NEED_SPHERES | FL_NEED_PLANES | FL_NEED_TEXTURES | FL_NEED_REFLECTION);
    assert_string_equal(c->object_loc[3].file, "test");
    assert_ptr_not_equal(c->object_loc[3].file, w.objects[3].loc.file);
    assert_int_equal(c->object_loc[3].line, 4);
    fl_compiled_release(c);
    fl_image_release(image);
}

static void many_objects_get_a_hierarchy(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    world_plane(&w, fl_v3(0, 1, 0), 0);
    for (int k = 0; k < FL_OBJECT_BVH_MIN; k++)
        world_sphere(&w, fl_v3(k, 1, 0), 0.3);
    fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
    assert_null(c->geometry.object_bvh);
    fl_compiled_release(c);
    world_sphere(&w, fl_v3(0, 3, 0), 0.3);
    c = world_compile(&w, FL_ACCEL_BVH, NULL);
    assert_non_null(c->geometry.object_bvh);
    assert_int_equal(c->geometry.bounded_entry_count, FL_OBJECT_BVH_MIN + 1);
    fl_compiled_release(c);
    c = world_compile(&w, FL_ACCEL_NONE, NULL);
    assert_null(c->geometry.object_bvh);
    fl_compiled_release(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_scene_compiles),
        cmocka_unit_test(a_mesh_is_stored_once),
        cmocka_unit_test(courses_have_flat_normals),
        cmocka_unit_test(loose_triangles_become_one_mesh_a_transform),
        cmocka_unit_test(the_origin_moves_only_for_scenes_far_away),
        cmocka_unit_test(what_does_not_fit_is_an_error_at_its_place),
        cmocka_unit_test(shaders_and_textures_are_shared),
        cmocka_unit_test(many_objects_get_a_hierarchy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
