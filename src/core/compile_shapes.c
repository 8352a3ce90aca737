/* SPDX-License-Identifier: MIT
 *
 * Spheres, planes, patches and surfaces of revolution: arrays for the kernels, baked objects first.
 */
#include <string.h>

#include "core/compile_build.h"

/* Floats of a structure-of-arrays, with room to the next multiple of 8 and NaN there, which nothing
 * hits. */
static bool float_arrays(fl_compiler *c, uint32_t count, float **const arrays[], size_t array_count)
{
    uint32_t padded = (count + 7) / 8 * 8;
    for (size_t k = 0; k < array_count; k++) {
        float *a = fl_arena_alloc(&c->out->arena, padded, sizeof *a);
        if (!a)
            return fl_out_of_memory(c->diags, "the scene's shapes");
        for (uint32_t i = count; i < padded; i++)
            a[i] = NAN;
        *arrays[k] = a;
    }
    return true;
}

#define ALLOC(field, count) ((field) = fl_arena_alloc(&c->out->arena, (count), sizeof *(field)))

static bool allocate(fl_compiler *c, const uint32_t counts[FL_OBJECT_KIND_COUNT])
{
    fl_geometry *g = c->geometry;
    fl_spheres *s = &g->spheres;
    fl_planes *p = &g->planes;
    fl_patches *q = &g->patches;
    fl_revolutions *r = &g->revolutions;
    s->count = counts[FL_OBJECT_SPHERE];
    p->count = counts[FL_OBJECT_PLANE];
    q->count = counts[FL_OBJECT_SQUARE] + counts[FL_OBJECT_DISK];
    r->count = counts[FL_OBJECT_REVOLUTION];
    bool ok =
        ALLOC(s->center, s->count) && ALLOC(s->radius, s->count) && ALLOC(s->object, s->count) &&
        ALLOC(p->normal, p->count) && ALLOC(p->offset, p->count) && ALLOC(p->object, p->count) &&
        ALLOC(q->corner, q->count) && ALLOC(q->normal, q->count) && ALLOC(q->dual_u, q->count) &&
        ALLOC(q->dual_v, q->count) && ALLOC(q->is_disk, q->count) && ALLOC(q->object, q->count) &&
        ALLOC(r->profile, r->count) && ALLOC(r->bounds, r->count) && ALLOC(r->object, r->count);
    if (!ok)
        return fl_out_of_memory(c->diags, "the scene's shapes");
    return float_arrays(c, s->count, (float **const[]){&s->cx, &s->cy, &s->cz, &s->r}, 4) &&
           float_arrays(c, p->count, (float **const[]){&p->nx, &p->ny, &p->nz, &p->d}, 4) &&
           float_arrays(c, q->count,
                        (float **const[]){&q->cx, &q->cy, &q->cz, &q->nx, &q->ny, &q->nz, &q->ax,
                                          &q->ay, &q->az, &q->bx, &q->by, &q->bz},
                        12);
}

static bool is_baked(const fl_compiler *c, const fl_object *object)
{
    fl_affine m = fl_compile_transform(c, object);
    return fl_affine_is_identity(&m);
}

static void split3(fl_vec3 v, float *x, float *y, float *z)
{
    *x = (float)v.x;
    *y = (float)v.y;
    *z = (float)v.z;
}

static fl_box box_around(fl_vec3 center, fl_vec3 reach)
{
    return (fl_box){fl_v3_sub(center, reach), fl_v3_add(center, reach)};
}

/* Transformed ones get their own centre as origin. */
static bool add_sphere(fl_compiler *c, const fl_object *object, uint32_t at, uint32_t k, bool baked)
{
    fl_spheres *s = &c->geometry->spheres;
    fl_vec3 center = object->as.sphere.center;
    double r = object->as.sphere.radius;
    s->center[k] = baked ? fl_v3_sub(center, c->geometry->origin) : fl_v3(0, 0, 0);
    s->radius[k] = r;
    s->object[k] = at;
    split3(s->center[k], &s->cx[k], &s->cy[k], &s->cz[k]);
    s->r[k] = (float)r;
    if (!(s->r[k] * s->r[k] > 0.0f))
        return fl_error(c->diags, object->loc,
                        "the radius %g is too small for the renderer's floats", r);
    return baked || fl_compile_instance(c, object, at, FL_OBJECT_SPHERE, k, center,
                                        box_around(fl_v3(0, 0, 0), fl_v3(r, r, r)), 0.0);
}

