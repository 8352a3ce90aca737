/* SPDX-License-Identifier: MIT
 *
 * Meshes: one stored form for every (mesh, kind of normals) in use, an instance an object. Loose
 * triangles become one mesh for each transform among them.
 */
#include <string.h>

#include "core/compile_build.h"

/* What decides whether two objects can share the stored form. */
typedef struct mesh_key {
    uint32_t mesh;
    fl_normals normals;
    bool needs_uv, has_identity_user;
    uint32_t stored; /* Index into geometry.meshes. */
} mesh_key;

static bool has_file_normals(const fl_mesh *mesh)
{
    for (uint32_t f = 0; f < mesh->face_count; f++)
        for (int k = 0; k < 3; k++)
            if (mesh->faces[f].normal[k] == FL_NONE)
                return false;
    return mesh->normal_count > 0;
}

/* Decision 14. */
static fl_normals normals_in_use(const fl_compiler *c, const fl_mesh *mesh, fl_normals wanted)
{
    if (wanted != FL_NORMALS_AUTO)
        return wanted;
    if (c->scene->dialect == FL_DIALECT_PA1 || c->scene->dialect == FL_DIALECT_M04)
        return FL_NORMALS_FLAT;
    return has_file_normals(mesh) ? FL_NORMALS_FILE : FL_NORMALS_SMOOTH;
}

static bool has_texture(const fl_compiler *c, const fl_object *object)
{
    return object->material < c->scene->material_count &&
           c->scene->materials[object->material].image != FL_NONE;
}

/* --- The stored form ------------------------------------------------------------------------- */

/* Room for the arrays that every mesh has. */
static bool allocate_mesh(fl_compiler *c, fl_tri_mesh *out, uint32_t position_count,
                          uint32_t face_count)
{
    fl_arena *arena = &c->out->arena;
    out->position_count = position_count;
    out->face_count = face_count;
    out->position = fl_arena_alloc(arena, position_count, 3 * sizeof *out->position);
    out->index = fl_arena_alloc(arena, face_count, 3 * sizeof *out->index);
    return (out->position && out->index) || fl_out_of_memory(c->diags, "a mesh");
}

static void store_vec3(float *array, uint32_t at, fl_vec3 v)
{
    array[3 * (size_t)at] = (float)v.x;
    array[3 * (size_t)at + 1] = (float)v.y;
    array[3 * (size_t)at + 2] = (float)v.z;
}

/* Box of the faces' corners as stored. */
static void bound_mesh(fl_tri_mesh *m)
{
    for (int a = 0; a < 3; a++) {
        m->box_lo[a] = INFINITY;
        m->box_hi[a] = -INFINITY;
    }
    for (size_t i = 0; i < 3 * (size_t)m->face_count; i++)
        for (int a = 0; a < 3; a++) {
            float x = m->position[3 * (size_t)m->index[i] + (size_t)a];
            m->box_lo[a] = x < m->box_lo[a] ? x : m->box_lo[a];
            m->box_hi[a] = x > m->box_hi[a] ? x : m->box_hi[a];
        }
}

static bool store_normals(fl_compiler *c, fl_tri_mesh *out, const fl_mesh *mesh, fl_normals how)
{
    fl_arena *arena = &c->out->arena;
    if (how == FL_NORMALS_FLAT)
        return true;
    bool is_file = how == FL_NORMALS_FILE;
    uint32_t count = is_file ? mesh->normal_count : mesh->position_count;
    fl_arena scratch = {0};
    fl_vec3 *smooth = is_file ? NULL : fl_arena_alloc(&scratch, count, sizeof *smooth);
    out->normal = fl_arena_alloc(arena, count, 3 * sizeof *out->normal);
    out->normal_index = is_file
                            ? fl_arena_alloc(arena, out->face_count, 3 * sizeof *out->normal_index)
                            : out->index;
    if (!out->normal || !out->normal_index || (!is_file && !smooth)) {
        fl_arena_deinit(&scratch);
        return fl_out_of_memory(c->diags, "the normals of a mesh");
    }
    if (!is_file)
        fl_mesh_vertex_normals(mesh, how, smooth);
    for (uint32_t i = 0; i < count; i++)
        store_vec3(out->normal, i, is_file ? fl_v3_normalize(mesh->normals[i]) : smooth[i]);
    for (uint32_t f = 0; is_file && f < mesh->face_count; f++)
        memcpy(&out->normal_index[3 * (size_t)f], mesh->faces[f].normal,
               sizeof mesh->faces[f].normal);
    fl_arena_deinit(&scratch);
    c->out->needs |= FL_NEED_SHADING_NORMALS;
    return true;
}

