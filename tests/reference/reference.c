/* SPDX-License-Identifier: MIT
 *
 * Numbers in comments are those of the list of binding decisions.
 */
#include "reference.h"

#include "points.h"

/* ---- intersection: every shape, every triangle ---- */

typedef struct ray {
    ref_vec o, d; /* t counts lengths of d, also in object space (4) */
    double t_min; /* what is nearer is the surface that the ray leaves */
} ray;

typedef struct hit {
    double t;
    const ref_shape *shape;
    uint32_t part; /* triangle or profile segment */
    double a, b;   /* barycentric, or the segment's parameter */
} hit;

static void accept(hit *best, const ref_shape *shape, double t_min, double t, uint32_t part,
                   double a, double b)
{
    if (t > t_min && t < best->t)
        *best = (hit){t, shape, part, a, b};
}

static void meet_sphere(const ref_shape *s, ray r, hit *best)
{
    ref_vec f = sub(r.o, s->a);
    double a = dot(r.d, r.d), b = dot(f, r.d), c = dot(f, f) - s->radius * s->radius;
    double discriminant = b * b - a * c;
    if (discriminant < 0.0)
        return;
    double q = -(b + copysign(sqrt(discriminant), b));
    accept(best, s, r.t_min, q / a, 0, 0, 0);
    if (q != 0.0)
        accept(best, s, r.t_min, c / q, 0, 0, 0);
}

/* corner + a u + b v: false unless the ray meets that plane. */
static bool meet_span(ray r, ref_vec corner, ref_vec u, ref_vec v, double *t, double *a, double *b)
{
    ref_vec n = cross(u, v), from = sub(r.o, corner), moment = cross(from, r.d);
    double det = -dot(n, r.d);
    *t = dot(n, from) / det;
    *a = dot(v, moment) / det;
    *b = -dot(u, moment) / det;
    return det != 0.0;
}

static void meet_mesh(const ref_shape *s, ray r, hit *best)
{
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        const ref_vec *p = s->triangles[i].corner;
        double t, a, b;
        if (meet_span(r, p[0], sub(p[1], p[0]), sub(p[2], p[0]), &t, &a, &b) && a >= 0.0 &&
            b >= 0.0 && a + b <= 1.0)
            accept(best, s, r.t_min, t, i, a, b);
    }
}

/* F(t) = |d_y o_xz + (y(t) - o_y) d_xz|^2 - d_y^2 x(t)^2: zero where the ray, at the height of the
 * profile's point t, is as far from the axis as that point. */
static double cut(const ref_segment *s, ray r, double t)
{
    double x = curve(s->x, s->degree, t, NULL), y = curve(s->y, s->degree, t, NULL) - r.o.y;
    double px = r.d.y * r.o.x + y * r.d.x, pz = r.d.y * r.o.z + y * r.d.z;
    return px * px + pz * pz - r.d.y * r.d.y * x * x;
}

typedef struct cut_search {
    const ref_shape *shape;
    uint32_t part, degree;
    ray r;
    hit *best;
} cut_search;

/* Roots of F in [lo, hi] from its Bernstein coefficients there: no change of sign means no root,
 * one means one; otherwise both halves are searched. A change of sign of F itself is bisected. */
static void search_roots(const cut_search *c, const double *g, double lo, double hi)
{
    enum { HALVINGS = 44 };
    int changes = 0;
    for (uint32_t i = 0; i < c->degree; i++)
        changes += (g[i] < 0.0) != (g[i + 1] < 0.0);
    if (changes == 0)
        return;
    const ref_segment *s = &c->shape->segments[c->part];
    bool begins_below = g[0] < 0.0;
    double middle = 0.5 * (lo + hi);
    if (changes > 1 && hi - lo > ldexp(1.0, -HALVINGS)) {
        double left[2 * REF_DEGREE_MAX + 1], right[2 * REF_DEGREE_MAX + 1];
        memcpy(right, g, (c->degree + 1) * sizeof *g);
        for (uint32_t n = c->degree, k = 0;; n--, k++) {
            left[k] = right[0];
            if (n == 0)
                break;
            for (uint32_t i = 0; i < n; i++)
                right[i] = 0.5 * (right[i] + right[i + 1]);
        }
        /* De Casteljau leaves the right half in place: its coefficient i was last touched in step
         * degree - i. */
        search_roots(c, left, lo, middle);
        search_roots(c, right, middle, hi);
        return;
    }
    if (changes > 1)
        return;
    while (middle > lo && middle < hi) {
        if ((cut(s, c->r, middle) < 0.0) == begins_below)
            lo = middle;
        else
            hi = middle;
        middle = 0.5 * (lo + hi);
    }
    double y = curve(s->y, s->degree, middle, NULL);
    accept(c->best, c->shape, c->r.t_min, (y - c->r.o.y) / c->r.d.y, c->part, middle, 0);
}

