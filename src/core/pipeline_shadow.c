/* SPDX-License-Identifier: MIT */
#include "core/pipeline_work.h"

#include <math.h>

static void block(fl_shadow *shadow, uint32_t i)
{
    shadow->arrives.x[i] = shadow->arrives.y[i] = shadow->arrives.z[i] = 0.0f;
}

static bool occlude_opaque(fl_pipe *pipe)
{
    fl_shadow *shadow = &pipe->work->shadow;
    const uint32_t *blocked = pipe->work->blocked;
    pipe->isect->any(&pipe->frame->scene->geometry, &shadow->rays, pipe->work->blocked,
                     &pipe->context);
    if (fl_is_cancelled(&pipe->context))
        return false;
    for (uint32_t i = 0; i < shadow->rays.count; i++)
        if (blocked[i])
            block(shadow, i);
    return true;
}

static void copy_ray(fl_rays *to, uint32_t i, const fl_rays *from, uint32_t j)
{
    to->ox[i] = from->ox[j];
    to->oy[i] = from->oy[j];
    to->oz[i] = from->oz[j];
    to->dx[i] = from->dx[j];
    to->dy[i] = from->dy[j];
    to->dz[i] = from->dz[j];
    to->t_max[i] = from->t_max[j];
    to->source_object[i] = from->source_object[j];
    to->source_prim[i] = from->source_prim[j];
}

/* Start ray i of `rays` again from the far side of the surface that it met. */
static void pass_surface(fl_workspace *work, uint32_t i, uint32_t object, uint32_t prim)
{
    fl_rays *rays = &work->through.rays;
    const fl_surface *s = &work->through_surface;
    float d[3] = {rays->dx[i], rays->dy[i], rays->dz[i]};
    float side = s->ngx[i] * d[0] + s->ngy[i] * d[1] + s->ngz[i] * d[2];
    float step = copysignf(s->offset[i], side);
    rays->ox[i] = s->px[i] + s->ngx[i] * step;
    rays->oy[i] = s->py[i] + s->ngy[i] * step;
    rays->oz[i] = s->pz[i] + s->ngz[i] * step;
    if (rays->t_max[i] <= 1.0f) { /* towards a point, not a direction */
        uint32_t at = work->through.at[i];
        rays->dx[i] = work->end.x[at] - rays->ox[i];
        rays->dy[i] = work->end.y[at] - rays->oy[i];
        rays->dz[i] = work->end.z[at] - rays->oz[i];
    }
    rays->source_object[i] = object;
    rays->source_prim[i] = prim;
}

/* Keep the rays that met something transparent, with their hits, in place. */
static uint32_t keep_transparent(fl_pipe *pipe)
{
    fl_workspace *work = pipe->work;
    const fl_compiled *scene = pipe->frame->scene;
    fl_array3 arrives = work->shadow.arrives;
    fl_hits *hits = &work->through_hits;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < work->through.rays.count; i++) {
        if (hits->object[i] == FL_NONE)
            continue;
        uint32_t at = work->through.at[i];
        const float *refract = scene->shaders[scene->object_shader[hits->object[i]]].refract;
        arrives.x[at] *= refract[0];
        arrives.y[at] *= refract[1];
        arrives.z[at] *= refract[2];
        if (arrives.x[at] == 0.0f && arrives.y[at] == 0.0f && arrives.z[at] == 0.0f)
            continue;
        copy_ray(&work->through.rays, kept, &work->through.rays, i);
        hits->t[kept] = hits->t[i];
        hits->object[kept] = hits->object[i];
        hits->prim[kept] = hits->prim[i];
        work->through.at[kept++] = at;
    }
    return kept;
}

static bool occlude_transparent(fl_pipe *pipe)
{
    fl_workspace *work = pipe->work;
    const fl_geometry *geometry = &pipe->frame->scene->geometry;
    const fl_rays *from = &work->shadow.rays;
    fl_rays *rays = &work->through.rays;
    for (uint32_t i = 0; i < from->count; i++) {
        copy_ray(rays, i, from, i);
        work->through.at[i] = i;
        work->end.x[i] = from->ox[i] + from->dx[i];
        work->end.y[i] = from->oy[i] + from->dy[i];
        work->end.z[i] = from->oz[i] + from->dz[i];
    }
    rays->count = from->count;
    for (int surfaces = 0; rays->count > 0 && surfaces <= FL_SHADOW_SURFACES_MAX; surfaces++) {
        fl_rays_pad(rays);
        pipe->isect->nearest(geometry, rays, &work->through_hits, &pipe->context);
        if (fl_is_cancelled(&pipe->context))
            return false;
        rays->count = keep_transparent(pipe);
        fl_rays_pad(rays);
        fl_hits_pad(&work->through_hits, rays->count);
        pipe->isect->resolve(geometry, rays, &work->through_hits, NULL, &work->through_surface,
                             &pipe->context);
        if (fl_is_cancelled(&pipe->context))
            return false;
        for (uint32_t i = 0; i < rays->count; i++)
            pass_surface(work, i, work->through_hits.object[i], work->through_hits.prim[i]);
    }
    for (uint32_t i = 0; i < rays->count; i++)
        block(&work->shadow, work->through.at[i]);
    pipe->counts.stopped_shadow_rays += rays->count;
    return true;
}

bool fl_pipe_occlude(fl_pipe *pipe)
{
    fl_isect_counts before = pipe->context.counts, *counts = &pipe->counts.occlude;
    fl_rays_pad(&pipe->work->shadow.rays);
    bool is_fine =
        pipe->frame->params.transparent_shadows ? occlude_transparent(pipe) : occlude_opaque(pipe);
    counts->node_visits += pipe->context.counts.node_visits - before.node_visits;
    counts->primitive_tests += pipe->context.counts.primitive_tests - before.primitive_tests;
    return is_fine;
}
