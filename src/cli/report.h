/* SPDX-License-Identifier: MIT
 *
 * The page that `check --report DIR` writes: golden, new and difference side by side, with numbers.
 */
#ifndef CLI_REPORT_H
#define CLI_REPORT_H

#include "core/firstlight.h"

/** How a scene did. */
typedef struct cli_check_result {
    const char *path;      /**< Of the scene; borrowed. */
    bool passed, has_golden; /**< Whether there is a golden picture of the same size. */
    const char *why;       /**< A phrase for people; static. */
    char sha256_golden[72], sha256_new[72];
    uint32_t largest_difference; /**< Of 8-bit values, against the golden picture. */
    double differing_share;      /**< Of pixels. */
} cli_check_result;

typedef struct cli_report cli_report;

/** Begin a page in folder `dir`, which is made if needed. NULL after adding an error. */
cli_report *cli_report_open(const char *dir, fl_diags *diags);

/** Add a scene; pictures are 3 * width * height bytes, golden may be NULL. False after adding an error. */
bool cli_report_add(cli_report *report, const cli_check_result *result, uint32_t width, uint32_t height,
                    const uint8_t *golden, const uint8_t *fresh, fl_diags *diags);

/** Write DIR/index.html and free the report; NULL is allowed. False after adding an error. */
bool cli_report_close(cli_report *report, fl_diags *diags);

#endif
