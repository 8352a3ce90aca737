/* SPDX-License-Identifier: MIT
 *
 * Meshes and pictures that a text names: looked for, read, and each kept once.
 */
#include <stdio.h>
#include <string.h>

#include "core/parse_build.h"

enum { PATH_BYTES = 4096 };

/* The place of a file's name, not of its key. */
static fl_loc word_loc(const fl_builder *b, const fl_node *key)
{
    return fl_token_loc(b->tree->name, &key->word);
}

static char *copy_text(fl_builder *b, const char *text, size_t bytes)
{
    char *copy = fl_arena_text(&b->scene->arena, text, bytes);
    if (!copy)
        fl_out_of_memory(b->diags, "a file name");
    return copy;
}

/* Where a reference leads; false: nowhere. Without a finder every name leads to itself. */
static bool find(const fl_builder *b, const char *reference, char out_path[PATH_BYTES])
{
    if (b->files)
        return b->files->find(b->files->context, b->scene->path, reference, out_path, PATH_BYTES);
    return snprintf(out_path, PATH_BYTES, "%s", reference) < PATH_BYTES;
}

/* Reading a file may have set another text to quote from. */
static void quote_scene(fl_builder *b)
{
    fl_diags_set_text(b->diags, b->tree->name, b->text, b->text_bytes);
}

/* Room for the meshes and pictures there are; once it is gone no more are read. */
static bool has_room(const fl_builder *b)
{
    return b->file_bytes <= FL_SCENE_MEMORY_LIMIT;
}

static bool take_room(fl_builder *b, uint64_t bytes, const char *path, fl_loc loc)
{
    b->file_bytes += bytes;
    return has_room(b) ||
           fl_error(b->diags, loc,
                    "with '%s' the meshes and pictures of the scene need %ju bytes of memory, at "
                    "most %ju",
                    path, (uintmax_t)b->file_bytes, (uintmax_t)FL_SCENE_MEMORY_LIMIT);
}

static fl_mesh *load_mesh(fl_builder *b, const char *path, fl_loc loc)
{
    fl_mesh *mesh = b->files->load_mesh(b->files->context, path, loc, b->diags);
    if (!mesh)
        return NULL;
    uint64_t bytes = fl_mesh_bytes(mesh) + (uint64_t)mesh->face_count * FL_FACE_MEMORY_ESTIMATE;
    bool fits = mesh->face_count <= FL_FACES_MAX
                    ? take_room(b, bytes, path, loc)
                    : fl_error(b->diags, loc, "mesh '%s' is too large: %u triangles, at most %d",
                               path, mesh->face_count, FL_FACES_MAX);
    if (fits)
        return mesh;
    fl_mesh_release(mesh);
    return NULL;
}

static fl_image *load_image(fl_builder *b, const char *path, fl_loc loc)
{
    fl_image *image = b->files->load_image(b->files->context, path, loc, b->diags);
    if (!image || take_room(b, fl_image_bytes(image), path, loc))
        return image;
    fl_image_release(image);
    return NULL;
}

static uint32_t find_name(const char *const *names, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0)
            return i;
    return FL_NONE;
}

uint32_t fl_build_mesh_file(fl_builder *b, const fl_node *key)
{
    fl_scene *scene = b->scene;
    char *reference = copy_text(b, key->word.text, key->word.bytes), path[PATH_BYTES];
    if (!reference)
        return FL_NONE;
    uint32_t known = find_name(b->mesh_references, scene->mesh_count, reference);
    if (known != FL_NONE)
        return known;
    fl_loc loc = word_loc(b, key);
    if (!find(b, reference, path)) {
        fl_error(b->diags, loc, "there is no file '%s'", reference);
        path[0] = '\0'; /* known from now on, so that it is reported once */
    }
    for (uint32_t i = 0; path[0] && i < scene->mesh_count; i++)
        if (strcmp(scene->meshes[i].path, path) == 0)
            return i;
    uint32_t index = scene->mesh_count;
    if (index == FL_FILES_MAX) {
        fl_error(b->diags, loc, "a scene names at most %d different meshes", FL_FILES_MAX);
        return FL_NONE;
    }
    fl_scene_mesh mesh = {.path = copy_text(b, path, strlen(path)), .loc = loc};
    if (!mesh.path)
        return FL_NONE;
    if (b->files && path[0] && has_room(b))
        mesh.mesh = load_mesh(b, mesh.path, loc);
    quote_scene(b);
    b->mesh_references[index] = reference;
    scene->meshes[index] = mesh;
    scene->mesh_count++;
    return index;
}

