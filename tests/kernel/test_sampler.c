/* SPDX-License-Identifier: MIT
 *
 * The sampler and the warps: against their definitions, in the strata they promise, and the wide
 * forms against the scalar ones, bit for bit. Ends with costs, printed and not asserted.
 */
#include "lane_check.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

enum { N = 1 << 14 };
#define SEED 0x77c3u

static float got[4 * N], want[4 * N], u[N], v[N];
static uint32_t pixels[N], paths[N];

/* --- definition ------------------------------------------------------------------------------ */

/* Direction numbers from a primitive polynomial of degree s with inner coefficients a [Joe, Kuo
 * 2008]. */
static void make_directions(uint32_t s, uint32_t a, const uint32_t *m, uint32_t out[32])
{
    for (uint32_t i = 0; i < 32; i++) {
        if (s == 0 || i < s) {
            out[i] = (s == 0 ? 1u : m[i]) << (31 - i);
            continue;
        }
        out[i] = out[i - s] ^ out[i - s] >> s;
        for (uint32_t k = 1; k < s; k++)
            if (a >> (s - 1 - k) & 1u)
                out[i] ^= out[i - k];
    }
}

static void test_sobol_equals_direction_matrices(void **state)
{
    (void)state;
    static const uint32_t m[] = {1, 3, 1};
    uint32_t directions[4][32];
    for (uint32_t d = 0; d < 4; d++)
        make_directions(d, d < 2 ? 0 : 1, m, directions[d]);
    print_message("seed %#x\n", SEED);
    for (uint32_t i = 0; i < 100000; i++) {
        uint32_t k = i < 1000 ? i : fl_hash_step(SEED, i);
        for (uint32_t d = 0; d < 4; d++) {
            uint32_t x = 0;
            for (uint32_t bit = 0; bit < 32; bit++)
                x ^= k >> bit & 1u ? directions[d][bit] : 0u;
            assert_int_equal(fl_sobol_raw(k, d), x);
        }
    }
}

/* Digit by digit, so a slip in the fast forms shows. */
static void test_reversal_and_nesting(void **state)
{
    (void)state;
    assert_true(fl_unit_float(UINT32_MAX) == 1.0f - 0x1p-24f && fl_unit_float(255) == 0.0f);
    for (uint32_t i = 0; i < 10000; i++) {
        uint32_t x = fl_hash_step(SEED, i), seed = fl_hash_step(SEED + 1, i), reversed = 0;
        for (int bit = 0; bit < 32; bit++)
            reversed |= (x >> bit & 1u) << (31 - bit);
        assert_int_equal(fl_reverse_bits(x), reversed);
        /* Nested: equal leading digits stay equal, the first different one stays different. */
        uint32_t depth = i % 32, other = x ^ 0x80000000u >> depth;
        uint32_t difference = fl_owen(x, seed) ^ fl_owen(other, seed);
        assert_int_equal(difference >> (31 - depth), 1);
    }
}

/* --- strata ---------------------------------------------------------------------------------- */

/* All boxes with sides 2^-bits[d], sum of bits = log2(n) - t, hold exactly 2^t of the n points. */
static void assert_boxes(float points[][4], uint32_t n, const uint32_t bits[4], uint32_t t)
{
    static uint32_t counts[1 << 12];
    uint32_t boxes = 1u << (bits[0] + bits[1] + bits[2] + bits[3]);
    memset(counts, 0, boxes * sizeof *counts);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t box = 0;
        for (int d = 0; d < 4; d++)
            box = box << bits[d] | (uint32_t)(points[i][d] * (float)(1u << bits[d]));
        counts[box]++;
    }
    for (uint32_t box = 0; box < boxes; box++)
        assert_int_equal(counts[box], 1u << t);
}

static void fill_points(float points[][4], fl_sampler kind, uint32_t n, uint32_t pixel,
                        uint32_t set)
{
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t d = 0; d < 4; d++)
            points[i][d] = fl_sample_scalar(kind, SEED, pixel, i, set, d);
}

/* Dimensions 0, 1 are a (0, 2)-sequence: every prefix of 2^k points is a net. Each of the four is
 * stratified by itself. All four are a (3, 4)-sequence: t = sum of polynomial degrees less one
 * each. */
