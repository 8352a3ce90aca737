/* SPDX-License-Identifier: MIT
 *
 * Layer 7: how far the picture still is from the converged one, predicted from the picture alone.
 *
 * Snapshot rule: at n = 2^k samples, V = mean over pixels and channels of (mean after n - mean
 * after n/2)^2 and RMSE = sqrt(V) 2^(0.5 - p), where the error falls like n^-p: p = 0.6, or
 * measured from V(n/4) and V(n) and clamped to [0.5, 1.5], from independent samples to scrambled
 * nets of something smooth (decision 056). Between powers of two e(n) = e(2^k) (2^k / n)^min(p,
 * 0.75). The interval is two standard errors by the spread of V over squares of 16 x 16 pixels, at
 * least 20 % (the uncertainty of p). Low index bits make no usable classes for low-discrepancy
 * points, contiguous halves do: measured in docs/accuracy.md.
 *
 * The same numbers for any number of threads: a tile is captured when it has exactly 2^k samples,
 * and sums run in a fixed order.
 */
#ifndef FL_ESTIMATE_H
#define FL_ESTIMATE_H

#include "core/film.h"
#include "core/schedule.h"

/** Errors are those of squares of so many pixels a side, the first at the film's corner. */
enum { FL_SQUARE_SIDE = 16 };

/** Predicted error of the current mean. Linear radiance units. */
typedef struct fl_error_estimate {
    bool is_known; /**< False below 4 samples; all else is then 0. */
    double rmse, low, high;
    double samples;  /**< The sample count it holds for. */
    double exponent; /**< p, the error's rate of falling. */
} fl_error_estimate;

/** Samples a pixel needs to reach a target. */
typedef struct fl_error_forecast {
    double samples;   /**< With the estimate's own p. */
    double low, high; /**< With the rates of fl_error_bracket. */
} fl_error_forecast;

/** Between which rates an error that falls like n^-p now may go on falling: from 0.5 to 0.7, and to
 * 0.1 beyond p. */
void fl_error_bracket(double p, double *out_slow, double *out_fast);

/** Predict when the error will be `target_rmse` > 0: times seconds per sample, when in time. False:
 * the error is not known yet. Already reached: the present number. */
bool fl_error_predict(const fl_error_estimate *error, double target_rmse,
                      fl_error_forecast *out_forecast);

typedef struct fl_estimate fl_estimate;

/** is_adaptive: fl_estimate_capture_round will be used; needs more memory. */
bool fl_estimate_bytes(uint32_t width, uint32_t height, bool is_adaptive, size_t *out_bytes);
/** NULL: out of memory. */
fl_estimate *fl_estimate_create(uint32_t width, uint32_t height, bool is_adaptive);
void fl_estimate_destroy(fl_estimate *estimate);
void fl_estimate_reset(fl_estimate *estimate);

/** All pixels of `rect` (corners at multiples of 16 or the film's edge) have exactly `samples`.
 * Does nothing unless that is a power of two; each power in turn, each pixel once. */
void fl_estimate_capture(fl_estimate *estimate, const fl_film *film, const fl_rect *rect,
                         uint32_t samples);

/** The end of a round of adaptive sampling, part by part: all pixels of `rect` (as above) have what
 * the round gave them, `mean_samples` in the mean over the picture. Where a pixel went from n1 to
 * n2 samples, its squared error is (mean after n2 - mean after n1)^2 over (1 - 1/r)^2 (r^2p + (r /
 * (r - 1))^2p), r = n2 / n1: the snapshot rule for any ratio, which two independent parts with
 * errors of n^-p give. A pixel without new samples keeps its figure. */
void fl_estimate_capture_round(fl_estimate *estimate, const fl_film *film, const fl_rect *rect,
                               double mean_samples);

/** Of adaptive sampling: the squared difference of the last capture at a pixel, as if it had
 * doubled its samples; mean of the channels. */
double fl_estimate_pixel_square(const fl_estimate *estimate, uint32_t x, uint32_t y);

/** The estimate when every pixel has at least `samples` samples; after a round: that many in the
 * mean. */
void fl_estimate_read(const fl_estimate *estimate, uint32_t samples, fl_error_estimate *out_error);

/** The error of the square of 16 x 16 pixels around (x, y) as far as it is known when every pixel
 * has at least `samples`: rmse of that square alone, noisier than the whole. Below 4 samples 0. */
double fl_estimate_square_rmse(const fl_estimate *estimate, uint32_t x, uint32_t y,
                               uint32_t samples);

/** Let the render go on to this many samples, then ask again: the least n up to the next power of
 * two whose error is within target_rmse, else that power; n <= samples means the target is reached.
 */
uint32_t fl_estimate_next_stop(const fl_estimate *estimate, uint32_t samples, double target_rmse);

/** Snapshots and sums; reading takes an estimate that was just reset, of a film whose tiles stand
 * as in `schedule`. O(pixels). */
void fl_estimate_pack(fl_estimate *estimate, const fl_schedule *schedule, fl_pack *pack);

#endif
