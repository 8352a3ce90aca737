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
/** Wall seconds from some point on. */
double bench_wall_seconds(void);

/** Rays of all kinds and the build, on one mesh, one thread. False after adding an error. */
bool bench_mesh_run(const bench_setup *setup, const bench_mesh *mesh);

/** Time to first picture, to the first and to 16 samples of a scene, for 1 thread and for all; cost
 * of its stages and of instruction sets. False after adding an error. */
bool bench_scene_run(const bench_setup *setup, const cli_scene *scene, uint32_t thread_count);

/** Load the module for the peer from beside the program or wherever the system looks; `name` is
 * NAME or NAME:CONFIG. NULL after adding an error. */
const bench_peer *bench_peer_load(const char *name, const char **out_config, fl_diags *diags);

#endif