static void test_strata(void **state)
{
    (void)state;
    static float points[1 << 10][4];
    for (uint32_t pixel = 0; pixel < 12; pixel++) {
        uint32_t set = pixel % 2 ? fl_set_light(SEED, FL_PATH_CAMERA, pixel) : FL_SET_CAMERA;
        fill_points(points, FL_SAMPLER_SOBOL, 1 << 10, fl_hash_step(SEED, pixel), set);
        for (uint32_t k = 0; k <= 10; k++) {
            for (uint32_t i = 0; i <= k; i++)
                assert_boxes(points, 1u << k, (const uint32_t[4]){i, k - i, 0, 0}, 0);
            assert_boxes(points, 1u << k, (const uint32_t[4]){0, 0, k, 0}, 0);
            assert_boxes(points, 1u << k, (const uint32_t[4]){0, 0, 0, k}, 0);
            for (uint32_t code = 0; k >= 3 && code < 8 * 8 * 8; code++) {
                uint32_t i = code % 8, j = code / 8 % 8, l = code / 64;
                if (i + j + l <= k - 3)
                    assert_boxes(points, 1u << k, (const uint32_t[4]){i, j, l, k - 3 - i - j - l},
                                 3);
            }
        }
    }
}

/* Both pairs are (0, 2)-sequences; the four together are not stratified: that is the difference. */
static void test_padded_strata(void **state)
{
    (void)state;
    static float points[1 << 10][4];
    for (uint32_t pixel = 0; pixel < 12; pixel++) {
        fill_points(points, FL_SAMPLER_PADDED, 1 << 10, fl_hash_step(SEED, pixel), FL_SET_CAMERA);
        for (uint32_t k = 0; k <= 10; k++)
            for (uint32_t i = 0; i <= k; i++) {
                assert_boxes(points, 1u << k, (const uint32_t[4]){i, k - i, 0, 0}, 0);
                assert_boxes(points, 1u << k, (const uint32_t[4]){0, 0, i, k - i}, 0);
            }
        for (uint32_t i = 0; i < 1 << 10; i++)
            for (uint32_t d = 0; d < 2; d++)
                assert_true(points[i][d] == fl_sample_scalar(FL_SAMPLER_SOBOL, SEED,
                                                             fl_hash_step(SEED, pixel), i,
                                                             FL_SET_CAMERA, d));
    }
}

/* --- independence ---------------------------------------------------------------------------- */

static double correlation(const double *x, const double *y, size_t n)
{
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0, count = (double)n;
    for (size_t i = 0; i < n; i++) {
        sx += x[i];
        sy += y[i];
        sxx += x[i] * x[i];
        syy += y[i] * y[i];
        sxy += x[i] * y[i];
    }
    double variance = (sxx - sx * sx / count) * (syy - sy * sy / count);
    return (sxy - sx * sy / count) / sqrt(variance);
}

enum { SIDE = 128, FIELD = SIDE * SIDE };

/* One number of one set over a field of pixels that is shifted by (dx, dy). */
static void fill_field(double *out, fl_sampler kind, uint32_t dx, uint32_t dy, uint32_t index,
                       uint32_t set, uint32_t dimension)
{
    for (uint32_t i = 0; i < FIELD; i++)
        out[i] = (double)fl_sample_scalar(kind, SEED, fl_pixel_id(i % SIDE + dx, i / SIDE + dy),
                                          index, set, dimension);
}

/* Over pixels all numbers are independent: of neighbours, dimensions, sets and sample numbers. The
 * correlation of n independent pairs has deviation 1 / sqrt(n); five of them are allowed. */
static void test_pixels_are_independent(void **state)
{
    (void)state;
    static double x[FIELD], y[FIELD];
    const double bound = 5.0 / SIDE;
    for (int kind = FL_SAMPLER_SOBOL; kind <= FL_SAMPLER_PADDED; kind++) {
        for (uint32_t code = 0; code < 4 * 3; code++) {
            uint32_t d = code % 4, index = code / 4 * 5, light = fl_set_light(SEED, 1, 0);
            fill_field(x, (fl_sampler)kind, 0, 0, index, FL_SET_CAMERA, d);
            double mean = 0;
            for (size_t i = 0; i < FIELD; i++)
                mean += x[i] / FIELD;
            assert_true(fabs(mean - 0.5) < bound / sqrt(12.0));
            for (uint32_t step = 1; step < 4; step++) { /* right, down, diagonal */
                fill_field(y, (fl_sampler)kind, step & 1u, step >> 1, index, FL_SET_CAMERA, d);
                assert_true(fabs(correlation(x, y, FIELD)) < bound);
            }
            fill_field(y, (fl_sampler)kind, 0, 0, index, FL_SET_CAMERA, (d + 1) % 4);
            assert_true(fabs(correlation(x, y, FIELD)) < bound);
            fill_field(y, (fl_sampler)kind, 0, 0, index, light, d);
            assert_true(fabs(correlation(x, y, FIELD)) < bound);
        }
    }
}

