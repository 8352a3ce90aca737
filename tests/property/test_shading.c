/* SPDX-License-Identifier: MIT
 *
 * Random scenes of spheres and planes against a tracer of a hundred lines: recursive, scalar,
 * double.
 */
#include "../kernel/pipeline_world.h"

#include "core/sampler.h"
#include "support/property.h"

enum { WIDTH = 24, HEIGHT = 16 };

#define HALF (UINT64_C(1) << 51) /* half of an interval, as a case of a property draws it */

typedef struct oracle {
    const world *w;
    uint32_t pixel, sample;
} oracle;

typedef struct meeting {
    double t;
    const fl_object *object;
    fl_vec3 point, normal; /* normal: outward, unit */
} meeting;

static double meet_sphere(const fl_object *o, fl_vec3 from, fl_vec3 d, bool is_source)
{
    fl_vec3 f = fl_v3_sub(from, o->as.sphere.center);
    double a = fl_v3_dot(d, d), b = fl_v3_dot(f, d), r = o->as.sphere.radius;
    if (is_source) /* the other end of the chord */
        return -2 * b / a;
    double disc = b * b - a * (fl_v3_dot(f, f) - r * r);
    if (disc < 0)
        return -1;
    double near = (-b - sqrt(disc)) / a, far = (-b + sqrt(disc)) / a;
    return near > 0 ? near : far;
}

static bool meet(const world *w, fl_vec3 from, fl_vec3 d, double t_max, const fl_object *source,
                 meeting *out)
{
    out->t = t_max;
    out->object = NULL;
    for (uint32_t i = 0; i < w->scene.object_count; i++) {
        const fl_object *o = &w->objects[i];
        double t;
        if (o->kind == FL_OBJECT_SPHERE) {
            t = meet_sphere(o, from, d, o == source);
        } else {
            t = (o->as.plane.offset - fl_v3_dot(o->as.plane.normal, from)) /
                fl_v3_dot(o->as.plane.normal, d);
            if (o == source)
                t = -1;
        }
        if (t > 1e-12 && t < out->t) {
            out->t = t;
            out->object = o;
        }
    }
    if (!out->object)
        return false;
    out->point = fl_v3_mad(from, d, out->t);
    out->normal = out->object->kind == FL_OBJECT_SPHERE
                      ? fl_v3_normalize(fl_v3_sub(out->point, out->object->as.sphere.center))
                      : fl_v3_normalize(out->object->as.plane.normal);
    return true;
}

