/* SPDX-License-Identifier: MIT */
#include "core/trace_piece.h"

#include <math.h>
#include <stdlib.h>

enum {
    PIECE_RAYS = 1024,
    INPUT_ARRAYS = 9,   /* ox oy oz dx dy dz t_max source_object source_prim */
    HIT_ARRAYS = 3,     /* t object prim; `any` puts its answers where object is */
    SURFACE_ARRAYS = 12 /* px..pz ngx..ngz nsx..nsz offset u v */
};

void fl_piece_deinit(fl_piece *p)
{
    free(p->memory);
}

bool fl_piece_init(fl_piece *p, uint32_t capacity)
{
    size_t arrays = INPUT_ARRAYS + HIT_ARRAYS + SURFACE_ARRAYS;
    float *next = p->memory = aligned_alloc(64, arrays * capacity * sizeof(float));
    if (!next)
        return false;
    float **floats[] = {&p->rays.ox,     &p->rays.oy,        &p->rays.oz,     &p->rays.dx,
                        &p->rays.dy,     &p->rays.dz,        &p->rays.t_max,  &p->hits.t,
                        &p->surface.px,  &p->surface.py,     &p->surface.pz,  &p->surface.ngx,
                        &p->surface.ngy, &p->surface.ngz,    &p->surface.nsx, &p->surface.nsy,
                        &p->surface.nsz, &p->surface.offset, &p->surface.u,   &p->surface.v};
    for (size_t i = 0; i < FL_COUNT_OF(floats); i++, next += capacity)
        *floats[i] = next;
    uint32_t **words[] = {&p->rays.source_object, &p->rays.source_prim, &p->hits.object,
                          &p->hits.prim};
    for (size_t i = 0; i < FL_COUNT_OF(words); i++, next += capacity)
        *words[i] = (uint32_t *)(void *)next;
    p->rays.capacity = capacity;
    return true;
}

void fl_piece_set_count(fl_rays *rays, uint32_t count)
{
    rays->count = count;
    for (uint32_t i = count; i % 8 != 0; i++)
        fl_rays_set(rays, i, fl_v3(0.0, 0.0, 0.0), fl_v3(0.0, 0.0, 1.0), -1.0f);
}

static void fill_pick(const fl_frame *frame, const fl_piece *p, fl_vec3 origin, fl_vec3 direction,
                      fl_pick *out_pick)
{
    const fl_surface *s = &p->surface;
    const fl_compiled *scene = frame->scene;
    fl_vec3 at = fl_v3((double)s->px[0], (double)s->py[0], (double)s->pz[0]);
    fl_vec3 normal = fl_v3((double)s->ngx[0], (double)s->ngy[0], (double)s->ngz[0]);
    fl_vec3 way = fl_v3_sub(at, origin);
    *out_pick = (fl_pick){
        .is_hit = true,
        .depth = fl_v3_dot(way, frame->axis_w),
        .distance = fl_v3_length(way),
        .position = fl_v3_add(at, scene->geometry.origin),
        .normal = fl_v3_dot(normal, direction) > 0.0 ? fl_v3_scale(normal, -1.0) : normal,
        .object = p->hits.object[0],
        .prim = p->hits.prim[0],
        .loc = scene->object_loc[p->hits.object[0]],
    };
}

bool fl_trace_pick(const fl_frame *frame, double x_px, double y_px, fl_pick *out_pick)
{
    fl_piece p = {0};
    if (!fl_piece_init(&p, 16))
        return false;
    /* Through the centre of the lens: the pinhole ray whatever the aperture. */
    fl_vec3 origin, direction;
    fl_frame_ray(frame, x_px, y_px, 0.0, 0.0, &origin, &direction);
    fl_rays_set(&p.rays, 0, origin, direction, INFINITY);
    fl_piece_set_count(&p.rays, 1);
    const fl_compiled *scene = frame->scene;
    const fl_isect_kernels *kernels = fl_isect_kernels_of(scene->isa);
    fl_isect_context context = {.solver = frame->params.solver};
    kernels->nearest(&scene->geometry, &p.rays, &p.hits, &context);
    *out_pick = (fl_pick){.object = FL_NONE, .prim = FL_NONE};
    if (p.hits.object[0] != FL_NONE) {
        kernels->resolve(&scene->geometry, &p.rays, &p.hits, NULL, &p.surface, &context);
        fill_pick(frame, &p, origin, direction, out_pick);
    }
    fl_piece_deinit(&p);
    return true;
}

