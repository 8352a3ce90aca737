/* SPDX-License-Identifier: MIT */
#include "isect_world.h"
#include "support/seed.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

uint64_t world_bits(world_random *random)
{
    return test_bits(&random->state);
}

double world_unit(world_random *random)
{
    return (double)(world_bits(random) >> 11) * 0x1p-53;
}

double world_between(world_random *random, double lo, double hi)
{
    return lo + (hi - lo) * world_unit(random);
}

/* Draws stand in statements of their own: C leaves the order of a call's arguments open. */
fl_vec3 world_point(world_random *random)
{
    fl_vec3 p;
    p.x = world_between(random, -1, 1);
    p.y = world_between(random, -1, 1);
    p.z = world_between(random, -1, 1);
    return p;
}

fl_vec3 world_direction(world_random *random)
{
    for (;;) {
        fl_vec3 d = world_point(random);
        double length = fl_v3_length(d);
        if (length > 0.01 && length <= 1.0)
            return fl_v3_scale(d, 1.0 / length);
    }
}

fl_vec3 world_around(world_random *random, fl_vec3 center, double lo, double hi)
{
    fl_vec3 d = world_direction(random);
    return fl_v3_mad(center, d, world_between(random, lo, hi));
}

void world_init(world *w)
{
    memset(w, 0, sizeof *w);
    w->material = (fl_material){.diffuse = {1, 1, 1}, .refraction_index = 1, .image = FL_NONE};
    w->scene = (fl_scene){.path = "test",
                          .objects = w->objects,
                          .transforms = w->transforms,
                          .materials = &w->material,
                          .material_count = 1,
                          .meshes = w->meshes,
                          .profiles = w->profiles};
    for (int k = 0; k < FL_CUBE_FACES; k++)
        w->scene.background.cube_image[k] = FL_NONE;
}

void world_deinit(world *w)
{
    for (uint32_t k = 0; k < w->scene.mesh_count; k++)
        fl_mesh_release(w->meshes[k].mesh);
}

uint32_t world_transform(world *w, fl_affine m)
{
    assert_true(w->scene.transform_count < WORLD_OBJECTS_MAX);
    w->transforms[w->scene.transform_count] = m;
    return w->scene.transform_count++;
}

fl_affine world_affine(world_random *random, fl_vec3 scale, fl_vec3 move)
{
    fl_vec3 x = world_direction(random);
    fl_vec3 y = world_direction(random);
    y = fl_v3_normalize(fl_v3_mad(y, x, -fl_v3_dot(x, y)));
    fl_vec3 z = fl_v3_cross(x, y);
    return (fl_affine){{{x.x * scale.x, y.x * scale.y, z.x * scale.z, move.x},
                        {x.y * scale.x, y.y * scale.y, z.y * scale.z, move.y},
                        {x.z * scale.x, y.z * scale.y, z.z * scale.z, move.z}}};
}

static fl_object *add_object(world *w, fl_object_kind kind)
{
    assert_true(w->scene.object_count < WORLD_OBJECTS_MAX);
    uint32_t at = w->scene.object_count++;
    w->objects[at] = (fl_object){
        .kind = kind, .transform = FL_NONE, .loc = {.file = "test", .line = at + 1, .column = 1}};
    return &w->objects[at];
}

fl_object *world_sphere(world *w, fl_vec3 center, double radius)
{
    fl_object *object = add_object(w, FL_OBJECT_SPHERE);
    object->as.sphere.center = center;
    object->as.sphere.radius = radius;
    return object;
}

fl_object *world_plane(world *w, fl_vec3 normal, double offset)
{
    fl_object *object = add_object(w, FL_OBJECT_PLANE);
    object->as.plane.normal = normal;
    object->as.plane.offset = offset;
    return object;
}

fl_object *world_square(world *w, fl_vec3 corner, fl_vec3 u, fl_vec3 v)
{
    fl_object *object = add_object(w, FL_OBJECT_SQUARE);
    object->as.square.corner = corner;
    object->as.square.u = u;
    object->as.square.v = v;
    return object;
}

fl_object *world_disk(world *w, fl_vec3 center, fl_vec3 normal, double radius)
{
    fl_object *object = add_object(w, FL_OBJECT_DISK);
    object->as.disk.center = center;
    object->as.disk.normal = normal;
    object->as.disk.radius = radius;
    return object;
}

