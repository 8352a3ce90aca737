/* SPDX-License-Identifier: MIT
 *
 * Floor and wall: both repeat without a seam.
 */
#include <math.h>

#include "picture.h"

/* ---- Oak parquet in herringbone ---- */

enum {
    FLOOR_SIDE = 1024,
    CELL = 64,  /* width of a plank in pixels */
    LENGTH = 4, /* planks are LENGTH cells long */
    CELLS = FLOOR_SIDE /
            CELL /* the pattern repeats every 2 LENGTH cells, the planks' grain every CELLS */
};

typedef struct plank_point {
    double along, across; /* cells from the plank's corner: [0, LENGTH), [0, 1) */
    int32_t id_x, id_y;   /* the plank's first cell, and */
    uint32_t direction;   /* whether it lies along x or y */
} plank_point;

/* Row j holds horizontal planks that begin where (i - j) mod 2 LENGTH = 0; what is left between
 * them are the vertical ones. */
static plank_point find_plank(double x, double y)
{
    int32_t i = (int32_t)floor(x), j = (int32_t)floor(y);
    int32_t k = ((i - j) % (2 * LENGTH) + 2 * LENGTH) % (2 * LENGTH);
    if (k < LENGTH)
        return (plank_point){k + x - i, y - j, (i - k + CELLS) % CELLS, j, 0};
    int32_t m = 2 * LENGTH - 1 - k;
    return (plank_point){m + y - j, x - i, i, (j - m + CELLS) % CELLS, 1};
}

static rgb oak(const plank_point *p)
{
    const rgb pale = {0.76, 0.58, 0.39}, dark = {0.47, 0.30, 0.17}, red = {0.62, 0.40, 0.24};
    uint32_t seed = 1000 + (uint32_t)(p->id_x * 64 + p->id_y) * 2 + p->direction;
    double tint = random_at(p->id_x, p->id_y, 7 + p->direction);
    double warmth = random_at(p->id_x, p->id_y, 17 + p->direction);
    /* Growth rings: slices of a slowly wandering cone, seen as long bands with cathedral bends. */
    double bend = fractal_noise(p->along * 0.55, p->across * 1.6, 64, 64, 3, seed);
    double center = 0.2 + 0.6 * random_at(p->id_x, p->id_y, 27 + p->direction);
    double distance = p->across - center + 0.5 * (bend - 0.5);
    double rings = sqrt(distance * distance + 0.012 * (1 + p->along)) * 11 + 3 * tint;
    double ring = 0.5 + 0.5 * sin_turns(rings);
    ring = ring * ring * (0.7 + 0.3 * noise(p->along * 2, p->across * 6, 64, 64, seed + 5));
    /* Pores: short dark strokes along the grain. */
    double pores = noise(p->along * 5, p->across * 55, 64, 64, seed + 9);
    double fibre = noise(p->along * 3, p->across * 110, 64, 128, seed + 13);
    double depth = 0.10 + 0.34 * ring + 0.22 * ramp(0.62, 0.95, pores) + 0.10 * fibre;
    rgb wood =
        mix_rgb(mix_rgb(pale, red, 0.55 * warmth), dark, clamp01(depth + 0.30 * (tint - 0.45)));
    double light = 0.90 + 0.20 * tint;
    return (rgb){wood.r * light, wood.g * light, wood.b * light};
}

/* Distance to the plank's outline in pixels. */
static double edge_distance(const plank_point *p)
{
    double across = p->across < 0.5 ? p->across : 1 - p->across;
    double along = p->along < LENGTH / 2.0 ? p->along : LENGTH - p->along;
    return CELL * (across < along ? across : along);
}

picture make_floor(void)
{
    enum { GRID = 3 }; /* samples a pixel and axis */
    picture p = picture_create(FLOOR_SIDE, FLOOR_SIDE);
    const rgb seam = {0.16, 0.10, 0.06};
    for (uint32_t y = 0; y < FLOOR_SIDE; y++) {
        for (uint32_t x = 0; x < FLOOR_SIDE; x++) {
            rgb sum = {0, 0, 0};
            for (int s = 0; s < GRID * GRID; s++) {
                plank_point at = find_plank((x + (s % GRID + 0.5) / GRID) / CELL,
                                            (y + (s / GRID + 0.5) / GRID) / CELL);
                double edge = edge_distance(&at);
                rgb c = mix_rgb(seam, oak(&at), 0.15 + 0.85 * ramp(0.3, 1.5, edge));
                double bevel = 1 + 0.05 * ramp(4.0, 1.6, edge);
                sum.r += c.r * bevel / (GRID * GRID);
                sum.g += c.g * bevel / (GRID * GRID);
                sum.b += c.b * bevel / (GRID * GRID);
            }
            p.pixels[(size_t)y * FLOOR_SIDE + x] = sum;
        }
    }
    return p;
}

/* ---- Wallpaper: damask in an ogee net, tone in tone ---- */

enum { WALL_SIDE = 1024, WALL_COLUMNS = 4, WALL_ROWS = 2 };

