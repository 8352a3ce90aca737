/* SPDX-License-Identifier: MIT */
#include "bytes/flat.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* "flscene1"; with the other byte order no file begins so. */
static const uint64_t flat_magic = 0x31656e6563736c66u;

_Static_assert(sizeof(fl_vec3) == 24 && sizeof(fl_uv) == 8 && sizeof(fl_face) == 36,
               "the arrays of a mesh have no gaps");

/* A file in one direction or the other: the layout is written down once. */
typedef struct stream {
    FILE *file;
    bool is_writing;
} stream;

static bool pass(stream *s, void *data, size_t bytes)
{
    if (bytes == 0)
        return true;
    return data &&
           (s->is_writing ? fwrite(data, bytes, 1, s->file) : fread(data, bytes, 1, s->file)) == 1;
}

/* An array to write, or zeroed room to read one into. */
static void *room(const stream *s, void *array, size_t count, size_t size)
{
    return s->is_writing || count == 0 ? array : calloc(count, size);
}

static bool pass_text(stream *s, char **text)
{
    uint32_t bytes = s->is_writing ? (uint32_t)strlen(*text) : 0;
    if (!pass(s, &bytes, sizeof bytes))
        return false;
    *text = room(s, *text, (size_t)bytes + 1, 1);
    return pass(s, *text, bytes);
}

static bool pass_mesh(stream *s, fl_mesh **out_mesh)
{
    if (!s->is_writing && !(*out_mesh = fl_mesh_create()))
        return false;
    fl_mesh *m = *out_mesh;
    uint32_t counts[] = {m->position_count, m->normal_count, m->uv_count, m->face_count};
    if (!pass(s, counts, sizeof counts))
        return false;
    m->position_count = counts[0];
    m->normal_count = counts[1];
    m->uv_count = counts[2];
    m->face_count = counts[3];
    m->positions = room(s, m->positions, m->position_count, sizeof *m->positions);
    m->normals = room(s, m->normals, m->normal_count, sizeof *m->normals);
    m->uvs = room(s, m->uvs, m->uv_count, sizeof *m->uvs);
    m->faces = room(s, m->faces, m->face_count, sizeof *m->faces);
    return pass(s, m->positions, m->position_count * sizeof *m->positions) &&
           pass(s, m->normals, m->normal_count * sizeof *m->normals) &&
           pass(s, m->uvs, m->uv_count * sizeof *m->uvs) &&
           pass(s, m->faces, m->face_count * sizeof *m->faces);
}

static bool pass_image(stream *s, fl_image **image)
{
    uint32_t head[3] = {0};
    if (s->is_writing) {
        head[0] = (*image)->width;
        head[1] = (*image)->height;
        head[2] = (*image)->format;
    }
    if (!pass(s, head, sizeof head))
        return false;
    if (!s->is_writing && !(*image = fl_image_create(head[0], head[1], (fl_pixel_format)head[2])))
        return false;
    return pass(s, (*image)->pixels, fl_image_bytes(*image));
}

static bool pass_file(stream *s, flat_file *file)
{
    uint32_t is_image = file->image != NULL;
    return pass_text(s, &file->name) && pass(s, &is_image, sizeof is_image) &&
           (is_image ? pass_image(s, &file->image) : pass_mesh(s, &file->mesh));
}

static bool pass_scene(stream *s, flat_scene *scene)
{
    uint64_t magic = flat_magic;
    uint32_t size[] = {scene->width, scene->height, scene->samples};
    if (!pass(s, &magic, sizeof magic) || magic != flat_magic || !pass(s, size, sizeof size) ||
        !pass_text(s, &scene->text) || !pass(s, &scene->file_count, sizeof scene->file_count))
        return false;
    scene->width = size[0];
    scene->height = size[1];
    scene->samples = size[2];
    scene->files = room(s, scene->files, scene->file_count, sizeof *scene->files);
    bool ok = scene->files || scene->file_count == 0;
    for (uint32_t i = 0; ok && i < scene->file_count; i++)
        ok = pass_file(s, &scene->files[i]);
    return ok;
}

bool flat_write(flat_scene *scene, const char *path)
{
    stream s = {.file = fopen(path, "wb"), .is_writing = true};
    bool ok = s.file && pass_scene(&s, scene);
    return s.file && fclose(s.file) == 0 && ok;
}

bool flat_read(flat_scene *out_scene, const char *path)
{
    *out_scene = (flat_scene){0};
    stream s = {.file = fopen(path, "rb")};
    bool ok = s.file && pass_scene(&s, out_scene) && getc(s.file) == EOF;
    if (s.file)
        fclose(s.file);
    if (!ok)
        flat_close(out_scene);
    return ok;
}

void flat_close(flat_scene *scene)
{
    for (uint32_t i = 0; scene->files && i < scene->file_count; i++) {
        free(scene->files[i].name);
        fl_mesh_release(scene->files[i].mesh);
        fl_image_release(scene->files[i].image);
    }
    free(scene->files);
    free(scene->text);
    *scene = (flat_scene){0};
}

static const flat_file *named(const flat_scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->file_count; i++)
        if (strcmp(scene->files[i].name, name) == 0)
            return &scene->files[i];
    return NULL;
}

static bool find(void *context, const char *scene_path, const char *reference, char *out_path,
                 size_t out_bytes)
{
    (void)scene_path;
    return named(context, reference) &&
           (size_t)snprintf(out_path, out_bytes, "%s", reference) < out_bytes;
}

static fl_mesh *load_mesh(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    const flat_file *file = named(context, path);
    if (file && file->mesh)
        return fl_mesh_retain(file->mesh);
    fl_error(diags, loc, "'%s' is no mesh", path);
    return NULL;
}

static fl_image *load_image(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    const flat_file *file = named(context, path);
    if (file && file->image)
        return fl_image_retain(file->image);
    fl_error(diags, loc, "'%s' is no picture", path);
    return NULL;
}

fl_files flat_files(flat_scene *scene)
{
    return (fl_files){scene, find, load_mesh, load_image};
}