fl_object *world_triangle(world *w, fl_vec3 a, fl_vec3 b, fl_vec3 c)
{
    fl_object *object = add_object(w, FL_OBJECT_TRIANGLE);
    object->as.triangle.vertex[0] = a;
    object->as.triangle.vertex[1] = b;
    object->as.triangle.vertex[2] = c;
    return object;
}

fl_object *world_revolution(world *w)
{
    static const fl_vec3 points[4] = {{0.4, -1, 0}, {1.4, -0.3, 0}, {0.1, 0.3, 0}, {0.7, 1, 0}};
    if (w->scene.profile_count == 0) {
        memcpy(w->profile_points, points, sizeof points);
        w->profiles[w->scene.profile_count++] =
            (fl_profile){.points = w->profile_points, .segment_count = 1, .degree = 3};
    }
    fl_object *object = add_object(w, FL_OBJECT_REVOLUTION);
    object->as.revolution.image = FL_NONE;
    return object;
}

uint32_t world_add_mesh(world *w, fl_mesh *mesh)
{
    assert_true(w->scene.mesh_count < WORLD_MESHES_MAX);
    assert_non_null(mesh);
    w->meshes[w->scene.mesh_count] = (fl_scene_mesh){.path = "mesh", .mesh = mesh};
    return w->scene.mesh_count++;
}

fl_object *world_mesh(world *w, uint32_t mesh)
{
    fl_object *object = add_object(w, FL_OBJECT_MESH);
    object->as.mesh.mesh = mesh;
    return object;
}

static fl_mesh *mesh_with_room(uint32_t position_count, uint32_t face_count)
{
    fl_mesh *mesh = fl_mesh_create();
    assert_non_null(mesh);
    mesh->positions = malloc(position_count * sizeof *mesh->positions);
    mesh->faces = malloc(face_count * sizeof *mesh->faces);
    assert_true(mesh->positions && mesh->faces);
    return mesh;
}

static void add_face(fl_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    mesh->faces[mesh->face_count++] =
        (fl_face){{a, b, c}, {FL_NONE, FL_NONE, FL_NONE}, {FL_NONE, FL_NONE, FL_NONE}};
}

/* The corner between a and b, made once: a chain for each lower corner. */
static uint32_t midpoint(fl_mesh *mesh, uint32_t a, uint32_t b, uint32_t *first, uint32_t *next,
                         uint32_t *other)
{
    uint32_t lo = a < b ? a : b, hi = a < b ? b : a;
    for (uint32_t k = first[lo]; k != FL_NONE; k = next[k])
        if (other[k] == hi)
            return k;
    uint32_t made = mesh->position_count++;
    mesh->positions[made] = fl_v3_normalize(fl_v3_add(mesh->positions[a], mesh->positions[b]));
    other[made] = hi;
    next[made] = first[lo];
    first[lo] = made;
    return made;
}

static void refine(fl_mesh *mesh, uint32_t position_count)
{
    uint32_t face_count = mesh->face_count;
    fl_face *coarse = malloc(face_count * sizeof *coarse);
    uint32_t *chain = malloc(3 * (size_t)position_count * sizeof *chain);
    assert_true(coarse && chain);
    memcpy(coarse, mesh->faces, face_count * sizeof *coarse);
    memset(chain, 0xff, 3 * (size_t)position_count * sizeof *chain);
    uint32_t *first = chain, *next = chain + position_count, *other = next + position_count;
    mesh->face_count = 0;
    for (uint32_t f = 0; f < face_count; f++) {
        const uint32_t *v = coarse[f].position;
        uint32_t a = midpoint(mesh, v[0], v[1], first, next, other);
        uint32_t b = midpoint(mesh, v[1], v[2], first, next, other);
        uint32_t c = midpoint(mesh, v[2], v[0], first, next, other);
        add_face(mesh, v[0], a, c);
        add_face(mesh, v[1], b, a);
        add_face(mesh, v[2], c, b);
        add_face(mesh, a, b, c);
    }
    free(coarse);
    free(chain);
}

