/* SPDX-License-Identifier: MIT */
#include "core/allocation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/math64.h"

enum {
    BAND_ROWS = FL_SQUARE_SIDE, /* A step of planning. */
    TILE_SIDE = 64, /* Largest: pixels of one sample number are few towards the end of a round. */
    TILE_SIDE_MIN = 16,
    BINS_PER_OCTAVE = 32,
    BIN_ZERO = 40 * BINS_PER_OCTAVE,
    BIN_COUNT = 2 * BIN_ZERO
};

/* A pixel whose neighbourhood showed nothing yet is taken for this part of the picture's spread. */
#define FLOOR_PART 0.05

/* How much smaller the error of a round must promise to become than with the same number of samples
 * everywhere; below, all get the same. */
#define GAIN_MIN 1.05

/* An error that falls faster than this owes it to whole nets of points, which numbers of blocks
 * that are no power of two break up. Measured: gain 1.4 to 1.7 at p = 1.0, 0.5 to 1.4 at 1.4. */
#define EXPONENT_NETS 1.2

/* Relative distance from the goal that is near enough. */
#define SLACK 0.02

#define ROUND_SEED 0x616c6c6fu

typedef enum phase {
    PHASE_EVEN,    /* The schedule gives every pixel its first block. */
    PHASE_MEASURE, /* Variances and the error, band by band. */
    PHASE_REST,    /* Between rounds. */
    PHASE_WEIGH,   /* How much each pixel wants, band by band, into bins. */
    PHASE_ASSIGN,  /* Wanted blocks, band by band; a second time if not by spread. */
    PHASE_ROUND    /* Units are out or waiting. */
} phase;

/* How a round is given out: in proportion to the spread, or to 1. */
typedef enum giving { GIVE_BY_SPREAD, GIVE_EVENLY, GIVING_COUNT } giving;

/* Pixels by blocks / weight: the water level from which on they get more. */
typedef struct bin {
    double weight, blocks;
} bin;

typedef struct giving_plan {
    bin bins[BIN_COUNT];
    double level; /* Blocks per weight. */
    double error; /* Squared error to expect at the end of the round, sum over pixels. */
} giving_plan;

struct fl_allocation {
    uint32_t width, height, columns, tile_side, tile_count;
    uint32_t seed, goal, round, band;
    phase phase;
    double *squares;  /* Per pixel: sum over samples and channels of the squared value. */
    float *variance;  /* Per pixel, of one sample, mean of the channels. */
    uint32_t *wanted; /* Per pixel: samples to have at the end of the round. */
    uint32_t *waiting, waiting_count, out_count; /* Tiles of this round. */
    uint64_t pixels, even_samples, round_samples;
    double total_variance;
    double round_target; /* Mean samples at the end of this round. */
    double exponent;     /* The error's rate of falling. */
    giving giving;       /* Of this round. */
    giving_plan plans[GIVING_COUNT];
};

static uint32_t tile_side(uint32_t width, uint32_t height)
{
    uint32_t side = TILE_SIDE;
    while (side > TILE_SIDE_MIN &&
           fl_ceil_div(width, side) * fl_ceil_div(height, side) < FL_TILES_FEW)
        side /= 2;
    return side;
}

static uint32_t count_tiles(uint32_t width, uint32_t height)
{
    uint32_t side = tile_side(width, height);
    return fl_ceil_div(width, side) * fl_ceil_div(height, side);
}

bool fl_allocation_bytes(uint32_t width, uint32_t height, size_t *out_bytes)
{
    size_t pixels, bytes, tiles = count_tiles(width, height) * sizeof(uint32_t);
    size_t pixel = sizeof(double) + sizeof(float) + sizeof(uint32_t);
    if (!fl_size_mul(width, height, &pixels) || !fl_size_mul(pixels, pixel, &bytes) ||
        bytes > SIZE_MAX - sizeof(fl_allocation) - tiles)
        return false;
    *out_bytes = bytes + sizeof(fl_allocation) + tiles;
    return true;
}

