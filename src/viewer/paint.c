/* SPDX-License-Identifier: MIT */
#include "viewer/paint.h"

#include <string.h>

/* Sharper than this counts as sharp. */
#define SHARP_PX 1.0
/* Blur at which the colours of the blur layer end. */
#define BLUR_END_PX 32.0
/* Difference at which its colours end, linear. */
#define DIFFERENCE_END 0.125

/* R f_px, half the blur in pixels of a point at half the focus distance; 0: nothing blurs. */
static double lens_strength(const fl_camera *camera, uint32_t height_px)
{
    if (camera->projection != FL_PERSPECTIVE)
        return 0.0;
    return camera->aperture * (double)height_px / (2.0 * fl_d_tan_deg(camera->fov_deg / 2.0));
}

double vw_blur_px(const fl_camera *camera, uint32_t height_px, double depth)
{
    double inverse_focus = isfinite(camera->focus) ? 1.0 / camera->focus : 0.0;
    double inverse_depth = isfinite(depth) && depth > 0.0 ? 1.0 / depth : 0.0;
    return 2.0 * lens_strength(camera, height_px) * (inverse_focus - inverse_depth);
}

bool vw_sharp_limits(const fl_camera *camera, uint32_t height_px, double blur_px, double *out_near,
                     double *out_far)
{
    double strength = lens_strength(camera, height_px);
    if (!(strength > 0.0))
        return false;
    double inverse_focus = isfinite(camera->focus) ? 1.0 / camera->focus : 0.0;
    double slack = blur_px / (2.0 * strength);
    *out_near = 1.0 / (inverse_focus + slack);
    *out_far = inverse_focus > slack ? 1.0 / (inverse_focus - slack) : (double)INFINITY;
    return true;
}

static void put(uint8_t *rgba, double r, double g, double b)
{
    const double rgb[3] = {r, g, b};
    for (int c = 0; c < 3; c++)
        rgba[c] = (uint8_t)(fl_clamp(rgb[c], 0.0, 1.0) * 255.0 + 0.5);
    rgba[3] = 255;
}

/* Dark blue, violet, red, orange, light yellow: brighter all the way, for any eye. */
static void heat(double t, uint8_t *rgba)
{
    static const double stops[5][3] = {{0.02, 0.02, 0.16},
                                       {0.32, 0.07, 0.48},
                                       {0.76, 0.20, 0.38},
                                       {0.98, 0.55, 0.20},
                                       {1.00, 0.98, 0.75}};
    t = fl_clamp(t, 0.0, 1.0) * 4.0;
    int i = t < 4.0 ? (int)t : 3;
    double part = t - i;
    double c[3];
    for (int k = 0; k < 3; k++)
        c[k] = stops[i][k] + part * (stops[i + 1][k] - stops[i][k]);
    put(rgba, c[0], c[1], c[2]);
}

void vw_paint_range(vw_paint *paint, const float *values, size_t stride, size_t pixels)
{
    paint->low = (double)INFINITY;
    paint->high = 0.0;
    for (size_t i = 0; i < pixels; i++) {
        double v = (double)values[i * stride];
        if (!isfinite(v))
            continue;
        paint->low = fl_min(paint->low, v);
        paint->high = fl_max(paint->high, v);
    }
    if (paint->low > paint->high)
        paint->low = 0.0;
}

/* Bright is near; equal steps of 1 / depth, as the lens sees it. Nothing is black. */
static void paint_depth(const vw_paint *paint, double depth, uint8_t *rgba)
{
    double range = 1.0 / paint->low - 1.0 / paint->high;
    double t = isfinite(depth) && range > 0.0 ? (1.0 / depth - 1.0 / paint->high) / range : 0.0;
    double grey = isfinite(depth) ? 0.1 + 0.9 * t : 0.0;
    put(rgba, grey, grey, grey);
}

/* White is sharp; nearer goes to orange, farther to blue, darker the more it is blurred. */
static void paint_blur(const vw_paint *paint, double depth, uint8_t *rgba)
{
    double blur = vw_blur_px(paint->camera, paint->height_px, depth), size = fabs(blur);
    if (size < SHARP_PX) {
        put(rgba, 1.0, 1.0, 1.0);
        return;
    }
    double t = fl_clamp(fl_d_log2(size / SHARP_PX) / fl_d_log2(BLUR_END_PX / SHARP_PX), 0.0, 1.0);
    double dim = 0.95 - 0.7 * t;
    if (blur < 0.0)
        put(rgba, dim, 0.55 * dim, 0.12 * dim);
    else
        put(rgba, 0.2 * dim, 0.5 * dim, dim);
}

static void paint_object(const float *value, uint8_t *rgba)
{
    uint32_t h = fl_lowbias32((uint32_t)value[0]);
    if (value[0] == 0.0f)
        put(rgba, 0.0, 0.0, 0.0);
    else
        put(rgba, 0.25 + (h & 255) / 340.0, 0.25 + (h >> 8 & 255) / 340.0,
            0.25 + (h >> 16 & 255) / 340.0);
}