/* The errors of neighbouring pixels' estimates must be independent too, and small. */
static void test_errors_are_small_and_independent(void **state)
{
    (void)state;
    static double errors[2][FIELD], shifted[FIELD];
    const double exact = 3.14159265358979 / 4.0;
    double rms[2] = {0};
    for (int kind = 0; kind < 2; kind++) {
        for (uint32_t p = 0; p < FIELD; p++) {
            uint32_t pixel = fl_pixel_id(p % SIDE, p / SIDE), inside = 0;
            for (uint32_t i = 0; i < 64; i++) {
                float x = fl_sample_scalar((fl_sampler)kind, SEED, pixel, i, 9, 0);
                float y = fl_sample_scalar((fl_sampler)kind, SEED, pixel, i, 9, 1);
                inside += x * x + y * y < 1.0f;
            }
            errors[kind][p] = inside / 64.0 - exact;
            rms[kind] += errors[kind][p] * errors[kind][p] / FIELD;
        }
        for (uint32_t p = 0; p < FIELD; p++)
            shifted[p] = errors[kind][(p + 1) % FIELD];
        assert_true(fabs(correlation(errors[kind], shifted, FIELD)) < 5.0 / SIDE);
    }
    print_message("quarter disc, 64 samples: rms error %.4f sobol, %.4f random\n", sqrt(rms[0]),
                  sqrt(rms[1]));
    /* Independent: sqrt(p (1 - p) / 64) = 0.0513. Jittered in 8 x 8 cells: the circle cuts 15 of
     * them, each adds at most 1/6 on average over cuts, sqrt(15 / 6) / 64 = 0.0247; Owen's must be
     * better. */
    assert_true(fabs(sqrt(rms[1]) - 0.0513) < 0.002);
    assert_true(sqrt(rms[0]) < 0.0247);
}

/* --- wide equals scalar ---------------------------------------------------------------------- */

static void fill_lanes(void)
{
    for (uint32_t i = 0; i < N; i++) {
        pixels[i] = i < N / 2 ? fl_pixel_id(i % 640, i / 640) : fl_hash_step(SEED, i);
        paths[i] = i < N / 4 ? FL_PATH_CAMERA : fl_path_child(SEED, i / 3, i % 2);
    }
}

static void test_wide_equals_scalar(void **state)
{
    (void)state;
    fill_lanes();
    const fl_wide_table *table;
    for (int t = 0; (table = fl_wide_table_at(t)); t++) {
        for (uint32_t code = 0; code < 3 * 24; code++) {
            fl_sampler kind = (fl_sampler)(code % 3);
            uint32_t step = code / 3, seed = step % 5;
            uint32_t set = step % 3 ? fl_set_light(seed, FL_PATH_CAMERA, step) : FL_SET_CAMERA;
            uint32_t index = step < 12 ? step : fl_hash_step(SEED, step);
            fl_sample_pass pass = fl_sample_pass_begin(kind, seed, set, index);
            table->sample(got, &pass, pixels, N);
            for (uint32_t d = 0; d < 4; d++)
                for (size_t i = 0; i < N; i++)
                    want[d * N + i] = fl_sample_scalar(kind, seed, pixels[i], index, set, d);
            assert_memory_equal(got, want, sizeof want);
        }
        for (uint32_t code = 0; code < 3 * 8; code++) {
            fl_sampler kind = (fl_sampler)(code % 3);
            uint32_t light = code / 3, seed = fl_hash_step(SEED, light);
            uint32_t index = light < 4 ? light : fl_hash_step(SEED + 1, light);
            fl_sample_pass pass = fl_sample_pass_begin(kind, seed, 0, index);
            table->sample_light(got, &pass, light, pixels, paths, N);
            for (size_t i = 0; i < N; i++) {
                uint32_t set = fl_set_light(seed, paths[i], light);
                want[i] = fl_sample_scalar(kind, seed, pixels[i], index, set, 0);
                want[N + i] = fl_sample_scalar(kind, seed, pixels[i], index, set, 1);
            }
            assert_memory_equal(got, want, 2 * N * sizeof *got);
        }
        static uint32_t children[N];
        for (uint32_t branch = 0; branch < 2; branch++) {
            table->path_child(children, SEED, paths, branch, N);
            for (size_t i = 0; i < N; i++)
                assert_int_equal(children[i], fl_path_child(SEED, paths[i], branch));
        }
    }
}

