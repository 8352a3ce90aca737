/* SPDX-License-Identifier: MIT
 *
 * Layer 8, private to noise*.c: what is measured.
 */
#ifndef FL_NOISE_STATE_H
#define FL_NOISE_STATE_H

#include "core/noise.h"
#include "core/pipeline.h"

/** Configurations: 0 as it is; 1 + 2 s and 2 + 2 s: source s alone, source s held. */
enum { FL_NOISE_CONFIGS_MAX = 1 + 2 * FL_NOISE_SOURCES_MAX };

/** More light samples than usual, to see what one costs. */
enum { FL_NOISE_EXTRA_LIGHT_SAMPLES = 2, FL_NOISE_COST_SAMPLES = 4 };

/** Over the pixels of all complete rounds; v: a pixel's part of the variance, v0 that of
 * configuration 0. */
typedef struct fl_noise_sums {
    double v, v_v, v_v0;
} fl_noise_sums;

struct fl_noise {
    fl_frame *frame; /**< Its own: `frozen` and the lights' samples change between pieces. */
    fl_workspace *workspace;
    fl_noise_source sources[FL_NOISE_SOURCES_MAX];
    uint32_t source_count, config_count, samples;
    uint32_t disk_lights, light_samples; /**< Of all disk lights together. */

    uint32_t round, config, sample; /**< Where we are; config config_count: the cost of lights. */
    uint64_t steps;
    uint32_t pixel_count;
    uint16_t x[FL_NOISE_PIXELS], y[FL_NOISE_PIXELS];
    double halves[2][FL_NOISE_PIXELS][3]; /**< Sums of the first and the second half. */
    double *round_values; /**< v by configuration and pixel, FL_NOISE_PIXELS each. */

    fl_noise_sums sums[FL_NOISE_CONFIGS_MAX];
    uint64_t pixels; /**< Of complete rounds. */
    /** Of the first FL_NOISE_COST_SAMPLES samples, as it is and with more light samples. */
    double cost_seconds[2];
    uint64_t cost_shadows[2], cost_paths[2];
};

#endif
