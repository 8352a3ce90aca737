/* SPDX-License-Identifier: MIT
 *
 * Nearest-hit and any-hit kernels. Compiled once an instruction set, with FL_W and FL_ISA defined
 * (wide.h).
 */
#include "core/kernel_isect_octree.h"
#include "core/kernel_isect_shaft.h"
#include "core/kernel_isect_shapes.h"
#include "core/kernel_isect_stream.h"
#include "core/kernel_resolve.h"

/* --- Objects with a transform, and meshes ---------------------------------------------------- */

static inline void leaf_nearest(packet *p, uint64_t lanes, const void *context, uint32_t child)
{
    packet_meet_pack(p, lanes, context, child, false);
}

static inline void leaf_any(packet *p, uint64_t lanes, const void *context, uint32_t child)
{
    packet_meet_pack(p, lanes, context, child, true);
}

static void walk_mesh_nearest(packet *p, const mesh_target *target)
{
    target->counts->node_visits +=
        packet_walk(p, target->mesh->bvh, target->mesh->packs, leaf_nearest, target, false);
}

static void walk_mesh_any(packet *p, const mesh_target *target)
{
    target->counts->node_visits +=
        packet_walk(p, target->mesh->bvh, target->mesh->packs, leaf_any, target, true);
}

static void walk_octree(packet *p, const mesh_target *target, const bool is_any)
{
    if (is_any)
        packet_walk_octree(p, target, true);
    else
        packet_walk_octree(p, target, false);
}

static void packet_begin(packet *p, const chunk *c)
{
    p->blocked = p->lanes = p->z_is_1 = p->z_is_2 = p->down[0] = p->down[1] = p->down[2] = 0;
    p->has_source = false;
    p->t = c->t;
    p->object = c->object;
    p->prim = c->prim;
    p->source_object = c->source_object;
    p->source_prim = c->source_prim;
}

/* Rays `lanes` of the chunk against a mesh in its own space. */
FL_INLINE void meet_mesh_instance(const job *j, chunk *c, uint64_t lanes,
                                  const fl_instance *instance, const bool is_any)
{
    _Alignas(64) float local[6][CHUNK_RAYS];
    packet p;
    packet_begin(&p, c);
    for (int a = 0; a < 3; a++) {
        p.o[a] = instance->is_identity ? c->o[a] : local[a];
        p.d[a] = instance->is_identity ? c->d[a] : local[3 + a];
    }
    for (uint64_t left = lanes; left;) {
        uint32_t i = (uint32_t)__builtin_ctzll(left) / FL_W * FL_W;
        fl_wm alive = chunk_alive(c, i) & group_of_bits(group_bits(left, i));
        left &= ~((uint64_t)FL_W_ALL << i);
        if (!fl_wm_any(alive))
            continue;
        bundle b = bundle_load(c, i);
        if (!instance->is_identity) {
            b = bundle_transform(instance->to_object, &b);
            for (int a = 0; a < 3; a++) {
                fl_wf_store(&local[a][i], b.o[a]);
                fl_wf_store(&local[3 + a][i], b.d[a]);
            }
        }
        fl_wf near;
        slabs s = slabs_of(&b, FL_ORIGIN_PAD);
        fl_wm meets =
            slabs_meet(&s, instance->box.lo, instance->box.hi, fl_wf_load(c->t + i), &near);
        if (fl_wm_any(meets & alive))
            packet_put(&p, i, &b, &s, meets & alive);
    }
    if (!p.lanes)
        return;
    mesh_target target = {&j->geometry->meshes[instance->index], instance->object,
                          &j->context->counts};
    if (target.mesh->octree)
        walk_octree(&p, &target, is_any);
    else if (!target.mesh->bvh || __builtin_popcountll(p.lanes) < PACKET_RAYS_MIN)
        packet_walk_alone(&p, &target, is_any);
    else if (is_any)
        walk_mesh_any(&p, &target);
    else
        walk_mesh_nearest(&p, &target);
}

FL_INLINE uint32_t lane_count(fl_wm m)
{
    return (uint32_t)__builtin_popcount(fl_wm_bits(m));
}

