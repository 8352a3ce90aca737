/* SPDX-License-Identifier: MIT
 *
 * usage: self_hits [RAYS [NAME]]     rays a kind, default 1e6; only kinds with NAME in theirs
 *
 * Rays that leave a surface as the renderer lets them leave (decision 13): how many meet again what
 * they cannot meet (false), and how many miss what they must meet (lost). Scales 1e-6, 1, 1e6; 0,
 * 1e3, 1e5 and 1e7 sizes from the world's origin; then with something else as far on the other
 * side, so that floats count from the middle between the two; a quarter of the directions graze.
 * Convex and flat shapes know the answer; for the others it is that of double precision, except
 * within a float's rounding (judge_by_double), of which there may be twice as much as was measured.
 * Exit 1 if there is any wrong one, too much rounding, or an exit chord further off than a ray's
 * start.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/extremes.h"
#include "core/double_trace.h"
#include "core/trace_piece.h"
#include "support/rounded.h"

enum { PIECE = 1024 };

/* What may be wrong with the exit chord 2 (c - o).d / d.d of a sphere, in offsets: one for the step
 * away, as much for rounding where that ends, and eight roundings of floats, three for each of the
 * products, one for c - o and one for the quotient. An offset is 1.15 of those or more. */
static const double chord_offsets_max = 9.0;

typedef enum truth { NEVER, CONVEX, BY_DOUBLE } truth;

typedef struct kind {
    const char *name, *object;
    truth truth;
    double far; /* Sizes from something else, at most: beyond it a step away from the surface, */
    fl_vec3 center; /* which is what floats cost, is as large as the object is thin. */
    double radius;  /* Centre and radius of the first object, where not the origin and 1. */
    double excused, excused_beside; /* Share within rounding, as measured; the second with else. */
} kind;

#define VASE                                                                                       \
    "RevSurface { profile BezierCurve { controls [0.3 -1 0][1.6 -0.5 0][-0.4 0.5 0][0.9 1 0] } }"
#define RING                                                                                       \
    "RevSurface { profile BezierCurve { piecewise 1 controls [0.9 0 0][0.9 0.133 0][0.8 0.2 0]"    \
    "[0.7 0.2 0][0.57 0.2 0][0.5 0.1 0][0.5 0 0][0.5 -0.1 0][0.57 -0.2 0][0.7 -0.2 0]"             \
    "[0.8 -0.2 0][0.9 -0.133 0][0.9 0 0] } }"
#define TILT(object) "Transform { Rotate { 1 2 3 77 } Scale 1 0.05 0.7 " object " }"
/* With something on the other side, so that the geometry's origin stays between them. */
#define FAR_OFF(object) "Transform { Translate 30 -70 50 UniformScale 0.5 " object " }"
#define SPHERE          "Sphere { center 0 0 0 radius 1 }"
#define BALL            "TriangleMesh { file ball.obj normals flat }"

#define BESIDE " Sphere { center -60 50 -40 radius 0.3 }"

static const kind kinds[] = {
    {"sphere", SPHERE, CONVEX, .far = 1e5},
    {"sphere, transformed", TILT(SPHERE), CONVEX, .far = 1e3},
    {"sphere, off the origin", FAR_OFF(SPHERE) BESIDE, CONVEX, .far = 1e5, .center = {30, -70, 50},
     .radius = 0.5},
    {"the same, transformed", FAR_OFF(TILT(SPHERE)) BESIDE, CONVEX, .far = 1e2,
     .center = {30, -70, 50}, .radius = 0.5},
    {"plane", "Plane { normal 0.3 1 -0.2 offset 0.1 }", NEVER, .far = 1e5},
    {"square", "Square { corner -1 -1 0.2 u 2 0 0.3 v 0 2 -0.1 }", NEVER, .far = 1e5},
    {"disk", "Disk { center 0.1 0 0 normal 1 2 3 radius 1 }", NEVER, .far = 1e5},
    {"triangle", "Triangle { vertex0 -1 -1 0 vertex1 1 -1 0.2 vertex2 0 1 -0.1 }", NEVER,
     .far = 1e5},
    {"mesh, convex", BALL, CONVEX, .far = 1e5},
    {"mesh, transformed", TILT(BALL), BY_DOUBLE, .far = 1e2, .excused = 3.2e-5,
     .excused_beside = 4.4e-4}, /* its rim is thinner than rounding */
    {"triangles in a valley",
     "Triangle { vertex0 -1 0 0 vertex1 1 0 0 vertex2 -1 0.7 1 } Triangle { vertex0 1 0 0 vertex1 "
     "1 0.7 1 vertex2 -1 0.7 1 } Triangle { vertex0 -1 0 0 vertex1 -1 0.6 -1 vertex2 1 0 0 } "
     "Triangle { vertex0 1 0 0 vertex1 -1 0.6 -1 vertex2 1 0.6 -1 }",
     BY_DOUBLE, .far = 1e5, .excused = 6.2e-6, .excused_beside = 4.4e-3},
    {"revolution, vase", VASE, BY_DOUBLE, .far = 1e3, .excused = 3.2e-4, .excused_beside = 7e-3},
    {"revolution, ring", RING, BY_DOUBLE, .far = 1e3, .excused = 1.2e-4, .excused_beside = 7.5e-3},
    {"revolution, transformed", TILT(VASE), BY_DOUBLE, .far = 1e2, .excused = 7.8e-3,
     .excused_beside = 3.6e-2},
};