fl_allocation *fl_allocation_create(uint32_t width, uint32_t height)
{
    fl_allocation *a = calloc(1, sizeof *a);
    if (!a)
        return NULL;
    a->width = width;
    a->height = height;
    a->pixels = (uint64_t)width * height;
    a->tile_side = tile_side(width, height);
    a->columns = fl_ceil_div(width, a->tile_side);
    a->tile_count = count_tiles(width, height);
    a->squares = malloc(a->pixels * sizeof *a->squares);
    a->variance = malloc(a->pixels * sizeof *a->variance);
    a->wanted = malloc(a->pixels * sizeof *a->wanted);
    a->waiting = malloc(a->tile_count * sizeof *a->waiting);
    if (!a->squares || !a->variance || !a->wanted || !a->waiting) {
        fl_allocation_destroy(a);
        return NULL;
    }
    fl_allocation_reset(a, 0);
    return a;
}

void fl_allocation_destroy(fl_allocation *allocation)
{
    if (!allocation)
        return;
    free(allocation->squares);
    free(allocation->variance);
    free(allocation->wanted);
    free(allocation->waiting);
    free(allocation);
}

void fl_allocation_reset(fl_allocation *a, uint32_t seed)
{
    a->seed = seed;
    a->goal = UINT32_MAX;
    a->round = a->band = a->waiting_count = a->out_count = 0;
    a->total_variance = a->round_target = 0.0;
    a->phase = PHASE_EVEN;
    a->even_samples = a->round_samples = 0;
}

void fl_allocation_set_goal(fl_allocation *a, uint32_t samples)
{
    a->goal = samples;
}

uint64_t fl_allocation_samples(const fl_allocation *a)
{
    return a->round_samples;
}

static double mean_samples(const fl_allocation *a)
{
    return (double)(a->even_samples + a->round_samples) / (double)a->pixels;
}

/* Where a round that begins now goes: the mean at most doubles. */
static double next_target(const fl_allocation *a)
{
    return fl_min((double)a->goal, 2.0 * mean_samples(a));
}

uint32_t fl_allocation_begun_samples(const fl_allocation *a)
{
    return (uint32_t)ceil(a->phase == PHASE_WEIGH ? next_target(a) : a->round_target);
}

/* Whether another round is worth its planning; parts of blocks were rounded, so the goal is hit
 * only about. */
static bool wants_more(const fl_allocation *a)
{
    return (double)a->goal > mean_samples(a) * (1.0 + SLACK) + SLACK;
}

/* Whether the round may go on: the goal has not been lowered below what it was begun for. */
static bool may_go_on(const fl_allocation *a)
{
    return a->phase == PHASE_ROUND && (double)a->goal >= a->round_target;
}

void fl_allocation_add(fl_allocation *a, const fl_unit *unit, const fl_unit_result *result,
                       uint32_t x0, uint32_t y0)
{
    for (uint32_t i = 0; i < unit->count; i++) {
        size_t at = (size_t)(unit->y[i] - y0) * a->width + (unit->x[i] - x0);
        double r = (double)result->r[i], g = (double)result->g[i], b = (double)result->b[i];
        double square = result->is_valid[i] ? r * r + g * g + b * b : 0.0;
        a->squares[at] = (unit->sample == 0 ? 0.0 : a->squares[at]) + square;
    }
    if (a->phase == PHASE_EVEN) {
        a->even_samples += unit->count;
        if (a->even_samples == a->pixels * FL_ALLOCATION_BLOCK)
            a->phase = PHASE_MEASURE;
    }
}

bool fl_allocation_must_plan(const fl_allocation *a)
{
    switch (a->phase) {
    case PHASE_EVEN:
        return false;
    case PHASE_MEASURE:
    case PHASE_WEIGH:
    case PHASE_ASSIGN:
        return true;
    case PHASE_REST:
        return wants_more(a);
    case PHASE_ROUND:
        return a->waiting_count == 0 && a->out_count == 0;
    }
    return false;
}

bool fl_allocation_has_units(const fl_allocation *a)
{
    return a->waiting_count > 0 && may_go_on(a);
}

bool fl_allocation_has_work(const fl_allocation *a)
{
    return fl_allocation_must_plan(a) || fl_allocation_has_units(a);
}

