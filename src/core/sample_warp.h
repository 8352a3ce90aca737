/* SPDX-License-Identifier: MIT
 *
 * Layer 1: sample numbers in [0, 1)^2 to points of a disc or of a lens aperture, uniform by area
 * and without rejection. fl_f_warp_* for one sample and, where FL_W is defined, fl_wf_warp_* for
 * FL_W; the same bits. The functions stand in sample_warp_body.inc:
 *
 *     warp_disk(u, v, &x, &y)                  unit disc, concentric
 *     warp_aperture(aperture, u, v, &x, &y)    unit disc or regular polygon in it
 *     warp_disk_light(centre, axis_u, axis_v, u, v, point)
 */
#ifndef FL_SAMPLE_WARP_H
#define FL_SAMPLE_WARP_H

#include "core/math64.h"

/** A lens opening of circumradius 1; make it with fl_aperture_make. */
typedef struct fl_aperture {
    uint32_t blades;      /**< Corners; 0: round. */
    float rotation_turns; /**< From the lens' horizontal axis to the first corner, towards the
                             vertical. */
    float rim_x, rim_y;   /**< The second corner when the first is (1, 0). */
} fl_aperture;

/** `blades` is 0 or 3 and more. */
static inline fl_aperture fl_aperture_make(uint32_t blades, double rotation_deg)
{
    fl_aperture aperture = {.blades = blades};
    if (blades > 0) {
        double s, c;
        fl_d_sincos_turns(1.0 / blades, &s, &c);
        aperture.rotation_turns = (float)(rotation_deg / 360.0);
        aperture.rim_x = (float)c;
        aperture.rim_y = (float)s;
    }
    return aperture;
}

static inline float fl_f_set(float x)
{
    return x;
}

static inline float fl_f_select(int32_t mask, float a, float b)
{
    return mask ? a : b;
}

static inline int32_t fl_f_lt(float a, float b)
{
    return -(int32_t)(a < b);
}

static inline int32_t fl_f_eq(float a, float b)
{
    return -(int32_t)(a == b);
}

static inline float fl_f_abs(float x)
{
    return fabsf(x);
}

static inline float fl_f_sqrt(float x)
{
    return sqrtf(x);
}

static inline float fl_f_floor(float x)
{
    return floorf(x);
}

#define FL_WARP_FN   static inline
#define FL_WARP_MASK int32_t
#define F            float
#define FL_F(name)   fl_f_##name
#include "core/sample_warp_body.inc"
#undef FL_WARP_FN
#undef FL_WARP_MASK
#undef F
#undef FL_F

#ifdef FL_W

#include "core/wide_math.h"

FL_INLINE fl_wm fl_wf_lt(fl_wf a, fl_wf b)
{
    return a < b;
}

FL_INLINE fl_wm fl_wf_eq(fl_wf a, fl_wf b)
{
    return a == b;
}

#define FL_WARP_FN   FL_INLINE
#define FL_WARP_MASK fl_wm
#define F            fl_wf
#define FL_F(name)   fl_wf_##name
#include "core/sample_warp_body.inc"
#undef FL_WARP_FN
#undef FL_WARP_MASK
#undef F
#undef FL_F

#endif
#endif