typedef struct tally {
    uint64_t rays, false_hits, lost_hits, excused;
    double worst_chord; /* Error of a sphere's exit chord, in what the ray's start may do to it. */
} tally;

typedef struct bench {
    fl_compiled *compiled;
    fl_vec3 center; /* Of the object, in the space of the geometry. */
    double size;
    fl_affine to_sphere; /* Where it is a sphere: to the space where its centre is 0, */
    double radius;       /* and its radius there. */
    uint32_t other;      /* What is beside it; FL_NONE: nothing. */
    fl_piece piece;
    uint64_t random;
} bench;

static double unit(bench *b)
{
    b->random = b->random * 6364136223846793005u + 1442695040888963407u;
    return (double)(b->random >> 40) * 0x1p-24;
}

static fl_vec3 direction(bench *b)
{
    for (;;) {
        fl_vec3 v = fl_v3(2 * unit(b) - 1, 2 * unit(b) - 1, 2 * unit(b) - 1);
        double square = fl_v3_dot(v, v);
        if (square > 1e-4 && square < 1.0)
            return fl_v3_scale(v, 1.0 / sqrt(square));
    }
}

/* The first object, exactly. */
static void find_sphere(bench *b)
{
    const fl_geometry *g = &b->compiled->geometry;
    if (g->object_kind[0] != FL_OBJECT_SPHERE)
        return;
    fl_vec3 center = g->spheres.center[g->object_entry[0]];
    b->radius = g->spheres.radius[g->object_entry[0]];
    b->to_sphere = fl_affine_identity();
    if (g->object_instance[0] != FL_NONE)
        b->to_sphere = g->instances[g->object_instance[0]].to_object_exact;
    b->to_sphere.m[0][3] -= center.x;
    b->to_sphere.m[1][3] -= center.y;
    b->to_sphere.m[2][3] -= center.z;
}

/* `is_beside`: with something as far on the other side of 0, so that the floats' origin is there.
 */
static bool open_bench(bench *b, const kind *k, double scale, double distance, bool is_beside)
{
    char text[2048], other[128] = "";
    if (is_beside)
        snprintf(other, sizeof other, "Sphere { center %g %g %g radius %g }", -2.0 * distance,
                 1.4 * distance, -0.6 * distance, 0.01 * distance);
    fl_diags diags = {0};
    snprintf(text, sizeof text,
             "firstlight 1\nMaterials { Material { diffuseColor 1 1 1 } }\nGroup { MaterialIndex 0 "
             "%s %s }\n",
             k->object, other);
    double far = distance * scale;
    fl_vec3 offset = fl_v3(far, -0.7 * far, 0.3 * far);
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), k->name, &(fl_parse_options){0}, &extreme_files, &diags);
    if (scene && fl_scene_map(scene, scale, offset, &diags))
        b->compiled = fl_compile(scene, &(fl_compile_options){.in_double = true}, NULL, &diags);
    for (uint32_t i = 0; i < diags.count; i++)
        fprintf(stderr, "self_hits: %s: %s\n", k->name, diags.items[i].message);
    b->other = scene && is_beside ? scene->object_count - 1 : FL_NONE;
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    if (!b->compiled || !fl_piece_init(&b->piece, PIECE))
        return false;
    b->center = fl_v3_sub(fl_v3_mad(offset, k->center, scale), b->compiled->geometry.origin);
    b->size = scale * (k->radius > 0.0 ? k->radius : 1.0);
    find_sphere(b);
    return true;
}

