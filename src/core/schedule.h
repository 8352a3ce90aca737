/* SPDX-License-Identifier: MIT
 *
 * Layer 7: which pixels to sample next. Pure bookkeeping: no threads, no clock; the render guards
 * it.
 *
 * Sample 0 is visited by Bayer rank over the whole picture: rank 0 is every 8th pixel in both
 * directions, 64 ranks make the full picture. Units lie in cells of 128 x 128 pixels. Ranks 0 to 3
 * go out one by one, 256 pixels a unit, so that rank 0 is soon complete and spread over all
 * workers; then 4 at a time, every 4th pixel of a cell, and 16 at a time, every 2nd of a quarter
 * cell: up to 1024 pixels that are near each other, as their rays then are (decision 050). Later
 * samples go over tiles of 32 x 32 pixels (16 x 16 in small pictures), 1024 pixels a unit. Cells
 * and tiles go out from the centre of the picture.
 *
 * A tile takes part in at most one unit at a time, and only when all its earlier samples are
 * committed; among those the tile with the fewest samples goes first. There is no barrier between
 * passes: a slow tile delays only itself.
 */
#ifndef FL_SCHEDULE_H
#define FL_SCHEDULE_H

#include "core/pack.h"

enum {
    FL_BAYER_RANKS = 64,
    FL_CELL_SIDE = 128,
    FL_TILE_SIDE = 32, /**< Largest. Multiples of 16, which the error estimate needs. */
    FL_TILES_FEW = 32  /**< With fewer tiles than this, tiles of half the side are used. */
};

typedef struct fl_rect {
    uint32_t x0, y0, x1, y1; /**< Half open. */
} fl_rect;

/** A unit of work: sample `sample` of the pixels x0, x0 + step ... < x1 in the rows y0, y0 + step
 * ... < y1. */
typedef struct fl_work {
    fl_rect rect;
    uint32_t step, sample;
    uint32_t index; /**< Of the cell (sample 0) or the tile. */
    uint32_t rank;  /**< Sample 0 only: the first of the unit's ranks. */
} fl_work;

typedef struct fl_schedule fl_schedule;

/** Rank of a pixel in the 8 x 8 Bayer order, 0 to 63. */
uint32_t fl_bayer_rank(uint32_t x, uint32_t y);

bool fl_schedule_bytes(uint32_t width, uint32_t height, size_t *out_bytes);
/** NULL: out of memory. Size at least 1 x 1, at most 65535 a side. O(tiles log tiles). */
fl_schedule *fl_schedule_create(uint32_t width, uint32_t height);
void fl_schedule_destroy(fl_schedule *schedule);
/** Begin again. O(cells). */
void fl_schedule_reset(fl_schedule *schedule);

/** Stop when every pixel has `samples` samples (at least 1 is taken). When some tiles already have
 * more, all get as many as the furthest tile, so that the film always ends even. May change at any
 * time. */
void fl_schedule_set_cap(fl_schedule *schedule, uint32_t samples);

/** Take the next unit. False: none now (all done, or what is left waits for units that are out). */
bool fl_schedule_next(fl_schedule *schedule, fl_work *out_work);
/** Whether fl_schedule_next would find one. */
bool fl_schedule_has_work(const fl_schedule *schedule);
/** The unit's samples are in the film. True: the pixels of *out_rect now all have exactly
 * work->sample + 1 samples. */
bool fl_schedule_commit(fl_schedule *schedule, const fl_work *work, fl_rect *out_rect);

/** The unit's pixels, relative to the film plus (x0, y0), in squares of 8 x 8 for the sake of
 * packets; returns how many. Arrays of FL_UNIT_PIXELS. */
uint32_t fl_work_pixels(const fl_work *work, uint32_t x0, uint32_t y0, uint16_t *out_x,
                        uint16_t *out_y);

/** Samples every pixel has. */
uint32_t fl_schedule_complete_samples(const fl_schedule *schedule);
/** The most that any pixel has or is getting: less is no end. */
uint32_t fl_schedule_begun_samples(const fl_schedule *schedule);
/** Bayer ranks 0 ... that are complete in the whole picture, 0 to 64; 4 and then 16 more at once. */
uint32_t fl_schedule_complete_ranks(const fl_schedule *schedule);
/** Samples committed, all pixels together. */
uint64_t fl_schedule_total_samples(const fl_schedule *schedule);

/** How far each tile is, when sample 0 is complete and no unit is out; reading takes a schedule that
 * was just reset. O(tiles log tiles). */
void fl_schedule_pack(fl_schedule *schedule, fl_pack *pack);
/** Tile number `index`: its pixels and how many samples they have. False: there is none. */
bool fl_schedule_tile(const fl_schedule *schedule, uint32_t index, fl_rect *out_rect,
                      uint32_t *out_samples);

#endif