fl_mesh *world_icosphere(uint32_t level, double roughness, double scale, fl_vec3 move)
{
    static const uint8_t faces[20][3] = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    const double g = 1.6180339887498949;
    const fl_vec3 corners[12] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                 {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                 {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    uint32_t face_count = 20u << 2 * level, position_count = face_count / 2 + 2;
    fl_mesh *mesh = mesh_with_room(position_count, face_count);
    for (uint32_t k = 0; k < 12; k++)
        mesh->positions[mesh->position_count++] = fl_v3_normalize(corners[k]);
    for (uint32_t k = 0; k < 20; k++)
        add_face(mesh, faces[k][0], faces[k][1], faces[k][2]);
    for (uint32_t k = 0; k < level; k++)
        refine(mesh, position_count);
    assert_int_equal(mesh->position_count, position_count);
    world_random random = {position_count};
    for (uint32_t k = 0; k < position_count; k++) {
        double r = scale * (1.0 + roughness * world_between(&random, -1, 1));
        mesh->positions[k] = fl_v3_mad(move, mesh->positions[k], r);
    }
    return mesh;
}

fl_mesh *world_soup(world_random *random, uint32_t count, double side, double scale, fl_vec3 move)
{
    fl_mesh *mesh = mesh_with_room(3 * count, count);
    for (uint32_t f = 0; f < count; f++) {
        fl_vec3 a = world_point(random);
        fl_vec3 u = world_around(random, fl_v3(0, 0, 0), 0, side);
        fl_vec3 v = world_around(random, fl_v3(0, 0, 0), 0, side);
        uint32_t shape = (uint32_t)(world_bits(random) % 16);
        if (shape < 3)
            v = fl_v3_mad(fl_v3_scale(v, shape == 0 ? 1e-6 : 1e-4), u, 0.5); /* a needle */
        else if (shape == 3)
            v = fl_v3_scale(u, 2.0); /* a line */
        else if (shape == 4)
            u = v = fl_v3(0, 0, 0); /* a point */
        for (int k = 0; k < 3; k++) {
            fl_vec3 p = k == 0 ? a : fl_v3_add(a, k == 1 ? u : v);
            mesh->positions[mesh->position_count++] = fl_v3_mad(move, p, scale);
        }
        add_face(mesh, 3 * f, 3 * f + 1, 3 * f + 2);
    }
    return mesh;
}

fl_compiled *world_compile(const world *w, fl_accel accel, fl_pool *pool)
{
    fl_diags diags = {0};
    fl_compile_options options = {.accel = accel};
    fl_compiled *compiled = fl_compile(&w->scene, &options, pool, &diags);
    if (!compiled && diags.count)
        fail_msg("compile: %s", diags.items[0].message);
    assert_non_null(compiled);
    fl_diags_deinit(&diags);
    return compiled;
}

void world_rays_init(world_rays *r, uint32_t capacity)
{
    enum { ARRAYS = 9 + 3 + 1 + 12 };
    assert_true(capacity % 8 == 0);
    uint32_t stride = (capacity + 15) / 16 * 16;
    float *a = aligned_alloc(64, (size_t)stride * ARRAYS * sizeof *a);
    assert_non_null(a);
    *r = (world_rays){.memory = a};
    float **floats[] = {&r->rays.ox,     &r->rays.oy,        &r->rays.oz,     &r->rays.dx,
                        &r->rays.dy,     &r->rays.dz,        &r->rays.t_max,  &r->hits.t,
                        &r->surface.px,  &r->surface.py,     &r->surface.pz,  &r->surface.ngx,
                        &r->surface.ngy, &r->surface.ngz,    &r->surface.nsx, &r->surface.nsy,
                        &r->surface.nsz, &r->surface.offset, &r->surface.u,   &r->surface.v};
    uint32_t **words[] = {&r->rays.source_object, &r->rays.source_prim, &r->hits.object,
                          &r->hits.prim, &r->blocked};
    for (size_t k = 0; k < FL_COUNT_OF(floats); k++, a += stride)
        *floats[k] = a;
    for (size_t k = 0; k < FL_COUNT_OF(words); k++, a += stride)
        *words[k] = (uint32_t *)(void *)a;
    r->rays.capacity = capacity;
}

void world_rays_deinit(world_rays *r)
{
    free(r->memory);
}

void world_ray(world_rays *r, fl_vec3 o, fl_vec3 d)
{
    assert_true(r->rays.count < r->rays.capacity);
    fl_rays_set(&r->rays, r->rays.count++, o, d, INFINITY);
}

void world_rays_finish(world_rays *r)
{
    for (uint32_t i = r->rays.count; i % 8 != 0; i++)
        fl_rays_set(&r->rays, i, fl_v3(0, 0, 0), fl_v3(0, 0, 1), -1.0f);
}

const fl_isect_kernels *world_kernels(fl_isa isa)
{
    return fl_cpu_has(isa) ? fl_isect_kernels_of(isa) : NULL;
}
