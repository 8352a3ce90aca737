/* SPDX-License-Identifier: MIT
 *
 * Symbols and numbers are those of the paper (study_flip.h). Two pipelines meet at the end: colours
 * as a far-off eye blurs them, compared by hue and lightness, and edges and points, found in the
 * lightness. Filters are sums of products of one-dimensional ones.
 */
#include "cli/study_flip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PIXELS_PER_DEGREE 67.0
#define PI                3.14159265358979323846
#define FEATURE_WIDTH     0.082 /* Degrees: w of the paper. */
#define EXPONENT_COLOR    0.7   /* q_c */
#define EXPONENT_FEATURE  0.5   /* q_f */
#define KNEE_AT           0.4   /* p_c: this share of the largest difference ... */
#define KNEE_TO           0.95  /* p_t: ... becomes this error. */

enum { RADIUS_MAX = 10, PLANES = 3 };

/* Contrast sensitivity of an opponent channel: a1 and b1, a2 and b2 are one Gaussian each. */
static const double sensitivity[PLANES][4] = {
    {1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};

typedef struct kernel {
    double tap[2 * RADIUS_MAX + 1];
    int radius;
} kernel;

/* What is known of one picture. */
typedef struct view {
    float *lab[PLANES];       /* Blurred; Hunt-adjusted CIELAB. */
    float *edge_x, *edge_y;   /* First derivatives of the lightness, */
    float *point_x, *point_y; /* and second ones. */
} view;

enum { VIEW_PLANES = 7, SCRATCH_PLANES = 5 };

struct study_flip {
    uint32_t width, height;
    double gain, largest; /* largest: difference of colours, to the power of q_c. */
    float *memory;
    view reference, test;
    float *scratch[SCRATCH_PLANES];
};

/* --- Colours ---------------------------------------------------------------------------------- */

static const double white[3] = {0.950428545, 1.0, 1.088900371};

static void xyz_of(const double rgb[3], double out[3])
{
    static const double m[3][3] = {{0.4123907993, 0.3575843394, 0.1804807884},
                                   {0.2126390059, 0.7151686788, 0.0721923154},
                                   {0.0193308187, 0.1191947798, 0.9505321522}};
    for (int i = 0; i < 3; i++)
        out[i] = (m[i][0] * rgb[0] + m[i][1] * rgb[1] + m[i][2] * rgb[2]) / white[i];
}

/* Of XYZ over that of white, to RGB, clamped to what a screen can show. */
static void shown_of(const double xyz[3], double out[3])
{
    static const double m[3][3] = {{3.2409699419, -1.5373831776, -0.4986107603},
                                   {-0.9692436363, 1.8759675015, 0.0415550574},
                                   {0.0556300797, -0.2039769589, 1.0569715142}};
    double a[3] = {xyz[0] * white[0], xyz[1] * white[1], xyz[2] * white[2]};
    for (int i = 0; i < 3; i++)
        out[i] = fl_clamp(m[i][0] * a[0] + m[i][1] * a[1] + m[i][2] * a[2], 0.0, 1.0);
}

/* The linear opponent space in which eyes blur: lightness, red-green, blue-yellow. */
static void opponents_of(const double rgb[3], double out[3])
{
    double xyz[3];
    xyz_of(rgb, xyz);
    out[0] = 116.0 * xyz[1] - 16.0;
    out[1] = 500.0 * (xyz[0] - xyz[1]);
    out[2] = 200.0 * (xyz[1] - xyz[2]);
}

static double root_of(double t)
{
    double delta = 6.0 / 29.0;
    return t > delta * delta * delta ? cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0;
}

/* CIELAB, its colours paler where it is darker, as Hunt found. */
static void lab_of(const double rgb[3], double out[3])
{
    double xyz[3];
    xyz_of(rgb, xyz);
    double x = root_of(xyz[0]), y = root_of(xyz[1]), z = root_of(xyz[2]);
    out[0] = 116.0 * y - 16.0;
    out[1] = 0.01 * out[0] * 500.0 * (x - y);
    out[2] = 0.01 * out[0] * 200.0 * (y - z);
}

static double distance(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]);
}

/* --- Filters ---------------------------------------------------------------------------------- */

static void gaussian(double sigma, int radius, kernel *out)
{
    out->radius = radius;
    for (int i = -radius; i <= radius; i++)
        out->tap[i + radius] = exp(-i * i / (2.0 * sigma * sigma));
}

