/* SPDX-License-Identifier: MIT */
#include "core/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/math64.h"

static void set_float3(float out[3], fl_vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/* Axes of the picture plane: h to the right, v up, w into the scene. */
static void prepare_axes(fl_frame *frame)
{
    const fl_params *p = &frame->params;
    fl_vec3 w = fl_v3_normalize(p->camera.direction);
    fl_vec3 h = fl_v3_normalize(fl_v3_cross(w, fl_v3_normalize(p->camera.up)));
    frame->axis_w = w;
    frame->axis_h = h;
    frame->axis_v = p->camera_model == FL_CAMERA_RAW_UP ? p->camera.up : fl_v3_cross(h, w);
    frame->eye = fl_v3_sub(p->camera.center, frame->scene->geometry.origin);
    frame->is_orthographic = p->camera.projection == FL_ORTHOGRAPHIC;
    /* M04's parallel rays have no beginning: start them before everything that has bounds. */
    if (frame->is_orthographic && p->camera_model == FL_CAMERA_UNIT_SQUARE) {
        double reach = 2.0 * frame->scene->geometry.extent;
        double back = fl_max(reach + fl_v3_dot(frame->eye, w), 0.0);
        frame->eye = fl_v3_mad(frame->eye, w, -back);
    }
}

/* How far the view reaches from its centre in picture units: at depth 1, or in scene units if
 * parallel. */
static void prepare_picture(fl_frame *frame)
{
    const fl_params *p = &frame->params;
    double reach =
        frame->is_orthographic ? p->camera.ortho_size : 2.0 * fl_d_tan_deg(0.5 * p->camera.fov_deg);
    double w = (double)p->width, h = (double)p->height;
    if (p->exact.pixel == FL_PIXEL_GRID_ENDS) {
        w = fl_max(w - 1.0, 1.0);
        h = fl_max(h - 1.0, 1.0);
    }
    frame->half_w = p->exact.pixel == FL_PIXEL_GRID_ENDS ? 0.5 * (double)(p->width - 1) : 0.5 * w;
    frame->half_h = p->exact.pixel == FL_PIXEL_GRID_ENDS ? 0.5 * (double)(p->height - 1) : 0.5 * h;
    frame->step_y = reach / h;
    frame->step_x = p->camera_model == FL_CAMERA_VERTICAL_FOV ? frame->step_y : reach / w;

    /* The course's corner is the lower left one; its grid counts whole pixels from the first to the
     * last. */
    static const double rule_x[] = {
        [FL_PIXEL_AREA] = 0.5, [FL_PIXEL_CENTER] = 0.5, [FL_PIXEL_GRID_ENDS] = 0};
    static const double rule_y[] = {[FL_PIXEL_AREA] = 0.5,
                                    [FL_PIXEL_CORNER] = 1.0,
                                    [FL_PIXEL_CENTER] = 0.5,
                                    [FL_PIXEL_GRID_ENDS] = 0};
    frame->pixel_x = rule_x[p->exact.pixel];
    frame->pixel_y = rule_y[p->exact.pixel];

    bool is_cropped = p->crop_w > 0;
    frame->x0 = is_cropped ? p->crop_x : 0;
    frame->y0 = is_cropped ? p->crop_y : 0;
    frame->width = is_cropped ? p->crop_w : p->width;
    frame->height = is_cropped ? p->crop_h : p->height;
}

static void prepare_light(fl_frame *frame, uint32_t index)
{
    const fl_params *p = &frame->params;
    const fl_light *light = &p->lights[index];
    fl_frame_light *out = &frame->lights[index];
    fl_vec3 normal = fl_v3_normalize(light->direction), u, v;
    fl_v3_basis(normal, &u, &v);

    *out = (fl_frame_light){.kind = light->kind, .index = index, .samples = 1};
    out->is_two_sided = light->kind != FL_LIGHT_DISK || light->is_two_sided;
    out->is_dark = fl_v3_max_abs(light->color) == 0.0;
    out->draws = light->kind == FL_LIGHT_DISK && light->radius > 0.0 && !out->is_dark;
    if (out->draws) {
        uint32_t own = light->samples ? light->samples : p->light_samples_default;
        out->samples = fl_max_u32(p->light_samples ? p->light_samples : own, 1);
        set_float3(out->axis_u, fl_v3_scale(u, light->radius));
        set_float3(out->axis_v, fl_v3_scale(v, light->radius));
    }
    set_float3(out->position, fl_v3_sub(light->position, frame->scene->geometry.origin));
    set_float3(out->to_light, fl_v3_scale(normal, -1.0));
    set_float3(out->normal, normal);
    set_float3(out->color, light->color);
    const double *a = light->attenuation;
    for (int i = 0; i < 3; i++)
        out->attenuation[i] = (float)a[i];
    out->has_attenuation =
        light->kind != FL_LIGHT_DIRECTIONAL && !(a[0] == 1.0 && a[1] == 0.0 && a[2] == 0.0);
}

static void prepare_plan(fl_frame *frame)
{
    const fl_params *p = &frame->params;
    uint32_t needs = frame->scene->needs;
    bool branches = p->depth_limit > 0 && !p->exact.no_recursion;
    fl_frame_plan *plan = &frame->plan;
    plan->samples_pixel = p->exact.pixel == FL_PIXEL_AREA;
    plan->samples_lens = p->camera.aperture > 0.0;
    plan->has_lights = p->light_count > 0;
    plan->has_shadows = plan->has_lights && !p->exact.no_shadows;
    plan->has_specular = needs & FL_NEED_SPECULAR;
    plan->has_textures = needs & FL_NEED_TEXTURES;
    plan->has_reflection = branches && (needs & FL_NEED_REFLECTION);
    plan->has_refraction = branches && (needs & FL_NEED_REFRACTION);
    plan->dimensions = (plan->samples_pixel ? 2u : 0u) + (plan->samples_lens ? 2u : 0u);
}

fl_frame *fl_frame_create(fl_compiled *scene, const fl_params *params, fl_diags *diags)
{
    if (!fl_params_check(params, diags))
        return NULL;
    fl_frame *frame = calloc(1, sizeof *frame);
    size_t count = params->light_count;
    fl_light *lights = calloc(count + 1, sizeof *lights);
    fl_frame_light *frame_lights = calloc(count + 1, sizeof *frame_lights);
    if (!frame || !lights || !frame_lights) {
        free(frame);
        free(lights);
        free(frame_lights);
        fl_out_of_memory(diags, "the render's parameters");
        return NULL;
    }
    if (count)
        memcpy(lights, params->lights, count * sizeof *lights);

    fl_ref_init(&frame->ref);
    frame->scene = fl_compiled_retain(scene);
    frame->params = *params;
    frame->params.lights = lights;
    frame->lights = frame_lights;
    frame->light_count = params->light_count;
    frame->aperture = params->camera.aperture;
    frame->inverse_focus = 1.0 / params->camera.focus;
    frame->opening = fl_aperture_make(params->camera.blades, params->camera.blade_rotation_deg);
    prepare_axes(frame);
    prepare_picture(frame);
    for (uint32_t i = 0; i < frame->light_count; i++)
        prepare_light(frame, i);
    prepare_plan(frame);
    return frame;
}

fl_frame *fl_frame_retain(fl_frame *frame)
{
    fl_ref_retain(&frame->ref);
    return frame;
}

void fl_frame_release(fl_frame *frame)
{
    if (!frame || !fl_ref_release(&frame->ref))
        return;
    fl_compiled_release(frame->scene);
    free((void *)frame->params.lights);
    free(frame->lights);
    free(frame);
}

void fl_frame_generalize(fl_frame *frame)
{
    fl_frame_plan *plan = &frame->plan;
    bool branches = frame->params.depth_limit > 0 && !frame->params.exact.no_recursion;
    plan->samples_lens = true;
    plan->has_specular = plan->has_textures = true;
    plan->has_reflection = plan->has_refraction = branches;
    plan->dimensions = (plan->samples_pixel ? 2u : 0u) + 2u;
    for (uint32_t i = 0; i < frame->light_count; i++) {
        frame->lights[i].is_dark = false;
        frame->lights[i].draws = frame->lights[i].kind == FL_LIGHT_DISK;
    }
}
