/* SPDX-License-Identifier: MIT */
#include "core/schedule.h"

#include <stdlib.h>
#include <string.h>

/* More than anybody renders, and far from where counting wraps. */
enum { PACKED_SAMPLES_MAX = 1 << 30 };

typedef struct tile {
    uint16_t x0, y0, x1, y1;
    uint32_t samples; /* Committed. */
} tile;

typedef struct cell {
    uint16_t x0, y0, x1, y1;
    uint32_t first_tile; /* Its tiles are [first_tile, first_tile of the next cell), centre-out. */
    uint32_t units_left; /* Of sample 0, not committed. */
} cell;

/* Ranks of sample 0 that go out together: those from first_rank to the next wave's are all pixels
 * `step` apart. A cell is cut into parts * parts units of up to 1024 pixels. */
typedef struct wave {
    uint32_t first_rank, step, parts;
} wave;

enum { WAVES = 10 };

static const wave waves[WAVES + 1] = {{0, 8, 1},
                                      {1, 8, 1},
                                      {2, 8, 1},
                                      {3, 8, 1},
                                      {4, 4, 1},
                                      {8, 4, 1},
                                      {12, 4, 1},
                                      {16, 2, 2},
                                      {32, 2, 2},
                                      {48, 2, 2},
                                      {FL_BAYER_RANKS, 1, 1}};

struct fl_schedule {
    uint32_t width, height, cell_count, tile_count;
    cell *cells; /* Centre-out; one more than cell_count, to end the last. */
    tile *tiles;
    uint32_t *queue; /* Ring of the tiles that may go next, by samples, then first come. */
    uint32_t queue_head, queue_count;
    uint32_t next_wave, next_unit; /* Of sample 0. */
    uint32_t cap;
    uint32_t furthest;                       /* Most samples that any tile has or is getting. */
    uint32_t complete_samples, behind_count; /* Tiles with exactly complete_samples. */
    uint32_t wave_units_left[WAVES];
    uint32_t complete_waves;
    uint64_t total_samples;
};

uint32_t fl_bayer_rank(uint32_t x, uint32_t y)
{
    uint32_t rank = 0;
    for (uint32_t bit = 0; bit < 3; bit++)
        rank = rank << 2 | (((x ^ y) >> bit) & 1u) << 1 | ((y >> bit) & 1u);
    return rank;
}

/* The inverse: where in its 8 x 8 block the pixel of a rank stands. */
static void bayer_position(uint32_t rank, uint32_t *out_x, uint32_t *out_y)
{
    uint32_t x = 0, y = 0;
    for (uint32_t bit = 0; bit < 3; bit++) {
        uint32_t pair = rank >> (4 - 2 * bit) & 3u;
        y |= (pair & 1u) << bit;
        x |= ((pair >> 1 ^ pair) & 1u) << bit;
    }
    *out_x = x;
    *out_y = y;
}

static uint32_t tile_side(uint32_t width, uint32_t height)
{
    uint32_t count = fl_ceil_div(width, FL_TILE_SIDE) * fl_ceil_div(height, FL_TILE_SIDE);
    return count < FL_TILES_FEW ? FL_TILE_SIDE / 2 : FL_TILE_SIDE;
}

bool fl_schedule_bytes(uint32_t width, uint32_t height, size_t *out_bytes)
{
    if (width > UINT16_MAX || height > UINT16_MAX)
        return false;
    size_t cells = (size_t)fl_ceil_div(width, FL_CELL_SIDE) * fl_ceil_div(height, FL_CELL_SIDE);
    uint32_t side = tile_side(width, height);
    size_t tiles = (size_t)fl_ceil_div(width, side) * fl_ceil_div(height, side);
    *out_bytes = sizeof(fl_schedule) + (cells + 1) * sizeof(cell) +
                 tiles * (sizeof(tile) + sizeof(uint32_t));
    return true;
}

/* A rectangle to be sorted by the distance of its centre from the picture's. */
typedef struct placed {
    fl_rect rect;
    uint64_t distance;
} placed;

static int nearer(const void *a, const void *b)
{
    const placed *p = a, *q = b;
    if (p->distance != q->distance)
        return p->distance < q->distance ? -1 : 1;
    if (p->rect.y0 != q->rect.y0)
        return p->rect.y0 < q->rect.y0 ? -1 : 1;
    return p->rect.x0 < q->rect.x0 ? -1 : p->rect.x0 > q->rect.x0;
}

