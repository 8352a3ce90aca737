/* SPDX-License-Identifier: MIT */
#include "core/kernel_shade.h"

#include <math.h>

#include "core/kernel_camera.h"
#include "core/kernel_material.h"
#include "core/kernel_shade_vec.h"
#include "core/kernel_spawn.h"

/* Shadow rays end this much, relatively, before the point on the light: far above the rounding of
 * t, so that a surface on which the light lies does not hide it. */
#define SHADOW_END (1.0f - 0x1p-20f)

static void generate(const fl_frame *frame, const fl_unit *unit, uint32_t begin, uint32_t count,
                     fl_stage *out_stage)
{
    fl_camera_generate(frame, unit, begin, count, out_stage);
}

static void orient(const fl_frame *frame, fl_stage *stage)
{
    const fl_rays *rays = &stage->rays;
    const fl_surface *s = &stage->surface;
    for (uint32_t i = 0; i < rays->count; i += FL_W) {
        wide3 d = {fl_wf_load(rays->dx + i), fl_wf_load(rays->dy + i), fl_wf_load(rays->dz + i)};
        wide3 n = {fl_wf_load(s->nsx + i), fl_wf_load(s->nsy + i), fl_wf_load(s->nsz + i)};
        wide3 view = scale3(d, -1.0f / fl_wf_sqrt(dot3(d, d)));
        fl_wm is_behind = dot3(load_geometric(stage, i), view) < 0.0f;
        if (frame->params.exact.no_normal_flip)
            is_behind = fl_wi_set(0);
        fl_wm flip = is_behind & INT32_MIN;
        n = (wide3){(fl_wf)((fl_wi)n.x ^ flip), (fl_wf)((fl_wi)n.y ^ flip),
                    (fl_wf)((fl_wi)n.z ^ flip)};
        store3(stage->normal, i, n);
        store3(stage->view, i, view);
    }
}

/* Coordinates on the light for the rays of the stage. */
typedef struct light_numbers {
    float u[FL_STREAM_RAYS + FL_STREAM_SLACK], v[FL_STREAM_RAYS + FL_STREAM_SLACK];
} light_numbers;

static void draw_light(const fl_frame *frame, const fl_frame_light *light, uint32_t index,
                       const fl_stage *stage, light_numbers *out)
{
    const fl_params *params = &frame->params;
    uint32_t set = fl_set_light(params->seed, FL_PATH_CAMERA, light->index);
    fl_sample_pass pass = fl_sample_pass_begin(params->sampler, params->seed, set, index);
    pass.strata = params->strata * light->samples;
    float *const numbers[] = {out->u, out->v};
    if (stage->is_camera)
        fl_sample_fill(&pass, stage->pixel, stage->rays.count, 0, 2, numbers);
    else
        fl_sample_fill_light(&pass, light->index, stage->pixel, stage->path, stage->rays.count,
                             numbers);
}

/* A point of the light for each of the lanes at `at`. */
FL_INLINE wide3 light_point(const fl_frame_light *light, const light_numbers *numbers, uint32_t at)
{
    if (!light->draws)
        return set3(light->position);
    fl_wf point[3];
    fl_wf_warp_disk_light(light->position, light->axis_u, light->axis_v,
                          fl_wf_load(numbers->u + at), fl_wf_load(numbers->v + at), point);
    return (wide3){point[0], point[1], point[2]};
}

/* Phong: diffuse max(0, N.L) + specular max(0, R.L)^shininess, with R the mirrored view. */
FL_INLINE wide3 reflectance(const fl_frame *frame, const fl_stage *stage, uint32_t at,
                            wide3 geometric, wide3 to_light)
{
    wide3 view = load3(stage->view, at), normal = load3(stage->normal, at);
    fl_wf zero = fl_wf_set(0.0f), n_l = dot3(normal, to_light);
    wide3 sum = scale3(load3(stage->diffuse, at), fl_wf_max(n_l, zero));
    if (!frame->plan.has_specular)
        return sum;
    wide3 specular = load3(stage->specular, at);
    fl_wm shines = (specular.x != 0.0f) | (specular.y != 0.0f) | (specular.z != 0.0f);
    if (!frame->params.exact.ungated_specular) {
        fl_wm is_behind = dot3(geometric, view) < 0.0f;
        fl_wf g_l = dot3(geometric, to_light);
        shines &= (n_l > 0.0f) & (fl_wf_select(is_behind, -g_l, g_l) > 0.0f);
    }
    if (!fl_wm_any(shines))
        return sum;
    fl_wf r_l = 2.0f * dot3(normal, view) * n_l - dot3(view, to_light);
    r_l = fl_wf_min(fl_wf_max(r_l, zero), fl_wf_set(1.0f));
    wide3 lit = mad3(sum, specular, fl_wf_pow(r_l, fl_wf_load(stage->shininess + at)));
    /* Not a lobe of 0: times infinity it would be NaN, or not, by what the neighbours do. */
    return (wide3){fl_wf_select(shines, lit.x, sum.x), fl_wf_select(shines, lit.y, sum.y),
                   fl_wf_select(shines, lit.z, sum.z)};
}

