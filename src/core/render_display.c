/* SPDX-License-Identifier: MIT
 *
 * The picture for the screen, on the owner's thread. Only means are copied under the lock. Pixels
 * without a sample cost no tone map: their bytes are filled in after it.
 */
#include <stdlib.h>
#include <string.h>

#include "core/render_state.h"

enum { SMOOTH_SAMPLES = 4 }; /* Beyond, the filter would blur more than it takes of the noise. */

size_t fl_display_floats(uint32_t width)
{
    return ((size_t)width + 2) * 4 * (FL_BAND_ROWS + 2);
}

/* How much of each neighbour, to one of itself, a pixel of few samples takes along either axis: a
 * lens or a light of some size leaves noise that the whole [1 2 1] more than halves; without them
 * only the first sample gains, by half of that. 0: shown as it is. */
static float neighbour_share(const fl_render *render, const fl_job *job)
{
    uint32_t samples = fl_schedule_complete_samples(job->schedule);
    if (!render->options.smooths_display || samples == 0 || samples > SMOOTH_SAMPLES)
        return 0.0f;
    bool is_noisy = job->frame->plan.samples_lens;
    for (uint32_t i = 0; i < job->frame->light_count; i++)
        is_noisy |= job->frame->lights[i].draws;
    return is_noisy ? 0.5f : samples == 1 ? 0.25f : 0.0f;
}

/* A row with its first and last pixel twice. */
static void copy_padded_row(const fl_job *job, uint32_t y, float *out_row)
{
    size_t pixel = 3 * sizeof *out_row, last = (size_t)3 * job->width;
    fl_film_row(job->film, 0, y, job->width, out_row + 3);
    memcpy(out_row, out_row + 3, pixel);
    memcpy(out_row + last + 3, out_row + last, pixel);
}

/* A band of padded rows, with one more before and after it. The lock is held. */
static void copy_padded_rows(const fl_job *job, uint32_t begin, uint32_t end, float *out_rows)
{
    size_t stride = ((size_t)job->width + 2) * 3;
    for (uint32_t i = 0; i < end - begin + 2; i++) {
        uint32_t y = begin + i > 0 ? begin + i - 1 : 0;
        copy_padded_row(job, fl_min_u32(y, job->height - 1), out_rows + i * stride);
    }
}

/* [share 1 share] along the row, then across; each result takes the place of the first value that
 * went into it, which nothing after it needs. */
static void smooth(float *rows, uint32_t width, uint32_t count, float share)
{
    size_t stride = ((size_t)width + 2) * 3, floats = (size_t)3 * width;
    float all = 1.0f / ((1.0f + 2.0f * share) * (1.0f + 2.0f * share));
    for (uint32_t y = 0; y < count + 2; y++) {
        float *row = rows + y * stride;
        for (size_t i = 0; i < floats; i++)
            row[i] = share * (row[i] + row[i + 6]) + row[i + 3];
    }
    for (uint32_t y = 0; y < count; y++) {
        float *row = rows + y * stride;
        const float *next = row + stride, *last = next + stride;
        for (size_t i = 0; i < floats; i++)
            row[i] = (share * (row[i] + last[i]) + next[i]) * all;
    }
}

static void scatter(const uint8_t *mapped, size_t pixels, uint8_t *rgba)
{
    for (size_t i = 0; i < pixels; i++)
        if (rgba[4 * i + 3]) {
            memcpy(rgba + 4 * i, mapped, 4);
            mapped += 4;
        }
}

typedef struct band {
    uint32_t begin, end; /* Rows. */
    uint32_t covered;    /* Pixels in `rows`, in a picture with holes. */
    float share;         /* neighbour_share. */
    bool has_holes;
} band;

/* False: the picture is no longer that of `generation`. */
static bool copy_band(fl_render *render, uint64_t generation, band *b, uint8_t *out_rgba)
{
    pthread_mutex_lock(&render->lock);
    const fl_job *job = render->shown;
    bool is_same = job->generation == generation;
    if (is_same) {
        b->has_holes = fl_schedule_complete_samples(job->schedule) == 0;
        b->share = neighbour_share(render, job);
        if (b->has_holes)
            b->covered = fl_film_rows_covered(job->film, b->begin, b->end, render->rows, out_rgba);
        else if (b->share > 0.0f)
            copy_padded_rows(job, b->begin, b->end, render->rows);
        else
            for (uint32_t y = b->begin; y < b->end; y++)
                fl_film_row(job->film, 0, y, job->width,
                            render->rows + (size_t)3 * (y - b->begin) * job->width);
    }
    pthread_mutex_unlock(&render->lock);
    return is_same;
}

static void map_band(fl_render *render, const band *b, uint32_t width, const fl_tonemap *tonemap,
                     uint8_t *out_rgba)
{
    uint32_t count = b->end - b->begin;
    size_t pixels = (size_t)count * width;
    const fl_tonemapper *mapper = render->tonemapper;
    if (b->has_holes) {
        uint8_t *mapped = (uint8_t *)(render->rows + 3 * pixels);
        fl_tonemapper_run(mapper, tonemap, render->rows, b->covered, mapped);
        scatter(mapped, pixels, out_rgba);
        fl_film_fill_holes(out_rgba, width, count);
    } else if (b->share > 0.0f) {
        smooth(render->rows, width, count, b->share);
        for (uint32_t y = 0; y < count; y++)
            fl_tonemapper_run(mapper, tonemap, render->rows + y * ((size_t)width + 2) * 3, width,
                              out_rgba + (size_t)4 * y * width);
    } else {
        fl_tonemapper_run(mapper, tonemap, render->rows, pixels, out_rgba);
    }
}

bool fl_display_picture(fl_render *render, const fl_progress *picture, const fl_tonemap *tonemap,
                        uint8_t *out_rgba)
{
    for (uint32_t y = 0; y < picture->height; y += FL_BAND_ROWS) {
        band b = {.begin = y, .end = fl_min_u32(y + FL_BAND_ROWS, picture->height)};
        uint8_t *rgba = out_rgba + (size_t)4 * y * picture->width;
        if (!copy_band(render, picture->generation, &b, rgba))
            return false;
        map_band(render, &b, picture->width, tonemap, rgba);
    }
    return true;
}