static void scale(kernel *k, double factor)
{
    for (int i = 0; i <= 2 * k->radius; i++)
        k->tap[i] *= factor;
}

static double sum_of(const kernel *k)
{
    double sum = 0.0;
    for (int i = 0; i <= 2 * k->radius; i++)
        sum += k->tap[i];
    return sum;
}

/* Taps above 0 add up to 1, those below to -1. */
static void balance(kernel *k)
{
    double above = 0.0, below = 0.0;
    for (int i = 0; i <= 2 * k->radius; i++)
        *(k->tap[i] > 0.0 ? &above : &below) += fabs(k->tap[i]);
    for (int i = 0; i <= 2 * k->radius; i++)
        k->tap[i] /= k->tap[i] > 0.0 ? above : below;
}

/* One row or column, its ends held. */
static void filter_line(const float *from, size_t stride, int count, const kernel *k, float *out)
{
    for (int i = 0; i < count; i++) {
        double sum = 0.0;
        for (int j = -k->radius; j <= k->radius; j++) {
            int at = i + j < 0 ? 0 : i + j >= count ? count - 1 : i + j;
            sum += k->tap[j + k->radius] * (double)from[(size_t)at * stride];
        }
        out[(size_t)i * stride] = (float)sum;
    }
}

static void filter(study_flip *f, const float *from, const kernel *along_x, const kernel *along_y,
                   float *out)
{
    float *half = f->scratch[SCRATCH_PLANES - 1];
    for (uint32_t y = 0; y < f->height; y++)
        filter_line(from + (size_t)y * f->width, 1, (int)f->width, along_x,
                    half + (size_t)y * f->width);
    for (uint32_t x = 0; x < f->width; x++)
        filter_line(half + x, f->width, (int)f->height, along_y, out + x);
}

/* Blur one channel, in place, as its contrast sensitivity says. */
static void blur(study_flip *f, const double s[4], float *plane)
{
    size_t pixels = (size_t)f->width * f->height;
    double weight[2], total = 0.0;
    kernel part[2];
    int count = s[2] > 0.0 ? 2 : 1;
    for (int i = 0; i < count; i++) {
        double sigma = sqrt(s[2 * i + 1] / (2.0 * PI * PI)) * PIXELS_PER_DEGREE;
        gaussian(sigma, RADIUS_MAX, &part[i]);
        double sum = sum_of(&part[i]);
        weight[i] = s[2 * i] * sqrt(PI / s[2 * i + 1]) * sum * sum;
        scale(&part[i], 1.0 / sum);
        total += weight[i];
    }
    float *blurred = f->scratch[PLANES];
    memcpy(f->scratch[0], plane, pixels * sizeof *plane);
    memset(plane, 0, pixels * sizeof *plane);
    for (int i = 0; i < count; i++) {
        filter(f, f->scratch[0], &part[i], &part[i], blurred);
        for (size_t k = 0; k < pixels; k++)
            plane[k] += (float)(weight[i] / total) * blurred[k];
    }
}

/* Edges and points of the lightness, both in x and in y. */
static void find_features(study_flip *f, const float *lightness, view *out)
{
    double sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    int radius = (int)ceil(3.0 * sigma);
    kernel smooth, edge, point;
    gaussian(sigma, radius, &smooth);
    edge = point = smooth;
    for (int i = -radius; i <= radius; i++) {
        edge.tap[i + radius] *= -i;
        point.tap[i + radius] *= i * i / (sigma * sigma) - 1.0;
    }
    scale(&smooth, 1.0 / sum_of(&smooth));
    balance(&edge);
    balance(&point);
    filter(f, lightness, &edge, &smooth, out->edge_x);
    filter(f, lightness, &smooth, &edge, out->edge_y);
    filter(f, lightness, &point, &smooth, out->point_x);
    filter(f, lightness, &smooth, &point, out->point_y);
}

/* --- The whole -------------------------------------------------------------------------------- */

