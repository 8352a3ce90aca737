/* SPDX-License-Identifier: MIT
 *
 * Two versions of the intersection kernels on the same rays, for kernels.sh: every stream of 1,024
 * goes to both, one after the other, in each of some rounds, and the least time of each counts.
 * What disturbs the machine disturbs single streams, so the ratio is repeatable to a per cent at
 * any load. A round goes through all streams: one stream again and again would teach the branch
 * predictor its rays.
 * usage: kernels MESH ROUNDS
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/bench_work.h"
#include "core/stream.h"
#include "core/ticks.h"

enum { STREAM = 1024, SIDE = 512, OLD = 0, NEW = 1 };

extern const fl_isect_kernels fl_isect_kernels_old, fl_isect_kernels_new;

/* What one version found in a stream. */
typedef struct answer {
    _Alignas(64) float t[STREAM];
    _Alignas(64) uint32_t object[STREAM], prim[STREAM], blocked[STREAM];
} answer;

static fl_rays stream_of(const fl_rays *all, uint32_t first)
{
    fl_rays r = *all;
    const float **const floats[] = {(const float **)&r.ox,   (const float **)&r.oy,
                                    (const float **)&r.oz,   (const float **)&r.dx,
                                    (const float **)&r.dy,   (const float **)&r.dz,
                                    (const float **)&r.t_max};
    for (size_t i = 0; i < FL_COUNT_OF(floats); i++)
        *floats[i] += first;
    r.source_object += first;
    r.source_prim += first;
    r.count = fl_min_u32(all->count - first, STREAM);
    return r;
}

static uint64_t ticks_of(const fl_isect_kernels *kernels, const fl_geometry *geometry,
                         const fl_rays *rays, bool is_any, answer *out)
{
    fl_isect_context context = {0};
    fl_hits hits = {.t = out->t, .object = out->object, .prim = out->prim};
    uint64_t begin = fl_ticks();
    if (is_any)
        kernels->any(geometry, rays, out->blocked, &context);
    else
        kernels->nearest(geometry, rays, &hits, &context);
    return fl_ticks() - begin;
}

/* Least ticks of each version, summed over the streams; false: no memory, or answers differ. */
static bool compare(const fl_compiled *scene, const bench_rays *b, uint32_t rounds,
                    double out_ticks[2])
{
    static answer found[2];
    static const fl_isect_kernels *const kernels[2] = {&fl_isect_kernels_old,
                                                       &fl_isect_kernels_new};
    uint32_t streams = (b->rays.count + STREAM - 1) / STREAM;
    uint64_t(*least)[2] = malloc(streams * sizeof *least);
    bool is_same = least != NULL;
    if (least)
        memset(least, 0xff, streams * sizeof *least);
    for (uint32_t k = 0; is_same && k < rounds * streams; k++) {
        uint32_t at = k % streams;
        fl_rays rays = stream_of(&b->rays, at * STREAM);
        for (uint32_t turn = 0; turn < 2; turn++) {
            uint32_t which = (turn + at + k / streams) % 2;
            uint64_t ticks = ticks_of(kernels[which], &scene->geometry, &rays,
                                      b->kind == BENCH_SHADOW, &found[which]);
            least[at][which] = ticks < least[at][which] ? ticks : least[at][which];
        }
        is_same = memcmp(&found[OLD], &found[NEW], sizeof found[OLD]) == 0;
    }
    out_ticks[OLD] = out_ticks[NEW] = 0.0;
    for (uint32_t at = 0; is_same && at < streams; at++)
        for (int k = 0; k < 2; k++)
            out_ticks[k] += (double)least[at][k];
    free(least);
    return is_same;
}

int main(int count, char **words)
{
    fl_diags diags = {0};
    bench_mesh mesh = {0};
    uint32_t faces, rounds = count > 2 ? (uint32_t)atoi(words[2]) : 9;
    if (count < 2 || rounds < 1)
        return 2;
    bool ok = sscanf(words[1], "sphere:%u", &faces) == 1 ? bench_mesh_sphere(faces, &mesh, &diags)
                                                         : bench_mesh_load(words[1], &mesh, &diags);
    fl_compiled *scene =
        ok ? bench_mesh_compile(&mesh, &(fl_compile_options){0}, NULL, &diags) : NULL;
    bench_rays primary = {0}, rays = {0};
    ok = scene != NULL;
    for (int kind = 0; ok && kind < BENCH_KIND_COUNT; kind++) {
        bench_rays *now = kind == BENCH_PRIMARY ? &primary : &rays;
        double ticks[2];
        ok = bench_rays_create(&mesh, scene, (bench_kind)kind, SIDE, &primary, now);
        if (ok && kind == BENCH_PRIMARY) /* The others start from its hits. */
            bench_rays_trace(scene, now, NULL);
        ok = ok && compare(scene, now, rounds, ticks);
        if (ok)
            printf("%-12s %-14s new / old speed %.3f  ticks a ray %.1f, was %.1f\n", mesh.name,
                   bench_kind_names[kind], ticks[OLD] / ticks[NEW], ticks[NEW] / now->rays.count,
                   ticks[OLD] / now->rays.count);
        if (now == &rays)
            bench_rays_deinit(&rays);
    }
    if (!ok)
        fprintf(stderr, "kernels: no mesh, no memory, or hits that differ\n");
    bench_rays_deinit(&primary);
    fl_compiled_release(scene);
    bench_mesh_deinit(&mesh);
    fl_diags_deinit(&diags);
    return ok ? 0 : 1;
}
