/* SPDX-License-Identifier: MIT
 *
 * Whatever structure finds the candidates and whatever instruction set tests them, hits are the
 * same bits; closed meshes do not leak; any-hit and nearest-hit agree. `--all` runs ten times the
 * rays.
 */
#include "support/isect_world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static uint32_t batches = 1; /* Set once in main. */

enum { BATCH = 2048 };

/* A point that rays like to go wrong at: a corner, a point of an edge, or of a face. */
static fl_vec3 aim(world_random *random, const fl_mesh *mesh)
{
    const fl_face *face = &mesh->faces[world_bits(random) % mesh->face_count];
    fl_vec3 a = mesh->positions[face->position[0]], b = mesh->positions[face->position[1]],
            c = mesh->positions[face->position[2]];
    double s = world_unit(random);
    double t = world_unit(random);
    switch (world_bits(random) % 4) {
    case 0:
        return a;
    case 1:
        return fl_v3_mad(a, fl_v3_sub(b, a), 0.5);
    case 2:
        return fl_v3_mad(a, fl_v3_sub(b, a), s);
    default:
        return fl_v3_mad(fl_v3_mad(a, fl_v3_sub(b, a), s * (1 - t)), fl_v3_sub(c, a), t);
    }
}

/* Rays of several kinds about a mesh of size `scale` at `middle`: aimed, along axes, from its own
 * surface, tiny and huge directions, some with an end or a source. */
static void fill(world_rays *r, world_random *random, const fl_mesh *mesh, double scale,
                 fl_vec3 middle, double distance)
{
    r->rays.count = 0;
    bool is_pinhole = world_bits(random) % 3 == 0;
    uint64_t corner = world_bits(random);
    fl_vec3 eye =
        fl_v3_mad(middle, fl_v3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1),
                  0.6 * scale * distance);
    while (r->rays.count < BATCH) {
        uint32_t i = r->rays.count;
        uint64_t kind = is_pinhole ? 8 : world_bits(random) % 8;
        fl_vec3 target = aim(random, mesh);
        fl_vec3 o = fl_v3_mad(middle, world_direction(random), scale * distance);
        if (kind == 8)
            o = eye;
        if (kind == 0)
            o = aim(random, mesh);
        if (kind == 1)
            o = world_around(random, middle, 0, scale);
        fl_vec3 d = fl_v3_sub(target, o);
        if (kind == 2) {
            d = fl_v3(0, 0, 0);
            double way = world_bits(random) & 1 ? 1.0 : -1.0;
            *(world_bits(random) & 1 ? &d.y : &d.z) = way;
            o = fl_v3_mad(target, d, -scale * distance);
        }
        if (kind == 3)
            d = fl_v3_scale(d, world_bits(random) & 1 ? 1e-5 : 1e5);
        world_ray(r, o, d);
        if (kind == 4)
            r->rays.t_max[i] = (float)world_between(random, 0.9, 1.1);
        if (kind == 5) {
            r->rays.source_object[i] = 0; /* the mesh */
            r->rays.source_prim[i] = (uint32_t)(world_bits(random) % mesh->face_count);
        }
    }
    world_rays_finish(r);
}

static void run(const fl_compiled *compiled, world_rays *r, fl_isa isa)
{
    fl_isect_context context = {0};
    const fl_isect_kernels *kernels = world_kernels(isa);
    kernels->nearest(&compiled->geometry, &r->rays, &r->hits, &context);
    kernels->any(&compiled->geometry, &r->rays, r->blocked, &context);
}

/* Differences between two answers to the same rays. */
static uint32_t differences(const world_rays *a, const world_rays *b)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < a->rays.count; i++)
        count += memcmp(&a->hits.t[i], &b->hits.t[i], sizeof(float)) != 0 ||
                 a->hits.object[i] != b->hits.object[i] || a->hits.prim[i] != b->hits.prim[i] ||
                 a->blocked[i] != b->blocked[i];
    return count;
}