static double choose(uint32_t n, uint32_t k)
{
    double c = 1.0;
    for (uint32_t i = 0; i < k; i++)
        c = c * (n - i) / (i + 1.0);
    return c;
}

/* What a level ray is tilted by, 0 otherwise: F says nothing about it. */
static double tilt_of(ref_vec d)
{
    double level = 1e-7 * length(d);
    return fabs(d.y) < level ? level : 0.0;
}

static void meet_revolution(const ref_shape *s, ray r, hit *best)
{
    if (tilt_of(r.d) > 0.0)
        r.d.y = copysign(tilt_of(r.d), r.d.y);
    for (uint32_t part = 0; part < s->segment_count; part++) {
        const ref_segment *p = &s->segments[part];
        uint32_t n = p->degree;
        double g[2 * REF_DEGREE_MAX + 1] = {0}, c[REF_DEGREE_MAX + 1];
        for (uint32_t i = 0; i <= n; i++)
            c[i] = choose(n, i);
        for (uint32_t i = 0; i <= n; i++)
            for (uint32_t j = 0; j <= n; j++) {
                double yi = p->y[i] - r.o.y, yj = p->y[j] - r.o.y;
                double px = (r.d.y * r.o.x + yi * r.d.x) * (r.d.y * r.o.x + yj * r.d.x);
                double pz = (r.d.y * r.o.z + yi * r.d.z) * (r.d.y * r.o.z + yj * r.d.z);
                g[i + j] += c[i] * c[j] * (px + pz - r.d.y * r.d.y * p->x[i] * p->x[j]);
            }
        for (uint32_t k = 0; k <= 2 * n; k++)
            g[k] /= choose(2 * n, k);
        cut_search search = {s, part, 2 * n, r, best};
        search_roots(&search, g, 0.0, 1.0);
    }
}

static void meet(const ref_shape *s, ray r, hit *best)
{
    double t, a, b;
    r.o = transform(s->to_object, r.o, 1.0);
    r.d = transform(s->to_object, r.d, 0.0);
    switch (s->kind) {
    case REF_SPHERE:
        meet_sphere(s, r, best);
        break;
    case REF_PLANE:
        accept(best, s, r.t_min, (s->radius - dot(s->a, r.o)) / dot(s->a, r.d), 0, 0, 0);
        break;
    case REF_SQUARE:
        if (meet_span(r, s->a, s->b, s->c, &t, &a, &b) && a >= 0.0 && a <= 1.0 && b >= 0.0 &&
            b <= 1.0)
            accept(best, s, r.t_min, t, 0, a, b);
        break;
    case REF_DISK:
        t = dot(s->b, sub(s->a, r.o)) / dot(s->b, r.d);
        if (length(sub(add(r.o, scale(r.d, t)), s->a)) <= s->radius)
            accept(best, s, r.t_min, t, 0, 0, 0);
        break;
    case REF_MESH:
        meet_mesh(s, r, best);
        break;
    case REF_REVOLUTION:
        meet_revolution(s, r, best);
        break;
    }
}

static hit nearest(const ref_dump *scene, ray r, double t_max)
{
    hit best = {.t = t_max};
    for (uint32_t i = 0; i < scene->shape_count; i++)
        meet(&scene->shapes[i], r, &best);
    return best;
}

/* ---- what is known of a hit ---- */

typedef struct surface {
    ref_vec p, ng, ns; /* world; unit normals */
    double u, v;
    bool has_uv, clamps_v;
} surface;

