/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/bench_work.h"

const char *const bench_kind_names[BENCH_KIND_COUNT] = {"primary", "primary-lens", "shadow",
                                                        "mirror", "incoherent"};

static const double two_pi = 6.28318530717958647692;

/* Repeatable numbers in [0, 1) by ray and dimension. */
static double unit_number(uint32_t ray, uint32_t dimension)
{
    uint32_t x = ray * 0x9e3779b9u ^ (dimension + 1) * 0x85ebca6bu;
    for (int k = 0; k < 2; k++) {
        x ^= x >> 16;
        x *= 0x7feb352du;
        x ^= x >> 15;
        x *= 0x846ca68bu;
    }
    return (double)((x ^ x >> 16) >> 8) * 0x1p-24;
}

static bool allocate(bench_rays *r, uint32_t capacity)
{
    capacity = (capacity + 15) / 16 * 16;
    const size_t arrays = 13;
    float *next = r->memory = aligned_alloc(64, arrays * capacity * sizeof *next);
    if (!next)
        return false;
    memset(next, 0, arrays * capacity * sizeof *next);
    float **floats[] = {&r->rays.ox, &r->rays.oy, &r->rays.oz,    &r->rays.dx,
                        &r->rays.dy, &r->rays.dz, &r->rays.t_max, &r->hits.t};
    for (size_t i = 0; i < FL_COUNT_OF(floats); i++, next += capacity)
        *floats[i] = next;
    uint32_t **words[] = {&r->rays.source_object, &r->rays.source_prim, &r->hits.object,
                          &r->hits.prim, &r->blocked};
    for (size_t i = 0; i < FL_COUNT_OF(words); i++, next += capacity)
        *words[i] = (uint32_t *)(void *)next;
    r->rays.capacity = capacity;
    return true;
}

/* Pixel number i in tiles of 8x8, within them in blocks of 4x2. */
static void pixel_at(uint32_t i, uint32_t side, uint32_t *x, uint32_t *y)
{
    uint32_t tile = i / 64, in = i % 64, block = in / 8, tiles = side / 8;
    *x = tile % tiles * 8 + block % 2 * 4 + in % 4;
    *y = tile / tiles * 8 + block / 2 * 2 + in % 8 / 4;
}

static void generate_camera(bench_rays *out, fl_vec3 shift, uint32_t side)
{
    const fl_vec3 eye = {1.4, 1.1, 3.1};
    const double aperture = 0.15, half = tan(0.5 * 40.0 / 360.0 * two_pi);
    double focus = fl_v3_length(eye) - 0.8;
    fl_vec3 w = fl_v3_scale(fl_v3_normalize(eye), -1.0);
    fl_vec3 h = fl_v3_normalize(fl_v3_cross(w, fl_v3(0, 1, 0))), v = fl_v3_cross(h, w);
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t x, y;
        pixel_at(i, side, &x, &y);
        double sx = ((x + 0.5) / side * 2.0 - 1.0) * half,
               sy = (1.0 - (y + 0.5) / side * 2.0) * half;
        fl_vec3 d = fl_v3_mad(fl_v3_mad(w, h, sx), v, sy), o = fl_v3_sub(eye, shift);
        if (out->kind == BENCH_LENS) {
            double r = aperture * sqrt(unit_number(i, 0)), turn = two_pi * unit_number(i, 1);
            fl_vec3 lens = fl_v3_mad(fl_v3_scale(h, r * cos(turn)), v, r * sin(turn));
            o = fl_v3_add(o, lens);
            d = fl_v3_mad(d, lens, -1.0 / focus);
        }
        fl_rays_set(&out->rays, i, o, d, INFINITY);
    }
    out->rays.count = side * side;
}

static fl_vec3 vertex(const bench_mesh *mesh, uint32_t face, uint32_t corner)
{
    const float *p = mesh->position + 3 * (size_t)mesh->index[3 * (size_t)face + corner];
    return fl_v3((double)p[0], (double)p[1], (double)p[2]);
}