/* --- Units -------------------------------------------------------------------------------------
 */

static fl_rect tile_rect(const fl_allocation *a, uint32_t tile)
{
    uint32_t x = tile % a->columns * a->tile_side, y = tile / a->columns * a->tile_side;
    return (fl_rect){x, y, fl_min_u32(x + a->tile_side, a->width),
                     fl_min_u32(y + a->tile_side, a->height)};
}

/* The least sample number that a pixel of the tile still needs; FL_NONE: all have what they should.
 */
static uint32_t next_sample(const fl_allocation *a, const fl_film *film, const fl_rect *r)
{
    uint32_t least = FL_NONE, samples[TILE_SIDE];
    for (uint32_t y = r->y0; y < r->y1; y++) {
        const uint32_t *wanted = a->wanted + (size_t)y * a->width;
        fl_film_samples_row(film, r->x0, y, r->x1 - r->x0, samples);
        for (uint32_t x = r->x0; x < r->x1; x++)
            if (samples[x - r->x0] < wanted[x] && samples[x - r->x0] < least)
                least = samples[x - r->x0];
    }
    return least;
}

/* Pixels of the tile that need sample number `sample` next, at most a unit, in squares of 8 x 8 for
 * the sake of packets. */
static uint32_t list_pixels(const fl_allocation *a, const fl_film *film, const fl_rect *r,
                            uint32_t sample, uint32_t x0, uint32_t y0, uint16_t *out_x,
                            uint16_t *out_y)
{
    enum { SQUARE = 8 };
    uint32_t count = 0, squares_x = fl_ceil_div(r->x1 - r->x0, SQUARE);
    uint32_t squares = squares_x * fl_ceil_div(r->y1 - r->y0, SQUARE), samples[SQUARE];
    for (uint32_t s = 0; s < squares && count + SQUARE * SQUARE <= FL_UNIT_PIXELS; s++) {
        uint32_t begin_x = r->x0 + s % squares_x * SQUARE, begin_y = r->y0 + s / squares_x * SQUARE;
        uint32_t end_x = fl_min_u32(begin_x + SQUARE, r->x1);
        uint32_t end_y = fl_min_u32(begin_y + SQUARE, r->y1);
        for (uint32_t y = begin_y; y < end_y; y++) {
            const uint32_t *wanted = a->wanted + (size_t)y * a->width;
            fl_film_samples_row(film, begin_x, y, end_x - begin_x, samples);
            for (uint32_t x = begin_x; x < end_x; x++)
                if (samples[x - begin_x] == sample && wanted[x] > sample) {
                    out_x[count] = (uint16_t)(x0 + x);
                    out_y[count++] = (uint16_t)(y0 + y);
                }
        }
    }
    return count;
}

uint32_t fl_allocation_next(fl_allocation *a, const fl_film *film, uint32_t x0, uint32_t y0,
                            uint16_t *out_x, uint16_t *out_y, uint32_t *out_sample,
                            uint32_t *out_tile)
{
    if (!may_go_on(a))
        return 0;
    while (a->waiting_count > 0) {
        uint32_t tile = a->waiting[--a->waiting_count];
        fl_rect rect = tile_rect(a, tile);
        *out_sample = next_sample(a, film, &rect);
        if (*out_sample == FL_NONE)
            continue;
        *out_tile = tile;
        a->out_count++;
        return list_pixels(a, film, &rect, *out_sample, x0, y0, out_x, out_y);
    }
    return 0;
}

void fl_allocation_commit(fl_allocation *a, uint32_t tile, uint32_t pixel_count)
{
    FL_ASSERT(a->phase == PHASE_ROUND && a->out_count > 0);
    a->out_count--;
    a->waiting[a->waiting_count++] = tile;
    a->round_samples += pixel_count;
}

/* --- Planning ----------------------------------------------------------------------------------
 */

