/* SPDX-License-Identifier: MIT
 *
 * Layer 7: more samples where the noise is. Pure bookkeeping beside the schedule, which gives every
 * pixel FL_ALLOCATION_BLOCK samples first; then rounds begin, each of which at most doubles the
 * mean number of samples. Between rounds all samples are in the film, and from the film alone it is
 * decided how many blocks of FL_ALLOCATION_BLOCK samples each pixel gets next: so the same film for
 * any number of threads, and sums keep their blocks (decision 1).
 *
 * With V_p the variance of a pixel's samples, the mean over its 3 x 3 neighbourhood, the error of
 * the picture is least for n_p proportional to sqrt(V_p). Pixels that have more already keep it,
 * the others share what is left (water filling); parts of a block are rounded up or down by a hash.
 * The neighbourhood matters: a pixel by itself that has missed an edge looks finished
 * (docs/sampling.md).
 *
 * The spread of single samples is not what stratified ones leave as error. So both ways to give a
 * round out, by spread and evenly, are judged beforehand by the squared differences that the
 * estimate has seen at each pixel, which fall like n^-2p; where spread promises less than 5 %, or p
 * is above 1.2, the round is given out evenly: scenes where spread misleads then lose nothing.
 */
#ifndef FL_ALLOCATION_H
#define FL_ALLOCATION_H

#include "core/estimate.h"

enum { FL_ALLOCATION_BLOCK = 16 };

typedef struct fl_allocation fl_allocation;

bool fl_allocation_bytes(uint32_t width, uint32_t height, size_t *out_bytes);
/** NULL: out of memory. */
fl_allocation *fl_allocation_create(uint32_t width, uint32_t height);
void fl_allocation_destroy(fl_allocation *allocation);
/** Begin again; `seed` decides how parts of blocks are rounded. O(1). */
void fl_allocation_reset(fl_allocation *allocation, uint32_t seed);

/** The mean number of samples a pixel to go for. May change at any time; no more than what there is
 * means: nothing to do. */
void fl_allocation_set_goal(fl_allocation *allocation, uint32_t samples);

/** Samples that have been committed to the film, whoever asked for them; coordinates as
 * fl_film_add. Every sample from number 0 on must be told. */
void fl_allocation_add(fl_allocation *allocation, const fl_unit *unit, const fl_unit_result *result,
                       uint32_t x0, uint32_t y0);

/** Whether there is something to do once every pixel has FL_ALLOCATION_BLOCK samples. */
bool fl_allocation_has_work(const fl_allocation *allocation);

/** Whether fl_allocation_next would find one, or at least has to look. */
bool fl_allocation_has_units(const fl_allocation *allocation);

/** Take the next unit of a round: its pixels, absolute as fl_work_pixels gives them, all of sample
 * *out_sample. Arrays of FL_UNIT_PIXELS. Returns how many; 0: none now. */
uint32_t fl_allocation_next(fl_allocation *allocation, const fl_film *film, uint32_t x0,
                            uint32_t y0, uint16_t *out_x, uint16_t *out_y, uint32_t *out_sample,
                            uint32_t *out_tile);
/** A unit's samples are in the film. */
void fl_allocation_commit(fl_allocation *allocation, uint32_t tile, uint32_t pixel_count);

/** Whether a step of planning is due: no unit is out or waiting. */
bool fl_allocation_must_plan(const fl_allocation *allocation);
/** Do one step, a few rows of the picture. Captures the error (fl_estimate_capture_round) at the
 * end of a round. */
void fl_allocation_plan(fl_allocation *allocation, const fl_film *film, fl_estimate *estimate);

/** The goal of the last round that has begun, rounded up: a goal of so many leaves that round as it
 * is and begins no other. 0: none has. */
uint32_t fl_allocation_begun_samples(const fl_allocation *allocation);

/** Samples committed in rounds, all pixels together: what the schedule does not count. */
uint64_t fl_allocation_samples(const fl_allocation *allocation);

#endif
