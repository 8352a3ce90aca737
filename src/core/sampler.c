/* SPDX-License-Identifier: MIT */
#include "core/sampler.h"

#include <math.h>

/* Direction numbers of dimensions 2 and 3: one word per bit of k, lowest bit first. Made from the
 * primitive polynomials and initial values (s = 2, a = 1, m = 1, 3) and (s = 3, a = 1, m = 1, 3, 1)
 * of Joe and Kuo; the test makes them again. */
static const uint32_t directions[2][32] = {
    {0x80000000u, 0xc0000000u, 0x60000000u, 0x90000000u, 0xe8000000u, 0x5c000000u, 0x8e000000u,
     0xc5000000u, 0x68800000u, 0x9cc00000u, 0xee600000u, 0x55900000u, 0x80680000u, 0xc09c0000u,
     0x60ee0000u, 0x90550000u, 0xe8808000u, 0x5cc0c000u, 0x8e606000u, 0xc5909000u, 0x6868e800u,
     0x9c9c5c00u, 0xeeee8e00u, 0x5555c500u, 0x8000e880u, 0xc0005cc0u, 0x60008e60u, 0x9000c590u,
     0xe8006868u, 0x5c009c9cu, 0x8e00eeeeu, 0xc5005555u},
    {0x80000000u, 0xc0000000u, 0x20000000u, 0x50000000u, 0xf8000000u, 0x74000000u, 0xa2000000u,
     0x93000000u, 0xd8800000u, 0x25400000u, 0x59e00000u, 0xe6d00000u, 0x78080000u, 0xb40c0000u,
     0x82020000u, 0xc3050000u, 0x208f8000u, 0x51474000u, 0xfbea2000u, 0x75d93000u, 0xa0858800u,
     0x914e5400u, 0xdbe79e00u, 0x25db6d00u, 0x58800080u, 0xe54000c0u, 0x79e00020u, 0xb6d00050u,
     0x800800f8u, 0xc00c0074u, 0x200200a2u, 0x50050093u}};

uint32_t fl_sobol_raw(uint32_t k, uint32_t dimension)
{
    FL_ASSERT(dimension < FL_SAMPLE_DIMENSIONS);
    if (dimension == 0)
        return fl_reverse_bits(k);
    if (dimension == 1)
        return fl_sobol_pascal(fl_reverse_bits(k));
    uint32_t x = 0;
    for (int bit = 0; bit < 32; bit++)
        if (k >> bit & 1u)
            x ^= directions[dimension - 2][bit];
    return x;
}

fl_sample_pass fl_sample_pass_begin(fl_sampler kind, uint32_t seed, uint32_t set, uint32_t index)
{
    fl_sample_pass pass = {.kind = kind, .seed = seed, .set = set, .index = index};
    bool is_sobol = kind == FL_SAMPLER_SOBOL || kind == FL_SAMPLER_PADDED;
    for (uint32_t d = 0; is_sobol && d < FL_SAMPLE_DIMENSIONS; d++)
        pass.raw_first[d] =
            fl_owen_first(fl_reverse_bits(fl_sample_raw(kind, seed, index, set, d)));
    return pass;
}

/* --- Stratified --------------------------------------------------------------------------------
 */

enum { STRATA_SEED = 4 };

/* Where `i` goes in an order of 0 ... count - 1 that the seed decides: a bijection of the next
 * power of two, walked until it lands below count. */
static uint32_t permute(uint32_t i, uint32_t count, uint32_t seed)
{
    uint32_t bits = 1;
    while (bits < 32 && (uint32_t)1 << bits < count)
        bits++;
    uint32_t mask = bits < 32 ? ((uint32_t)1 << bits) - 1 : UINT32_MAX, shift = (bits + 1) / 2;
    do {
        for (uint32_t round = 0; round < 3; round++) {
            uint32_t h = fl_hash_step(seed, round);
            i = (i * (h | 1u) + (h >> 7)) & mask;
            i ^= i >> shift;
        }
    } while (i >= count);
    return i;
}

/* The most square shape: the largest divisor not above the root. */
static uint32_t strata_rows(uint32_t strata)
{
    uint32_t rows = 1;
    for (uint32_t r = 2; r * r <= strata; r++)
        if (strata % r == 0)
            rows = r;
    return rows;
}

float fl_sample_stratified(uint32_t seed, uint32_t pixel, uint32_t index, uint32_t set,
                           uint32_t dimension, uint32_t strata)
{
    FL_ASSERT(strata > 0 && strata <= FL_STRATA_MAX);
    uint32_t h = fl_hash_step(fl_hash_step(fl_hash_step(seed, STRATA_SEED), pixel), set);
    h = fl_hash_step(fl_hash_step(h, dimension / 2), index / strata);
    uint32_t rows = strata_rows(strata), columns = strata / rows;
    uint32_t cell = permute(index % strata, strata, h);
    bool is_even = dimension % 2 == 0;
    uint32_t at = is_even ? cell % columns : cell / columns, count = is_even ? columns : rows;
    double jitter = (double)fl_sample_scalar(FL_SAMPLER_RANDOM, seed, pixel, index, set, dimension);
    return (float)(floor((at + jitter) / count * 0x1p24) * 0x1p-24);
}
