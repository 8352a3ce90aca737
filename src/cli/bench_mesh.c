/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/bench_work.h"
#include "io/mesh_file.h"
#include "io/path.h"

static bool allocate(bench_mesh *out, uint32_t position_count, uint32_t face_count, fl_diags *diags)
{
    out->position_count = position_count;
    out->face_count = face_count;
    out->position = calloc(3 * (size_t)position_count + 4, sizeof *out->position);
    out->index = calloc(3 * (size_t)face_count, sizeof *out->index);
    return (out->position && out->index) || fl_out_of_memory(diags, "a mesh to measure on");
}

void bench_mesh_deinit(bench_mesh *mesh)
{
    free(mesh->position);
    free(mesh->index);
    *mesh = (bench_mesh){0};
}

/* Two triangles at the bottom of the box [-1, 1], five times as wide. */
static void add_ground(bench_mesh *out, uint32_t position, uint32_t face, float height)
{
    for (uint32_t k = 0; k < 4; k++) {
        float *p = out->position + 3 * (size_t)(position + k);
        p[0] = k & 1 ? 5.0f : -5.0f;
        p[1] = height;
        p[2] = k & 2 ? 5.0f : -5.0f;
    }
    const uint32_t corners[6] = {0, 2, 1, 1, 2, 3};
    for (uint32_t k = 0; k < 6; k++)
        out->index[3 * (size_t)face + k] = position + corners[k];
}

bool bench_mesh_load(const char *path, bench_mesh *out, fl_diags *diags)
{
    fl_mesh *mesh = fl_mesh_load(path, (fl_loc){.file = path}, diags);
    if (!mesh)
        return false;
    snprintf(out->name, sizeof out->name, "%s", fl_path_name(path));
    bool ok = allocate(out, mesh->position_count + 4, mesh->face_count + 2, diags);
    fl_box box = fl_box_empty();
    for (uint32_t f = 0; ok && f < mesh->face_count; f++)
        for (int k = 0; k < 3; k++) {
            uint32_t at = mesh->faces[f].position[k];
            out->index[3 * (size_t)f + (size_t)k] = at;
            box = fl_box_grow(box, mesh->positions[at]);
        }
    fl_vec3 center = fl_v3_scale(fl_v3_add(box.lo, box.hi), 0.5), size = fl_v3_sub(box.hi, box.lo);
    double scale = 2.0 / fl_max(fl_v3_max_abs(size), 1e-300);
    for (uint32_t i = 0; ok && i < mesh->position_count; i++) {
        fl_vec3 p = fl_v3_scale(fl_v3_sub(mesh->positions[i], center), scale);
        float xyz[3] = {(float)p.x, (float)p.y, (float)p.z};
        memcpy(out->position + 3 * (size_t)i, xyz, sizeof xyz);
    }
    if (ok)
        add_ground(out, mesh->position_count, mesh->face_count, (float)(-0.5 * size.y * scale));
    fl_mesh_release(mesh);
    return ok;
}

/* A point of the cube [-1, 1]^3 pushed to the sphere, which depends on the point alone: faces of
 * the cube meet without cracks. */
static void sphere_point(const double cube[3], float out[3])
{
    fl_vec3 n = fl_v3_normalize(fl_v3(cube[0], cube[1], cube[2]));
    double bump = 0.06 * sin(9.0 * n.x) * sin(8.0 * n.y + 1.0) * sin(7.0 * n.z + 2.0) +
                  0.012 * sin(41.0 * n.x + 3.0) * sin(37.0 * n.y) * sin(43.0 * n.z);
    double r = 0.9 + bump;
    out[0] = (float)(r * n.x);
    out[1] = (float)(r * n.y);
    out[2] = (float)(r * n.z);
}