static void test_stratified_wide_equals_scalar(void **state)
{
    (void)state;
    fill_lanes();
    const fl_wide_table *table;
    for (int t = 0; (table = fl_wide_table_at(t)); t++)
        for (uint32_t step = 0; step < 12; step++) {
            fl_sample_pass pass = fl_sample_pass_begin(FL_SAMPLER_STRATIFIED, SEED, step, 7 * step);
            pass.strata = 5 + step;
            table->sample(got, &pass, pixels, N);
            for (uint32_t d = 0; d < 4; d++)
                for (size_t i = 0; i < N; i++)
                    want[d * N + i] =
                        fl_sample_stratified(SEED, pixels[i], 7 * step, step, d, 5 + step);
            assert_memory_equal(got, want, sizeof want);
            table->sample_light(got, &pass, step, pixels, paths, N);
            for (size_t i = 0; i < N; i++) {
                uint32_t set = fl_set_light(SEED, paths[i], step);
                for (uint32_t d = 0; d < 2; d++)
                    want[d * N + i] =
                        fl_sample_stratified(SEED, pixels[i], 7 * step, set, d, 5 + step);
            }
            assert_memory_equal(got, want, 2 * N * sizeof *got);
        }
}

/* Of N points, each of the most square N strata of each pair has one, whatever N, and again after
 * N.
 */
static void test_stratified_fills_its_strata(void **state)
{
    (void)state;
    static const uint32_t shapes[][2] = {{1, 1}, {2, 1}, {2, 2}, {7, 1},
                                         {4, 3}, {4, 4}, {8, 8}, {25, 20}};
    static uint8_t seen[512];
    for (size_t s = 0; s < FL_COUNT_OF(shapes); s++)
        for (uint32_t code = 0; code < 64; code++) {
            uint32_t columns = shapes[s][0], rows = shapes[s][1], count = columns * rows;
            uint32_t pair = code % 2, begin = code % 3 * count;
            memset(seen, 0, sizeof seen);
            for (uint32_t i = begin; i < begin + count; i++) {
                float x = fl_sample_stratified(SEED, code, i, 3, 2 * pair, count);
                float y = fl_sample_stratified(SEED, code, i, 3, 2 * pair + 1, count);
                assert_true(x >= 0.0f && x < 1.0f && y >= 0.0f && y < 1.0f);
                uint32_t column = (uint32_t)((double)x * columns + 1e-6);
                uint32_t row = (uint32_t)((double)y * rows + 1e-6);
                seen[row * columns + column]++;
            }
            uint32_t once = 0;
            for (uint32_t i = 0; i < count; i++)
                once += seen[i] == 1;
            assert_int_equal(once, count);
        }
}

/* The numbers decide every picture, so they may not drift with compiler, machine or edit. */
static void test_pinned_numbers(void **state)
{
    (void)state;
    uint32_t hash = 2166136261u;
    for (uint32_t i = 0; i < 4096; i++) {
        float x =
            fl_sample_scalar((fl_sampler)(i % 2), i % 7, fl_pixel_id(i, i / 3), i / 11,
                             i % 3 ? fl_set_light(i % 7, i, i % 4) : FL_SET_CAMERA, i / 2 % 4);
        hash = hash_floats(hash, &x, 1);
    }
    assert_int_equal(hash, 0x2eb1df43);
}

/* --- warps ----------------------------------------------------------------------------------- */

static const double rotations[] = {0.0, 11.25, 90.0, -200.0};

