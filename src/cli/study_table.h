/* SPDX-License-Identifier: MIT
 *
 * What the measurements of a study say together: figures over the rounds, comparisons with the
 * baseline, floors, the Pareto front.
 */
#ifndef CLI_STUDY_TABLE_H
#define CLI_STUDY_TABLE_H

#include "cli/study_run.h"

/** One configuration at 2^level samples, over the rounds it was measured in. */
typedef struct study_cell {
    uint32_t rounds; /**< 0: not measured; all else is then 0. */
    uint32_t samples;
    fl_counts counts; /**< Of the first round. */
    study_spread cpu_s, wall_s, bias, largest, p999, flip;
    double bias_se; /**< With what the references do not know. */
    study_root noise, error, relative;
    double predicted;       /**< Mean of the predicted RMSE; 0: not known. */
    double predicted_ratio; /**< predicted over noise; 0: not known. */
    /** To the baseline at the same number of samples, paired by rounds. The error is that against
     * the baseline's own limit, for biased configurations that against the deep truth. */
    study_ratio cpu_ratio, rmse_ratio, work_ratio; /**< work: mean squared error times CPU time. */
} study_cell;

typedef struct study_column {
    study_cell cells[STUDY_LEVELS_MAX];
    study_fit fit; /**< Biased: of `error`, with a floor; else of `noise`, without. */
    double floor;  /**< Of biased ones and the baseline: by pairs of rounds; NaN: not known. */
    double
        apart; /**< Biased: RMSE between its limit and the baseline's, by pairs of rounds; NaN. */
    double slope; /**< Of `noise` (biased: `error`), from 16 samples (else from 1) on; NaN. */
} study_column;

typedef struct study_place {
    uint32_t config, level;
} study_place;

typedef struct study_table {
    study_column columns[STUDY_CONFIGS_MAX];
    study_place front[STUDY_CONFIGS_MAX * STUDY_LEVELS_MAX]; /**< By rising CPU time. */
    uint32_t front_count;
} study_table;

/** NULL: out of memory. From malloc. */
study_table *study_table_create(const study *s);

enum { STUDY_SENTENCE_BYTES = 480 };

/** The cheapest place whose error against the deep truth, with twice its standard error, is at most
 * `rmse`; the scene as asked for where that is as good and not significantly dearer. False: none.
 */
bool study_cheapest(const study_table *table, double rmse, study_place *out_place);

static inline const study_cell *study_cell_at(const study_table *table, study_place place)
{
    return &table->columns[place.config].cells[place.level];
}

/** The scene as asked for: the baseline at the most samples that were measured. */
const study_cell *study_now(const study *s, const study_table *table);

/** "scale=1/2, 16 samples". */
void study_place_name(const study *s, study_place place, char *out, size_t bytes);

/** One sentence: the cheapest setting with an error of at most `rmse`, or that there is none. */
void study_sentence(const study *s, const study_table *table, double rmse, char *out, size_t bytes);

/** One sentence: the scene as asked for, and what is as good for less. */
void study_summary(const study *s, const study_table *table, char *out, size_t bytes);

/** Errors to give a sentence for: `wanted`, or (0) round numbers that were reached. */
uint32_t study_targets(const study_table *table, double wanted, double out_targets[8]);

#endif