static void look(study_flip *f, const float *picture, view *out)
{
    size_t pixels = (size_t)f->width * f->height;
    float *lightness = f->scratch[1];
    for (size_t i = 0; i < pixels; i++) {
        double rgb[3], opponents[3];
        for (int c = 0; c < 3; c++)
            rgb[c] = fl_clamp(f->gain * (double)picture[3 * i + (size_t)c], 0.0, 1.0);
        opponents_of(rgb, opponents);
        for (int c = 0; c < PLANES; c++)
            out->lab[c][i] = (float)opponents[c];
        lightness[i] = (float)((opponents[0] + 16.0) / 116.0);
    }
    find_features(f, lightness, out);
    for (int c = 0; c < PLANES; c++)
        blur(f, sensitivity[c], out->lab[c]);
    for (size_t i = 0; i < pixels; i++) {
        double y = ((double)out->lab[0][i] + 16.0) / 116.0, rgb[3], lab[3];
        double xyz[3] = {(double)out->lab[1][i] / 500.0 + y, y, y - (double)out->lab[2][i] / 200.0};
        shown_of(xyz, rgb);
        lab_of(rgb, lab);
        for (int c = 0; c < PLANES; c++)
            out->lab[c][i] = (float)lab[c];
    }
}

/* Of green and blue, which are farthest apart. */
static double largest_difference(void)
{
    double green[3], blue[3];
    lab_of((double[3]){0.0, 1.0, 0.0}, green);
    lab_of((double[3]){0.0, 0.0, 1.0}, blue);
    return pow(distance(green, blue), EXPONENT_COLOR);
}

static float *carve(float **memory, size_t pixels)
{
    float *plane = *memory;
    *memory += pixels;
    return plane;
}

static void view_place(view *v, float **memory, size_t pixels)
{
    for (int c = 0; c < PLANES; c++)
        v->lab[c] = carve(memory, pixels);
    v->edge_x = carve(memory, pixels);
    v->edge_y = carve(memory, pixels);
    v->point_x = carve(memory, pixels);
    v->point_y = carve(memory, pixels);
}

study_flip *study_flip_create(const float *reference, uint32_t width, uint32_t height,
                              double exposure_ev)
{
    size_t pixels = (size_t)width * height;
    study_flip *f = calloc(1, sizeof *f);
    float *memory = malloc((2 * VIEW_PLANES + SCRATCH_PLANES) * pixels * sizeof *memory);
    if (!f || !memory) {
        free(f);
        free(memory);
        return NULL;
    }
    *f = (study_flip){.width = width,
                      .height = height,
                      .gain = exp2(exposure_ev),
                      .largest = largest_difference(),
                      .memory = memory};
    view_place(&f->reference, &memory, pixels);
    view_place(&f->test, &memory, pixels);
    for (int i = 0; i < SCRATCH_PLANES; i++)
        f->scratch[i] = carve(&memory, pixels);
    look(f, reference, &f->reference);
    return f;
}

void study_flip_destroy(study_flip *flip)
{
    if (flip)
        free(flip->memory);
    free(flip);
}

static double color_error(const study_flip *f, size_t i)
{
    double a[3], b[3];
    for (int c = 0; c < PLANES; c++) {
        a[c] = (double)f->reference.lab[c][i];
        b[c] = (double)f->test.lab[c][i];
    }
    double error = pow(distance(a, b), EXPONENT_COLOR), knee = KNEE_AT * f->largest;
    if (error < knee)
        return KNEE_TO / knee * error;
    return KNEE_TO + (error - knee) / (f->largest - knee) * (1.0 - KNEE_TO);
}

static double length_difference(const float *ax, const float *ay, const float *bx, const float *by,
                                size_t i)
{
    return fabs(hypot((double)ax[i], (double)ay[i]) - hypot((double)bx[i], (double)by[i]));
}

double study_flip_mean(study_flip *f, const float *picture)
{
    const view *a = &f->reference, *b = &f->test;
    size_t pixels = (size_t)f->width * f->height;
    double sum = 0.0;
    look(f, picture, &f->test);
    for (size_t i = 0; i < pixels; i++) {
        double edge = length_difference(a->edge_x, a->edge_y, b->edge_x, b->edge_y, i);
        double point = length_difference(a->point_x, a->point_y, b->point_x, b->point_y, i);
        double feature = pow(fl_max(edge, point) / sqrt(2.0), EXPONENT_FEATURE);
        sum += pow(fl_min(color_error(f, i), 1.0), 1.0 - fl_min(feature, 1.0));
    }
    return sum / (double)pixels;
}
