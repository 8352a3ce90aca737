/* SPDX-License-Identifier: MIT */
#include "core/scene_map.h"

#include <stdlib.h>
#include <string.h>

typedef struct mapping {
    fl_scene *scene;
    double scale;
    fl_vec3 offset;
    fl_diags *diags;
} mapping;

static fl_vec3 grown(const mapping *m, fl_vec3 v)
{
    return fl_v3_scale(v, m->scale);
}

static fl_vec3 mapped(const mapping *m, fl_vec3 p)
{
    return fl_v3_mad(m->offset, p, m->scale);
}

static bool is_moved(const mapping *m)
{
    return fl_v3_max_abs(m->offset) > 0.0;
}

static void map_camera(const mapping *m, fl_camera *camera)
{
    camera->center = mapped(m, camera->center);
    camera->ortho_size *= m->scale;
    camera->aperture *= m->scale;
    camera->focus *= m->scale;
}

/* Intensity at a distance stays what it was at the old one. */
static void map_light(const mapping *m, fl_light *light)
{
    light->position = mapped(m, light->position);
    light->radius *= m->scale;
    light->attenuation[1] /= m->scale;
    light->attenuation[2] /= m->scale;
    light->attenuation[2] /= m->scale;
}

/* A mesh may be shared with other scenes, so it is copied. NULL: out of memory. */
static fl_mesh *grown_mesh(const mapping *m, const fl_mesh *mesh)
{
    fl_mesh *copy = fl_mesh_create();
    if (!copy)
        return NULL;
    copy->position_count = mesh->position_count;
    copy->normal_count = mesh->normal_count;
    copy->uv_count = mesh->uv_count;
    copy->face_count = mesh->face_count;
    copy->positions = malloc((size_t)mesh->position_count * sizeof *copy->positions + 1);
    copy->normals = malloc((size_t)mesh->normal_count * sizeof *copy->normals + 1);
    copy->uvs = malloc((size_t)mesh->uv_count * sizeof *copy->uvs + 1);
    copy->faces = malloc((size_t)mesh->face_count * sizeof *copy->faces + 1);
    if (!copy->positions || !copy->normals || !copy->uvs || !copy->faces) {
        fl_mesh_release(copy);
        return NULL;
    }
    for (uint32_t i = 0; i < mesh->position_count; i++)
        copy->positions[i] = grown(m, mesh->positions[i]);
    if (mesh->normal_count)
        memcpy(copy->normals, mesh->normals, mesh->normal_count * sizeof *copy->normals);
    if (mesh->uv_count)
        memcpy(copy->uvs, mesh->uvs, mesh->uv_count * sizeof *copy->uvs);
    if (mesh->face_count)
        memcpy(copy->faces, mesh->faces, mesh->face_count * sizeof *copy->faces);
    return copy;
}

static bool map_meshes(const mapping *m)
{
    for (uint32_t i = 0; i < m->scene->mesh_count; i++) {
        fl_scene_mesh *entry = &m->scene->meshes[i];
        if (!entry->mesh)
            continue;
        fl_mesh *copy = grown_mesh(m, entry->mesh);
        if (!copy)
            return fl_out_of_memory(m->diags, "a mesh of another size");
        fl_mesh_release(entry->mesh);
        entry->mesh = copy;
    }
    return true;
}

/* --- Objects -----------------------------------------------------------------------------------
 */

static bool has_own_space(const fl_scene *scene, const fl_object *object)
{
    return object->transform != FL_NONE &&
           !fl_affine_is_identity(&scene->transforms[object->transform]);
}

/* What cannot be moved by its numbers: curves turn about the y axis, meshes are shared, and the
 * texture of a plane counts from the origin of its space. */
static bool needs_transform(const fl_scene *scene, const fl_object *object)
{
    return object->kind == FL_OBJECT_MESH || object->kind == FL_OBJECT_REVOLUTION ||
           (object->kind == FL_OBJECT_PLANE && scene->materials[object->material].image != FL_NONE);
}

