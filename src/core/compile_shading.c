/* SPDX-License-Identifier: MIT
 *
 * Shaders and textures of the objects, without doubles; what the scene needs.
 */
#include <string.h>

#include "core/compile_build.h"

const char *const fl_need_names[FL_NEED_COUNT] = {
    "spheres",  "planes",   "patches",    "triangles",  "revolutions",     "transforms",
    "textures", "specular", "reflection", "refraction", "shading normals", "cube map"};

static void store_color(float out[3], fl_vec3 color)
{
    out[0] = (float)color.x;
    out[1] = (float)color.y;
    out[2] = (float)color.z;
}

static bool is_black(const float color[3])
{
    return color[0] == 0.0f && color[1] == 0.0f && color[2] == 0.0f;
}

/* Triangles and meshes bring their own texture coordinates, or have none. */
static bool has_coordinates(const fl_compiler *c, const fl_object *object)
{
    if (object->kind == FL_OBJECT_TRIANGLE)
        return false;
    return object->kind != FL_OBJECT_MESH || c->scene->meshes[object->as.mesh.mesh].mesh->uv_count > 0;
}

/* How an object reads its picture; FL_NONE in *out_image: it has none. */
static fl_texture texture_of(const fl_compiler *c, const fl_object *object, uint32_t *out_image)
{
    const fl_material *material = &c->scene->materials[object->material];
    bool is_revolution = object->kind == FL_OBJECT_REVOLUTION;
    uint32_t image = material->image;
    if (is_revolution && object->as.revolution.image != FL_NONE)
        image = object->as.revolution.image;
    if (image != FL_NONE && !c->scene->images[image].image)
        image = FL_NONE;
    if (image != FL_NONE && !has_coordinates(c, object)) {
        fl_warning(c->diags, object->loc, "this object has no texture coordinates, so its material's texture is not used");
        image = FL_NONE;
    }
    *out_image = image;
    if (image == FL_NONE)
        return (fl_texture){0};
    fl_texture texture = {.image = c->scene->images[image].image,
                          .filter = material->filter,
                          .clamps_v = is_revolution || object->kind == FL_OBJECT_SPHERE};
    for (int k = 0; k < 2; k++) {
        double scale = material->texture_scale[k];
        /* A plane's is scene units per repeat. */
        texture.scale[k] = (float)(object->kind == FL_OBJECT_PLANE ? 1.0 / scale : scale);
    }
    return texture;
}

static uint32_t find_texture(fl_compiler *c, const fl_texture *wanted)
{
    fl_compiled *out = c->out;
    for (uint32_t k = 0; k < out->texture_count; k++) {
        const fl_texture *have = &out->textures[k];
        if (have->image == wanted->image && have->filter == wanted->filter &&
            have->clamps_v == wanted->clamps_v && have->scale[0] == wanted->scale[0] &&
            have->scale[1] == wanted->scale[1])
            return k;
    }
    bool is_new_image = true;
    for (uint32_t k = 0; k < out->texture_count; k++)
        is_new_image &= out->textures[k].image != wanted->image;
    if (is_new_image)
        out->texture_bytes += fl_image_bytes(wanted->image);
    out->textures[out->texture_count] = *wanted;
    fl_image_retain(wanted->image);
    return out->texture_count++;
}

static fl_shader shader_of(const fl_material *m, uint32_t texture)
{
    fl_shader s = {.shininess = (float)m->shininess,
                   .refraction_index = (float)m->refraction_index,
                   .index_exact = m->refraction_index,
                   .texture = texture,
                   .ambient_is_diffuse = !m->has_ambient};
    store_color(s.diffuse, m->diffuse);
    store_color(s.specular, m->specular);
    store_color(s.ambient, m->has_ambient ? m->ambient : m->diffuse);
    store_color(s.reflect, m->reflect);
    store_color(s.refract, m->refract);
    return s;
}

