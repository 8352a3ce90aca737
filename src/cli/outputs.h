/* SPDX-License-Identifier: MIT
 *
 * What a render is to write, looked over before it is rendered: hours may lie between.
 */
#ifndef CLI_OUTPUTS_H
#define CLI_OUTPUTS_H

#include "cli/aov.h"

enum { CLI_PLACES_MAX = CLI_OUTPUTS_MAX + FL_AOV_COUNT + CLI_MAP_COUNT + 1 };

/** Names of all files. Zero-initialise; free with cli_outputs_deinit. */
typedef struct cli_outputs {
    char *paths[CLI_PLACES_MAX]; /**< Pictures, maps, checkpoint. */
    uint32_t count;
} cli_outputs;

/** List them. False: out of memory, after adding the error. */
bool cli_outputs_list(const cli_options *options, const cli_aovs *aovs, cli_outputs *out,
                      fl_diags *diags);
void cli_outputs_deinit(cli_outputs *outputs);

/** Whether all can be written (cli_place_check). False after adding an environment error. */
bool cli_outputs_check(const cli_outputs *outputs, fl_diags *diags);

/** A place that would be written twice, or NULL. */
const char *cli_outputs_twice(const cli_outputs *outputs);

/** A place where a file stands that the scene reads: its text, a mesh, a picture. NULL: none. */
const char *cli_outputs_over_input(const cli_outputs *outputs, const cli_scene *scene);

#endif
