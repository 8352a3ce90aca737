/* SPDX-License-Identifier: MIT
 *
 * What single rays must see, by every instruction set: shapes, own surfaces, degenerate triangles,
 * the solved surface.
 */
#include "support/isect_world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const fl_isect_kernels *best(void)
{
    return world_kernels(fl_cpu_best_isa());
}

static void trace(const fl_compiled *c, world_rays *r, const fl_isect_kernels *kernels)
{
    static const uint8_t wants_uv[WORLD_OBJECTS_MAX] = {1, 1, 1, 1, 1, 1, 1, 1};
    fl_isect_context context = {0};
    world_rays_finish(r);
    kernels->nearest(&c->geometry, &r->rays, &r->hits, &context);
    kernels->any(&c->geometry, &r->rays, r->blocked, &context);
    kernels->resolve(&c->geometry, &r->rays, &r->hits, wants_uv, &r->surface, &context);
}

static fl_vec3 normal_of(const world_rays *r, uint32_t i)
{
    return fl_v3((double)r->surface.ngx[i], (double)r->surface.ngy[i], (double)r->surface.ngz[i]);
}

static fl_vec3 point_of(const world_rays *r, uint32_t i)
{
    return fl_v3((double)r->surface.px[i], (double)r->surface.py[i], (double)r->surface.pz[i]);
}

static void assert_near(double got, double want, double bound)
{
    if (!(fabs(got - want) <= bound))
        fail_msg("got %.17g, want %.17g within %g", got, want, bound);
}

static void assert_vec3_near(fl_vec3 got, fl_vec3 want, double bound)
{
    assert_near(got.x, want.x, bound);
    assert_near(got.y, want.y, bound);
    assert_near(got.z, want.z, bound);
}

/* Shapes in a row along x, each met straight on from +z; then again through a transform that moves
 * them by 100. */
static void each_shape_is_met_where_it_is(void **state)
{
    (void)state;
    for (int moved = 0; moved < 2; moved++)
        for (int isa = 0; isa < FL_ISA_COUNT; isa++) {
            const fl_isect_kernels *kernels = world_kernels((fl_isa)isa);
            if (!kernels)
                continue;
            world w;
            world_init(&w);
            world_sphere(&w, fl_v3(0, 0, 0), 1);
            world_square(&w, fl_v3(3, -1, 0), fl_v3(2, 0, 0), fl_v3(0, 2, 0));
            world_disk(&w, fl_v3(8, 0, 0), fl_v3(0, 0, 3), 1);
            world_triangle(&w, fl_v3(11, -1, 0), fl_v3(13, -1, 0), fl_v3(12, 2, 0));
            uint32_t mesh = world_add_mesh(&w, world_icosphere(3, 0, 1, fl_v3(16, 0, 0)));
            world_mesh(&w, mesh)->as.mesh.normals = FL_NORMALS_FLAT;
            world_plane(&w, fl_v3(0, 0, 2), -10);
            double x = moved ? 100 : 0;
            if (moved)
                for (uint32_t k = 0; k < w.scene.object_count; k++)
                    w.objects[k].transform = world_transform(
                        &w, (fl_affine){{{1, 0, 0, 100}, {0, 1, 0, 0}, {0, 0, 1, 0}}});
            fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
            fl_vec3 shift = c->geometry.origin;
            world_rays r;
            world_rays_init(&r, 16);
            static const double at_x[] = {0, 4.5, 8.5, 12, 16.01, 20};
            for (int k = 0; k < 6; k++)
                world_ray(&r, fl_v3_sub(fl_v3(at_x[k] + x, 0.25, 9), shift), fl_v3(0, 0, -2));
            trace(c, &r, kernels);
            static const double want_z[] = {0.968245836551854, 0, 0, 0, 0.96, -5};
            for (uint32_t k = 0; k < 6; k++) {
                assert_int_equal(r.hits.object[k], k);
                assert_int_equal(r.blocked[k], 1);
                double bound = k == 4 ? 0.02 : 1e-5; /* the mesh is no sphere */
                assert_near((double)r.hits.t[k], (9 - want_z[k]) / 2, bound);
                assert_vec3_near(fl_v3_add(point_of(&r, k), shift),
                                 fl_v3(at_x[k] + x, 0.25, want_z[k]), bound);
                if (k != 0 && k != 4)
                    assert_vec3_near(normal_of(&r, k), fl_v3(0, 0, 1), 1e-7);
            }
            assert_vec3_near(normal_of(&r, 0), fl_v3(0, 0.25, want_z[0]), 1e-6);
            assert_near((double)r.surface.u[1], 0.75, 1e-5);
            assert_near((double)r.surface.v[1], 0.625, 1e-5);
            assert_near((double)r.surface.u[0], 0.25, 1e-5);
            assert_near((double)r.surface.v[0], 0.91956884, 1e-5); /* 1 - acos(z) / pi */
            world_rays_deinit(&r);
            fl_compiled_release(c);
            world_deinit(&w);
        }
}

