/* SPDX-License-Identifier: MIT */
#include "core/double_path.h"

#include <math.h>
#include <string.h>

#include "core/double_trace.h"
#include "core/math64.h"
#include "core/texture.h"

/* Shadow rays end this much, relatively, before the point on the light (kernel_shade.c). */
#define SHADOW_END (1.0 - 0x1p-40)

/** A ray that waits for its level. */
typedef struct branch {
    fl_double_ray ray;
    fl_vec3 throughput;
    uint32_t path;
    bool is_refracted;
} branch;

typedef struct branches {
    branch items[2 * FL_PENDING_MAX];
    uint32_t count;
} branches;

typedef struct path {
    const fl_frame *frame;
    fl_isect_context context;
    fl_counts counts;
    uint32_t pixel, sample;
} path;

/** What light falls on. */
typedef struct spot {
    const fl_shader *shader;
    fl_double_surface surface;
    fl_vec3 view, normal;      /**< As fl_stage. */
    fl_vec3 diffuse, specular; /**< Texture included. */
    uint32_t object, prim, path;
} spot;

static fl_vec3 color_of(const float c[3])
{
    return fl_v3((double)c[0], (double)c[1], (double)c[2]);
}

static bool is_black(fl_vec3 c)
{
    return c.x == 0.0 && c.y == 0.0 && c.z == 0.0;
}

static double largest(fl_vec3 c)
{
    double rg = c.x > c.y ? c.x : c.y;
    return rg > c.z ? rg : c.z;
}

/* --- Sample points: sample_warp_body.inc, in double ------------------------------------------- */

/* `strata`: how many points the set will have in all, for the stratified sampler. */
static double number(const path *p, uint32_t set, uint32_t index, uint32_t dimension,
                     uint32_t strata)
{
    const fl_params *params = &p->frame->params;
    if (params->sampler == FL_SAMPLER_STRATIFIED)
        return (double)fl_sample_stratified(params->seed, p->pixel, index, set, dimension, strata);
    return (double)fl_sample_scalar(params->sampler, params->seed, p->pixel, index, set, dimension);
}

static void warp_disk(double u, double v, double *out_x, double *out_y)
{
    double a = u * 2.0 - 1.0, b = v * 2.0 - 1.0, s, c;
    bool is_flat = fabs(b) < fabs(a);
    double radius = is_flat ? a : b, across = is_flat ? b : a;
    fl_d_sincos_turns(across / (radius == 0.0 ? 1.0 : radius) * 0.125, &s, &c);
    *out_x = radius * (is_flat ? c : s);
    *out_y = radius * (is_flat ? s : c);
}

static void warp_aperture(const fl_camera *camera, double u, double v, double *out_x, double *out_y)
{
    double s, c, rim_x, rim_y, count = camera->blades;
    if (camera->blades == 0) {
        warp_disk(u, v, out_x, out_y);
        return;
    }
    fl_d_sincos_turns(1.0 / count, &rim_y, &rim_x);
    double wedge = floor(u * count), along = u * count - wedge, out = sqrt(v);
    double x = out * (1.0 - along * (1.0 - rim_x)), y = out * (along * rim_y);
    fl_d_sincos_turns(wedge / count + camera->blade_rotation_deg / 360.0, &s, &c);
    *out_x = x * c - y * s;
    *out_y = x * s + y * c;
}

