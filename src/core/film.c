/* SPDX-License-Identifier: MIT */
#include "core/film.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK_SAMPLES = 16, FETCH_AHEAD = 16 };

typedef double rgb_sum[3];

/* `full` is meaningful from 16 samples on, `block` while a block is unfinished; samples and invalid
 * only in rows of the current epoch. They lie apart because adding costs what the memory it touches
 * costs. */
struct fl_film {
    uint32_t width, height;
    uint32_t epoch;      /* Counts fl_film_clear, from 1. */
    uint32_t *row_epoch; /* Per row; another value than `epoch`: the row is empty. */
    rgb_sum *full;       /* Per pixel: of the full blocks. */
    rgb_sum *block;      /* Per pixel: of the samples since the last full block. */
    uint32_t *samples;   /* Per pixel: next sample index. */
    uint32_t *invalid;   /* Per pixel: samples that are not in the sums. */
};

bool fl_film_bytes(uint32_t width, uint32_t height, size_t *out_bytes)
{
    size_t pixels, bytes;
    size_t row = sizeof(uint32_t);
    if (!fl_size_mul(width, height, &pixels) ||
        !fl_size_mul(pixels, 2 * sizeof(rgb_sum) + 2 * sizeof(uint32_t), &bytes) ||
        bytes > SIZE_MAX - sizeof(fl_film) - row * height)
        return false;
    *out_bytes = bytes + sizeof(fl_film) + row * height;
    return true;
}

fl_film *fl_film_create(uint32_t width, uint32_t height)
{
    FL_ASSERT(width > 0 && height > 0);
    size_t bytes;
    if (!fl_film_bytes(width, height, &bytes))
        return NULL;
    fl_film *film = calloc(1, sizeof *film);
    if (!film)
        return NULL;
    size_t pixels = (size_t)width * height;
    film->width = width;
    film->height = height;
    film->epoch = 1;
    film->row_epoch = calloc(height, sizeof *film->row_epoch);
    film->full = malloc(pixels * sizeof *film->full);
    film->block = malloc(pixels * sizeof *film->block);
    film->samples = malloc(pixels * sizeof *film->samples);
    film->invalid = malloc(pixels * sizeof *film->invalid);
    if (!film->row_epoch || !film->full || !film->block || !film->samples || !film->invalid) {
        fl_film_destroy(film);
        return NULL;
    }
    return film;
}

void fl_film_destroy(fl_film *film)
{
    if (!film)
        return;
    free(film->row_epoch);
    free(film->full);
    free(film->block);
    free(film->samples);
    free(film->invalid);
    free(film);
}

void fl_film_clear(fl_film *film)
{
    if (++film->epoch == 0) { /* After 2^32 clears old stamps could look new. */
        memset(film->row_epoch, 0, film->height * sizeof *film->row_epoch);
        film->epoch = 1;
    }
}

uint32_t fl_film_width(const fl_film *film)
{
    return film->width;
}

uint32_t fl_film_height(const fl_film *film)
{
    return film->height;
}

static void wipe_row(fl_film *film, uint32_t y)
{
    size_t begin = (size_t)y * film->width;
    memset(film->samples + begin, 0, film->width * sizeof *film->samples);
    memset(film->invalid + begin, 0, film->width * sizeof *film->invalid);
    film->row_epoch[y] = film->epoch;
}

/* The block that ends with this sample joins the full ones. */
static void end_block(fl_film *film, size_t at, bool is_first)
{
    for (int c = 0; c < 3; c++)
        film->full[at][c] = (is_first ? 0.0 : film->full[at][c]) + film->block[at][c];
}

/* In Bayer order every pixel lies on lines of its own: ask for those of a later one. */
static void fetch_pixel(const fl_film *film, uint32_t x, uint32_t y)
{
    size_t at = (size_t)y * film->width + x;
    __builtin_prefetch(film->block + at, 1);
    __builtin_prefetch(film->samples + at, 1);
}