static inline void meet_shape_instance(const job *j, chunk *c, uint32_t i,
                                       const fl_instance *instance, const bool is_any)
{
    static const fl_vec3 no_shift = {0.0, 0.0, 0.0};
    const fl_geometry *g = j->geometry;
    fl_wm alive = chunk_alive(c, i), own = chunk_starts_on(c, i, instance->object);
    if (!fl_wm_any(alive))
        return;
    const bundle world = bundle_load(c, i);
    bundle b = bundle_transform(instance->to_object, &world);
    if (instance->kind == FL_OBJECT_REVOLUTION) {
        meet_revolution(j, c, i, &b, instance->index, instance->object, &no_shift, is_any);
        return;
    }
    fl_wf t;
    j->context->counts.primitive_tests += lane_count(alive);
    if (instance->kind == FL_OBJECT_PLANE)
        t = hit_plane(&g->planes, instance->index, &b, own);
    else if (instance->kind == FL_OBJECT_SPHERE)
        t = hit_sphere(&g->spheres, instance->index, &b, &world, &instance->to_object_exact, own);
    else
        t = hit_patch(&g->patches, instance->index, &b, own, fl_wf_load(c->t + i));
    chunk_accept(c, i, t, instance->object, is_any);
}

FL_INLINE void meet_instance(const job *j, chunk *c, uint64_t lanes, const fl_instance *instance,
                             const bool is_any)
{
    if (instance->kind == FL_OBJECT_MESH) {
        meet_mesh_instance(j, c, lanes, instance, is_any);
        return;
    }
    for (uint64_t left = lanes; left;) {
        uint32_t i = (uint32_t)__builtin_ctzll(left) / FL_W * FL_W;
        left &= ~((uint64_t)FL_W_ALL << i);
        meet_shape_instance(j, c, i, instance, is_any);
    }
}

/* --- Objects in world space ------------------------------------------------------------------ */

FL_INLINE void meet_baked(const job *j, chunk *c, uint32_t i, const bundle *b, fl_object_kind kind,
                          uint32_t k, const bool is_any)
{
    const fl_geometry *g = j->geometry;
    uint32_t object;
    fl_wf t;
    if (kind == FL_OBJECT_SPHERE) {
        object = g->spheres.object[k];
        t = hit_sphere(&g->spheres, k, b, b, NULL, chunk_starts_on(c, i, object));
    } else if (kind == FL_OBJECT_PLANE) {
        object = g->planes.object[k];
        t = hit_plane(&g->planes, k, b, chunk_starts_on(c, i, object));
    } else if (kind == FL_OBJECT_SQUARE) {
        object = g->patches.object[k];
        t = hit_patch(&g->patches, k, b, chunk_starts_on(c, i, object), fl_wf_load(c->t + i));
    } else {
        meet_revolution(j, c, i, b, k, g->revolutions.object[k], &g->revolutions.shift, is_any);
        return;
    }
    chunk_accept(c, i, t, object, is_any);
}

/* Baked objects of one kind, one after the other: numbers which[0], which[1] ..., NULL for all. */
FL_INLINE void meet_all_baked(const job *j, chunk *c, uint32_t i, const bundle *b,
                              fl_object_kind kind, const uint32_t *which, uint32_t count,
                              const bool is_any)
{
    fl_isect_counts *counts = &j->context->counts;
    for (uint32_t k = 0; k < count; k++) {
        fl_wm alive = chunk_alive(c, i);
        if (is_any && !fl_wm_any(alive))
            return;
        if (kind != FL_OBJECT_REVOLUTION)
            counts->primitive_tests += lane_count(alive);
        meet_baked(j, c, i, b, kind, which ? which[k] : k, is_any);
    }
}

/* --- The hierarchy of objects ---------------------------------------------------------------- */

/* Whom a leaf of the objects' hierarchy belongs to. */
typedef struct object_walk {
    const job *j;
    chunk *c;
} object_walk;

