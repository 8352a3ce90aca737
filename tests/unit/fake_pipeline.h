/* SPDX-License-Identifier: MIT
 *
 * Stands in for frame.c and pipeline.c where the progressive part is tested by itself: a sample is
 * a hash of (seed, pixel, index), at no cost, and units can be held back.
 */
#ifndef FAKE_PIPELINE_H
#define FAKE_PIPELINE_H

#include "core/pipeline.h"

/** The sample that the fake "renders"; false: an invalid one (one of 64). About 0.5 with uniform
 * noise around it. */
bool fake_sample(uint32_t seed, uint32_t x, uint32_t y, uint32_t index, float out_rgb[3]);

/** What a film must hold for a picture of w x h from (x0, y0) after `samples` samples: decision 1
 * by the letter. */
void fake_mean(uint32_t seed, uint32_t x0, uint32_t y0, uint32_t w, uint32_t h, uint32_t samples,
               float *out_rgb);

/** Let units pass freely (UINT64_MAX, the beginning), or only so many more. Units without a permit
 * wait. */
void fake_permit(uint64_t units);
/** Wait until `count` units are waiting for a permit. */
void fake_await_waiting(uint32_t count);
/** Make waiting units see a new generation. */
void fake_poke(void);
/** Make the next unit run out of memory. */
void fake_fail_next(void);

/** Parameters of a w x h picture (all of it, or a crop of a larger one when x0 or y0 is not 0). */
fl_params fake_params(uint32_t seed, uint32_t x0, uint32_t y0, uint32_t w, uint32_t h);

#endif