static bool store_uv(fl_compiler *c, fl_tri_mesh *out, const fl_mesh *mesh)
{
    fl_arena *arena = &c->out->arena;
    out->uv = fl_arena_alloc(arena, mesh->uv_count, 2 * sizeof *out->uv);
    out->uv_index = fl_arena_alloc(arena, mesh->face_count, 3 * sizeof *out->uv_index);
    if (!out->uv || !out->uv_index)
        return fl_out_of_memory(c->diags, "the texture coordinates of a mesh");
    for (uint32_t i = 0; i < mesh->uv_count; i++) {
        out->uv[2 * (size_t)i] = mesh->uvs[i].u;
        out->uv[2 * (size_t)i + 1] = mesh->uvs[i].v;
    }
    for (uint32_t f = 0; f < mesh->face_count; f++)
        memcpy(&out->uv_index[3 * (size_t)f], mesh->faces[f].uv, sizeof mesh->faces[f].uv);
    return true;
}

static fl_box used_box(const fl_mesh *mesh)
{
    fl_box box = fl_box_empty();
    for (uint32_t f = 0; f < mesh->face_count; f++)
        for (int k = 0; k < 3; k++)
            box = fl_box_grow(box, mesh->positions[mesh->faces[f].position[k]]);
    return box;
}

static bool store_mesh(fl_compiler *c, const fl_mesh *mesh, const mesh_key *key, fl_loc loc)
{
    fl_tri_mesh *out = &c->geometry->meshes[key->stored];
    fl_box box = used_box(mesh);
    out->origin =
        key->has_identity_user ? fl_compile_vertex_origin(c, box) : fl_compile_box_origin(box);
    fl_box local = {fl_v3_sub(box.lo, out->origin), fl_v3_sub(box.hi, out->origin)};
    if (key->normals == FL_NORMALS_FILE && !has_file_normals(mesh))
        return fl_error(c->diags, loc,
                        "'normals file', but not every face of the mesh has normals");
    if (!fl_compile_check_box(c, local, loc) ||
        !allocate_mesh(c, out, mesh->position_count, mesh->face_count))
        return false;
    for (uint32_t i = 0; i < mesh->position_count; i++)
        store_vec3(out->position, i, fl_v3_sub(mesh->positions[i], out->origin));
    for (uint32_t f = 0; f < mesh->face_count; f++)
        memcpy(&out->index[3 * (size_t)f], mesh->faces[f].position, sizeof mesh->faces[f].position);
    bound_mesh(out);
    if (!store_normals(c, out, mesh, key->normals))
        return false;
    if (key->needs_uv && mesh->uv_count > 0 && !store_uv(c, out, mesh))
        return false;
    c->out->triangle_count += mesh->face_count;
    return fl_compile_is_large(c, out) || fl_compile_accel(c, out);
}

/* The largest face, by the longest side of its box. */
static double face_size(const fl_tri_mesh *m)
{
    float largest = 0.0f;
    for (uint32_t f = 0; f < m->face_count; f++)
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) {
                const uint32_t *at = m->index + 3 * (size_t)f;
                float side = fabsf(m->position[3 * (size_t)at[k] + (size_t)a] -
                                   m->position[3 * (size_t)at[(k + 1) % 3] + (size_t)a]);
                largest = side > largest ? side : largest;
            }
    return (double)largest;
}

