/* SPDX-License-Identifier: MIT
 *
 * What a study compares: the scene as asked for (the baseline) and one knob at a time moved away
 * from it. The number of samples is no configuration: every run passes through all powers of two.
 */
#ifndef CLI_STUDY_CONFIG_H
#define CLI_STUDY_CONFIG_H

#include "cli/load.h"

typedef enum study_knob {
    STUDY_BASELINE,
    STUDY_SAMPLER,
    STUDY_LIGHT_SAMPLES,
    STUDY_DEPTH,
    STUDY_WEIGHT,
    STUDY_SCALE,
    STUDY_ACCEL,
    STUDY_SOLVER,
    STUDY_ADAPTIVE,
    STUDY_PRECISION,
    STUDY_KNOB_COUNT
} study_knob;

/** In the order of study_knob. */
extern const char *const study_knob_names[STUDY_KNOB_COUNT];

enum { STUDY_CONFIGS_MAX = 48, STUDY_NAME_BYTES = 40 };

typedef struct study_config {
    study_knob knob;
    char name[STUDY_NAME_BYTES]; /**< "baseline", "depth=2", ... */
    fl_params params;            /**< Borrows the scene's lights. */
    fl_compiled *compiled;       /**< A reference. */
    double scale;                /**< Of the resolution; the picture is enlarged to compare. */
    uint32_t samples_max;        /**< The curve ends here; a power of two. */
    bool is_biased;              /**< Converges to another picture than the baseline. */
} study_config;

typedef struct study_plan {
    study_config configs[STUDY_CONFIGS_MAX]; /**< The first is the baseline. */
    uint32_t count;
} study_plan;

/** Knobs by name, separated by commas; *out_knobs gets a bit per study_knob. False: an unknown
 * word, which is copied to `word`. */
bool study_knobs_parse(const char *text, uint32_t *out_knobs, char word[STUDY_NAME_BYTES]);

/** All configurations of `knobs` that mean something in this scene. Zero-initialise. False after
 * adding an error; close it in any case. */
bool study_plan_build(const cli_scene *scene, uint32_t knobs, uint32_t samples_max,
                      uint32_t threads, study_plan *out_plan);
void study_plan_close(study_plan *plan);

/** The baseline's own value of a knob, as a name: "depth=5". */
void study_own_name(const study_plan *plan, study_knob knob, char *out, size_t bytes);

/** Whether depth and weight threshold can decide anything in this scene. */
bool study_has_branches(const fl_compiled *compiled);

/** The settings of the deep truth: bounces and threshold where more changes nothing that shows. */
enum { STUDY_DEEP_BOUNCES = 16 };
#define STUDY_DEEP_THRESHOLD 0x1p-16
fl_params study_deep_params(const fl_params *params);

#endif