static void close_bench(bench *b)
{
    fl_piece_deinit(&b->piece);
    fl_compiled_release(b->compiled);
}

/* Camera rays that meet the object or pass it by, and the surfaces where they do. */
static void first_hits(bench *b)
{
    fl_isect_context context = {0};
    const fl_isect_kernels *kernels = fl_isect_kernels_of(b->compiled->isa);
    for (uint32_t i = 0; i < PIECE; i++) {
        double away = i % 8 == 0 ? 100.0 : 3.0;
        fl_vec3 from = fl_v3_mad(b->center, direction(b), away * b->size);
        fl_vec3 to = fl_v3_mad(b->center, direction(b), b->size * unit(b));
        fl_rays_set(&b->piece.rays, i, from, fl_v3_sub(to, from), INFINITY);
    }
    fl_piece_set_count(&b->piece.rays, PIECE);
    kernels->nearest(&b->compiled->geometry, &b->piece.rays, &b->piece.hits, &context);
    kernels->resolve(&b->compiled->geometry, &b->piece.rays, &b->piece.hits, NULL,
                     &b->piece.surface, &context);
}

static fl_vec3 vec(const float *x, const float *y, const float *z, uint32_t i)
{
    return fl_v3((double)x[i], (double)y[i], (double)z[i]);
}

/* A ray that left, and what is known about where from. */
typedef struct leaving {
    fl_double_ray first;
    fl_vec3 p, ng, d;
    double offset;
    uint32_t object, prim;
} leaving;

/* Replace the rays of the piece by rays that leave where they hit; returns how many. */
static uint32_t leave(bench *b, leaving *out)
{
    fl_rays *r = &b->piece.rays;
    const fl_surface *s = &b->piece.surface;
    uint32_t count = 0;
    for (uint32_t i = 0; i < PIECE; i++) {
        uint32_t object = b->piece.hits.object[i];
        if (object == FL_NONE || object == b->other)
            continue;
        leaving *l = &out[count];
        l->first = (fl_double_ray){vec(r->ox, r->oy, r->oz, i), vec(r->dx, r->dy, r->dz, i),
                                   HUGE_VAL, FL_NONE, FL_NONE};
        l->object = object;
        l->prim = b->piece.hits.prim[i];
        l->p = vec(s->px, s->py, s->pz, i);
        l->ng = vec(s->ngx, s->ngy, s->ngz, i);
        l->offset = (double)s->offset[i];
        fl_vec3 d = direction(b);
        if (i % 4 == 3) { /* graze */
            double up = fl_v3_dot(d, l->ng);
            d = fl_v3_mad(d, l->ng, up * (unit(b) < 0.5 ? 1e-2 : 1e-4) - up);
        }
        l->d = fl_v3(rounded(d.x), rounded(d.y), rounded(d.z));
        count++;
    }
    for (uint32_t i = 0; i < count; i++) {
        const leaving *l = &out[i];
        double step = copysign(l->offset, fl_v3_dot(l->ng, l->d));
        fl_rays_set(r, i, fl_v3_mad(l->p, l->ng, step), l->d, INFINITY);
        r->source_object[i] = l->object;
        r->source_prim[i] = l->prim;
    }
    fl_piece_set_count(r, count);
    return count;
}

/* Where the ray left from, in double; false: its camera ray met something else there. */
static bool first_in_double(const bench *b, const leaving *l, fl_double_hit *hit,
                            fl_double_surface *out)
{
    fl_isect_context context = {0};
    const fl_geometry *g = &b->compiled->geometry;
    if (!fl_double_nearest(g, &l->first, &context, hit) || hit->object != l->object ||
        hit->prim != l->prim)
        return false;
    fl_double_resolve(g, &l->first, hit, false, out);
    return true;
}

/* Another way to leave: with the direction moved, from where the float renderer met the surface
 * (`out` 0: from where double did), so many offsets out and aside. */
typedef struct move {
    double turn[2], out, aside[2];
} move;

