/* SPDX-License-Identifier: MIT
 *
 * The surface at a hit: kernel_resolve.c for a ray and an origin that are doubles to the end.
 */
#include <math.h>

#include "core/double_trace.h"
#include "core/math64.h"

/* Half the spacing of doubles at 1, and how many of those an origin moves (kernel_resolve.c). */
static const double rounding = 0x1p-53;
static const double offset_roundings = 16.0, sphere_roundings = 4.0;

/* Unit normals nearer than this to the y axis count as along it when a plane's texture is laid out.
 */
static const double along_axis = 1e-6;

/** A hit in the space of its object. */
typedef struct place {
    const fl_geometry *geometry;
    const fl_instance *instance; /* NULL: baked. */
    const fl_double_hit *hit;
    fl_double_ray ray;
    uint32_t entry;
    bool needs_uv;
} place;

typedef struct solution {
    fl_double_surface s;
    double roundings, size; /* offset = roundings * rounding * (|p| and size, in world units). */
} solution;

static solution plain(fl_vec3 p, fl_vec3 n)
{
    return (solution){.s = {.p = p, .ng = n, .ns = n}, .roundings = offset_roundings};
}

static solution solve_sphere(const place *w)
{
    const fl_spheres *spheres = &w->geometry->spheres;
    fl_vec3 c = spheres->center[w->entry];
    fl_vec3 n = fl_v3_normalize(fl_v3_mad(fl_v3_sub(w->ray.o, c), w->ray.d, w->hit->t));
    solution s = plain(fl_v3_mad(c, n, spheres->radius[w->entry]), n);
    s.roundings = sphere_roundings;
    s.size = fl_v3_max_abs(c);
    if (w->needs_uv) {
        const double half_turn = 3.14159265358979323846;
        double phi = fl_d_atan2(n.y, n.x), theta = fl_d_atan2(sqrt(n.x * n.x + n.y * n.y), n.z);
        s.s.u = phi / (2.0 * half_turn);
        s.s.u = s.s.u < 0.0 ? s.s.u + 1.0 : s.s.u;
        s.s.v = 1.0 - theta / half_turn;
    }
    return s;
}

static solution solve_plane(const place *w)
{
    fl_vec3 n = w->geometry->planes.normal[w->entry];
    double offset = w->geometry->planes.offset[w->entry];
    fl_vec3 p = fl_v3_mad(w->ray.o, w->ray.d, w->hit->t);
    solution s = plain(fl_v3_mad(p, n, offset - fl_v3_dot(n, p)), n);
    if (w->needs_uv) {
        fl_vec3 at = w->instance ? s.s.p : fl_v3_add(s.s.p, w->geometry->origin);
        fl_vec3 x = fl_v3_cross(fl_v3(0, 1, 0), n);
        bool is_along_y = fl_v3_max_abs(x) < along_axis;
        x = fl_v3_normalize(x);
        s.s.u = is_along_y ? at.x : fl_v3_dot(at, x);
        s.s.v = is_along_y ? -at.z : fl_v3_dot(at, fl_v3_cross(n, x));
    }
    return s;
}

static solution solve_patch(const place *w)
{
    const fl_patches *patches = &w->geometry->patches;
    fl_vec3 n = patches->normal[w->entry], c = patches->corner[w->entry];
    fl_vec3 f = fl_v3_mad(fl_v3_sub(w->ray.o, c), w->ray.d, w->hit->t);
    f = fl_v3_mad(f, n, -fl_v3_dot(n, f));
    solution s = plain(fl_v3_add(c, f), n);
    s.size = fl_v3_max_abs(c) + fl_v3_max_abs(f);
    if (w->needs_uv) {
        double a = fl_v3_dot(f, patches->dual_u[w->entry]);
        double b = fl_v3_dot(f, patches->dual_v[w->entry]);
        bool is_disk = patches->is_disk[w->entry];
        s.s.u = fl_clamp(is_disk ? 0.5 * (a + 1.0) : a, 0.0, 1.0);
        s.s.v = fl_clamp(is_disk ? 0.5 * (b + 1.0) : b, 0.0, 1.0);
    }
    return s;
}

static solution solve_revolution(const place *w)
{
    const fl_revolutions *r = &w->geometry->revolutions;
    fl_vec3 shift = w->instance ? fl_v3(0, 0, 0) : r->shift, from = fl_v3_add(w->ray.o, shift);
    const double o[3] = {from.x, from.y, from.z}, d[3] = {w->ray.d.x, w->ray.d.y, w->ray.d.z};
    fl_revolve_point point;
    fl_revolve_resolve(r->profile[w->entry], o, d, &w->hit->at.revolve, &point);
    solution s = plain(fl_v3_sub(point.position, shift), point.normal);
    s.s.u = point.u;
    s.s.v = point.v;
    s.size = point.scale + fl_v3_max_abs(shift);
    return s;
}

