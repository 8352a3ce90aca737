/* SPDX-License-Identifier: MIT */
#include "core/estimate.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "core/math64.h"

enum {
    SQUARE_SIDE = 16,
    LEVELS = 32,          /* Powers of two of samples. */
    LEVEL_FIRST_KNOWN = 2 /* 4 samples. */
};

#define EXPONENT_PRIOR     0.60
#define EXPONENT_MIN       0.50
#define EXPONENT_MAX       0.75
#define EXPONENT_FAST      0.70 /* Bracket of forecasts. */
#define EXPONENT_SLOW      0.50
#define RELATIVE_ERROR_MIN 0.20

typedef struct level {
    uint64_t captured_pixels;
    double mean_square;    /* V; valid when all pixels are captured. */
    double standard_error; /* Of sqrt(V), relative. */
} level;

struct fl_estimate {
    uint32_t width, height, squares_x, squares_y;
    float *snapshot; /* Mean at the last captured power of two, rgb per pixel. */
    double *sums;    /* LEVELS times squares: sum of squared differences. */
    level levels[LEVELS];
};

static uint32_t squares_along(uint32_t side_px)
{
    return side_px / SQUARE_SIDE + (side_px % SQUARE_SIDE != 0);
}

bool fl_estimate_bytes(uint32_t width, uint32_t height, size_t *out_bytes)
{
    size_t pixels, snapshot, squares, sums;
    if (!fl_size_mul(width, height, &pixels) ||
        !fl_size_mul(pixels, 3 * sizeof(float), &snapshot) ||
        !fl_size_mul(squares_along(width), squares_along(height), &squares) ||
        !fl_size_mul(squares, LEVELS * sizeof(double), &sums) ||
        snapshot > SIZE_MAX - sums - sizeof(fl_estimate))
        return false;
    *out_bytes = sizeof(fl_estimate) + snapshot + sums;
    return true;
}

fl_estimate *fl_estimate_create(uint32_t width, uint32_t height)
{
    size_t bytes;
    fl_estimate *estimate =
        fl_estimate_bytes(width, height, &bytes) ? calloc(1, sizeof *estimate) : NULL;
    if (!estimate)
        return NULL;
    estimate->width = width;
    estimate->height = height;
    estimate->squares_x = squares_along(width);
    estimate->squares_y = squares_along(height);
    size_t squares = (size_t)estimate->squares_x * estimate->squares_y;
    estimate->snapshot = malloc((size_t)width * height * 3 * sizeof *estimate->snapshot);
    estimate->sums = malloc(squares * LEVELS * sizeof *estimate->sums);
    if (!estimate->snapshot || !estimate->sums) {
        fl_estimate_destroy(estimate);
        return NULL;
    }
    return estimate;
}

void fl_estimate_destroy(fl_estimate *estimate)
{
    if (!estimate)
        return;
    free(estimate->snapshot);
    free(estimate->sums);
    free(estimate);
}

void fl_estimate_reset(fl_estimate *estimate)
{
    for (uint32_t k = 0; k < LEVELS; k++)
        estimate->levels[k] = (level){0};
}

static uint32_t floor_log2(uint32_t x)
{
    uint32_t k = 0;
    while (x >>= 1)
        k++;
    return k;
}

/* Put the mean of a square into the snapshot; returns the sum of squared differences from what was
 * there, which at level 0 is nothing. */
static double exchange_square(fl_estimate *estimate, const fl_film *film, const fl_rect *square,
                              bool is_first)
{
    double sum = 0.0;
    uint32_t width = square->x1 - square->x0;
    for (uint32_t y = square->y0; y < square->y1; y++) {
        float mean[3 * SQUARE_SIDE];
        fl_film_row(film, square->x0, y, width, mean);
        float *old = estimate->snapshot + 3 * ((size_t)y * estimate->width + square->x0);
        for (uint32_t i = 0; i < 3 * width; i++) {
            double difference = is_first ? 0.0 : (double)mean[i] - (double)old[i];
            sum += difference * difference;
            old[i] = mean[i];
        }
    }
    return sum;
}

static fl_rect square_rect(const fl_estimate *estimate, uint32_t sx, uint32_t sy)
{
    uint32_t x = sx * SQUARE_SIDE, y = sy * SQUARE_SIDE;
    return (fl_rect){x, y, fl_min_u32(x + SQUARE_SIDE, estimate->width),
                     fl_min_u32(y + SQUARE_SIDE, estimate->height)};
}

/* All squares of level k are there: V and its spread. */
static void reduce(fl_estimate *estimate, uint32_t k)
{
    size_t count = (size_t)estimate->squares_x * estimate->squares_y;
    const double *sums = estimate->sums + k * count;
    double total = 0.0;
    for (size_t i = 0; i < count; i++)
        total += sums[i];
    double v = total / (3.0 * estimate->width * estimate->height);
    double spread = 0.0;
    for (uint32_t sy = 0; sy < estimate->squares_y; sy++)
        for (uint32_t sx = 0; sx < estimate->squares_x; sx++) {
            fl_rect r = square_rect(estimate, sx, sy);
            double pixels = (double)(r.x1 - r.x0) * (r.y1 - r.y0);
            double d = sums[(size_t)sy * estimate->squares_x + sx] / (3.0 * pixels) - v;
            spread += d * d;
        }
    /* A single square says nothing about its spread: assume as much as there is. */
    double deviation = count > 1 ? sqrt(spread / (double)(count - 1)) : v;
    estimate->levels[k].mean_square = v;
    estimate->levels[k].standard_error =
        v > 0.0 ? deviation / (sqrt((double)count) * v) / 2.0 : 0.0;
}

