/* SPDX-License-Identifier: MIT
 *
 * Whatever structure finds the candidates and whatever instruction set tests them, hits are the
 * same bits; closed meshes do not leak; any-hit and nearest-hit agree. `--all` runs ten times the
 * rays.
 */
#include "support/isect_world.h"
#include "support/property.h"

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

/* Rays about a mesh of size `scale` at `middle`, all made from one eye or none. */
typedef struct place {
    const fl_mesh *mesh;
    double scale, distance;
    fl_vec3 middle, eye;
    bool is_pinhole;
} place;

/* A ray of one of several kinds: aimed, along an axis, from the mesh's own surface, of a tiny or
 * huge direction, with an end or a source. */
static void add_ray(world_rays *r, const place *a, uint64_t seed)
{
    world_random random = {seed};
    uint32_t i = r->rays.count;
    uint64_t kind = a->is_pinhole ? 8 : world_bits(&random) % 8;
    fl_vec3 target = aim(&random, a->mesh);
    fl_vec3 o = fl_v3_mad(a->middle, world_direction(&random), a->scale * a->distance);
    if (kind == 8)
        o = a->eye;
    if (kind == 0)
        o = aim(&random, a->mesh);
    if (kind == 1)
        o = world_around(&random, a->middle, 0, a->scale);
    fl_vec3 d = fl_v3_sub(target, o);
    if (kind == 2) {
        d = fl_v3(0, 0, 0);
        double way = world_bits(&random) & 1 ? 1.0 : -1.0;
        *(world_bits(&random) & 1 ? &d.y : &d.z) = way;
        o = fl_v3_mad(target, d, -a->scale * a->distance);
    }
    if (kind == 3)
        d = fl_v3_scale(d, world_bits(&random) & 1 ? 1e-5 : 1e5);
    world_ray(r, o, d);
    if (kind == 4)
        r->rays.t_max[i] = (float)world_between(&random, 0.9, 1.1);
    if (kind == 5) {
        r->rays.source_object[i] = 0; /* the mesh */
        r->rays.source_prim[i] = (uint32_t)(world_bits(&random) % a->mesh->face_count);
    }
}

static void run(const fl_compiled *compiled, world_rays *r, fl_isa isa)
{
    fl_isect_context context = {0};
    const fl_isect_kernels *kernels = world_kernels(isa);
    kernels->nearest(&compiled->geometry, &r->rays, &r->hits, &context);
    kernels->any(&compiled->geometry, &r->rays, r->blocked, &context);
}

static bool differs(const world_rays *a, const world_rays *b, uint32_t i)
{
    return memcmp(&a->hits.t[i], &b->hits.t[i], sizeof(float)) != 0 ||
           a->hits.object[i] != b->hits.object[i] || a->hits.prim[i] != b->hits.prim[i] ||
           a->blocked[i] != b->blocked[i];
}

/* Notes the ray of a case that went wrong, to the bit. */
static bool note(property *p, const char *what, const world_rays *r, uint32_t i)
{
    const fl_rays *y = &r->rays;
    return property_fail(p, "%s: o %a %a %a, d %a %a %a, t_max %a, source %u %u", what,
                         (double)y->ox[i], (double)y->oy[i], (double)y->oz[i], (double)y->dx[i],
                         (double)y->dy[i], (double)y->dz[i], (double)y->t_max[i],
                         y->source_object[i], y->source_prim[i]);
}