typedef struct petal {
    double x, y, turns, length, width; /* root, direction from straight up, size */
} petal;

/* Negative inside a petal that is narrow at its root and round at its end. */
static double petal_distance(const petal *p, double x, double y, double *out_side)
{
    double c = cos_turns(p->turns), s = sin_turns(p->turns), dx = x - p->x, dy = y - p->y;
    double side = c * dx - s * dy, up = s * dx + c * dy, t = clamp01(up / p->length);
    double beyond = up < 0 ? -up : up > p->length ? up - p->length : 0;
    *out_side = fabs(side);
    return fabs(side) - p->width * t * sqrt(1 - t) * 2.6 + beyond;
}

/* The palmette of one cell, mirrored in x; the cell is 1 wide and 2 high with its centre at 0, 0.
 * Each petal is laid over those before it with a gap around it and a vein left open. */
static double figure(double x, double y)
{
    static const petal petals[] = {
        {0.00, -0.17, 0.335, 0.30, 0.050}, {0.00, -0.15, 0.255, 0.33, 0.055},
        {0.00, -0.13, 0.180, 0.38, 0.060}, {0.00, -0.11, 0.110, 0.45, 0.062},
        {0.00, -0.09, 0.048, 0.53, 0.060}, {0.00, -0.07, 0.000, 0.60, 0.058},
        {0.00, -0.25, 0.415, 0.30, 0.040}, {0.00, -0.27, 0.460, 0.38, 0.042},
        {0.00, -0.29, 0.500, 0.44, 0.040}, {0.00, 0.64, 0.14, 0.13, 0.028},
        {0.00, 0.64, 0.000, 0.18, 0.030},
    };
    double value = 0, side;
    x = fabs(x);
    for (unsigned i = 0; i < sizeof petals / sizeof petals[0]; i++) {
        double d = petal_distance(&petals[i], x, y, &side);
        double vein = 0.45 * ramp(0.007, 0.003, side) * ramp(-0.008, -0.016, d);
        value = mix(value, ramp(0.003, -0.004, d) - vein, ramp(0.014, 0.008, d));
    }
    double knot = sqrt(x * x * 0.25 + (y + 0.21) * (y + 0.21));
    value = mix(value, ramp(0.028, 0.022, knot) - 0.45 * ramp(0.012, 0.008, knot),
                ramp(0.040, 0.034, knot));
    double bud = sqrt((x - 0.155) * (x - 0.155) + (y + 0.40) * (y + 0.40));
    return mix(value, 1 - 0.6 * ramp(0.014, 0.010, bud), ramp(0.028, 0.023, bud));
}

static double damask(double u, double v)
{
    /* The net: two mirrored waves a column, meeting where the ogees touch. */
    double column = u * WALL_COLUMNS, row = v * WALL_ROWS;
    double best = 0;
    for (int shift = 0; shift < 2; shift++) {
        double x = column + 0.5 * shift, y = row + 0.5 * shift;
        x -= floor(x + 0.5);
        y -= floor(y + 0.5);
        double value = figure(x * 0.98, y * 1.96);
        double border = fabs(fabs(x) - 0.25 - 0.235 * cos_turns(y));
        double twin = fabs(border - 0.022);
        double net = ramp(0.0085, 0.0035, twin) * 0.8;
        double dots = fabs(y * 28 - floor(y * 28 + 0.5)) * 0.035;
        double bead = sqrt(border * border + dots * dots);
        net = net > ramp(0.011, 0.007, bead) ? net : ramp(0.011, 0.007, bead);
        value = value > net ? value : net;
        best = value > best ? value : best;
    }
    return best;
}

picture make_wall(void)
{
    enum { GRID = 2 };
    picture p = picture_create(WALL_SIDE, WALL_SIDE);
    const rgb ground = {0.705, 0.735, 0.690}, silk = {0.800, 0.820, 0.770};
    for (uint32_t y = 0; y < WALL_SIDE; y++) {
        for (uint32_t x = 0; x < WALL_SIDE; x++) {
            double figure_sum = 0;
            for (int s = 0; s < GRID * GRID; s++)
                figure_sum += damask((x + (s % GRID + 0.5) / GRID) / WALL_SIDE,
                                     1 - (y + (s / GRID + 0.5) / GRID) / WALL_SIDE);
            double u = (double)x / WALL_SIDE, v = (double)y / WALL_SIDE;
            double weave =
                noise(u * 512, v * 64, 512, 64, 3) + noise(u * 64, v * 512, 64, 512, 4) - 1;
            double cloud = fractal_noise(u * 6, v * 6, 6, 6, 5, 5) - 0.5;
            rgb c = mix_rgb(ground, silk, figure_sum / (GRID * GRID));
            double light = 1 + 0.035 * weave + 0.05 * cloud;
            p.pixels[(size_t)y * WALL_SIDE + x] = (rgb){c.r * light, c.g * light, c.b * light};
        }
    }
    return p;
}
