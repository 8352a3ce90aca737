/* SPDX-License-Identifier: MIT
 *
 * Layer 4: linear radiance to bytes, one copy for each instruction set.
 *
 * The curve is a table: the floats from 2^-13 to 1 fall into buckets of 1/128 octave by their
 * leading bits, and no bucket meets more than two bytes. So a value is compared with one threshold,
 * and bytes are exact and monotone by construction.
 */
#ifndef FL_KERNEL_TONEMAP_H
#define FL_KERNEL_TONEMAP_H

#include "core/base.h"

enum {
    FL_CURVE_SHIFT = 23 - 7,          /**< Bits of a float below a bucket's number. */
    FL_CURVE_FIRST = (127 - 13) << 7, /**< Bucket that starts at 2^-13. */
    FL_CURVE_BUCKETS = (127 << 7) - FL_CURVE_FIRST + 1 /**< The last holds only 1. */
};

typedef struct fl_curve {
    float threshold[FL_CURVE_BUCKETS]; /**< From here on the byte is one higher; 2 when that is in
                                          another bucket. */
    uint32_t byte[FL_CURVE_BUCKETS];   /**< At the bucket's beginning. */
} fl_curve;

/** rgb times `gain`, through the curve, to RGBA bytes as tonemap.h says; curve NULL: truncated.
 * out_rgba: 4 * pixel_count. */
typedef void fl_tonemap_kernel(const float *rgb, size_t pixel_count, float gain,
                               const fl_curve *curve, uint8_t *out_rgba);

extern fl_tonemap_kernel fl_tonemap_kernel_scalar;
#if defined(__x86_64__)
extern fl_tonemap_kernel fl_tonemap_kernel_sse2, fl_tonemap_kernel_avx2;
#elif defined(__aarch64__)
extern fl_tonemap_kernel fl_tonemap_kernel_neon;
#endif

#endif
