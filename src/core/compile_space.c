/* SPDX-License-Identifier: MIT
 *
 * Spaces: transforms, bounds, the origin, instances.
 */
#include "core/compile_build.h"

/* An object that is narrower than this many steps of the floats where it lies is shown roughly. Of
 * 1,728 pixels of a scene whose smallest object has ten thousand steps 36 are off by a 256th, of
 * one with a thousand 398, with a hundred 738. The smallest object of 969 scenes that people wrote
 * has 207,000 steps. */
#define STEPS_SHOWN_WELL 8192.0
/* Vertices are rounded where they are stored: those of a mesh with fewer steps count from a point
 * of their own, and rays take the way through a transform. */
#define STEPS_STORED_WELL 65536.0

fl_affine fl_compile_transform(const fl_compiler *c, const fl_object *object)
{
    if (object->transform == FL_NONE)
        return fl_affine_identity();
    return c->scene->transforms[object->transform];
}

static fl_box sphere_box(fl_vec3 center, double radius)
{
    fl_vec3 r = fl_v3(radius, radius, radius);
    return (fl_box){fl_v3_sub(center, r), fl_v3_add(center, r)};
}

static fl_box square_box(fl_vec3 corner, fl_vec3 u, fl_vec3 v)
{
    fl_box box = fl_box_grow(fl_box_empty(), corner);
    box = fl_box_grow(box, fl_v3_add(corner, u));
    box = fl_box_grow(box, fl_v3_add(corner, v));
    return fl_box_grow(box, fl_v3_add(fl_v3_add(corner, u), v));
}

static fl_box mesh_box(const fl_mesh *mesh)
{
    fl_box box = fl_box_empty();
    for (uint32_t f = 0; mesh && f < mesh->face_count; f++)
        for (int k = 0; k < 3; k++)
            box = fl_box_grow(box, mesh->positions[mesh->faces[f].position[k]]);
    return box;
}

/* A cylinder about the y axis that holds all control points, hence the surface. */
static fl_box profile_box(const fl_profile *profile)
{
    fl_box box = fl_box_empty();
    uint32_t count = profile->segment_count * (profile->degree + 1);
    for (uint32_t i = 0; i < count; i++) {
        fl_vec3 p = profile->points[i];
        box = fl_box_grow(box, fl_v3(p.x, p.y, p.x));
        box = fl_box_grow(box, fl_v3(-p.x, p.y, -p.x));
    }
    return box;
}

static fl_box object_space_bounds(const fl_compiler *c, const fl_object *object)
{
    switch (object->kind) {
    case FL_OBJECT_SPHERE:
        return sphere_box(object->as.sphere.center, object->as.sphere.radius);
    case FL_OBJECT_SQUARE:
        return square_box(object->as.square.corner, object->as.square.u, object->as.square.v);
    case FL_OBJECT_DISK:
        return sphere_box(object->as.disk.center, object->as.disk.radius);
    case FL_OBJECT_TRIANGLE: {
        const fl_vec3 *v = object->as.triangle.vertex;
        return fl_box_grow(fl_box_grow(fl_box_grow(fl_box_empty(), v[0]), v[1]), v[2]);
    }
    case FL_OBJECT_MESH:
        return mesh_box(c->scene->meshes[object->as.mesh.mesh].mesh);
    case FL_OBJECT_REVOLUTION:
        return profile_box(&c->scene->profiles[object->as.revolution.profile]);
    case FL_OBJECT_PLANE:
    case FL_OBJECT_KIND_COUNT:
    default:
        return fl_box_empty();
    }
}

static fl_box transform_box(const fl_affine *m, fl_box box)
{
    if (fl_box_is_empty(box))
        return box;
    fl_box out = fl_box_empty();
    for (int k = 0; k < 8; k++)
        out = fl_box_grow(
            out, fl_affine_point(m, fl_v3(k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y,
                                          k & 4 ? box.hi.z : box.lo.z)));
    return out;
}

fl_box fl_compile_object_bounds(const fl_compiler *c, const fl_object *object)
{
    fl_affine m = fl_compile_transform(c, object);
    return transform_box(&m, object_space_bounds(c, object));
}