static fl_vec3 float3(const float *array, uint32_t index)
{
    const float *p = array + 3 * (size_t)index;
    return fl_v3((double)p[0], (double)p[1], (double)p[2]);
}

static fl_vec3 blend(const fl_vec3 v[3], const double weight[3])
{
    return fl_v3_mad(fl_v3_mad(fl_v3_scale(v[0], weight[0]), v[1], weight[1]), v[2], weight[2]);
}

/* The interpolated normal where all three corners have one, else the face's. */
static fl_vec3 shading_normal(const place *w, const fl_tri_mesh *mesh, uint32_t face, fl_vec3 flat)
{
    if (!mesh->normal)
        return flat;
    fl_vec3 normal[3];
    for (uint32_t k = 0; k < 3; k++) {
        normal[k] = float3(mesh->normal, mesh->normal_index[3 * (size_t)face + k]);
        if (!(fl_v3_max_abs(normal[k]) > 0.0))
            return flat;
    }
    fl_vec3 n = fl_v3_normalize(blend(normal, w->hit->at.weight));
    return fl_v3_max_abs(n) > 0.0 ? n : flat;
}

static solution solve_triangle(const place *w)
{
    const fl_tri_mesh *mesh = &w->geometry->meshes[w->instance->index];
    uint32_t face = mesh->face_object ? w->entry : w->hit->prim;
    const double *weight = w->hit->at.weight;
    fl_vec3 corner[3];
    for (uint32_t k = 0; k < 3; k++)
        corner[k] = float3(mesh->position, mesh->index[3 * (size_t)face + k]);
    fl_vec3 n = fl_v3_normalize(
        fl_v3_cross(fl_v3_sub(corner[1], corner[0]), fl_v3_sub(corner[2], corner[0])));
    if (!(fl_v3_max_abs(n) > 0.0))
        n = fl_v3_scale(fl_v3_normalize(w->ray.d), -1.0);
    solution s = plain(blend(corner, weight), n);
    s.s.ns = shading_normal(w, mesh, face, n);
    if (!w->needs_uv || !mesh->uv)
        return s;
    const uint32_t *at = mesh->uv_index + 3 * (size_t)face;
    if (at[0] == FL_NONE || at[1] == FL_NONE || at[2] == FL_NONE)
        return s;
    for (int k = 0; k < 3; k++) {
        s.s.u += weight[k] * (double)mesh->uv[2 * (size_t)at[k]];
        s.s.v += weight[k] * (double)mesh->uv[2 * (size_t)at[k] + 1];
    }
    return s;
}

static solution solve(const place *w)
{
    switch (w->geometry->object_kind[w->hit->object]) {
    case FL_OBJECT_SPHERE:
        return solve_sphere(w);
    case FL_OBJECT_PLANE:
        return solve_plane(w);
    case FL_OBJECT_SQUARE:
    case FL_OBJECT_DISK:
        return solve_patch(w);
    case FL_OBJECT_REVOLUTION:
        return solve_revolution(w);
    case FL_OBJECT_TRIANGLE:
    case FL_OBJECT_MESH:
    case FL_OBJECT_KIND_COUNT:
    default:
        return solve_triangle(w);
    }
}

void fl_double_resolve(const fl_geometry *geometry, const fl_double_ray *ray,
                       const fl_double_hit *hit, bool needs_uv, fl_double_surface *out_surface)
{
    uint32_t number = geometry->object_instance[hit->object];
    const fl_instance *instance = number == FL_NONE ? NULL : &geometry->instances[number];
    place w = {.geometry = geometry,
               .instance = instance,
               .hit = hit,
               .ray = fl_double_ray_to(instance, ray),
               .entry = geometry->object_entry[hit->object],
               .needs_uv = needs_uv};
    solution s = solve(&w);
    double gain = 1.0, base = s.size;
    if (instance) {
        gain = instance->error_gain;
        base = instance->error_base;
        if (!instance->is_identity) {
            const fl_affine *back = &instance->to_object_exact;
            s.s.p = fl_affine_point(&instance->to_world_exact, s.s.p);
            s.s.ng = fl_v3_normalize(fl_affine_transposed_direction(back, s.s.ng));
            s.s.ns = fl_v3_normalize(fl_affine_transposed_direction(back, s.s.ns));
        }
    }
    if (fl_v3_dot(s.s.ns, s.s.ng) < 0.0)
        s.s.ns = fl_v3_scale(s.s.ns, -1.0);
    s.s.offset = fl_max(s.roundings * rounding * (gain * fl_v3_max_abs(s.s.p) + base), 1e-300);
    *out_surface = s.s;
}