static void test_warps_wide_equal_scalar(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < N; i++) { /* a grid with the corners and the centre, then any */
        bool is_grid = i < 65 * 65;
        u[i] = is_grid ? fminf((float)(i % 65) / 64.0f, 1.0f - 0x1p-24f) : test_unit(SEED, 2 * i);
        v[i] =
            is_grid ? fminf((float)(i / 65) / 64.0f, 1.0f - 0x1p-24f) : test_unit(SEED, 2 * i + 1);
    }
    static const float frame[9] = {1.0f, -2.0f, 3.0f, 0.5f, 0.1f, -0.3f, 0.2f, 0.7f, 0.4f};
    const fl_wide_table *table;
    for (int t = 0; (table = fl_wide_table_at(t)); t++) {
        for (uint32_t blades = 0; blades <= 9; blades += blades ? 1 : 3) {
            fl_aperture aperture = fl_aperture_make(blades, rotations[blades % 4]);
            table->warp(got, &aperture, u, v, N);
            for (size_t i = 0; i < N; i++)
                fl_f_warp_aperture(&aperture, u[i], v[i], &want[i], &want[N + i]);
            assert_same_lanes("warp x", table->width, got, want, u, v, N);
            assert_same_lanes("warp y", table->width, got + N, want + N, u, v, N);
        }
        table->disk_light(got, frame, u, v, N);
        for (size_t i = 0; i < N; i++) {
            float point[3];
            fl_f_warp_disk_light(frame, frame + 3, frame + 6, u[i], v[i], point);
            for (size_t axis = 0; axis < 3; axis++)
                want[axis * N + i] = point[axis];
        }
        for (size_t axis = 0; axis < 3; axis++)
            assert_same_lanes("disk light", table->width, got + axis * N, want + axis * N, u, v, N);
    }
}

/* Fractions of the area by exact strata: a (0,2)-net of 2^14 points measures a simple region to
 * about 2^-10. Moments: mean 0; mean square (2 + cos(2 pi / n)) / 6 of an n-gon, 1/2 of the disc.
 */
static void test_warps_are_uniform(void **state)
{
    (void)state;
    for (uint32_t blades = 0; blades <= 9; blades += blades ? 1 : 3) {
        fl_aperture aperture = fl_aperture_make(blades, rotations[blades % 4]);
        double sum_x = 0, sum_y = 0, sum_square = 0, corner_c, corner_s;
        uint32_t inner = 0;
        fl_d_sincos_turns(blades ? 1.0 / blades : 0.0, &corner_s, &corner_c);
        for (uint32_t i = 0; i < N; i++) {
            float x, y;
            fl_f_warp_aperture(&aperture, fl_sample_scalar(FL_SAMPLER_SOBOL, SEED, 5, i, 0, 0),
                               fl_sample_scalar(FL_SAMPLER_SOBOL, SEED, 5, i, 0, 1), &x, &y);
            double square = (double)x * (double)x + (double)y * (double)y;
            assert_true(square <= 1.0 + 0x1p-21);
            sum_x += (double)x / N;
            sum_y += (double)y / N;
            sum_square += square / N;
            inner += square < 0.09; /* radius 0.3 is inside the triangle as well */
        }
        double area = blades ? blades * corner_s / 2.0 : 3.14159265358979;
        double mean_square = blades ? (2.0 + corner_c) / 6.0 : 0.5;
        assert_true(fabs(sum_x) < 1e-3 && fabs(sum_y) < 1e-3);
        assert_true(fabs(sum_square - mean_square) < 1e-3);
        assert_true(fabs(inner / (double)N - 0.09 * 3.14159265358979 / area) < 2e-3);
    }
}

/* Corners lie where the rotation says, and every point is inside all the polygon's edges. */
static void test_polygon_shape(void **state)
{
    (void)state;
    for (uint32_t blades = 3; blades <= 9; blades++) {
        double rotation = rotations[blades % 4];
        fl_aperture aperture = fl_aperture_make(blades, rotation);
        double s, c, edge;
        fl_d_sincos_deg(180.0 / blades, &s, &edge); /* distance of an edge from the centre */
        float x, y;
        fl_f_warp_aperture(&aperture, 0.0f, 1.0f, &x, &y);
        fl_d_sincos_deg(rotation, &s, &c);
        assert_true(fabs((double)x - c) < 2e-7 && fabs((double)y - s) < 2e-7);
        for (uint32_t i = 0; i < 4000; i++) {
            fl_f_warp_aperture(&aperture, test_unit(SEED, 2 * i), test_unit(SEED, 2 * i + 1), &x,
                               &y);
            for (uint32_t k = 0; k < blades; k++) {
                fl_d_sincos_deg(rotation + 360.0 * (k + 0.5) / blades, &s, &c);
                assert_true((double)x * c + (double)y * s <= edge + 3e-7);
            }
        }
    }
}