static double box_largest(fl_box box)
{
    return fl_max(fl_v3_max_abs(box.lo), fl_v3_max_abs(box.hi));
}

bool fl_compile_check_box(fl_compiler *c, fl_box box, fl_loc loc)
{
    if (fl_v3_is_finite(box.lo) && fl_v3_is_finite(box.hi) && box_largest(box) <= FL_COORDINATE_MAX)
        return true;
    return fl_error(c->diags, loc,
                    "the object reaches beyond " FL_TEXT_OF(
                        FL_COORDINATE_MAX) ", too far for the renderer's floats");
}

/* Nearest multiple of `step`; halves go towards 0. */
static double nearest_multiple(double x, double step)
{
    return copysign(ceil(fabs(x) / step - 0.5) * step, x) + 0.0;
}

fl_vec3 fl_compile_box_origin(fl_box box)
{
    fl_vec3 size = fl_v3_sub(box.hi, box.lo);
    double extent = fl_v3_max_abs(size);
    if (fl_box_is_empty(box) || !(extent > 0.0))
        return fl_v3(0, 0, 0);
    /* Four extents from 0 costs two bits, and leaves what is anywhere near 0 in place. */
    double step = 0x1p-200;
    while (step < 4.0 * extent)
        step *= 2.0;
    fl_vec3 middle = fl_v3_mad(box.lo, size, 0.5);
    return fl_v3(nearest_multiple(middle.x, step), nearest_multiple(middle.y, step),
                 nearest_multiple(middle.z, step));
}

static double box_size(fl_box box)
{
    return fl_v3_max_abs(fl_v3_sub(box.hi, box.lo));
}

/* How far floats are apart at a coordinate, at most. */
static double float_step(double coordinate)
{
    return 2.0 * FL_EPSILON * coordinate;
}

/* From the geometry's origin to what of the box is farthest from it, along an axis. */
static double reach(const fl_compiler *c, fl_box box)
{
    return box_largest(
        (fl_box){fl_v3_sub(box.lo, c->geometry->origin), fl_v3_sub(box.hi, c->geometry->origin)});
}

/* Objects that lie so far from the middle of the scene that floats cannot place them well: one
 * warning, at the worst of them. Their boxes are asked for again only where the smallest object and
 * the whole scene say that there may be any. */
static void warn_of_floats(fl_compiler *c, double smallest)
{
    double fewest = STEPS_SHOWN_WELL;
    const fl_object *worst = NULL;
    uint32_t count = 0;
    if (c->options->in_double || smallest >= STEPS_SHOWN_WELL * float_step(c->geometry->extent))
        return;
    for (uint32_t i = 0; i < c->scene->object_count; i++) {
        const fl_object *object = &c->scene->objects[i];
        fl_box box = fl_compile_object_bounds(c, object);
        if (fl_box_is_empty(box) || !(box_size(box) > 0.0))
            continue;
        double steps = box_size(box) / float_step(reach(c, box));
        count += steps < STEPS_SHOWN_WELL ? 1 : 0;
        worst = steps < fewest ? object : worst;
        fewest = fl_min(steps, fewest);
    }
    if (worst)
        fl_warning(c->diags, worst->loc,
                   "%u object%s too small for floats so far from the middle of the scene, this one "
                   "%.3g steps of a float wide: --precision double renders it right%s",
                   (unsigned)count, count == 1 ? " is" : "s are", fewest,
                   worst->kind == FL_OBJECT_TRIANGLE ? " as part of a TriangleMesh" : "");
}

fl_vec3 fl_compile_vertex_origin(const fl_compiler *c, fl_box box)
{
    if (box_size(box) >= STEPS_STORED_WELL * float_step(reach(c, box)))
        return c->geometry->origin;
    return fl_compile_box_origin(box);
}