/* Whether two answers to the same rays are the same. */
static bool is_alike(property *p, const char *what, const world_rays *a, const world_rays *b)
{
    for (uint32_t i = 0; i < a->rays.count; i++)
        if (differs(a, b, i))
            return note(p, what, a, i);
    return true;
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

/* Whether any-hit and nearest-hit agree, and hits lie on their rays. */
static bool is_consistent(property *p, const world_rays *r)
{
    for (uint32_t i = 0; i < r->rays.count; i++) {
        bool is_hit = r->hits.object[i] != FL_NONE;
        if (is_hit != (r->blocked[i] != 0) || is_hit != (r->hits.t[i] < r->rays.t_max[i]))
            return note(p, "any and nearest", r, i);
    }
    return true;
}

/* Rays go down the hierarchy in company; each must find what it finds alone. */
static bool is_alike_alone(property *p, const fl_compiled *compiled, const world_rays *together,
                           world_rays *alone)
{
    enum { APART = 16 };
    for (uint32_t phase = 0; phase < APART; phase++) {
        for (uint32_t i = 0; i < alone->rays.count; i++)
            alone->rays.t_max[i] = i % APART == phase ? together->rays.t_max[i] : -1.0f;
        run(compiled, alone, fl_cpu_best_isa());
        for (uint32_t i = phase; i < alone->rays.count; i += APART)
            if (differs(alone, together, i))
                return note(p, "alone", together, i);
    }
    return true;
}

typedef struct comparison {
    place about;
    fl_compiled *compiled[3]; /* one for each structure */
    world_rays answers[3];
    uint64_t hit_count, ray_count, hash;
} comparison;

static void fill(comparison *c, property *p)
{
    static uint64_t seeds[BATCH];
    place *a = &c->about;
    a->is_pinhole = property_below(p, 3) == 2;
    uint64_t corner = property_below(p, 8), count = property_given(p, BATCH, BATCH + 1);
    a->eye =
        fl_v3_mad(a->middle, fl_v3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1),
                  0.6 * a->scale * a->distance);
    for (uint64_t i = 0; i < count; i++) {
        property_mark(p);
        seeds[i] = property_below(p, 0);
    }
    for (int k = 0; k < 3; k++) {
        c->answers[k].rays.count = 0;
        for (uint64_t i = 0; i < count; i++)
            add_ray(&c->answers[k], a, seeds[i]);
        world_rays_finish(&c->answers[k]);
    }
}

/* All structures with the best kernels, all kernels with the hierarchy. */
static bool hits_are_alike(property *p, void *data)
{
    static const char *const structures[] = {"hierarchy", "octree", "none"};
    comparison *c = data;
    world_rays *first = &c->answers[0];
    fill(c, p);
    for (int k = 0; k < 3; k++) {
        run(c->compiled[k], &c->answers[k], fl_cpu_best_isa());
        if (!is_alike(p, structures[k], first, &c->answers[k]) || !is_consistent(p, &c->answers[k]))
            return false;
    }
    for (int isa = 0; isa < FL_ISA_COUNT; isa++) {
        if (!world_kernels((fl_isa)isa))
            continue;
        run(c->compiled[0], &c->answers[1], (fl_isa)isa);
        if (!is_alike(p, fl_isa_name((fl_isa)isa), first, &c->answers[1]))
            return false;
    }
    for (uint32_t i = 0; i < first->rays.count; i++)
        c->hit_count += first->hits.object[i] != FL_NONE;
    c->ray_count += first->rays.count;
    c->hash = digest(first, c->hash);
    return is_alike_alone(p, c->compiled[0], first, &c->answers[1]);
}

static void compare(const char *name, const world *w, const place *about, uint32_t batch_count,
                    uint32_t seed)
{
    comparison c = {.about = *about};
    for (int k = 0; k < 3; k++) {
        c.compiled[k] = world_compile(w, (fl_accel)k, NULL);
        world_rays_init(&c.answers[k], BATCH);
    }
    /* One ray each, where boxes that are 1e-4 of their size too small lose a hit. */
    static const uint64_t icosphere[] = {2, 4, 1, 0x8b85ead804275a57},
                          large[] = {2, 1, 1, 0x5f3aecede0a1a3f2},
                          soup[] = {0, 0, 1, 0x60d1dd1b733838c0},
                          scene[] = {0, 0, 1, 0xfa80000000000000};
    const property_case kept[] = {PROPERTY_CASE(icosphere), PROPERTY_CASE(large),
                                  PROPERTY_CASE(soup), PROPERTY_CASE(scene)};
    property_run(hits_are_alike, &c, seed, batch_count * batches, kept, FL_COUNT_OF(kept));
    print_message("%s: %llu rays, %llu hits, digest %016llx\n", name,
                  (unsigned long long)c.ray_count, (unsigned long long)c.hit_count,
                  (unsigned long long)c.hash);
    for (int k = 0; k < 3; k++) {
        fl_compiled_release(c.compiled[k]);
        world_rays_deinit(&c.answers[k]);
    }
    assert_true(c.hit_count > c.ray_count / 10);
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
        place about = {shifted, cases[k].scale, cases[k].distance, local, local, false};
        compare("icosphere", &w, &about, 50, 100 + (uint32_t)k);
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
        compare("large icosphere", &w,
                &(place){.mesh = mesh, .scale = 1.0, .distance = distances[k]}, 4,
                800 + (uint32_t)k);
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
        compare("soup", &w, &(place){.mesh = mesh, .scale = 1.0, .distance = 3.0}, 60,
                600 + (uint32_t)k);
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
        compare(round % 2 ? "many objects" : "few objects", &w,
                &(place){.mesh = mesh, .scale = 1.0, .distance = 3.0}, 10, 1000 + round);
        world_deinit(&w);
    }
}

