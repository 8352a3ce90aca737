/* SPDX-License-Identifier: MIT
 *
 * usage: bench_revolve [ROUNDS]
 *        bench_revolve frame [ROUNDS]    only the primary rays of the vase at 640x640, as
 * bench/revolve/pov.sh asks Nanoseconds a ray of CPU time of this thread, medians over interleaved
 * rounds: the certified solver one ray at a time and in packets of eight, and the Newton baseline,
 * on the camera rays of four profiles, hits and misses apart.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/revolve.h"

enum { SIDE = 640, MAX_ROUNDS = 101, MAX_POINTS = 64 };

typedef enum method { SINGLE, PACKET, NEWTON, METHODS } method;

typedef struct rays {
    double (*d)[3];
    fl_revolve_packet *packets; /* the same rays, padded with the last one */
    size_t count;
} rays;

typedef struct view {
    const char *name;
    fl_revolve *revolve;
    uint32_t segments;
    double eye[3];
    rays hit, miss;
} view;

static double now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void *must(void *memory)
{
    if (!memory) {
        fprintf(stderr, "bench_revolve: out of memory\n");
        exit(4);
    }
    return memory;
}

/* Uniform cubic B-spline to Bezier segments. */
static fl_profile spline(fl_arena *arena, const double (*p)[2], uint32_t count)
{
    fl_profile out = {.segment_count = count - 3, .degree = 3};
    out.points = must(fl_arena_alloc(arena, (size_t)4 * out.segment_count, sizeof *out.points));
    for (uint32_t s = 0; s < out.segment_count; s++) {
        double b[2][4];
        for (int k = 0; k < 2; k++) {
            double p0 = p[s][k], p1 = p[s + 1][k], p2 = p[s + 2][k], p3 = p[s + 3][k];
            b[k][0] = (p0 + 4 * p1 + p2) / 6;
            b[k][1] = (2 * p1 + p2) / 3;
            b[k][2] = (p1 + 2 * p2) / 3;
            b[k][3] = (p1 + 4 * p2 + p3) / 6;
        }
        for (int i = 0; i < 4; i++)
            out.points[4 * s + (uint32_t)i] = fl_v3(b[0][i], b[1][i], 0.0);
    }
    return out;
}

/* The vase of the figures: foot, belly, neck and lip; pov.sh has the same points. */
static const double vase_points[][2] = {{0.00, -0.12}, {0.52, 0.04}, {0.58, 0.22}, {1.00, 0.72},
                                        {0.62, 1.38},  {0.24, 1.72}, {0.52, 2.16}, {0.56, 2.30}};

/* A gently waved wall of `segments` spline segments: the same outline whatever their number. */
static fl_profile wave(fl_arena *arena, uint32_t segments)
{
    double p[MAX_POINTS][2];
    uint32_t count = segments + 3;
    for (uint32_t i = 0; i < count; i++) {
        double y = 2.2 * ((double)i - 1.0) / (count - 3.0);
        double bump = y * (2.2 - y);
        p[i][0] = 0.35 + 0.4 * bump + (segments > 8 ? 0.02 * (i & 1 ? 1.0 : -1.0) : 0.0);
        p[i][1] = y;
    }
    return spline(arena, (const double(*)[2])p, count);
}

static fl_profile single_cubic(fl_arena *arena)
{
    fl_profile out = {.segment_count = 1, .degree = 3};
    out.points = must(fl_arena_alloc(arena, 4, sizeof *out.points));
    out.points[0] = fl_v3(0.4, 0.0, 0.0);
    out.points[1] = fl_v3(1.5, 0.7, 0.0);
    out.points[2] = fl_v3(0.0, 1.5, 0.0);
    out.points[3] = fl_v3(0.6, 2.2, 0.0);
    return out;
}

/* Camera ray through pixel (i, j): eye (0, 2.2, -6.2), looking at (0, 1.1, 0), 28 degrees. */
static void camera_ray(int i, int j, double d[3])
{
    const double forward[3] = {0.0, -0.174692, 0.984623}, up[3] = {0.0, 0.984623, 0.174692},
                 half = 0.249328;
    double a = half * (2.0 * (i + 0.5) / SIDE - 1.0), b = half * (1.0 - 2.0 * (j + 0.5) / SIDE);
    d[0] = a;
    d[1] = forward[1] + b * up[1];
    d[2] = forward[2] + b * up[2];
}

