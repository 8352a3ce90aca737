/* SPDX-License-Identifier: MIT
 *
 * Where the noise comes from, measured for the command line: --noise-split and --light-samples
 * auto.
 */
#ifndef CLI_NOISE_H
#define CLI_NOISE_H

#include <jansson.h>

#include "core/firstlight.h"

/** Measure with the given parameters (core/noise.h); below or about a second for ordinary scenes.
 * `progress_name`: as in cli_picture_render. An interrupt ends the measurement early. False after
 * adding an error. */
bool cli_noise_measure(fl_compiled *scene, const fl_params *params, const char *progress_name,
                       fl_noise_split *out, fl_diags *diags);

/** Set params->light_samples to the measured optimum, at least 1; leaves scenes without disk lights
 * alone. False after adding an error. */
bool cli_noise_choose_light_samples(fl_compiled *scene, fl_params *params, fl_diags *diags);

/** The object behind the key "noise"; never NULL but for want of memory. */
json_t *cli_noise_json(const fl_noise_split *split);

/** Some lines on standard output, each beginning with `indent`. */
void cli_noise_print(const fl_noise_split *split, const char *indent);

#endif