/* FNV-1a of the nearest hits: to compare machines and compilers by eye. */
static uint64_t digest(const world_rays *r, uint64_t hash)
{
    for (uint32_t i = 0; i < r->rays.count; i++) {
        uint32_t words[3] = {0, r->hits.object[i], r->hits.prim[i]};
        memcpy(words, &r->hits.t[i], sizeof(float));
        for (int k = 0; k < 3; k++)
            hash = (hash ^ words[k]) * 0x100000001b3u;
    }
    return hash;
}

static uint32_t disagreements(const world_rays *r)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < r->rays.count; i++)
        count += (r->hits.object[i] != FL_NONE) != (r->blocked[i] != 0) ||
                 (r->hits.object[i] != FL_NONE) != (r->hits.t[i] < r->rays.t_max[i]);
    return count;
}

/* Rays go down the hierarchy in company; each must find what it finds alone. */
static uint32_t differences_alone(const fl_compiled *compiled, const world_rays *together,
                                  world_rays *alone)
{
    enum { APART = 16 };
    uint32_t count = 0;
    for (uint32_t phase = 0; phase < APART; phase++) {
        for (uint32_t i = 0; i < alone->rays.count; i++)
            alone->rays.t_max[i] = i % APART == phase ? together->rays.t_max[i] : -1.0f;
        run(compiled, alone, fl_cpu_best_isa());
        for (uint32_t i = phase; i < alone->rays.count; i += APART)
            count += memcmp(&alone->hits.t[i], &together->hits.t[i], sizeof(float)) != 0 ||
                     alone->hits.object[i] != together->hits.object[i] ||
                     alone->hits.prim[i] != together->hits.prim[i] ||
                     alone->blocked[i] != together->blocked[i];
    }
    return count;
}

/* All structures with the best kernels, all kernels with the hierarchy. */
static void compare(const char *name, const world *w, const fl_mesh *mesh, double scale,
                    fl_vec3 middle, double distance, uint32_t batch_count, uint64_t seed)
{
    fl_compiled *compiled[3];
    world_rays answers[3];
    for (int k = 0; k < 3; k++) {
        compiled[k] = world_compile(w, (fl_accel)k, NULL);
        world_rays_init(&answers[k], BATCH);
    }
    world_random random = {seed};
    uint64_t hit_count = 0, wrong = 0, wrong_isa = 0, unlike = 0, total = 0, hash = 0;
    for (uint32_t batch = 0; batch < batch_count * batches; batch++) {
        world_random start = random;
        for (int k = 0; k < 3; k++) {
            random = start;
            fill(&answers[k], &random, mesh, scale, middle, distance);
            run(compiled[k], &answers[k], fl_cpu_best_isa());
            wrong += differences(&answers[0], &answers[k]);
            unlike += disagreements(&answers[k]);
        }
        for (int isa = 0; isa < FL_ISA_COUNT; isa++)
            if (world_kernels((fl_isa)isa)) {
                run(compiled[0], &answers[1], (fl_isa)isa);
                wrong_isa += differences(&answers[0], &answers[1]);
            }
        wrong += differences_alone(compiled[0], &answers[0], &answers[1]);
        for (uint32_t i = 0; i < answers[0].rays.count; i++)
            hit_count += answers[0].hits.object[i] != FL_NONE;
        total += answers[0].rays.count;
        hash = digest(&answers[0], hash);
    }
    print_message("%s: seed %llu, %llu rays, %llu hits, digest %016llx, "
                  "differences %llu (structures) %llu (kernels) %llu (any)\n",
                  name, (unsigned long long)seed, (unsigned long long)total,
                  (unsigned long long)hit_count, (unsigned long long)hash,
                  (unsigned long long)wrong, (unsigned long long)wrong_isa,
                  (unsigned long long)unlike);
    for (int k = 0; k < 3; k++) {
        fl_compiled_release(compiled[k]);
        world_rays_deinit(&answers[k]);
    }
    assert_true(hit_count > total / 10);
    assert_int_equal(wrong, 0);
    assert_int_equal(wrong_isa, 0);
    assert_int_equal(unlike, 0);
}

