/* SPDX-License-Identifier: MIT
 *
 * What a study leaves behind, all in one folder: study.csv (one row per picture), study.json (the
 * table), *.gp and *.svg (plots), *.png (thumbnails), index.html.
 */
#ifndef CLI_STUDY_WRITE_H
#define CLI_STUDY_WRITE_H

#include <jansson.h>
#include <stdio.h>

#include "cli/study_table.h"

/** The commit this program was built from, "-dirty" with changes; "unknown" without git. */
extern const char cli_commit[];

/** Write text that `fill` prints to DIR/NAME, all or nothing. False after adding an error. */
bool study_save_text(const char *dir, const char *name,
                     void (*fill)(FILE *file, const void *context), const void *context,
                     fl_diags *diags);

/** What all writers need. */
typedef struct study_report {
    const study *s;
    const study_table *table;
    const char *dir;
    const char *command; /**< As typed. */
    double wanted_rmse;  /**< 0: round numbers. */
    bool has_plots;      /**< Set by study_write_plots: gnuplot made the SVGs. */
} study_report;

/** All of it, into a folder that is there. False after adding errors; what could be written is
 * there. */
bool study_write(study_report *report, fl_diags *diags);

/** The table as JSON; NULL: out of memory. The caller's. */
json_t *study_json(const study_report *report);

bool study_write_plots(study_report *report, fl_diags *diags);
bool study_write_page(const study_report *report, fl_diags *diags);

#endif
