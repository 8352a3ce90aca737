/* SPDX-License-Identifier: MIT
 *
 * Layer 1: the sampler of sampler.h for FL_W pixels at once; the same bits as fl_sample_scalar.
 *
 * One set for all lanes (camera rays, and lights seen from camera rays, path FL_PATH_CAMERA):
 *     fl_sample_pass pass = fl_sample_pass_begin(kind, seed, set, index);         once a pass
 *     fl_wu key = fl_wu_sample_key(&pass, pixel);                                 once per FL_W
 * pixels fl_wf u = fl_wf_sample(&pass, key, dimension);                              per number A
 * set per lane (lights seen from secondary rays, whose paths differ): fl_wf_sample_pair(kind, seed,
 * pixel, index, fl_wu_set_light(seed, path, light), strata, &u, &v);
 */
#ifndef FL_WIDE_SAMPLER_H
#define FL_WIDE_SAMPLER_H

#include "core/sampler.h"
#include "core/wide.h"

FL_INLINE fl_wu fl_wu_lowbias32(fl_wu x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
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
FL_INLINE fl_wu fl_wu_reverse_bits(fl_wu x)
{
    const __m256i low = _mm256_set1_epi8(0x0f);
    const __m256i high_nibble = _mm256_broadcastsi128_si256(
        _mm_setr_epi8(0x0, (char)0x80, 0x40, (char)0xc0, 0x20, (char)0xa0, 0x60, (char)0xe0, 0x10,
                      (char)0x90, 0x50, (char)0xd0, 0x30, (char)0xb0, 0x70, (char)0xf0));
    const __m256i low_nibble = _mm256_broadcastsi128_si256(_mm_setr_epi8(
        0x0, 0x8, 0x4, 0xc, 0x2, 0xa, 0x6, 0xe, 0x1, 0x9, 0x5, 0xd, 0x3, 0xb, 0x7, 0xf));
    const __m256i swap = _mm256_broadcastsi128_si256(
        _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
    __m256i bytes = _mm256_shuffle_epi8((__m256i)x, swap);
    __m256i a = _mm256_shuffle_epi8(high_nibble, _mm256_and_si256(bytes, low));
    __m256i b = _mm256_shuffle_epi8(low_nibble, _mm256_and_si256(_mm256_srli_epi32(bytes, 4), low));
    return (fl_wu)_mm256_or_si256(a, b);
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
#endif

FL_INLINE fl_wu fl_wu_owen_reversed(fl_wu n, fl_wu seed)
{
    n ^= n * 0x3d20adeau;
    n += seed;
    n *= seed >> 16 | 1u;
    n ^= n * 0x05526c56u;
    n ^= n * 0x53a22864u;
    return n;
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

/** fl_unit_float of lanes. */
FL_INLINE fl_wf fl_wf_unit(fl_wu bits)
{
    return fl_wf_from_wi((fl_wi)(bits >> 8)) * 0x1p-24f;
}

/** Numbers of `stratified`, lane by lane: it is there to compare with, not to be fast. */
FL_INLINE fl_wf fl_wf_sample_strata(uint32_t seed, fl_wu pixel, fl_wu index, fl_wu set,
                                    uint32_t dimension, uint32_t strata)
{
    fl_wf u = fl_wf_set(0.0f);
    for (int i = 0; i < FL_W; i++)
        u[i] = fl_sample_stratified(seed, pixel[i], index[i], set[i], dimension, strata);
    return u;
}

/** The part of the hash that all dimensions of a pixel's point share. */
FL_INLINE fl_wu fl_wu_sample_key(const fl_sample_pass *pass, fl_wu pixel)
{
    bool is_random = pass->kind == FL_SAMPLER_RANDOM;
    if (pass->kind == FL_SAMPLER_STRATIFIED)
        return pixel;
    uint32_t start = is_random ? fl_hash_step(pass->seed, 3) : pass->seed;
    fl_wu h = fl_wu_hash_step(fl_wu_set(start), pixel);
    if (is_random)
        h = fl_wu_hash_step(h, fl_wu_set(pass->index));
    return fl_wu_hash_step(h, fl_wu_set(pass->set));
}

/** Number `dimension` of the pass's point at the pixels whose keys are `key`. */
FL_INLINE fl_wf fl_wf_sample(const fl_sample_pass *pass, fl_wu key, uint32_t dimension)
{
    if (pass->kind == FL_SAMPLER_STRATIFIED)
        return fl_wf_sample_strata(pass->seed, key, fl_wu_set(pass->index), fl_wu_set(pass->set),
                                   dimension, pass->strata);
    fl_wu h = fl_wu_hash_step(key, fl_wu_set(dimension));
    if (pass->kind == FL_SAMPLER_RANDOM)
        return fl_wf_unit(h);
    fl_wu raw = fl_wu_set(pass->raw_reversed[dimension]);
    return fl_wf_unit(fl_wu_reverse_bits(fl_wu_owen_reversed(raw, h)));
}

/** Dimensions 0 and 1 of point `index` of `set`, both per lane. */
FL_INLINE void fl_wf_sample_pair(fl_sampler kind, uint32_t seed, fl_wu pixel, fl_wu index,
                                 fl_wu set, uint32_t strata, fl_wf *out_u, fl_wf *out_v)
{
    if (kind == FL_SAMPLER_STRATIFIED) {
        *out_u = fl_wf_sample_strata(seed, pixel, index, set, 0, strata);
        *out_v = fl_wf_sample_strata(seed, pixel, index, set, 1, strata);
        return;
    }
    if (kind == FL_SAMPLER_RANDOM) {
        fl_wu h = fl_wu_hash_step(fl_wu_set(fl_hash_step(seed, 3)), pixel);
        h = fl_wu_hash_step(fl_wu_hash_step(h, index), set);
        *out_u = fl_wf_unit(fl_wu_hash_step(h, fl_wu_set(0)));
        *out_v = fl_wf_unit(fl_wu_hash_step(h, fl_wu_set(1)));
        return;
    }
    fl_wu shuffle = fl_wu_hash_step(fl_wu_set(seed), set);
    fl_wu k = fl_wu_reverse_bits(fl_wu_owen_reversed(fl_wu_reverse_bits(index), shuffle));
    fl_wu key = fl_wu_hash_step(fl_wu_hash_step(fl_wu_set(seed), pixel), set);
    /* Scrambling wants raw points bit-reversed: k itself, and Pascal's matrix mirrored. */
    fl_wu u = fl_wu_owen_reversed(k, fl_wu_hash_step(key, fl_wu_set(0)));
    fl_wu v = fl_wu_owen_reversed(fl_wu_pascal_mirrored(k), fl_wu_hash_step(key, fl_wu_set(1)));
    *out_u = fl_wf_unit(fl_wu_reverse_bits(u));
    *out_v = fl_wf_unit(fl_wu_reverse_bits(v));
}

#endif
