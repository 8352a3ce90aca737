/* SPDX-License-Identifier: MIT
 *
 * The only file of the reference that sees the core's types. It copies; it computes nothing but the
 * decoding of 8-bit texels, by the curve of IEC 61966-2-1 written out.
 */
#include "dump.h"

#include <math.h>
#include <stdlib.h>

#include "core/firstlight.h"

static const double radians = 0.017453292519943295769;

static ref_vec vec(fl_vec3 v)
{
    return (ref_vec){v.x, v.y, v.z};
}

static double decode(double code)
{
    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

static double texel(const fl_image *image, size_t i)
{
    if (image->format == FL_PIXEL_FLOAT)
        return (double)((const float *)image->pixels)[i];
    double code = ((const uint8_t *)image->pixels)[i] / 255.0;
    return image->format == FL_PIXEL_SRGB8 ? decode(code) : code;
}

static bool copy_image(const fl_image *from, ref_image *to)
{
    to->width = from->width;
    to->height = from->height;
    size_t count = (size_t)from->width * from->height;
    to->texels = malloc(count * sizeof(ref_vec));
    for (size_t i = 0; to->texels && i < count; i++)
        to->texels[i] =
            (ref_vec){texel(from, 3 * i), texel(from, 3 * i + 1), texel(from, 3 * i + 2)};
    return to->texels;
}

static ref_material copy_material(const ref_dump *dump, const fl_material *m, uint32_t image)
{
    return (ref_material){.diffuse = vec(m->diffuse),
                          .specular = vec(m->specular),
                          .ambient = vec(m->ambient),
                          .reflect = vec(m->reflect),
                          .refract = vec(m->refract),
                          .shininess = m->shininess,
                          .refraction_index = m->refraction_index,
                          .has_ambient = m->has_ambient,
                          .image = image == FL_NONE ? NULL : &dump->images[image],
                          .is_nearest = m->filter == FL_FILTER_NEAREST,
                          .texture_scale = {m->texture_scale[0], m->texture_scale[1]}};
}

static bool copy_mesh(const fl_mesh *mesh, ref_shape *shape)
{
    shape->triangle_count = mesh->face_count;
    shape->position_count = mesh->position_count;
    shape->triangles = calloc(mesh->face_count + 1u, sizeof(ref_triangle));
    for (uint32_t i = 0; shape->triangles && i < mesh->face_count; i++) {
        const fl_face *face = &mesh->faces[i];
        ref_triangle *to = &shape->triangles[i];
        to->has_file_normals = to->has_uv = true;
        for (int k = 0; k < 3; k++) {
            to->index[k] = face->position[k];
            to->corner[k] = vec(mesh->positions[face->position[k]]);
            if (face->normal[k] == FL_NONE)
                to->has_file_normals = false;
            else
                to->normal[k] = vec(mesh->normals[face->normal[k]]);
            if (face->uv[k] == FL_NONE) {
                to->has_uv = false;
            } else {
                to->u[k] = (double)mesh->uvs[face->uv[k]].u;
                to->v[k] = (double)mesh->uvs[face->uv[k]].v;
            }
        }
    }
    return shape->triangles;
}

static bool copy_triangle(const fl_object *object, ref_shape *shape)
{
    shape->triangle_count = 1;
    shape->position_count = 3;
    shape->triangles = calloc(1, sizeof(ref_triangle));
    for (uint32_t k = 0; shape->triangles && k < 3; k++) {
        shape->triangles->index[k] = k;
        shape->triangles->corner[k] = vec(object->as.triangle.vertex[k]);
    }
    return shape->triangles;
}

static bool copy_profile(const fl_profile *profile, ref_shape *shape)
{
    shape->segment_count = profile->segment_count;
    shape->segments = calloc(profile->segment_count, sizeof(ref_segment));
    const fl_vec3 *point = profile->points;
    for (uint32_t i = 0; shape->segments && i < profile->segment_count; i++) {
        shape->segments[i].degree = profile->degree;
        for (uint32_t k = 0; k <= profile->degree; k++, point++) {
            shape->segments[i].x[k] = point->x;
            shape->segments[i].y[k] = point->y;
        }
    }
    return shape->segments;
}

static ref_normals normals_of(fl_normals normals)
{
    switch (normals) {
    case FL_NORMALS_FLAT:
        return REF_NORMALS_FLAT;
    case FL_NORMALS_SMOOTH:
        return REF_NORMALS_SMOOTH;
    case FL_NORMALS_ANGLE:
        return REF_NORMALS_ANGLE;
    case FL_NORMALS_FILE:
        return REF_NORMALS_FILE;
    case FL_NORMALS_AUTO:
        break;
    }
    return REF_NORMALS_AUTO;
}

static bool copy_object(const fl_scene *scene, const ref_dump *dump, const fl_object *object,
                        ref_shape *shape)
{
    fl_affine identity = fl_affine_identity();
    const fl_affine *m =
        object->transform == FL_NONE ? &identity : &scene->transforms[object->transform];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            shape->to_world[i][j] = m->m[i][j];
    const fl_material *material = &scene->materials[object->material];
    uint32_t image = material->image;
    if (object->kind == FL_OBJECT_REVOLUTION && object->as.revolution.image != FL_NONE)
        image = object->as.revolution.image;
    shape->material = copy_material(dump, material, image);
    switch (object->kind) {
    case FL_OBJECT_SPHERE:
        shape->kind = REF_SPHERE;
        shape->a = vec(object->as.sphere.center);
        shape->radius = object->as.sphere.radius;
        return true;
    case FL_OBJECT_PLANE:
        shape->kind = REF_PLANE;
        shape->a = vec(object->as.plane.normal);
        shape->radius = object->as.plane.offset;
        return true;
    case FL_OBJECT_SQUARE:
        shape->kind = REF_SQUARE;
        shape->a = vec(object->as.square.corner);
        shape->b = vec(object->as.square.u);
        shape->c = vec(object->as.square.v);
        return true;
    case FL_OBJECT_DISK:
        shape->kind = REF_DISK;
        shape->a = vec(object->as.disk.center);
        shape->b = vec(object->as.disk.normal);
        shape->radius = object->as.disk.radius;
        return true;
    case FL_OBJECT_TRIANGLE:
        shape->kind = REF_MESH;
        shape->normals = REF_NORMALS_FLAT;
        return copy_triangle(object, shape);
    case FL_OBJECT_MESH:
        shape->kind = REF_MESH;
        shape->normals = normals_of(object->as.mesh.normals);
        return copy_mesh(scene->meshes[object->as.mesh.mesh].mesh, shape);
    case FL_OBJECT_REVOLUTION:
        shape->kind = REF_REVOLUTION;
        return copy_profile(&scene->profiles[object->as.revolution.profile], shape);
    case FL_OBJECT_KIND_COUNT:
        break;
    }
    return false;
}

/* Command line or key > light > Render block > 1 (decision 9). */
static uint32_t light_samples(const fl_params *params, const fl_light *light)
{
    if (light->kind != FL_LIGHT_DISK || !(light->radius > 0.0))
        return 1;
    uint32_t count = params->light_samples ? params->light_samples
                     : light->samples      ? light->samples
                                           : params->light_samples_default;
    return count ? count : 1;
}

static void copy_light(const fl_params *params, const fl_light *from, ref_light *to)
{
    to->kind = from->kind == FL_LIGHT_DIRECTIONAL ? REF_DIRECTIONAL
               : from->kind == FL_LIGHT_POINT     ? REF_POINT
                                                  : REF_DISKLIGHT;
    to->position = vec(from->position);
    to->direction = vec(from->direction);
    to->color = vec(from->color);
    to->radius = from->radius;
    for (int i = 0; i < 3; i++)
        to->attenuation[i] = from->attenuation[i];
    to->samples = light_samples(params, from);
    to->is_two_sided = from->is_two_sided;
}

static void copy_camera(const fl_params *p, ref_dump *dump)
{
    const fl_camera *camera = &p->camera;
    dump->width = p->width;
    dump->height = p->height;
    dump->eye = vec(camera->center);
    dump->direction = vec(camera->direction);
    dump->up = vec(camera->up);
    dump->fov = camera->fov_deg * radians;
    dump->ortho_size = camera->ortho_size;
    dump->aperture = camera->aperture;
    dump->focus = camera->focus;
    dump->blades = camera->blades;
    dump->blade_rotation = camera->blade_rotation_deg * radians;
    dump->is_orthographic = camera->projection == FL_ORTHOGRAPHIC;
    dump->spans_square = p->camera_model != FL_CAMERA_VERTICAL_FOV;
    dump->has_raw_up = p->camera_model == FL_CAMERA_RAW_UP;
    dump->pixel = p->exact.pixel == FL_PIXEL_CORNER      ? REF_PIXEL_CORNER
                  : p->exact.pixel == FL_PIXEL_CENTER    ? REF_PIXEL_CENTER
                  : p->exact.pixel == FL_PIXEL_GRID_ENDS ? REF_PIXEL_ENDS
                                                         : REF_PIXEL_AREA;
}

static void copy_rules(const fl_params *p, ref_dump *dump)
{
    dump->no_shadows = p->exact.no_shadows;
    dump->no_recursion = p->exact.no_recursion;
    dump->ungated_specular = p->exact.ungated_specular;
    dump->no_normal_flip = p->exact.no_normal_flip;
    dump->course_cube = p->exact.course_cube;
    dump->black_back_faces = p->exact.black_back_faces;
    dump->transparent_shadows = p->transparent_shadows;
    dump->is_random = p->sampler == FL_SAMPLER_RANDOM;
    dump->seed = p->seed;
    dump->depth_limit = p->depth_limit;
    dump->weight_threshold = p->weight_threshold;
    dump->background = vec(p->background);
    dump->ambient = vec(p->ambient);
}

ref_dump *ref_dump_create(const struct fl_scene *scene, const struct fl_params *params)
{
    ref_dump *dump = calloc(1, sizeof *dump);
    if (!dump)
        return NULL;
    copy_camera(params, dump);
    copy_rules(params, dump);
    dump->images = calloc(scene->image_count + 1u, sizeof *dump->images);
    dump->shapes = calloc(scene->object_count + 1u, sizeof *dump->shapes);
    dump->lights = calloc(params->light_count + 1u, sizeof *dump->lights);
    bool ok = dump->images && dump->shapes && dump->lights;
    for (; ok && dump->image_count < scene->image_count; dump->image_count++)
        ok = copy_image(scene->images[dump->image_count].image, &dump->images[dump->image_count]);
    for (; ok && dump->shape_count < scene->object_count; dump->shape_count++)
        ok = copy_object(scene, dump, &scene->objects[dump->shape_count],
                         &dump->shapes[dump->shape_count]);
    for (; ok && dump->light_count < params->light_count; dump->light_count++)
        copy_light(params, &params->lights[dump->light_count], &dump->lights[dump->light_count]);
    for (int i = 0; ok && i < 6; i++)
        if (scene->background.cube_image[i] != FL_NONE)
            dump->cube[i] = &dump->images[scene->background.cube_image[i]];
    if (ok)
        return dump;
    ref_dump_destroy(dump);
    return NULL;
}

void ref_dump_destroy(ref_dump *dump)
{
    if (!dump)
        return;
    for (uint32_t i = 0; dump->images && i < dump->image_count; i++)
        free(dump->images[i].texels);
    for (uint32_t i = 0; dump->shapes && i < dump->shape_count; i++) {
        free(dump->shapes[i].triangles);
        free(dump->shapes[i].segments);
    }
    free(dump->images);
    free(dump->shapes);
    free(dump->lights);
    free(dump);
}
