/* SPDX-License-Identifier: MIT */
#include "core/resolve.h"

#include "core/math64.h"

/* An origin moved by this many roundings of its largest coordinate, and of the size of what its
 * neighbours are made of, is on the side it was moved to for every test. A test's own error is at
 * most 14 such roundings (geometry.h). */
static const double offset_roundings = 16.0;

/* A sphere knows its own rays by name, so only the rounding of the point itself remains. */
static const double sphere_roundings = 4.0;

/* Unit normals nearer than this to the y axis count as along it when a plane's texture is laid out.
 */
static const double along_axis = 1e-6;

/** One ray, its winner, and where the answer goes: everything in the space of the winner. */
typedef struct winner {
    const fl_geometry *geometry;
    const fl_instance *instance; /* NULL: baked. */
    float ray_o[3], ray_d[3];    /* World, as traced. */
    fl_vec3 o, d;                /* Exactly transformed. */
    double t;                    /* As the float test found it. */
    uint32_t object, prim, entry;
    bool needs_uv;
} winner;

typedef struct solution {
    fl_vec3 p, ng, ns;
    double u, v;
    double roundings, size; /* offset = roundings * epsilon * (|p| and size, in world units). */
} solution;

/* Unit vector along `a`, without the care for extreme lengths where there is no need. */
static inline fl_vec3 unit(fl_vec3 a)
{
    double square = fl_v3_dot(a, a);
    if (square > 1e-200 && square < 1e200)
        return fl_v3_scale(a, 1.0 / sqrt(square));
    return fl_v3_normalize(a);
}

/* --- Shapes ---------------------------------------------------------------------------------- */

static solution solve_sphere(const winner *w)
{
    fl_vec3 c = w->geometry->spheres.center[w->entry];
    double r = w->geometry->spheres.radius[w->entry];
    fl_vec3 f = fl_v3_sub(w->o, c);
    double a = fl_v3_dot(w->d, w->d), b = -fl_v3_dot(f, w->d);
    fl_vec3 l = fl_v3_mad(f, w->d, b / a);
    double rest = fl_max(r * r - fl_v3_dot(l, l), 0.0);
    double q = b + copysign(sqrt(a * rest), b);
    double t1 = q / a, t0 = q != 0.0 ? (fl_v3_dot(f, f) - r * r) / q : t1;
    double t = fabs(t0 - w->t) < fabs(t1 - w->t) ? t0 : t1;
    fl_vec3 n = unit(fl_v3_mad(f, w->d, t));
    solution s = {.p = fl_v3_mad(c, n, r), .ng = n, .ns = n, .roundings = sphere_roundings};
    if (w->needs_uv) {
        const double half_turn = 3.14159265358979323846;
        double phi = fl_d_atan2(n.y, n.x), theta = fl_d_atan2(sqrt(n.x * n.x + n.y * n.y), n.z);
        s.u = phi / (2.0 * half_turn);
        s.u = s.u < 0.0 ? s.u + 1.0 : s.u;
        s.v = 1.0 - theta / half_turn;
    }
    return s;
}

static solution solve_plane(const winner *w)
{
    fl_vec3 n = w->geometry->planes.normal[w->entry];
    double offset = w->geometry->planes.offset[w->entry];
    double t = (offset - fl_v3_dot(n, w->o)) / fl_v3_dot(n, w->d);
    fl_vec3 p = fl_v3_mad(w->o, w->d, isfinite(t) ? t : w->t);
    p = fl_v3_mad(p, n, offset - fl_v3_dot(n, p));
    solution s = {.p = p, .ng = n, .ns = n, .roundings = offset_roundings};
    if (w->needs_uv) {
        fl_vec3 at = w->instance ? p : fl_v3_add(p, w->geometry->origin);
        fl_vec3 x = fl_v3_cross(fl_v3(0, 1, 0), n);
        if (fl_v3_max_abs(x) < along_axis) {
            s.u = at.x;
            s.v = -at.z;
        } else {
            x = unit(x);
            s.u = fl_v3_dot(at, x);
            s.v = fl_v3_dot(at, fl_v3_cross(n, x));
        }
    }
    return s;
}

static solution solve_patch(const winner *w)
{
    const fl_patches *patches = &w->geometry->patches;
    fl_vec3 n = patches->normal[w->entry], c = patches->corner[w->entry];
    fl_vec3 f = fl_v3_sub(w->o, c);
    double t = -fl_v3_dot(n, f) / fl_v3_dot(n, w->d);
    f = fl_v3_mad(f, w->d, isfinite(t) ? t : w->t);
    f = fl_v3_mad(f, n, -fl_v3_dot(n, f));
    solution s = {.p = fl_v3_add(c, f), .ng = n, .ns = n, .roundings = offset_roundings};
    s.size = fl_v3_max_abs(c) + fl_v3_max_abs(f);
    if (w->needs_uv) {
        s.u = fl_v3_dot(f, patches->dual_u[w->entry]);
        s.v = fl_v3_dot(f, patches->dual_v[w->entry]);
        if (patches->is_disk[w->entry]) {
            s.u = 0.5 * (s.u + 1.0);
            s.v = 0.5 * (s.v + 1.0);
        }
        s.u = fl_clamp(s.u, 0.0, 1.0);
        s.v = fl_clamp(s.v, 0.0, 1.0);
    }
    return s;
}