bool fl_compile_origin(fl_compiler *c)
{
    fl_box all = fl_box_empty();
    double smallest = HUGE_VAL;
    for (uint32_t i = 0; i < c->scene->object_count; i++) {
        fl_box box = fl_compile_object_bounds(c, &c->scene->objects[i]);
        if (fl_box_is_empty(box))
            continue;
        if (!fl_compile_check_box(c, box, c->scene->objects[i].loc))
            return false;
        all = fl_box_union(all, box);
        if (box_size(box) > 0.0)
            smallest = fl_min(box_size(box), smallest);
    }
    c->geometry->origin = fl_compile_box_origin(all);
    c->geometry->extent = 1.0;
    if (!fl_box_is_empty(all)) {
        fl_box local = {fl_v3_sub(all.lo, c->geometry->origin),
                        fl_v3_sub(all.hi, c->geometry->origin)};
        double largest = box_largest(local);
        c->geometry->extent = largest > 0.0 ? largest : 1.0;
    }
    warn_of_floats(c, smallest);
    return true;
}

fl_bvh_box fl_compile_padded(fl_box box)
{
    double pad = box_largest(box) * (double)FL_BOX_PAD;
    return (fl_bvh_box){
        {(float)(box.lo.x - pad), (float)(box.lo.y - pad), (float)(box.lo.z - pad)},
        {(float)(box.hi.x + pad), (float)(box.hi.y + pad), (float)(box.hi.z + pad)}};
}

/* Largest sum of the absolute entries of a row of the linear part. */
static double row_norm(const fl_affine *m)
{
    double norm = 0.0;
    for (int i = 0; i < 3; i++)
        norm = fl_max(fabs(m->m[i][0]) + fabs(m->m[i][1]) + fabs(m->m[i][2]), norm);
    return norm;
}

static bool affine_fits(const fl_affine *m)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!(fabs(m->m[i][j]) <= FL_COORDINATE_MAX))
                return false;
    return true;
}

static fl_affine translation(fl_vec3 by)
{
    fl_affine m = fl_affine_identity();
    m.m[0][3] = by.x;
    m.m[1][3] = by.y;
    m.m[2][3] = by.z;
    return m;
}

bool fl_compile_instance(fl_compiler *c, const fl_object *object, uint32_t object_index,
                         fl_object_kind kind, uint32_t index, fl_vec3 local_origin, fl_box box,
                         double size)
{
    fl_geometry *g = c->geometry;
    fl_instance *instance = &g->instances[g->instance_count];
    fl_affine to_world = fl_compile_transform(c, object);
    fl_affine local = translation(local_origin), back = translation(fl_v3_scale(g->origin, -1.0));
    to_world = fl_affine_mul(&to_world, &local);
    to_world = fl_affine_mul(&back, &to_world);
    *instance = (fl_instance){.kind = kind, .index = index, .object = object_index};
    if (!affine_fits(&to_world) || !fl_affine_invert(&to_world, &instance->to_object_exact))
        return fl_error(
            c->diags, object->loc,
            "the object's transform flattens it or reaches beyond " FL_TEXT_OF(FL_COORDINATE_MAX));
    if (!affine_fits(&instance->to_object_exact))
        return fl_error(c->diags, object->loc, "the object's transform shrinks it below 1e-18");
    instance->to_world_exact = to_world;
    instance->is_identity = kind == FL_OBJECT_MESH && fl_affine_is_identity(&to_world);
    for (int i = 0; i < 12; i++)
        instance->to_object[i] = (float)instance->to_object_exact.m[i / 4][i % 4];
    if (!fl_box_is_empty(box)) {
        if (!fl_compile_check_box(c, box, object->loc))
            return false;
        instance->box = fl_compile_padded(box);
    }
    double norm = row_norm(&to_world), shift = 0.0;
    for (int i = 0; i < 3; i++)
        shift = fl_max(fabs(instance->to_object_exact.m[i][3]), shift);
    instance->error_gain =
        instance->is_identity ? 1.0 : fl_max(norm * row_norm(&instance->to_object_exact), 1.0);
    instance->error_base = norm * (size + (instance->is_identity ? 0.0 : shift));
    if (!instance->is_identity)
        c->out->needs |= FL_NEED_TRANSFORMS;
    if (object_index != FL_NONE)
        g->object_instance[object_index] = g->instance_count;
    g->instance_count++;
    return true;
}