static bool add_instance(fl_compiler *c, uint32_t object, uint32_t named, uint32_t stored,
                         double size)
{
    const fl_tri_mesh *m = &c->geometry->meshes[stored];
    fl_box box = {fl_v3((double)m->box_lo[0], (double)m->box_lo[1], (double)m->box_lo[2]),
                  fl_v3((double)m->box_hi[0], (double)m->box_hi[1], (double)m->box_hi[2])};
    c->out->instanced_triangle_count += m->face_count;
    return fl_compile_instance(c, &c->scene->objects[object], named, FL_OBJECT_MESH, stored,
                               m->origin, box, size);
}

/* --- Meshes of the scene --------------------------------------------------------------------- */

static bool is_identity_object(const fl_compiler *c, const fl_object *object)
{
    fl_affine m = fl_compile_transform(c, object);
    return fl_affine_is_identity(&m);
}

/* The key of each mesh object, by index into `keys`. */
static uint32_t collect_keys(fl_compiler *c, mesh_key *keys, uint32_t *first_key_of_mesh,
                             uint32_t *next_key)
{
    const fl_scene *scene = c->scene;
    uint32_t key_count = 0;
    memset(first_key_of_mesh, 0xff, scene->mesh_count * sizeof *first_key_of_mesh);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const fl_object *object = &scene->objects[i];
        const fl_mesh *mesh =
            object->kind == FL_OBJECT_MESH ? scene->meshes[object->as.mesh.mesh].mesh : NULL;
        if (!mesh || mesh->face_count == 0)
            continue;
        fl_normals normals = normals_in_use(c, mesh, object->as.mesh.normals);
        uint32_t k = first_key_of_mesh[object->as.mesh.mesh];
        while (k != FL_NONE && keys[k].normals != normals)
            k = next_key[k];
        if (k == FL_NONE) {
            k = key_count++;
            keys[k] = (mesh_key){.mesh = object->as.mesh.mesh, .normals = normals, .stored = k};
            next_key[k] = first_key_of_mesh[object->as.mesh.mesh];
            first_key_of_mesh[object->as.mesh.mesh] = k;
        }
        keys[k].needs_uv |= has_texture(c, object);
        keys[k].has_identity_user |= is_identity_object(c, object);
        c->geometry->object_entry[i] = k;
    }
    return key_count;
}

static bool compile_scene_meshes(fl_compiler *c, fl_arena *scratch)
{
    const fl_scene *scene = c->scene;
    fl_geometry *g = c->geometry;
    uint32_t object_count = scene->object_count;
    mesh_key *keys = fl_arena_alloc(scratch, object_count, sizeof *keys);
    uint32_t *first = fl_arena_alloc(scratch, scene->mesh_count, sizeof *first);
    uint32_t *next = fl_arena_alloc(scratch, object_count, sizeof *next);
    double *sizes = fl_arena_alloc(scratch, object_count, sizeof *sizes);
    if (!keys || !first || !next || !sizes)
        return fl_out_of_memory(c->diags, "the scene's meshes");
    g->mesh_count = collect_keys(c, keys, first, next);
    bool ok = true;
    for (uint32_t i = 0; i < object_count && ok; i++) {
        const fl_object *object = &scene->objects[i];
        uint32_t k = g->object_entry[i];
        if (object->kind != FL_OBJECT_MESH || k == FL_NONE)
            continue;
        if (!g->meshes[k].position) {
            ok = store_mesh(c, scene->meshes[object->as.mesh.mesh].mesh, &keys[k], object->loc);
            sizes[k] = ok ? face_size(&g->meshes[k]) : 0.0;
        }
        ok = ok && add_instance(c, i, i, k, sizes[k]);
        c->out->needs |= FL_NEED_TRIANGLES;
    }
    return ok;
}