void fl_film_add(fl_film *film, const fl_unit *unit, const fl_unit_result *result, uint32_t x0,
                 uint32_t y0)
{
    bool starts_block = unit->sample % BLOCK_SAMPLES == 0;
    bool ends_block = unit->sample % BLOCK_SAMPLES == BLOCK_SAMPLES - 1;
    for (uint32_t i = 0; i < unit->count; i++) {
        uint32_t x = unit->x[i] - x0, y = unit->y[i] - y0;
        FL_ASSERT(x < film->width && y < film->height);
        if (i + FETCH_AHEAD < unit->count)
            fetch_pixel(film, unit->x[i + FETCH_AHEAD] - x0, unit->y[i + FETCH_AHEAD] - y0);
        if (film->row_epoch[y] != film->epoch)
            wipe_row(film, y);
        size_t at = (size_t)y * film->width + x;
        FL_ASSERT(film->samples[at] == unit->sample);
        film->samples[at] = unit->sample + 1;
        double *block = film->block[at];
        if (starts_block)
            block[0] = block[1] = block[2] = 0.0;
        if (result->is_valid[i]) {
            block[0] += (double)result->r[i];
            block[1] += (double)result->g[i];
            block[2] += (double)result->b[i];
        } else {
            film->invalid[at]++;
        }
        if (ends_block)
            end_block(film, at, unit->sample < BLOCK_SAMPLES);
    }
}

static bool has_sample(const fl_film *film, uint32_t x, uint32_t y)
{
    return film->row_epoch[y] == film->epoch && film->samples[(size_t)y * film->width + x] > 0;
}

static void pixel_mean(const fl_film *film, size_t at, float *out_rgb)
{
    uint32_t samples = film->samples[at], valid = samples - film->invalid[at];
    bool has_full = samples >= BLOCK_SAMPLES, has_block = samples % BLOCK_SAMPLES != 0;
    for (int c = 0; c < 3; c++) {
        double sum = has_full ? film->full[at][c] : 0.0;
        if (has_block)
            sum += film->block[at][c];
        /* One sample is its own mean: three divisions less for the first pictures. */
        out_rgb[c] = valid > 1 ? (float)(sum / valid) : valid > 0 ? (float)sum : 0.0f;
    }
}

void fl_film_row(const fl_film *film, uint32_t x, uint32_t y, uint32_t count, float *out_rgb)
{
    FL_ASSERT(y < film->height && x + count <= film->width);
    if (film->row_epoch[y] != film->epoch) {
        memset(out_rgb, 0, (size_t)3 * count * sizeof *out_rgb);
        return;
    }
    size_t at = (size_t)y * film->width + x;
    for (uint32_t i = 0; i < count; i++)
        pixel_mean(film, at + i, out_rgb + (size_t)3 * i);
}

void fl_film_samples_row(const fl_film *film, uint32_t x, uint32_t y, uint32_t count,
                         uint32_t *out_samples)
{
    FL_ASSERT(y < film->height && x + count <= film->width);
    for (uint32_t i = 0; i < count; i++)
        out_samples[i] =
            film->row_epoch[y] == film->epoch ? film->samples[(size_t)y * film->width + x + i] : 0;
}

void fl_film_valid_row(const fl_film *film, uint32_t x, uint32_t y, uint32_t count,
                       uint32_t *out_valid)
{
    fl_film_samples_row(film, x, y, count, out_valid);
    for (uint32_t i = 0; i < count; i++)
        if (out_valid[i] > 0)
            out_valid[i] -= film->invalid[(size_t)y * film->width + x + i];
}

void fl_film_mean(const fl_film *film, float *out_rgb)
{
    for (uint32_t y = 0; y < film->height; y++)
        fl_film_row(film, 0, y, film->width, out_rgb + (size_t)3 * y * film->width);
}

/* Most pixels have one sample, which is their block (0 when it was invalid): this is done again and
 * again while workers wait for the lock. */
