/* SPDX-License-Identifier: MIT
 *
 * Measuring of `firstlight bench`: interleaved runs, medians, spread; and rows to print.
 */
#ifndef CLI_BENCH_RUN_H
#define CLI_BENCH_RUN_H

#include <jansson.h>

#include "cli/bench_peer.h"
#include "cli/bench_work.h"
#include "cli/load.h"

enum { BENCH_ROUNDS_MAX = 64 };

typedef struct bench_setup {
    uint32_t rounds, side; /**< Pairs of runs; pixels of the square picture. */
    uint32_t thread_count; /**< As fl_thread_count takes it. */
    fl_compile_options compile;
    const bench_peer *peer;  /**< NULL: nobody. */
    const char *peer_config; /**< Passed on to it. */
    json_t *rows;            /**< Array to which rows are added; NULL: rows are printed. */
    fl_diags *diags;
} bench_setup;

typedef struct bench_figure {
    double median, min, max;
} bench_figure;

/** Median, least and greatest; sorts the values. count >= 1. */
bench_figure bench_figure_of(double *values, uint32_t count);

/** CPU seconds of this thread. */
double bench_thread_seconds(void);

/** Say on a terminal how far it is and how long the rest will take; `begin` by cli_wall_seconds. */
void bench_show_progress(uint32_t done, uint32_t all, double begin);

/** Rays of all kinds and the build, on one mesh, one thread. False after adding an error. */
bool bench_mesh_run(const bench_setup *setup, const bench_mesh *mesh);

/** A picture of the mesh with and without a quick first build, all threads: times from compiling on
 * to the first picture, the first sample and BENCH_SAMPLES; the first sample's cost by stage. False
 * after adding an error, as that the films differ. */
bool bench_first_run(const bench_setup *setup, const bench_mesh *mesh);

enum { BENCH_SAMPLES = 16 };

/** Render a whole picture of BENCH_SAMPLES samples. False after adding an error. */
bool bench_render(fl_compiled *compiled, const fl_params *params, uint32_t thread_count,
                  fl_progress *out, fl_diags *diags);

/** Time to first picture, to the first and to 16 samples of a scene, for 1 thread and for all; cost
 * of its stages; for every instruction set, unless one was asked for. False after adding an error.
 */
bool bench_scene_run(const bench_setup *setup, const cli_scene *scene, uint32_t thread_count);

/** The source's comparison: a whole picture of `scene`, and the primary rays of `mesh` alone, by
 * hierarchy, octree and brute force, one thread, in turn. False after adding an error. */
bool bench_source_run(const bench_setup *setup, const cli_scene *scene, const bench_mesh *mesh);

/** What can grow. */
typedef enum bench_growth {
    BENCH_SPHERES,   /**< In a cube, as small as they are many. */
    BENCH_TRIANGLES, /**< Of one sphere with bumps. */
    BENCH_INSTANCES, /**< Of a mesh of 1,200 triangles, as the spheres. */
    BENCH_LIGHTS,    /**< Over spheres on a plane. */
    BENCH_GROWTH_COUNT
} bench_growth;

extern const char *const bench_growth_names[BENCH_GROWTH_COUNT];

/** What became of a scene with `count` of something. A ray is a primary one; with lights, any. */
typedef struct bench_growth_row {
    bench_growth of;
    uint32_t count;
    double node_visits, primitive_tests; /**< A ray; exact. */
    double rays_per_pixel;               /**< Shadow rays included. Exact. */
    bench_figure ns;                     /**< CPU time of a ray. */
    double build_seconds, bytes; /**< CPU time to make and compile; of geometry and structure. */
} bench_growth_row;

/** Measure one size. False after adding an error. */
bool bench_growth_measure(const bench_setup *setup, bench_growth of, uint32_t count,
                          bench_growth_row *out);

/** All sizes of all things, a row each. False after adding an error. */
bool bench_growth_run(const bench_setup *setup);

/** Load the module for the peer from beside the program or wherever the system looks; `name` is
 * NAME or NAME:CONFIG. NULL after adding an error. */
const bench_peer *bench_peer_load(const char *name, const char **out_config, fl_diags *diags);

#endif
