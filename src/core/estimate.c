/* SPDX-License-Identifier: MIT */
#include "core/estimate.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "core/math64.h"

enum {
    LEVELS = 32,          /* Powers of two of samples. */
    LEVEL_FIRST_KNOWN = 2 /* 4 samples. */
};

#define EXPONENT_PRIOR     0.60
#define EXPONENT_MIN       0.50
#define EXPONENT_MAX       1.50
#define EXPONENT_PART      0.75 /* At most, within a doubling: nets must be whole. */
#define EXPONENT_FAST      0.70 /* Bracket of forecasts; at least EXPONENT_MARGIN beyond p. */
#define EXPONENT_SLOW      0.50
#define EXPONENT_MARGIN    0.10
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
    /* Adaptive sampling only. The figures are as if each pixel had doubled its samples. */
    float *pixel_square;     /* Squared difference, mean of the channels. */
    uint32_t *pixel_samples; /* At the snapshot. */
    double *round_sums;      /* By square: sums of 3 pixel_square. */
    level round;
    double round_samples;  /* Mean, at the last complete round; 0: none yet. */
    uint64_t round_pixels; /* Captured of the round under way. */
};

static uint32_t squares_along(uint32_t side_px)
{
    return side_px / FL_SQUARE_SIDE + (side_px % FL_SQUARE_SIDE != 0);
}

bool fl_estimate_bytes(uint32_t width, uint32_t height, bool is_adaptive, size_t *out_bytes)
{
    size_t pixels, snapshot, squares, sums, pixel = 3 * sizeof(float);
    if (is_adaptive)
        pixel += sizeof(float) + sizeof(uint32_t);
    if (!fl_size_mul(width, height, &pixels) || !fl_size_mul(pixels, pixel, &snapshot) ||
        !fl_size_mul(squares_along(width), squares_along(height), &squares) ||
        !fl_size_mul(squares, (LEVELS + is_adaptive) * sizeof(double), &sums) ||
        snapshot > SIZE_MAX - sums - sizeof(fl_estimate))
        return false;
    *out_bytes = sizeof(fl_estimate) + snapshot + sums;
    return true;
}

static bool allocate_round(fl_estimate *estimate, size_t pixels, size_t squares)
{
    estimate->pixel_square = malloc(pixels * sizeof *estimate->pixel_square);
    estimate->pixel_samples = malloc(pixels * sizeof *estimate->pixel_samples);
    estimate->round_sums = malloc(squares * sizeof *estimate->round_sums);
    return estimate->pixel_square && estimate->pixel_samples && estimate->round_sums;
}

