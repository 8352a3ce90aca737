/* SPDX-License-Identifier: MIT
 *
 * Measurements about the picture, by one thread of its own and one render of low priority, so that
 * neither the window nor the picture waits for them. The newest question wins; an older one that is
 * not answered yet is dropped.
 */
#ifndef VW_LAB_H
#define VW_LAB_H

#include "viewer/state.h"
#include "viewer/viewer.h"

typedef enum vw_lab_kind {
    VW_LAB_NOTHING,
    VW_LAB_NOISE,  /**< Where the noise comes from. */
    VW_LAB_TRIALS, /**< What other settings would cost and buy. */
    VW_LAB_STRESS  /**< What changes in the picture when nothing, or one number, should. */
} vw_lab_kind;

enum { VW_TRIALS_MAX = 8, VW_TRIAL_NAME = 32 };

/** A setting as measured. */
typedef struct vw_trial {
    char name[VW_TRIAL_NAME];
    double rays;        /**< A sample, of all kinds: exact. */
    double cpu_seconds; /**< A sample: the smaller of two measurements. */
    double rmse;        /**< Of `samples` samples, by two seeds: no prediction. */
    double change;      /**< Root mean square of its mean picture less that of the first trial. */
} vw_trial;

/** Zero-initialise. Which members count depends on the kind. */
typedef struct vw_lab_question {
    vw_lab_kind kind;
    uint32_t samples;
    /** Noise: the picture. Trials: the present setting first. Stress: the picture, and what it is
     * held against unless `scale` says it. vw_lab_ask takes a reference of each. */
    fl_frame *frames[VW_TRIALS_MAX];
    char names[VW_TRIALS_MAX][VW_TRIAL_NAME];
    uint32_t frame_count;
    /** Stress by scaling the scene: read it again from `path`, by this factor; 0: not so. */
    double scale;
    const vw_loader *loader;
    char path[VW_PATH_MAX];
    vw_state state;
    fl_params base;
    char error[128]; /**< Stress: why there is nothing to hold the picture against; empty: there is.
                      */
} vw_lab_question;

/** Zero-initialise; free with vw_lab_answer_deinit. */
typedef struct vw_lab_answer {
    vw_lab_kind kind;
    uint64_t wish;
    uint32_t samples;
    vw_trial trials[VW_TRIALS_MAX];
    uint32_t trial_count;
    fl_noise_split noise; /**< Its `rounds` grow while it is sharpened. */
    float *changes; /**< Stress: largest difference of a pixel's channels, sign dropped; infinite
                       where one of the two is not a number. Owned. */
    uint32_t width, height;
    char error[128]; /**< Why there is no answer; empty: there is. */
} vw_lab_answer;

void vw_lab_answer_deinit(vw_lab_answer *answer);

typedef struct vw_lab vw_lab;

/** Starts the thread, asleep. `notify`: called by it when there is an answer; may be NULL. NULL
 * after adding an error. */
vw_lab *vw_lab_create(void (*notify)(void *context), void *context, fl_diags *diags);
/** Stops and joins; NULL is allowed. */
void vw_lab_destroy(vw_lab *lab);

/** Ask; VW_LAB_NOTHING: only drop what was asked. Returns the question's number, from 1. Never
 * waits. */
uint64_t vw_lab_ask(vw_lab *lab, const vw_lab_question *question);

/** Take the newest answer, if there is one that was not taken: *out is then replaced. */
bool vw_lab_take(vw_lab *lab, vw_lab_answer *out);

/** Block until the latest question is answered or given up. */
void vw_lab_wait(vw_lab *lab);

#endif
