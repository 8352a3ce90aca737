/* SPDX-License-Identifier: MIT
 *
 * Layer 1: elementary functions of FL_W floats (fl_wf_*) and FL_WD doubles (fl_wd_*), the same bits
 * for every instruction set and compiler and as the scalars of math64.h.
 *
 *     fl_wf_sincos(x, &s, &c) radians · fl_wf_sincos_turns, _eighth · fl_wf_atan2(y, x)
 *     fl_wf_acos · fl_wf_log2 · fl_wf_exp2 · fl_wf_pow · fl_wf_srgb_encode · fl_wf_srgb_decode
 *
 * Domains and special values stand at the double functions in math_body.inc; largest errors are
 * measured by tests/kernel/test_math_error.c --all over every float.
 */
#ifndef FL_WIDE_MATH_H
#define FL_WIDE_MATH_H

#include "core/wide.h"

FL_INLINE fl_wq fl_wd_bits(fl_wd x)
{
    return (fl_wq)x;
}

FL_INLINE fl_wd fl_wd_from_bits(fl_wq bits)
{
    return (fl_wd)bits;
}

FL_INLINE fl_wl fl_wd_lt(fl_wd a, fl_wd b)
{
    return (fl_wl)(a < b);
}

FL_INLINE fl_wl fl_wd_le(fl_wd a, fl_wd b)
{
    return (fl_wl)(a <= b);
}

FL_INLINE fl_wl fl_wd_eq(fl_wd a, fl_wd b)
{
    return (fl_wl)(a == b);
}

#define FL_MATH_FN FL_INLINE
#define D          fl_wd
#define L          fl_wl
#define Q          fl_wq
#define F          fl_wf
#define FL_D(name) fl_wd_##name
#define FL_F(name) fl_wf_##name
#include "core/math_body.inc"
#undef FL_MATH_FN
#undef D
#undef L
#undef Q
#undef F
#undef FL_D
#undef FL_F

#endif