FL_INLINE void meet_leaf_entries(uint64_t lanes, const object_walk *walk, uint32_t child,
                                 const bool is_any)
{
    const job *j = walk->j;
    chunk *c = walk->c;
    const fl_geometry *g = j->geometry;
    const uint32_t *items = &g->object_bvh->items[(size_t)FL_BVH_LEAF_INDEX(child) * FL_BVH_WIDTH];
    for (uint32_t n = 0; n < FL_BVH_LEAF_COUNT(child); n++) {
        const fl_entry *entry = &g->entries[items[n]];
        if (entry->is_instance) {
            meet_instance(j, c, lanes, &g->instances[entry->index], is_any);
            continue;
        }
        if (entry->kind != FL_OBJECT_REVOLUTION)
            j->context->counts.primitive_tests += (uint32_t)__builtin_popcountll(lanes);
        for (uint64_t left = lanes; left;) {
            uint32_t i = (uint32_t)__builtin_ctzll(left) / FL_W * FL_W;
            left &= ~((uint64_t)FL_W_ALL << i);
            bundle b = bundle_load(c, i);
            meet_baked(j, c, i, &b, entry->kind, entry->index, is_any);
        }
    }
}

static inline void objects_nearest(packet *p, uint64_t lanes, const void *context, uint32_t child)
{
    (void)p;
    meet_leaf_entries(lanes, context, child, false);
}

static inline void objects_any(packet *p, uint64_t lanes, const void *context, uint32_t child)
{
    meet_leaf_entries(lanes, context, child, true);
    p->blocked |= lanes & ~groups_beyond(p, lanes, 0.0f);
}

FL_INLINE void walk_objects(const job *j, chunk *c, const bool is_any)
{
    const fl_bvh *bvh = j->geometry->object_bvh;
    const object_walk walk = {j, c};
    packet p;
    packet_begin(&p, c);
    for (int a = 0; a < 3; a++) {
        p.o[a] = c->o[a];
        p.d[a] = c->d[a];
    }
    for (uint32_t i = 0; i < c->count; i += FL_W) {
        fl_wm alive = chunk_alive(c, i);
        if (!fl_wm_any(alive))
            continue;
        bundle b = bundle_load(c, i);
        slabs s = slabs_of(&b, bvh->origin_pad);
        packet_put(&p, i, &b, &s, alive);
    }
    if (p.lanes)
        j->context->counts.node_visits +=
            packet_walk(&p, bvh, NULL, is_any ? objects_any : objects_nearest, &walk, is_any);
}

/* --- Whole chunks ---------------------------------------------------------------------------- */

FL_INLINE uint64_t chunk_all(const chunk *c)
{
    return c->count == CHUNK_RAYS ? ~(uint64_t)0 : ((uint64_t)1 << c->count) - 1;
}

/* A scene of some objects: those near the chunk. */
FL_INLINE void meet_nearby(const job *j, chunk *c, const bool is_any)
{
    const fl_geometry *g = j->geometry;
    nearby n;
    find_nearby(g, c, &n);
    for (uint32_t i = 0; i < c->count; i += FL_W) {
        bundle b = bundle_load(c, i);
        meet_all_baked(j, c, i, &b, FL_OBJECT_PLANE, NULL, g->planes.baked_count, is_any);
        meet_all_baked(j, c, i, &b, FL_OBJECT_SPHERE, n.index, n.spheres, is_any);
        meet_all_baked(j, c, i, &b, FL_OBJECT_SQUARE, n.index + n.spheres, n.squares - n.spheres,
                       is_any);
        meet_all_baked(j, c, i, &b, FL_OBJECT_REVOLUTION, n.index + n.squares,
                       n.revolutions - n.squares, is_any);
    }
    for (uint32_t k = n.revolutions; k < n.count; k++)
        meet_instance(j, c, chunk_all(c), &g->instances[n.index[k]], is_any);
    for (uint32_t k = g->bounded_entry_count; k < g->entry_count; k++)
        meet_instance(j, c, chunk_all(c), &g->instances[g->entries[k].index], is_any);
}

