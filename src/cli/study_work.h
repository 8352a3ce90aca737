/* SPDX-License-Identifier: MIT
 *
 * Private to study_run.c and study_reference.c: rendering that can be stopped, with a word on how
 * far it is.
 */
#ifndef CLI_STUDY_WORK_H
#define CLI_STUDY_WORK_H

#include "cli/study_run.h"

typedef enum study_outcome { STUDY_REACHED, STUDY_STOPPED, STUDY_FAILED } study_outcome;

/** Of the budget: all of it, and the most that references take. */
#define STUDY_WHOLE_BUDGET    1.0
#define STUDY_REFERENCE_SHARE 0.5

/** Go on to `samples` samples; *out_progress is what was reached. STOPPED: interrupted, or more
 * than `share` of the budget is gone. */
study_outcome study_render_to(study *s, fl_render *render, uint32_t samples, double share,
                              fl_progress *out_progress);

/** Begin a stage of `total` units of work, of any unit, for the progress bar. */
void study_stage_begin(study *s, double total);
/** `done` units are done, and `part` more of those that study_render_to is at. */
void study_stage_set(study *s, const char *what, double done, double part);

/** References, and their difference. True: two pairs stand ready, with one sample. */
bool study_references_open(study *s);
void study_references_close(study *s);
/** To `samples` samples each. STOPPED leaves the pictures as they were. */
study_outcome study_references_grow(study *s, uint32_t samples, double share);
/** Double until they are good enough, the limit is reached, or their share of the budget is gone.
 * False: an error. */
bool study_references_finish(study *s);
/** The first samples, before anything else is known. */
uint32_t study_references_first(const study *s);
/** What lies between the truths, once they are as good as they get. False: an error. */
bool study_references_compare(study *s);

#endif
