/* SPDX-License-Identifier: MIT
 *
 * Blue-and-white porcelain for a vase, painted with a brush: bands of ornament from foot (bottom
 * row) to rim. It closes in x: the width is once around. Lengths are in heights of the texture; y
 * goes up.
 */
#include <math.h>
#include <stdlib.h>

#include "picture.h"

enum {
    WIDTH = 2048,
    HEIGHT = 1024,
    FINE = 2,
    FINE_WIDTH = WIDTH * FINE,
    FINE_HEIGHT = HEIGHT * FINE
};

static const double around = (double)WIDTH / HEIGHT;

/* Density of cobalt, 0 to 1, FINE times finer than the picture; row 0 at the foot. */
typedef struct canvas {
    float *density;
} canvas;

typedef struct point {
    double x, y;
} point;

/* A place to paint a motif at: local (x, y) is turned, scaled and moved; a negative scale_x
 * mirrors. */
typedef struct frame {
    point origin;
    double turns, scale_x, scale_y;
} frame;

typedef struct bezier {
    point p[4];
} bezier;

static point place(const frame *f, double x, double y)
{
    double c = cos_turns(f->turns), s = sin_turns(f->turns);
    x *= f->scale_x;
    y *= f->scale_y;
    return (point){f->origin.x + c * x + s * y, f->origin.y - s * x + c * y};
}

static frame frame_at(double x, double y, double turns, double scale)
{
    return (frame){{x, y}, turns, scale, scale};
}

/* One touch of the brush: it covers what was there. */
static void dab(canvas *to, point at, double radius, double tone)
{
    double r = radius * FINE_HEIGHT, cx = at.x * FINE_HEIGHT, cy = at.y * FINE_HEIGHT;
    int32_t y0 = (int32_t)floor(cy - r - 1), y1 = (int32_t)floor(cy + r + 1);
    int32_t x0 = (int32_t)floor(cx - r - 1), x1 = (int32_t)floor(cx + r + 1);
    for (int32_t y = y0 < 0 ? 0 : y0; y <= y1 && y < FINE_HEIGHT; y++) {
        for (int32_t x = x0; x <= x1; x++) {
            double dx = x + 0.5 - cx, dy = y + 0.5 - cy;
            double cover = clamp01(r + 0.5 - sqrt(dx * dx + dy * dy));
            int32_t column = (x % FINE_WIDTH + FINE_WIDTH) % FINE_WIDTH;
            float *d = &to->density[(size_t)y * FINE_WIDTH + (size_t)column];
            *d = (float)mix((double)*d, tone, cover);
        }
    }
}

static point on_bezier(const bezier *b, double t)
{
    double s = 1 - t, w0 = s * s * s, w1 = 3 * s * s * t, w2 = 3 * s * t * t, w3 = t * t * t;
    return (point){w0 * b->p[0].x + w1 * b->p[1].x + w2 * b->p[2].x + w3 * b->p[3].x,
                   w0 * b->p[0].y + w1 * b->p[1].y + w2 * b->p[2].y + w3 * b->p[3].y};
}

static double control_length(const bezier *b)
{
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        double dx = b->p[i + 1].x - b->p[i].x, dy = b->p[i + 1].y - b->p[i].y;
        sum += sqrt(dx * dx + dy * dy);
    }
    return sum;
}

/* A brush stroke; its half width goes from w0 over about w1 to w2. */
static void stroke(canvas *to, const bezier *b, double w0, double w1, double w2, double tone)
{
    int steps = 2 + (int)(control_length(b) * FINE_HEIGHT);
    for (int i = 0; i <= steps; i++) {
        double t = (double)i / steps;
        dab(to, on_bezier(b, t), mix(mix(w0, w1, t), mix(w1, w2, t), t), tone);
    }
}

static void line(canvas *to, point a, point b, double w, double tone)
{
    stroke(to,
           &(bezier){{a,
                      {mix(a.x, b.x, 1.0 / 3), mix(a.y, b.y, 1.0 / 3)},
                      {mix(a.x, b.x, 2.0 / 3), mix(a.y, b.y, 2.0 / 3)},
                      b}},
           w, w, w, tone);
}