/* Rays [begin, begin + count) of the caller's arrays into the piece. */
static void load_piece(fl_piece *p, const fl_compiled *scene, const float *origins,
                       const float *directions, const float *t_max, size_t begin, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const float *o = origins + 3 * (begin + i), *d = directions + 3 * (begin + i);
        fl_vec3 origin =
            fl_v3_sub(fl_v3((double)o[0], (double)o[1], (double)o[2]), scene->geometry.origin);
        fl_rays_set(&p->rays, i, origin, fl_v3((double)d[0], (double)d[1], (double)d[2]),
                    t_max ? t_max[begin + i] : INFINITY);
    }
    fl_piece_set_count(&p->rays, count);
}

static void add_counts(fl_isect_counts *sum, const fl_isect_context *context)
{
    if (!sum)
        return;
    sum->node_visits += context->counts.node_visits;
    sum->primitive_tests += context->counts.primitive_tests;
}

bool fl_trace_nearest(const fl_compiled *scene, const float *origins, const float *directions,
                      size_t count, float *out_t, uint32_t *out_object, uint32_t *out_prim,
                      fl_isect_counts *counts)
{
    fl_piece p = {0};
    if (!fl_piece_init(&p, PIECE_RAYS))
        return false;
    fl_isect_context context = {0};
    for (size_t begin = 0; begin < count; begin += PIECE_RAYS) {
        uint32_t n = count - begin < PIECE_RAYS ? (uint32_t)(count - begin) : PIECE_RAYS;
        load_piece(&p, scene, origins, directions, NULL, begin, n);
        fl_isect_kernels_of(scene->isa)->nearest(&scene->geometry, &p.rays, &p.hits, &context);
        for (uint32_t i = 0; i < n; i++) {
            if (out_t)
                out_t[begin + i] = p.hits.t[i];
            if (out_object)
                out_object[begin + i] = p.hits.object[i];
            if (out_prim)
                out_prim[begin + i] = p.hits.prim[i];
        }
    }
    add_counts(counts, &context);
    fl_piece_deinit(&p);
    return true;
}

bool fl_trace_any(const fl_compiled *scene, const float *origins, const float *directions,
                  const float *t_max, size_t count, uint32_t *out_blocked, fl_isect_counts *counts)
{
    fl_piece p = {0};
    if (!fl_piece_init(&p, PIECE_RAYS))
        return false;
    fl_isect_context context = {0};
    for (size_t begin = 0; begin < count; begin += PIECE_RAYS) {
        uint32_t n = count - begin < PIECE_RAYS ? (uint32_t)(count - begin) : PIECE_RAYS;
        load_piece(&p, scene, origins, directions, t_max, begin, n);
        fl_isect_kernels_of(scene->isa)->any(&scene->geometry, &p.rays, p.hits.object, &context);
        for (uint32_t i = 0; i < n; i++)
            out_blocked[begin + i] = p.hits.object[i];
    }
    add_counts(counts, &context);
    fl_piece_deinit(&p);
    return true;
}

void fl_trace_stream_nearest(const fl_compiled *scene, const fl_rays *rays, fl_hits *out_hits,
                             fl_isect_counts *counts)
{
    fl_isect_context context = {0};
    fl_isect_kernels_of(scene->isa)->nearest(&scene->geometry, rays, out_hits, &context);
    add_counts(counts, &context);
}

void fl_trace_stream_any(const fl_compiled *scene, const fl_rays *rays, uint32_t *out_blocked,
                         fl_isect_counts *counts)
{
    fl_isect_context context = {0};
    fl_isect_kernels_of(scene->isa)->any(&scene->geometry, rays, out_blocked, &context);
    add_counts(counts, &context);
}