/* --- Loose triangles ------------------------------------------------------------------------- */

/* Gather the `count` ones that next[] links from first_object on: all of one transform. */
static bool compile_loose(fl_compiler *c, uint32_t count, uint32_t first_object,
                          const uint32_t *next)
{
    const fl_scene *scene = c->scene;
    fl_geometry *g = c->geometry;
    uint32_t stored = g->mesh_count++, face = 0;
    fl_tri_mesh *m = &g->meshes[stored];
    fl_box box = fl_box_empty();
    if (!allocate_mesh(c, m, 3 * count, count))
        return false;
    m->face_object = fl_arena_alloc(&c->out->arena, count, sizeof *m->face_object);
    if (!m->face_object)
        return fl_out_of_memory(c->diags, "the scene's triangles");
    for (uint32_t i = first_object; i != FL_NONE; i = next[i]) {
        const fl_object *object = &scene->objects[i];
        for (int k = 0; k < 3; k++)
            box = fl_box_grow(box, object->as.triangle.vertex[k]);
        if (!fl_compile_check_box(c, box, object->loc))
            return false;
        g->object_entry[i] = face;
        g->object_instance[i] = g->instance_count;
        m->face_object[face++] = i;
    }
    bool is_identity = is_identity_object(c, &scene->objects[first_object]);
    m->origin = is_identity ? fl_compile_vertex_origin(c, box) : fl_compile_box_origin(box);
    for (uint32_t f = 0; f < count; f++)
        for (uint32_t k = 0; k < 3; k++) {
            const fl_vec3 *vertex = scene->objects[m->face_object[f]].as.triangle.vertex;
            store_vec3(m->position, 3 * f + k, fl_v3_sub(vertex[k], m->origin));
            m->index[3 * (size_t)f + k] = 3 * f + k;
        }
    bound_mesh(m);
    c->out->triangle_count += count;
    c->out->needs |= FL_NEED_TRIANGLES;
    return (fl_compile_is_large(c, m) || fl_compile_accel(c, m)) &&
           add_instance(c, first_object, FL_NONE, stored, face_size(m));
}

static bool compile_loose_triangles(fl_compiler *c, fl_arena *scratch)
{
    const fl_scene *scene = c->scene;
    uint32_t group_count = scene->transform_count + 1; /* The last is the identity. */
    uint32_t *count = fl_arena_alloc(scratch, group_count, sizeof *count);
    uint32_t *first = fl_arena_alloc(scratch, group_count, sizeof *first);
    uint32_t *next = fl_arena_alloc(scratch, scene->object_count, sizeof *next);
    if (!count || !first || !next)
        return fl_out_of_memory(c->diags, "the scene's triangles");
    for (uint32_t i = scene->object_count; i-- > 0;) {
        uint32_t group = fl_min_u32(scene->objects[i].transform, scene->transform_count);
        if (scene->objects[i].kind != FL_OBJECT_TRIANGLE)
            continue;
        next[i] = count[group]++ ? first[group] : FL_NONE;
        first[group] = i;
    }
    for (uint32_t k = 0; k < group_count; k++)
        if (count[k] && !compile_loose(c, count[k], first[k], next))
            return false;
    return true;
}

bool fl_compile_meshes(fl_compiler *c)
{
    fl_geometry *g = c->geometry;
    size_t most = (size_t)c->scene->object_count;
    g->meshes = fl_arena_alloc(&c->out->arena, most, sizeof *g->meshes);
    if (!g->meshes)
        return fl_out_of_memory(c->diags, "the scene's meshes");
    fl_arena scratch = {0};
    bool ok = compile_scene_meshes(c, &scratch) && compile_loose_triangles(c, &scratch);
    fl_arena_deinit(&scratch);
    return ok;
}