/* Cut `area` into squares of `side`, sorted centre-out; returns how many. */
static uint32_t cut(const fl_schedule *schedule, fl_rect area, uint32_t side, placed *out)
{
    uint32_t count = 0;
    for (uint32_t y = area.y0; y < area.y1; y += side)
        for (uint32_t x = area.x0; x < area.x1; x += side) {
            fl_rect r = {x, y, fl_min_u32(x + side, area.x1), fl_min_u32(y + side, area.y1)};
            int64_t dx = (int64_t)r.x0 + r.x1 - schedule->width;
            int64_t dy = (int64_t)r.y0 + r.y1 - schedule->height;
            out[count++] = (placed){r, (uint64_t)(dx * dx + dy * dy)};
        }
    qsort(out, count, sizeof *out, nearer);
    return count;
}

/* Fill cells and tiles. `scratch` holds all cells and then the tiles of one. */
static void lay_out(fl_schedule *schedule, uint32_t side, placed *scratch)
{
    fl_rect whole = {0, 0, schedule->width, schedule->height};
    uint32_t cell_count = cut(schedule, whole, FL_CELL_SIDE, scratch), tile_count = 0;
    FL_ASSERT(cell_count == schedule->cell_count);
    placed *parts = scratch + cell_count;
    for (uint32_t c = 0; c < cell_count; c++) {
        fl_rect r = scratch[c].rect;
        schedule->cells[c] =
            (cell){(uint16_t)r.x0, (uint16_t)r.y0, (uint16_t)r.x1, (uint16_t)r.y1, tile_count, 0};
        uint32_t part_count = cut(schedule, r, side, parts);
        for (uint32_t i = 0; i < part_count; i++) {
            fl_rect t = parts[i].rect;
            schedule->tiles[tile_count++] =
                (tile){(uint16_t)t.x0, (uint16_t)t.y0, (uint16_t)t.x1, (uint16_t)t.y1, 0};
        }
    }
    schedule->cells[cell_count].first_tile = tile_count;
    FL_ASSERT(tile_count == schedule->tile_count);
}

fl_schedule *fl_schedule_create(uint32_t width, uint32_t height)
{
    FL_ASSERT(width > 0 && height > 0 && width <= UINT16_MAX && height <= UINT16_MAX);
    fl_schedule *schedule = calloc(1, sizeof *schedule);
    if (!schedule)
        return NULL;
    uint32_t side = tile_side(width, height);
    schedule->width = width;
    schedule->height = height;
    schedule->cell_count = fl_ceil_div(width, FL_CELL_SIDE) * fl_ceil_div(height, FL_CELL_SIDE);
    schedule->tile_count = fl_ceil_div(width, side) * fl_ceil_div(height, side);
    schedule->cap = UINT32_MAX;
    uint32_t cell_tiles = FL_CELL_SIDE / side * (FL_CELL_SIDE / side);
    schedule->cells = calloc(schedule->cell_count + 1, sizeof *schedule->cells);
    schedule->tiles = calloc(schedule->tile_count, sizeof *schedule->tiles);
    schedule->queue = calloc(schedule->tile_count, sizeof *schedule->queue);
    placed *scratch = calloc(schedule->cell_count + cell_tiles, sizeof *scratch);
    if (!schedule->cells || !schedule->tiles || !schedule->queue || !scratch) {
        free(scratch);
        fl_schedule_destroy(schedule);
        return NULL;
    }
    lay_out(schedule, side, scratch);
    free(scratch);
    fl_schedule_reset(schedule);
    return schedule;
}

void fl_schedule_destroy(fl_schedule *schedule)
{
    if (!schedule)
        return;
    free(schedule->cells);
    free(schedule->tiles);
    free(schedule->queue);
    free(schedule);
}

static uint32_t wave_units(const fl_schedule *schedule, uint32_t w)
{
    return schedule->cell_count * waves[w].parts * waves[w].parts;
}

/* Unit `unit` of a wave, cell by cell; false when the cell is too small to have it. */
static bool wave_unit(const fl_schedule *schedule, uint32_t w, uint32_t unit, fl_work *out_work)
{
    uint32_t parts = waves[w].parts, side = FL_CELL_SIDE / parts, part = unit % (parts * parts);
    uint32_t index = unit / (parts * parts), x, y;
    const cell *c = &schedule->cells[index];
    uint32_t x0 = c->x0 + part % parts * side, y0 = c->y0 + part / parts * side;
    bayer_position(waves[w].first_rank, &x, &y);
    *out_work = (fl_work){
        .rect = {x0 + x, y0 + y, fl_min_u32(x0 + side, c->x1), fl_min_u32(y0 + side, c->y1)},
        .step = waves[w].step,
        .index = index,
        .rank = waves[w].first_rank};
    return out_work->rect.x0 < out_work->rect.x1 && out_work->rect.y0 < out_work->rect.y1;
}

