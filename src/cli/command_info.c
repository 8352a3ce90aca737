/* SPDX-License-Identifier: MIT */
#include <jansson.h>
#include <stdio.h>

#include "cli/commands.h"

static const char *const severity_names[] = {"note", "warning", "error"};

static json_t *diagnostics_json(const fl_diags *diags)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < diags->count; i++) {
        const fl_diag *d = &diags->items[i];
        json_array_append_new(list, json_pack("{s:s?, s:i, s:i, s:s, s:s}", "file", d->loc.file, "line",
                                              (int)d->loc.line, "column", (int)d->loc.column, "severity",
                                              severity_names[d->severity], "message", d->message));
    }
    return list;
}

static void print_json(const cli_scene *scene)
{
    json_t *line = json_pack("{s:s, s:o}", "scene", scene->path, "diagnostics", diagnostics_json(scene->diags));
    const fl_compiled *c = scene->compiled;
    json_t *needs = json_array();
    for (uint32_t i = 0; c && i < FL_NEED_COUNT; i++)
        if (c->needs >> i & 1u)
            json_array_append_new(needs, json_string(fl_need_names[i]));
    json_object_set_new(line, "needs", needs);
    if (c) {
        json_t *more = json_pack(
            "{s:s, s:s, s:i, s:i, s:i, s:I, s:I, s:i, s:i, s:i, s:s, s:f, s:{s:I, s:I, s:I}}", "dialect",
            fl_dialect_names[scene->scene->dialect], "dialect_reason", scene->scene->dialect_reason, "spheres",
            (int)c->geometry.spheres.count, "planes", (int)c->geometry.planes.count, "squares",
            (int)c->geometry.patches.count, "triangles", (json_int_t)c->triangle_count, "revolution_pieces",
            (json_int_t)c->revolution_piece_count, "instances", (int)c->geometry.instance_count, "lights",
            (int)scene->scene->light_count, "textures", (int)c->texture_count, "isa", fl_isa_name(c->isa),
            "build_seconds", c->build_seconds, "bytes", "geometry", (json_int_t)c->geometry_bytes, "accel",
            (json_int_t)c->accel_bytes, "textures", (json_int_t)c->texture_bytes);
        json_object_update(line, more);
        json_decref(more);
    }
    json_dumpf(line, stdout, JSON_COMPACT);
    putchar('\n');
    json_decref(line);
}

static void print_text(const cli_scene *scene)
{
    const fl_compiled *c = scene->compiled;
    const fl_params *p = &scene->params;
    printf("%s\n  dialect   %s: %s\n", scene->path, fl_dialect_names[scene->scene->dialect],
           scene->scene->dialect_reason);
    printf("  contains  %u spheres, %u planes, %u squares and disks, %llu triangles, %llu revolution pieces, %u instances, "
           "%u lights, %u textures\n",
           c->geometry.spheres.count, c->geometry.planes.count, c->geometry.patches.count,
           (unsigned long long)c->triangle_count, (unsigned long long)c->revolution_piece_count,
           c->geometry.instance_count, scene->scene->light_count, c->texture_count);
    printf("  needs    ");
    for (uint32_t i = 0; i < FL_NEED_COUNT; i++)
        if (c->needs >> i & 1u)
            printf(" %s", fl_need_names[i]);
    printf("\n  picture   %ux%u, %s, depth %u\n", p->width, p->height,
           p->camera.aperture > 0.0 ? "thin lens" : "pinhole", p->depth_limit);
    if (p->camera.aperture > 0.0)
        printf("  lens      radius %g, focus %g\n", p->camera.aperture, p->camera.focus);
    printf("  kernels   %s\n  memory    geometry %.1f MB, acceleration %.1f MB, textures %.1f MB; built in %.3f s\n",
           fl_isa_name(c->isa), (double)c->geometry_bytes / 1e6, (double)c->accel_bytes / 1e6,
           (double)c->texture_bytes / 1e6, c->build_seconds);
}

int cli_command_info(const cli_options *options)
{
    if (options->path_count != 1)
        return cli_usage_error(CLI_INFO, "expected one scene, got %u", options->path_count);
    fl_diags diags = {0};
    cli_scene scene = {.diags = &diags};
    bool ok = cli_scene_open(options, options->paths[0], &scene);
    if (cli_has(options, CLI_OPT_JSON)) {
        scene.path = options->paths[0];
        print_json(&scene);
    } else if (ok) {
        print_text(&scene);
    }
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    cli_scene_close(&scene);
    fl_diags_deinit(&diags);
    return code;
}
