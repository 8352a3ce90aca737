/* SPDX-License-Identifier: MIT */
#include "cli/outputs.h"

#include <stdlib.h>
#include <string.h>

#include "cli/places.h"

static bool add(cli_outputs *outputs, const char *path, fl_diags *diags)
{
    char *copy = strdup(path);
    if (!copy)
        return fl_out_of_memory(diags, path);
    outputs->paths[outputs->count++] = copy;
    return true;
}

bool cli_outputs_list(const cli_options *options, const cli_aovs *aovs, cli_outputs *out,
                      fl_diags *diags)
{
    for (uint32_t i = 0; i < options->output_count; i++)
        if (!add(out, options->outputs[i], diags))
            return false;
    const char *name;
    for (uint32_t i = 0; options->output_count && (name = cli_aov_name(aovs, i)) != NULL; i++) {
        char *path = cli_aov_path(options->outputs[0], name);
        bool ok = path ? add(out, path, diags) : fl_out_of_memory(diags, name);
        free(path);
        if (!ok)
            return false;
    }
    return !options->checkpoint || add(out, options->checkpoint, diags);
}

void cli_outputs_deinit(cli_outputs *outputs)
{
    for (uint32_t i = 0; i < outputs->count; i++)
        free(outputs->paths[i]);
    *outputs = (cli_outputs){0};
}

bool cli_outputs_check(const cli_outputs *outputs, fl_diags *diags)
{
    for (uint32_t i = 0; i < outputs->count; i++)
        if (!cli_place_check(outputs->paths[i], diags))
            return false;
    return true;
}

const char *cli_outputs_twice(const cli_outputs *outputs)
{
    for (uint32_t i = 0; i < outputs->count; i++)
        for (uint32_t j = 0; j < i; j++)
            if (cli_places_are_same(outputs->paths[i], outputs->paths[j]))
                return outputs->paths[i];
    return NULL;
}

static bool is_read(const char *path, const fl_scene *scene)
{
    bool is_same = cli_places_are_same(path, scene->path);
    for (uint32_t i = 0; i < scene->mesh_count && !is_same; i++)
        is_same = cli_places_are_same(path, scene->meshes[i].path);
    for (uint32_t i = 0; i < scene->image_count && !is_same; i++)
        is_same = cli_places_are_same(path, scene->images[i].path);
    return is_same;
}

const char *cli_outputs_over_input(const cli_outputs *outputs, const cli_scene *scene)
{
    for (uint32_t i = 0; i < outputs->count; i++)
        if (is_read(outputs->paths[i], scene->scene))
            return outputs->paths[i];
    return NULL;
}
