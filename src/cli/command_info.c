/* SPDX-License-Identifier: MIT */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli/commands.h"
#include "cli/json_text.h"
#include "cli/noise.h"

static const char *const severity_names[] = {"note", "warning", "error"};

static json_t *diagnostics_json(const fl_diags *diags)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < diags->count; i++) {
        const fl_diag *d = &diags->items[i];
        json_array_append_new(list, json_pack("{s:o, s:i, s:i, s:s, s:o}", "file", cli_json_text(d->loc.file), "line",
                                              (int)d->loc.line, "column", (int)d->loc.column, "severity",
                                              severity_names[d->severity], "message", cli_json_text(d->message)));
    }
    return list;
}

/* The tree of rays of the sample that --pixel names, from malloc, and its value; NULL after adding an error. */
static char *tree_text(const cli_options *options, const cli_scene *scene, float out_rgb[3])
{
    fl_raytree tree = {0};
    fl_frame *frame = fl_frame_create(scene->compiled, &scene->params, scene->diags);
    if (!frame)
        return NULL;
    char *text = NULL;
    if (fl_raytree_trace(frame, options->pixel[0], options->pixel[1], options->pixel[2], &tree) &&
        fl_raytree_find_blockers(frame, &tree)) {
        size_t bytes = fl_raytree_text(frame, &tree, false, NULL, 0) + 1;
        text = malloc(bytes);
        if (text)
            fl_raytree_text(frame, &tree, false, text, bytes);
    }
    if (!text)
        fl_out_of_memory(scene->diags, "the tree of rays");
    for (int c = 0; c < 3; c++)
        out_rgb[c] = tree.rgb[c];
    fl_raytree_deinit(&tree);
    fl_frame_release(frame);
    return text;
}

static json_t *tree_json(const cli_options *options, const cli_scene *scene)
{
    float rgb[3];
    char *text = tree_text(options, scene, rgb);
    json_t *tree = text ? json_pack("{s:[I, I], s:I, s:[f, f, f], s:o}", "pixel", (json_int_t)options->pixel[0],
                                    (json_int_t)options->pixel[1], "sample", (json_int_t)options->pixel[2], "rgb",
                                    (double)rgb[0], (double)rgb[1], (double)rgb[2], "tree", cli_json_text(text))
                        : NULL;
    free(text);
    return tree;
}

/* False: for want of memory. */
static bool print_json(const cli_options *options, const cli_scene *scene, bool is_open,
                       const fl_noise_split *noise)
{
    json_t *line = json_pack("{s:o, s:o}", "scene", cli_json_text(scene->path), "diagnostics", diagnostics_json(scene->diags));
    const fl_compiled *c = scene->compiled;
    json_t *needs = json_array();
    for (uint32_t i = 0; c && i < FL_NEED_COUNT; i++)
        if (c->needs >> i & 1u)
            json_array_append_new(needs, json_string(fl_need_names[i]));
    json_object_set_new(line, "needs", needs);
    if (c) {
        json_t *more = json_pack(
            "{s:s, s:o, s:i, s:i, s:i, s:I, s:I, s:i, s:i, s:i, s:s, s:f, s:{s:I, s:I, s:I}}", "dialect",
            fl_dialect_names[scene->scene->dialect], "dialect_reason", cli_json_text(scene->scene->dialect_reason), "spheres",
            (int)c->geometry.spheres.count, "planes", (int)c->geometry.planes.count, "squares",
            (int)c->geometry.patches.count, "triangles", (json_int_t)c->triangle_count, "revolution_pieces",
            (json_int_t)c->revolution_piece_count, "instances", (int)c->geometry.instance_count, "lights",
            (int)scene->scene->light_count, "textures", (int)c->texture_count, "isa", fl_isa_name(c->isa),
            "build_seconds", c->build_seconds, "bytes", "geometry", (json_int_t)c->geometry_bytes, "accel",
            (json_int_t)c->accel_bytes, "textures", (json_int_t)c->texture_bytes);
        json_object_update(line, more);
        json_decref(more);
    }
    if (is_open && cli_has(options, CLI_OPT_PIXEL))
        json_object_set_new(line, "sample", tree_json(options, scene));
    if (noise)
        json_object_set_new(line, "noise", cli_noise_json(noise));
    return cli_json_print(line, 9);
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
    fl_noise_split split, *noise = NULL;
    cli_catch_signals();
    bool ok = cli_scene_open(options, options->paths[0], &scene);
    if (ok && cli_has(options, CLI_OPT_PIXEL) &&
        (options->pixel[0] >= scene.params.width || options->pixel[1] >= scene.params.height)) {
        int code = cli_usage_error(CLI_INFO, "pixel %u,%u lies outside the picture of %ux%u", options->pixel[0],
                                   options->pixel[1], scene.params.width, scene.params.height);
        cli_scene_close(&scene);
        fl_diags_deinit(&diags);
        return code;
    }
    if (ok && cli_has(options, CLI_OPT_NOISE_SPLIT)) {
        ok = cli_noise_measure(scene.compiled, &scene.params, scene.path, &split, &diags);
        noise = ok ? &split : NULL;
    }
    bool is_printed = true;
    if (cli_has(options, CLI_OPT_JSON)) {
        scene.path = options->paths[0];
        is_printed = print_json(options, &scene, ok, noise);
    } else if (ok && cli_has(options, CLI_OPT_PIXEL)) {
        float rgb[3];
        char *text = tree_text(options, &scene, rgb);
        if (text)
            fputs(text, stdout);
        free(text);
    } else if (ok) {
        print_text(&scene);
    }
    if (noise && !cli_has(options, CLI_OPT_JSON))
        cli_noise_print(noise, "  ");
    cli_print_diags(&diags);
    int code = is_printed ? cli_exit_code(&diags) : CLI_ENVIRONMENT;
    if (code == CLI_DONE && cli_was_interrupted())
        code = CLI_INTERRUPTED;
    cli_scene_close(&scene);
    fl_diags_deinit(&diags);
    return code;
}