/* Handle of the picture at a path that was found; `reference` is in the scene's arena. */
static uint32_t add_image(fl_builder *b, const char *reference, const char *path, fl_loc loc)
{
    fl_scene *scene = b->scene;
    for (uint32_t i = 0; path[0] && i < scene->image_count; i++)
        if (strcmp(scene->images[i].path, path) == 0)
            return i;
    uint32_t index = scene->image_count;
    if (index == FL_FILES_MAX) {
        fl_error(b->diags, loc, "a scene names at most %d different pictures", FL_FILES_MAX);
        return FL_NONE;
    }
    fl_scene_image image = {.path = copy_text(b, path, strlen(path)), .loc = loc};
    if (!image.path)
        return FL_NONE;
    if (b->files && path[0] && has_room(b))
        image.image = load_image(b, image.path, loc);
    quote_scene(b);
    b->image_references[index] = reference;
    scene->images[index] = image;
    scene->image_count++;
    return index;
}

uint32_t fl_build_image_file(fl_builder *b, const fl_node *key)
{
    char *reference = copy_text(b, key->word.text, key->word.bytes), path[PATH_BYTES];
    if (!reference)
        return FL_NONE;
    uint32_t known = find_name(b->image_references, b->scene->image_count, reference);
    if (known != FL_NONE)
        return known;
    fl_loc loc = word_loc(b, key);
    if (!find(b, reference, path)) {
        fl_error(b->diags, loc, "there is no file '%s'", reference);
        path[0] = '\0';
    }
    return add_image(b, reference, path, loc);
}

/* One face, by the first ending under which it exists. */
static uint32_t cube_face(fl_builder *b, const fl_node *key, const char *face)
{
    static const char *const endings[] = {"png", "bmp", "jpg",  "jpeg", "exr", "hdr",
                                          "tif", "tga", "tiff", "ppm",  "pfm"};
    char reference[FL_WORD_BYTES_MAX + 32], path[PATH_BYTES];
    fl_loc loc = word_loc(b, key);
    for (size_t i = 0; i < FL_COUNT_OF(endings); i++) {
        int bytes = snprintf(reference, sizeof reference, "%.*s/%s.%s", (int)key->word.bytes,
                             key->word.text, face, endings[i]);
        if (!find(b, reference, path))
            continue;
        char *kept = copy_text(b, reference, (size_t)bytes);
        return kept ? add_image(b, kept, path, loc) : FL_NONE;
    }
    fl_error(b->diags, loc, "there is no picture '%s' in the cube map folder '%.*s'", face,
             (int)key->word.bytes, key->word.text);
    return FL_NONE;
}

void fl_build_cube_map(fl_builder *b, const fl_node *key, uint32_t out_images[FL_CUBE_FACES])
{
    static const char *const faces[FL_CUBE_FACES] = {
        [FL_CUBE_RIGHT] = "right", [FL_CUBE_LEFT] = "left",   [FL_CUBE_UP] = "up",
        [FL_CUBE_DOWN] = "down",   [FL_CUBE_FRONT] = "front", [FL_CUBE_BACK] = "back"};
    for (int i = 0; i < FL_CUBE_FACES; i++)
        out_images[i] = cube_face(b, key, faces[i]);
}
