/* SPDX-License-Identifier: MIT */
#include "core/double_trace.h"

#include <math.h>

#include "core/octree.h"

/** One ray on its search. */
typedef struct search {
    const fl_geometry *geometry;
    fl_isect_context *context;
    fl_double_hit best; /* best.t begins as t_max; object FL_NONE: nothing yet. */
    bool is_any, is_over;
} search;

fl_double_ray fl_double_ray_to(const fl_instance *instance, const fl_double_ray *ray)
{
    fl_double_ray r = *ray;
    if (instance && !instance->is_identity) {
        r.o = fl_affine_point(&instance->to_object_exact, ray->o);
        r.d = fl_affine_direction(&instance->to_object_exact, ray->d);
    }
    return r;
}

/* Is (t, object, prim) nearer than the best? NaN is not. */
static bool is_nearer(const search *s, double t, uint32_t object, uint32_t prim)
{
    const fl_double_hit *b = &s->best;
    if (!(t > 0.0) || !(t <= b->t))
        return false;
    return t < b->t || (b->object != FL_NONE &&
                        (object < b->object || (object == b->object && prim < b->prim)));
}

static fl_double_hit *take(search *s, double t, uint32_t object, uint32_t prim)
{
    s->is_over = s->is_any;
    s->best.t = t;
    s->best.object = object;
    s->best.prim = prim;
    return &s->best;
}

/* --- Shapes: kernel_isect_shapes.h, in double ------------------------------------------------- */

static double hit_sphere(const fl_spheres *spheres, uint32_t k, const fl_double_ray *r, bool is_own)
{
    double radius = spheres->radius[k];
    fl_vec3 f = fl_v3_sub(r->o, spheres->center[k]);
    double dd = fl_v3_dot(r->d, r->d), fd = -fl_v3_dot(f, r->d), middle = fd / dd;
    if (is_own) /* The exact chord. */
        return middle + middle;
    fl_vec3 l = fl_v3_mad(f, r->d, middle);
    double rest = radius * radius - fl_v3_dot(l, l);
    if (!(rest >= 0.0))
        return -1.0;
    /* (|f| - r)(|f| + r) keeps the digits that |f|^2 - r^2 loses near a huge sphere. */
    double distance = fl_v3_length(f), q = fd + copysign(sqrt(dd * rest), fd);
    double t0 = (distance - radius) * (distance + radius) / q, t1 = q / dd;
    double first = fl_min(t0, t1);
    return first > 0.0 ? first : fl_max(t0, t1);
}

static double hit_plane(const fl_planes *planes, uint32_t k, const fl_double_ray *r, bool is_own)
{
    fl_vec3 n = planes->normal[k];
    return is_own ? -1.0 : (planes->offset[k] - fl_v3_dot(n, r->o)) / fl_v3_dot(n, r->d);
}

static double hit_patch(const fl_patches *patches, uint32_t k, const fl_double_ray *r, bool is_own)
{
    fl_vec3 n = patches->normal[k], f = fl_v3_sub(r->o, patches->corner[k]);
    double t = -fl_v3_dot(n, f) / fl_v3_dot(n, r->d);
    if (is_own || !(t > 0.0))
        return -1.0;
    f = fl_v3_mad(f, r->d, t);
    double a = fl_v3_dot(patches->dual_u[k], f), b = fl_v3_dot(patches->dual_v[k], f);
    bool is_inside =
        patches->is_disk[k] ? a * a + b * b <= 1.0 : a >= 0.0 && a <= 1.0 && b >= 0.0 && b <= 1.0;
    return is_inside ? t : -1.0;
}

/* A concave surface may be met again by its own rays: the offset alone tells (decision 13). */
static void meet_revolution(search *s, uint32_t k, const fl_double_ray *r, fl_vec3 shift)
{
    const fl_revolutions *all = &s->geometry->revolutions;
    fl_vec3 from = fl_v3_add(r->o, shift);
    const double o[3] = {from.x, from.y, from.z}, d[3] = {r->d.x, r->d.y, r->d.z};
    fl_revolve_hit hit;
    s->context->counts.primitive_tests++;
    /* A root at the best t itself may still have the lower name. */
    double end = isfinite(s->best.t) ? s->best.t * (1.0 + 0x1p-52) : HUGE_VAL;
    if (fl_revolve_nearest(all->profile[k], o, d, 0.0, end, s->context->solver, &hit) &&
        is_nearer(s, hit.u, all->object[k], 0))
        take(s, hit.u, all->object[k], 0)->at.revolve = hit;
}