typedef struct closed {
    const fl_compiled *compiled;
    const fl_mesh *mesh;
    fl_vec3 middle;
    double scale;
    world_rays rays;
    uint64_t ray_count;
} closed;

/* A ray through the surface, from inside or, beginning beyond it, inwards. */
static void add_crossing(closed *c, uint64_t seed)
{
    world_random random = {seed};
    fl_vec3 inside = world_around(&random, c->middle, 0, 0.5 * c->scale);
    fl_vec3 target = aim(&random, c->mesh);
    fl_vec3 d = fl_v3_sub(target, inside);
    if (world_bits(&random) & 1) {
        world_ray(&c->rays, inside, d);
    } else {
        world_ray(&c->rays, fl_v3_mad(inside, d, 10.0), fl_v3_scale(d, -1.0));
        c->rays.rays.t_max[c->rays.rays.count - 1] = 10.0f;
    }
}

/* From inside every ray must meet the closed surface; from outside, towards a point well inside
 * where it ends, too: what passes the near wall must not be stopped by the far one. */
static bool nothing_leaks(property *p, void *data)
{
    closed *c = data;
    uint32_t count = (uint32_t)property_given(p, BATCH, BATCH + 1);
    c->rays.rays.count = 0;
    for (uint32_t i = 0; i < count; i++) {
        property_mark(p);
        add_crossing(c, property_below(p, 0));
    }
    world_rays_finish(&c->rays);
    run(c->compiled, &c->rays, fl_cpu_best_isa());
    c->ray_count += count;
    for (uint32_t i = 0; i < count; i++)
        if (c->rays.hits.object[i] == FL_NONE || !c->rays.blocked[i])
            return note(p, "leak", &c->rays, i);
    return true;
}

static void closed_meshes_do_not_leak(void **state)
{
    static const struct {
        double scale, x;
    } cases[] = {{1, 0}, {1e-6, 0}, {1e-3, 1}, {1e6, 0}, {1, 1e5}, {1e-3, 1e3}, {10, -77}};
    static const fl_accel accels[] = {FL_ACCEL_BVH, FL_ACCEL_OCTREE, FL_ACCEL_NONE};
    (void)state;
    /* Again one ray that too small boxes lose. */
    static const uint64_t inwards[] = {1, 0xa4066f19f95c5c18};
    const property_case kept[] = {PROPERTY_CASE(inwards)};
    closed c = {0};
    world_rays_init(&c.rays, BATCH);
    for (uint32_t k = 0; k < FL_COUNT_OF(cases); k++) {
        fl_vec3 middle = fl_v3(cases[k].x, 0.3 * cases[k].x, 0);
        world w;
        world_init(&w);
        world_mesh(&w, world_add_mesh(&w, world_icosphere(3, 0.1, cases[k].scale, middle)));
        c.scale = cases[k].scale;
        c.ray_count = 0;
        for (size_t m = 0; m < FL_COUNT_OF(accels); m++) {
            fl_compiled *compiled = world_compile(&w, accels[m], NULL);
            c.compiled = compiled;
            c.middle = fl_v3_sub(middle, compiled->geometry.origin);
            fl_mesh *shifted = world_icosphere(3, 0.1, c.scale, c.middle);
            c.mesh = shifted;
            property_run(nothing_leaks, &c, 7000 + k, 8 * batches, kept, FL_COUNT_OF(kept));
            fl_mesh_release(shifted);
            fl_compiled_release(compiled);
        }
        print_message("closed sphere of size %g at %g: %llu rays\n", cases[k].scale, cases[k].x,
                      (unsigned long long)c.ray_count);
        world_deinit(&w);
    }
    world_rays_deinit(&c.rays);
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
