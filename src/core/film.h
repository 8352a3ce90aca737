/* SPDX-License-Identifier: MIT
 *
 * Layer 7: the film: per-pixel sums of one generation. Not locked: the render guards it.
 */
#ifndef FL_FILM_H
#define FL_FILM_H

#include "core/pack.h"
#include "core/pipeline.h"
#include "core/schedule.h"

/** Sums of a w x h picture. A pixel's sum is the double sum, in order, of blocks of 16 consecutive
 * samples, each summed from 0 in index order (decision 1). */
typedef struct fl_film fl_film;

/** Bytes a film of that size needs; false when that overflows. */
bool fl_film_bytes(uint32_t width, uint32_t height, size_t *out_bytes);
/** An empty film, at least 1 x 1; NULL: out of memory or overflow. Touches little memory:
 * O(height). */
fl_film *fl_film_create(uint32_t width, uint32_t height);
void fl_film_destroy(fl_film *film);
/** Forget all samples. O(1): each row is wiped when it is next written. */
void fl_film_clear(fl_film *film);
uint32_t fl_film_width(const fl_film *film);
uint32_t fl_film_height(const fl_film *film);

/** Add one sample of each of the unit's pixels; film coordinates are the unit's minus (x0, y0).
 * Every pixel must get its samples in index order 0, 1, 2 ...: asserted. Invalid samples advance
 * the index but neither sum nor count. */
void fl_film_add(fl_film *film, const fl_unit *unit, const fl_unit_result *result, uint32_t x0,
                 uint32_t y0);

/** Mean of `count` pixels of row `y` from `x` on, linear RGB floats. Pixels without a valid sample
 * are 0. */
void fl_film_row(const fl_film *film, uint32_t x, uint32_t y, uint32_t count, float *out_rgb);

/** How many samples `count` pixels of row `y` from `x` on have. */
void fl_film_samples_row(const fl_film *film, uint32_t x, uint32_t y, uint32_t count,
                         uint32_t *out_samples);

/** How many of them are valid and so are in the sums. */
void fl_film_valid_row(const fl_film *film, uint32_t x, uint32_t y, uint32_t count,
                       uint32_t *out_valid);

/** Mean of the whole film, top row first, 3 * width * height floats. */
void fl_film_mean(const fl_film *film, float *out_rgb);

/** For display while sample 0 is incomplete: means of those pixels of rows [row_begin, row_end)
 * that have a sample, one after the other; returns how many. Sets the alpha of every pixel of the
 * rows in out_rgba: 255 for these, else 0. */
uint32_t fl_film_rows_covered(const fl_film *film, uint32_t row_begin, uint32_t row_end,
                              float *out_rgb, uint8_t *out_rgba);

/** Fill the pixels of alpha 0 in `rows` rows, the first of which is a multiple of 8 of the picture:
 * with the nearest corner pixel of their 2x2, else 4x4, else 8x8 cell that has another alpha;
 * corners have the lower Bayer ranks (decision 16). Without one: opaque black. Never for saved
 * pictures. */
void fl_film_fill_holes(uint8_t *rgba, uint32_t width, uint32_t rows);

/** Samples every pixel has (the minimum over pixels), and the number of pixels with at least one.
 * O(pixels). */
uint32_t fl_film_complete_samples(const fl_film *film);
uint64_t fl_film_covered_pixels(const fl_film *film);

/** Sums, when every pixel has a sample. Reading replaces them and needs the sample counts, which
 * are not in the pack, from fl_film_set_samples first. O(pixels). */
void fl_film_pack(fl_film *film, fl_pack *pack);
void fl_film_set_samples(fl_film *film, const fl_rect *rect, uint32_t samples);

#endif
