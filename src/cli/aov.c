/* SPDX-License-Identifier: MIT */
#include "cli/aov.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/image_file.h"
#include "io/path.h"

static const char *const map_names[CLI_MAP_COUNT] = {[FL_RENDER_SAMPLES] = "samples", [FL_RENDER_ERROR] = "error"};

/* Position of a word in a list of names; `count`: it is not there. */
static uint32_t find(const char *word, size_t bytes, const char *const *names, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && (strlen(names[i]) != bytes || memcmp(names[i], word, bytes) != 0))
        i++;
    return i;
}

static bool refuse(const char *word, size_t bytes, char message[CLI_MESSAGE_BYTES])
{
    const char *names[FL_AOV_COUNT + CLI_MAP_COUNT];
    memcpy(names, fl_aov_names, sizeof fl_aov_names[0] * FL_AOV_COUNT);
    memcpy(names + FL_AOV_COUNT, map_names, sizeof map_names);
    const char *nearest = fl_nearest_name(word, bytes, names, FL_COUNT_OF(names));
    snprintf(message, CLI_MESSAGE_BYTES, "--aov does not know '%.*s'%s%s%s", (int)bytes, word,
             nearest ? "; did you mean '" : "; expected depth, normal, albedo, samples, error, cost, object, shape, branch",
             nearest ? nearest : "", nearest ? "'?" : "");
    return false;
}

bool cli_aov_parse(const char *names, cli_aovs *out, char message[CLI_MESSAGE_BYTES])
{
    *out = (cli_aovs){0};
    while (names && *names) {
        size_t bytes = strcspn(names, ",");
        uint32_t kind = find(names, bytes, fl_aov_names, FL_AOV_COUNT);
        uint32_t map = find(names, bytes, map_names, CLI_MAP_COUNT);
        if (kind < FL_AOV_COUNT)
            out->kinds |= 1u << kind;
        else if (map < CLI_MAP_COUNT)
            out->maps |= 1u << map;
        else
            return refuse(names, bytes, message);
        names += bytes + (names[bytes] == ',');
    }
    return true;
}

const char *cli_aov_name(const cli_aovs *aovs, uint32_t i)
{
    for (uint32_t kind = 0; kind < FL_AOV_COUNT; kind++)
        if ((aovs->kinds >> kind & 1u) && i-- == 0)
            return fl_aov_names[kind];
    for (uint32_t map = 0; map < CLI_MAP_COUNT; map++)
        if ((aovs->maps >> map & 1u) && i-- == 0)
            return map_names[map];
    return NULL;
}

char *cli_aov_path(const char *path, const char *name)
{
    size_t stem = (size_t)(fl_path_ending(path) - path), room = stem + 32;
    char *beside = malloc(room);
    if (beside)
        snprintf(beside, room, "%.*s.%s.exr", (int)stem, path, name);
    return beside;
}

static bool save(const char *path, const char *name, uint32_t width, uint32_t height, float *rgb, fl_diags *diags)
{
    char *beside = cli_aov_path(path, name);
    if (!beside)
        return fl_out_of_memory(diags, path);
    fl_image image = {.width = width, .height = height, .format = FL_PIXEL_FLOAT, .pixels = rgb};
    bool ok = fl_image_save(beside, &image, NULL, 0, diags);
    free(beside);
    return ok;
}

bool cli_aov_save(const cli_scene *scene, const cli_picture *picture, const cli_aovs *aovs, const char *path,
                  fl_diags *diags)
{
    size_t pixels = (size_t)picture->width * picture->height;
    float *rgb = malloc(pixels * 3 * sizeof *rgb);
    fl_frame *frame = rgb ? fl_frame_create(scene->compiled, &scene->params, diags) : NULL;
    bool ok = frame || (!rgb && fl_out_of_memory(diags, path));
    fl_aov_grid grid = {.step = 1, .width = picture->width, .height = picture->height};
    for (uint32_t kind = 0; kind < FL_AOV_COUNT && ok; kind++)
        if (aovs->kinds >> kind & 1u)
            ok = fl_aov_eval(frame, (fl_aov)kind, NULL, &grid, rgb)
                     ? save(path, fl_aov_names[kind], grid.width, grid.height, rgb, diags)
                     : fl_out_of_memory(diags, path);
    for (uint32_t map = 0; map < CLI_MAP_COUNT && ok; map++)
        if (aovs->maps >> map & 1u) {
            for (size_t i = 0; i < pixels; i++)
                rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = picture->maps[map][i];
            ok = save(path, map_names[map], grid.width, grid.height, rgb, diags);
        }
    fl_frame_release(frame);
    free(rgb);
    return ok;
}