static bool add_plane(fl_compiler *c, const fl_object *object, uint32_t at, uint32_t k, bool baked)
{
    fl_planes *p = &c->geometry->planes;
    fl_vec3 n = object->as.plane.normal;
    double length = fl_v3_length(n);
    p->normal[k] = fl_v3_normalize(n);
    p->offset[k] = object->as.plane.offset / length;
    if (baked)
        p->offset[k] -= fl_v3_dot(p->normal[k], c->geometry->origin);
    if (!(length > 0.0) || !(fabs(p->offset[k]) <= FL_COORDINATE_MAX))
        return fl_error(c->diags, object->loc,
                        "the plane's normal is 0, or it lies beyond " FL_TEXT_OF(
                            FL_COORDINATE_MAX) " from the middle of the scene");
    p->object[k] = at;
    split3(p->normal[k], &p->nx[k], &p->ny[k], &p->nz[k]);
    p->d[k] = (float)p->offset[k];
    return baked || fl_compile_instance(c, object, at, FL_OBJECT_PLANE, k, fl_v3(0, 0, 0),
                                        fl_box_empty(), 0.0);
}

/* Two directions of a disk, as a plane's texture axes. */
static void disk_axes(fl_vec3 n, double radius, fl_vec3 *out_u, fl_vec3 *out_v)
{
    fl_vec3 x = fl_v3_cross(fl_v3(0, 1, 0), n);
    bool is_along_y = fl_v3_max_abs(x) < 1e-6;
    x = is_along_y ? fl_v3(1, 0, 0) : fl_v3_normalize(x);
    x = fl_v3_normalize(fl_v3_mad(x, n, -fl_v3_dot(x, n)));
    *out_u = fl_v3_scale(x, radius);
    *out_v = fl_v3_scale(fl_v3_normalize(fl_v3_cross(n, x)), radius);
}

/* Transformed ones get their own corner as origin. */
static bool add_patch(fl_compiler *c, const fl_object *object, uint32_t at, uint32_t k, bool baked)
{
    fl_patches *q = &c->geometry->patches;
    bool is_disk = object->kind == FL_OBJECT_DISK;
    fl_vec3 corner = is_disk ? object->as.disk.center : object->as.square.corner;
    fl_vec3 u = object->as.square.u, v = object->as.square.v;
    if (is_disk)
        disk_axes(fl_v3_normalize(object->as.disk.normal), object->as.disk.radius, &u, &v);
    fl_vec3 n = fl_v3_normalize(fl_v3_cross(fl_v3_normalize(u), fl_v3_normalize(v)));
    fl_vec3 across_u = fl_v3_cross(v, n), across_v = fl_v3_cross(n, u);
    double du = fl_v3_dot(u, across_u), dv = fl_v3_dot(v, across_v);
    q->dual_u[k] = fl_v3_scale(across_u, 1.0 / du);
    q->dual_v[k] = fl_v3_scale(across_v, 1.0 / dv);
    bool is_flat = !(fl_v3_length(fl_v3_cross(fl_v3_normalize(u), fl_v3_normalize(v))) > 1e-6);
    if (is_flat || !(fl_v3_max_abs(q->dual_u[k]) <= FL_COORDINATE_MAX) ||
        !(fl_v3_max_abs(q->dual_v[k]) <= FL_COORDINATE_MAX))
        return fl_error(c->diags, object->loc,
                        "the sides are parallel or too short: there is no area");
    q->corner[k] = baked ? fl_v3_sub(corner, c->geometry->origin) : fl_v3(0, 0, 0);
    q->normal[k] = n;
    q->is_disk[k] = is_disk;
    q->object[k] = at;
    split3(q->corner[k], &q->cx[k], &q->cy[k], &q->cz[k]);
    split3(n, &q->nx[k], &q->ny[k], &q->nz[k]);
    split3(q->dual_u[k], &q->ax[k], &q->ay[k], &q->az[k]);
    split3(q->dual_v[k], &q->bx[k], &q->by[k], &q->bz[k]);
    fl_vec3 reach = fl_v3(fabs(u.x) + fabs(v.x), fabs(u.y) + fabs(v.y), fabs(u.z) + fabs(v.z));
    return baked || fl_compile_instance(c, object, at, object->kind, k, corner,
                                        box_around(fl_v3(0, 0, 0), reach), fl_v3_max_abs(reach));
}

