/* SPDX-License-Identifier: MIT
 *
 * What a quick first build brings: the same picture of a mesh with and without it, in turn, from
 * compiling on.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/bench_run.h"
#include "cli/json_text.h"

/* The mesh on a square, before a disc light: 640x640. */
static const char scene_text[] =
    "firstlight 1\n"
    "PerspectiveCamera { center 0.4 1.5 4.2 direction -0.09 -0.3 -1 up 0 1 0 angle 31 }\n"
    "Background { color 0.3 0.36 0.42 ambientLight 0.1 0.1 0.1 }\n"
    "Lights { numLights 1 DiskLight { position -3 4.2 3.5 direction 0.6 -0.8 -0.7 radius 0.6\n"
    "    color 1.2 1.2 1.2 } }\n"
    "Materials { numMaterials 2 Material { diffuseColor 0.75 0.72 0.68 }\n"
    "    Material { diffuseColor 0.7 0.4 0.25 specularColor 0.2 0.2 0.2 shininess 30 } }\n"
    "Group { numObjects 2\n"
    "    MaterialIndex 0 Square { corner -9 -1 9 u 18 0 0 v 0 0 -18 }\n"
    "    MaterialIndex 1 TriangleMesh { obj_file mesh normals smooth } }\n";

static bool find_mesh(void *context, const char *scene_path, const char *reference, char *out_path,
                      size_t out_bytes)
{
    (void)context, (void)scene_path;
    snprintf(out_path, out_bytes, "%s", reference);
    return true;
}

static fl_mesh *make_mesh(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)path, (void)loc;
    return bench_mesh_create(context, diags);
}

static fl_image *no_image(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)context;
    fl_error(diags, loc, "no picture '%s'", path);
    return NULL;
}

/* Seconds of wall time from the start of compiling. */
enum { COMPILED, FIRST_PICTURE, FIRST_SAMPLE, ALL_SAMPLES, REFINED, MOMENT_COUNT };

static const char *const moment_names[MOMENT_COUNT] = {"compiled", "first picture", "first sample",
                                                       "16 samples", "refined"};

/* One way to come to a picture. */
typedef struct way {
    bool is_quick;
    double at[MOMENT_COUNT][BENCH_ROUNDS_MAX];
    fl_progress progress; /* Of the last round, like the film. */
    float *film;
} way;

typedef struct swap {
    fl_render *render;
    double begin, at;
} swap;

static void go_on_with(void *context, fl_compiled *refined)
{
    swap *s = context;
    fl_diags diags = {0};
    if (refined && fl_render_replace_scene(s->render, refined, &diags))
        s->at = cli_wall_seconds() - s->begin;
    fl_diags_deinit(&diags);
}

/* Consumes `compiled`; the render was created at `s->begin + compiled`. */
static bool render_on(const bench_setup *setup, const fl_params *params, fl_compiled *compiled,
                      swap *s, way *out)
{
    fl_refine *refine = NULL;
    bool ok = fl_render_restart(s->render, compiled, params, setup->diags);
    if (ok && compiled->is_quick)
        ok = (refine = fl_refine_start(compiled, setup->thread_count, go_on_with, s,
                                       setup->diags)) != NULL;
    fl_compiled_release(compiled);
    ok = ok && fl_render_wait(s->render, -1.0);
    fl_refine_destroy(refine);
    return ok && fl_render_mean(s->render, out->film, (size_t)3 * params->width * params->height,
                                &out->progress);
}

static bool go_once(const bench_setup *setup, const fl_scene *scene, const fl_params *params,
                    uint32_t samples, uint32_t round, way *w)
{
    fl_compile_options options = setup->compile;
    options.quick_above = w->is_quick;
    swap s = {.begin = cli_wall_seconds()};
    fl_pool *pool = fl_pool_create(setup->thread_count, setup->diags);
    fl_compiled *compiled = pool ? fl_compile(scene, &options, pool, setup->diags) : NULL;
    fl_pool_destroy(pool);
    w->at[COMPILED][round] = cli_wall_seconds() - s.begin;
    if (!compiled)
        return false;
    const fl_render_options how = {.thread_count = setup->thread_count};
    const fl_render_limits limits = {.samples = samples};
    s.render = fl_render_create(&how, setup->diags);
    if (!s.render) {
        fl_compiled_release(compiled);
        return false;
    }
    fl_render_set_limits(s.render, &limits);
    double begun = cli_wall_seconds() - s.begin;
    bool ok = render_on(setup, params, compiled, &s, w);
    fl_render_destroy(s.render);
    w->at[FIRST_PICTURE][round] = begun + w->progress.first_picture_seconds;
    w->at[FIRST_SAMPLE][round] = begun + w->progress.first_sample_seconds;
    w->at[ALL_SAMPLES][round] = begun + w->progress.seconds;
    w->at[REFINED][round] = s.at;
    return ok;
}

