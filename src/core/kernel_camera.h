/* SPDX-License-Identifier: MIT
 *
 * Layer 6: camera rays, FL_W pixels at a time. Part of kernel_shade.c, compiled per instruction
 * set.
 */
#ifndef FL_KERNEL_CAMERA_H
#define FL_KERNEL_CAMERA_H

#include "core/kernel_shade.h"
#include "core/wide.h"
#include "core/wide_math.h"
#include "core/wide_sampler.h"

/* The basis is double and a ray is rounded once, at its end: two halves of FL_WD doubles each. */
typedef struct fl_camera_half {
    fl_wd o[3], d[3];
} fl_camera_half;

FL_INLINE fl_camera_half fl_camera_half_ray(const fl_frame *f, fl_wd x, fl_wd y, fl_wd lens_x,
                                            fl_wd lens_y)
{
    const double h[3] = {f->axis_h.x, f->axis_h.y, f->axis_h.z};
    const double v[3] = {f->axis_v.x, f->axis_v.y, f->axis_v.z};
    const double w[3] = {f->axis_w.x, f->axis_w.y, f->axis_w.z};
    const double eye[3] = {f->eye.x, f->eye.y, f->eye.z};
    fl_wd sx = (x - f->half_w) * f->step_x, sy = (f->half_h - y) * f->step_y;
    fl_camera_half ray;
    lens_x = lens_x * f->aperture;
    lens_y = lens_y * f->aperture;
    for (int i = 0; i < 3; i++) {
        fl_wd screen = h[i] * sx + v[i] * sy;
        fl_wd lens = h[i] * lens_x + v[i] * lens_y;
        fl_wd origin = eye[i] + lens;
        fl_wd direction = w[i] + lens * -f->inverse_focus;
        ray.o[i] = f->is_orthographic ? origin + screen : origin;
        ray.d[i] = f->is_orthographic ? direction : direction + screen;
    }
    return ray;
}

FL_INLINE void fl_camera_store(const fl_frame *f, fl_wf x, fl_wf y, fl_wf lens_x, fl_wf lens_y,
                               fl_wf jitter_x, fl_wf jitter_y, fl_rays *rays, uint32_t at)
{
    fl_camera_half lo =
        fl_camera_half_ray(f, fl_wd_lo(x) + fl_wd_lo(jitter_x), fl_wd_lo(y) + fl_wd_lo(jitter_y),
                           fl_wd_lo(lens_x), fl_wd_lo(lens_y));
    fl_camera_half hi =
        fl_camera_half_ray(f, fl_wd_hi(x) + fl_wd_hi(jitter_x), fl_wd_hi(y) + fl_wd_hi(jitter_y),
                           fl_wd_hi(lens_x), fl_wd_hi(lens_y));
    float *o[3] = {rays->ox, rays->oy, rays->oz}, *d[3] = {rays->dx, rays->dy, rays->dz};
    for (int i = 0; i < 3; i++) {
        fl_wf_store(o[i] + at, fl_wf_narrow(lo.o[i], hi.o[i]));
        fl_wf_store(d[i] + at, fl_wf_narrow(lo.d[i], hi.d[i]));
    }
    fl_wf_store(rays->t_max + at, fl_wf_set(INFINITY));
    fl_wu_store(rays->source_object + at, fl_wu_set(FL_NONE));
    fl_wu_store(rays->source_prim + at, fl_wu_set(FL_NONE));
}

/* Coordinates in the pixel and on the lens for the pixels of the stage. */
typedef struct fl_camera_numbers {
    float pixel[2][FL_STREAM_RAYS + FL_STREAM_SLACK], lens[2][FL_STREAM_RAYS + FL_STREAM_SLACK];
} fl_camera_numbers;

FL_INLINE void fl_camera_draw(const fl_frame *frame, uint32_t sample, uint32_t count,
                              const fl_stage *stage, fl_camera_numbers *out)
{
    const fl_params *params = &frame->params;
    uint32_t pixel_sample = params->frozen & FL_FREEZE_PIXEL ? 0 : sample;
    uint32_t lens_sample = params->frozen & FL_FREEZE_LENS ? 0 : sample;
    bool has_pixel = frame->plan.samples_pixel, has_lens = frame->plan.samples_lens;
    float *numbers[] = {out->pixel[0], out->pixel[1], out->lens[0], out->lens[1]};
    fl_sample_pass pass =
        fl_sample_pass_begin(params->sampler, params->seed, FL_SET_CAMERA, pixel_sample);
    pass.strata = params->strata;
    if (has_pixel && has_lens && pixel_sample == lens_sample) {
        fl_sample_fill(&pass, stage->pixel, count, 0, 4, numbers);
        return;
    }
    if (has_pixel)
        fl_sample_fill(&pass, stage->pixel, count, 0, 2, numbers);
    if (!has_lens)
        return;
    uint32_t first = has_pixel ? 2 : 0;
    pass = fl_sample_pass_begin(params->sampler, params->seed, FL_SET_CAMERA, lens_sample);
    pass.strata = params->strata;
    fl_sample_fill(&pass, stage->pixel, count, first, first + 2, numbers + 2);
}

FL_INLINE void fl_camera_generate(const fl_frame *frame, const fl_unit *unit, uint32_t begin,
                                  uint32_t count, fl_stage *stage)
{
    const fl_frame_plan *plan = &frame->plan;
    fl_camera_numbers numbers;
    for (uint32_t i = 0; i < count; i++)
        stage->pixel[i] = fl_pixel_id(unit->x[begin + i], unit->y[begin + i]);
    fl_camera_draw(frame, unit->sample, count, stage, &numbers);

    for (uint32_t i = 0; i < count; i += FL_W) {
        fl_wu pixel = fl_wu_load(stage->pixel + i);
        fl_wf jitter_x = fl_wf_set((float)frame->pixel_x),
              jitter_y = fl_wf_set((float)frame->pixel_y);
        fl_wf lens_x = fl_wf_set(0.0f), lens_y = lens_x;
        if (plan->samples_pixel) {
            jitter_x = fl_wf_load(numbers.pixel[0] + i);
            jitter_y = fl_wf_load(numbers.pixel[1] + i);
        }
        if (plan->samples_lens)
            fl_wf_warp_aperture(&frame->opening, fl_wf_load(numbers.lens[0] + i),
                                fl_wf_load(numbers.lens[1] + i), &lens_x, &lens_y);
        fl_wf x = fl_wf_from_wi((fl_wi)(pixel & 0xffffu)), y = fl_wf_from_wi((fl_wi)(pixel >> 16));
        fl_camera_store(frame, x, y, lens_x, lens_y, jitter_x, jitter_y, &stage->rays, i);
        fl_wu_store(stage->path + i, fl_wu_set(FL_PATH_CAMERA));
    }
    stage->rays.count = count;
    stage->is_camera = true;
}

#endif