/* Variance of one sample of each pixel of a row, from sums. */
static void measure_row(fl_allocation *a, const fl_film *film, uint32_t y)
{
    for (uint32_t x = 0; x < a->width; x++) {
        size_t at = (size_t)y * a->width + x;
        float rgb[3];
        uint32_t n; /* Invalid samples are in neither of the sums. */
        fl_film_row(film, x, y, 1, rgb);
        fl_film_valid_row(film, x, y, 1, &n);
        double r = (double)rgb[0], g = (double)rgb[1], b = (double)rgb[2];
        double spread = a->squares[at] - (double)n * (r * r + g * g + b * b);
        double variance = n > 1 ? fl_max(spread, 0.0) / (3.0 * (double)(n - 1)) : 0.0;
        a->variance[at] = variance <= 1e30 ? (float)variance : 1e30f;
        a->total_variance += (double)a->variance[at];
    }
}

/* Spread of the samples in the 3 x 3 neighbourhood, as far as it lies in the picture. */
static double spread_around(const fl_allocation *a, uint32_t x, uint32_t y)
{
    uint32_t begin_x = x > 0 ? x - 1 : 0, end_x = fl_min_u32(x + 2, a->width);
    uint32_t begin_y = y > 0 ? y - 1 : 0, end_y = fl_min_u32(y + 2, a->height);
    double sum = 0.0;
    for (uint32_t v = begin_y; v < end_y; v++)
        for (uint32_t u = begin_x; u < end_x; u++)
            sum += (double)a->variance[(size_t)v * a->width + u];
    if (a->total_variance <= 0.0)
        return 1.0;
    double mean = sum / ((end_x - begin_x) * (end_y - begin_y));
    double least = FLOOR_PART * FLOOR_PART * a->total_variance / (double)a->pixels;
    return sqrt(fl_max(mean, least));
}

static double weight_of(const fl_allocation *a, giving way, uint32_t x, uint32_t y)
{
    return way == GIVE_EVENLY ? 1.0 : spread_around(a, x, y);
}

static uint32_t bin_of(double level)
{
    double position = fl_d_log2(level) * BINS_PER_OCTAVE + BIN_ZERO;
    return (uint32_t)fl_clamp(floor(position), 0.0, BIN_COUNT - 1);
}

static void weigh_row(fl_allocation *a, const fl_film *film, uint32_t y)
{
    for (uint32_t x = 0; x < a->width; x++) {
        uint32_t n;
        fl_film_samples_row(film, x, y, 1, &n);
        for (giving g = GIVE_BY_SPREAD; g < GIVING_COUNT; g++) {
            double weight = weight_of(a, g, x, y), blocks = n / FL_ALLOCATION_BLOCK;
            bin *b = &a->plans[g].bins[bin_of(blocks / weight)];
            b->weight += weight;
            b->blocks += blocks;
        }
    }
}

/* The level at which all that pixels want beyond what they have is what there is to give. */
static double find_level(const giving_plan *plan, double blocks)
{
    double weight = 0.0, had = 0.0;
    for (int i = 0; i < BIN_COUNT; i++) {
        double end = fl_d_exp2((double)(i + 1 - BIN_ZERO) / BINS_PER_OCTAVE);
        weight += plan->bins[i].weight;
        had += plan->bins[i].blocks;
        if (weight > 0.0 && end * weight - had >= blocks)
            return (blocks + had) / weight;
    }
    return weight > 0.0 ? (blocks + had) / weight : 0.0;
}

/* Blocks of this round, all pixels together: the mean at most doubles. */
static double round_blocks(const fl_allocation *a)
{
    return (a->round_target - mean_samples(a)) * (double)a->pixels / FL_ALLOCATION_BLOCK;
}

static uint32_t wanted_by(const fl_allocation *a, giving way, uint32_t x, uint32_t y, uint32_t n)
{
    uint32_t seed = fl_hash_step(fl_hash_step(fl_hash_step(a->seed, ROUND_SEED), a->round), y);
    double more = a->plans[way].level * weight_of(a, way, x, y) - n / FL_ALLOCATION_BLOCK;
    double dither = (double)(fl_hash_step(seed, x) >> 8) * 0x1p-24;
    double blocks = more > 0.0 ? floor(more + dither) : 0.0;
    return n + FL_ALLOCATION_BLOCK * (uint32_t)blocks;
}

