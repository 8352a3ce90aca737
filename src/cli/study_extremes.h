/* SPDX-License-Identifier: MIT
 *
 * `firstlight study --extremes`: a table of pass and fail with the measured error of every row.
 */
#ifndef CLI_STUDY_EXTREMES_H
#define CLI_STUDY_EXTREMES_H

#include "cli/options.h"

/** Run the rows, print the table (or, with --json, one line) and return the exit code: 1 if a row
 * fails. */
int study_extremes(const cli_options *options);

#endif