static void describe_plane(const ref_shape *s, ref_vec p, surface *out)
{
    ref_vec n = unit(s->a), x = vec(1, 0, 0), y = vec(0, 0, -1);
    if (hypot(n.x, n.z) > 1e-6) {
        x = unit(cross(vec(0, 1, 0), n));
        y = cross(n, x);
    }
    out->ng = out->ns = n;
    out->u = dot(p, x);
    out->v = dot(p, y);
    out->has_uv = true;
}

static void describe_mesh(const ref_shape *s, const hit *h, surface *out)
{
    const ref_triangle *f = &s->triangles[h->part];
    double w[3] = {1.0 - h->a - h->b, h->a, h->b};
    ref_vec sum = vec(0, 0, 0);
    for (int k = 0; k < 3; k++) {
        sum = add(sum, scale(f->normal[k], w[k]));
        out->u += w[k] * f->u[k];
        out->v += w[k] * f->v[k];
    }
    out->ng = unit(cross(sub(f->corner[1], f->corner[0]), sub(f->corner[2], f->corner[0])));
    out->ns = f->is_flat || length(sum) == 0.0 ? out->ng : unit(sum);
    out->has_uv = f->has_uv;
}

static double turn_of(double y, double x) /* atan2 in turns, [0, 1) */
{
    double turns = atan2(y, x) / (2.0 * pi);
    return turns < 0.0 ? turns + 1.0 : turns;
}

static void describe_revolution(const ref_shape *s, const hit *h, ref_vec p, surface *out)
{
    const ref_segment *c = &s->segments[h->part];
    double dx, dy, x = curve(c->x, c->degree, h->a, &dx), r = hypot(p.x, p.z);
    curve(c->y, c->degree, h->a, &dy);
    /* The curve (|x|, y) has the normal (dy, -d|x|): outwards when it runs round the body
     * counter-clockwise. */
    double slope = x < 0.0 ? -dx : dx, out_r = r > 0.0 ? dy / r : 0.0;
    ref_vec n = vec(out_r * p.x, -slope, out_r * p.z);
    out->ng = out->ns = unit(s->is_clockwise ? scale(n, -1.0) : n);
    out->u = 1.0 - turn_of(p.z, p.x); /* (11) */
    out->v = s->y_max > s->y_min ? (p.y - s->y_min) / (s->y_max - s->y_min) : 0.0;
    out->has_uv = out->clamps_v = true;
}

static surface describe(ray r, const hit *h)
{
    const ref_shape *s = h->shape;
    surface out = {0};
    ref_vec p =
        add(transform(s->to_object, r.o, 1.0), scale(transform(s->to_object, r.d, 0.0), h->t));
    switch (s->kind) {
    case REF_SPHERE:
        out.ng = out.ns = unit(sub(p, s->a));
        out.u = turn_of(out.ng.y, out.ng.x);
        out.v = 1.0 - acos(fmax(-1.0, fmin(1.0, out.ng.z))) / pi;
        out.has_uv = out.clamps_v = true;
        break;
    case REF_PLANE:
        describe_plane(s, p, &out);
        break;
    case REF_SQUARE:
        out = (surface){.ng = cross(s->b, s->c), .u = h->a, .v = h->b, .has_uv = true};
        out.ns = out.ng;
        break;
    case REF_DISK:
        describe_plane(&(ref_shape){.a = s->b}, sub(p, s->a), &out);
        out.u = 0.5 + 0.5 * out.u / s->radius; /* the picture spans the disk along a plane's axes */
        out.v = 0.5 + 0.5 * out.v / s->radius;
        break;
    case REF_MESH:
        describe_mesh(s, h, &out);
        break;
    case REF_REVOLUTION:
        describe_revolution(s, h, p, &out);
        break;
    }
    out.p = add(r.o, scale(r.d, h->t));
    out.ng = transform_normal(s->to_object, out.ng);
    out.ns = transform_normal(s->to_object, out.ns);
    return out;
}

/* ---- pictures ---- */