/* What is left of a squared error when n samples become more. */
static double decline(const fl_allocation *a, uint32_t n, uint32_t more)
{
    return more > n ? fl_d_exp2(2.0 * a->exponent * fl_d_log2((double)n / more)) : 1.0;
}

static void assign_row(fl_allocation *a, const fl_film *film, const fl_estimate *estimate,
                       uint32_t y)
{
    for (uint32_t x = 0; x < a->width; x++) {
        uint32_t n, *wanted = &a->wanted[(size_t)y * a->width + x];
        fl_film_samples_row(film, x, y, 1, &n);
        *wanted = wanted_by(a, a->giving, x, y, n);
        if (a->giving == GIVE_EVENLY)
            continue;
        double square = fl_estimate_pixel_square(estimate, x, y);
        a->plans[GIVE_BY_SPREAD].error += square * decline(a, n, *wanted);
        a->plans[GIVE_EVENLY].error += square * decline(a, n, wanted_by(a, GIVE_EVENLY, x, y, n));
    }
}

static void begin_round(fl_allocation *a)
{
    a->phase = PHASE_ROUND;
    a->round++;
    a->waiting_count = a->out_count = 0;
    for (uint32_t i = a->tile_count; i-- > 0;)
        a->waiting[a->waiting_count++] = i;
}

/* The spread of single samples says little about what stratified ones leave where the picture is
 * smooth; the differences that the estimate has seen do. */
static bool spread_is_worth_it(const fl_allocation *a)
{
    return a->exponent <= EXPONENT_NETS &&
           GAIN_MIN * GAIN_MIN * a->plans[GIVE_BY_SPREAD].error <= a->plans[GIVE_EVENLY].error;
}

/* All bands of a phase are done. */
static void next_phase(fl_allocation *a)
{
    if (a->phase == PHASE_MEASURE) {
        a->phase = PHASE_REST;
    } else if (a->phase == PHASE_WEIGH) {
        a->round_target = next_target(a);
        for (giving g = GIVE_BY_SPREAD; g < GIVING_COUNT; g++)
            a->plans[g].level = find_level(&a->plans[g], round_blocks(a));
        a->giving = GIVE_BY_SPREAD;
        a->phase = PHASE_ASSIGN;
    } else if (a->giving == GIVE_BY_SPREAD && !spread_is_worth_it(a)) {
        a->giving = GIVE_EVENLY;
    } else {
        begin_round(a);
    }
}

static void begin_phase(fl_allocation *a, phase next)
{
    a->phase = next;
    a->band = 0;
    if (next == PHASE_MEASURE)
        a->total_variance = 0.0;
    if (next == PHASE_WEIGH)
        memset(a->plans, 0, sizeof a->plans);
}

static void plan_row(fl_allocation *a, const fl_film *film, const fl_estimate *estimate, uint32_t y)
{
    if (a->phase == PHASE_MEASURE)
        measure_row(a, film, y);
    else if (a->phase == PHASE_WEIGH)
        weigh_row(a, film, y);
    else
        assign_row(a, film, estimate, y);
}

void fl_allocation_plan(fl_allocation *a, const fl_film *film, fl_estimate *estimate)
{
    if (a->phase == PHASE_ROUND) {
        begin_phase(a, PHASE_MEASURE);
    } else if (a->phase == PHASE_REST) {
        fl_error_estimate error;
        fl_estimate_read(estimate, FL_ALLOCATION_BLOCK, &error);
        a->exponent = error.exponent;
        begin_phase(a, PHASE_WEIGH);
    }
    uint32_t begin = a->band * BAND_ROWS, end = fl_min_u32(begin + BAND_ROWS, a->height);
    for (uint32_t y = begin; y < end; y++)
        plan_row(a, film, estimate, y);
    if (a->phase == PHASE_MEASURE && a->round > 0)
        fl_estimate_capture_round(estimate, film, &(fl_rect){0, begin, a->width, end},
                                  mean_samples(a));
    a->band++;
    if (end < a->height)
        return;
    a->band = 0;
    next_phase(a);
}
