/* SPDX-License-Identifier: MIT
 *
 * Layer 7: linear radiance to bytes for display and 8-bit files: times 2^EV, clamp to [0, 1], sRGB
 * curve, times 255, round half up (decision 8). Monotone; the same bytes on every machine.
 */
#ifndef FL_TONEMAP_H
#define FL_TONEMAP_H

#include "core/cpu.h"

typedef struct fl_tonemap {
    double exposure_ev; /**< Clamped to +-100. */
    bool truncates;     /**< Course rule: (int)(c * 255), no sRGB, no rounding. */
} fl_tonemap;

/** pixel_count RGB floats to RGBA bytes (alpha 255). NaN becomes 0. Any thread. */
void fl_tonemap_rgba8(const fl_tonemap *tonemap, const float *rgb, size_t pixel_count,
                      uint8_t *out_rgba);

/** The same with the curve's table kept (13 KiB; making it costs as much as mapping some 20,000
 * pixels), for pictures that are mapped again and again in pieces. */
typedef struct fl_tonemapper fl_tonemapper;

/** NULL: out of memory. Immutable: any thread. */
fl_tonemapper *fl_tonemapper_create(void);
void fl_tonemapper_destroy(fl_tonemapper *mapper);
void fl_tonemapper_run(const fl_tonemapper *mapper, const fl_tonemap *tonemap, const float *rgb,
                       size_t pixel_count, uint8_t *out_rgba);

#endif
