/* SPDX-License-Identifier: MIT */
#include "picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static _Noreturn void stop(const char *path, const char *why)
{
    fprintf(stderr, "textures: %s: %s\n", path, why);
    exit(4);
}

picture picture_create(uint32_t width, uint32_t height)
{
    picture p = {width, height, calloc((size_t)width * height, sizeof(rgb))};
    if (!p.pixels)
        stop("picture", "out of memory");
    return p;
}

/* ---- PNG [ISO/IEC 15948] with stored deflate blocks ---- */

typedef struct png_writer {
    FILE *file;
    uint32_t crc;
} png_writer;

static uint32_t crc_byte(uint32_t crc, uint8_t byte)
{
    crc ^= byte;
    for (int bit = 0; bit < 8; bit++)
        crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    return crc;
}

static uint32_t crc_table[256];

static void put(png_writer *w, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        w->crc = crc_table[(w->crc ^ bytes[i]) & 0xFF] ^ w->crc >> 8;
    fwrite(bytes, 1, count, w->file);
}

static void put_u32(png_writer *w, uint32_t x)
{
    uint8_t bytes[4] = {(uint8_t)(x >> 24), (uint8_t)(x >> 16), (uint8_t)(x >> 8), (uint8_t)x};
    put(w, bytes, 4);
}

static void begin_chunk(png_writer *w, const char *name, uint32_t bytes)
{
    put_u32(w, bytes);
    w->crc = 0xFFFFFFFFu;
    put(w, (const uint8_t *)name, 4);
}

static void end_chunk(png_writer *w)
{
    put_u32(w, ~w->crc);
}

static uint8_t to_byte(double x)
{
    return (uint8_t)(clamp01(x) * 255.0 + 0.5);
}

/* One stored block a row: each is shorter than 65,536 bytes for up to 21,844 pixels. */
static void put_rows(png_writer *w, const picture *p)
{
    uint32_t row_bytes = 1 + 3 * p->width, a = 1, b = 0;
    uint8_t *row = calloc(1, row_bytes);
    if (!row)
        stop("picture", "out of memory");
    begin_chunk(w, "IDAT", 2 + p->height * (5 + row_bytes) + 4);
    put(w, (const uint8_t[]){0x78, 0x01}, 2);
    for (uint32_t y = 0; y < p->height; y++) {
        const rgb *from = &p->pixels[(size_t)y * p->width];
        for (uint32_t x = 0; x < p->width; x++) {
            row[1 + 3 * x] = to_byte(from[x].r);
            row[2 + 3 * x] = to_byte(from[x].g);
            row[3 + 3 * x] = to_byte(from[x].b);
        }
        for (uint32_t i = 0; i < row_bytes; i++) {
            a = (a + row[i]) % 65521;
            b = (b + a) % 65521;
        }
        uint8_t head[5] = {y + 1 == p->height, (uint8_t)row_bytes, (uint8_t)(row_bytes >> 8),
                           (uint8_t)~row_bytes, (uint8_t)(~row_bytes >> 8)};
        put(w, head, 5);
        put(w, row, row_bytes);
    }
    put_u32(w, b << 16 | a);
    end_chunk(w);
    free(row);
}

void picture_save(const picture *p, const char *path)
{
    png_writer w = {fopen(path, "wb"), 0};
    if (!w.file)
        stop(path, "cannot be written");
    for (uint32_t i = 0; i < 256; i++)
        crc_table[i] = crc_byte(i, 0);
    put(&w, (const uint8_t *)"\x89PNG\r\n\x1a\n", 8);
    begin_chunk(&w, "IHDR", 13);
    put_u32(&w, p->width);
    put_u32(&w, p->height);
    put(&w, (const uint8_t[]){8, 2, 0, 0, 0}, 5); /* 8 bits, RGB */
    end_chunk(&w);
    begin_chunk(&w, "sRGB", 1);
    put(&w, (const uint8_t[]){0}, 1);
    end_chunk(&w);
    put_rows(&w, p);
    begin_chunk(&w, "IEND", 0);
    end_chunk(&w);
    if (ferror(w.file) || fclose(w.file) != 0)
        stop(path, "cannot be written");
}

picture picture_load_ppm(const char *path)
{
    FILE *file = fopen(path, "rb");
    unsigned width = 0, height = 0, limit = 0;
    if (!file || fscanf(file, "P6 %u %u %u", &width, &height, &limit) != 3 || limit != 255 ||
        width == 0 || height == 0 || width > 16384 || height > 16384 || fgetc(file) == EOF)
        stop(path, "is not a binary PPM of 8 bits");
    picture p = picture_create(width, height);
    for (size_t i = 0; i < (size_t)width * height; i++) {
        uint8_t c[3];
        if (fread(c, 1, 3, file) != 3)
            stop(path, "ends too early");
        p.pixels[i] = (rgb){c[0] / 255.0, c[1] / 255.0, c[2] / 255.0};
    }
    fclose(file);
    return p;
}

/* ---- Arithmetic ---- */

double clamp01(double x)
{
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
}

double ramp(double lo, double hi, double x)
{
    double t = clamp01((x - lo) / (hi - lo));
    return t * t * (3.0 - 2.0 * t);
}

double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

rgb mix_rgb(rgb a, rgb b, double t)
{
    return (rgb){mix(a.r, b.r, t), mix(a.g, b.g, t), mix(a.b, b.b, t)};
}

/* Taylor series about 0 on a quarter turn; more than enough for 8 bits. */
double sin_turns(double x)
{
    x -= floor(x + 0.5);
    if (x > 0.25)
        x = 0.5 - x;
    else if (x < -0.25)
        x = -0.5 - x;
    double a = x * 6.283185307179586, s = a * a;
    return a * (1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72 * (1 - s / 110)))));
}

double cos_turns(double x)
{
    return sin_turns(x + 0.25);
}

static uint32_t scramble(uint32_t x)
{
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return x ^ x >> 16;
}

double random_at(int32_t x, int32_t y, uint32_t seed)
{
    uint32_t h = scramble(seed + 0x9E3779B9u);
    h = scramble(h ^ ((uint32_t)x * 0x9E3779B9u + 0x7F4A7C15u));
    h = scramble(h ^ ((uint32_t)y * 0x9E3779B9u + 0x7F4A7C15u));
    return (h >> 8) / 16777216.0;
}

static int32_t wrap(int32_t x, int32_t period)
{
    return (x % period + period) % period;
}

double noise(double x, double y, int32_t period_x, int32_t period_y, uint32_t seed)
{
    double fx = floor(x), fy = floor(y), tx = ramp(0, 1, x - fx), ty = ramp(0, 1, y - fy);
    int32_t x0 = wrap((int32_t)fx, period_x), x1 = wrap((int32_t)fx + 1, period_x);
    int32_t y0 = wrap((int32_t)fy, period_y), y1 = wrap((int32_t)fy + 1, period_y);
    double below = mix(random_at(x0, y0, seed), random_at(x1, y0, seed), tx);
    double above = mix(random_at(x0, y1, seed), random_at(x1, y1, seed), tx);
    return mix(below, above, ty);
}

double fractal_noise(double x, double y, int32_t period_x, int32_t period_y, int octaves,
                     uint32_t seed)
{
    double sum = 0, weight = 1, total = 0;
    for (int i = 0; i < octaves; i++) {
        sum += weight * noise(x, y, period_x, period_y, seed + (uint32_t)i);
        total += weight;
        x *= 2;
        y *= 2;
        period_x *= 2;
        period_y *= 2;
        weight *= 0.5;
    }
    return sum / total;
}
