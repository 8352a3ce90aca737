/* SPDX-License-Identifier: MIT
 *
 * What the texture generators share: a picture of doubles, noise, waves, PNG output. Only plain
 * arithmetic and sqrt and floor are used, so every machine makes the same bytes.
 */
#ifndef PICTURE_H
#define PICTURE_H

#include <stddef.h>
#include <stdint.h>

typedef struct rgb {
    double r, g, b;
} rgb;

/** sRGB colours in [0, 1], row 0 on top. */
typedef struct picture {
    uint32_t width, height;
    rgb *pixels;
} picture;

picture picture_create(uint32_t width, uint32_t height);
/** Write as an uncompressed PNG, so that the bytes depend on no library. Exits with a message on
 * failure. */
void picture_save(const picture *p, const char *path);
/** Read a binary PPM of 8 bits. Exits with a message on failure. */
picture picture_load_ppm(const char *path);

double clamp01(double x);
/** 0 below lo, 1 above hi, smooth between. */
double ramp(double lo, double hi, double x);
double mix(double a, double b, double t);
rgb mix_rgb(rgb a, rgb b, double t);
/** Cosine and sine of an angle in turns. */
double cos_turns(double x);
double sin_turns(double x);
/** A number in [0, 1) that belongs to (x, y, seed). */
double random_at(int32_t x, int32_t y, uint32_t seed);
/** Smooth noise in [0, 1] with cells of size 1, repeating every (period_x, period_y) cells. */
double noise(double x, double y, int32_t period_x, int32_t period_y, uint32_t seed);
/** Octaves of noise, each of half the size and strength of the one before; in [0, 1]. */
double fractal_noise(double x, double y, int32_t period_x, int32_t period_y, int octaves,
                     uint32_t seed);

/* The textures. */
picture make_floor(void);
picture make_wall(void);
picture make_porcelain(void);

#endif