fl_estimate *fl_estimate_create(uint32_t width, uint32_t height, bool is_adaptive)
{
    size_t bytes;
    fl_estimate *estimate =
        fl_estimate_bytes(width, height, is_adaptive, &bytes) ? calloc(1, sizeof *estimate) : NULL;
    if (!estimate)
        return NULL;
    estimate->width = width;
    estimate->height = height;
    estimate->squares_x = squares_along(width);
    estimate->squares_y = squares_along(height);
    size_t squares = (size_t)estimate->squares_x * estimate->squares_y;
    estimate->snapshot = malloc((size_t)width * height * 3 * sizeof *estimate->snapshot);
    estimate->sums = malloc(squares * LEVELS * sizeof *estimate->sums);
    if (!estimate->snapshot || !estimate->sums ||
        (is_adaptive && !allocate_round(estimate, (size_t)width * height, squares))) {
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
    free(estimate->pixel_square);
    free(estimate->pixel_samples);
    free(estimate->round_sums);
    free(estimate);
}

void fl_estimate_reset(fl_estimate *estimate)
{
    for (uint32_t k = 0; k < LEVELS; k++)
        estimate->levels[k] = (level){0};
    estimate->round_samples = 0.0;
    estimate->round_pixels = 0;
}

static uint32_t floor_log2(uint32_t x)
{
    uint32_t k = 0;
    while (x >>= 1)
        k++;
    return k;
}

/* For adaptive sampling: a channel's difference at a pixel that has `samples` now. */
static void note_pixel(fl_estimate *estimate, size_t at, uint32_t channel, double difference,
                       uint32_t samples)
{
    double before = channel == 0 ? 0.0 : (double)estimate->pixel_square[at];
    estimate->pixel_square[at] = (float)(before + difference * difference / 3.0);
    estimate->pixel_samples[at] = samples;
}

/* Put the mean of a square into the snapshot; returns the sum of squared differences from what was
 * there, which at level 0 is nothing. */
static double exchange_square(fl_estimate *estimate, const fl_film *film, const fl_rect *square,
                              uint32_t samples)
{
    bool is_first = samples == 1;
    double sum = 0.0;
    uint32_t width = square->x1 - square->x0;
    for (uint32_t y = square->y0; y < square->y1; y++) {
        float mean[3 * FL_SQUARE_SIDE];
        fl_film_row(film, square->x0, y, width, mean);
        size_t at = (size_t)y * estimate->width + square->x0;
        float *old = estimate->snapshot + 3 * at;
        for (uint32_t i = 0; i < 3 * width; i++) {
            double difference = is_first ? 0.0 : (double)mean[i] - (double)old[i];
            sum += difference * difference;
            if (estimate->pixel_square)
                note_pixel(estimate, at + i / 3, i % 3, difference, samples);
            old[i] = mean[i];
        }
    }
    return sum;
}

static fl_rect square_rect(const fl_estimate *estimate, uint32_t sx, uint32_t sy)
{
    uint32_t x = sx * FL_SQUARE_SIDE, y = sy * FL_SQUARE_SIDE;
    return (fl_rect){x, y, fl_min_u32(x + FL_SQUARE_SIDE, estimate->width),
                     fl_min_u32(y + FL_SQUARE_SIDE, estimate->height)};
}

/* All squares are there: V and its spread. */
static void reduce(const fl_estimate *estimate, const double *sums, level *out)
{
    size_t count = (size_t)estimate->squares_x * estimate->squares_y;
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
    out->mean_square = v;
    out->standard_error = v > 0.0 ? deviation / (sqrt((double)count) * v) / 2.0 : 0.0;
}

void fl_estimate_capture(fl_estimate *estimate, const fl_film *film, const fl_rect *rect,
                         uint32_t samples)
{
    if (samples == 0 || (samples & (samples - 1)) != 0)
        return;
    uint32_t k = floor_log2(samples);
    size_t count = (size_t)estimate->squares_x * estimate->squares_y;
    FL_ASSERT(rect->x0 % FL_SQUARE_SIDE == 0 && rect->y0 % FL_SQUARE_SIDE == 0);
    uint32_t end_x = squares_along(rect->x1), end_y = squares_along(rect->y1);
    for (uint32_t sy = rect->y0 / FL_SQUARE_SIDE; sy < end_y; sy++)
        for (uint32_t sx = rect->x0 / FL_SQUARE_SIDE; sx < end_x; sx++) {
            fl_rect square = square_rect(estimate, sx, sy);
            FL_ASSERT(square.x1 <= rect->x1 && square.y1 <= rect->y1);
            estimate->sums[k * count + (size_t)sy * estimate->squares_x + sx] =
                exchange_square(estimate, film, &square, samples);
        }
    level *l = &estimate->levels[k];
    l->captured_pixels += (uint64_t)(rect->x1 - rect->x0) * (rect->y1 - rect->y0);
    FL_ASSERT(l->captured_pixels <= (uint64_t)estimate->width * estimate->height);
    if (l->captured_pixels == (uint64_t)estimate->width * estimate->height)
        reduce(estimate, estimate->sums + k * count, l);
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

/* How a squared difference from n1 to n2 = r n1 samples compares with one from n to 2 n, as a
 * factor on it: both stand for the same error after them. */
static double ratio_factor(double r, double p)
{
    double fresh = r / (r - 1.0);
    double of_r = (fl_d_exp2(2.0 * p * fl_d_log2(r)) + fl_d_exp2(2.0 * p * fl_d_log2(fresh))) /
                  (fresh * fresh);
    double of_two = fl_d_exp2(2.0 * p) / 2.0;
    return of_two / of_r;
}

/* One pixel at the end of a round; returns its figure. */
static double exchange_pixel(fl_estimate *estimate, const fl_film *film, uint32_t x, uint32_t y,
                             double p)
{
    size_t at = (size_t)y * estimate->width + x;
    uint32_t before = estimate->pixel_samples[at], now;
    fl_film_samples_row(film, x, y, 1, &now);
    if (now == before)
        return (double)estimate->pixel_square[at];
    float mean[3], *old = estimate->snapshot + 3 * at;
    fl_film_row(film, x, y, 1, mean);
    double square = 0.0;
    for (int c = 0; c < 3; c++) {
        double difference = (double)mean[c] - (double)old[c];
        square += difference * difference / 3.0;
        old[c] = mean[c];
    }
    square *= ratio_factor((double)now / before, p);
    estimate->pixel_square[at] = (float)square;
    estimate->pixel_samples[at] = now;
    return square;
}

static bool is_complete(const fl_estimate *estimate, uint32_t k)
{
    return estimate->levels[k].captured_pixels == (uint64_t)estimate->width * estimate->height;
}

/* The last power of two that all pixels had when they still had the same number: in adaptive
 * sampling there are none beyond. */
static uint32_t even_level(const fl_estimate *estimate, uint32_t samples)
{
    uint32_t k = floor_log2(samples);
    while (estimate->pixel_square && k > 0 && !is_complete(estimate, k))
        k--;
    return k;
}

void fl_estimate_capture_round(fl_estimate *estimate, const fl_film *film, const fl_rect *rect,
                               double mean_samples)
{
    FL_ASSERT(estimate->pixel_square && rect->x0 % FL_SQUARE_SIDE == 0 &&
              rect->y0 % FL_SQUARE_SIDE == 0);
    double p = exponent_at(estimate, even_level(estimate, (uint32_t)mean_samples));
    for (uint32_t sy = rect->y0 / FL_SQUARE_SIDE; sy < squares_along(rect->y1); sy++)
        for (uint32_t sx = rect->x0 / FL_SQUARE_SIDE; sx < squares_along(rect->x1); sx++) {
            fl_rect square = square_rect(estimate, sx, sy);
            double sum = 0.0;
            for (uint32_t y = square.y0; y < square.y1; y++)
                for (uint32_t x = square.x0; x < square.x1; x++)
                    sum += 3.0 * exchange_pixel(estimate, film, x, y, p);
            estimate->round_sums[(size_t)sy * estimate->squares_x + sx] = sum;
        }
    estimate->round_pixels += (uint64_t)(rect->x1 - rect->x0) * (rect->y1 - rect->y0);
    if (estimate->round_pixels < (uint64_t)estimate->width * estimate->height)
        return;
    reduce(estimate, estimate->round_sums, &estimate->round);
    estimate->round_samples = mean_samples;
    estimate->round_pixels = 0;
}

/* RMSE from the sqrt(V) of so many doublings ago. */
static double rmse_after(double root, double p, double doublings)
{
    return root * fl_d_exp2(0.5 - p - fl_min(p, EXPONENT_PART) * doublings);
}

double fl_estimate_pixel_square(const fl_estimate *estimate, uint32_t x, uint32_t y)
{
    FL_ASSERT(estimate->pixel_square);
    return (double)estimate->pixel_square[(size_t)y * estimate->width + x];
}

void fl_estimate_read(const fl_estimate *estimate, uint32_t samples, fl_error_estimate *out_error)
{
    *out_error = (fl_error_estimate){0};
    bool is_round = estimate->round_samples > 0.0;
    uint32_t k = even_level(estimate, (uint32_t)fl_max(samples, estimate->round_samples));
    if (samples == 0 || k < LEVEL_FIRST_KNOWN)
        return;
    const level *l = is_round ? &estimate->round : &estimate->levels[k];
    FL_ASSERT(is_complete(estimate, k));
    double p = exponent_at(estimate, k), now = fl_max(samples, estimate->round_samples);
    double then = is_round ? estimate->round_samples : (double)(1u << k);
    double since = fl_d_log2(now) - fl_d_log2(then); /* Doublings since the snapshot. */
    double rmse = rmse_after(sqrt(l->mean_square), p, since);
    double relative = fl_max(RELATIVE_ERROR_MIN, 2.0 * l->standard_error);
    *out_error = (fl_error_estimate){
        .is_known = true,
        .rmse = rmse,
        .low = rmse * fl_max(0.0, 1.0 - relative),
        .high = rmse * (1.0 + relative),
        .samples = now,
        .exponent = p,
    };
}

double fl_estimate_square_rmse(const fl_estimate *estimate, uint32_t x, uint32_t y,
                               uint32_t samples)
{
    bool is_round = estimate->round_samples > 0.0;
    uint32_t k = even_level(estimate, (uint32_t)fl_max(samples, estimate->round_samples));
    if (samples == 0 || k < LEVEL_FIRST_KNOWN)
        return 0.0;
    uint32_t sx = x / FL_SQUARE_SIDE, sy = y / FL_SQUARE_SIDE;
    FL_ASSERT(sx < estimate->squares_x && sy < estimate->squares_y);
    fl_rect r = square_rect(estimate, sx, sy);
    double pixels = (double)(r.x1 - r.x0) * (r.y1 - r.y0), p = exponent_at(estimate, k);
    size_t count = (size_t)estimate->squares_x * estimate->squares_y;
    const double *sums = is_round ? estimate->round_sums : estimate->sums + k * count;
    double since = is_round ? 0.0 : fl_d_log2((double)samples) - (double)k;
    double mean_square = sums[(size_t)sy * estimate->squares_x + sx] / (3.0 * pixels);
    return rmse_after(sqrt(mean_square), p, since);
}

static double samples_at(const fl_error_estimate *error, double target_rmse, double p)
{
    double doublings = (fl_d_log2(error->rmse) - fl_d_log2(target_rmse)) / p;
    return error->samples * fl_d_exp2(doublings);
}

/* After a round: what the forecast says, but ask again after another doubling of the mean. */
static uint32_t next_mean(const fl_estimate *estimate, double target_rmse)
{
    fl_error_estimate error;
    fl_estimate_read(estimate, 1, &error);
    if (error.rmse <= target_rmse)
        return (uint32_t)error.samples;
    double wanted = ceil(samples_at(&error, target_rmse, error.exponent));
    return (uint32_t)fl_min(wanted, 2.0 * error.samples);
}

uint32_t fl_estimate_next_stop(const fl_estimate *estimate, uint32_t samples, double target_rmse)
{
    if (estimate->round_samples > 0.0)
        return next_mean(estimate, target_rmse);
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

void fl_error_bracket(double p, double *out_slow, double *out_fast)
{
    *out_slow = fl_min(EXPONENT_SLOW, p);
    *out_fast = fl_max(EXPONENT_FAST, p + EXPONENT_MARGIN);
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
    double slow, fast;
    fl_error_bracket(error->exponent, &slow, &fast);
    out_forecast->samples = samples_at(error, target_rmse, error->exponent);
    out_forecast->low = samples_at(error, target_rmse, fast);
    out_forecast->high = samples_at(error, target_rmse, slow);
    return true;
}

/* Sums of a tile at levels that it has not reached are 0, not whatever was there. */
static void clear_uncaptured(fl_estimate *estimate, const fl_rect *rect, uint32_t begin,
                             uint32_t end)
{
    size_t squares = (size_t)estimate->squares_x * estimate->squares_y;
    for (uint32_t k = begin; k < end; k++)
        for (uint32_t sy = rect->y0 / FL_SQUARE_SIDE; sy < squares_along(rect->y1); sy++)
            for (uint32_t sx = rect->x0 / FL_SQUARE_SIDE; sx < squares_along(rect->x1); sx++)
                estimate->sums[k * squares + (size_t)sy * estimate->squares_x + sx] = 0.0;
}

/* Count what the tiles have captured. */
static void recount(fl_estimate *estimate, const fl_schedule *schedule)
{
    size_t squares = (size_t)estimate->squares_x * estimate->squares_y;
    fl_rect rect;
    uint32_t samples;
    for (uint32_t i = 0; fl_schedule_tile(schedule, i, &rect, &samples); i++)
        for (uint32_t k = 0; k < LEVELS && samples >> k; k++)
            estimate->levels[k].captured_pixels +=
                (uint64_t)(rect.x1 - rect.x0) * (rect.y1 - rect.y0);
    for (uint32_t k = 0; k < LEVELS; k++)
        if (estimate->levels[k].captured_pixels == (uint64_t)estimate->width * estimate->height)
            reduce(estimate, estimate->sums + k * squares, &estimate->levels[k]);
}

void fl_estimate_pack(fl_estimate *estimate, const fl_schedule *schedule, fl_pack *pack)
{
    size_t squares = (size_t)estimate->squares_x * estimate->squares_y;
    size_t pixels = (size_t)estimate->width * estimate->height;
    fl_rect rect;
    uint32_t samples, levels = 0;
    for (uint32_t i = 0; fl_schedule_tile(schedule, i, &rect, &samples); i++)
        levels = fl_max_u32(levels, floor_log2(samples) + 1);
    for (uint32_t i = 0; fl_schedule_tile(schedule, i, &rect, &samples); i++)
        clear_uncaptured(estimate, &rect, floor_log2(samples) + 1, levels);
    fl_pack_bytes(pack, estimate->snapshot, pixels * 3 * sizeof *estimate->snapshot);
    fl_pack_bytes(pack, estimate->sums, levels * squares * sizeof *estimate->sums);
    if (pack->mode == FL_PACK_READ && !pack->has_failed)
        recount(estimate, schedule);
}