static void pack(const double eye[3], rays *r)
{
    size_t count = (r->count + FL_REVOLVE_PACKET - 1) / FL_REVOLVE_PACKET;
    r->packets = must(aligned_alloc(64, (count + 1) * sizeof *r->packets));
    for (size_t i = 0; i < count * FL_REVOLVE_PACKET; i++) {
        fl_revolve_packet *p = &r->packets[i / FL_REVOLVE_PACKET];
        size_t lane = i % FL_REVOLVE_PACKET, at = i < r->count ? i : r->count - 1;
        p->ox[lane] = eye[0];
        p->oy[lane] = eye[1];
        p->oz[lane] = eye[2];
        p->dx[lane] = r->d[at][0];
        p->dy[lane] = r->d[at][1];
        p->dz[lane] = r->d[at][2];
        p->u_min[lane] = 0.0;
        p->u_max[lane] = HUGE_VAL;
    }
}

static view make_view(fl_arena *arena, const char *name, const fl_profile *profile)
{
    fl_diags diags = {0};
    view v = {.name = name, .segments = profile->segment_count, .eye = {0.0, 2.2, -6.2}};
    v.revolve = fl_revolve_build(arena, profile, &diags);
    if (!v.revolve) {
        fprintf(stderr, "bench_revolve: %s\n", diags.items[0].message);
        exit(1);
    }
    v.hit.d = must(malloc((size_t)SIDE * SIDE * sizeof *v.hit.d));
    v.miss.d = must(malloc((size_t)SIDE * SIDE * sizeof *v.miss.d));
    for (int j = 0; j < SIDE; j++) {
        for (int i = 0; i < SIDE; i++) {
            double d[3];
            fl_revolve_hit hit;
            camera_ray(i, j, d);
            bool is_hit =
                fl_revolve_nearest(v.revolve, v.eye, d, 0.0, HUGE_VAL, FL_REVOLVE_ROBUST, &hit);
            rays *r = is_hit ? &v.hit : &v.miss;
            memcpy(r->d[r->count++], d, sizeof d);
        }
    }
    pack(v.eye, &v.hit);
    pack(v.eye, &v.miss);
    return v;
}

static void free_view(view *v)
{
    free(v->hit.d);
    free(v->miss.d);
    free(v->hit.packets);
    free(v->miss.packets);
}

