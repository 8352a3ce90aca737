/* SPDX-License-Identifier: MIT
 *
 * Layer 1: FL_W lanes at once, by the vector extensions of GCC and Clang.
 *
 * A kernel source is written once and compiled per instruction set with two definitions:
 *
 *     -DFL_ISA=avx2 -DFL_W=8 -mavx2
 *     -DFL_ISA=sse2 -DFL_W=4           neon likewise
 *     -DFL_ISA=scalar -DFL_W=1
 *
 * Every operation gives the same bits in a lane whatever FL_W, instruction set and compiler are
 * (NaN stays NaN, but its payload and sign are not specified). Arithmetic, comparison and shifts
 * are plain operators; a comparison yields a mask of 0 / -1 lanes; v[i] reads or writes lane i.
 *
 *     fl_wf  FL_W floats     fl_wi, fl_wu  FL_W 32-bit integers     fl_wm  mask for them
 *     fl_wd  FL_WD doubles   fl_wl, fl_wq  FL_WD 64-bit integers    fl_wl  is also their mask
 *
 * Doubles fill one register too, so FL_WD is FL_W / 2 (1 for FL_W 1) and a fl_wf is a low and a
 * high fl_wd: vectors wider than a register are split badly by gcc 12. With FL_W 1 both halves are
 * the one lane, so code written for two halves needs no special case.
 */
#ifndef FL_WIDE_H
#define FL_WIDE_H

#include <string.h>

#include "core/base.h"

#define FL_INLINE static inline __attribute__((always_inline, unused))

#define FL_ISA_JOIN_(name, isa) name##_##isa
#define FL_ISA_JOIN(name, isa)  FL_ISA_JOIN_(name, isa)
/** The name of this instruction set's copy of a kernel: FL_ISA_NAME(fl_trace) is fl_trace_avx2. */
#define FL_ISA_NAME(name) FL_ISA_JOIN(name, FL_ISA)

/* Initialisers: the same value in each lane; the lane numbers. */
#if FL_W == 8
#define FL_WD         4
#define FL_SPLAT(x)   x, x, x, x, x, x, x, x
#define FL_SPLAT_D(x) x, x, x, x
#define FL_IOTA       0, 1, 2, 3, 4, 5, 6, 7
#elif FL_W == 4
#define FL_WD         2
#define FL_SPLAT(x)   x, x, x, x
#define FL_SPLAT_D(x) x, x
#define FL_IOTA       0, 1, 2, 3
#elif FL_W == 1
#define FL_WD         1
#define FL_SPLAT(x)   x
#define FL_SPLAT_D(x) x
#define FL_IOTA       0
#else
#error "define FL_W as 8, 4 or 1"
#endif

/** All lanes as bits of fl_wm_bits. */
#define FL_W_ALL ((1u << FL_W) - 1u)

typedef float fl_wf __attribute__((vector_size(4 * FL_W)));
typedef int32_t fl_wi __attribute__((vector_size(4 * FL_W)));
typedef uint32_t fl_wu __attribute__((vector_size(4 * FL_W)));
typedef fl_wi fl_wm;
typedef double fl_wd __attribute__((vector_size(8 * FL_WD)));
typedef int64_t fl_wl __attribute__((vector_size(8 * FL_WD)));
typedef uint64_t fl_wq __attribute__((vector_size(8 * FL_WD)));

/* For each type: the same value in all lanes; load and store of consecutive elements, any
 * alignment; lane-wise m ? a : b. */
#define FL_WIDE_COMMON(T, element, M, SPLAT)                                                       \
    FL_INLINE T T##_set(element x)                                                                 \
    {                                                                                              \
        return (T){SPLAT(x)};                                                                      \
    }                                                                                              \
    FL_INLINE T T##_load(const element *p)                                                         \
    {                                                                                              \
        T v;                                                                                       \
        memcpy(&v, p, sizeof v);                                                                   \
        return v;                                                                                  \
    }                                                                                              \
    FL_INLINE void T##_store(element *p, T v)                                                      \
    {                                                                                              \
        memcpy(p, &v, sizeof v);                                                                   \
    }                                                                                              \
    FL_INLINE T T##_select(M m, T a, T b)                                                          \
    {                                                                                              \
        return (T)((m & (M)a) | (~m & (M)b));                                                      \
    }

FL_WIDE_COMMON(fl_wf, float, fl_wm, FL_SPLAT)
FL_WIDE_COMMON(fl_wi, int32_t, fl_wm, FL_SPLAT)
FL_WIDE_COMMON(fl_wu, uint32_t, fl_wm, FL_SPLAT)
FL_WIDE_COMMON(fl_wd, double, fl_wl, FL_SPLAT_D)
FL_WIDE_COMMON(fl_wl, int64_t, fl_wl, FL_SPLAT_D)
FL_WIDE_COMMON(fl_wq, uint64_t, fl_wl, FL_SPLAT_D)

/* min, max, sqrt, floor, fl_wm_bits and the halves: one definition per register file. */
#include "core/wide_native.inc"

/** 0, 1, 2, … FL_W - 1. */
FL_INLINE fl_wi fl_wi_iota(void)
{
    return (fl_wi){FL_IOTA};
}

/** The first `count` lanes (any count; for the tail of an array). */
FL_INLINE fl_wm fl_wm_first(uint32_t count)
{
    return fl_wi_iota() < (int32_t)fl_min_u32(count, FL_W);
}

FL_INLINE bool fl_wm_any(fl_wm m)
{
    return fl_wm_bits(m) != 0;
}

FL_INLINE bool fl_wm_all(fl_wm m)
{
    return fl_wm_bits(m) == FL_W_ALL;
}

FL_INLINE fl_wf fl_wf_abs(fl_wf a)
{
    return (fl_wf)((fl_wi)a & 0x7fffffff);
}

FL_INLINE fl_wd fl_wd_abs(fl_wd a)
{
    return (fl_wd)((fl_wl)a & INT64_MAX);
}

/** Magnitude of `a` with the sign of `s`. */
FL_INLINE fl_wf fl_wf_copysign(fl_wf a, fl_wf s)
{
    return (fl_wf)(((fl_wi)a & 0x7fffffff) | ((fl_wi)s & INT32_MIN));
}

FL_INLINE fl_wd fl_wd_copysign(fl_wd a, fl_wd s)
{
    return (fl_wd)(((fl_wl)a & INT64_MAX) | ((fl_wl)s & INT64_MIN));
}

/** Least and greatest of the lanes, none of them NaN. */
FL_INLINE float fl_wf_least(fl_wf v)
{
#if FL_W == 8
    v = fl_wf_min(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
    v = fl_wf_min(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5));
    v = fl_wf_min(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6));
#elif FL_W == 4
    v = fl_wf_min(v, __builtin_shufflevector(v, v, 2, 3, 0, 1));
    v = fl_wf_min(v, __builtin_shufflevector(v, v, 1, 0, 3, 2));
#endif
    return v[0];
}

FL_INLINE float fl_wf_most(fl_wf v)
{
    return -fl_wf_least(-v);
}

/** Neither infinite nor NaN. */
FL_INLINE fl_wm fl_wf_is_finite(fl_wf a)
{
    return ((fl_wi)a & 0x7fffffff) < 0x7f800000;
}

#endif