/* Wash between two strokes with the same ends, shaded from tone0 at the root to tone1 at the tip.
 */
static void wash(canvas *to, const bezier *left, const bezier *right, double tone0, double tone1)
{
    int steps = 2 + (int)(control_length(left) * FINE_HEIGHT / 1.5);
    for (int i = 0; i <= steps; i++) {
        double t = (double)i / steps;
        point a = on_bezier(left, t), b = on_bezier(right, t);
        double dx = b.x - a.x, dy = b.y - a.y;
        int across = 1 + (int)(sqrt(dx * dx + dy * dy) * FINE_HEIGHT / 1.5);
        for (int k = 0; k <= across; k++) {
            double s = (double)k / across;
            dab(to, (point){a.x + s * dx, a.y + s * dy}, 1.6 / FINE_HEIGHT, mix(tone0, tone1, t));
        }
    }
}

/* ---- Motifs, painted upwards from their origin ---- */

static bezier petal_side(const frame *f, double w, double length)
{
    return (bezier){{place(f, 0, 0), place(f, 1.25 * w, 0.30 * length),
                     place(f, 1.05 * w, 0.85 * length), place(f, 0, length)}};
}

/* A pointed petal: wash inside, dark outline, fine lines from the root. */
static void petal(canvas *to, const frame *f, double length, double width, double root, double tip)
{
    const double pen = 0.0016;
    bezier left = petal_side(f, -width, length), right = petal_side(f, width, length);
    wash(to, &left, &right, root, tip);
    for (int i = -1; i <= 1; i++) {
        bezier vein = {{place(f, 0, 0.05 * length), place(f, 0.3 * i * width, 0.3 * length),
                        place(f, 0.4 * i * width, 0.4 * length),
                        place(f, 0.45 * i * width, 0.62 * length)}};
        stroke(to, &vein, 0.5 * pen, 0.6 * pen, 0.2 * pen, root + 0.25);
    }
    stroke(to, &left, pen, 1.3 * pen, 0.9 * pen, 0.92);
    stroke(to, &right, pen, 1.3 * pen, 0.9 * pen, 0.92);
}

/* A leaf with a bend and a light midrib. */
static void leaf(canvas *to, const frame *f, double length, double width, double bend)
{
    point tip = place(f, bend, length);
    bezier left = {{place(f, 0, 0), place(f, -width, 0.35 * length),
                    place(f, bend * 0.5 - 0.9 * width, 0.8 * length), tip}};
    bezier right = {{place(f, 0, 0), place(f, width, 0.25 * length),
                     place(f, bend * 0.5 + 0.9 * width, 0.7 * length), tip}};
    bezier rib = {{place(f, 0, 0), place(f, 0, 0.3 * length), place(f, 0.3 * bend, 0.6 * length),
                   place(f, 0.75 * bend, 0.85 * length)}};
    wash(to, &left, &right, 0.78, 0.52);
    stroke(to, &left, 0.0010, 0.0016, 0.0010, 0.95);
    stroke(to, &right, 0.0010, 0.0016, 0.0010, 0.95);
    stroke(to, &rib, 0.0016, 0.0012, 0.0004, 0.12);
}

/* A tendril that winds up into a spiral of `turns` turns to one side. */
static void tendril(canvas *to, const frame *f, double radius, double turns)
{
    int steps = (int)(40 + turns * radius * FINE_HEIGHT * 5);
    double pen = radius < 0.02 ? 0.16 * radius : 0.0032;
    for (int i = 0; i <= steps; i++) {
        double t = (double)i / steps, r = radius * (1 - 0.86 * t), a = turns * t;
        point at = place(f, radius - r * cos_turns(a), r * sin_turns(a) * 1.05);
        dab(to, at, mix(pen, 0.6 * pen, t), 0.85);
    }
    dab(to, place(f, radius, 0), 1.6 * pen, 0.85);
}