/* In its own space an object only grows; its transform's translation does the rest. */
static void map_object(const mapping *m, fl_object *object, bool is_local)
{
    mapping own = *m;
    if (is_local)
        own.offset = fl_v3(0, 0, 0);
    switch (object->kind) {
    case FL_OBJECT_SPHERE:
        object->as.sphere.center = mapped(&own, object->as.sphere.center);
        object->as.sphere.radius *= m->scale;
        break;
    case FL_OBJECT_PLANE:
        object->as.plane.offset =
            object->as.plane.offset * m->scale + fl_v3_dot(object->as.plane.normal, own.offset);
        break;
    case FL_OBJECT_SQUARE:
        object->as.square.corner = mapped(&own, object->as.square.corner);
        object->as.square.u = grown(m, object->as.square.u);
        object->as.square.v = grown(m, object->as.square.v);
        break;
    case FL_OBJECT_DISK:
        object->as.disk.center = mapped(&own, object->as.disk.center);
        object->as.disk.radius *= m->scale;
        break;
    case FL_OBJECT_TRIANGLE:
        for (int k = 0; k < 3; k++)
            object->as.triangle.vertex[k] = mapped(&own, object->as.triangle.vertex[k]);
        break;
    case FL_OBJECT_MESH:
    case FL_OBJECT_REVOLUTION:
    case FL_OBJECT_KIND_COUNT:
    default:
        break;
    }
}

/* The transforms there were, carried over, and behind them the plain translation. */
static bool map_transforms(const mapping *m)
{
    fl_scene *scene = m->scene;
    size_t count = scene->transform_count;
    fl_affine *all = fl_arena_alloc(&scene->arena, count + 1, sizeof *all);
    if (!all)
        return fl_out_of_memory(m->diags, "the scene's transforms");
    if (count)
        memcpy(all, scene->transforms, count * sizeof *all);
    all[count] = fl_affine_identity();
    for (size_t i = 0; i <= count; i++) {
        if (i < count && fl_affine_is_identity(&all[i]))
            continue;
        fl_vec3 t = mapped(m, fl_v3(all[i].m[0][3], all[i].m[1][3], all[i].m[2][3]));
        all[i].m[0][3] = t.x;
        all[i].m[1][3] = t.y;
        all[i].m[2][3] = t.z;
    }
    scene->transforms = all;
    scene->transform_count = (uint32_t)count + 1;
    return true;
}

static bool map_objects(const mapping *m)
{
    fl_scene *scene = m->scene;
    uint32_t translation = scene->transform_count;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        fl_object *object = &scene->objects[i];
        bool is_local = has_own_space(scene, object);
        if (!is_local && is_moved(m) && needs_transform(scene, object)) {
            object->transform = translation;
            is_local = true;
        }
        map_object(m, object, is_local);
    }
    return true;
}

/* textureScale counts scene units on planes and repeats elsewhere: planes get materials of their
 * own. */
static bool map_materials(const mapping *m)
{
    fl_scene *scene = m->scene;
    uint32_t count = scene->material_count;
    fl_material *all = fl_arena_alloc(&scene->arena, 2 * (size_t)count, sizeof *all);
    if (!all)
        return fl_out_of_memory(m->diags, "the scene's materials");
    for (uint32_t i = 0; i < count; i++) {
        all[i] = all[count + i] = scene->materials[i];
        for (int k = 0; k < 2; k++)
            all[count + i].texture_scale[k] *= m->scale;
    }
    for (uint32_t i = 0; i < scene->object_count; i++) {
        fl_object *object = &scene->objects[i];
        if (object->kind == FL_OBJECT_PLANE && all[object->material].image != FL_NONE)
            object->material += count;
    }
    scene->materials = all;
    scene->material_count = 2 * count;
    return true;
}

static void map_profiles(const mapping *m)
{
    for (uint32_t i = 0; i < m->scene->profile_count; i++) {
        fl_profile *profile = &m->scene->profiles[i];
        size_t count = (size_t)profile->segment_count * (profile->degree + 1);
        for (size_t k = 0; k < count; k++)
            profile->points[k] = grown(m, profile->points[k]);
    }
}

bool fl_scene_map(fl_scene *scene, double scale, fl_vec3 offset, fl_diags *diags)
{
    const mapping m = {scene, scale, offset, diags};
    if (!(scale > 0.0 && isfinite(scale) && fl_v3_is_finite(offset)))
        return fl_error(diags, (fl_loc){0},
                        "a scene can be scaled by a finite number above 0 and moved by a finite "
                        "distance, got %g and %g %g %g",
                        scale, offset.x, offset.y, offset.z);
    /* Objects look at the transforms and materials that they had. */
    if (!map_objects(&m) || !map_transforms(&m) || !map_materials(&m) || !map_meshes(&m))
        return false;
    map_profiles(&m);
    map_camera(&m, &scene->camera);
    for (uint32_t i = 0; i < scene->view_count; i++)
        map_camera(&m, &scene->views[i].camera);
    for (uint32_t i = 0; i < scene->light_count; i++)
        map_light(&m, &scene->lights[i]);
    return true;
}
