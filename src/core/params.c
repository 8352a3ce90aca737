/* SPDX-License-Identifier: MIT */
#include "core/params.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const fl_camera default_camera = {
    .projection = FL_PERSPECTIVE,
    .center = {0, 0, 10},
    .direction = {0, 0, -1},
    .up = {0, 1, 0},
    .fov_deg = 30,
    .ortho_size = 5,
    .focus = HUGE_VAL,
};

static const fl_camera_model camera_models[FL_DIALECT_COUNT] = {
    [FL_DIALECT_M04] = FL_CAMERA_UNIT_SQUARE,
    [FL_DIALECT_M12] = FL_CAMERA_RAW_UP,
};

/* What the programs behind the courses' reference pictures do: local shading only, seen from the
 * front. */
#define COURSE_RULES                                                                               \
    .no_shadows = true, .no_recursion = true, .ungated_specular = true, .no_normal_flip = true,    \
    .truncate_bytes = true

static const fl_exact_rules exact_rules[FL_DIALECT_COUNT] = {
    [FL_DIALECT_PA1] = {.pixel = FL_PIXEL_CORNER, COURSE_RULES},
    [FL_DIALECT_M04] = {.pixel = FL_PIXEL_CENTER, .black_back_faces = true, COURSE_RULES},
    [FL_DIALECT_M12] = {.pixel = FL_PIXEL_GRID_ENDS, .course_cube = true, COURSE_RULES},
};

void fl_params_from_scene(fl_params *out_params, const fl_scene *scene, bool is_exact)
{
    const fl_render_block *render = &scene->render;
    const fl_camera *camera = scene->has_camera ? &scene->camera : &default_camera;
    bool has_size = camera->width && camera->height;
    memset(out_params, 0, sizeof *out_params);
    *out_params = (fl_params){
        .camera = *camera,
        .camera_model = camera_models[scene->dialect],
        .width = has_size ? camera->width : FL_SIZE_DEFAULT,
        .height = has_size ? camera->height : FL_SIZE_DEFAULT,
        .depth_limit = render->has_depth ? render->depth : FL_DEPTH_DEFAULT,
        .weight_threshold =
            render->has_weight_threshold ? render->weight_threshold : FL_WEIGHT_THRESHOLD_DEFAULT,
        .light_samples_default = render->has_light_samples ? render->light_samples : 1,
        .transparent_shadows = render->has_transparent_shadows && render->transparent_shadows,
        .background = scene->background.color,
        .ambient = scene->background.ambient,
        .lights = scene->lights,
        .light_count = scene->light_count,
    };
    if (is_exact)
        out_params->exact = exact_rules[scene->dialect];
}

static const fl_loc nowhere = {0};

/* Finite as the float that it becomes. */
static bool is_float(double x)
{
    return fabs(x) <= (double)FLT_MAX;
}

static bool is_float3(fl_vec3 v)
{
    return is_float(v.x) && is_float(v.y) && is_float(v.z);
}

static bool check_size(const fl_params *p, fl_diags *diags)
{
    bool is_fine = true;
    if (p->width < 1 || p->width > FL_SIDE_MAX || p->height < 1 || p->height > FL_SIDE_MAX)
        is_fine = fl_error(diags, nowhere, "the size must be from 1x1 to %dx%d pixels, got %ux%u",
                           FL_SIDE_MAX, FL_SIDE_MAX, p->width, p->height);
    else if (p->crop_w > 0 &&
             (p->crop_h < 1 || p->crop_x >= p->width || p->crop_y >= p->height ||
              p->crop_w > p->width - p->crop_x || p->crop_h > p->height - p->crop_y))
        is_fine =
            fl_error(diags, nowhere,
                     "the crop %u,%u,%u,%u (x, y, width, height) must lie inside the %ux%u picture",
                     p->crop_x, p->crop_y, p->crop_w, p->crop_h, p->width, p->height);
    return is_fine;
}

