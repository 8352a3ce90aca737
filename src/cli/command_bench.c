/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/bench_run.h"
#include "cli/commands.h"
#include "cli/json_text.h"
#include "cli/places.h"

enum { ROUNDS = 5, SIDE = 512, GROWTH_SIDE = 256, SOURCE_SIDE = 96 };

/* Triangles of sphere:N. */
enum { SPHERE_LEAST = 12, SPHERE_MOST = 100000000 };

static bool is_mesh_file(const char *path)
{
    static const char *const endings[] = {".obj", ".ply", ".stl", ".gltf", ".glb"};
    size_t length = strlen(path);
    for (size_t i = 0; i < FL_COUNT_OF(endings); i++) {
        size_t n = strlen(endings[i]);
        if (length > n && strcmp(path + length - n, endings[i]) == 0)
            return true;
    }
    return false;
}

static const char sphere_prefix[] = "sphere:";

static bool is_sphere(const char *path)
{
    return strncmp(path, sphere_prefix, sizeof sphere_prefix - 1) == 0;
}

/* N of sphere:N; 0: not a number that is taken. */
static uint32_t sphere_triangles(const char *path)
{
    const char *digits = path + sizeof sphere_prefix - 1;
    size_t count = strspn(digits, "0123456789");
    unsigned long n = count >= 1 && count <= 9 && !digits[count] ? strtoul(digits, NULL, 10) : 0;
    return n >= SPHERE_LEAST && n <= SPHERE_MOST ? (uint32_t)n : 0;
}

/* A mesh file, sphere:N for a bumpy sphere of about N triangles, or a scene. */
static bool run_path(const cli_options *options, const bench_setup *setup, const char *path)
{
    if (is_sphere(path) || is_mesh_file(path)) {
        bench_mesh mesh = {0};
        bool ok = is_sphere(path) ? bench_mesh_sphere(sphere_triangles(path), &mesh, setup->diags)
                                  : bench_mesh_load(path, &mesh, setup->diags);
        ok = ok && (cli_has(options, CLI_OPT_FIRST_PICTURE) ? bench_first_run(setup, &mesh)
                                                            : bench_mesh_run(setup, &mesh));
        bench_mesh_deinit(&mesh);
        return ok;
    }
    cli_scene scene = {.diags = setup->diags};
    bool ok =
        cli_scene_open(options, path, &scene) && bench_scene_run(setup, &scene, options->threads);
    cli_scene_close(&scene);
    return ok;
}

/* What is measured when nothing is named: as far as it is there. */
static bool run_default(const cli_options *options, const bench_setup *setup)
{
    static const char *const paths[] = {"assets/bunny_1k.obj", "assets/bunny.obj", "sphere:1000000",
                                        "scenes/vase.txt", "scenes/bunny.txt"};
    bool ok = true;
    char found[PATH_MAX];
    for (size_t i = 0; ok && i < FL_COUNT_OF(paths) && !cli_was_interrupted(); i++)
        if (cli_data_find(paths[i], found) || strchr(paths[i], ':'))
            ok = run_path(options, setup, found);
    return ok;
}

/* The mesh alone is the one that our scene holds. */
static bool run_source(const cli_options *options, const bench_setup *setup)
{
    cli_scene scene = {.diags = setup->diags};
    bench_mesh mesh = {0};
    char bunny[PATH_MAX], default_scene[PATH_MAX];
    cli_data_find("assets/bunny_1k.obj", bunny);
    cli_data_find("scenes/bunny.txt", default_scene);
    bool ok =
        bench_mesh_load(bunny, &mesh, setup->diags) &&
        cli_scene_open(options, options->path_count ? options->paths[0] : default_scene, &scene) &&
        bench_source_run(setup, &scene, &mesh);
    bench_mesh_deinit(&mesh);
    cli_scene_close(&scene);
    return ok;
}

static uint32_t side_of(const cli_options *options)
{
    if (cli_has(options, CLI_OPT_SIZE))
        return (options->size[0] + 7) / 8 * 8;
    if (cli_has(options, CLI_OPT_SOURCE))
        return SOURCE_SIDE;
    return cli_has(options, CLI_OPT_GROWTH) ? GROWTH_SIDE : SIDE;
}

/* What the words may be; CLI_DONE, or CLI_WRONG_USAGE after saying what is wrong. */
static int check_words(const cli_options *options)
{
    if (cli_has(options, CLI_OPT_GROWTH) && options->path_count)
        return cli_usage_error(CLI_BENCH, "--growth makes its own scenes: '%s' means nothing to it",
                               options->paths[0]);
    if (cli_has(options, CLI_OPT_SOURCE) && options->path_count > 1)
        return cli_usage_error(CLI_BENCH, "--source-comparison takes one scene, got %u",
                               options->path_count);
    for (uint32_t i = 0; i < options->path_count; i++)
        if (is_sphere(options->paths[i]) && !sphere_triangles(options->paths[i]))
            return cli_usage_error(
                CLI_BENCH, "'%s': expected sphere:N with a whole number of triangles from %d to %d",
                options->paths[i], SPHERE_LEAST, SPHERE_MOST);
    return CLI_DONE;
}

int cli_command_bench(const cli_options *options)
{
    if (check_words(options) != CLI_DONE)
        return CLI_WRONG_USAGE;
    cli_catch_signals();
    fl_diags diags = {0};
    bool is_json = cli_has(options, CLI_OPT_JSON);
    bench_setup setup = {.rounds = cli_has(options, CLI_OPT_REPEATS) ? options->repeats : ROUNDS,
                         .side = side_of(options),
                         .thread_count = options->threads,
                         .compile = {.accel = (fl_accel)options->accel,
                                     .has_isa = cli_has(options, CLI_OPT_ISA),
                                     .octree_height = options->octree_height},
                         .rows = is_json ? json_array() : NULL,
                         .diags = &diags};
    bool ok = true;
    if (setup.compile.has_isa) {
        fl_isa_find(options->isa, &setup.compile.isa);
        ok = fl_cpu_has(setup.compile.isa) ||
             fl_environment_error(&diags, "this machine has no %s", options->isa);
    }
    if (options->against)
        ok = ok &&
             (setup.peer = bench_peer_load(options->against, &setup.peer_config, &diags)) != NULL;
    bool is_special = cli_has(options, CLI_OPT_SOURCE) || cli_has(options, CLI_OPT_GROWTH);
    if (ok && cli_has(options, CLI_OPT_SOURCE))
        ok = run_source(options, &setup);
    if (ok && cli_has(options, CLI_OPT_GROWTH))
        ok = bench_growth_run(&setup);
    if (ok && options->path_count == 0 && !is_special)
        ok = run_default(options, &setup);
    for (uint32_t i = 0; ok && !is_special && i < options->path_count && !cli_was_interrupted();
         i++)
        ok = run_path(options, &setup, options->paths[i]);
    bool is_printed = !is_json || cli_json_print(json_pack("{s:O}", "rows", setup.rows), 6);
    json_decref(setup.rows);
    cli_print_diags(&diags);
    int code = is_printed ? cli_exit_code(&diags) : CLI_ENVIRONMENT;
    fl_diags_deinit(&diags);
    return code == CLI_DONE && cli_was_interrupted() ? CLI_INTERRUPTED : code;
}
