/* SPDX-License-Identifier: MIT
 *
 * Inputs and comparisons for tests that demand the same bits in every lane.
 */
#ifndef FL_LANE_CHECK_H
#define FL_LANE_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "wide_table.h"

static inline uint32_t float_bits(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline float float_from_bits(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/** Bits, with all NaN taken for one: their payload is not specified. */
static inline uint32_t float_identity(float x)
{
    return x != x ? 0x7fc00000u : float_bits(x);
}

/** A value in [0, 1) with 24 bits, from a counter. */
static inline float test_unit(uint32_t seed, uint32_t i)
{
    return fl_unit_float(fl_hash_step(seed, i));
}

/** Fill a and b (n each): all pairs of special values first, then any bit patterns, then pairs of
 *  ordinary size, then pairs in [0, 1). */
static inline void test_operands(uint32_t seed, float *a, float *b, size_t n)
{
    static const uint32_t special[] = {0x00000000, 0x00000001, 0x007fffff, 0x00800000, 0x33800000,
                                       0x3effffff, 0x3f000000, 0x3f3504f3, 0x3f7fffff, 0x3f800000,
                                       0x3f800001, 0x40490fdb, 0x4affffff, 0x4b000000, 0x4b000001,
                                       0x4b7fffff, 0x4b800001, 0x4f000000, 0x5f000000, 0x7f7fffff,
                                       0x7f800000, 0x7fc00000, 0x3b4d2e1c, 0x42b40000};
    const size_t count = 2 * FL_COUNT_OF(special), pairs = count * count;
    for (size_t i = 0; i < n; i++) {
        uint32_t r = fl_hash_step(seed, (uint32_t)(2 * i)),
                 s = fl_hash_step(seed, (uint32_t)(2 * i + 1));
        uint32_t p = (uint32_t)(i / count % count), q = (uint32_t)(i % count);
        if (i < pairs) {
            r = special[p / 2] | (p % 2) << 31;
            s = special[q / 2] | (q % 2) << 31;
        } else if (i > pairs + (n - pairs) / 3) {
            bool in_unit = i > pairs + (n - pairs) / 3 * 2;
            a[i] = in_unit ? fl_unit_float(r) : (fl_unit_float(r) - 0.5f) * 256.0f;
            b[i] = in_unit ? fl_unit_float(s) : (fl_unit_float(s) - 0.5f) * 256.0f;
            continue;
        }
        a[i] = float_from_bits(r);
        b[i] = float_from_bits(s);
    }
}

/** Fail, showing operands and both values, at the first lane that differs. */
static inline void assert_same_lanes(const char *what, uint32_t width, const float *got,
                                     const float *want, const float *a, const float *b, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (float_identity(got[i]) != float_identity(want[i]))
            fail_msg("%s, width %u, lane %zu: (%a, %a) gives %a, should be %a", what, width, i,
                     (double)a[i], (double)b[i], (double)got[i], (double)want[i]);
}

/** FNV-1a over the identities of n floats. */
static inline uint32_t hash_floats(uint32_t hash, const float *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        hash = (hash ^ float_identity(x[i])) * 16777619u;
    return hash;
}

#endif