static uint32_t row_covered(const fl_film *film, uint32_t y, float *out_rgb, uint8_t *out_rgba)
{
    uint32_t covered = 0;
    bool is_empty = film->row_epoch[y] != film->epoch;
    size_t at = (size_t)y * film->width;
    for (uint32_t x = 0; x < film->width; x++, at++) {
        uint32_t samples = is_empty ? 0 : film->samples[at];
        out_rgba[4 * x + 3] = samples ? 255 : 0;
        if (samples == 0)
            continue;
        float *rgb = out_rgb + (size_t)3 * covered++;
        if (samples > 1) {
            pixel_mean(film, at, rgb);
            continue;
        }
        for (int c = 0; c < 3; c++)
            rgb[c] = (float)film->block[at][c];
    }
    return covered;
}

uint32_t fl_film_rows_covered(const fl_film *film, uint32_t row_begin, uint32_t row_end,
                              float *out_rgb, uint8_t *out_rgba)
{
    FL_ASSERT(row_begin <= row_end && row_end <= film->height);
    uint32_t covered = 0;
    for (uint32_t y = row_begin; y < row_end; y++, out_rgba += (size_t)4 * film->width)
        covered += row_covered(film, y, out_rgb + (size_t)3 * covered, out_rgba);
    return covered;
}

void fl_film_fill_holes(uint8_t *rgba, uint32_t width, uint32_t rows)
{
    static const uint8_t black[4] = {0, 0, 0, 255};
    for (uint32_t y = 0; y < rows; y++)
        for (uint32_t x = 0; x < width; x++) {
            uint8_t *pixel = rgba + (size_t)4 * ((size_t)y * width + x);
            if (pixel[3])
                continue;
            /* The corner of the next larger cell has been filled already, if by its own corner. */
            uint32_t both = x | y, mask = both & 1 ? 1 : both & 2 ? 3 : 7;
            const uint8_t *from =
                both & 7 ? rgba + (size_t)4 * ((size_t)(y & ~mask) * width + (x & ~mask)) : black;
            memcpy(pixel, from, 4);
        }
}

uint32_t fl_film_complete_samples(const fl_film *film)
{
    uint32_t least = UINT32_MAX;
    for (uint32_t y = 0; y < film->height; y++) {
        if (film->row_epoch[y] != film->epoch)
            return 0;
        for (uint32_t x = 0; x < film->width; x++)
            least = fl_min_u32(least, film->samples[(size_t)y * film->width + x]);
    }
    return least;
}

uint64_t fl_film_covered_pixels(const fl_film *film)
{
    uint64_t covered = 0;
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            covered += has_sample(film, x, y);
    return covered;
}

void fl_film_set_samples(fl_film *film, const fl_rect *rect, uint32_t samples)
{
    FL_ASSERT(rect->x1 <= film->width && rect->y1 <= film->height);
    for (uint32_t y = rect->y0; y < rect->y1; y++)
        for (uint32_t x = rect->x0; x < rect->x1; x++)
            film->samples[(size_t)y * film->width + x] = samples;
}

void fl_film_pack(fl_film *film, fl_pack *pack)
{
    size_t pixels = (size_t)film->width * film->height;
    for (uint32_t y = 0; pack->mode == FL_PACK_READ && y < film->height; y++)
        film->row_epoch[y] = film->epoch;
    for (size_t i = 0; i < pixels;
         i++) { /* What has no meaning yet is 0, not whatever was there. */
        if (film->samples[i] < BLOCK_SAMPLES)
            memset(film->full[i], 0, sizeof film->full[i]);
        if (film->samples[i] % BLOCK_SAMPLES == 0)
            memset(film->block[i], 0, sizeof film->block[i]);
    }
    fl_pack_bytes(pack, film->full, pixels * sizeof *film->full);
    fl_pack_bytes(pack, film->block, pixels * sizeof *film->block);
    fl_pack_bytes(pack, film->invalid, pixels * sizeof *film->invalid);
    for (size_t i = 0; i < pixels; i++)
        pack->has_failed |= film->invalid[i] > film->samples[i];
}
