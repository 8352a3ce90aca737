/* SPDX-License-Identifier: MIT
 *
 * Along mirrors and through glass: one ray, one branch at a time; and from four such rays to where
 * a lens must be focused to see the end of the path sharply.
 */
#include <math.h>

#include "core/trace_piece.h"

enum { LENS_RAYS = 4, SCAN_STEPS = 96, REFINE_STEPS = 48 };

/* A branch weaker than this is not what one sees in a surface. */
#define WEIGHT_MIN 0.01
/* Lens radius that stands in for a pinhole's, in depths of the first surface. */
#define SMALL_LENS 1e-3
/* Focus distances looked at: from this part of the first surface's depth to so many path lengths.
 */
#define SCAN_NEAREST  (1.0 / 16.0)
#define SCAN_FARTHEST 64.0

static double largest(const float rgb[3])
{
    return fl_max(fl_max((double)rgb[0], (double)rgb[1]), (double)rgb[2]);
}

/* Which branch goes on at the surface; false: the path ends here. */
static bool choose(const fl_shader *shader, uint32_t bounce, const fl_trace_seen *same,
                   bool *out_is_refracted)
{
    if (same) {
        *out_is_refracted = same->refracted >> bounce & 1u;
        return bounce < same->bounces;
    }
    double reflect = largest(shader->reflect), refract = largest(shader->refract);
    double weight = fl_max(reflect, refract);
    *out_is_refracted = refract > reflect;
    return bounce < FL_TRACE_BOUNCES_MAX && weight > WEIGHT_MIN &&
           (bounce == 0 || weight >= largest(shader->diffuse));
}

/* Direction behind the surface of normal n (on the side of -d); false: total reflection. */
static bool refract(fl_vec3 d, fl_vec3 n, double eta, fl_vec3 *out_direction)
{
    double cosine = -fl_v3_dot(d, n), k = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (k < 0.0)
        return false;
    *out_direction = fl_v3_mad(fl_v3_scale(d, eta), n, eta * cosine - sqrt(k));
    return true;
}

typedef struct walk {
    const fl_frame *frame;
    fl_piece piece;
} walk;

/* The next ray, from the surface in the piece. False: it cannot go that way. */
static bool step(walk *w, const fl_shader *shader, bool is_refracted, bool may_reflect,
                 bool *out_was_refracted)
{
    fl_rays *rays = &w->piece.rays;
    const fl_surface *s = &w->piece.surface;
    fl_vec3 d =
        fl_v3_normalize(fl_v3((double)rays->dx[0], (double)rays->dy[0], (double)rays->dz[0]));
    fl_vec3 ng = fl_v3((double)s->ngx[0], (double)s->ngy[0], (double)s->ngz[0]);
    fl_vec3 n = fl_v3((double)s->nsx[0], (double)s->nsy[0], (double)s->nsz[0]), next;
    bool is_entering = fl_v3_dot(ng, d) < 0.0;
    double index = (double)shader->refraction_index > 0.0 ? (double)shader->refraction_index : 1.0;
    if (!is_entering)
        n = fl_v3_scale(n, -1.0);
    *out_was_refracted = is_refracted && refract(d, n, is_entering ? 1.0 / index : index, &next);
    if (is_refracted && !*out_was_refracted && !may_reflect)
        return false;
    if (!*out_was_refracted)
        next = fl_v3_mad(d, n, -2.0 * fl_v3_dot(d, n));
    double side = fl_v3_dot(ng, next) < 0.0 ? -1.0 : 1.0;
    fl_vec3 at = fl_v3((double)s->px[0], (double)s->py[0], (double)s->pz[0]);
    uint32_t object = w->piece.hits.object[0], prim = w->piece.hits.prim[0];
    fl_rays_set(rays, 0, fl_v3_mad(at, ng, side * (double)s->offset[0]), next, INFINITY);
    rays->source_object[0] = object;
    rays->source_prim[0] = prim;
    return true;
}