static ref_vec texel(const ref_image *image, double column, double row_up, bool repeats_u,
                     bool repeats_v)
{
    double w = image->width, h = image->height;
    column = repeats_u ? column - w * floor(column / w) : fmax(0.0, fmin(w - 1.0, column));
    row_up = repeats_v ? row_up - h * floor(row_up / h) : fmax(0.0, fmin(h - 1.0, row_up));
    size_t row = (size_t)(h - 1.0 - row_up); /* v = 0 is the bottom row (11) */
    return image->texels[row * image->width + (size_t)column];
}

/* x and y in texels from the left and the bottom; whole numbers are texel centres. */
static ref_vec blend(const ref_image *image, double x, double y, bool repeats_u, bool repeats_v)
{
    double i = floor(x), j = floor(y), a = x - i, b = y - j;
    ref_vec low = add(scale(texel(image, i, j, repeats_u, repeats_v), 1.0 - a),
                      scale(texel(image, i + 1.0, j, repeats_u, repeats_v), a));
    ref_vec high = add(scale(texel(image, i, j + 1.0, repeats_u, repeats_v), 1.0 - a),
                       scale(texel(image, i + 1.0, j + 1.0, repeats_u, repeats_v), a));
    return add(scale(low, 1.0 - b), scale(high, b));
}

static ref_vec diffuse_of(const ref_shape *s, const surface *at)
{
    const ref_material *m = &s->material;
    if (!m->image || !at->has_uv)
        return m->diffuse;
    bool is_plane = s->kind == REF_PLANE;
    double u = is_plane ? at->u / m->texture_scale[0] : at->u * m->texture_scale[0];
    double v = is_plane ? at->v / m->texture_scale[1] : at->v * m->texture_scale[1];
    double x = u * m->image->width, y = v * m->image->height;
    ref_vec t = m->is_nearest ? texel(m->image, floor(x), floor(y), true, !at->clamps_v)
                              : blend(m->image, x - 0.5, y - 0.5, true, !at->clamps_v);
    return times(m->diffuse, t);
}

/* Faces as the course's cube maps have them, front at +z; ours turns the two mirrored ones round.
 */
static ref_vec background(const ref_dump *scene, ref_vec d)
{
    if (!scene->cube[0])
        return scene->background;
    enum { RIGHT, LEFT, UP, DOWN, FRONT, BACK };
    double ax = fabs(d.x), ay = fabs(d.y), az = fabs(d.z), u, v;
    double mirror = scene->course_cube ? -1.0 : 1.0;
    int face;
    if (ax >= ay && ax >= az) {
        face = d.x > 0.0 ? RIGHT : LEFT;
        u = d.z / d.x;
        v = d.y / ax;
    } else if (ay >= az) {
        face = d.y > 0.0 ? UP : DOWN;
        u = d.x / ay;
        v = d.y > 0.0 ? d.z / ay : -mirror * d.z / ay;
    } else {
        face = d.z > 0.0 ? FRONT : BACK;
        u = d.z > 0.0 ? -d.x / az : mirror * d.x / az;
        v = d.y / az;
    }
    const ref_image *image = scene->cube[face];
    double x = 0.5 * (u + 1.0) * image->width, y = 0.5 * (v + 1.0) * image->height;
    return scene->course_cube ? blend(image, x, y - 1.0, false, false)
                              : blend(image, x - 0.5, y - 0.5, false, false);
}

/* ---- light ---- */

typedef struct sample {
    const ref_dump *scene;
    uint32_t pixel, index;
} sample;

/* The share of light that reaches r.o from t_max away. */
static ref_vec transmittance(const ref_dump *scene, ray r, double t_max)
{
    ref_vec left = vec(1, 1, 1);
    double margin = r.t_min;
    if (scene->no_shadows)
        return left;
    for (hit h = nearest(scene, r, t_max); h.shape; h = nearest(scene, r, t_max)) {
        if (!scene->transparent_shadows)
            return vec(0, 0, 0);
        left = times(left, h.shape->material.refract);
        if (left.x == 0.0 && left.y == 0.0 && left.z == 0.0)
            break;
        r.t_min = h.t + margin; /* the next surface behind this one */
    }
    return left;
}

/* Light from `direction` (unit, towards the light) at a hit seen from `eye`: diffuse and Phong's
 * lobe (8). */