static void meet_shape(search *s, fl_object_kind kind, uint32_t k, const fl_double_ray *r,
                       fl_vec3 shift)
{
    const fl_geometry *g = s->geometry;
    if (kind == FL_OBJECT_REVOLUTION) {
        meet_revolution(s, k, r, shift);
        return;
    }
    bool is_sphere = kind == FL_OBJECT_SPHERE, is_plane = kind == FL_OBJECT_PLANE;
    uint32_t object = is_sphere  ? g->spheres.object[k]
                      : is_plane ? g->planes.object[k]
                                 : g->patches.object[k];
    bool is_own = r->source_object == object;
    double t = is_sphere  ? hit_sphere(&g->spheres, k, r, is_own)
               : is_plane ? hit_plane(&g->planes, k, r, is_own)
                          : hit_patch(&g->patches, k, r, is_own);
    s->context->counts.primitive_tests++;
    if (is_nearer(s, t, object, 0))
        take(s, t, object, 0);
}

/* --- Boxes -------------------------------------------------------------------------------------
 */

typedef struct slabs {
    double o[3], inverse[3], pad;
} slabs;

static slabs slabs_of(const fl_double_ray *r, double pad)
{
    slabs s = {{r->o.x, r->o.y, r->o.z}, {1.0 / r->d.x, 1.0 / r->d.y, 1.0 / r->d.z}, pad};
    const double d[3] = {r->d.x, r->d.y, r->d.z};
    for (int a = 0; a < 3; a++)
        if (!(fabs(s.inverse[a]) < 1e300)) /* 0 * inf would be NaN */
            s.inverse[a] = copysign(1e300, d[a]);
    return s;
}

/* May the ray meet the box at 0 < t <= best? */
static bool slabs_meet(const slabs *s, const float lo[3], const float hi[3], double best,
                       double *out_near)
{
    double near = 0.0, far = best;
    for (int a = 0; a < 3; a++) {
        double l = ((double)lo[a] - s->pad - s->o[a]) * s->inverse[a];
        double h = ((double)hi[a] + s->pad - s->o[a]) * s->inverse[a];
        near = fl_max(l < h ? l : h, near);
        far = fl_min(l < h ? h : l, far);
    }
    *out_near = near;
    return near <= far;
}

/* --- Triangles ---------------------------------------------------------------------------------
 */

typedef struct needle {
    const fl_double_ray *ray;
    double o[3], shear_x, shear_y, inverse_z;
    int kx, ky, kz; /* kz: the axis in which d is largest. */
} needle;

static needle needle_of(const fl_double_ray *r)
{
    const double d[3] = {r->d.x, r->d.y, r->d.z};
    double size = fl_v3_max_abs(r->d);
    needle n = {.ray = r, .o = {r->o.x, r->o.y, r->o.z}};
    n.kz = fabs(d[0]) == size ? 0 : fabs(d[1]) == size ? 1 : 2;
    n.kx = n.kz == 2 ? 0 : n.kz + 1;
    n.ky = n.kx == 2 ? 0 : n.kx + 1;
    n.inverse_z = 1.0 / d[n.kz];
    n.shear_x = d[n.kx] * n.inverse_z;
    n.shear_y = d[n.ky] * n.inverse_z;
    return n;
}

/* Watertight as in kernel_isect_mesh.h: an edge has one value, up to its sign, in both triangles
 * that share it, and 0 counts as inside. */
