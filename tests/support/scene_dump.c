/* SPDX-License-Identifier: MIT */
#include "support/scene_dump.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct dump {
    char *text;
    size_t bytes, capacity;
} dump;

static void put(dump *d, const char *format, ...) FL_PRINTF(2, 3);

static void put(dump *d, const char *format, ...)
{
    for (;;) {
        va_list args;
        va_start(args, format);
        size_t room = d->capacity - d->bytes;
        int bytes = vsnprintf(d->text ? d->text + d->bytes : NULL, room, format, args);
        va_end(args);
        if (bytes >= 0 && (size_t)bytes < room) {
            d->bytes += (size_t)bytes;
            return;
        }
        d->capacity = 2 * d->capacity + 4096;
        d->text = realloc(d->text, d->capacity);
        if (!d->text)
            abort();
    }
}

static void put_vec(dump *d, const char *name, fl_vec3 v)
{
    put(d, "  %s %a %a %a\n", name, v.x, v.y, v.z);
}

static void put_camera(dump *d, const char *name, const fl_camera *c)
{
    put(d, "camera %s projection %d fov %a size %a\n", name, (int)c->projection, c->fov_deg,
        c->ortho_size);
    put_vec(d, "center", c->center);
    put_vec(d, "direction", c->direction);
    put_vec(d, "up", c->up);
    put(d, "  aperture %a focus %a blades %u rotation %a exposure %a pixels %u %u\n", c->aperture,
        c->focus, c->blades, c->blade_rotation_deg, c->exposure_ev, c->width, c->height);
}

static void put_light(dump *d, const fl_light *l)
{
    put(d, "light %d radius %a samples %u two-sided %d fade %a %a %a\n", (int)l->kind, l->radius,
        l->samples, l->is_two_sided, l->attenuation[0], l->attenuation[1], l->attenuation[2]);
    put_vec(d, "position", l->position);
    put_vec(d, "direction", l->direction);
    put_vec(d, "color", l->color);
}

static void put_material(dump *d, const fl_material *m)
{
    put(d, "material shininess %a index %a image %d filter %d scale %a %a has ambient %d\n",
        m->shininess, m->refraction_index, (int)m->image, (int)m->filter, m->texture_scale[0],
        m->texture_scale[1], m->has_ambient);
    put_vec(d, "diffuse", m->diffuse);
    put_vec(d, "specular", m->specular);
    put_vec(d, "ambient", m->ambient);
    put_vec(d, "reflect", m->reflect);
    put_vec(d, "refract", m->refract);
}

static void put_shape(dump *d, const fl_object *o)
{
    switch (o->kind) {
    case FL_OBJECT_SPHERE:
        put_vec(d, "center", o->as.sphere.center);
        put(d, "  radius %a\n", o->as.sphere.radius);
        break;
    case FL_OBJECT_PLANE:
        put_vec(d, "normal", o->as.plane.normal);
        put(d, "  offset %a\n", o->as.plane.offset);
        break;
    case FL_OBJECT_SQUARE:
        put_vec(d, "corner", o->as.square.corner);
        put_vec(d, "u", o->as.square.u);
        put_vec(d, "v", o->as.square.v);
        break;
    case FL_OBJECT_DISK:
        put_vec(d, "center", o->as.disk.center);
        put_vec(d, "normal", o->as.disk.normal);
        put(d, "  radius %a\n", o->as.disk.radius);
        break;
    case FL_OBJECT_TRIANGLE:
        for (int i = 0; i < 3; i++)
            put_vec(d, "vertex", o->as.triangle.vertex[i]);
        break;
    case FL_OBJECT_MESH:
        put(d, "  mesh %d normals %d\n", (int)o->as.mesh.mesh, (int)o->as.mesh.normals);
        break;
    default:
        put(d, "  profile %d image %d\n", (int)o->as.revolution.profile,
            (int)o->as.revolution.image);
    }
}

