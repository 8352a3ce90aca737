/* SPDX-License-Identifier: MIT
 *
 * Layer 1: elementary functions of one double (fl_d_*) or one float (fl_f_*), the same bits
 * everywhere and the same bits as the lanes of wide_math.h. For code outside the kernels that still
 * reaches a pixel: rotations, field of view, texture tables, the tone map's tail.
 *
 *     fl_d_sincos(x, &s, &c)   also _turns, _deg; error about 1e-16, see math_body.inc for domains
 *     fl_d_tan_deg, fl_d_atan2(y, x), fl_d_acos
 *     fl_d_log2, fl_d_exp2, fl_d_pow, fl_d_srgb_encode, fl_d_srgb_decode     float accuracy only
 *     fl_f_sincos, _sincos_turns, _sincos_eighth, atan2, acos, log2, exp2, pow
 *     fl_f_srgb_encode, fl_f_srgb_decode
 */
#ifndef FL_MATH64_H
#define FL_MATH64_H

#include <math.h>
#include <string.h>

#include "core/base.h"

static inline double fl_d_set(double x)
{
    return x;
}

static inline uint64_t fl_d_bits(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double fl_d_from_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Masks are 0 / -1 as in wide.h. */
static inline int64_t fl_d_lt(double a, double b)
{
    return -(int64_t)(a < b);
}

static inline int64_t fl_d_le(double a, double b)
{
    return -(int64_t)(a <= b);
}

static inline int64_t fl_d_eq(double a, double b)
{
    return -(int64_t)(a == b);
}

static inline double fl_d_select(int64_t mask, double a, double b)
{
    return mask ? a : b;
}

static inline double fl_d_abs(double x)
{
    return fabs(x);
}

static inline double fl_d_sqrt(double x)
{
    return sqrt(x);
}

static inline double fl_d_copysign(double x, double s)
{
    return copysign(x, s);
}

/* A scalar is both halves of itself. */
static inline double fl_d_lo(float x)
{
    return (double)x;
}

static inline double fl_d_hi(float x)
{
    return (double)x;
}

static inline float fl_f_narrow(double lo, double hi)
{
    (void)hi;
    return (float)lo;
}

#define FL_MATH_FN static inline
#define D          double
#define L          int64_t
#define Q          uint64_t
#define F          float
#define FL_D(name) fl_d_##name
#define FL_F(name) fl_f_##name
#include "core/math_body.inc"
#undef FL_MATH_FN
#undef D
#undef L
#undef Q
#undef F
#undef FL_D
#undef FL_F

#endif