/* By the very ray that the kernel gave to the solver, so that it is the same root. */
static solution solve_revolution(const winner *w, fl_revolve_solver solver)
{
    const fl_revolutions *r = &w->geometry->revolutions;
    const float *fo = w->ray_o, *fd = w->ray_d;
    fl_vec3 shift = w->instance ? fl_v3(0, 0, 0) : r->shift;
    double from[3] = {shift.x, shift.y, shift.z}, o[3], d[3];
    for (int a = 0; a < 3; a++) {
        float oa = fo[a], da = fd[a];
        if (w->instance) {
            const float *row = w->instance->to_object + 4 * a;
            oa = row[0] * fo[0] + row[1] * fo[1] + row[2] * fo[2] + row[3];
            da = row[0] * fd[0] + row[1] * fd[1] + row[2] * fd[2];
        }
        o[a] = (double)oa + from[a];
        d[a] = (double)da;
    }
    fl_revolve_hit hit;
    fl_revolve_point point;
    if (!fl_revolve_nearest(r->profile[w->entry], o, d, 0.0, w->t * (1.0 + 0x1p-22), solver,
                            &hit)) {
        fl_vec3 n = fl_v3_scale(unit(w->d), -1.0);
        return (solution){
            .p = fl_v3_mad(w->o, w->d, w->t), .ng = n, .ns = n, .roundings = offset_roundings};
    }
    fl_revolve_resolve(r->profile[w->entry], o, d, &hit, &point);
    return (solution){.p = fl_v3_sub(point.position, shift),
                      .ng = point.normal,
                      .ns = point.normal,
                      .u = point.u,
                      .v = point.v,
                      .roundings = offset_roundings,
                      .size = point.scale};
}

/* --- Triangles ------------------------------------------------------------------------------- */

static fl_vec3 mesh_vec3(const float *array, uint32_t index)
{
    const float *p = array + 3 * (size_t)index;
    return fl_v3((double)p[0], (double)p[1], (double)p[2]);
}

static double component(fl_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* Weights of the corners where the ray meets the triangle's plane, pushed back into the triangle:
 * at least 0, sum 1. */
static void corner_weights(const fl_vec3 corner[3], fl_vec3 o, fl_vec3 d, double out_weight[3])
{
    double size = fl_v3_max_abs(d), x[3], y[3];
    int kz = fabs(d.x) == size ? 0 : fabs(d.y) == size ? 1 : 2;
    int kx = kz == 2 ? 0 : kz + 1, ky = kx == 2 ? 0 : kx + 1;
    double inverse = 1.0 / component(d, kz);
    double shear_x = component(d, kx) * inverse, shear_y = component(d, ky) * inverse;
    for (int k = 0; k < 3; k++) {
        fl_vec3 v = fl_v3_sub(corner[k], o);
        x[k] = component(v, kx) - shear_x * component(v, kz);
        y[k] = component(v, ky) - shear_y * component(v, kz);
    }
    double weight[3] = {x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2],
                        x[1] * y[0] - y[1] * x[0]};
    double sign = weight[0] + weight[1] + weight[2] < 0.0 ? -1.0 : 1.0, sum = 0.0;
    for (int k = 0; k < 3; k++) {
        weight[k] = fl_max(sign * weight[k], 0.0);
        sum += weight[k];
    }
    double share = 1.0 / sum;
    for (int k = 0; k < 3; k++)
        out_weight[k] = sum > 0.0 ? weight[k] * share : 1.0 / 3.0;
}

static fl_vec3 blend(const fl_vec3 v[3], const double weight[3])
{
    return fl_v3_mad(fl_v3_mad(fl_v3_scale(v[0], weight[0]), v[1], weight[1]), v[2], weight[2]);
}

static void mesh_uv(const fl_tri_mesh *mesh, uint32_t face, const double weight[3], solution *s)
{
    const uint32_t *at = mesh->uv_index + 3 * (size_t)face;
    if (at[0] == FL_NONE || at[1] == FL_NONE || at[2] == FL_NONE)
        return;
    for (int k = 0; k < 3; k++) {
        s->u += weight[k] * (double)mesh->uv[2 * (size_t)at[k]];
        s->v += weight[k] * (double)mesh->uv[2 * (size_t)at[k] + 1];
    }
}

