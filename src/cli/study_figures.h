/* SPDX-License-Identifier: MIT
 *
 * The figures of a study: how far a picture is from the truth, and what repeated measurements say.
 * Pure functions; pictures are linear RGB floats, 3 * pixels, rows from the top.
 *
 * The truth is known through two independent references R1, R2, each right on average. The product
 * (x - R1)(x - R2) averages to the squared error of x alone, because the errors of R1 and R2 are
 * independent of each other and of x: noise of the references adds variance, no offset.
 */
#ifndef CLI_STUDY_FIGURES_H
#define CLI_STUDY_FIGURES_H

#include "core/firstlight.h"

/** Error of one picture. The products may be negative where the error is below what the references
 * resolve. */
typedef struct study_error {
    double mse;          /**< Mean over pixels and channels of (x - R1)(x - R2). */
    double relative_mse; /**< The same over R^2 + 0.01, R the mean of the references. */
    double bias;         /**< Mean of x - R. */
    double largest;      /**< |x - R|, largest over pixels and channels. */
    double p999;         /**< |x - R|: 99.9 % of the values are at most this. */
} study_error;

/** scratch: 3 * pixels floats. O(pixels log pixels). */
void study_error_measure(const float *picture, const float *reference1, const float *reference2,
                         size_t pixels, float *scratch, study_error *out_error);

/** Mean squared error of the mean of two references: mean of (R1 - R2)^2, over 4. */
double study_reference_mse(const float *reference1, const float *reference2, size_t pixels);

/** Bilinear enlargement (or reduction) with pixel centres at half integers, edges held. */
void study_resize(const float *from, uint32_t from_width, uint32_t from_height, float *out,
                  uint32_t width, uint32_t height);

/** What repeated measurements of one thing say. */
typedef struct study_spread {
    uint32_t count;
    double mean, standard_error; /**< 0 with fewer than two values. */
    double median, lowest, quartile1, quartile3;
} study_spread;

/** Sorts `values`. */
study_spread study_spread_of(double *values, uint32_t count);

/** Root of a mean square that was measured repeatedly, with its standard error. */
typedef struct study_root {
    double value, standard_error;
} study_root;
study_root study_root_of(const study_spread *mean_square);

/** A ratio from paired measurements: geometric mean and its 95 % interval (Student's t). */
typedef struct study_ratio {
    bool is_known; /**< All values were above 0 and there was at least one pair. */
    bool has_interval, is_significant; /**< Needs two pairs; the interval excludes 1. */
    double value, low, high;
} study_ratio;
study_ratio study_ratio_of(const double *values, const double *base, uint32_t count);

/** 97.5 % quantile of Student's t distribution. */
double study_t_quantile(uint32_t degrees_of_freedom);

/** RMSE(n)^2 = floor^2 + (scale n^-rate)^2: the error that no number of samples removes. */
typedef struct study_fit {
    bool is_known; /**< From four points on. */
    double floor, scale, rate;
} study_fit;

/** Least squares of relative deviations without a floor; rate in [0.3, 1] by steps of 0.005. */
study_fit study_fit_rate(const double *samples, const double *mse, uint32_t count);

/** The same with a floor, at a known rate: a short curve cannot tell a floor from a change of rate,
 * so the rate is that of a setting without a floor. */
study_fit study_fit_floor(const double *samples, const double *mse, uint32_t count, double rate);

/** Mean of (x - R1)(x - R2). */
double study_product_mse(const float *picture, const float *reference1, const float *reference2,
                         size_t pixels);

/** Squared floor without a model: two pictures a, b of one setting with different seeds have the
 * floor in common and nothing else, so (a - R1)(b - R2) averages to its square. Here over all pairs
 * of `count` >= 2 pictures, by their sum and the sum of their study_product_mse. May be negative.
 */
double study_floor_mse(const float *sum, uint32_t count, double mse_sum, const float *reference1,
                       const float *reference2, size_t pixels);

/** Slope of log2 rmse over log2 samples, least squares; NaN with fewer than two points. */
double study_slope_of(const double *samples, const double *rmse, uint32_t count);

#endif