static ref_vec phong(const ref_dump *scene, const ref_material *m, ref_vec diffuse,
                     const surface *at, ref_vec eye, ref_vec direction)
{
    double cosine = dot(at->ns, direction);
    ref_vec mirrored = sub(scale(at->ns, 2.0 * dot(at->ns, eye)), eye);
    bool gate = cosine > 0.0 && dot(at->ng, direction) * dot(at->ng, eye) > 0.0;
    double lobe = gate || scene->ungated_specular
                      ? pow(fmax(0.0, dot(mirrored, direction)), m->shininess)
                      : 0.0;
    return add(scale(diffuse, fmax(0.0, cosine)), scale(m->specular, lobe));
}

static ref_vec lit(const sample *s, const ref_material *m, ref_vec diffuse, const surface *at,
                   ref_vec eye, double t_min, uint32_t path, uint32_t number)
{
    const ref_light *light = &s->scene->lights[number];
    ref_vec sum = vec(0, 0, 0), u, v;
    basis(light->direction, &u, &v);
    for (uint32_t j = 0; j < light->samples; j++) {
        ref_vec to = scale(light->direction, -1.0);
        double distance = HUGE_VAL, fade = 1.0;
        if (light->kind != REF_DIRECTIONAL) {
            ref_vec point = light->position;
            if (light->kind == REF_DISKLIGHT && light->radius > 0.0) {
                uint32_t set = HASH(s->scene->seed, 1, path, number),
                         i = s->index * light->samples + j;
                double x, y;
                disc_point(coordinate(s->scene, s->pixel, i, set, 0),
                           coordinate(s->scene, s->pixel, i, set, 1), &x, &y);
                point = add(point, scale(add(scale(u, x), scale(v, y)), light->radius));
            }
            to = sub(point, at->p);
            distance = length(to);
            to = unit(to);
            fade = light->attenuation[0] +
                   distance * (light->attenuation[1] + distance * light->attenuation[2]);
        }
        if (light->kind == REF_DISKLIGHT && !light->is_two_sided &&
            dot(to, light->direction) >= 0.0)
            continue;
        ref_vec through = transmittance(s->scene, (ray){at->p, to, t_min}, distance * (1.0 - 1e-9));
        ref_vec color = times(scale(light->color, 1.0 / fade), through);
        sum = add(sum, times(color, phong(s->scene, m, diffuse, at, eye, to)));
    }
    return scale(sum, 1.0 / light->samples);
}

static ref_vec trace(const sample *s, ray r, uint32_t depth, uint32_t path, ref_vec weight);

static ref_vec branch(const sample *s, ref_vec color, ray r, uint32_t depth, uint32_t path,
                      ref_vec weight)
{
    ref_vec product = times(weight, color);
    bool is_black = color.x == 0.0 && color.y == 0.0 && color.z == 0.0;
    if (is_black ||
        (s->scene->weight_threshold > 0.0 && largest(product) < s->scene->weight_threshold))
        return vec(0, 0, 0);
    return times(color, trace(s, r, depth + 1, path, product));
}