static void meet_face(search *s, const needle *n, const fl_tri_mesh *mesh, uint32_t mesh_object,
                      uint32_t face)
{
    double x[3], y[3], z[3];
    for (uint32_t k = 0; k < 3; k++) {
        const float *p = mesh->position + 3 * (size_t)mesh->index[3 * (size_t)face + k];
        z[k] = (double)p[n->kz] - n->o[n->kz];
        x[k] = (double)p[n->kx] - n->o[n->kx] - n->shear_x * z[k];
        y[k] = (double)p[n->ky] - n->o[n->ky] - n->shear_y * z[k];
    }
    double u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2],
           w = x[1] * y[0] - y[1] * x[0], area = u + v + w;
    s->context->counts.primitive_tests++;
    if (((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) || area == 0.0)
        return;
    double t = (u / area * z[0] + v / area * z[1] + w / area * z[2]) * n->inverse_z;
    uint32_t object = mesh->face_object ? mesh->face_object[face] : mesh_object;
    uint32_t prim = mesh->face_object ? 0 : face;
    if ((object == n->ray->source_object && prim == n->ray->source_prim) ||
        !is_nearer(s, t, object, prim))
        return;
    fl_double_hit *hit = take(s, t, object, prim);
    hit->at.weight[0] = u / area;
    hit->at.weight[1] = v / area;
    hit->at.weight[2] = w / area;
}

static void meet_octree(search *s, const needle *n, const fl_tri_mesh *mesh, uint32_t object)
{
    const fl_octree *tree = mesh->octree;
    uint32_t stack[FL_OCTREE_STACK_MAX + 1], height = 1;
    slabs slab = slabs_of(n->ray, (double)FL_ORIGIN_PAD * fl_v3_max_abs(n->ray->o));
    stack[0] = tree->root;
    while (height > 0 && !s->is_over) {
        uint32_t child = stack[--height];
        if (child == FL_NONE)
            continue;
        if (child & FL_BVH_LEAF) {
            const fl_octree_leaf *leaf = &tree->leaves[child & ~FL_BVH_LEAF];
            for (uint32_t i = 0; i < leaf->count && !s->is_over; i++)
                meet_face(s, n, mesh, object, tree->items[leaf->first + i]);
            continue;
        }
        const fl_octree_node *node = &tree->nodes[child];
        s->context->counts.node_visits++;
        for (uint32_t k = 0; k < 8; k++) {
            float lo[3], hi[3];
            double near;
            for (uint32_t a = 0; a < 3; a++) {
                lo[a] = node->plane[a][k >> a & 1u];
                hi[a] = node->plane[a][2 + (k >> a & 1u)];
            }
            if (node->child[k] != FL_NONE && slabs_meet(&slab, lo, hi, s->best.t, &near))
                stack[height++] = node->child[k];
        }
    }
}

static void meet_instance(search *s, const fl_instance *instance, const fl_double_ray *ray);

/* --- Hierarchies -------------------------------------------------------------------------------
 */

/** What the leaves of a hierarchy hold: faces of a mesh, or entries of the scene. */
typedef struct leaves {
    const needle *n; /* NULL: entries. */
    const fl_tri_mesh *mesh;
    uint32_t object;
    const fl_double_ray *ray;
} leaves;

static void meet_leaf(search *s, const fl_bvh *bvh, uint32_t child, const leaves *l)
{
    uint32_t leaf = FL_BVH_LEAF_INDEX(child);
    for (uint32_t i = 0; i < FL_BVH_LEAF_COUNT(child) && !s->is_over; i++) {
        if (l->n) { /* A mesh keeps its faces in packs alone. */
            meet_face(s, l->n, l->mesh, l->object, l->mesh->packs[leaf].face[i]);
            continue;
        }
        const fl_entry *entry = &s->geometry->entries[bvh->items[(size_t)leaf * FL_BVH_WIDTH + i]];
        if (entry->is_instance)
            meet_instance(s, &s->geometry->instances[entry->index], l->ray);
        else
            meet_shape(s, entry->kind, entry->index, l->ray, s->geometry->revolutions.shift);
    }
}

typedef struct visit {
    double near;
    uint32_t child;
} visit;