static uint32_t shader_needs(const fl_shader *s)
{
    uint32_t needs = 0;
    needs |= s->texture != FL_NONE ? FL_NEED_TEXTURES : 0u;
    needs |= is_black(s->specular) ? 0u : FL_NEED_SPECULAR;
    needs |= is_black(s->reflect) ? 0u : FL_NEED_REFLECTION;
    /* Total reflection sends refracted light the mirror's way. */
    needs |= is_black(s->refract) ? 0u : FL_NEED_REFRACTION | FL_NEED_REFLECTION;
    return needs;
}

/* One shader for each (material, texture) in use. */
static bool compile_shaders(fl_compiler *c, fl_arena *scratch)
{
    const fl_scene *scene = c->scene;
    fl_compiled *out = c->out;
    uint32_t *first = fl_arena_alloc(scratch, scene->material_count, sizeof *first);
    uint32_t *next = fl_arena_alloc(scratch, scene->object_count, sizeof *next);
    if (!first || !next)
        return fl_out_of_memory(c->diags, "the scene's materials");
    memset(first, 0xff, scene->material_count * sizeof *first);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const fl_object *object = &scene->objects[i];
        FL_ASSERT(object->material < scene->material_count);
        uint32_t image;
        fl_texture texture = texture_of(c, object, &image);
        uint32_t at = image == FL_NONE ? FL_NONE : find_texture(c, &texture);
        uint32_t k = first[object->material];
        while (k != FL_NONE && out->shaders[k].texture != at)
            k = next[k];
        if (k == FL_NONE) {
            k = out->shader_count++;
            out->shaders[k] = shader_of(&scene->materials[object->material], at);
            out->needs |= shader_needs(&out->shaders[k]);
            next[k] = first[object->material];
            first[object->material] = k;
        }
        out->object_shader[i] = k;
        out->object_needs_uv[i] = at != FL_NONE;
    }
    return true;
}

/* Places in the text, with names of files that live as long as the compiled scene. */
static bool copy_places(fl_compiler *c)
{
    const char *name = NULL, *copy = NULL;
    for (uint32_t i = 0; i < c->scene->object_count; i++) {
        fl_loc loc = c->scene->objects[i].loc;
        if (loc.file && (!name || strcmp(loc.file, name) != 0)) {
            copy = fl_arena_text(&c->out->arena, loc.file, strlen(loc.file));
            name = loc.file;
            if (!copy)
                return fl_out_of_memory(c->diags, "the scene's places");
        }
        if (loc.file)
            loc.file = copy;
        c->out->object_loc[i] = loc;
    }
    return true;
}

static void compile_cube(fl_compiler *c)
{
    const fl_background *background = &c->scene->background;
    for (int k = 0; k < FL_CUBE_FACES; k++)
        if (background->cube_image[k] == FL_NONE ||
            !c->scene->images[background->cube_image[k]].image)
            return;
    for (int k = 0; k < FL_CUBE_FACES; k++) {
        c->out->cube[k] = fl_image_retain(c->scene->images[background->cube_image[k]].image);
        c->out->texture_bytes += fl_image_bytes(c->out->cube[k]);
    }
    c->out->needs |= FL_NEED_CUBE_MAP;
}

bool fl_compile_shading(fl_compiler *c)
{
    fl_compiled *out = c->out;
    uint32_t count = c->scene->object_count;
    out->shaders = fl_arena_alloc(&out->arena, count, sizeof *out->shaders);
    out->textures = fl_arena_alloc(&out->arena, count, sizeof *out->textures);
    out->object_shader = fl_arena_alloc(&out->arena, count, sizeof *out->object_shader);
    out->object_needs_uv = fl_arena_alloc(&out->arena, count, sizeof *out->object_needs_uv);
    out->object_loc = fl_arena_alloc(&out->arena, count, sizeof *out->object_loc);
    if (!out->shaders || !out->textures || !out->object_shader || !out->object_needs_uv ||
        !out->object_loc)
        return fl_out_of_memory(c->diags, "the scene's materials");
    fl_arena scratch = {0};
    bool ok = compile_shaders(c, &scratch) && copy_places(c);
    fl_arena_deinit(&scratch);
    if (ok)
        compile_cube(c);
    return ok;
}