static solution solve_triangle(const winner *w)
{
    const fl_tri_mesh *mesh = &w->geometry->meshes[w->instance->index];
    uint32_t face = mesh->face_object ? w->entry : w->prim;
    const uint32_t *at = mesh->index + 3 * (size_t)face;
    fl_vec3 corner[3];
    double weight[3];
    for (int k = 0; k < 3; k++)
        corner[k] = mesh_vec3(mesh->position, at[k]);
    corner_weights(corner, w->o, w->d, weight);
    fl_vec3 n = unit(fl_v3_cross(fl_v3_sub(corner[1], corner[0]), fl_v3_sub(corner[2], corner[0])));
    if (!(fl_v3_max_abs(n) > 0.0))
        n = fl_v3_scale(unit(w->d), -1.0);
    solution s = {.p = blend(corner, weight), .ng = n, .ns = n, .roundings = offset_roundings};
    if (mesh->normal) {
        const uint32_t *normal_at = mesh->normal_index + 3 * (size_t)face;
        fl_vec3 normal[3];
        bool is_smooth = true;
        for (int k = 0; k < 3; k++) {
            normal[k] = mesh_vec3(mesh->normal, normal_at[k]);
            is_smooth &= fl_v3_max_abs(normal[k]) > 0.0;
        }
        fl_vec3 ns = unit(blend(normal, weight));
        if (is_smooth && fl_v3_max_abs(ns) > 0.0)
            s.ns = ns;
    }
    if (w->needs_uv && mesh->uv)
        mesh_uv(mesh, face, weight, &s);
    return s;
}

/* --- All of them ----------------------------------------------------------------------------- */

static solution solve(const winner *w, fl_revolve_solver solver)
{
    switch (w->geometry->object_kind[w->object]) {
    case FL_OBJECT_SPHERE:
        return solve_sphere(w);
    case FL_OBJECT_PLANE:
        return solve_plane(w);
    case FL_OBJECT_SQUARE:
    case FL_OBJECT_DISK:
        return solve_patch(w);
    case FL_OBJECT_REVOLUTION:
        return solve_revolution(w, solver);
    case FL_OBJECT_TRIANGLE:
    case FL_OBJECT_MESH:
    default:
        return solve_triangle(w);
    }
}

/* Back to world space, with the error bound in world units. */
static double to_world(const winner *w, solution *s)
{
    const fl_instance *instance = w->instance;
    double gain = 1.0, base = s->size;
    if (instance) {
        gain = instance->error_gain;
        base = instance->error_base;
        if (!instance->is_identity) {
            s->p = fl_affine_point(&instance->to_world_exact, s->p);
            s->ng = unit(fl_affine_transposed_direction(&instance->to_object_exact, s->ng));
            s->ns = unit(fl_affine_transposed_direction(&instance->to_object_exact, s->ns));
        }
    }
    if (fl_v3_dot(s->ns, s->ng) < 0.0)
        s->ns = fl_v3_scale(s->ns, -1.0);
    double bound = s->roundings * FL_EPSILON * (gain * fl_v3_max_abs(s->p) + base);
    return fl_max(bound, 1e-30);
}

static void store(fl_surface *out, uint32_t i, const solution *s, double offset)
{
    out->px[i] = (float)s->p.x;
    out->py[i] = (float)s->p.y;
    out->pz[i] = (float)s->p.z;
    out->ngx[i] = (float)s->ng.x;
    out->ngy[i] = (float)s->ng.y;
    out->ngz[i] = (float)s->ng.z;
    out->nsx[i] = (float)s->ns.x;
    out->nsy[i] = (float)s->ns.y;
    out->nsz[i] = (float)s->ns.z;
    out->offset[i] = (float)offset;
    out->u[i] = (float)s->u;
    out->v[i] = (float)s->v;
}

static void resolve_hit(const fl_geometry *g, const fl_rays *rays, const fl_hits *hits, uint32_t i,
                        bool needs_uv, fl_surface *out, fl_revolve_solver solver)
{
    uint32_t object = hits->object[i], instance = g->object_instance[object];
    winner w = {.geometry = g,
                .instance = instance == FL_NONE ? NULL : &g->instances[instance],
                .ray_o = {rays->ox[i], rays->oy[i], rays->oz[i]},
                .ray_d = {rays->dx[i], rays->dy[i], rays->dz[i]},
                .o = fl_v3((double)rays->ox[i], (double)rays->oy[i], (double)rays->oz[i]),
                .d = fl_v3((double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i]),
                .t = (double)hits->t[i],
                .object = object,
                .prim = hits->prim[i],
                .entry = g->object_entry[object],
                .needs_uv = needs_uv};
    if (w.instance && !w.instance->is_identity) {
        w.o = fl_affine_point(&w.instance->to_object_exact, w.o);
        w.d = fl_affine_direction(&w.instance->to_object_exact, w.d);
    }
    solution s = solve(&w, solver);
    double offset = to_world(&w, &s);
    store(out, i, &s, offset);
}

void fl_resolve(const fl_geometry *geometry, const fl_rays *rays, const fl_hits *hits,
                const uint8_t *needs_uv, fl_surface *out_surface, fl_isect_context *context)
{
    static const solution missed;
    for (uint32_t i = 0; i < rays->count; i++) {
        if (i % 64 == 0 && fl_is_cancelled(context))
            return;
        uint32_t object = hits->object[i];
        if (object == FL_NONE)
            store(out_surface, i, &missed, 1e-30);
        else
            resolve_hit(geometry, rays, hits, i, needs_uv && needs_uv[object], out_surface,
                        context->solver);
    }
}