/* CPU time a ray; *hits counts what was found, so that nothing can be left out. */
static double time_rays(const view *v, const rays *r, method m, size_t *hits)
{
    fl_revolve_solver solver = m == NEWTON ? FL_REVOLVE_NEWTON : FL_REVOLVE_ROBUST;
    fl_revolve_hit hit[FL_REVOLVE_PACKET];
    size_t found = 0;
    double begin = now_ns();
    if (m == PACKET) {
        for (size_t i = 0; i * FL_REVOLVE_PACKET < r->count; i++)
            found += (size_t)__builtin_popcount(
                fl_revolve_nearest8(v->revolve, &r->packets[i], 0xff, solver, hit));
    } else {
        for (size_t i = 0; i < r->count; i++)
            found += fl_revolve_nearest(v->revolve, v->eye, r->d[i], 0.0, HUGE_VAL, solver, hit);
    }
    double ns = (now_ns() - begin) / (double)r->count;
    *hits = found;
    return ns;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(double *v, int count)
{
    qsort(v, (size_t)count, sizeof *v, by_value);
    return v[count / 2];
}

static void report(const view *v, int rounds, double out[METHODS][2])
{
    static double ns[METHODS][2][MAX_ROUNDS];
    size_t found[METHODS][2];
    for (int round = 0; round < rounds; round++)
        for (int m = 0; m < METHODS; m++)
            for (int k = 0; k < 2; k++)
                ns[m][k][round] = time_rays(v, k ? &v->miss : &v->hit, (method)m, &found[m][k]);
    for (int m = 0; m < METHODS; m++)
        for (int k = 0; k < 2; k++)
            out[m][k] = median(ns[m][k], rounds);
    printf("%-13s %3u segments %4u pieces  hits %7zu: single %6.1f packet %6.1f newton %7.1f ns, "
           "x%5.1f;"
           "  misses %7zu: single %6.1f packet %6.1f newton %7.1f ns, x%6.1f\n",
           v->name, v->segments, fl_revolve_piece_count(v->revolve), v->hit.count, out[SINGLE][0],
           out[PACKET][0], out[NEWTON][0], out[NEWTON][0] / out[PACKET][0], v->miss.count,
           out[SINGLE][1], out[PACKET][1], out[NEWTON][1], out[NEWTON][1] / out[PACKET][1]);
    printf("              newton found %zu of the hits and %zu where there is none\n",
           found[NEWTON][0], found[NEWTON][1]);
}

/* All primary rays of a frame in packets, 8 in a row, made on the way as a renderer would. */
static void report_frame(const view *v, int rounds)
{
    double ms[MAX_ROUNDS];
    size_t hits = 0;
    for (int round = 0; round < rounds; round++) {
        double begin = now_ns();
        hits = 0;
        for (int j = 0; j < SIDE; j++) {
            for (int i = 0; i < SIDE; i += FL_REVOLVE_PACKET) {
                fl_revolve_packet p;
                fl_revolve_hit hit[FL_REVOLVE_PACKET];
                for (int lane = 0; lane < FL_REVOLVE_PACKET; lane++) {
                    double d[3];
                    camera_ray(i + lane, j, d);
                    p.ox[lane] = v->eye[0];
                    p.oy[lane] = v->eye[1];
                    p.oz[lane] = v->eye[2];
                    p.dx[lane] = d[0];
                    p.dy[lane] = d[1];
                    p.dz[lane] = d[2];
                    p.u_min[lane] = 0.0;
                    p.u_max[lane] = HUGE_VAL;
                }
                hits += (size_t)__builtin_popcount(
                    fl_revolve_nearest8(v->revolve, &p, 0xff, FL_REVOLVE_ROBUST, hit));
            }
        }
        ms[round] = (now_ns() - begin) * 1e-6;
    }
    printf("frame: %d primary rays, %zu hits, %.2f ms of CPU time (median of %d)\n", SIDE * SIDE,
           hits, median(ms, rounds), rounds);
}

int main(int argc, char **argv)
{
    bool frame_only = argc > 1 && strcmp(argv[1], "frame") == 0;
    const char *rounds_text = argc > 1 + frame_only ? argv[1 + frame_only] : "11";
    long rounds = strtol(rounds_text, NULL, 10);
    if (rounds < 1 || rounds > MAX_ROUNDS) {
        fprintf(stderr, "usage: bench_revolve [frame] [ROUNDS, 1 to %d]\n", MAX_ROUNDS);
        return 2;
    }
    fl_arena arena = {0};
    fl_profile vase = spline(&arena, vase_points, FL_COUNT_OF(vase_points));
    view v = make_view(&arena, "vase", &vase);
    double eight[METHODS][2], forty[METHODS][2], other[METHODS][2];
    if (!frame_only) {
        report(&v, (int)rounds, other);
        fl_profile profiles[3] = {single_cubic(&arena), wave(&arena, 8), wave(&arena, 40)};
        const char *names[3] = {"single cubic", "8 segments", "40 segments"};
        for (int i = 0; i < 3; i++) {
            view w = make_view(&arena, names[i], &profiles[i]);
            report(&w, (int)rounds, i == 0 ? other : i == 1 ? eight : forty);
            free_view(&w);
        }
        printf("40 segments cost x%.2f of 8 for hits, x%.2f for misses (packets)\n",
               forty[PACKET][0] / eight[PACKET][0], forty[PACKET][1] / eight[PACKET][1]);
    }
    report_frame(&v, (int)rounds);
    free_view(&v);
    fl_arena_deinit(&arena);
    return 0;
}