static branch camera_ray(path *p, uint32_t x, uint32_t y)
{
    const fl_frame *f = p->frame;
    double jitter_x = f->pixel_x, jitter_y = f->pixel_y, lens_x = 0.0, lens_y = 0.0;
    uint32_t dimension = 0, strata = f->params.strata;
    uint32_t pixel_sample = f->params.frozen & FL_FREEZE_PIXEL ? 0 : p->sample;
    uint32_t lens_sample = f->params.frozen & FL_FREEZE_LENS ? 0 : p->sample;
    if (f->plan.samples_pixel) {
        jitter_x = number(p, FL_SET_CAMERA, pixel_sample, dimension++, strata);
        jitter_y = number(p, FL_SET_CAMERA, pixel_sample, dimension++, strata);
    }
    if (f->plan.samples_lens)
        warp_aperture(&f->params.camera, number(p, FL_SET_CAMERA, lens_sample, dimension, strata),
                      number(p, FL_SET_CAMERA, lens_sample, dimension + 1, strata), &lens_x,
                      &lens_y);
    branch b = {.throughput = {1.0, 1.0, 1.0}, .path = FL_PATH_CAMERA};
    fl_frame_ray(f, x + jitter_x, y + jitter_y, lens_x, lens_y, &b.ray.o, &b.ray.d);
    b.ray.t_max = HUGE_VAL;
    b.ray.source_object = b.ray.source_prim = FL_NONE;
    p->counts.camera_rays++;
    p->counts.sample_dimensions += f->plan.dimensions;
    return b;
}

/* --- Light -------------------------------------------------------------------------------------
 */

/* Outside the surface's error bound, on the side that the ray goes to. */
static fl_double_ray leave(const spot *at, fl_vec3 d)
{
    const fl_double_surface *s = &at->surface;
    double step = copysign(s->offset, fl_v3_dot(s->ng, d));
    return (fl_double_ray){fl_v3_mad(s->p, s->ng, step), d, HUGE_VAL, at->object, at->prim};
}

/* What of `arrives` comes through: nothing where blocked, unless shadows are transparent. */
static fl_vec3 occlude(path *p, fl_double_ray ray, fl_vec3 arrives)
{
    const fl_compiled *scene = p->frame->scene;
    const fl_geometry *g = &scene->geometry;
    fl_vec3 end = fl_v3_add(ray.o, ray.d), none = {0};
    bool is_far = !(ray.t_max <= 1.0);
    fl_double_hit hit;
    p->counts.shadow_rays++;
    if (!p->frame->params.transparent_shadows)
        return fl_double_any(g, &ray, &p->context) ? none : arrives;
    for (int surfaces = 0; surfaces <= FL_SHADOW_SURFACES_MAX && !fl_is_cancelled(&p->context);
         surfaces++) {
        if (!fl_double_nearest(g, &ray, &p->context, &hit))
            return arrives;
        arrives =
            fl_v3_mul(arrives, color_of(scene->shaders[scene->object_shader[hit.object]].refract));
        if (is_black(arrives))
            return none;
        spot far_side = {.object = hit.object, .prim = hit.prim};
        fl_double_resolve(g, &ray, &hit, false, &far_side.surface);
        double t_max = ray.t_max;
        ray = leave(&far_side, ray.d);
        ray.t_max = t_max;
        if (!is_far)
            ray.d = fl_v3_sub(end, ray.o);
    }
    p->counts.stopped_shadow_rays++;
    return none;
}

/* Phong: diffuse max(0, N.L) + specular max(0, R.L)^shininess, with R the mirrored view. */
static fl_vec3 reflectance(const path *p, const spot *at, fl_vec3 to_light)
{
    double n_l = fl_v3_dot(at->normal, to_light);
    fl_vec3 sum = fl_v3_scale(at->diffuse, n_l > 0.0 ? n_l : 0.0);
    if (!p->frame->plan.has_specular || is_black(at->specular))
        return sum;
    double g_l = fl_v3_dot(at->surface.ng, to_light);
    if (fl_v3_dot(at->surface.ng, at->view) < 0.0)
        g_l = -g_l;
    if (!p->frame->params.exact.ungated_specular && !(n_l > 0.0 && g_l > 0.0))
        return sum;
    double r_l = 2.0 * fl_v3_dot(at->normal, at->view) * n_l - fl_v3_dot(at->view, to_light);
    return fl_v3_mad(sum, at->specular,
                     fl_d_pow(fl_clamp(r_l, 0.0, 1.0), (double)at->shader->shininess));
}