/* Lanes that carry something, packed behind those already in the stream. */
FL_INLINE void shadow_append(fl_shadow *out, fl_wm live, uint32_t at, wide3 arrives)
{
    uint32_t n = out->rays.count, order = fl_wm_order(live);
    fl_wu_store_packed(out->at + n, (fl_wu)fl_wi_iota() + at, order);
    fl_wf_store_packed(out->arrives.x + n, arrives.x, order);
    fl_wf_store_packed(out->arrives.y + n, arrives.y, order);
    fl_wf_store_packed(out->arrives.z + n, arrives.z, order);
}

FL_INLINE void shadow_append_rays(fl_shadow *out, fl_wm live, const fl_hits *hits, uint32_t at,
                                  wide3 origin, wide3 direction, float t_max)
{
    uint32_t n = out->rays.count, order = fl_wm_order(live);
    fl_wf_store_packed(out->rays.ox + n, origin.x, order);
    fl_wf_store_packed(out->rays.oy + n, origin.y, order);
    fl_wf_store_packed(out->rays.oz + n, origin.z, order);
    fl_wf_store_packed(out->rays.dx + n, direction.x, order);
    fl_wf_store_packed(out->rays.dy + n, direction.y, order);
    fl_wf_store_packed(out->rays.dz + n, direction.z, order);
    fl_wf_store(out->rays.t_max + n, fl_wf_set(t_max));
    fl_wu_store_packed(out->rays.source_object + n, fl_wu_load(hits->object + at), order);
    fl_wu_store_packed(out->rays.source_prim + n, fl_wu_load(hits->prim + at), order);
}

static void light(const fl_frame *frame, const fl_frame_light *from, uint32_t sample, uint32_t j,
                  const fl_stage *stage, fl_shadow *out)
{
    uint32_t set_bit = stage->is_camera ? fl_freeze_light(from->index) : FL_FREEZE_DEEPER;
    uint32_t number = frame->params.frozen & set_bit ? 0 : sample;
    uint32_t count = stage->rays.count;
    bool is_far = from->kind == FL_LIGHT_DIRECTIONAL;
    light_numbers numbers;
    if (from->draws)
        draw_light(frame, from, number * from->samples + j, stage, &numbers);
    out->rays.count = 0;
    for (uint32_t i = 0; i < count; i += FL_W) {
        fl_wm live = fl_wm_first(count - i);
        wide3 point = load_point(stage, i), geometric = load_geometric(stage, i);
        wide3 color = set3(from->color), target = {0}, to_light = set3(from->to_light);
        if (!is_far) {
            target = light_point(from, &numbers, i);
            wide3 way = mad3(target, point, fl_wf_set(-1.0f));
            fl_wf square = dot3(way, way), distance = fl_wf_sqrt(square);
            live &= square > 0.0f;
            if (!from->is_two_sided)
                live &= dot3(way, set3(from->normal)) < 0.0f;
            to_light = scale3(way, 1.0f / distance);
            if (from->has_attenuation) {
                /* Without the terms that are 0: far away they would be 0 times infinity. */
                const float *a = from->attenuation;
                fl_wf by = fl_wf_set(a[0]);
                by = a[1] != 0.0f ? by + a[1] * distance : by;
                by = a[2] != 0.0f ? by + a[2] * square : by;
                color = scale3(color, 1.0f / by);
            }
        }
        wide3 part = reflectance(frame, stage, i, geometric, to_light);
        wide3 arrives = {color.x * part.x, color.y * part.y, color.z * part.z};
        live &= (arrives.x != 0.0f) | (arrives.y != 0.0f) | (arrives.z != 0.0f);
        if (!fl_wm_any(live))
            continue;
        shadow_append(out, live, i, arrives);
        if (frame->plan.has_shadows) {
            wide3 origin = leave(stage, i, point, geometric, to_light);
            wide3 direction = is_far ? to_light : mad3(target, origin, fl_wf_set(-1.0f));
            shadow_append_rays(out, live, &stage->hits, i, origin, direction,
                               is_far ? INFINITY : SHADOW_END);
        }
        out->rays.count += fl_wm_count(live);
    }
}

const fl_shade_kernels FL_ISA_NAME(fl_shade_kernels) = {generate,
                                                        FL_ISA_NAME(fl_shade_keep_hits),
                                                        FL_ISA_NAME(fl_shade_material),
                                                        FL_ISA_NAME(fl_shade_texture),
                                                        orient,
                                                        light,
                                                        FL_ISA_NAME(fl_shade_spawn)};