bool bench_mesh_sphere(uint32_t face_count, bench_mesh *out, fl_diags *diags)
{
    uint32_t n = (uint32_t)ceil(sqrt(face_count / 12.0)), row = n + 1;
    if (face_count >= 1000000)
        snprintf(out->name, sizeof out->name, "sphere_%uM", face_count / 1000000);
    else
        snprintf(out->name, sizeof out->name, "sphere_%u", face_count);
    if (!allocate(out, 6 * row * row, 12 * n * n, diags))
        return false;
    float *p = out->position;
    uint32_t *index = out->index;
    for (uint32_t side = 0; side < 6; side++) {
        uint32_t axis = side / 2, base = side * row * row;
        for (uint32_t j = 0; j < row; j++)
            for (uint32_t i = 0; i < row; i++, p += 3) {
                double cube[3];
                cube[axis] = side & 1 ? 1.0 : -1.0;
                cube[(axis + 1) % 3] = 2.0 * i / n - 1.0;
                cube[(axis + 2) % 3] = 2.0 * j / n - 1.0;
                sphere_point(cube, p);
            }
        for (uint32_t j = 0; j < n; j++)
            for (uint32_t i = 0; i < n; i++, index += 6) {
                uint32_t a = base + j * row + i, b = a + 1, c = a + row, d = c + 1;
                const uint32_t up[6] = {a, b, d, a, d, c}, down[6] = {a, d, b, a, c, d};
                memcpy(index, side & 1 ? up : down, sizeof up);
            }
    }
    return true;
}

fl_mesh *bench_mesh_create(const bench_mesh *mesh, fl_diags *diags)
{
    fl_mesh *copy = fl_mesh_create();
    if (!copy) {
        fl_out_of_memory(diags, "a mesh to measure on");
        return NULL;
    }
    copy->position_count = mesh->position_count;
    copy->face_count = mesh->face_count;
    copy->positions = calloc(mesh->position_count, sizeof *copy->positions);
    copy->faces = calloc(mesh->face_count, sizeof *copy->faces);
    if (!copy->positions || !copy->faces) {
        fl_mesh_release(copy);
        fl_out_of_memory(diags, "a mesh to measure on");
        return NULL;
    }
    for (uint32_t i = 0; i < mesh->position_count; i++) {
        const float *p = mesh->position + 3 * (size_t)i;
        copy->positions[i] = fl_v3((double)p[0], (double)p[1], (double)p[2]);
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        fl_face *face = &copy->faces[f];
        memset(face, 0xff, sizeof *face);
        memcpy(face->position, mesh->index + 3 * (size_t)f, sizeof face->position);
    }
    return copy;
}

/* The scene has what compile needs, and nothing else. */
fl_compiled *bench_mesh_compile_copy(fl_mesh *copy, const char *name,
                                     const fl_compile_options *options, fl_pool *pool,
                                     fl_diags *diags)
{
    fl_object object = {.kind = FL_OBJECT_MESH,
                        .transform = FL_NONE,
                        .as.mesh = {.mesh = 0, .normals = FL_NORMALS_FLAT}};
    fl_material material = {.diffuse = {1, 1, 1}, .refraction_index = 1, .image = FL_NONE};
    fl_scene_mesh row = {.path = name, .mesh = copy};
    fl_scene scene = {.path = name,
                      .objects = &object,
                      .object_count = 1,
                      .materials = &material,
                      .material_count = 1,
                      .meshes = &row,
                      .mesh_count = 1};
    for (int k = 0; k < FL_CUBE_FACES; k++)
        scene.background.cube_image[k] = FL_NONE;
    return fl_compile(&scene, options, pool, diags);
}

fl_compiled *bench_mesh_compile(const bench_mesh *mesh, const fl_compile_options *options,
                                fl_pool *pool, fl_diags *diags)
{
    fl_mesh *copy = bench_mesh_create(mesh, diags);
    fl_compiled *compiled =
        copy ? bench_mesh_compile_copy(copy, mesh->name, options, pool, diags) : NULL;
    fl_mesh_release(copy);
    return compiled;
}