static fl_vec3 light_point(path *p, const spot *at, const fl_frame_light *use,
                           const fl_light *light, uint32_t j)
{
    fl_vec3 center = fl_v3_sub(light->position, p->frame->scene->geometry.origin), u, v;
    double x, y;
    if (!use->draws)
        return center;
    const fl_params *params = &p->frame->params;
    uint32_t set = fl_set_light(params->seed, at->path, use->index);
    uint32_t freeze = at->path == FL_PATH_CAMERA ? fl_freeze_light(use->index) : FL_FREEZE_DEEPER;
    uint32_t index = (params->frozen & freeze ? 0 : p->sample) * use->samples + j;
    uint32_t strata = params->strata * use->samples;
    fl_v3_basis(fl_v3_normalize(light->direction), &u, &v);
    warp_disk(number(p, set, index, 0, strata), number(p, set, index, 1, strata), &x, &y);
    p->counts.sample_dimensions += 2;
    return fl_v3_mad(fl_v3_mad(center, u, x * light->radius), v, y * light->radius);
}

/* Sample j of a light: what arrives, the way not yet looked along. *ray: that way. */
static fl_vec3 light_sample(path *p, const spot *at, uint32_t l, uint32_t j, fl_double_ray *ray)
{
    const fl_frame_light *use = &p->frame->lights[l];
    const fl_light *light = &p->frame->params.lights[l];
    fl_vec3 axis = fl_v3_normalize(light->direction), color = light->color;
    if (light->kind == FL_LIGHT_DIRECTIONAL) {
        fl_vec3 to_light = fl_v3_scale(axis, -1.0);
        *ray = leave(at, to_light);
        return fl_v3_mul(color, reflectance(p, at, to_light));
    }
    fl_vec3 target = light_point(p, at, use, light, j), way = fl_v3_sub(target, at->surface.p);
    double distance = fl_v3_length(way);
    if (!(distance > 0.0) || (!use->is_two_sided && !(fl_v3_dot(way, axis) < 0.0)))
        return fl_v3(0, 0, 0);
    fl_vec3 to_light = fl_v3_normalize(way);
    if (use->has_attenuation) {
        const double *a = light->attenuation;
        color = fl_v3_scale(color, 1.0 / (a[0] + a[1] * distance + a[2] * (distance * distance)));
    }
    *ray = leave(at, to_light);
    ray->d = fl_v3_sub(target, ray->o);
    ray->t_max = SHADOW_END;
    return fl_v3_mul(color, reflectance(p, at, to_light));
}

/* The mean of a light's samples. */
static fl_vec3 light(path *p, const spot *at, uint32_t l)
{
    uint32_t samples = p->frame->lights[l].samples;
    fl_vec3 sum = {0};
    for (uint32_t j = 0; j < samples && !fl_is_cancelled(&p->context); j++) {
        fl_double_ray ray;
        fl_vec3 arrives = light_sample(p, at, l, j, &ray);
        if (is_black(fl_v3((double)(float)arrives.x, (double)(float)arrives.y,
                           (double)(float)arrives.z)))
            continue; /* as in float, which asks for the same shadow rays */
        if (p->frame->plan.has_shadows)
            arrives = occlude(p, ray, arrives);
        sum = fl_v3_add(sum, arrives);
    }
    return samples > 1 ? fl_v3_scale(sum, 1.0 / (double)samples) : sum;
}

/* --- One hit -----------------------------------------------------------------------------------
 */

static fl_vec3 background(const path *p, fl_vec3 d)
{
    const fl_frame *frame = p->frame;
    if (!frame->scene->cube[0])
        return frame->params.background;
    const double direction[3] = {d.x, d.y, d.z};
    double rgb[3];
    fl_cube_eval_double(frame->scene->cube, direction, frame->params.exact.course_cube, rgb);
    return fl_v3(rgb[0], rgb[1], rgb[2]);
}