/* Whether, and how far along the ray, it meets anything when it leaves in double, moved. */
static bool meets_in_double(const bench *b, const leaving *l, const fl_double_surface *s,
                            const move *m, double *out_t)
{
    fl_isect_context context = {0};
    fl_double_hit hit;
    bool is_own = m->out > 0.0;
    fl_vec3 p = is_own ? l->p : s->p, ng = is_own ? l->ng : s->ng;
    fl_vec3 side = fl_v3_normalize(fl_v3_cross(l->d, fl_v3(0.3, 0.5, 0.8)));
    fl_vec3 up = fl_v3_cross(l->d, side);
    fl_vec3 d = fl_v3_mad(fl_v3_mad(l->d, side, m->turn[0]), up, m->turn[1]);
    double step = copysign(is_own ? m->out * l->offset : s->offset, fl_v3_dot(ng, l->d));
    p = fl_v3_mad(fl_v3_mad(p, side, m->aside[0] * l->offset), up, m->aside[1] * l->offset);
    fl_double_ray ray = {fl_v3_mad(p, ng, step), d, HUGE_VAL, l->object, l->prim};
    bool is_hit = fl_double_nearest(&b->compiled->geometry, &ray, &context, &hit);
    *out_t = is_hit ? hit.t : 0.0;
    return is_hit;
}

/* Rounding decides, and nothing is counted, where the two normals disagree about the side that the
 * ray leaves to, where the true hit is within sixteen times the height at which a float origin
 * stands, and where the answer changes as the ray moves a little. A ray is off in height by 14 of
 * the 16 roundings that make its offset, at most (kernel_resolve_mesh.h): 1/8 to 15/8 of it;
 * aside by 2 roundings in each of three axes, a quarter of it. */
static void judge_by_double(const bench *b, const leaving *l, bool is_hit, tally *t)
{
    static const move none = {{0, 0}, 0, {0, 0}},
                      moves[] = {
                          {{2e-6, 0}, 0, {0, 0}},  {{-2e-6, 0}, 0, {0, 0}}, {{0, 2e-6}, 0, {0, 0}},
                          {{0, -2e-6}, 0, {0, 0}}, {{0, 0}, 1, {0, 0}},     {{1e-5, 0}, 1, {0, 0}},
                          {{-1e-5, 0}, 1, {0, 0}}, {{0, 0}, 0.125, {0, 0}}, {{0, 0}, 1.875, {0, 0}},
                          {{0, 0}, 1, {0.25, 0}},  {{0, 0}, 1, {-0.25, 0}}, {{0, 0}, 1, {0, 0.25}},
                          {{0, 0}, 1, {0, -0.25}}};
    fl_double_hit first;
    fl_double_surface s;
    double distance, slope = fabs(fl_v3_dot(l->ng, l->d));
    if (!first_in_double(b, l, &first, &s)) {
        t->excused++;
        return;
    }
    bool is_true = meets_in_double(b, l, &s, &none, &distance);
    if (is_true == is_hit)
        return;
    bool is_excused = slope <= fl_v3_length(fl_v3_sub(s.ng, l->ng)) + 2e-7 ||
                      (is_true && distance <= 16.0 * l->offset);
    for (size_t k = 0; k < FL_COUNT_OF(moves) && !is_excused; k++)
        is_excused = meets_in_double(b, l, &s, &moves[k], &distance) == is_hit;
    t->excused += is_excused ? 1 : 0;
    t->false_hits += !is_excused && is_hit ? 1 : 0;
    t->lost_hits += !is_excused && !is_hit ? 1 : 0;
}

/* How far the exit chord is off, in parts of what it changes by when the ray's start moves as far
 * as leaving moves it. */
static double chord_error(const bench *b, const leaving *l, double t)
{
    const fl_affine *m = &b->to_sphere;
    fl_vec3 n = fl_v3_normalize(fl_affine_point(m, l->p)), d = fl_affine_direction(m, l->d);
    double inward = -fl_v3_dot(n, d), square = fl_v3_dot(d, d), norm = 0.0;
    double chord = 2.0 * b->radius * inward / square, slope = inward / sqrt(square);
    for (int i = 0; i < 3; i++)
        norm = fl_max(fabs(m->m[i][0]) + fabs(m->m[i][1]) + fabs(m->m[i][2]), norm);
    return slope > 1e-2 ? fabs(t - chord) / chord * slope * b->radius / (l->offset * norm) : 0.0;
}

