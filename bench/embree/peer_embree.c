/* SPDX-License-Identifier: MIT
 *
 * Embree 3 behind bench_peer.h. Modes are its calls: a single ray, packets of eight, streams; each
 * as coherent or incoherent where the call takes the flag. Time to lay rays out is not counted.
 */
#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cli/bench_peer.h"

enum { SINGLE, EIGHT_COHERENT, EIGHT, STREAM_COHERENT, STREAM, MODE_COUNT, STREAM_RAYS = 64 };

static const char *const mode_names[MODE_COUNT] = {"1", "8 coherent", "8", "stream coherent",
                                                   "stream"};

typedef struct peer_scene {
    RTCDevice device;
    RTCScene scene;
} peer_scene;

typedef struct peer_rays {
    uint32_t count, mode;
    bool is_any;
    float *t_max;
    struct RTCRayHit *one;  /* Single rays and streams: nearest. */
    struct RTCRay *one_any; /* The same: any hit. */
    struct RTCRayHit8 *eight;
} peer_rays;

/* Of the process by one thread, of the wall by more. */
static double seconds_now(uint32_t thread_count)
{
    struct timespec t;
    clock_gettime(thread_count == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void scene_destroy(void *scene)
{
    peer_scene *s = scene;
    if (!s)
        return;
    rtcReleaseScene(s->scene);
    rtcReleaseDevice(s->device);
    free(s);
}

static void *scene_build(const float *position, uint32_t position_count, const uint32_t *index,
                         uint32_t face_count, bool is_robust, uint32_t thread_count,
                         const char *config, double *out_seconds)
{
    peer_scene *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    char settings[256];
    snprintf(settings, sizeof settings, "threads=%u%s%s", thread_count, *config ? "," : "", config);
    s->device = rtcNewDevice(settings);
    if (!s->device) {
        free(s);
        return NULL;
    }
    s->scene = rtcNewScene(s->device);
    RTCGeometry g = rtcNewGeometry(s->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, position, 0, 12,
                               position_count);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, index, 0, 12,
                               face_count);
    rtcCommitGeometry(g);
    rtcAttachGeometry(s->scene, g);
    rtcReleaseGeometry(g);
    rtcSetSceneBuildQuality(s->scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneFlags(s->scene, is_robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    double begin = seconds_now(thread_count);
    rtcCommitScene(s->scene);
    *out_seconds = seconds_now(thread_count) - begin;
    return s;
}

static void rays_unload(void *set)
{
    peer_rays *r = set;
    if (!r)
        return;
    free(r->t_max);
    free(r->one);
    free(r->one_any);
    free(r->eight);
    free(r);
}

static struct RTCRay ray_of(const fl_rays *rays, uint32_t i)
{
    return (struct RTCRay){.org_x = rays->ox[i],
                           .org_y = rays->oy[i],
                           .org_z = rays->oz[i],
                           .dir_x = rays->dx[i],
                           .dir_y = rays->dy[i],
                           .dir_z = rays->dz[i],
                           .tfar = rays->t_max[i],
                           .mask = ~0u,
                           .id = i};
}

static void fill_eight(struct RTCRayHit8 *packet, uint32_t k, const struct RTCRay *ray)
{
    struct RTCRay8 *r = &packet->ray;
    r->org_x[k] = ray->org_x;
    r->org_y[k] = ray->org_y;
    r->org_z[k] = ray->org_z;
    r->dir_x[k] = ray->dir_x;
    r->dir_y[k] = ray->dir_y;
    r->dir_z[k] = ray->dir_z;
    r->mask[k] = ~0u;
    r->id[k] = ray->id;
}

static void *rays_load(const fl_rays *rays, uint32_t mode, bool is_any)
{
    peer_rays *r = calloc(1, sizeof *r);
    if (!r)
        return NULL;
    uint32_t count = (rays->count + STREAM_RAYS - 1) / STREAM_RAYS * STREAM_RAYS,
             groups = count / 8;
    *r = (peer_rays){.count = rays->count, .mode = mode, .is_any = is_any};
    bool is_eight = mode == EIGHT || mode == EIGHT_COHERENT;
    r->t_max = calloc(count, sizeof *r->t_max);
    if (is_eight)
        r->eight = aligned_alloc(64, groups * sizeof *r->eight);
    else if (is_any)
        r->one_any = aligned_alloc(64, count * sizeof *r->one_any);
    else
        r->one = aligned_alloc(64, (count * sizeof *r->one + 63) / 64 * 64);
    if (!r->t_max || !(r->eight || r->one || r->one_any)) {
        rays_unload(r);
        return NULL;
    }
    if (r->eight)
        memset(r->eight, 0, groups * sizeof *r->eight);
    for (uint32_t i = 0; i < count; i++) {
        struct RTCRay ray = {.dir_z = 1.0f, .tfar = -INFINITY, .mask = ~0u};
        if (i < rays->count)
            ray = ray_of(rays, i);
        r->t_max[i] = ray.tfar;
        if (is_eight)
            fill_eight(&r->eight[i / 8], i % 8, &ray);
        else if (is_any)
            r->one_any[i] = ray;
        else
            r->one[i].ray = ray;
    }
    return r;
}

static void rays_reset(void *set)
{
    peer_rays *r = set;
    uint32_t count = (r->count + STREAM_RAYS - 1) / STREAM_RAYS * STREAM_RAYS;
    for (uint32_t i = 0; i < count; i++) {
        if (r->eight) {
            r->eight[i / 8].ray.tfar[i % 8] = r->t_max[i];
            r->eight[i / 8].hit.geomID[i % 8] = RTC_INVALID_GEOMETRY_ID;
        } else if (r->one_any) {
            r->one_any[i].tfar = r->t_max[i];
        } else {
            r->one[i].ray.tfar = r->t_max[i];
            r->one[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
        }
    }
}

static void rays_trace(void *scene, void *set)
{
    RTCScene s = ((peer_scene *)scene)->scene;
    peer_rays *r = set;
    bool is_coherent = r->mode == EIGHT_COHERENT || r->mode == STREAM_COHERENT;
    struct RTCIntersectContext c;
    rtcInitIntersectContext(&c);
    c.flags =
        is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    if (r->eight) {
        static const _Alignas(32) int all[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
        for (uint32_t k = 0; k < (r->count + 7) / 8; k++)
            if (r->is_any)
                rtcOccluded8(all, s, &c, &r->eight[k].ray);
            else
                rtcIntersect8(all, s, &c, &r->eight[k]);
    } else if (r->mode == SINGLE) {
        for (uint32_t i = 0; i < r->count; i++)
            if (r->is_any)
                rtcOccluded1(s, &c, &r->one_any[i]);
            else
                rtcIntersect1(s, &c, &r->one[i]);
    } else {
        for (uint32_t i = 0; i < r->count; i += STREAM_RAYS)
            if (r->is_any)
                rtcOccluded1M(s, &c, &r->one_any[i], STREAM_RAYS, sizeof *r->one_any);
            else
                rtcIntersect1M(s, &c, &r->one[i], STREAM_RAYS, sizeof *r->one);
    }
}

static float rays_result(const void *set, uint32_t i, uint32_t *out_face)
{
    const peer_rays *r = set;
    *out_face = FL_NONE;
    if (r->is_any) {
        float t = r->eight ? r->eight[i / 8].ray.tfar[i % 8] : r->one_any[i].tfar;
        return t < 0.0f ? 0.0f : INFINITY;
    }
    uint32_t geometry = r->eight ? r->eight[i / 8].hit.geomID[i % 8] : r->one[i].hit.geomID;
    if (geometry == RTC_INVALID_GEOMETRY_ID)
        return INFINITY;
    *out_face = r->eight ? r->eight[i / 8].hit.primID[i % 8] : r->one[i].hit.primID;
    return r->eight ? r->eight[i / 8].ray.tfar[i % 8] : r->one[i].ray.tfar;
}

extern const bench_peer bench_peer_module;
__attribute__((visibility("default"))) const bench_peer bench_peer_module = {
    .name = "embree",
    .modes = mode_names,
    .mode_count = MODE_COUNT,
    .build = scene_build,
    .destroy = scene_destroy,
    .load = rays_load,
    .unload = rays_unload,
    .reset = rays_reset,
    .trace = rays_trace,
    .result = rays_result,
};