/* The surface, its material there, and the ambient light on it. */
static fl_vec3 look(path *p, const fl_double_ray *ray, const fl_double_hit *hit, spot *at)
{
    const fl_frame *frame = p->frame;
    const fl_compiled *scene = frame->scene;
    bool has_texture = frame->plan.has_textures && scene->object_needs_uv[hit->object];
    at->object = hit->object;
    at->prim = hit->prim;
    at->shader = &scene->shaders[scene->object_shader[hit->object]];
    fl_double_resolve(&scene->geometry, ray, hit, has_texture, &at->surface);
    at->view = fl_v3_scale(fl_v3_normalize(ray->d), -1.0);
    at->diffuse = color_of(at->shader->diffuse);
    at->specular = color_of(at->shader->specular);
    if (frame->plan.has_textures && at->shader->texture != FL_NONE) {
        double texel[3];
        fl_texture_eval_double(&scene->textures[at->shader->texture], at->surface.u, at->surface.v,
                               texel);
        at->diffuse = fl_v3_mul(at->diffuse, fl_v3(texel[0], texel[1], texel[2]));
        p->counts.texture_lookups++;
    }
    bool is_behind = fl_v3_dot(at->surface.ng, at->view) < 0.0;
    bool flips = is_behind && !frame->params.exact.no_normal_flip;
    at->normal = flips ? fl_v3_scale(at->surface.ns, -1.0) : at->surface.ns;
    fl_vec3 reflects = at->shader->ambient_is_diffuse ? at->diffuse : color_of(at->shader->ambient);
    if (frame->params.exact.black_back_faces && is_behind)
        at->diffuse = at->specular = reflects = fl_v3(0, 0, 0);
    return fl_v3_mul(reflects, frame->params.ambient);
}

static void spawn(path *p, const spot *at, const branch *from, fl_vec3 weight, fl_vec3 direction,
                  bool is_refracted, branches *next)
{
    fl_vec3 c = fl_v3_mul(from->throughput, weight);
    double threshold = p->frame->params.weight_threshold;
    if (is_black(c) || (threshold > 0.0 && largest(c) < threshold))
        return;
    uint32_t child = fl_path_child(p->frame->params.seed, at->path, is_refracted ? 1 : 0);
    next->items[next->count++] = (branch){leave(at, direction), c, child, is_refracted};
}

static void spawn_both(path *p, const spot *at, const branch *from, branches *next)
{
    fl_vec3 reflect = color_of(at->shader->reflect), refract = color_of(at->shader->refract);
    if (is_black(reflect) && is_black(refract))
        return;
    double index = at->shader->index_exact;
    index = index > 0.0 ? index : 1.0;
    double n_v = fl_clamp(fl_v3_dot(at->normal, at->view), -1.0, 1.0);
    fl_vec3 back = fl_v3_scale(at->view, -1.0), bent = {0};
    fl_vec3 mirrored = fl_v3_mad(back, at->normal, 2.0 * n_v);
    bool is_total = false;
    if (p->frame->plan.has_refraction) {
        /* The part along the surface scales by the ratio of the indices; what is left of 1 goes
         * across. */
        bool enters = fl_v3_dot(at->surface.ng, at->view) >= 0.0;
        fl_vec3 along = fl_v3_scale(fl_v3_mad(back, at->normal, n_v), enters ? 1.0 / index : index);
        double across = 1.0 - fl_v3_dot(along, along);
        is_total = !(across > 0.0);
        bent = fl_v3_mad(along, at->normal, -sqrt(fl_max(across, 0.0)));
    }
    spawn(p, at, from, is_total ? fl_v3_add(reflect, refract) : reflect, mirrored, false, next);
    if (!is_total)
        spawn(p, at, from, refract, bent, true, next);
}