static void icospheres_are_hit_alike(void **state)
{
    static const struct {
        double scale, x, distance;
    } cases[] = {{1, 0, 3}, {1e-6, 0, 3}, {1e6, 0, 3}, {1, 1e4, 3}, {1, 0, 1e4}, {1e-3, 10, 50}};
    (void)state;
    for (size_t k = 0; k < FL_COUNT_OF(cases); k++) {
        fl_vec3 middle = fl_v3(cases[k].x, -0.5 * cases[k].x, 0);
        world w;
        world_init(&w);
        fl_mesh *mesh = world_icosphere(3, 0.2, cases[k].scale, middle);
        world_mesh(&w, world_add_mesh(&w, mesh));
        /* Rays below are relative to the scene's own origin only where that is 0: compile moves it
         * far away. */
        fl_compiled *probe = world_compile(&w, FL_ACCEL_NONE, NULL);
        fl_vec3 local = fl_v3_sub(middle, probe->geometry.origin);
        fl_mesh *shifted = world_icosphere(3, 0.2, cases[k].scale, local);
        compare("icosphere", &w, shifted, cases[k].scale, local, cases[k].distance, 50, 100 + k);
        fl_mesh_release(shifted);
        fl_compiled_release(probe);
        world_deinit(&w);
    }
}

/* Beyond the caches leaves are tested in another way (kernel_isect_mesh.h, STEADY_PACKS). */
static void large_meshes_are_hit_alike(void **state)
{
    static const double distances[] = {3.0, 1e3};
    (void)state;
    for (size_t k = 0; k < FL_COUNT_OF(distances); k++) {
        world w;
        world_init(&w);
        fl_mesh *mesh = world_icosphere(5, 0.1, 1.0, fl_v3(0, 0, 0));
        world_mesh(&w, world_add_mesh(&w, mesh));
        fl_compiled *probe = world_compile(&w, FL_ACCEL_BVH, NULL);
        assert_true(probe->geometry.meshes[0].pack_count >= 2048);
        fl_compiled_release(probe);
        compare("large icosphere", &w, mesh, 1.0, fl_v3(0, 0, 0), distances[k], 4, 800 + k);
        world_deinit(&w);
    }
}

static void soups_are_hit_alike(void **state)
{
    static const double sides[] = {0.1, 1.0, 3.0};
    (void)state;
    for (size_t k = 0; k < FL_COUNT_OF(sides); k++) {
        world_random random = {500 + k};
        world w;
        world_init(&w);
        fl_mesh *mesh = world_soup(&random, 700, sides[k], 1.0, fl_v3(0, 0, 0));
        world_mesh(&w, world_add_mesh(&w, mesh));
        compare("soup", &w, mesh, 1.0, fl_v3(0, 0, 0), 3.0, 60, 600 + k);
        world_deinit(&w);
    }
}

/* Everything at once, with transforms of all kinds and with enough objects for the hierarchy of
 * objects. */
static void scenes_are_hit_alike(void **state)
{
    (void)state;
    for (uint32_t round = 0; round < 8; round++) {
        world_random random = {900 + round};
        world w;
        world_init(&w);
        fl_mesh *mesh = world_icosphere(2, 0.2, 1.0, fl_v3(0, 0, 0));
        uint32_t index = world_add_mesh(&w, mesh);
        world_mesh(&w, index);
        uint32_t count = round % 2 ? 60 : 12;
        for (uint32_t k = 0; k < count; k++) {
            fl_vec3 at = world_around(&random, fl_v3(0, 0, 0), 0.3, 2);
            fl_vec3 a = fl_v3_scale(world_direction(&random), 0.5);
            fl_vec3 b = fl_v3_scale(world_direction(&random), 0.5);
            double size = world_between(&random, 0.05, 0.5);
            fl_object *object = k % 7 == 0   ? world_sphere(&w, at, size)
                                : k % 7 == 1 ? world_square(&w, at, a, b)
                                : k % 7 == 2 ? world_disk(&w, at, a, size)
                                : k % 7 == 3
                                    ? world_triangle(&w, at, fl_v3_add(at, a), fl_v3_add(at, b))
                                : k % 7 == 4 ? world_revolution(&w)
                                : k % 7 == 5 ? world_mesh(&w, index)
                                             : world_plane(&w, a, 2.0);
            if (k % 3 == 0 || object->kind == FL_OBJECT_MESH) {
                fl_vec3 scale = fl_v3(0, 0, k % 2 ? 0.3 : -0.3);
                scale.x = world_between(&random, 0.1, 1);
                scale.y = world_between(&random, 0.1, 1);
                object->transform = world_transform(&w, world_affine(&random, scale, at));
            }
        }
        compare(round % 2 ? "many objects" : "few objects", &w, mesh, 1.0, fl_v3(0, 0, 0), 3.0, 10,
                1000 + round);
        world_deinit(&w);
    }
}

