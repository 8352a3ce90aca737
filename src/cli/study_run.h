/* SPDX-License-Identifier: MIT
 *
 * The measuring part of a study. Order: references, one warm-up round, references again until they
 * are good enough, then rounds of all configurations in turn (A B C A B C), so that whatever else
 * the machine does falls on all alike. A round has one seed for all configurations; rounds and
 * references have different ones. Without a budget the result, times aside, is a function of scene
 * and settings alone.
 */
#ifndef CLI_STUDY_RUN_H
#define CLI_STUDY_RUN_H

#include "cli/study_config.h"
#include "cli/study_figures.h"
#include "cli/study_flip.h"

enum { STUDY_LEVELS_MAX = 17, STUDY_REPEATS_MAX = 64 };

enum { STUDY_REFERENCE_FACTOR = 128 };

typedef struct study_settings {
    uint32_t samples_max; /**< A power of two, at most 2^(STUDY_LEVELS_MAX - 1). */
    uint32_t repeats;     /**< Rounds after the warm-up; at most STUDY_REPEATS_MAX. */
    uint32_t threads;     /**< 0: one per CPU. */
    /** References have at most this many times samples_max; 0: STUDY_REFERENCE_FACTOR. */
    uint32_t reference_factor;
    bool skips_warm_up; /**< Times are then not to be trusted, and references go to the limit. */
    double budget_s;    /**< Wall time; 0: no limit. */
    bool shows_progress;
    bool (*should_stop)(void); /**< Asked often; what is measured by then is kept. */
} study_settings;

/** One picture: configuration, round, 2^level samples. */
typedef struct study_measure {
    bool is_there;
    double cpu_s, wall_s;
    fl_counts counts;
    fl_error_estimate predicted;
    study_error noise; /**< Against the baseline converged; not for biased configurations. */
    study_error error; /**< Against the deep truth. */
    double flip;       /**< Mean FLIP as shown, against the deep truth. */
    double load;       /**< Load average of the machine, a minute's; below 0: not known. */
} study_measure;

/** A pair of independent converged pictures, by samplers of different make. */
typedef struct study_reference {
    fl_render *renders[2];
    float *rgb[2];
    uint32_t samples;
    double rmse; /**< Of the mean of the two, by their difference. */
    double best; /**< Least RMSE among the measured pictures, as seen in the warm-up. */
    uint64_t dropped_branches;
} study_reference;

/** What is being done, for the progress bar: in any unit of work. */
typedef struct study_stage {
    double begin_s, done, total;
    double part; /**< What the render under way adds. */
    char what[96];
} study_stage;

/** Pictures of one setting and different seeds, added up. */
typedef struct study_sum {
    float *rgb; /**< Full size; NULL: none. */
    uint32_t count;
    double mse;    /**< Sum of study_product_mse. */
    double square; /**< Sum of mean squares. */
} study_sum;

typedef struct study {
    cli_scene *scene; /**< Borrowed. */
    study_settings settings;
    study_plan plan;
    uint32_t width, height, levels;
    study_reference own, deep; /**< deep is empty where it would be the same as own. */
    bool has_deep;
    double truncation_rmse; /**< Between own and deep: what the baseline's bounces leave out. */
    study_measure *measures;
    uint32_t rounds;                       /**< Complete ones. */
    study_sum pictures[STUDY_CONFIGS_MAX]; /**< Last pictures of the curves. */
    /** The same minus the baseline's of the round, of biased configurations: the noise that both
     * have in common is gone. mse: against deep minus own. */
    study_sum differences[STUDY_CONFIGS_MAX];
    /** The baseline's of this round, of the levels at which a biased configuration ends; else NULL.
     */
    float *base_pictures[STUDY_LEVELS_MAX];
    float *shift[2]; /**< Deep minus own reference: what the baseline lacks. */
    bool was_interrupted, ran_out_of_budget;
    double begin_s, seconds;
    double load;      /**< Load average when the study began; below 0: not known. */
    study_flip *flip; /**< Holds pictures against the mean of the truth. */
    study_stage stage;
    float *scratch[3]; /**< Each one picture of the full size. */
    fl_render *render;
} study;

/** Measure. Zero-initialise `out`; close it in any case. Borrows `scene`. `knobs`: a bit per
 * study_knob. False after adding an error to the scene's diagnostics. */
bool study_run(cli_scene *scene, const study_settings *settings, uint32_t knobs, study *out);
void study_close(study *s);

/** Level is log2 of the samples. May not be there. */
const study_measure *study_at(const study *s, uint32_t config, uint32_t round, uint32_t level);

/** Levels that a configuration passes through. */
uint32_t study_levels_of(const study_config *config);

/** Whether the references' own error is a tenth of the best measured, or less. */
bool study_reference_is_good(const study_reference *r);

/** The load average of the last minute; below 0: not known. */
double study_load_average(void);

static inline const study_reference *study_truth(const study *s)
{
    return s->has_deep ? &s->deep : &s->own;
}

static inline uint64_t study_rays(const fl_counts *counts)
{
    return counts->camera_rays + counts->shadow_rays + counts->reflect_rays + counts->refract_rays;
}

#endif