/* A light's sample as seen from `path`, by the scalar definition of the sampler. */
static fl_vec3 light_point(const oracle *k, uint32_t l, uint32_t path, uint32_t index)
{
    const fl_light *light = &k->w->lights[l];
    if (light->kind != FL_LIGHT_DISK || !(light->radius > 0))
        return light->position;
    fl_vec3 n = light->direction;
    double sign = copysign(1, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    fl_vec3 u = fl_v3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            v = fl_v3(b, sign + n.y * n.y * a, -n.y);
    uint32_t seed = k->w->params.seed, set = fl_set_light(seed, path, l);
    float x, y, s = fl_sample_scalar(k->w->params.sampler, seed, k->pixel, index, set, 0);
    fl_f_warp_disk(s, fl_sample_scalar(k->w->params.sampler, seed, k->pixel, index, set, 1), &x,
                   &y);
    return fl_v3_mad(fl_v3_mad(light->position, u, light->radius * (double)x), v,
                     light->radius * (double)y);
}

static fl_vec3 shine(const oracle *k, const meeting *m, uint32_t l, fl_vec3 at, fl_vec3 n,
                     fl_vec3 view)
{
    const fl_light *light = &k->w->lights[l];
    const fl_material *material = &k->w->materials[m->object->material];
    bool is_far = light->kind == FL_LIGHT_DIRECTIONAL;
    fl_vec3 way = is_far ? fl_v3_scale(light->direction, -1) : fl_v3_sub(at, m->point),
            black = {0, 0, 0};
    double distance = is_far ? 1 : fl_v3_length(way);
    fl_vec3 to_light = fl_v3_scale(way, 1 / distance);
    double n_l = fl_v3_dot(n, to_light);
    meeting other;
    if (n_l <= 0 || (!light->is_two_sided && fl_v3_dot(way, light->direction) >= 0))
        return black;
    if (meet(k->w, m->point, way, is_far ? HUGE_VAL : 1 - 1e-6, m->object, &other))
        return black;
    double r_l = 2 * fl_v3_dot(n, view) * n_l - fl_v3_dot(view, to_light);
    double lobe = pow(fl_max(r_l, 0), material->shininess);
    fl_vec3 part = fl_v3_mad(fl_v3_scale(material->diffuse, n_l), material->specular, lobe);
    double fade = is_far ? 1
                         : light->attenuation[0] + light->attenuation[1] * distance +
                               light->attenuation[2] * distance * distance;
    return fl_v3_scale(fl_v3_mul(light->color, part), 1 / fade);
}

static fl_vec3 trace(const oracle *k, fl_vec3 from, fl_vec3 d, const fl_object *source,
                     fl_vec3 weight, uint32_t path, uint32_t depth)
{
    const world *w = k->w;
    meeting m;
    if (!meet(w, from, d, HUGE_VAL, source, &m))
        return fl_v3_mul(weight, w->params.background);
    const fl_material *material = &w->materials[m.object->material];
    fl_vec3 view = fl_v3_normalize(fl_v3_scale(d, -1)), n = m.normal, sum;
    bool enters = fl_v3_dot(n, view) >= 0;
    if (!enters)
        n = fl_v3_scale(n, -1);
    sum = fl_v3_mul(w->params.ambient, material->diffuse);
    for (uint32_t l = 0; l < w->scene.light_count; l++) {
        uint32_t count = w->lights[l].kind == FL_LIGHT_DISK && w->lights[l].radius > 0
                             ? w->params.light_samples
                             : 1;
        for (uint32_t j = 0; j < count; j++) {
            fl_vec3 at = light_point(k, l, path, k->sample * count + j);
            sum = fl_v3_mad(sum, shine(k, &m, l, at, n, view), 1.0 / count);
        }
    }
    sum = fl_v3_mul(sum, weight);
    if (depth == w->params.depth_limit)
        return sum;
    double cosine = fl_v3_dot(n, view),
           ratio = enters ? 1 / material->refraction_index : material->refraction_index;
    double radicand = 1 - ratio * ratio * (1 - cosine * cosine);
    fl_vec3 mirrored = fl_v3_mad(fl_v3_scale(view, -1), n, 2 * cosine);
    fl_vec3 bent =
        fl_v3_mad(fl_v3_scale(view, -ratio), n, ratio * cosine - sqrt(fl_max(radicand, 0)));
    fl_vec3 reflect =
        radicand > 0 ? material->reflect : fl_v3_add(material->reflect, material->refract);
    for (uint32_t branch = 0; branch < 2; branch++) {
        fl_vec3 next = fl_v3_mul(weight, branch ? material->refract : reflect);
        double largest = fl_max(next.x, fl_max(next.y, next.z));
        if ((branch && radicand <= 0) || largest <= 0 || largest < w->params.weight_threshold)
            continue;
        uint32_t child = fl_path_child(w->params.seed, path, branch);
        sum = fl_v3_add(
            sum, trace(k, m.point, branch ? bent : mirrored, m.object, next, child, depth + 1));
    }
    return sum;
}

static fl_vec3 random3(property *p, double low, double high)
{
    double x = property_between(p, low, high), y = property_between(p, low, high);
    return fl_v3(x, y, property_between(p, low, high));
}

/* True in so many of a hundred cases, and false in the simplest. */
static bool chance(property *p, uint32_t percent)
{
    return property_below(p, 100) >= 100 - percent;
}

static void random_material(world *w, property *p)
{
    fl_material *m = add_material(w);
    m->diffuse = random3(p, 0, 1);
    if (chance(p, 50)) {
        m->specular = random3(p, 0, 1);
        m->shininess = property_between(p, 1, 30);
    }
    if (chance(p, 40))
        m->reflect = random3(p, 0, 0.9);
    if (chance(p, 40)) {
        m->refract = random3(p, 0, 0.9);
        m->refraction_index = property_between(p, 0.6, 2);
    }
}

static void random_light(world *w, property *p)
{
    fl_light_kind kind = (fl_light_kind)property_below(p, 3);
    fl_vec3 at = random3(p, -6, 6);
    fl_light *l = add_light(w, kind, at, random3(p, -0.2, 1));
    fl_vec3 direction = random3(p, -1, 1);
    l->direction = fl_v3_max_abs(direction) > 0 ? fl_v3_normalize(direction) : fl_v3(0, 0, 1);
    l->radius = kind == FL_LIGHT_DISK ? property_between(p, 0, 1.5) : 0;
    l->is_two_sided = kind != FL_LIGHT_DISK || chance(p, 50);
    l->attenuation[1] = kind == FL_LIGHT_POINT ? property_between(p, 0, 0.2) : 0;
}

static void random_world(world *w, property *p)
{
    world_init(w);
    w->params.seed = (uint32_t)property_below(p, UINT64_C(1) << 32);
    w->params.width = WIDTH;
    w->params.height = HEIGHT;
    w->params.exact.pixel = FL_PIXEL_CENTER;
    w->params.background = random3(p, 0, 1);
    w->params.ambient = random3(p, 0, 0.3);
    w->params.depth_limit = (uint32_t)property_below(p, 4);
    w->params.light_samples = 1 + (uint32_t)property_below(p, 3);
    w->params.weight_threshold = property_between(p, 0, 0.1);
    random_material(w, p);
    add_plane(w, chance(p, 50) ? fl_v3(0.1, -1, 0) : fl_v3(0, 2, 0.3), -2.5);
    uint64_t spheres = property_given(p, 5, 6), lights = property_given(p, 3, 4);
    for (uint64_t i = 0; i < spheres; i++) {
        property_mark(p);
        random_material(w, p);
        fl_vec3 center = random3(p, -3, 3);
        add_sphere(w, center, property_between(p, 0.3, 1.5));
    }
    for (uint64_t i = 0; i < lights; i++) {
        property_mark(p);
        random_light(w, p);
    }
}

static bool is_close(fl_vec3 a, const float b[3])
{
    fl_vec3 d = fl_v3_sub(a, fl_v3((double)b[0], (double)b[1], (double)b[2]));
    return fl_v3_max_abs(d) <= 2e-4 * (1 + fl_v3_max_abs(a));
}

static bool matches_the_reference(property *p, void *data)
{
    static picture got;
    world w;
    (void)data;
    random_world(&w, p);
    uint32_t sample = (uint32_t)property_below(p, 5);
    fl_frame *frame = world_frame(&w, fl_cpu_best_isa());
    picture_render(&got, frame, sample, 200, false);
    bool holds = got.counts.invalid_samples == 0 || property_fail(p, "invalid samples");
    for (uint32_t i = 0; holds && i < got.count; i++) {
        uint32_t x = i % WIDTH, y = i / WIDTH;
        oracle k = {&w, fl_pixel_id(x, y), sample};
        fl_vec3 o, d, white = {1, 1, 1};
        fl_frame_ray(frame, x + 0.5, y + 0.5, 0, 0, &o, &d);
        o = fl_v3_add(o, frame->scene->geometry.origin);
        fl_vec3 want = trace(&k, o, d, NULL, white, FL_PATH_CAMERA, 0);
        holds =
            is_close(want, got.rgb[i]) ||
            property_fail(p, "pixel %u %u: %g %g %g, want %g %g %g", x, y, (double)got.rgb[i][0],
                          (double)got.rgb[i][1], (double)got.rgb[i][2], want.x, want.y, want.z);
    }
    fl_frame_release(frame);
    return holds;
}

static void random_scenes_match_the_reference(void **state)
{
    (void)state;
    /* A plane under one light, which a lobe of a limited shininess makes too bright. */
    static const uint64_t lobe[] = {
        [17] = 2,  [18] = 1,    [35] = 50, [38] = HALF, [39] = HALF + HALF / 2,
        [40] = 60, [51] = HALF, [52] = 1,  [54] = HALF, [64] = HALF / 4};
    const property_case kept[] = {PROPERTY_CASE(lobe)};
    property_run(matches_the_reference, NULL, 20, 60, kept, FL_COUNT_OF(kept));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_scenes_match_the_reference),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