static void judge(const bench *b, const kind *k, const leaving *l, uint32_t i, tally *t)
{
    const fl_hits *hits = &b->piece.hits;
    bool is_hit = hits->object[i] == l->object;
    bool is_outward = !signbit(fl_v3_dot(l->ng, l->d)); /* The side that leave() stepped to. */
    t->rays++;
    if (k->truth == BY_DOUBLE) {
        judge_by_double(b, l, hits->object[i] != FL_NONE, t);
        return;
    }
    bool must_hit = k->truth == CONVEX && !is_outward;
    t->false_hits += is_hit && !must_hit ? 1 : 0;
    t->lost_hits += !is_hit && must_hit ? 1 : 0;
    if (b->radius > 0.0 && must_hit && is_hit && l->object == 0)
        t->worst_chord = fl_max(chord_error(b, l, (double)hits->t[i]), t->worst_chord);
}

static bool run_place(const kind *k, double scale, double distance, bool is_beside, uint64_t rays,
                      uint64_t seed, tally *t)
{
    static leaving all[PIECE];
    bench b = {.random = seed};
    uint64_t until = t->rays + rays;
    fl_isect_context context = {0};
    bool ok = open_bench(&b, k, scale, distance, is_beside);
    while (ok && t->rays < until) {
        first_hits(&b);
        uint32_t count = leave(&b, all);
        fl_isect_kernels_of(b.compiled->isa)
            ->nearest(&b.compiled->geometry, &b.piece.rays, &b.piece.hits, &context);
        for (uint32_t i = 0; i < count; i++)
            judge(&b, k, &all[i], i, t);
    }
    close_bench(&b);
    return ok;
}

/* At all scales, and all distances up to the kind's own when beside something else. */
static bool run_kind(const kind *k, bool is_beside, uint64_t rays, tally *t)
{
    static const double scales[] = {1e-6, 1.0, 1e6};
    static const double plain[] = {0.0, 1e3, 1e5, 1e7}, beside[] = {1e2, 1e3, 1e4, 1e5};
    uint32_t count = 4;
    while (is_beside && beside[count - 1] > k->far)
        count--;
    bool ok = true;
    for (uint32_t at = 0; at < 3 * count && ok; at++)
        ok = run_place(k, scales[at / count], (is_beside ? beside : plain)[at % count], is_beside,
                       rays / (3 * count), 1234567u + at, t);
    return ok;
}

/* Prints the line; how much of it is wrong. */
static uint64_t report(const kind *k, bool is_beside, const tally *t)
{
    double share = is_beside ? k->excused_beside : k->excused;
    double most = 2.0 * share * (double)t->rays + 8.0; /* Eight are chance in a short run. */
    uint64_t wrong = t->false_hits + t->lost_hits;
    printf("%-24s %-11s %10llu rays, %llu false, %llu lost", is_beside ? "" : k->name,
           is_beside ? "far from 2nd" : "", (unsigned long long)t->rays,
           (unsigned long long)t->false_hits, (unsigned long long)t->lost_hits);
    if (k->truth == BY_DOUBLE) {
        printf(", %llu within rounding (at most %.0f)", (unsigned long long)t->excused, most);
        wrong += (double)t->excused > most ? 1 : 0;
    }
    if (t->worst_chord > 0.0) {
        printf(", exit chord off by %.1f offsets (at most %.0f)", t->worst_chord,
               chord_offsets_max);
        wrong += t->worst_chord > chord_offsets_max ? 1 : 0;
    }
    putchar('\n');
    fflush(stdout);
    return wrong;
}

int main(int argc, char **argv)
{
    uint64_t rays = argc > 1 ? (uint64_t)atof(argv[1]) : 1000000, wrong = 0;
    const char *wanted = argc > 2 ? argv[2] : "";
    unsigned run = 0;
    for (size_t i = 0; i < FL_COUNT_OF(kinds); i++)
        for (int is_beside = 0; is_beside < 2 && strstr(kinds[i].name, wanted); is_beside++) {
            tally t = {0};
            if (!run_kind(&kinds[i], is_beside, rays, &t))
                return 2;
            wrong += report(&kinds[i], is_beside, &t);
            run++;
        }
    if (run == 0)
        fprintf(stderr, "self_hits: no kind has '%s' in its name\n", wanted);
    return wrong || run == 0;
}