static void put_render(dump *d, const fl_render_block *r)
{
    put(d, "render %d %u %d %u %d %u %d %a %d %d\n", r->has_samples, r->samples, r->has_depth,
        r->depth, r->has_light_samples, r->light_samples, r->has_weight_threshold,
        r->weight_threshold, r->has_transparent_shadows, r->transparent_shadows);
}

static void put_arrays(dump *d, const fl_scene *s)
{
    for (uint32_t i = 0; i < s->light_count; i++)
        put_light(d, &s->lights[i]);
    for (uint32_t i = 0; i < s->material_count; i++)
        put_material(d, &s->materials[i]);
    for (uint32_t i = 0; i < s->object_count; i++) {
        const fl_object *o = &s->objects[i];
        put(d, "object %d material %u transform %d\n", (int)o->kind, o->material,
            (int)o->transform);
        put_shape(d, o);
    }
    for (uint32_t i = 0; i < s->transform_count; i++) {
        put(d, "transform");
        for (int k = 0; k < 12; k++)
            put(d, " %a", s->transforms[i].m[k / 4][k % 4]);
        put(d, "\n");
    }
    for (uint32_t i = 0; i < s->profile_count; i++) {
        const fl_profile *p = &s->profiles[i];
        put(d, "profile %u of degree %u\n", p->segment_count, p->degree);
        for (uint32_t k = 0; k < p->segment_count * (p->degree + 1); k++)
            put_vec(d, "point", p->points[k]);
    }
    for (uint32_t i = 0; i < s->mesh_count; i++)
        put(d, "mesh %s\n", s->meshes[i].path);
    for (uint32_t i = 0; i < s->image_count; i++)
        put(d, "image %s\n", s->images[i].path);
}

char *scene_dump(const fl_scene *scene)
{
    dump d = {0};
    put(&d, "has camera %d\n", scene->has_camera);
    put_camera(&d, "main", &scene->camera);
    put_vec(&d, "background", scene->background.color);
    put_vec(&d, "ambient light", scene->background.ambient);
    for (int i = 0; i < FL_CUBE_FACES; i++)
        put(&d, "cube %d\n", (int)scene->background.cube_image[i]);
    put_render(&d, &scene->render);
    for (uint32_t i = 0; i < scene->view_count; i++)
        put_camera(&d, scene->views[i].name, &scene->views[i].camera);
    put_arrays(&d, scene);
    return d.text;
}

static bool fake_find(void *context, const char *scene_path, const char *reference, char *out_path,
                      size_t out_bytes)
{
    ((fake_files *)context)->find_count++;
    (void)scene_path;
    return !strstr(reference, "missing") &&
           snprintf(out_path, out_bytes, "found/%s", reference) < (int)out_bytes;
}

static fl_mesh *fake_load_mesh(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    ((fake_files *)context)->mesh_count++;
    fl_mesh *mesh = strstr(path, "broken") ? NULL : fl_mesh_create();
    if (!mesh) {
        fl_error(diags, loc, "cannot read mesh '%s'", path);
        return NULL;
    }
    mesh->positions = calloc(3, sizeof *mesh->positions);
    mesh->faces = malloc(sizeof *mesh->faces);
    if (!mesh->positions || !mesh->faces)
        abort();
    mesh->positions[1].x = mesh->positions[2].y = 1.0;
    *mesh->faces = (fl_face){{0, 1, 2}, {FL_NONE, FL_NONE, FL_NONE}, {FL_NONE, FL_NONE, FL_NONE}};
    mesh->position_count = 3;
    mesh->face_count = 1;
    return mesh;
}

static fl_image *fake_load_image(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    ((fake_files *)context)->image_count++;
    fl_image *image = strstr(path, "broken") ? NULL : fl_image_create(1, 1, FL_PIXEL_SRGB8);
    if (!image)
        fl_error(diags, loc, "cannot read picture '%s'", path);
    else
        memset(image->pixels, 255, 3);
    return image;
}

void fake_files_init(fake_files *fake)
{
    *fake = (fake_files){
        .files = {.find = fake_find, .load_mesh = fake_load_mesh, .load_image = fake_load_image}};
    fake->files.context = fake;
}