/* Concentric means continuous: neighbours on the square are neighbours on the disc. The map
 * stretches by 2 sqrt(1 + (pi/4)^2) < 2.55 at most. */
static void test_disk_is_continuous(void **state)
{
    (void)state;
    const float step = 0x1p-8f;
    for (float y = 0.0f; y < 1.0f; y += step)
        for (float x = 0.0f; x < 1.0f - step; x += step) {
            float p[2], q[2], r[2];
            fl_f_warp_disk(x, y, &p[0], &p[1]);
            fl_f_warp_disk(x + step, y, &q[0], &q[1]);
            fl_f_warp_disk(y, x + step, &r[0], &r[1]); /* mirrored at the diagonal */
            assert_true(hypotf(p[0] - q[0], p[1] - q[1]) < 2.55f * step);
            assert_true(fabsf(q[0] - r[1]) < 1e-6f && fabsf(q[1] - r[0]) < 1e-6f);
        }
}

/* --- cost, not asserted ---------------------------------------------------------------------- */

static double cpu_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

enum { COSTS = 4, REPEATS = 9 };

/* CPU time of one round over all lanes: a set of four dimensions, a pair of a set of its own, the
 * two warps. */
static void time_round(const fl_wide_table *table, uint32_t i, double out_ns[COSTS])
{
    fl_aperture round = fl_aperture_make(0, 0.0), hexagon = fl_aperture_make(6, 15.0);
    double at[COSTS + 1] = {cpu_ns()};
    fl_sample_pass pass = fl_sample_pass_begin(FL_SAMPLER_SOBOL, SEED, FL_SET_CAMERA, i);
    table->sample(got, &pass, pixels, N);
    at[1] = cpu_ns();
    table->sample_light(got, &pass, i, pixels, paths, N);
    at[2] = cpu_ns();
    table->warp(got, &round, u, v, N);
    at[3] = cpu_ns();
    table->warp(got, &hexagon, u, v, N);
    at[4] = cpu_ns();
    for (int c = 0; c < COSTS; c++)
        out_ns[c] += at[c + 1] - at[c];
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Medians of interleaved repeats. */
static void test_print_cost(void **state)
{
    (void)state;
    enum { ROUNDS = 12 };
    fill_lanes();
    const fl_wide_table *table;
    for (int t = 0; (table = fl_wide_table_at(t)); t++) {
        double ns[COSTS][REPEATS];
        for (int r = 0; r < REPEATS; r++) {
            double sum[COSTS] = {0};
            for (uint32_t i = 0; i < ROUNDS; i++)
                time_round(table, i, sum);
            for (int c = 0; c < COSTS; c++)
                ns[c][r] = sum[c] / (ROUNDS * N);
        }
        for (int c = 0; c < COSTS; c++)
            qsort(ns[c], REPEATS, sizeof(double), by_size);
        enum { MEDIAN = REPEATS / 2 };
        print_message("width %u, ns a sample: 4-D set %.2f (%.2f a dimension, least %.2f), "
                      "2-D set of its own %.2f, disc %.2f, hexagon %.2f\n",
                      table->width, ns[0][MEDIAN], ns[0][MEDIAN] / 4, ns[0][0] / 4, ns[1][MEDIAN],
                      ns[2][MEDIAN], ns[3][MEDIAN]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sobol_equals_direction_matrices),
        cmocka_unit_test(test_reversal_and_nesting),
        cmocka_unit_test(test_strata),
        cmocka_unit_test(test_padded_strata),
        cmocka_unit_test(test_pixels_are_independent),
        cmocka_unit_test(test_errors_are_small_and_independent),
        cmocka_unit_test(test_wide_equals_scalar),
        cmocka_unit_test(test_stratified_wide_equals_scalar),
        cmocka_unit_test(test_stratified_fills_its_strata),
        cmocka_unit_test(test_pinned_numbers),
        cmocka_unit_test(test_warps_wide_equal_scalar),
        cmocka_unit_test(test_warps_are_uniform),
        cmocka_unit_test(test_polygon_shape),
        cmocka_unit_test(test_disk_is_continuous),
        cmocka_unit_test(test_print_cost),
    };
    return cmocka_run_group_tests_name("sampler", tests, NULL, NULL);
}