/* By what adds most: the surface itself yellow, a mirror's blue, glass's green; darker the deeper
 * it lies. */
static void paint_branch(const float *value, uint8_t *rgba)
{
    static const double colors[4][3] = {
        {0.0, 0.0, 0.0}, {0.95, 0.82, 0.45}, {0.35, 0.55, 1.0}, {0.35, 0.9, 0.45}};
    int kind = (int)fl_clamp((double)value[0], 0.0, 3.0);
    double level = (double)value[1], dim = level > 1.0 ? 1.0 / (0.5 + 0.5 * level) : 1.0;
    put(rgba, colors[kind][0] * dim, colors[kind][1] * dim, colors[kind][2] * dim);
}

void vw_paint_layer(const vw_paint *paint, vw_layer layer, const float *values, size_t pixels,
                    uint8_t *out_rgba)
{
    fl_tonemap plain = {0};
    if (layer == VW_LAYER_ALBEDO || layer == VW_LAYER_BEAUTY) {
        fl_tonemap_rgba8(&plain, values, pixels, out_rgba);
        return;
    }
    if (layer == VW_LAYER_BRANCH) {
        for (size_t i = 0; i < pixels; i++)
            paint_branch(values + 3 * i, out_rgba + 4 * i);
        return;
    }
    bool is_single = layer == VW_LAYER_SAMPLES || layer == VW_LAYER_ERROR;
    double high = paint->high > 0.0 ? paint->high : 1.0;
    for (size_t i = 0; i < pixels; i++) {
        const float *v = values + (is_single ? i : 3 * i);
        uint8_t *rgba = out_rgba + 4 * i;
        switch (layer) {
        case VW_LAYER_DEPTH:
            paint_depth(paint, (double)v[0], rgba);
            break;
        case VW_LAYER_NORMAL:
            put(rgba, 0.5 + 0.5 * (double)v[0], 0.5 + 0.5 * (double)v[1], 0.5 + 0.5 * (double)v[2]);
            break;
        case VW_LAYER_BLUR:
            paint_blur(paint, (double)v[0], rgba);
            break;
        case VW_LAYER_OBJECTS:
            paint_object(v, rgba);
            break;
        default:
            heat((double)v[0] / high, rgba);
            break;
        }
    }
}

void vw_paint_band(const vw_paint *paint, const float *depths, size_t pixels, uint8_t *rgba)
{
    for (size_t i = 0; i < pixels; i++) {
        double depth = (double)depths[3 * i];
        if (!isfinite(depth) ||
            fabs(vw_blur_px(paint->camera, paint->height_px, depth)) >= SHARP_PX)
            continue;
        /* Two thirds of a green that no scene has, one third of the picture. */
        uint8_t *p = rgba + 4 * i;
        p[0] = (uint8_t)(p[0] / 3);
        p[1] = (uint8_t)(p[1] / 3 + 168);
        p[2] = (uint8_t)(p[2] / 3 + 52);
    }
}

void vw_paint_changes(const float *changes, size_t pixels, uint8_t *rgba)
{
    for (size_t i = 0; i < pixels; i++) {
        uint8_t *p = rgba + 4 * i;
        double change = (double)changes[i];
        uint8_t grey = (uint8_t)((p[0] * 2 + p[1] * 5 + p[2]) / 8 / 3);
        p[0] = p[1] = p[2] = grey;
        if (isinf(change))
            put(p, 0.2, 1.0, 0.4);
        else if (change > VW_VISIBLE_CHANGE)
            heat(1.0 + 0.5 * fl_d_log2(change) / fl_d_log2(1.0 / VW_VISIBLE_CHANGE), p);
        else if (change > 0.0)
            put(p, grey / 255.0 + 0.08, grey / 255.0, grey / 255.0 + 0.16);
    }
}

void vw_paint_difference(const float *present_rgb, const float *pinned_rgb, size_t pixels,
                         uint8_t *out_rgba, vw_difference *out_difference)
{
    double sum = 0.0, largest = 0.0;
    for (size_t i = 0; i < pixels; i++) {
        double c[3];
        for (size_t k = 0; k < 3; k++) {
            double d = (double)present_rgb[3 * i + k] - (double)pinned_rgb[3 * i + k];
            sum += d * d;
            largest = fl_max(largest, fabs(d));
            c[k] = 0.5 + 0.5 * d / DIFFERENCE_END;
        }
        if (out_rgba)
            put(out_rgba + 4 * i, c[0], c[1], c[2]);
    }
    out_difference->rmse = pixels ? sqrt(sum / (3.0 * (double)pixels)) : 0.0;
    out_difference->largest = largest;
}
