/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "cli/bench_run.h"
#include "cli/commands.h"

enum { ROUNDS = 5, SIDE = 512, GROWTH_SIDE = 256, SOURCE_SIDE = 96, MILLION = 1000000 };

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

/* A mesh file, sphere:N for a bumpy sphere of about N triangles, or a scene. */
static bool run_path(const cli_options *options, const bench_setup *setup, const char *path)
{
    uint32_t faces;
    char rest;
    if (sscanf(path, "sphere:%u%c", &faces, &rest) == 1 || is_mesh_file(path)) {
        bench_mesh mesh = {0};
        bool is_sphere = strncmp(path, "sphere:", 7) == 0;
        bool ok = is_sphere ? bench_mesh_sphere(fl_min_u32(fl_max_u32(faces, 12), 100 * MILLION),
                                                &mesh, setup->diags)
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
    for (size_t i = 0; ok && i < FL_COUNT_OF(paths) && !cli_was_interrupted(); i++)
        if (strchr(paths[i], ':') || access(paths[i], R_OK) == 0)
            ok = run_path(options, setup, paths[i]);
    return ok;
}

/* The mesh alone is the one that our scene holds. */
static bool run_source(const cli_options *options, const bench_setup *setup)
{
    cli_scene scene = {.diags = setup->diags};
    bench_mesh mesh = {0};
    bool ok = bench_mesh_load("assets/bunny_1k.obj", &mesh, setup->diags) &&
              cli_scene_open(options, options->path_count ? options->paths[0] : "scenes/bunny.txt",
                             &scene) &&
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

int cli_command_bench(const cli_options *options)
{
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
    if (is_json) {
        json_t *line = json_pack("{s:O}", "rows", setup.rows);
        json_dumpf(line, stdout, JSON_COMPACT | JSON_REAL_PRECISION(6));
        putchar('\n');
        json_decref(line);
    }
    json_decref(setup.rows);
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    fl_diags_deinit(&diags);
    return code == CLI_DONE && cli_was_interrupted() ? CLI_INTERRUPTED : code;
}