/* A direction around n, cosine distributed. */
static fl_vec3 cosine_direction(fl_vec3 n, uint32_t i)
{
    fl_vec3 side = fabs(n.x) < 0.7 ? fl_v3(1, 0, 0) : fl_v3(0, 1, 0);
    fl_vec3 a = fl_v3_normalize(fl_v3_cross(n, side)), b = fl_v3_cross(n, a);
    double r2 = unit_number(i, 4), r = sqrt(r2), turn = two_pi * unit_number(i, 5);
    fl_vec3 d = fl_v3_mad(fl_v3_scale(a, r * cos(turn)), b, r * sin(turn));
    return fl_v3_mad(d, n, sqrt(1.0 - r2) + 1e-4);
}

static void generate_secondary(bench_rays *out, const bench_mesh *mesh, fl_vec3 shift,
                               const bench_rays *primary)
{
    const fl_vec3 light = {2.5, 5.0, 2.0};
    const double light_radius = 0.8, leave = 1e-4;
    fl_vec3 to_center = fl_v3_normalize(light);
    fl_vec3 a = fl_v3_normalize(fl_v3_cross(to_center, fl_v3(0, 1, 0)));
    fl_vec3 b = fl_v3_cross(a, to_center);
    const fl_rays *in = &primary->rays;
    uint32_t count = 0;
    for (uint32_t i = 0; i < in->count; i++) {
        if (primary->hits.object[i] == FL_NONE)
            continue;
        uint32_t face = primary->hits.prim[i];
        fl_vec3 c = vertex(mesh, face, 0);
        fl_vec3 n = fl_v3_normalize(
            fl_v3_cross(fl_v3_sub(vertex(mesh, face, 1), c), fl_v3_sub(vertex(mesh, face, 2), c)));
        fl_vec3 d = fl_v3((double)in->dx[i], (double)in->dy[i], (double)in->dz[i]);
        fl_vec3 o = fl_v3((double)in->ox[i], (double)in->oy[i], (double)in->oz[i]);
        if (fl_v3_dot(n, d) > 0.0)
            n = fl_v3_scale(n, -1.0);
        fl_vec3 p = fl_v3_mad(fl_v3_mad(o, d, (double)primary->hits.t[i]), n, leave);
        if (out->kind == BENCH_MIRROR) {
            fl_rays_set(&out->rays, count++, p, fl_v3_mad(d, n, -2.0 * fl_v3_dot(n, d)), INFINITY);
        } else if (out->kind == BENCH_INCOHERENT) {
            fl_rays_set(&out->rays, count++, p, cosine_direction(n, i), INFINITY);
        } else {
            double r = light_radius * sqrt(unit_number(i, 2)), turn = two_pi * unit_number(i, 3);
            fl_vec3 at = fl_v3_mad(fl_v3_mad(light, a, r * cos(turn)), b, r * sin(turn));
            fl_vec3 way = fl_v3_sub(fl_v3_sub(at, shift), p);
            if (fl_v3_dot(way, n) > 0.0) /* Others are dark without a ray. */
                fl_rays_set(&out->rays, count++, p, way, 0.9999f);
        }
    }
    out->rays.count = count;
}

bool bench_rays_create(const bench_mesh *mesh, const fl_compiled *scene, bench_kind kind,
                       uint32_t side, const bench_rays *primary, bench_rays *out)
{
    *out = (bench_rays){.kind = kind};
    if (!allocate(out, kind <= BENCH_LENS ? side * side : fl_max_u32(primary->rays.count, 8)))
        return false;
    if (kind <= BENCH_LENS)
        generate_camera(out, scene->geometry.origin, side);
    else
        generate_secondary(out, mesh, scene->geometry.origin, primary);
    for (uint32_t i = out->rays.count; i % 8 != 0; i++)
        fl_rays_set(&out->rays, i, fl_v3(0, 0, 0), fl_v3(0, 0, 1), -1.0f);
    return true;
}

void bench_rays_deinit(bench_rays *rays)
{
    free(rays->memory);
    *rays = (bench_rays){0};
}

void bench_rays_trace(const fl_compiled *scene, bench_rays *rays, fl_isect_counts *counts)
{
    if (rays->kind == BENCH_SHADOW)
        fl_trace_stream_any(scene, &rays->rays, rays->blocked, counts);
    else
        fl_trace_stream_nearest(scene, &rays->rays, &rays->hits, counts);
}
