/* SPDX-License-Identifier: MIT
 *
 * Numbers behind the pixels as colours, and the optics that decide them. Display only; pure.
 */
#ifndef VW_PAINT_H
#define VW_PAINT_H

#include "viewer/state.h"

/** Diameter of the circle of confusion at that depth in pixels, < 0 nearer than the focus; 0 with a
 * pinhole or an orthographic camera. `height_px`: of the whole picture (decision 10). */
double vw_blur_px(const fl_camera *camera, uint32_t height_px, double depth);

/** Depths between which the blur stays below `blur_px`; far may be infinite. False: everywhere. */
bool vw_sharp_limits(const fl_camera *camera, uint32_t height_px, double blur_px, double *out_near,
                     double *out_far);

/** What a picture of a layer needs besides its values. */
typedef struct vw_paint {
    const fl_camera *camera;
    uint32_t height_px; /**< Of the whole picture. */
    double low, high;   /**< Set by vw_paint_range: what the colours' ends mean. */
} vw_paint;

/** The range of a layer's values (`stride` floats a pixel, the first counts). */
void vw_paint_range(vw_paint *paint, const float *values, size_t stride, size_t pixels);

/** Colour a layer. values: 3 floats a pixel for the aov layers, 1 for samples and error. RGBA out.
 */
void vw_paint_layer(const vw_paint *paint, vw_layer layer, const float *values, size_t pixels,
                    uint8_t *out_rgba);

/** Tint what is blurred by less than a pixel in `rgba`; `depths`: 3 floats a pixel. */
void vw_paint_band(const vw_paint *paint, const float *depths, size_t pixels, uint8_t *rgba);

/** Half a step of an 8-bit picture: a change below is not seen. */
#define VW_VISIBLE_CHANGE (0.5 / 255.0)

/** Dim the picture and colour what changed: dark violet where it cannot be seen, orange to white
 * where it can; green: one of the two values is not a number. */
void vw_paint_changes(const float *changes, size_t pixels, uint8_t *rgba);

/** Present minus pinned about middle grey, and how far they differ. */
typedef struct vw_difference {
    double rmse, largest;
} vw_difference;
void vw_paint_difference(const float *present_rgb, const float *pinned_rgb, size_t pixels,
                         uint8_t *out_rgba, vw_difference *out_difference);

#endif