static void report(const bench_setup *setup, const bench_mesh *mesh, int moment, way *full,
                   way *quick)
{
    uint32_t n = setup->rounds;
    double ratio[BENCH_ROUNDS_MAX];
    for (uint32_t r = 0; r < n; r++)
        ratio[r] = full->at[moment][r] / quick->at[moment][r];
    bool is_pair = moment != REFINED;
    bench_figure f = bench_figure_of(full->at[moment], n),
                 q = bench_figure_of(quick->at[moment], n), gain = bench_figure_of(ratio, n);
    if (setup->rows) {
        json_t *line = json_pack("{s:o, s:I, s:s, s:s, s:f}", "mesh", cli_json_text(mesh->name),
                                 "triangles", (json_int_t)mesh->face_count, "kind", "first-picture",
                                 "moment", moment_names[moment], "quick_ms", q.median * 1e3);
        if (is_pair)
            json_object_update_new(line, json_pack("{s:f, s:f, s:f, s:f}", "full_ms",
                                                   f.median * 1e3, "ratio", gain.median,
                                                   "ratio_min", gain.min, "ratio_max", gain.max));
        json_array_append_new(setup->rows, line);
        return;
    }
    printf("%-12s %8u  %-14s quick build %8.1f ms", mesh->name, mesh->face_count,
           moment_names[moment], q.median * 1e3);
    if (is_pair)
        printf("  full build %8.1f ms  ratio %.2f (%.2f to %.2f)", f.median * 1e3, gain.median,
               gain.min, gain.max);
    putchar('\n');
    fflush(stdout);
}

/* What the first sample of every pixel costs, of CPU time of all threads. */
static void report_stages(const bench_setup *setup, const bench_mesh *mesh, way *one)
{
    double rendering[BENCH_ROUNDS_MAX];
    for (uint32_t r = 0; r < setup->rounds; r++)
        rendering[r] = one->at[FIRST_SAMPLE][r] - one->at[COMPILED][r];
    double wall = bench_figure_of(rendering, setup->rounds).median;
    const fl_progress *p = &one->progress;
    if (!setup->rows)
        printf("%-12s %8u  first sample alone %.1f ms, CPU by stage in ms:", mesh->name,
               mesh->face_count, wall * 1e3);
    json_t *costs = json_object();
    for (int k = 0; k < FL_COST_COUNT; k++) {
        json_object_set_new(costs, fl_cost_names[k], json_real(p->cost_seconds[k] * 1e3));
        if (!setup->rows)
            printf(" %s %.1f", fl_cost_names[k], p->cost_seconds[k] * 1e3);
    }
    if (setup->rows)
        json_array_append_new(
            setup->rows, json_pack("{s:o, s:I, s:s, s:f, s:O}", "mesh", cli_json_text(mesh->name),
                                   "triangles", (json_int_t)mesh->face_count, "kind",
                                   "first-sample", "ms", wall * 1e3, "stage_ms", costs));
    else
        putchar('\n');
    json_decref(costs);
}

/* ways: full, quick, and full for one sample only. */
static bool run(const bench_setup *setup, const bench_mesh *mesh, const fl_scene *scene,
                way ways[3])
{
    fl_params params;
    fl_params_from_scene(&params, scene, false);
    size_t bytes = (size_t)3 * params.width * params.height * sizeof(float);
    for (int k = 0; k < 3; k++)
        if (!(ways[k].film = malloc(bytes)))
            return fl_out_of_memory(setup->diags, "the film");
    double begin = cli_wall_seconds();
    for (uint32_t r = 0; r < setup->rounds; r++) {
        bench_show_progress(r, setup->rounds, begin);
        for (int k = 0; k < 3; k++)
            if (!go_once(setup, scene, &params, k < 2 ? BENCH_SAMPLES : 1, r, &ways[k]))
                return false;
        if (memcmp(ways[0].film, ways[1].film, bytes) != 0)
            return fl_environment_error(setup->diags, "the films of both builds differ");
    }
    bench_show_progress(setup->rounds, setup->rounds, begin);
    for (int moment = 0; moment < MOMENT_COUNT; moment++)
        report(setup, mesh, moment, &ways[0], &ways[1]);
    report_stages(setup, mesh, &ways[2]);
    return true;
}

bool bench_first_run(const bench_setup *setup, const bench_mesh *mesh)
{
    const fl_files files = {(void *)(uintptr_t)mesh, find_mesh, make_mesh, no_image};
    fl_scene *scene = fl_scene_parse(scene_text, sizeof scene_text - 1, mesh->name,
                                     &(fl_parse_options){0}, &files, setup->diags);
    way *ways = calloc(3, sizeof *ways);
    bool ok = scene && (ways || fl_out_of_memory(setup->diags, "times"));
    if (ok) {
        ways[1].is_quick = true;
        ok = run(setup, mesh, scene, ways);
    }
    for (int k = 0; ways && k < 3; k++)
        free(ways[k].film);
    free(ways);
    fl_scene_destroy(scene);
    return ok;
}
