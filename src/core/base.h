/* SPDX-License-Identifier: MIT
 *
 * Layer 0: what every file of the core may use. No allocation, no I/O, no state.
 */
#ifndef FL_BASE_H
#define FL_BASE_H

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** A wrong program, not a wrong input: never used for anything that comes from a file or a user. */
#define FL_ASSERT(condition) assert(condition)

/** Format checking for printf-like functions; 1-based positions of the format and its first argument. */
#define FL_PRINTF(format_at, args_at) __attribute__((format(printf, format_at, args_at)))

/** "No index": handles are uint32_t into plain arrays, and this one is never a valid element. */
#define FL_NONE UINT32_MAX

#define FL_COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

static inline uint32_t fl_min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static inline uint32_t fl_max_u32(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/** a / b, rounded up. */
static inline uint32_t fl_ceil_div(uint32_t a, uint32_t b)
{
    return a / b + (a % b != 0);
}

/* min and max of floating-point values are spelled out, not left to libm: which operand survives
 * when one is NaN must not depend on the instruction set (decision 2). NaN in `a` yields `b`. */
static inline double fl_min(double a, double b)
{
    return a < b ? a : b;
}

static inline double fl_max(double a, double b)
{
    return a > b ? a : b;
}

static inline double fl_clamp(double x, double lo, double hi)
{
    return fl_min(fl_max(x, lo), hi);
}

/** Multiply sizes; false (and *out untouched) when the product does not fit. */
static inline bool fl_size_mul(size_t a, size_t b, size_t *out)
{
    return !__builtin_mul_overflow(a, b, out);
}

/** Bijective 32-bit mixer with low bias (C. Wellons' search, public domain constants). */
static inline uint32_t fl_lowbias32(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

/** One step of the hash H of decision 6: fold the word `v` into the running value `h`.
 *  H(a, b, c) with a seed is fl_hash_step(fl_hash_step(fl_hash_step(seed, a), b), c). */
static inline uint32_t fl_hash_step(uint32_t h, uint32_t v)
{
    return fl_lowbias32(h ^ (v * 0x9E3779B9u + 0x7F4A7C15u));
}

#endif
