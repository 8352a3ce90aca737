/* SPDX-License-Identifier: MIT
 *
 * For tests of what is concluded from a film: made-up samples, put into it a unit at a time, and
 * how far its mean is from the truth.
 */
#ifndef NOISE_FILM_H
#define NOISE_FILM_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/film.h"

/** The value of a sample; x and y are the unit's coordinates. */
typedef double noise_value(const void *context, uint32_t x, uint32_t y, uint32_t sample,
                           uint32_t channel);

/** A unit of one sample number and its result; not for more than one thread. */
typedef struct noise_unit {
    uint16_t x[FL_UNIT_PIXELS], y[FL_UNIT_PIXELS];
    uint32_t count;
    float rgb[3][FL_UNIT_PIXELS];
    uint8_t is_valid[FL_UNIT_PIXELS];
} noise_unit;

/** A number of mean 0 and variance 1 for each hash. */
static inline double noise_of(uint32_t hash)
{
    return ((double)(hash >> 8) * 0x1p-24 - 0.5) * sqrt(12.0);
}

/** What sample number n must be for the mean of samples 0 to n to be off by a number of standard
 * deviation (n + 1)^-p, another for each n. */
static inline double noise_at_rate(uint32_t hash, uint32_t n, double p)
{
    double now = noise_of(fl_hash_step(hash, n + 1)) * pow(n + 1, 1.0 - p);
    return n == 0 ? now : now - noise_of(fl_hash_step(hash, n)) * pow(n, 1.0 - p);
}

/** The pixels of a row: `count` from (x0, y) on. */
static inline void noise_list_row(noise_unit *unit, uint32_t x0, uint32_t y, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        unit->x[i] = (uint16_t)(x0 + i);
        unit->y[i] = (uint16_t)y;
    }
    unit->count = count;
}

/** Draw sample number `sample` for the listed pixels and add it to a film that begins at (x0, y0).
 * Fills the views of what was added, which are good until the unit changes. */
static inline void noise_add(noise_unit *unit, uint32_t sample, noise_value *value,
                             const void *context, fl_film *film, uint32_t x0, uint32_t y0,
                             fl_unit *out_unit, fl_unit_result *out_result)
{
    for (uint32_t i = 0; i < unit->count; i++)
        for (uint32_t c = 0; c < 3; c++)
            unit->rgb[c][i] = (float)value(context, unit->x[i], unit->y[i], sample, c);
    for (uint32_t i = 0; i < unit->count; i++)
        unit->is_valid[i] = isfinite(unit->rgb[0][i]) != 0;
    *out_unit = (fl_unit){unit->x, unit->y, unit->count, sample};
    *out_result = (fl_unit_result){unit->rgb[0], unit->rgb[1], unit->rgb[2], unit->is_valid};
    fl_film_add(film, out_unit, out_result, x0, y0);
}

/** Root of the mean square of the film's mean less the truth. */
static inline double noise_rmse(const fl_film *film, double truth)
{
    size_t count = (size_t)3 * fl_film_width(film) * fl_film_height(film);
    float *mean = malloc(count * sizeof *mean);
    double sum = 0.0;
    fl_film_mean(film, mean);
    for (size_t i = 0; i < count; i++)
        sum += ((double)mean[i] - truth) * ((double)mean[i] - truth);
    free(mean);
    return sqrt(sum / (double)count);
}

#endif