/* Stratified sampling has a stratum for every sample, and for every light sample of each. */
static bool check_strata(const fl_params *p, fl_diags *diags)
{
    if (p->sampler != FL_SAMPLER_STRATIFIED)
        return true;
    uint32_t most = fl_max_u32(p->light_samples, fl_max_u32(p->light_samples_default, 1));
    for (uint32_t i = 0; i < p->light_count; i++)
        most = fl_max_u32(most, p->lights[i].samples);
    if (p->strata > 0 && (uint64_t)p->strata * most <= FL_STRATA_MAX)
        return true;
    return fl_error(diags, nowhere,
                    "the stratified sampler must know the number of samples, at most %u with %u "
                    "light samples: give "
                    "--samples",
                    FL_STRATA_MAX / most, most);
}

static bool check_limits(const fl_params *p, fl_diags *diags)
{
    bool is_fine = true;
    if (p->depth_limit > FL_DEPTH_MAX)
        is_fine = fl_error(diags, nowhere, "the depth must be from 0 to %d bounces, got %u",
                           FL_DEPTH_MAX, p->depth_limit);
    if (!(p->weight_threshold >= 0.0 && is_float(p->weight_threshold)))
        is_fine = fl_error(diags, nowhere, "the weight threshold must be 0 or above, got %g",
                           p->weight_threshold);
    if (p->light_samples > FL_LIGHT_SAMPLES_MAX || p->light_samples_default > FL_LIGHT_SAMPLES_MAX)
        is_fine =
            fl_error(diags, nowhere, "the light samples must be from 1 to %d, got %u",
                     FL_LIGHT_SAMPLES_MAX, fl_max_u32(p->light_samples, p->light_samples_default));
    if (p->solver > FL_REVOLVE_MAX_STARTS)
        is_fine = fl_error(diags, nowhere, "Newton's method takes 1 to %d starts a segment, got %u",
                           FL_REVOLVE_MAX_STARTS, p->solver);
    /* Tables and names are indexed by these. */
    if (p->sampler > FL_SAMPLER_STRATIFIED)
        is_fine = fl_error(diags, nowhere, "there is no sampler number %u", (unsigned)p->sampler);
    if (p->precision > FL_PRECISION_DOUBLE)
        is_fine =
            fl_error(diags, nowhere, "there is no precision number %u", (unsigned)p->precision);
    is_fine = check_strata(p, diags) && is_fine;
    if (!is_float3(p->background))
        is_fine = fl_error(diags, nowhere, "the background colour must be finite");
    if (!is_float3(p->ambient))
        is_fine = fl_error(diags, nowhere, "the ambient light must be finite");
    return is_fine;
}

/* Rays must stay finite as floats. */
#define MAX_LENS_SLOPE 1e9
#define MAX_RAW_UP     1e9

static bool check_lens(const fl_camera *c, fl_diags *diags)
{
    bool is_fine = true;
    if (!(c->aperture >= 0.0 && is_float(c->aperture)))
        is_fine = fl_error(
            diags, nowhere,
            "'aperture' is the radius of the lens: 0 (pinhole) or above and finite, got %g",
            c->aperture);
    if (!(c->focus > 0.0))
        is_fine = fl_error(diags, nowhere,
                           "'focus' is the distance of the focus plane: above 0, or inf, got %g",
                           c->focus);
    if (c->aperture > MAX_LENS_SLOPE * c->focus)
        is_fine =
            fl_error(diags, nowhere, "'aperture' must be at most %g times 'focus', got %g and %g",
                     MAX_LENS_SLOPE, c->aperture, c->focus);
    if (c->blades != 0 && (c->blades < 3 || c->blades > 9))
        is_fine = fl_error(diags, nowhere, "'blades' must be 0 (round) or from 3 to 9, got %u",
                           c->blades);
    if (!(fabs(c->blade_rotation_deg) <= 1e6))
        is_fine =
            fl_error(diags, nowhere, "'bladeRotation' must be from -1e6 to 1e6 degrees, got %g",
                     c->blade_rotation_deg);
    if (!(fabs(c->exposure_ev) <= 100.0))
        is_fine = fl_error(diags, nowhere, "'exposure' must be from -100 to 100 EV, got %g",
                           c->exposure_ev);
    return is_fine;
}