void fl_estimate_capture(fl_estimate *estimate, const fl_film *film, const fl_rect *rect,
                         uint32_t samples)
{
    if (samples == 0 || (samples & (samples - 1)) != 0)
        return;
    uint32_t k = floor_log2(samples);
    size_t count = (size_t)estimate->squares_x * estimate->squares_y;
    FL_ASSERT(rect->x0 % SQUARE_SIDE == 0 && rect->y0 % SQUARE_SIDE == 0);
    uint32_t end_x = squares_along(rect->x1), end_y = squares_along(rect->y1);
    for (uint32_t sy = rect->y0 / SQUARE_SIDE; sy < end_y; sy++)
        for (uint32_t sx = rect->x0 / SQUARE_SIDE; sx < end_x; sx++) {
            fl_rect square = square_rect(estimate, sx, sy);
            FL_ASSERT(square.x1 <= rect->x1 && square.y1 <= rect->y1);
            estimate->sums[k * count + (size_t)sy * estimate->squares_x + sx] =
                exchange_square(estimate, film, &square, k == 0);
        }
    level *l = &estimate->levels[k];
    l->captured_pixels += (uint64_t)(rect->x1 - rect->x0) * (rect->y1 - rect->y0);
    FL_ASSERT(l->captured_pixels <= (uint64_t)estimate->width * estimate->height);
    if (l->captured_pixels == (uint64_t)estimate->width * estimate->height)
        reduce(estimate, k);
}

static double exponent_at(const fl_estimate *estimate, uint32_t k)
{
    if (k <= LEVEL_FIRST_KNOWN)
        return EXPONENT_PRIOR;
    double before = estimate->levels[k - 2].mean_square, now = estimate->levels[k].mean_square;
    if (!(before >= DBL_MIN && now >= DBL_MIN && before <= DBL_MAX && now <= DBL_MAX))
        return EXPONENT_PRIOR;
    return fl_clamp((fl_d_log2(before) - fl_d_log2(now)) / 4.0, EXPONENT_MIN, EXPONENT_MAX);
}

void fl_estimate_read(const fl_estimate *estimate, uint32_t samples, fl_error_estimate *out_error)
{
    *out_error = (fl_error_estimate){0};
    uint32_t k = floor_log2(samples);
    if (samples == 0 || k < LEVEL_FIRST_KNOWN)
        return;
    const level *l = &estimate->levels[k];
    FL_ASSERT(l->captured_pixels == (uint64_t)estimate->width * estimate->height);
    double p = exponent_at(estimate, k);
    double since = fl_d_log2((double)samples) - (double)k; /* Doublings since the snapshot. */
    double rmse = sqrt(l->mean_square) * fl_d_exp2(0.5 - p - p * since);
    double relative = fl_max(RELATIVE_ERROR_MIN, 2.0 * l->standard_error);
    *out_error = (fl_error_estimate){
        .is_known = true,
        .rmse = rmse,
        .low = rmse * fl_max(0.0, 1.0 - relative),
        .high = rmse * (1.0 + relative),
        .samples = samples,
        .exponent = p,
    };
}

double fl_estimate_square_rmse(const fl_estimate *estimate, uint32_t x, uint32_t y,
                               uint32_t samples)
{
    uint32_t k = floor_log2(samples);
    if (samples == 0 || k < LEVEL_FIRST_KNOWN)
        return 0.0;
    uint32_t sx = x / SQUARE_SIDE, sy = y / SQUARE_SIDE;
    FL_ASSERT(sx < estimate->squares_x && sy < estimate->squares_y);
    fl_rect r = square_rect(estimate, sx, sy);
    double pixels = (double)(r.x1 - r.x0) * (r.y1 - r.y0), p = exponent_at(estimate, k);
    size_t count = (size_t)estimate->squares_x * estimate->squares_y;
    double sum = estimate->sums[k * count + (size_t)sy * estimate->squares_x + sx];
    double since = fl_d_log2((double)samples) - (double)k;
    return sqrt(sum / (3.0 * pixels)) * fl_d_exp2(0.5 - p - p * since);
}

uint32_t fl_estimate_next_stop(const fl_estimate *estimate, uint32_t samples, double target_rmse)
{
    uint32_t k = floor_log2(samples);
    if (samples == 0 || k < LEVEL_FIRST_KNOWN)
        return 1u << LEVEL_FIRST_KNOWN;
    uint32_t low = 1u << k, high = k + 1 < LEVELS ? 1u << (k + 1) : UINT32_MAX;
    while (low < high) { /* The error falls with n: the least n within the target, or high. */
        uint32_t middle = low + (high - low) / 2;
        fl_error_estimate error;
        fl_estimate_read(estimate, middle, &error);
        if (error.rmse <= target_rmse)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static double samples_at(const fl_error_estimate *error, double target_rmse, double p)
{
    double doublings = (fl_d_log2(error->rmse) - fl_d_log2(target_rmse)) / p;
    return error->samples * fl_d_exp2(doublings);
}

bool fl_error_predict(const fl_error_estimate *error, double target_rmse,
                      fl_error_forecast *out_forecast)
{
    if (!error->is_known || !(target_rmse >= DBL_MIN && target_rmse <= DBL_MAX))
        return false;
    if (error->rmse <= target_rmse) {
        *out_forecast = (fl_error_forecast){error->samples, error->samples, error->samples};
        return true;
    }
    double samples = samples_at(error, target_rmse, error->exponent);
    out_forecast->samples = samples;
    out_forecast->low = fl_min(samples_at(error, target_rmse, EXPONENT_FAST), samples);
    out_forecast->high = fl_max(samples_at(error, target_rmse, EXPONENT_SLOW), samples);
    return true;
}