static void peony(canvas *to, double x, double y, double turns, double size)
{
    static const struct {
        int count;
        double length, width, offset, root, tip;
    } rings[] = {{11, 1.00, 0.23, 0.0, 0.62, 0.14},
                 {9, 0.76, 0.20, 0.5, 0.66, 0.16},
                 {7, 0.53, 0.17, 0.0, 0.70, 0.22}};
    for (unsigned k = 0; k < sizeof rings / sizeof rings[0]; k++) {
        for (int i = 0; i < rings[k].count; i++) {
            double turn = turns + (i + rings[k].offset) / rings[k].count;
            frame f = frame_at(x, y, turn, size);
            petal(to, &f, rings[k].length, rings[k].width, rings[k].root, rings[k].tip);
        }
    }
    dab(to, (point){x, y}, 0.25 * size, 0.95);
    dab(to, (point){x, y}, 0.22 * size, 0.10);
    for (int i = 0; i < 8; i++) {
        frame f = frame_at(x, y, turns + i / 8.0, size);
        dab(to, place(&f, 0, 0.14), 0.035 * size, 0.85);
    }
    dab(to, (point){x, y}, 0.06 * size, 0.85);
}

/* ---- Bands ---- */

/* Lines once around; the hand trembles a little. */
static void ring(canvas *to, double y, double half_width, double tone)
{
    int steps = FINE_WIDTH;
    for (int i = 0; i < steps; i++) {
        double x = around * i / steps;
        double tremble = noise(x * 12, y * 50, 24, 64, 77) - 0.5;
        dab(to, (point){x, y + 0.0012 * tremble}, half_width * (1 + 0.25 * tremble), tone);
    }
}

static void double_ring(canvas *to, double y)
{
    ring(to, y - 0.0045, 0.0026, 0.88);
    ring(to, y + 0.0045, 0.0014, 0.75);
}

/* Key fret: squared spirals that join. */
static void fret(canvas *to, double y, double height, int count)
{
    static const point path[] = {{0, 0},     {0, 5},     {5, 5},    {5, 1.2},
                                 {1.7, 1.2}, {1.7, 3.4}, {3.3, 3.4}};
    double step = around / count;
    for (int i = 0; i < count; i++) {
        frame f = {{i * step, y}, 0, step / 6.5, height / 5};
        for (unsigned k = 0; k + 1 < sizeof path / sizeof path[0]; k++)
            line(to, place(&f, path[k].x, path[k].y), place(&f, path[k + 1].x, path[k + 1].y),
                 0.0026, 0.82);
        line(to, place(&f, 0, 0), place(&f, -1.5, 0), 0.0026, 0.82);
        line(to, place(&f, -1.5, 0), place(&f, -1.5, 5), 0.0026, 0.82);
    }
}

/* Lotus panels standing on the foot. */
static void panels(canvas *to, double y, double height, int count)
{
    double half = around / count / 2;
    for (int i = 0; i < count; i++) {
        static const struct {
            double size, tone;
        } layers[] = {{1.00, 0.92}, {0.93, 0.06}, {0.80, 0.55}, {0.73, 0.06}};
        frame f = frame_at((2 * i + 1) * half, y, 0, 1);
        for (unsigned k = 0; k < sizeof layers / sizeof layers[0]; k++) {
            double w = half * 0.97 * layers[k].size, h = height * (0.5 + 0.5 * layers[k].size);
            bezier left = {{place(&f, -w, 0), place(&f, -w, 0.75 * h),
                            place(&f, -0.75 * w, 0.80 * h), place(&f, 0, h)}};
            bezier right = {{place(&f, w, 0), place(&f, w, 0.75 * h), place(&f, 0.75 * w, 0.80 * h),
                             place(&f, 0, h)}};
            wash(to, &left, &right, layers[k].tone, layers[k].tone);
        }
        frame drop = frame_at(f.origin.x, y + 0.12 * height, 0, 1);
        petal(to, &drop, 0.52 * height, 0.34 * half, 0.75, 0.30);
        for (int side = -1; side <= 1; side += 2) {
            frame curl = {{f.origin.x + side * 0.10 * half, y + 0.16 * height}, 0, side, 1};
            tendril(to, &curl, 0.19 * half, 1.1);
        }
    }
}

