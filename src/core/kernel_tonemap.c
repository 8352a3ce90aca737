/* SPDX-License-Identifier: MIT
 *
 * Compiled once for each instruction set, with FL_W and FL_ISA defined (wide.h).
 */
#include "core/kernel_tonemap.h"
#include "core/wide.h"

enum { FLOATS = 3 * FL_W }; /* FL_W pixels a turn. */

/* Clamp to [low, 1]; comparisons are false for NaN, which so becomes `low`. */
FL_INLINE fl_wf clamp_to_one(fl_wf x, float low)
{
    fl_wf one = fl_wf_set(1.0f), least = fl_wf_set(low);
    x = fl_wf_select(x > least, x, least);
    return fl_wf_select(x < one, x, one);
}

FL_INLINE fl_wi to_byte(fl_wf x, const fl_curve *curve)
{
    if (!curve)
        return fl_wi_from_wf(clamp_to_one(x, 0.0f) * 255.0f);
    x = clamp_to_one(x, 0x1p-13f);
    fl_wi bucket = ((fl_wi)x >> FL_CURVE_SHIFT) - FL_CURVE_FIRST;
    fl_wm is_above = x >= fl_wf_gather(curve->threshold, bucket);
    return (fl_wi)fl_wu_gather(curve->byte, bucket) - is_above;
}

FL_INLINE void some_pixels(const float *rgb, size_t count, float gain, const fl_curve *curve,
                           uint8_t *out_rgba)
{
    int32_t bytes[FLOATS];
    for (size_t i = 0; i < FLOATS; i += FL_W)
        fl_wi_store(bytes + i, to_byte(fl_wf_load(rgb + i) * gain, curve));
    for (size_t i = 0; i < count; i++) {
        out_rgba[4 * i] = (uint8_t)bytes[3 * i];
        out_rgba[4 * i + 1] = (uint8_t)bytes[3 * i + 1];
        out_rgba[4 * i + 2] = (uint8_t)bytes[3 * i + 2];
        out_rgba[4 * i + 3] = 255;
    }
}

void FL_ISA_NAME(fl_tonemap_kernel)(const float *rgb, size_t pixel_count, float gain,
                                    const fl_curve *curve, uint8_t *out_rgba)
{
    size_t done = 0;
    for (; done + FL_W <= pixel_count; done += FL_W)
        some_pixels(rgb + 3 * done, FL_W, gain, curve, out_rgba + 4 * done);
    if (done < pixel_count) {
        float rest[FLOATS] = {0};
        memcpy(rest, rgb + 3 * done, 3 * (pixel_count - done) * sizeof *rest);
        some_pixels(rest, pixel_count - done, gain, curve, out_rgba + 4 * done);
    }
}
