/* SPDX-License-Identifier: MIT
 *
 * How different two pictures look when one is put in the other's place: LDR-FLIP, the mean over the
 * pixels [Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020, "FLIP: a
 * difference evaluator for alternating images"], at 67 pixels a degree: a 0.7 m wide screen of 3840
 * pixels seen from 0.7 m. 0: they look the same; 1: as different as can be.
 */
#ifndef CLI_STUDY_FLIP_H
#define CLI_STUDY_FLIP_H

#include "core/firstlight.h"

/** A reference that pictures are held against, with working memory. */
typedef struct study_flip study_flip;

/** `reference`: linear RGB, 3 * width * height; shown as 2^exposure_ev times that, clamped to
 * [0, 1], sRGB primaries. Copies what it needs. NULL: out of memory. */
study_flip *study_flip_create(const float *reference, uint32_t width, uint32_t height,
                              double exposure_ev);
void study_flip_destroy(study_flip *flip);

/** Mean FLIP of a picture of the same size, in [0, 1]. O(pixels), some 250 multiplications each. */
double study_flip_mean(study_flip *flip, const float *picture);

#endif
