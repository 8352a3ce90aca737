/* SPDX-License-Identifier: MIT
 *
 * Writes scenes and what they name as FOLDER/NAME.flat (flat.h), with the size and the samples of
 * their golden pictures: to be rendered where nothing reads texture and mesh files.
 *
 * usage: flatten FOLDER SCENE.txt ...
 * Exit: 0 all written, 1 not.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bytes/flat.h"
#include "cli/picture.h"
#include "io/files.h"

enum { FINDS_MAX = 64, PATH_BYTES = 4096 };

/* What the parser asked for, and where that was. */
typedef struct finds {
    char references[FINDS_MAX][PATH_BYTES], paths[FINDS_MAX][PATH_BYTES];
    uint32_t count;
} finds;

static bool find_and_note(void *context, const char *scene_path, const char *reference,
                          char *out_path, size_t out_bytes)
{
    finds *f = context;
    if (f->count == FINDS_MAX ||
        !fl_files_on_disk.find(NULL, scene_path, reference, out_path, out_bytes))
        return false;
    snprintf(f->references[f->count], PATH_BYTES, "%s", reference);
    snprintf(f->paths[f->count++], PATH_BYTES, "%s", out_path);
    return true;
}

/* What was read from a path; borrowed from the scene. */
static flat_file file_at(const fl_scene *scene, const char *path, char *reference)
{
    flat_file file = {.name = reference};
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        if (strcmp(scene->meshes[i].path, path) == 0)
            file.mesh = scene->meshes[i].mesh;
    for (uint32_t i = 0; i < scene->image_count; i++)
        if (strcmp(scene->images[i].path, path) == 0)
            file.image = scene->images[i].image;
    return file;
}

static bool write_flat(const fl_scene *scene, char *text, finds *f, const char *path)
{
    flat_file files[FINDS_MAX];
    for (uint32_t i = 0; i < f->count; i++)
        files[i] = file_at(scene, f->paths[i], f->references[i]);
    const fl_render_block *render = &scene->render;
    flat_scene flat = {
        .width = CLI_GOLDEN_SIDE,
        .height = CLI_GOLDEN_SIDE,
        .samples = cli_golden_samples(render),
        .text = text,
        .files = files,
        .file_count = f->count,
    };
    return flat_write(&flat, path);
}

static bool flatten(const char *folder, const char *scene_path, fl_diags *diags)
{
    static finds found; /* too large for a stack */
    char path[PATH_BYTES];
    const char *slash = strrchr(scene_path, '/'), *name = slash ? slash + 1 : scene_path;
    snprintf(path, sizeof path, "%s/%.*s.flat", folder, (int)strcspn(name, "."), name);
    found.count = 0;
    fl_files files = fl_files_on_disk; /* whose functions have no context of their own */
    files.context = &found;
    files.find = find_and_note;
    size_t bytes;
    char *text =
        fl_file_load(scene_path, "scene", FL_SCENE_FILE_MAX_BYTES, (fl_loc){0}, diags, &bytes);
    fl_scene *scene =
        text ? fl_scene_parse(text, bytes, scene_path, &(fl_parse_options){0}, &files, diags)
             : NULL;
    bool ok = scene && (write_flat(scene, text, &found, path) ||
                        fl_environment_error(diags, "cannot write '%s'", path));
    fl_scene_destroy(scene);
    free(text);
    return ok;
}

int main(int argc, char **argv)
{
    bool ok = argc > 2;
    if (!ok)
        fputs("usage: flatten FOLDER SCENE.txt ...\n", stderr);
    for (int i = 2; ok && i < argc; i++) {
        fl_diags diags = {0};
        ok = flatten(argv[1], argv[i], &diags);
        cli_print_diags(&diags);
        fl_diags_deinit(&diags);
    }
    return ok ? 0 : 1;
}