/* `built` holds one surface a profile, made when first needed. */
static bool add_revolution(fl_compiler *c, const fl_object *object, uint32_t at, uint32_t k,
                           bool baked, fl_revolve **built)
{
    fl_revolutions *r = &c->geometry->revolutions;
    uint32_t profile = object->as.revolution.profile;
    if (!built[profile]) {
        built[profile] = fl_revolve_build(&c->out->arena, &c->scene->profiles[profile], c->diags);
        if (!built[profile])
            return false;
        fl_revolve_set_isa(built[profile], c->out->isa);
        c->out->revolution_piece_count += fl_revolve_piece_count(built[profile]);
    }
    fl_box box = fl_revolve_bounds(built[profile]);
    double size = fl_max(fl_v3_max_abs(box.lo), fl_v3_max_abs(box.hi));
    r->profile[k] = built[profile];
    r->object[k] = at;
    r->shift = c->geometry->origin;
    if (baked)
        box = (fl_box){fl_v3_sub(box.lo, r->shift), fl_v3_sub(box.hi, r->shift)};
    if (!fl_compile_check_box(c, box, object->loc))
        return false;
    r->bounds[k] = fl_compile_padded(box);
    return baked ||
           fl_compile_instance(c, object, at, FL_OBJECT_REVOLUTION, k, fl_v3(0, 0, 0), box, size);
}

static bool add_shape(fl_compiler *c, uint32_t at, bool baked, fl_revolve **built)
{
    fl_geometry *g = c->geometry;
    const fl_object *object = &c->scene->objects[at];
    uint32_t *count = NULL, *baked_count = NULL;
    switch (object->kind) {
    case FL_OBJECT_SPHERE:
        count = &g->spheres.count;
        baked_count = &g->spheres.baked_count;
        c->out->needs |= FL_NEED_SPHERES;
        break;
    case FL_OBJECT_PLANE:
        count = &g->planes.count;
        baked_count = &g->planes.baked_count;
        c->out->needs |= FL_NEED_PLANES;
        break;
    case FL_OBJECT_SQUARE:
    case FL_OBJECT_DISK:
        count = &g->patches.count;
        baked_count = &g->patches.baked_count;
        c->out->needs |= FL_NEED_PATCHES;
        break;
    case FL_OBJECT_REVOLUTION:
        count = &g->revolutions.count;
        baked_count = &g->revolutions.baked_count;
        c->out->needs |= FL_NEED_REVOLUTIONS;
        break;
    case FL_OBJECT_TRIANGLE:
    case FL_OBJECT_MESH:
    case FL_OBJECT_KIND_COUNT:
    default:
        return true;
    }
    uint32_t k = (*count)++;
    *baked_count += baked;
    g->object_entry[at] = k;
    switch (object->kind) {
    case FL_OBJECT_SPHERE:
        return add_sphere(c, object, at, k, baked);
    case FL_OBJECT_PLANE:
        return add_plane(c, object, at, k, baked);
    case FL_OBJECT_REVOLUTION:
        return add_revolution(c, object, at, k, baked, built);
    case FL_OBJECT_SQUARE:
    case FL_OBJECT_DISK:
    case FL_OBJECT_TRIANGLE:
    case FL_OBJECT_MESH:
    case FL_OBJECT_KIND_COUNT:
    default:
        return add_patch(c, object, at, k, baked);
    }
}

bool fl_compile_shapes(fl_compiler *c)
{
    fl_geometry *g = c->geometry;
    uint32_t counts[FL_OBJECT_KIND_COUNT] = {0};
    for (uint32_t i = 0; i < c->scene->object_count; i++)
        counts[c->scene->objects[i].kind]++;
    fl_revolve **built =
        fl_arena_alloc(&c->out->arena, c->scene->profile_count, sizeof(fl_revolve *));
    if (!built)
        return fl_out_of_memory(c->diags, "the scene's shapes");
    if (!allocate(c, counts))
        return false;
    g->spheres.count = g->planes.count = g->patches.count = g->revolutions.count = 0;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < c->scene->object_count; i++) {
            bool baked = is_baked(c, &c->scene->objects[i]);
            if (baked == (pass == 0) && !add_shape(c, i, baked, built))
                return false;
        }
    return true;
}