static ref_vec trace(const sample *s, ray r, uint32_t depth, uint32_t path, ref_vec weight)
{
    const ref_dump *scene = s->scene;
    hit h = nearest(scene, r, HUGE_VAL);
    if (!h.shape)
        return background(scene, r.d);
    const ref_material *m = &h.shape->material;
    surface at = describe(r, &h);
    ref_vec eye = scale(unit(r.d), -1.0);
    bool enters = dot(at.ng, eye) > 0.0;
    /* Ng decides which side is the viewer's (8), so at a silhouette n . eye may be below 0. */
    ref_vec n = (dot(at.ns, at.ng) > 0.0) == enters ? at.ns : scale(at.ns, -1.0);
    if (!scene->no_normal_flip)
        at.ns = n;
    if (scene->black_back_faces && !enters)
        return vec(0, 0, 0);
    /* Rounding of the hit point, with room; what is nearer than that is the surface itself. Where
     * a tilted ray met it, that is off by the tilt. */
    bool is_tilted =
        h.shape->kind == REF_REVOLUTION && tilt_of(transform(h.shape->to_object, r.d, 0.0)) > 0.0;
    double t_min = (is_tilted ? 1e-6 : 1e-10) * (length(r.o) + fabs(h.t) * length(r.d));
    ref_vec diffuse = diffuse_of(h.shape, &at);
    ref_vec sum = times(m->has_ambient ? m->ambient : diffuse, scene->ambient);
    for (uint32_t i = 0; i < scene->light_count; i++)
        sum = add(sum, lit(s, m, diffuse, &at, eye, t_min, path, i));
    if (depth >= scene->depth_limit || scene->no_recursion)
        return sum;
    double cosine = fmax(-1.0, fmin(1.0, dot(n, eye))),
           eta = enters ? 1.0 / m->refraction_index : m->refraction_index;
    double radicand = 1.0 - eta * eta * (1.0 - cosine * cosine);
    ref_vec reflect = m->reflect, refract = m->refract;
    if (radicand <= 0.0) { /* total internal reflection (8) */
        reflect = add(reflect, refract);
        refract = vec(0, 0, 0);
    }
    ref_vec mirrored = sub(scale(n, 2.0 * cosine), eye);
    ref_vec bent = sub(scale(sub(scale(n, cosine), eye), eta), scale(n, sqrt(fmax(0.0, radicand))));
    sum = add(sum, branch(s, reflect, (ray){at.p, mirrored, t_min}, depth,
                          HASH(scene->seed, 2, path, 0), weight));
    return add(sum, branch(s, refract, (ray){at.p, bent, t_min}, depth,
                           HASH(scene->seed, 2, path, 1), weight));
}

/* ---- camera (10) ---- */

ref_vec reference_sample(const ref_dump *scene, uint32_t x, uint32_t y, uint32_t index,
                         const double *nudge)
{
    sample s = {scene, y << 16 | x, index};
    double w = scene->width, h = scene->height, px = x + 0.5, py = y + 0.5, lens_x = 0.0,
           lens_y = 0.0;
    uint32_t d = 0;
    if (scene->pixel == REF_PIXEL_AREA) {
        px = x + coordinate(scene, s.pixel, index, 0, d++);
        py = y + coordinate(scene, s.pixel, index, 0, d++);
    } else if (scene->pixel == REF_PIXEL_CORNER) { /* of a picture whose row 0 is the bottom */
        px = x;
        py = y + 1.0;
    } else if (scene->pixel == REF_PIXEL_ENDS) {
        px = x * w / (w - 1.0);
        py = y * h / (h - 1.0);
    }
    if (scene->aperture > 0.0) {
        double u = coordinate(scene, s.pixel, index, 0, d),
               v = coordinate(scene, s.pixel, index, 0, d + 1);
        if (scene->blades)
            polygon_point(scene->blades, scene->blade_rotation, u, v, &lens_x, &lens_y);
        else
            disc_point(u, v, &lens_x, &lens_y);
    }
    ref_vec forward = unit(scene->direction), right = unit(cross(forward, scene->up));
    ref_vec up = scene->has_raw_up ? scene->up : cross(right, forward);
    double extent = scene->is_orthographic ? scene->ortho_size : 2.0 * tan(0.5 * scene->fov);
    double sx = (px - 0.5 * w) * extent / (scene->spans_square ? w : h),
           sy = (0.5 * h - py) * extent / h;
    ref_vec lens = scale(add(scale(right, lens_x), scale(up, lens_y)), scene->aperture);
    ref_vec screen = add(scale(right, sx), scale(up, sy));
    ray r = {add(scene->eye, lens), sub(forward, scale(lens, 1.0 / scene->focus)), 0.0};
    if (scene->is_orthographic) {
        r.o = add(r.o, screen);
        if (scene->spans_square) /* the 2004 course's camera also sees what is behind its plane */
            r.t_min = -HUGE_VAL;
    } else {
        r.d = add(r.d, screen);
    }
    if (nudge)
        r.d = add(r.d, scale(add(scale(right, nudge[0]), scale(up, nudge[1])), length(r.d)));
    return trace(&s, r, 0, 1, vec(1, 1, 1));
}