static void t_max_and_padding_are_exclusive(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    world_plane(&w, fl_v3(0, 0, 1), 0);
    world_mesh(&w, world_add_mesh(&w, world_icosphere(0, 0, 0.5, fl_v3(0, 0, -2))));
    world_triangle(&w, fl_v3(-9, -9, 0), fl_v3(9, -9, 0), fl_v3(0, 9, 0));
    fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
    world_rays r;
    world_rays_init(&r, 8);
    for (int k = 0; k < 3; k++)
        world_ray(&r, fl_v3(0, 0, 1), fl_v3(0, 0, -1));
    r.rays.t_max[0] = 1.0f;
    r.rays.t_max[1] = 1.0000001f;
    r.rays.source_object[2] = 0;
    r.rays.source_prim[2] = 0;
    trace(c, &r, best());
    assert_int_equal(r.hits.object[0], FL_NONE);
    assert_true(isinf(r.hits.t[0]) && r.hits.t[0] > 0);
    assert_int_equal(r.blocked[0], 0);
    assert_int_equal(r.hits.object[1], 0); /* of equals the lower object */
    assert_int_equal(r.blocked[1], 1);
    assert_int_equal(r.hits.object[2], 2); /* the plane is skipped, not what lies in it */
    world_rays_deinit(&r);
    fl_compiled_release(c);
    world_deinit(&w);
}

/* accuracy: the chord that leaves a sphere from within is known to 5.2e-5 of itself at every scale,
 * and no ray that leaves it outwards meets it again. */
static void spheres_know_their_own_rays(void **state)
{
    static const struct {
        double r, x;
    } cases[] = {{1, 0}, {1, 100}, {1e-3, 1}, {1e6, 0}, {1, 1e4}, {0.01, 10}};
    enum { COUNT = 4096 };
    (void)state;
    world_rays first, second;
    world_rays_init(&first, COUNT);
    world_rays_init(&second, COUNT);
    for (size_t k = 0; k < FL_COUNT_OF(cases); k++) {
        world w;
        world_init(&w);
        double radius = cases[k].r;
        fl_vec3 center = fl_v3(cases[k].x, 0, 0);
        world_sphere(&w, center, radius);
        world_sphere(&w, fl_v3(0, 0, 0), radius * 1e-3); /* keeps the origin where it is */
        fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
        center = c->geometry.spheres.center[0];
        world_random random = {40 + k};
        first.rays.count = second.rays.count = 0;
        for (uint32_t i = 0; i < COUNT; i++) {
            fl_vec3 o = fl_v3_mad(center, world_direction(&random), 3 * radius);
            fl_vec3 target = fl_v3_mad(center, world_direction(&random), 0.9 * radius);
            world_ray(&first, o, fl_v3_sub(target, o));
        }
        trace(c, &first, best());
        for (uint32_t i = 0; i < COUNT; i++) {
            assert_true(first.hits.object[i] == 0);
            fl_vec3 n = normal_of(&first, i), d = world_direction(&random);
            bool is_out = i & 1;
            if ((fl_v3_dot(n, d) < 0) == is_out)
                d = fl_v3_scale(d, -1);
            double side = is_out ? 1 : -1;
            if (fabs(fl_v3_dot(n, d)) < 0.01)
                d = fl_v3_mad(d, n, 0.02 * side);
            double offset = (double)first.surface.offset[i];
            assert_true(offset > 0);
            world_ray(&second, fl_v3_mad(point_of(&first, i), n, side * offset), d);
            second.rays.source_object[i] = 0;
            second.rays.source_prim[i] = 0;
        }
        trace(c, &second, best());
        for (uint32_t i = 0; i < COUNT; i++) {
            if (i & 1) {
                assert_true(second.hits.object[i] != 0);
                continue;
            }
            fl_vec3 d = fl_v3((double)second.rays.dx[i], (double)second.rays.dy[i],
                              (double)second.rays.dz[i]);
            fl_vec3 n = normal_of(&first, i);
            double chord = -2 * radius * fl_v3_dot(n, d) / fl_v3_dot(d, d);
            if (second.hits.object[i] == 0) {
                /* The bound is the rounding of the origin, met at an angle of at least 0.01. */
                double bound = 1e-4 + 100 * 0x1p-21 * (1 + fabs(cases[k].x) / radius);
                assert_near((double)second.hits.t[i] / chord, 1.0, bound);
            } else {
                assert_int_equal(second.hits.object[i], 1);
            }
        }
        fl_compiled_release(c);
        world_deinit(&w);
    }
    world_rays_deinit(&first);
    world_rays_deinit(&second);
}

