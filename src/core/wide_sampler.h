/* SPDX-License-Identifier: MIT
 *
 * Layer 1: the sampler of sampler.h for FL_W pixels at once; the same bits as fl_sample_scalar.
 *
 * One set for all pixels (camera rays, and lights seen from camera rays, path FL_PATH_CAMERA):
 *     fl_sample_pass pass = fl_sample_pass_begin(kind, seed, set, index);     once a pass
 *     fl_sample_fill(&pass, pixel, count, begin, end, out);                   numbers of dimensions
 * A set per pixel (lights seen from secondary rays, whose paths differ):
 *     fl_sample_fill_light(&pass, light, pixel, path, count, out);            the first two
 */
#ifndef FL_WIDE_SAMPLER_H
#define FL_WIDE_SAMPLER_H

#include "core/sampler.h"
#include "core/wide.h"

/** lowbias32 from its second step on; the first is linear. */
FL_INLINE fl_wu fl_wu_lowbias32_rest(fl_wu x)
{
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

FL_INLINE fl_wu fl_wu_lowbias32(fl_wu x)
{
    return fl_wu_lowbias32_rest(x ^ x >> 16);
}

/** fl_hash_step of lanes. */
FL_INLINE fl_wu fl_wu_hash_step(fl_wu h, fl_wu v)
{
    return fl_wu_lowbias32(h ^ (v * 0x9E3779B9u + 0x7F4A7C15u));
}

/** fl_set_light of lanes. */
FL_INLINE fl_wu fl_wu_set_light(uint32_t seed, fl_wu path, uint32_t light)
{
    return fl_wu_hash_step(fl_wu_hash_step(fl_wu_set(fl_hash_step(seed, 1)), path),
                           fl_wu_set(light));
}

/** fl_path_child of lanes. */
FL_INLINE fl_wu fl_wu_path_child(uint32_t seed, fl_wu path, uint32_t branch)
{
    return fl_wu_hash_step(fl_wu_hash_step(fl_wu_set(fl_hash_step(seed, 2)), path),
                           fl_wu_set(branch));
}

/* With a byte shuffle: nibbles by table, bytes by position; a third of the operations. */
#if FL_W == 8 && defined(__AVX2__)
/* Each byte of x goes, bit-reversed, where `order` takes it from; -1 gives 0. */
FL_INLINE fl_wu fl_wu_reverse_bytes(fl_wu x, __m128i order)
{
    const __m256i low = _mm256_set1_epi8(0x0f);
    const __m256i high_nibble = _mm256_broadcastsi128_si256(
        _mm_setr_epi8(0x0, (char)0x80, 0x40, (char)0xc0, 0x20, (char)0xa0, 0x60, (char)0xe0, 0x10,
                      (char)0x90, 0x50, (char)0xd0, 0x30, (char)0xb0, 0x70, (char)0xf0));
    const __m256i low_nibble = _mm256_broadcastsi128_si256(_mm_setr_epi8(
        0x0, 0x8, 0x4, 0xc, 0x2, 0xa, 0x6, 0xe, 0x1, 0x9, 0x5, 0xd, 0x3, 0xb, 0x7, 0xf));
    __m256i bytes = _mm256_shuffle_epi8((__m256i)x, _mm256_broadcastsi128_si256(order));
    __m256i a = _mm256_shuffle_epi8(high_nibble, _mm256_and_si256(bytes, low));
    __m256i b = _mm256_shuffle_epi8(low_nibble, _mm256_and_si256(_mm256_srli_epi32(bytes, 4), low));
    return (fl_wu)_mm256_or_si256(a, b);
}

FL_INLINE fl_wu fl_wu_reverse_bits(fl_wu x)
{
    return fl_wu_reverse_bytes(x,
                               _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
}

/** The upper 24 bits of the reversed number. */
FL_INLINE fl_wu fl_wu_reverse_24(fl_wu x)
{
    return fl_wu_reverse_bytes(
        x, _mm_setr_epi8(2, 1, 0, -1, 6, 5, 4, -1, 10, 9, 8, -1, 14, 13, 12, -1));
}
#else
FL_INLINE fl_wu fl_wu_reverse_bits(fl_wu x)
{
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
    x = (x & 0x00FF00FFu) << 8 | (x >> 8 & 0x00FF00FFu);
    return x << 16 | x >> 16;
}

FL_INLINE fl_wu fl_wu_reverse_24(fl_wu x)
{
    return fl_wu_reverse_bits(x) >> 8;
}
#endif

/** fl_owen_reversed of lanes, for n after its first step, fl_owen_first. */
FL_INLINE fl_wu fl_wu_owen_rest(fl_wu n, fl_wu seed)
{
    n += seed;
    n *= seed >> 16 | 1u;
    n ^= n * 0x05526c56u;
    n ^= n * 0x53a22864u;
    return n;
}

FL_INLINE fl_wu fl_wu_owen_reversed(fl_wu n, fl_wu seed)
{
    return fl_wu_owen_rest(n ^ n * 0x3d20adeau, seed);
}

/** Bit reversal, then fl_sobol_pascal, then bit reversal. */
FL_INLINE fl_wu fl_wu_pascal_mirrored(fl_wu v)
{
    v ^= v >> 16;
    v ^= v >> 8 & 0x00FF00FFu;
    v ^= v >> 4 & 0x0F0F0F0Fu;
    v ^= v >> 2 & 0x33333333u;
    v ^= v >> 1 & 0x55555555u;
    return v;
}

/** 24 bits of lanes as floats in [0, 1). */
FL_INLINE fl_wf fl_wf_unit_24(fl_wu bits)
{
    return fl_wf_from_wi((fl_wi)bits) * 0x1p-24f;
}

/** fl_unit_float of lanes. */
FL_INLINE fl_wf fl_wf_unit(fl_wu bits)
{
    return fl_wf_unit_24(bits >> 8);
}

/** fl_unit_float of bit-reversed lanes. */
FL_INLINE fl_wf fl_wf_unit_reversed(fl_wu bits)
{
    return fl_wf_unit_24(fl_wu_reverse_24(bits));
}

/* Of the hash that ends with the dimension: what all dimensions share. Folding a number into x
 * begins with x ^ x >> 16, which is linear, so that is here already. */
FL_INLINE fl_wu fl_wu_key(fl_wu x)
{
    return x ^ x >> 16;
}

FL_INLINE fl_wu fl_wu_key_hash(fl_wu key, uint32_t dimension)
{
    uint32_t word = dimension * 0x9E3779B9u + 0x7F4A7C15u;
    return fl_wu_lowbias32_rest(key ^ (word ^ word >> 16));
}

/* The pass's number `dimension` at FL_W pixels. */
FL_INLINE fl_wf fl_wf_sample(const fl_sample_pass *pass, fl_wu key, uint32_t dimension)
{
    fl_wu first = fl_wu_set(pass->raw_first[dimension]);
    return fl_wf_unit_reversed(fl_wu_owen_rest(first, fl_wu_key_hash(key, dimension)));
}

/* Each kind has a loop of its own: one in which stratified numbers may be called for would make all
 * its constants anew each time around. Padded points differ from Sobol's in the pass alone. */
static inline void fl_sample_fill_sobol(const fl_sample_pass *pass, const uint32_t *pixel,
                                        uint32_t count, uint32_t begin, uint32_t end,
                                        float *const *out)
{
    for (uint32_t i = 0; i < count; i += FL_W) {
        fl_wu h = fl_wu_hash_step(fl_wu_set(pass->seed), fl_wu_load(pixel + i));
        fl_wu key = fl_wu_key(fl_wu_hash_step(h, fl_wu_set(pass->set)));
        for (uint32_t d = begin; d < end; d++)
            fl_wf_store(out[d - begin] + i, fl_wf_sample(pass, key, d));
    }
}

FL_INLINE fl_wu fl_wu_random_key(const fl_sample_pass *pass, fl_wu pixel, fl_wu set)
{
    fl_wu h = fl_wu_hash_step(fl_wu_set(fl_hash_step(pass->seed, 3)), pixel);
    return fl_wu_key(fl_wu_hash_step(fl_wu_hash_step(h, fl_wu_set(pass->index)), set));
}

static inline void fl_sample_fill_random(const fl_sample_pass *pass, const uint32_t *pixel,
                                         uint32_t count, uint32_t begin, uint32_t end,
                                         float *const *out)
{
    for (uint32_t i = 0; i < count; i += FL_W) {
        fl_wu key = fl_wu_random_key(pass, fl_wu_load(pixel + i), fl_wu_set(pass->set));
        for (uint32_t d = begin; d < end; d++)
            fl_wf_store(out[d - begin] + i, fl_wf_unit(fl_wu_key_hash(key, d)));
    }
}

/** Numbers [begin, end) of the pass's point at `count` pixels, each into an array of its own.
 * Reads and writes whole vectors. */
static inline void fl_sample_fill(const fl_sample_pass *pass, const uint32_t *pixel, uint32_t count,
                                  uint32_t begin, uint32_t end, float *const *out)
{
    if (pass->kind == FL_SAMPLER_RANDOM)
        fl_sample_fill_random(pass, pixel, count, begin, end, out);
    else if (pass->kind != FL_SAMPLER_STRATIFIED)
        fl_sample_fill_sobol(pass, pixel, count, begin, end, out);
    else
        for (uint32_t d = begin; d < end; d++)
            for (uint32_t i = 0; i < count; i++)
                out[d - begin][i] = fl_sample_stratified(pass->seed, pixel[i], pass->index,
                                                         pass->set, d, pass->strata);
}

static inline void fl_sample_fill_light_sobol(const fl_sample_pass *pass, uint32_t light,
                                              const uint32_t *pixel, const uint32_t *path,
                                              uint32_t count, float *const out[2])
{
    fl_wu seed = fl_wu_set(pass->seed),
          index = fl_wu_set(fl_owen_first(fl_reverse_bits(pass->index)));
    for (uint32_t i = 0; i < count; i += FL_W) {
        fl_wu set = fl_wu_set_light(pass->seed, fl_wu_load(path + i), light);
        fl_wu h = fl_wu_hash_step(seed, fl_wu_load(pixel + i));
        fl_wu key = fl_wu_key(fl_wu_hash_step(h, set));
        /* Scrambling wants raw points bit-reversed: k itself, and Pascal's matrix mirrored. */
        fl_wu k = fl_wu_reverse_bits(fl_wu_owen_rest(index, fl_wu_hash_step(seed, set)));
        fl_wu u = fl_wu_owen_reversed(k, fl_wu_key_hash(key, 0));
        fl_wu v = fl_wu_owen_reversed(fl_wu_pascal_mirrored(k), fl_wu_key_hash(key, 1));
        fl_wf_store(out[0] + i, fl_wf_unit_reversed(u));
        fl_wf_store(out[1] + i, fl_wf_unit_reversed(v));
    }
}

static inline void fl_sample_fill_light_random(const fl_sample_pass *pass, uint32_t light,
                                               const uint32_t *pixel, const uint32_t *path,
                                               uint32_t count, float *const out[2])
{
    for (uint32_t i = 0; i < count; i += FL_W) {
        fl_wu set = fl_wu_set_light(pass->seed, fl_wu_load(path + i), light);
        fl_wu key = fl_wu_random_key(pass, fl_wu_load(pixel + i), set);
        for (uint32_t d = 0; d < 2; d++)
            fl_wf_store(out[d] + i, fl_wf_unit(fl_wu_key_hash(key, d)));
    }
}

/** Numbers 0 and 1 for a light as each of `count` paths sees it: of the pass all but its set.
 * Reads and writes whole vectors. */
static inline void fl_sample_fill_light(const fl_sample_pass *pass, uint32_t light,
                                        const uint32_t *pixel, const uint32_t *path, uint32_t count,
                                        float *const out[2])
{
    if (pass->kind == FL_SAMPLER_RANDOM)
        fl_sample_fill_light_random(pass, light, pixel, path, count, out);
    else if (pass->kind != FL_SAMPLER_STRATIFIED)
        fl_sample_fill_light_sobol(pass, light, pixel, path, count, out);
    else
        for (uint32_t d = 0; d < 2; d++)
            for (uint32_t i = 0; i < count; i++)
                out[d][i] =
                    fl_sample_stratified(pass->seed, pixel[i], pass->index,
                                         fl_set_light(pass->seed, path[i], light), d, pass->strata);
}

#endif