/* Cloud collar: trefoil heads hanging down, one wash inside another. */
static void clouds(canvas *to, double y, double size, int count)
{
    static const point lobes[] = {{-0.62, -0.10}, {0.62, -0.10}, {0, -0.62}, {0, 0.05}};
    static const struct {
        double radius, tone;
    } layers[] = {{0.52, 0.93}, {0.47, 0.07}, {0.40, 0.60}, {0.34, 0.80}, {0.27, 0.07}};
    double step = around / count;
    for (int i = 0; i < count; i++) {
        double x = (i + 0.5) * step;
        frame f = frame_at(x, y, 0, size);
        for (unsigned k = 0; k < sizeof layers / sizeof layers[0]; k++)
            for (unsigned l = 0; l < sizeof lobes / sizeof lobes[0]; l++)
                dab(to, place(&f, lobes[l].x, lobes[l].y), layers[k].radius * size, layers[k].tone);
        frame heart = frame_at(x, y + 0.12 * size, 0.5, 1);
        petal(to, &heart, 0.62 * size, 0.15 * size, 0.80, 0.35);
        /* Between two heads a drop and three pearls. */
        frame between = frame_at(x + 0.5 * step, y + 0.45 * size, 0.5, 1);
        petal(to, &between, 0.72 * size, 0.17 * size, 0.75, 0.25);
        for (int k = 0; k < 3; k++)
            dab(to, place(&between, 0, (0.86 + 0.17 * k) * size), (0.055 - 0.011 * k) * size, 0.8);
    }
}

/* Stiff plantain leaves up the neck. */
static void plantain(canvas *to, double y, double height, int count)
{
    double half = around / count / 2;
    for (int k = 0; k < 2 * count; k++) {
        int i = k % count, is_front = k / count;
        double h = is_front ? height : 0.86 * height, w = 0.92 * half;
        frame f = frame_at((2 * i + (is_front ? 1 : 0)) * half, y, 0, 1);
        petal(to, &f, h, w, 0.10, 0.10);
        petal(to, &f, 0.90 * h, 0.72 * w, 0.72, 0.40);
        petal(to, &f, 0.74 * h, 0.40 * w, 0.08, 0.08);
        line(to, place(&f, 0, 0), place(&f, 0, 0.80 * h), 0.0015, 0.9);
        for (int v = 1; v < 9; v++)
            for (int side = -1; side <= 1; side += 2)
                line(to, place(&f, 0, 0.07 * v * h),
                     place(&f, side * (0.30 - 0.018 * v) * w, (0.07 * v + 0.07) * h), 0.0011, 0.75);
    }
}

/* Waves: rows of overlapping scales. */
static void waves(canvas *to, double y, double radius, int rows)
{
    int count = (int)(around / (2 * radius) + 0.5);
    double step = around / count;
    for (int row = rows - 1; row >= 0; row--) {
        for (int i = 0; i < count; i++) {
            point at = {(i + 0.5 * (row % 2)) * step, y + row * 0.5 * step};
            for (int k = 0; k < 6; k++)
                dab(to, at, step * 0.5 * (1.02 - 0.17 * k), k % 2 ? 0.06 : 0.85 - 0.08 * k);
        }
    }
}

