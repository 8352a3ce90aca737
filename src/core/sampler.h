/* SPDX-License-Identifier: MIT
 *
 * Layer 1: sample points as a pure function of (seed, pixel, sample index, set, dimension); no
 * state.
 *
 * `sobol`: Owen-scrambled Sobol points in padded sets of up to four dimensions. The order of the
 * points inside a set is shuffled by the seed and the set alone, so all pixels of a pass share the
 * raw points; each pixel scrambles them with a seed of its own. Dimensions 0 and 1 form a
 * (0,2)-sequence and are the best pair: hand out dimensions only to features in use.
 * `random`: an independent hash for every number; the slow baseline to compare with.
 * `padded`: the first two Sobol dimensions only, the lens a set of its own; to compare with, too.
 * `stratified`: each pair of dimensions in as many equal strata as there will be samples, one
 * jittered sample in each, in an order of its own: what a renderer that knows its number of samples
 * does. Not progressive; scalar, to compare with only.
 *
 *     pixel   y << 16 | x, absolute in the whole picture also when only a crop is rendered
 *     set     FL_SET_CAMERA: pixel filter and lens, up to four dimensions, index i (sample number);
 *             fl_set_light(seed, path, light): two dimensions, index i * m + j for light sample j
 * of m path    FL_PATH_CAMERA for camera rays, fl_path_child for the rays they spawn
 *
 * This file is the definition; wide_sampler.h gives the same bits for FL_W pixels.
 * Hash-based Owen scrambling: Laine and Karras 2011, Burley 2020, constants of Vegdahl 2021;
 * direction numbers: Joe and Kuo 2008.
 */
#ifndef FL_SAMPLER_H
#define FL_SAMPLER_H

#include "core/base.h"

typedef enum fl_sampler {
    FL_SAMPLER_SOBOL,
    FL_SAMPLER_RANDOM,
    FL_SAMPLER_PADDED, /**< Sobol in pairs: dimensions 2, 3 are those of a set of their own. */
    FL_SAMPLER_STRATIFIED
} fl_sampler;

#define FL_SET_CAMERA  0u /* the set of the pixel filter and the lens */
#define FL_PATH_CAMERA 1u /* path number of a camera ray */

/** The most dimensions one set has. */
#define FL_SAMPLE_DIMENSIONS 4

/** Set of the points on light number `light` (scene order) as seen from the hit of ray `path`. */
static inline uint32_t fl_set_light(uint32_t seed, uint32_t path, uint32_t light)
{
    return fl_hash_step(fl_hash_step(fl_hash_step(seed, 1), path), light);
}

/** Path number of the ray that `path` spawns: branch 0 reflected, 1 refracted. */
static inline uint32_t fl_path_child(uint32_t seed, uint32_t path, uint32_t branch)
{
    return fl_hash_step(fl_hash_step(fl_hash_step(seed, 2), path), branch);
}

static inline uint32_t fl_pixel_id(uint32_t x, uint32_t y)
{
    return y << 16 | x;
}

static inline uint32_t fl_reverse_bits(uint32_t x)
{
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
    return __builtin_bswap32(x);
}

/** The step of fl_owen_reversed that needs no seed. */
static inline uint32_t fl_owen_first(uint32_t n)
{
    return n ^ n * 0x3d20adeau;
}

/** Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it. */
static inline uint32_t fl_owen_reversed(uint32_t n, uint32_t seed)
{
    n = fl_owen_first(n);
    n += seed;
    n *= seed >> 16 | 1u;
    n ^= n * 0x05526c56u;
    n ^= n * 0x53a22864u;
    return n;
}

static inline uint32_t fl_owen(uint32_t x, uint32_t seed)
{
    return fl_reverse_bits(fl_owen_reversed(fl_reverse_bits(x), seed));
}

/** Pascal's matrix modulo 2 in closed form: with k bit-reversed, Sobol dimension 1 of point k. */
static inline uint32_t fl_sobol_pascal(uint32_t v)
{
    v ^= v << 16;
    v ^= (v & 0x00FF00FFu) << 8;
    v ^= (v & 0x0F0F0F0Fu) << 4;
    v ^= (v & 0x33333333u) << 2;
    v ^= (v & 0x55555555u) << 1;
    return v;
}

/** Coordinate `dimension` (0 to 3) of Sobol point `k`, as a binary fraction of 32 bits. */
uint32_t fl_sobol_raw(uint32_t k, uint32_t dimension);

/** What all pixels share of number `dimension` of point `index`, before scrambling. */
static inline uint32_t fl_sample_raw(fl_sampler kind, uint32_t seed, uint32_t index, uint32_t set,
                                     uint32_t dimension)
{
    uint32_t shuffle = fl_hash_step(seed, set);
    if (kind == FL_SAMPLER_PADDED && dimension >= 2)
        return fl_sobol_raw(fl_owen(index, fl_hash_step(shuffle, 2)), dimension - 2);
    return fl_sobol_raw(fl_owen(index, shuffle), dimension);
}

/** 24 bits as a float in [0, 1): the low 8 would round some numbers up to 1. */
static inline float fl_unit_float(uint32_t bits)
{
    return (float)(bits >> 8) * 0x1p-24f;
}

/** The definition: number `dimension` of point `index` of `set` at `pixel`, in [0, 1); of all kinds
 * but `stratified`, whose definition is fl_sample_stratified. */
static inline float fl_sample_scalar(fl_sampler kind, uint32_t seed, uint32_t pixel, uint32_t index,
                                     uint32_t set, uint32_t dimension)
{
    FL_ASSERT(kind != FL_SAMPLER_STRATIFIED);
    if (kind == FL_SAMPLER_RANDOM) {
        uint32_t h = fl_hash_step(fl_hash_step(fl_hash_step(seed, 3), pixel), index);
        return fl_unit_float(fl_hash_step(fl_hash_step(h, set), dimension));
    }
    uint32_t h = fl_hash_step(fl_hash_step(fl_hash_step(seed, pixel), set), dimension);
    return fl_unit_float(fl_owen(fl_sample_raw(kind, seed, index, set, dimension), h));
}

/** The same for `stratified` with `strata` points, 1 to FL_STRATA_MAX; later indices begin again
 * with another order. O(strata^0.5) for the shape of the strata. */
float fl_sample_stratified(uint32_t seed, uint32_t pixel, uint32_t index, uint32_t set,
                           uint32_t dimension, uint32_t strata);

enum { FL_STRATA_MAX = 1 << 24 };

/** What all pixels share for one (set, index): made once a pass, read by wide_sampler.h. */
typedef struct fl_sample_pass {
    fl_sampler kind;
    uint32_t seed, set, index;
    uint32_t strata; /* FL_SAMPLER_STRATIFIED only; the caller sets it. */
    /* Raw points as scrambling wants them: bit-reversed, and what it does first done. */
    uint32_t raw_first[FL_SAMPLE_DIMENSIONS];
} fl_sample_pass;

fl_sample_pass fl_sample_pass_begin(fl_sampler kind, uint32_t seed, uint32_t set, uint32_t index);

#endif
