/* SPDX-License-Identifier: MIT */
#include "core/texture.h"

#include <math.h>

typedef struct texel {
    double c[3];
} texel;

static texel texel_at(const fl_image *image, uint32_t column, uint32_t row)
{
    size_t at = 3 * ((size_t)row * image->width + column);
    if (image->format == FL_PIXEL_FLOAT) {
        const float *p = (const float *)image->pixels + at;
        return (texel){{(double)p[0], (double)p[1], (double)p[2]}};
    }
    const uint8_t *p = (const uint8_t *)image->pixels + at;
    texel t;
    for (int i = 0; i < 3; i++)
        t.c[i] = image->format == FL_PIXEL_SRGB8 ? (double)fl_srgb8_to_linear[p[i]]
                                                 : (double)p[i] / 255.0;
    return t;
}

/* Two neighbours along one axis and the weight of the second. */
typedef struct pair {
    uint32_t at[2];
    double weight;
} pair;

/* x in texels, centres at i + 1/2. Clamping x to half a texel inside the edges clamps both
 * neighbours. */
static pair pair_clamped(double x, uint32_t size)
{
    x = fl_clamp(x - 0.5, 0.0, (double)(size - 1));
    double low = floor(x);
    uint32_t i = (uint32_t)low;
    return (pair){{i, fl_min_u32(i + 1, size - 1)}, x - low};
}

/* x in [0, size]. */
static pair pair_repeated(double x, uint32_t size)
{
    x = x < 0.5 ? x + (double)size - 0.5 : x - 0.5;
    double low = floor(x);
    uint32_t i = fl_min_u32((uint32_t)low, size - 1);
    return (pair){{i, i + 1 < size ? i + 1 : 0}, x - low};
}

/* The one texel around x in [0, size]. */
static pair pair_nearest(double x, uint32_t size)
{
    uint32_t i = fl_min_u32((uint32_t)x, size - 1);
    return (pair){{i, i}, 0.0};
}

/* `down` counts rows from the top. */
static void blend(const fl_image *image, pair across, pair down, double out_rgb[3])
{
    texel a = texel_at(image, across.at[0], down.at[0]),
          b = texel_at(image, across.at[1], down.at[0]);
    texel c = texel_at(image, across.at[0], down.at[1]),
          d = texel_at(image, across.at[1], down.at[1]);
    for (int i = 0; i < 3; i++) {
        double top = a.c[i] + across.weight * (b.c[i] - a.c[i]);
        double bottom = c.c[i] + across.weight * (d.c[i] - c.c[i]);
        out_rgb[i] = top + down.weight * (bottom - top);
    }
}

/* A coordinate as a fraction of the picture in [0, 1]. */
static double fraction(double coordinate, float scale, bool clamps)
{
    double x = coordinate * (double)scale;
    if (!isfinite(x))
        return 0.0;
    return clamps ? fl_clamp(x, 0.0, 1.0) : x - floor(x);
}

void fl_texture_eval_double(const fl_texture *texture, double u, double v, double out_rgb[3])
{
    const fl_image *image = texture->image;
    double x = fraction(u, texture->scale[0], false) * (double)image->width;
    double y = (1.0 - fraction(v, texture->scale[1], texture->clamps_v)) * (double)image->height;
    if (texture->filter == FL_FILTER_NEAREST) {
        texel t = texel_at(image, pair_nearest(x, image->width).at[0],
                           pair_nearest(y, image->height).at[0]);
        for (int i = 0; i < 3; i++)
            out_rgb[i] = t.c[i];
        return;
    }
    pair down =
        texture->clamps_v ? pair_clamped(y, image->height) : pair_repeated(y, image->height);
    blend(image, pair_repeated(x, image->width), down, out_rgb);
}

static void round3(const double rgb[3], float out_rgb[3])
{
    for (int i = 0; i < 3; i++)
        out_rgb[i] = (float)rgb[i];
}

void fl_texture_eval(const fl_texture *texture, float u, float v, float out_rgb[3])
{
    double rgb[3];
    fl_texture_eval_double(texture, (double)u, (double)v, rgb);
    round3(rgb, out_rgb);
}

/* Which signed coordinates of d run to the right and up on a face. */
typedef struct face_axes {
    uint8_t main, across, up;
    int8_t across_sign, up_sign, course_across_sign, course_up_sign;
} face_axes;

static const face_axes axes[FL_CUBE_FACES] = {
    [FL_CUBE_RIGHT] = {0, 2, 1, 1, 1, 1, 1},   [FL_CUBE_LEFT] = {0, 2, 1, -1, 1, -1, 1},
    [FL_CUBE_UP] = {1, 0, 2, 1, 1, 1, 1},      [FL_CUBE_DOWN] = {1, 0, 2, 1, -1, 1, 1},
    [FL_CUBE_FRONT] = {2, 0, 1, -1, 1, -1, 1}, [FL_CUBE_BACK] = {2, 0, 1, 1, 1, -1, 1},
};

void fl_cube_eval_double(fl_image *const faces[FL_CUBE_FACES], const double p[3], bool is_course,
                         double out_rgb[3])
{
    double ax = fabs(p[0]), ay = fabs(p[1]), az = fabs(p[2]);
    int face = ax >= ay && ax >= az ? (p[0] < 0.0 ? FL_CUBE_LEFT : FL_CUBE_RIGHT)
               : ay >= az           ? (p[1] < 0.0 ? FL_CUBE_DOWN : FL_CUBE_UP)
                                    : (p[2] < 0.0 ? FL_CUBE_BACK : FL_CUBE_FRONT);
    const face_axes *a = &axes[face];
    double size = fabs(p[a->main]), s = 0.5, t = 0.5;
    if (size > 0.0 && isfinite(ax) && isfinite(ay) && isfinite(az)) {
        s += 0.5 * (double)(is_course ? a->course_across_sign : a->across_sign) *
             (p[a->across] / size);
        t += 0.5 * (double)(is_course ? a->course_up_sign : a->up_sign) * (p[a->up] / size);
    }
    const fl_image *image = faces[face];
    double shift = is_course ? 0.5 : 0.0;
    blend(image, pair_clamped(s * (double)image->width + shift, image->width),
          pair_clamped((1.0 - t) * (double)image->height + shift, image->height), out_rgb);
}

void fl_cube_eval(fl_image *const faces[FL_CUBE_FACES], const float d[3], bool is_course,
                  float out_rgb[3])
{
    const double p[3] = {(double)d[0], (double)d[1], (double)d[2]};
    double rgb[3];
    fl_cube_eval_double(faces, p, is_course, rgb);
    round3(rgb, out_rgb);
}