FL_INLINE void meet_geometry(const job *j, chunk *c, const bool is_any)
{
    const fl_geometry *g = j->geometry;
    if (g->entry_boxes) {
        meet_nearby(j, c, is_any);
        return;
    }
    for (uint32_t i = 0; i < c->count; i += FL_W) {
        if (!fl_wm_any(chunk_alive(c, i)))
            continue;
        bundle b = bundle_load(c, i);
        meet_all_baked(j, c, i, &b, FL_OBJECT_PLANE, NULL, g->planes.baked_count, is_any);
        if (g->object_bvh)
            continue;
        meet_all_baked(j, c, i, &b, FL_OBJECT_SPHERE, NULL, g->spheres.baked_count, is_any);
        meet_all_baked(j, c, i, &b, FL_OBJECT_SQUARE, NULL, g->patches.baked_count, is_any);
        meet_all_baked(j, c, i, &b, FL_OBJECT_REVOLUTION, NULL, g->revolutions.baked_count, is_any);
    }
    if (g->object_bvh)
        walk_objects(j, c, is_any);
    /* With a hierarchy, only what has no bounds is left. */
    for (uint32_t k = g->object_bvh ? g->bounded_entry_count : 0; k < g->entry_count; k++)
        if (g->entries[k].is_instance)
            meet_instance(j, c, chunk_all(c), &g->instances[g->entries[k].index], is_any);
}

FL_INLINE chunk chunk_of(const fl_rays *rays, uint32_t first, float *t, uint32_t *object,
                         uint32_t *prim)
{
    uint32_t left = fl_min_u32(rays->count - first, CHUNK_RAYS);
    chunk c = {.o = {rays->ox + first, rays->oy + first, rays->oz + first},
               .d = {rays->dx + first, rays->dy + first, rays->dz + first},
               .t = t,
               .object = object,
               .prim = prim,
               .source_object = rays->source_object + first,
               .source_prim = rays->source_prim + first,
               .count = (left + FL_W - 1) / FL_W * FL_W};
    for (uint32_t i = 0; i < c.count; i += FL_W) {
        fl_wf_store(t + i, fl_wf_load(rays->t_max + first + i));
        /* Least of all names, so that nothing at t_max itself is nearer. */
        fl_wu_store(object + i, fl_wu_set(0));
        fl_wu_store(prim + i, fl_wu_set(0));
    }
    return c;
}

static void trace_nearest(const fl_geometry *geometry, const fl_rays *rays, fl_hits *out_hits,
                          fl_isect_context *context)
{
    job j = {geometry, context};
    for (uint32_t first = 0; first < rays->count; first += CHUNK_RAYS) {
        if (fl_is_cancelled(context))
            return;
        chunk c = chunk_of(rays, first, out_hits->t + first, out_hits->object + first,
                           out_hits->prim + first);
        if (out_hits->root)
            c.root = out_hits->root + first;
        meet_geometry(&j, &c, false);
        for (uint32_t i = 0; i < c.count; i += FL_W) {
            fl_wf t = fl_wf_load(c.t + i);
            fl_wm hit = t < fl_wf_load(rays->t_max + first + i);
            fl_wf_store(c.t + i, fl_wf_select(hit, t, fl_wf_set(INFINITY)));
            fl_wu none = fl_wu_set(FL_NONE);
            fl_wu_store(c.object + i, fl_wu_select(hit, fl_wu_load(c.object + i), none));
            fl_wu_store(c.prim + i, fl_wu_select(hit, fl_wu_load(c.prim + i), none));
        }
    }
}

static void trace_any(const fl_geometry *geometry, const fl_rays *rays, uint32_t *out_blocked,
                      fl_isect_context *context)
{
    job j = {geometry, context};
    _Alignas(64) float t[CHUNK_RAYS];
    _Alignas(64) uint32_t object[CHUNK_RAYS], prim[CHUNK_RAYS];
    for (uint32_t first = 0; first < rays->count; first += CHUNK_RAYS) {
        if (fl_is_cancelled(context))
            return;
        chunk c = chunk_of(rays, first, t, object, prim);
        meet_geometry(&j, &c, true);
        for (uint32_t i = 0; i < c.count; i += FL_W) {
            fl_wm blocked = fl_wf_load(t + i) < fl_wf_load(rays->t_max + first + i);
            fl_wu_store(out_blocked + first + i, (fl_wu)blocked & 1u);
        }
    }
}

const fl_isect_kernels FL_ISA_NAME(fl_isect_kernels) = {trace_nearest, trace_any,
                                                        FL_ISA_NAME(fl_resolve)};