/* The body: a scrolling stem with peonies in its bends, facing up and down in turn. */
static void scroll(canvas *to, double y, double half_height, int periods)
{
    static const struct {
        double at, turns, length, bend;
    } leaves[] = {{0.050, 0.33, 0.31, 0.10}, {0.105, 0.13, 0.34, -0.08},
                  {0.140, 0.41, 0.42, 0.12}, {0.185, 0.03, 0.36, -0.09},
                  {0.215, 0.34, 0.40, 0.10}, {0.262, 0.06, 0.34, -0.10}};
    double period = around / periods, rise = 0.79 * half_height, size = 0.56 * half_height;
    for (int i = 0; i < FINE_WIDTH; i++) {
        double x = around * i / FINE_WIDTH;
        dab(to, (point){x, y - rise * cos_turns(x / period)}, 0.0042, 0.88);
    }
    for (int i = 0; i < 2 * periods; i++) {
        double side = i % 2 ? -1 : 1, x = 0.5 * i * period, middle = y + 0.20 * side * half_height;
        for (int hand = -1; hand <= 1; hand += 2) {
            /* Two tendrils and the leaves leave the stem on each side of the bend. */
            frame outer = {
                {x + hand * 0.345 * period, y - side * rise * cos_turns(0.345)}, 0, -hand, side};
            frame inner = {
                {x + hand * 0.085 * period, y - side * rise * cos_turns(0.085)}, 0, -hand, side};
            tendril(to, &outer, 0.165 * half_height, 1.7);
            tendril(to, &inner, 0.095 * half_height, 1.4);
            for (unsigned k = 0; k < sizeof leaves / sizeof leaves[0]; k++) {
                frame f = {
                    {x + hand * leaves[k].at * period, y - side * rise * cos_turns(leaves[k].at)},
                    side * hand * leaves[k].turns,
                    hand * half_height,
                    side * half_height};
                leaf(to, &f, leaves[k].length, 0.10, leaves[k].bend);
            }
        }
        bezier stalk = {{{x - 0.13 * period, y - side * rise * cos_turns(0.13)},
                         {x - 0.08 * period, y - 0.3 * side * rise},
                         {x - 0.03 * period, middle - 0.3 * side * size},
                         {x, middle}}};
        stroke(to, &stalk, 0.004, 0.004, 0.004, 0.88);
        peony(to, x, middle, side > 0 ? 0 : 0.5, size);
    }
}

/* ---- Glaze ---- */

static rgb glaze(double density)
{
    static const rgb tones[] = {{0.925, 0.940, 0.945},
                                {0.640, 0.735, 0.860},
                                {0.270, 0.390, 0.690},
                                {0.105, 0.165, 0.450},
                                {0.050, 0.075, 0.260}};
    double at = clamp01(density) * 4;
    int i = at >= 4 ? 3 : (int)at;
    return mix_rgb(tones[i], tones[i + 1], at - i);
}

static picture fire(const canvas *from)
{
    picture p = picture_create(WIDTH, HEIGHT);
    for (uint32_t y = 0; y < HEIGHT; y++) {
        for (uint32_t x = 0; x < WIDTH; x++) {
            double sum = 0, u = (double)x / HEIGHT, v = (double)y / HEIGHT;
            for (uint32_t s = 0; s < FINE * FINE; s++)
                sum +=
                    (double)from
                        ->density[(size_t)(y * FINE + s / FINE) * FINE_WIDTH + x * FINE + s % FINE];
            /* Cobalt gathers in spots and fades; the glaze has a breath of cloud. */
            double heap = fractal_noise(u * 40, v * 40, 80, 40, 4, 31) - 0.5;
            double cloud = fractal_noise(u * 5, v * 5, 10, 5, 4, 41) - 0.5;
            double density = sum / (FINE * FINE);
            rgb c = glaze(density * (1 + 0.45 * heap) + 0.02 * cloud);
            p.pixels[(size_t)(HEIGHT - 1 - y) * WIDTH + x] = c;
        }
    }
    return p;
}

picture make_porcelain(void)
{
    canvas to = {calloc((size_t)FINE_WIDTH * FINE_HEIGHT, sizeof(float))};
    if (!to.density)
        return picture_create(1, 1);
    waves(&to, 0.924, 0.020, 4);
    ring(&to, 0.915, 0.016, 0.05); /* the lowest scales are cut off by the neck */
    ring(&to, 1.000, 0.012, 0.92);
    ring(&to, 0.000, 0.012, 0.92);
    double_ring(&to, 0.024);
    panels(&to, 0.032, 0.118, 16);
    double_ring(&to, 0.162);
    fret(&to, 0.178, 0.026, 44);
    double_ring(&to, 0.220);
    scroll(&to, 0.405, 0.172, 4);
    double_ring(&to, 0.590);
    clouds(&to, 0.668, 0.062, 12);
    double_ring(&to, 0.715);
    fret(&to, 0.730, 0.022, 52);
    double_ring(&to, 0.768);
    plantain(&to, 0.776, 0.136, 22);
    double_ring(&to, 0.926);
    picture p = fire(&to);
    free(to.density);
    return p;
}