/* Radiance along a branch; what it spawns goes to `next`. */
static fl_vec3 shade(path *p, const branch *b, branches *next, bool may_spawn)
{
    const fl_frame *frame = p->frame;
    fl_double_hit hit;
    if (!fl_double_nearest(&frame->scene->geometry, &b->ray, &p->context, &hit))
        return background(p, b->ray.d);
    spot at = {.path = b->path};
    fl_vec3 sum = look(p, &b->ray, &hit, &at);
    for (uint32_t l = 0; l < frame->light_count; l++)
        if (!frame->lights[l].is_dark)
            sum = fl_v3_add(sum, light(p, &at, l));
    if (may_spawn)
        spawn_both(p, &at, b, next);
    return sum;
}

/* --- One sample --------------------------------------------------------------------------------
 */

/* Bring branches into order of path and keep the FL_PENDING_MAX heaviest (decision 5). */
static uint32_t settle(branches *all)
{
    uint32_t dropped = 0;
    for (uint32_t i = 1; i < all->count; i++) {
        branch moved = all->items[i];
        uint32_t k = i;
        for (; k > 0 && all->items[k - 1].path > moved.path; k--)
            all->items[k] = all->items[k - 1];
        all->items[k] = moved;
    }
    for (; all->count > FL_PENDING_MAX; dropped++) {
        uint32_t lightest = 0;
        for (uint32_t i = 1; i < all->count; i++)
            if (largest(all->items[i].throughput) < largest(all->items[lightest].throughput))
                lightest = i;
        memmove(&all->items[lightest], &all->items[lightest + 1],
                (--all->count - lightest) * sizeof *all->items);
    }
    return dropped;
}

static fl_vec3 run_sample(path *p, uint32_t x, uint32_t y)
{
    const fl_frame *frame = p->frame;
    bool branches_out = frame->plan.has_reflection || frame->plan.has_refraction;
    branches levels[2], *now = &levels[0], *next = &levels[1];
    fl_vec3 sum = {0};
    now->items[0] = camera_ray(p, x, y);
    now->count = 1;
    for (uint32_t level = 0; now->count > 0 && !fl_is_cancelled(&p->context); level++) {
        next->count = 0;
        for (uint32_t i = 0; i < now->count; i++) {
            const branch *b = &now->items[i];
            if (level > 0 && b->is_refracted)
                p->counts.refract_rays++;
            else if (level > 0)
                p->counts.reflect_rays++;
            fl_vec3 light = shade(p, b, next, branches_out && level < frame->params.depth_limit);
            sum = fl_v3_add(sum, fl_v3_mul(b->throughput, light));
        }
        p->counts.dropped_branches += settle(next);
        branches *swapped = now;
        now = next;
        next = swapped;
    }
    return sum;
}

bool fl_double_run(const fl_frame *frame, const fl_unit *unit, const fl_unit_result *result,
                   const atomic_uint_least64_t *generation, uint64_t wanted, fl_counts *counts)
{
    path p = {.frame = frame, .sample = unit->sample};
    p.context = (fl_isect_context){
        .solver = frame->params.solver, .generation = generation, .wanted = wanted};
    for (uint32_t i = 0; i < unit->count; i++) {
        p.pixel = fl_pixel_id(unit->x[i], unit->y[i]);
        fl_vec3 light = run_sample(&p, unit->x[i], unit->y[i]);
        if (fl_is_cancelled(&p.context))
            return false;
        float rgb[3] = {(float)light.x, (float)light.y, (float)light.z};
        bool is_valid = isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]);
        result->r[i] = is_valid ? rgb[0] : 0.0f;
        result->g[i] = is_valid ? rgb[1] : 0.0f;
        result->b[i] = is_valid ? rgb[2] : 0.0f;
        result->is_valid[i] = is_valid;
        p.counts.invalid_samples += is_valid ? 0 : 1;
    }
    p.counts.samples += unit->count;
    p.counts.isect = p.context.counts;
    fl_counts_add(counts, &p.counts);
    return true;
}