/* Rays leaving a convex mesh outwards never meet it again, whatever its size, place and transform.
 */
static void convex_meshes_are_left_for_good(void **state)
{
    enum { COUNT = 8192 };
    static const struct {
        double size, x;
        bool is_transformed;
    } cases[] = {{1, 0, false}, {1e-4, 0, true}, {1e4, 0, false}, {1, 300, true}, {0.01, 5, false}};
    (void)state;
    world_rays first, second;
    world_rays_init(&first, COUNT);
    world_rays_init(&second, COUNT);
    for (size_t k = 0; k < FL_COUNT_OF(cases); k++) {
        world w;
        world_init(&w);
        world_random random = {70 + k};
        double size = cases[k].size;
        fl_vec3 middle = fl_v3(cases[k].x, 0, 0);
        fl_object *object =
            world_mesh(&w, world_add_mesh(&w, world_icosphere(3, 0, size, fl_v3(0, 0, 0))));
        fl_affine move = {{{1, 0, 0, middle.x}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
        object->transform = world_transform(
            &w, cases[k].is_transformed ? world_affine(&random, fl_v3(1, 0.3, 2), middle) : move);
        world_sphere(&w, fl_v3(0, 0, 0), size * 1e-6);
        fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
        first.rays.count = second.rays.count = 0;
        fl_vec3 local = fl_v3_sub(middle, c->geometry.origin);
        for (uint32_t i = 0; i < COUNT; i++) {
            fl_vec3 o = fl_v3_mad(local, world_direction(&random), 4 * size);
            world_ray(&first, o,
                      fl_v3_sub(fl_v3_mad(local, world_direction(&random), 0.2 * size), o));
        }
        trace(c, &first, best());
        for (uint32_t i = 0; i < COUNT; i++) {
            fl_vec3 n = normal_of(&first, i), d = world_direction(&random);
            d = fl_v3_dot(n, d) < 0 ? fl_v3_scale(d, -1) : d;
            if (i % 4 == 0) /* grazing */
                d = fl_v3_mad(d, n, -0.999 * fl_v3_dot(n, d));
            world_ray(&second, fl_v3_mad(point_of(&first, i), n, (double)first.surface.offset[i]),
                      d);
            second.rays.source_object[i] = first.hits.object[i];
            second.rays.source_prim[i] = first.hits.prim[i];
        }
        trace(c, &second, best());
        uint32_t rehits = 0;
        for (uint32_t i = 0; i < COUNT; i++) {
            assert_int_equal(first.hits.object[i], 0);
            rehits += second.hits.object[i] == 0 ||
                      (second.hits.object[i] == FL_NONE && second.blocked[i]);
        }
        if (rehits)
            fail_msg("case %zu: %u of %d rays meet the mesh they leave", k, rehits, COUNT);
        fl_compiled_release(c);
        world_deinit(&w);
    }
    world_rays_deinit(&first);
    world_rays_deinit(&second);
}

static void degenerate_triangles_are_never_hit(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    world_triangle(&w, fl_v3(0, 0, 0), fl_v3(0, 0, 0), fl_v3(0, 0, 0));
    world_triangle(&w, fl_v3(-1, 0, 0), fl_v3(1, 0, 0), fl_v3(0.5, 0, 0));
    world_triangle(&w, fl_v3(0, 0, -1), fl_v3(0, 0, 1), fl_v3(0, 1, 0)); /* edge on */
    fl_compiled *c = world_compile(&w, FL_ACCEL_NONE, NULL);
    world_rays r;
    world_rays_init(&r, 8);
    world_ray(&r, fl_v3(0, 0, 5), fl_v3(0, 0, -1));
    world_ray(&r, fl_v3(0.25, 0, 5), fl_v3(0, 0, -1));
    world_ray(&r, fl_v3(0, 0.25, 5), fl_v3(0, 0, -1));
    world_ray(&r, fl_v3(1, 1, 5), fl_v3(0, 0, 0));
    trace(c, &r, best());
    for (int k = 0; k < 4; k++) {
        assert_int_equal(r.hits.object[k], FL_NONE);
        assert_int_equal(r.blocked[k], 0);
    }
    world_rays_deinit(&r);
    fl_compiled_release(c);
    world_deinit(&w);
}

/* Whatever the transform, the solved point lies on the ray and on the surface, and normals stand on
 * it. */
static void solved_points_lie_on_ray_and_surface(void **state)
{
    enum { COUNT = 1024 };
    (void)state;
    world_rays r;
    world_rays_init(&r, COUNT);
    for (uint32_t round = 0; round < 20; round++) {
        world w;
        world_init(&w);
        world_random random = {300 + round};
        fl_vec3 scale = fl_v3(0, 0, -1);
        scale.x = world_between(&random, 0.2, 2);
        scale.y = world_between(&random, 0.2, 2);
        fl_affine m = world_affine(&random, scale, fl_v3(2, -1, 3));
        fl_affine inverse = fl_affine_identity();
        assert_true(fl_affine_invert(&m, &inverse));
        fl_object *o = round % 2 ? world_sphere(&w, fl_v3(0, 0, 0), 1)
                                 : world_disk(&w, fl_v3(0, 0, 0), fl_v3(0, 1, 0), 1);
        o->transform = world_transform(&w, m);
        fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
        r.rays.count = 0;
        for (uint32_t i = 0; i < COUNT; i++) {
            fl_vec3 from = fl_v3_mad(fl_v3(2, -1, 3), world_direction(&random), 5);
            fl_vec3 to = fl_v3_mad(fl_v3(2, -1, 3), world_direction(&random), 0.3);
            world_ray(&r, fl_v3_sub(from, c->geometry.origin), fl_v3_sub(to, from));
        }
        trace(c, &r, best());
        uint32_t hits = 0;
        for (uint32_t i = 0; i < COUNT; i++) {
            if (r.hits.object[i] == FL_NONE)
                continue;
            hits++;
            fl_vec3 ro = fl_v3((double)r.rays.ox[i], (double)r.rays.oy[i], (double)r.rays.oz[i]);
            fl_vec3 rd = fl_v3((double)r.rays.dx[i], (double)r.rays.dy[i], (double)r.rays.dz[i]);
            fl_vec3 p = point_of(&r, i), way = fl_v3_sub(p, ro);
            fl_vec3 off = fl_v3_cross(way, fl_v3_normalize(rd));
            assert_near(fl_v3_length(off), 0, 2e-4); /* grazing points are pulled to the surface */
            fl_vec3 q = fl_affine_point(&inverse, fl_v3_add(p, c->geometry.origin));
            fl_vec3 n = normal_of(&r, i);
            assert_near(fl_v3_length(n), 1, 2e-7);
            fl_vec3 want = round % 2 ? q : fl_v3(0, 1, 0);
            if (round % 2)
                assert_near(fl_v3_length(q), 1, 1e-5);
            else
                assert_near(q.y, 0, 1e-5);
            want = fl_v3_normalize(fl_affine_transposed_direction(&inverse, want));
            assert_near(fl_v3_dot(n, want), 1, 1e-5);
        }
        assert_true(hits > COUNT / 8);
        fl_compiled_release(c);
        world_deinit(&w);
    }
    world_rays_deinit(&r);
}

static void a_stale_generation_stops_the_kernels(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    world_plane(&w, fl_v3(0, 0, 1), 0);
    fl_compiled *c = world_compile(&w, FL_ACCEL_BVH, NULL);
    world_rays r;
    world_rays_init(&r, 8);
    world_ray(&r, fl_v3(0, 0, 1), fl_v3(0, 0, -1));
    world_rays_finish(&r);
    atomic_uint_least64_t generation;
    atomic_init(&generation, 2);
    fl_isect_context context = {.generation = &generation, .wanted = 1};
    best()->nearest(&c->geometry, &r.rays, &r.hits, &context);
    best()->any(&c->geometry, &r.rays, r.blocked, &context);
    assert_int_equal(context.counts.primitive_tests, 0);
    atomic_store(&generation, 1);
    best()->nearest(&c->geometry, &r.rays, &r.hits, &context);
    assert_int_equal(context.counts.primitive_tests, 1);
    world_rays_deinit(&r);
    fl_compiled_release(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_shape_is_met_where_it_is),
        cmocka_unit_test(t_max_and_padding_are_exclusive),
        cmocka_unit_test(spheres_know_their_own_rays),
        cmocka_unit_test(convex_meshes_are_left_for_good),
        cmocka_unit_test(degenerate_triangles_are_never_hit),
        cmocka_unit_test(solved_points_lie_on_ray_and_surface),
        cmocka_unit_test(a_stale_generation_stops_the_kernels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