/* From the ray in the piece to the end of its path. */
static bool follow(walk *w, const fl_trace_seen *same, fl_trace_seen *out)
{
    const fl_compiled *scene = w->frame->scene;
    const fl_isect_kernels *kernels = fl_isect_kernels_of(scene->isa);
    fl_isect_context context = {.solver = w->frame->params.solver};
    *out = (fl_trace_seen){.object = FL_NONE};
    fl_piece_set_count(&w->piece.rays, 1);
    for (;;) {
        kernels->nearest(&scene->geometry, &w->piece.rays, &w->piece.hits, &context);
        if (w->piece.hits.object[0] == FL_NONE)
            return false;
        kernels->resolve(&scene->geometry, &w->piece.rays, &w->piece.hits, NULL, &w->piece.surface,
                         &context);
        const fl_surface *s = &w->piece.surface;
        fl_vec3 at = fl_v3((double)s->px[0], (double)s->py[0], (double)s->pz[0]);
        fl_vec3 from = out->bounces ? out->position : w->frame->eye;
        out->length += fl_v3_length(fl_v3_sub(at, from));
        out->position = at;
        if (out->bounces == 0)
            out->first_depth = fl_v3_dot(fl_v3_sub(at, w->frame->eye), w->frame->axis_w);
        out->object = w->piece.hits.object[0];
        const fl_shader *shader = &scene->shaders[scene->object_shader[out->object]];
        bool is_refracted, was_refracted;
        if (!choose(shader, out->bounces, same, &is_refracted))
            return !same || out->bounces == same->bounces;
        if (!step(w, shader, is_refracted, !same, &was_refracted))
            return false;
        out->refracted |= (uint32_t)was_refracted << out->bounces;
        out->bounces++;
    }
}

/* How far apart four rays of a lens focused at `focus` end, as the sum of squared distances from
 * their mean. */
static double spread(walk *w, double x_px, double y_px, double radius, double focus,
                     const fl_trace_seen *same)
{
    static const double corner[LENS_RAYS][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const fl_frame *frame = w->frame;
    fl_vec3 end[LENS_RAYS], mean = {0}, eye, straight;
    fl_frame_ray(frame, x_px, y_px, 0.0, 0.0, &eye, &straight);
    for (int i = 0; i < LENS_RAYS; i++) {
        fl_vec3 lens = fl_v3_mad(fl_v3_scale(frame->axis_h, corner[i][0] * radius), frame->axis_v,
                                 corner[i][1] * radius);
        fl_trace_seen seen;
        fl_rays_set(&w->piece.rays, 0, fl_v3_add(eye, lens),
                    fl_v3_mad(straight, lens, -1.0 / focus), INFINITY);
        if (!follow(w, same, &seen))
            return (double)INFINITY;
        end[i] = seen.position;
        mean = fl_v3_mad(mean, end[i], 1.0 / LENS_RAYS);
    }
    double sum = 0.0;
    for (int i = 0; i < LENS_RAYS; i++) {
        fl_vec3 off = fl_v3_sub(end[i], mean);
        sum += fl_v3_dot(off, off);
    }
    return sum;
}

/* The best focus near the best of a scan; steps are equal in 1 / focus, in which the spread of a
 * plane path is a parabola. */
static double search(walk *w, double x_px, double y_px, const fl_trace_seen *seen)
{
    double radius = w->frame->aperture > 0.0 ? w->frame->aperture : SMALL_LENS * seen->first_depth;
    double highest = 1.0 / (SCAN_NEAREST * seen->first_depth);
    double lowest = 1.0 / (SCAN_FARTHEST * seen->length), ratio = sqrt(lowest / highest);
    double factor = 1.0, best = 0.0, least = (double)INFINITY;
    for (int halving = 0; halving < 5; halving++)
        ratio = sqrt(ratio);
    /* ratio^(64) spans the range; a few steps more look beyond its far end. */
    for (int i = 0; i < SCAN_STEPS; i++, factor *= ratio) {
        double value = spread(w, x_px, y_px, radius, 1.0 / (highest * factor), seen);
        if (value < least) {
            least = value;
            best = highest * factor;
        }
    }
    if (!(least < (double)INFINITY))
        return 0.0;
    double low = best * ratio, high = best / ratio;
    const double golden = 0.6180339887498949;
    for (int i = 0; i < REFINE_STEPS; i++) {
        double a = high - golden * (high - low), b = low + golden * (high - low);
        if (spread(w, x_px, y_px, radius, 1.0 / a, seen) <
            spread(w, x_px, y_px, radius, 1.0 / b, seen))
            high = b;
        else
            low = a;
    }
    return 2.0 / (low + high);
}

bool fl_trace_focus(const fl_frame *frame, double x_px, double y_px, double *out_focus,
                    fl_trace_seen *out_seen)
{
    walk w = {.frame = frame};
    *out_focus = 0.0;
    *out_seen = (fl_trace_seen){.object = FL_NONE};
    if (!fl_piece_init(&w.piece, 16))
        return false;
    fl_vec3 origin, direction;
    fl_frame_ray(frame, x_px, y_px, 0.0, 0.0, &origin, &direction);
    fl_rays_set(&w.piece.rays, 0, origin, direction, INFINITY);
    if (!frame->is_orthographic && follow(&w, NULL, out_seen) && out_seen->first_depth > 0.0)
        *out_focus = out_seen->bounces ? search(&w, x_px, y_px, out_seen) : out_seen->first_depth;
    out_seen->position = fl_v3_add(out_seen->position, frame->scene->geometry.origin);
    fl_piece_deinit(&w.piece);
    return true;
}