/* From inside every ray must meet the closed surface; from outside, towards a point well inside
 * where it ends, too: what passes the near wall must not be stopped by the far one. */
static void closed_meshes_do_not_leak(void **state)
{
    static const struct {
        double scale, x;
    } cases[] = {{1, 0}, {1e-6, 0}, {1e-3, 1}, {1e6, 0}, {1, 1e5}, {1e-3, 1e3}, {10, -77}};
    static const fl_accel accels[] = {FL_ACCEL_BVH, FL_ACCEL_OCTREE, FL_ACCEL_NONE};
    (void)state;
    world_rays r;
    world_rays_init(&r, BATCH);
    for (size_t k = 0; k < FL_COUNT_OF(cases); k++) {
        fl_vec3 middle = fl_v3(cases[k].x, 0.3 * cases[k].x, 0);
        world w;
        world_init(&w);
        world_mesh(&w, world_add_mesh(&w, world_icosphere(3, 0.1, cases[k].scale, middle)));
        world_random random = {7000 + k};
        uint32_t leaks = 0, ray_count = 0;
        for (size_t m = 0; m < FL_COUNT_OF(accels); m++) {
            fl_compiled *compiled = world_compile(&w, accels[m], NULL);
            fl_vec3 local = fl_v3_sub(middle, compiled->geometry.origin);
            fl_mesh *shifted = world_icosphere(3, 0.1, cases[k].scale, local);
            for (uint32_t batch = 0; batch < 8 * batches; batch++) {
                r.rays.count = 0;
                while (r.rays.count < BATCH) {
                    fl_vec3 inside = world_around(&random, local, 0, 0.5 * cases[k].scale);
                    fl_vec3 target = aim(&random, shifted);
                    fl_vec3 d = fl_v3_sub(target, inside);
                    /* Half of them inwards, beginning beyond the surface in the line to that point.
                     */
                    if (world_bits(&random) & 1) {
                        world_ray(&r, inside, d);
                    } else {
                        world_ray(&r, fl_v3_mad(inside, d, 10.0), fl_v3_scale(d, -1.0));
                        r.rays.t_max[r.rays.count - 1] = 10.0f;
                    }
                }
                world_rays_finish(&r);
                run(compiled, &r, fl_cpu_best_isa());
                for (uint32_t i = 0; i < r.rays.count; i++)
                    leaks += r.hits.object[i] == FL_NONE || !r.blocked[i];
                ray_count += r.rays.count;
            }
            fl_mesh_release(shifted);
            fl_compiled_release(compiled);
        }
        print_message("closed sphere of size %g at %g: seed %zu, %u rays, %u leaks\n",
                      cases[k].scale, cases[k].x, 7000 + k, ray_count, leaks);
        assert_int_equal(leaks, 0);
        world_deinit(&w);
    }
    world_rays_deinit(&r);
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "--all") == 0)
        batches = 10;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(icospheres_are_hit_alike),  cmocka_unit_test(large_meshes_are_hit_alike),
        cmocka_unit_test(soups_are_hit_alike),       cmocka_unit_test(scenes_are_hit_alike),
        cmocka_unit_test(closed_meshes_do_not_leak),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