/* Move past the units of sample 0 that have no pixels. */
static void skip_empty_units(fl_schedule *schedule)
{
    fl_work work;
    while (schedule->next_wave < WAVES) {
        if (schedule->next_unit == wave_units(schedule, schedule->next_wave)) {
            schedule->next_wave++;
            schedule->next_unit = 0;
        } else if (wave_unit(schedule, schedule->next_wave, schedule->next_unit, &work)) {
            return;
        } else {
            schedule->next_unit++;
        }
    }
}

static void advance_waves(fl_schedule *schedule)
{
    while (schedule->complete_waves < WAVES &&
           schedule->wave_units_left[schedule->complete_waves] == 0)
        schedule->complete_waves++;
}

void fl_schedule_reset(fl_schedule *schedule)
{
    for (uint32_t i = 0; i < schedule->tile_count; i++)
        schedule->tiles[i].samples = 0;
    for (uint32_t c = 0; c < schedule->cell_count; c++)
        schedule->cells[c].units_left = 0;
    for (uint32_t w = 0; w < WAVES; w++) {
        schedule->wave_units_left[w] = 0;
        for (uint32_t unit = 0; unit < wave_units(schedule, w); unit++) {
            fl_work work;
            if (wave_unit(schedule, w, unit, &work)) {
                schedule->cells[work.index].units_left++;
                schedule->wave_units_left[w]++;
            }
        }
    }
    schedule->queue_head = schedule->queue_count = 0;
    schedule->next_wave = schedule->next_unit = 0;
    schedule->furthest = 1;
    schedule->complete_samples = 0;
    schedule->behind_count = schedule->tile_count;
    schedule->complete_waves = 0;
    schedule->total_samples = 0;
    skip_empty_units(schedule);
}

void fl_schedule_set_cap(fl_schedule *schedule, uint32_t samples)
{
    schedule->cap = fl_max_u32(samples, 1);
}

static uint32_t *queue_at(const fl_schedule *schedule, uint32_t position)
{
    uint64_t at = (uint64_t)schedule->queue_head + position;
    return &schedule->queue[at % schedule->tile_count];
}

/* Insert behind the last tile that has no more samples: at the end, unless this tile was slow. */
static void enqueue(fl_schedule *schedule, uint32_t index)
{
    uint32_t at = schedule->queue_count++;
    FL_ASSERT(at < schedule->tile_count);
    for (; at > 0; at--) {
        uint32_t before = *queue_at(schedule, at - 1);
        if (schedule->tiles[before].samples <= schedule->tiles[index].samples)
            break;
        *queue_at(schedule, at) = before;
    }
    *queue_at(schedule, at) = index;
}

static bool has_unit_of_sample_0(const fl_schedule *schedule)
{
    return schedule->next_wave < WAVES;
}

static bool has_tile(const fl_schedule *schedule)
{
    return schedule->queue_count > 0 && schedule->tiles[*queue_at(schedule, 0)].samples <
                                            fl_max_u32(schedule->cap, schedule->furthest);
}

bool fl_schedule_has_work(const fl_schedule *schedule)
{
    return has_unit_of_sample_0(schedule) || has_tile(schedule);
}

bool fl_schedule_next(fl_schedule *schedule, fl_work *out_work)
{
    if (has_unit_of_sample_0(schedule)) {
        wave_unit(schedule, schedule->next_wave, schedule->next_unit, out_work);
        schedule->next_unit++;
        skip_empty_units(schedule);
        return true;
    }
    if (!has_tile(schedule))
        return false;
    uint32_t index = *queue_at(schedule, 0);
    schedule->queue_head = (schedule->queue_head + 1) % schedule->tile_count;
    schedule->queue_count--;
    const tile *t = &schedule->tiles[index];
    *out_work = (fl_work){{t->x0, t->y0, t->x1, t->y1}, 1, t->samples, index, 0};
    schedule->furthest = fl_max_u32(schedule->furthest, t->samples + 1);
    return true;
}

static void advance_tile(fl_schedule *schedule, uint32_t index)
{
    uint32_t before = schedule->tiles[index].samples++;
    enqueue(schedule, index);
    if (before != schedule->complete_samples || --schedule->behind_count > 0)
        return;
    schedule->complete_samples++;
    for (uint32_t i = 0; i < schedule->tile_count; i++)
        schedule->behind_count += schedule->tiles[i].samples == schedule->complete_samples;
}

static uint32_t steps(uint32_t begin, uint32_t end, uint32_t step)
{
    return fl_ceil_div(end - begin, step);
}