/* Children that the ray may meet onto the stack, the nearest on top. */
static uint32_t push_children(const fl_bvh_node *node, const slabs *slab, double best, visit *stack,
                              uint32_t height)
{
    uint32_t first = height;
    for (uint32_t k = 0; k < FL_BVH_WIDTH && node->child[k] != FL_NONE; k++) {
        const float lo[3] = {node->plane[0][k], node->plane[2][k], node->plane[4][k]};
        const float hi[3] = {node->plane[1][k], node->plane[3][k], node->plane[5][k]};
        double near;
        if (!slabs_meet(slab, lo, hi, best, &near))
            continue;
        uint32_t at = height++;
        for (; at > first && stack[at - 1].near < near; at--)
            stack[at] = stack[at - 1];
        stack[at] = (visit){near, node->child[k]};
    }
    return height;
}

static void walk(search *s, const fl_bvh *bvh, const leaves *l)
{
    visit stack[FL_BVH_STACK_MAX];
    uint32_t height = 1;
    slabs slab = slabs_of(l->ray, (double)bvh->origin_pad * fl_v3_max_abs(l->ray->o));
    stack[0] = (visit){0.0, 0};
    while (height > 0 && !s->is_over) {
        visit top = stack[--height];
        if (top.near > s->best.t)
            continue;
        if (top.child & FL_BVH_LEAF) {
            meet_leaf(s, bvh, top.child, l);
            continue;
        }
        s->context->counts.node_visits++;
        height = push_children(&bvh->nodes[top.child], &slab, s->best.t, stack, height);
    }
}

static void meet_mesh(search *s, const fl_tri_mesh *mesh, uint32_t object, const fl_double_ray *ray)
{
    needle n = needle_of(ray);
    if (mesh->bvh)
        walk(s, mesh->bvh, &(leaves){&n, mesh, object, ray});
    else if (mesh->octree)
        meet_octree(s, &n, mesh, object);
    else
        for (uint32_t face = 0; face < mesh->face_count && !s->is_over; face++)
            meet_face(s, &n, mesh, object, face);
}

static void meet_instance(search *s, const fl_instance *instance, const fl_double_ray *ray)
{
    fl_double_ray local = fl_double_ray_to(instance, ray);
    if (instance->kind == FL_OBJECT_MESH)
        meet_mesh(s, &s->geometry->meshes[instance->index], instance->object, &local);
    else
        meet_shape(s, instance->kind, instance->index, &local, fl_v3(0, 0, 0));
}

static void meet_all(search *s, fl_object_kind kind, uint32_t count, const fl_double_ray *ray)
{
    for (uint32_t k = 0; k < count && !s->is_over; k++)
        meet_shape(s, kind, k, ray, s->geometry->revolutions.shift);
}

static void meet_geometry(search *s, const fl_double_ray *ray)
{
    const fl_geometry *g = s->geometry;
    meet_all(s, FL_OBJECT_PLANE, g->planes.baked_count, ray);
    if (g->object_bvh) {
        walk(s, g->object_bvh, &(leaves){.ray = ray});
    } else {
        meet_all(s, FL_OBJECT_SPHERE, g->spheres.baked_count, ray);
        meet_all(s, FL_OBJECT_SQUARE, g->patches.baked_count, ray);
        meet_all(s, FL_OBJECT_REVOLUTION, g->revolutions.baked_count, ray);
    }
    /* With a hierarchy, only what has no bounds is left. */
    for (uint32_t k = g->object_bvh ? g->bounded_entry_count : 0; k < g->entry_count && !s->is_over;
         k++)
        if (g->entries[k].is_instance)
            meet_instance(s, &g->instances[g->entries[k].index], ray);
}

static bool find(const fl_geometry *geometry, const fl_double_ray *ray, fl_isect_context *context,
                 bool is_any, fl_double_hit *out_hit)
{
    search s = {.geometry = geometry, .context = context, .is_any = is_any};
    s.best = (fl_double_hit){.t = ray->t_max, .object = FL_NONE, .prim = FL_NONE};
    meet_geometry(&s, ray);
    *out_hit = s.best;
    return s.best.object != FL_NONE;
}

bool fl_double_nearest(const fl_geometry *geometry, const fl_double_ray *ray,
                       fl_isect_context *context, fl_double_hit *out_hit)
{
    return find(geometry, ray, context, false, out_hit);
}

bool fl_double_any(const fl_geometry *geometry, const fl_double_ray *ray, fl_isect_context *context)
{
    fl_double_hit hit;
    return find(geometry, ray, context, true, &hit);
}