static bool check_camera(const fl_params *p, fl_diags *diags)
{
    const fl_camera *c = &p->camera;
    bool is_fine = check_lens(c, diags);
    if (c->projection == FL_PERSPECTIVE &&
        !(c->fov_deg >= FL_FOV_MIN_DEG && c->fov_deg <= FL_FOV_MAX_DEG))
        is_fine =
            fl_error(diags, nowhere, "the field of view must be from %g to %g degrees, got %g",
                     FL_FOV_MIN_DEG, FL_FOV_MAX_DEG, c->fov_deg);
    if (c->projection == FL_ORTHOGRAPHIC && !(c->ortho_size > 0.0 && is_float(c->ortho_size)))
        is_fine =
            fl_error(diags, nowhere, "the 'size' of the view must be above 0 and finite, got %g",
                     c->ortho_size);
    if (!is_float3(c->center))
        is_fine = fl_error(diags, nowhere, "the camera's 'center' must be finite");
    if (!is_float3(c->direction) || !(fl_v3_max_abs(c->direction) > 0.0))
        return fl_error(diags, nowhere, "the camera's 'direction' must be finite and not 0 0 0");
    if (!is_float3(c->up) || !(fl_v3_max_abs(c->up) > 0.0))
        return fl_error(diags, nowhere, "the camera's 'up' must be finite and not 0 0 0");
    if (p->camera_model == FL_CAMERA_RAW_UP && fl_v3_max_abs(c->up) > MAX_RAW_UP)
        return fl_error(diags, nowhere, "the camera's 'up' must be at most %g long", MAX_RAW_UP);
    fl_vec3 side = fl_v3_cross(fl_v3_normalize(c->direction), fl_v3_normalize(c->up));
    if (!(fl_v3_length(side) > 1e-9))
        return fl_error(diags, nowhere,
                        "the camera's 'up' must not be parallel to its 'direction'");
    return is_fine;
}

static bool check_light(const fl_light *light, fl_diags *diags)
{
    bool is_fine = true;
    if (!is_float3(light->color))
        is_fine = fl_error(diags, light->loc, "a light's 'color' must be finite");
    if (light->kind != FL_LIGHT_DIRECTIONAL &&
        !(fl_v3_max_abs(light->position) <= FL_COORDINATE_MAX && is_float3(light->position)))
        is_fine =
            fl_error(diags, light->loc,
                     "a light's 'position' must be finite and within %g of the world's origin",
                     FL_COORDINATE_MAX);
    if (light->kind != FL_LIGHT_POINT &&
        !(is_float3(light->direction) && fl_v3_max_abs(light->direction) > 0.0))
        is_fine = fl_error(diags, light->loc, "a light's 'direction' must be finite and not 0 0 0");
    if (light->kind == FL_LIGHT_DISK &&
        !(light->radius >= 0.0 && light->radius <= FL_COORDINATE_MAX))
        is_fine = fl_error(diags, light->loc, "a light's 'radius' must be from 0 to %g, got %g",
                           FL_COORDINATE_MAX, light->radius);
    if (light->samples > FL_LIGHT_SAMPLES_MAX)
        is_fine = fl_error(diags, light->loc, "a light's 'samples' must be from 1 to %d, got %u",
                           FL_LIGHT_SAMPLES_MAX, light->samples);
    for (int i = 0; i < 3; i++)
        if (!is_float(light->attenuation[i]))
            is_fine = fl_error(diags, light->loc, "a light's attenuation must be finite");
    return is_fine;
}

bool fl_params_check(const fl_params *params, fl_diags *diags)
{
    bool is_fine = check_size(params, diags);
    is_fine = check_limits(params, diags) && is_fine;
    is_fine = check_camera(params, diags) && is_fine;
    for (uint32_t i = 0; i < params->light_count; i++)
        is_fine = check_light(&params->lights[i], diags) && is_fine;
    return is_fine;
}