bool fl_schedule_commit(fl_schedule *schedule, const fl_work *work, fl_rect *out_rect)
{
    schedule->total_samples += (uint64_t)steps(work->rect.x0, work->rect.x1, work->step) *
                               steps(work->rect.y0, work->rect.y1, work->step);
    if (work->sample > 0) {
        FL_ASSERT(schedule->tiles[work->index].samples == work->sample);
        advance_tile(schedule, work->index);
        *out_rect = work->rect;
        return true;
    }
    uint32_t w = 0;
    while (waves[w].first_rank != work->rank)
        w++;
    schedule->wave_units_left[w]--;
    advance_waves(schedule);
    cell *c = &schedule->cells[work->index];
    FL_ASSERT(c->units_left > 0);
    if (--c->units_left > 0)
        return false;
    for (uint32_t i = c->first_tile; i < c[1].first_tile; i++)
        advance_tile(schedule, i);
    *out_rect = (fl_rect){c->x0, c->y0, c->x1, c->y1};
    return true;
}

uint32_t fl_work_pixels(const fl_work *work, uint32_t x0, uint32_t y0, uint16_t *out_x,
                        uint16_t *out_y)
{
    uint32_t square = 8 * work->step, count = 0;
    for (uint32_t by = work->rect.y0; by < work->rect.y1; by += square)
        for (uint32_t bx = work->rect.x0; bx < work->rect.x1; bx += square) {
            uint32_t end_x = fl_min_u32(bx + square, work->rect.x1);
            uint32_t end_y = fl_min_u32(by + square, work->rect.y1);
            for (uint32_t y = by; y < end_y; y += work->step)
                for (uint32_t x = bx; x < end_x; x += work->step) {
                    out_x[count] = (uint16_t)(x0 + x);
                    out_y[count++] = (uint16_t)(y0 + y);
                }
        }
    return count;
}

uint32_t fl_schedule_complete_samples(const fl_schedule *schedule)
{
    return schedule->complete_samples;
}

uint32_t fl_schedule_begun_samples(const fl_schedule *schedule)
{
    return schedule->furthest;
}

uint32_t fl_schedule_complete_ranks(const fl_schedule *schedule)
{
    return waves[schedule->complete_waves].first_rank;
}

uint64_t fl_schedule_total_samples(const fl_schedule *schedule)
{
    return schedule->total_samples;
}

bool fl_schedule_tile(const fl_schedule *schedule, uint32_t index, fl_rect *out_rect,
                      uint32_t *out_samples)
{
    if (index >= schedule->tile_count)
        return false;
    const tile *t = &schedule->tiles[index];
    *out_rect = (fl_rect){t->x0, t->y0, t->x1, t->y1};
    *out_samples = t->samples;
    return true;
}

static int fewer(const void *a, const void *b)
{
    const uint64_t *p = a, *q = b;
    return *p < *q ? -1 : *p > *q;
}

/* Everything that follows from the tiles' samples, once sample 0 is complete. False: out of memory.
 */
static bool resume(fl_schedule *schedule)
{
    uint64_t *order = malloc(schedule->tile_count * sizeof *order);
    if (!order)
        return false;
    for (uint32_t i = 0; i < schedule->tile_count; i++)
        order[i] = (uint64_t)schedule->tiles[i].samples << 32 | i;
    qsort(order, schedule->tile_count, sizeof *order, fewer);
    schedule->queue_head = schedule->queue_count = 0;
    schedule->total_samples = 0;
    for (uint32_t i = 0; i < schedule->tile_count; i++) {
        const tile *t = &schedule->tiles[(uint32_t)order[i]];
        enqueue(schedule, (uint32_t)order[i]);
        schedule->total_samples += (uint64_t)(t->x1 - t->x0) * (t->y1 - t->y0) * t->samples;
    }
    schedule->complete_samples = (uint32_t)(order[0] >> 32);
    schedule->furthest = (uint32_t)(order[schedule->tile_count - 1] >> 32);
    schedule->behind_count = 0;
    for (uint32_t i = 0; i < schedule->tile_count; i++)
        schedule->behind_count += order[i] >> 32 == schedule->complete_samples;
    free(order);
    for (uint32_t c = 0; c < schedule->cell_count; c++)
        schedule->cells[c].units_left = 0;
    memset(schedule->wave_units_left, 0, sizeof schedule->wave_units_left);
    schedule->complete_waves = schedule->next_wave = WAVES;
    return true;
}

void fl_schedule_pack(fl_schedule *schedule, fl_pack *pack)
{
    fl_pack_check(pack, &schedule->tile_count, sizeof schedule->tile_count);
    for (uint32_t i = 0; i < schedule->tile_count; i++) {
        fl_pack_bytes(pack, &schedule->tiles[i].samples, sizeof schedule->tiles[i].samples);
        pack->has_failed |= schedule->tiles[i].samples - 1 >= PACKED_SAMPLES_MAX;
    }
    if (pack->mode == FL_PACK_READ && !pack->has_failed)
        pack->has_failed = !resume(schedule);
}
