/* SPDX-License-Identifier: MIT
 *
 * Acceleration structures over the faces of a mesh and over the objects of a scene.
 */
#include <stdlib.h>
#include <string.h>

#include "core/compile_build.h"

/* --- Meshes ---------------------------------------------------------------------------------- */

static void clear_pack(fl_tri_pack *pack)
{
    for (int corner = 0; corner < 3; corner++)
        for (int axis = 0; axis < 3; axis++)
            for (int k = 0; k < 8; k++)
                pack->corner[corner][axis][k] = NAN;
    memset(pack->face, 0xff, sizeof pack->face);
}

/* Lay `count` faces into packs from `at` on; NULL names the faces first, first + 1, ... */
static void fill_packs(fl_tri_mesh *mesh, uint32_t at, const uint32_t *faces, uint32_t first,
                       uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        fl_tri_pack *pack = &mesh->packs[at + i / 8];
        uint32_t face = faces ? faces[i] : first + i;
        if (i % 8 == 0)
            clear_pack(pack);
        pack->face[i % 8] = face;
        for (uint32_t corner = 0; corner < 3; corner++)
            for (uint32_t axis = 0; axis < 3; axis++)
                pack->corner[corner][axis][i % 8] =
                    mesh->position[3 * (size_t)mesh->index[3 * (size_t)face + corner] + axis];
    }
}

static fl_bvh_box face_box(const fl_tri_mesh *mesh, uint32_t face)
{
    fl_bvh_box box;
    for (uint32_t a = 0; a < 3; a++) {
        float x[3];
        for (uint32_t k = 0; k < 3; k++)
            x[k] = mesh->position[3 * (size_t)mesh->index[3 * (size_t)face + k] + a];
        box.lo[a] = x[0] < x[1] ? x[0] : x[1];
        box.hi[a] = x[0] > x[1] ? x[0] : x[1];
        box.lo[a] = x[2] < box.lo[a] ? x[2] : box.lo[a];
        box.hi[a] = x[2] > box.hi[a] ? x[2] : box.hi[a];
    }
    return box;
}

typedef struct face_boxes {
    const fl_tri_mesh *mesh;
    fl_bvh_box *boxes;
} face_boxes;

static void fill_face_boxes(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const face_boxes *f = context;
    (void)thread;
    for (uint32_t k = begin; k < end; k++)
        f->boxes[k] = face_box(f->mesh, k);
}

static float largest_coordinate(const fl_tri_mesh *mesh)
{
    float largest = 0.0f;
    for (int a = 0; a < 3; a++) {
        float lo = fabsf(mesh->box_lo[a]), hi = fabsf(mesh->box_hi[a]);
        largest = lo > largest ? lo : largest;
        largest = hi > largest ? hi : largest;
    }
    return largest;
}

static void fill_bvh_packs(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    fl_tri_mesh *mesh = context;
    (void)thread;
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t *items = &mesh->bvh->items[(size_t)k * FL_BVH_WIDTH];
        uint32_t count = 1;
        while (count < FL_BVH_WIDTH && items[count] != FL_NONE)
            count++;
        fill_packs(mesh, k, items, 0, count);
    }
}

static bool allocate_packs(fl_compiler *c, fl_tri_mesh *mesh, uint32_t count)
{
    mesh->pack_count = count;
    mesh->packs = fl_arena_alloc(&c->out->arena, count, sizeof *mesh->packs);
    return mesh->packs != NULL;
}

/* Packs name their faces, so the hierarchy's own list of them goes. */
static bool accel_bvh(fl_compiler *c, fl_tri_mesh *mesh, const fl_bvh_box *boxes, float largest)
{
    const fl_bvh_input input = {.boxes = boxes,
                                .count = mesh->face_count,
                                .pad = FL_BOX_PAD * largest,
                                .origin_pad = FL_ORIGIN_PAD,
                                .are_packed = true};
    fl_arena item_arena = {0};
    mesh->bvh = fl_arena_alloc(&c->out->arena, 1, sizeof *mesh->bvh);
    bool ok = mesh->bvh &&
              (c->is_quick ? fl_bvh_build_quick : fl_bvh_build)(mesh->bvh, &input, &c->out->arena,
                                                                &item_arena, c->pool) &&
              allocate_packs(c, mesh, mesh->bvh->leaf_count);
    if (ok) {
        fl_parallel_for(c->pool, mesh->bvh->leaf_count, 1024, fill_bvh_packs, mesh);
        c->out->accel_bytes += mesh->bvh->node_count * sizeof *mesh->bvh->nodes;
        mesh->bvh->items = NULL;
    }
    fl_arena_deinit(&item_arena);
    return ok;
}

static bool accel_octree(fl_compiler *c, fl_tri_mesh *mesh, const fl_bvh_box *boxes, float largest)
{
    uint32_t height = c->options->octree_height ? c->options->octree_height : FL_OCTREE_HEIGHT_MAX;
    fl_octree *tree = fl_arena_alloc(&c->out->arena, 1, sizeof *tree);
    mesh->octree = tree;
    /* Twice the widening: the planes of small cells come about by eight roundings. */
    if (!tree ||
        !fl_octree_build(tree, &c->out->arena, boxes, mesh->face_count,
                         fl_min_u32(height, FL_OCTREE_HEIGHT_MAX), 2.0f * FL_BOX_PAD * largest) ||
        !allocate_packs(c, mesh, tree->pack_count))
        return false;
    for (uint32_t k = 0; k < tree->leaf_count; k++) {
        const fl_octree_leaf *leaf = &tree->leaves[k];
        fill_packs(mesh, leaf->first_pack, tree->items + leaf->first, 0, leaf->count);
    }
    c->out->accel_bytes += tree->node_count * sizeof *tree->nodes +
                           tree->leaf_count * sizeof *tree->leaves +
                           tree->item_count * sizeof *tree->items;
    return true;
}

bool fl_compile_accel(fl_compiler *c, fl_tri_mesh *mesh)
{
    float largest = largest_coordinate(mesh);
    fl_arena scratch = {0};
    fl_bvh_box *boxes = fl_arena_alloc(&scratch, mesh->face_count, sizeof *boxes);
    bool ok = boxes != NULL;
    if (ok)
        fl_parallel_for(c->pool, mesh->face_count, 16384, fill_face_boxes,
                        &(face_boxes){mesh, boxes});
    if (ok && c->options->accel == FL_ACCEL_BVH) {
        ok = accel_bvh(c, mesh, boxes, largest);
    } else if (ok && c->options->accel == FL_ACCEL_OCTREE) {
        ok = accel_octree(c, mesh, boxes, largest);
    } else if (ok) {
        ok = allocate_packs(c, mesh, (mesh->face_count + 7) / 8);
        if (ok)
            fill_packs(mesh, 0, NULL, 0, mesh->face_count);
    }
    c->out->accel_bytes += ok ? mesh->pack_count * sizeof *mesh->packs : 0;
    fl_arena_deinit(&scratch);
    return ok || fl_out_of_memory(c->diags, "the acceleration structure of a mesh");
}

/* --- Objects --------------------------------------------------------------------------------- */

/* What the boxes of the objects' hierarchy are widened by, in roundings. Tests of spheres and
 * patches err by less than 32 of the coordinates they see; a transform multiplies that by what its
 * rounding does to a ray. */
static const double entry_roundings = 64.0;

/* Nothing reaches so far, and areas and centres of such boxes are still numbers. */
static const double everywhere = 1e37;

typedef struct entry_box {
    fl_bvh_box box;
    double gain;
} entry_box;

static entry_box bounds_of(const fl_geometry *g, const fl_entry *entry)
{
    fl_box box = fl_box_empty();
    double gain = 1.0, base = 0.0;
    if (entry->is_instance) {
        const fl_instance *instance = &g->instances[entry->index];
        const fl_bvh_box *b = &instance->box;
        for (int k = 0; k < 8; k++) {
            fl_vec3 corner = {(double)(k & 1 ? b->hi[0] : b->lo[0]),
                              (double)(k & 2 ? b->hi[1] : b->lo[1]),
                              (double)(k & 4 ? b->hi[2] : b->lo[2])};
            box = fl_box_grow(box, fl_affine_point(&instance->to_world_exact, corner));
        }
        gain = instance->error_gain;
        base = instance->error_base;
    } else if (entry->kind == FL_OBJECT_SPHERE) {
        double r = g->spheres.radius[entry->index];
        box = fl_box_grow(box, fl_v3_add(g->spheres.center[entry->index], fl_v3(r, r, r)));
        box = fl_box_grow(box, fl_v3_sub(g->spheres.center[entry->index], fl_v3(r, r, r)));
    } else if (entry->kind == FL_OBJECT_REVOLUTION) {
        const fl_bvh_box *b = &g->revolutions.bounds[entry->index];
        box.lo = fl_v3((double)b->lo[0], (double)b->lo[1], (double)b->lo[2]);
        box.hi = fl_v3((double)b->hi[0], (double)b->hi[1], (double)b->hi[2]);
    } else {
        /* Sides from their duals: u is orthogonal to dual v and to n, and u . dual u = 1. */
        const fl_patches *q = &g->patches;
        fl_vec3 du = q->dual_u[entry->index], dv = q->dual_v[entry->index];
        fl_vec3 u = fl_v3_cross(dv, q->normal[entry->index]);
        fl_vec3 v = fl_v3_cross(q->normal[entry->index], du);
        u = fl_v3_scale(u, 1.0 / fl_v3_dot(u, du));
        v = fl_v3_scale(v, 1.0 / fl_v3_dot(v, dv));
        fl_vec3 corner = q->corner[entry->index];
        double low = q->is_disk[entry->index] ? -1.0 : 0.0;
        for (int k = 0; k < 4; k++)
            box = fl_box_grow(
                box, fl_v3_mad(fl_v3_mad(corner, u, k & 1 ? 1.0 : low), v, k & 2 ? 1.0 : low));
        gain = 3.0 * fl_max(fl_v3_length(u) * fl_v3_length(du), fl_v3_length(v) * fl_v3_length(dv));
    }
    double size = fl_max(fl_v3_max_abs(box.lo), fl_v3_max_abs(box.hi));
    double pad = entry_roundings * FL_EPSILON * (gain * size + base);
    const double lo[3] = {box.lo.x, box.lo.y, box.lo.z}, hi[3] = {box.hi.x, box.hi.y, box.hi.z};
    entry_box out = {.gain = gain};
    for (int a = 0; a < 3; a++) {
        out.box.lo[a] = (float)fl_max(lo[a] - pad, -everywhere);
        out.box.hi[a] = (float)fl_min(hi[a] + pad, everywhere);
    }
    return out;
}

/* Item from[k] goes to place k. False: out of memory. */
static bool reorder(void *array, size_t item_bytes, const uint32_t *from, uint32_t count)
{
    char *items = array, *copy = malloc(count * item_bytes + 1);
    if (!copy)
        return false;
    memcpy(copy, items, count * item_bytes);
    for (uint32_t k = 0; k < count; k++)
        memcpy(items + k * item_bytes, copy + from[k] * item_bytes, item_bytes);
    free(copy);
    return true;
}

/* Entries, and baked spheres, in the order of the leaves that hold them: a leaf then reads one line
 * of each array instead of eight. */
static bool gather_entries(fl_compiler *c)
{
    fl_geometry *g = c->geometry;
    fl_spheres *s = &g->spheres;
    uint32_t entry_count = 0, sphere_count = 0;
    uint32_t *entry_from = malloc(g->bounded_entry_count * sizeof *entry_from);
    uint32_t *sphere_from = malloc(fl_max_u32(s->baked_count, 1) * sizeof *sphere_from);
    bool ok = entry_from && sphere_from;
    for (size_t k = 0; ok && k < (size_t)g->object_bvh->leaf_count * FL_BVH_WIDTH; k++) {
        uint32_t *item = &g->object_bvh->items[k];
        if (*item == FL_NONE)
            continue;
        fl_entry *entry = &g->entries[*item];
        entry_from[entry_count] = *item;
        *item = entry_count++;
        if (entry->is_instance || entry->kind != FL_OBJECT_SPHERE)
            continue;
        sphere_from[sphere_count] = entry->index;
        g->object_entry[s->object[entry->index]] = sphere_count;
        entry->index = sphere_count++;
    }
    ok = ok && reorder(g->entries, sizeof *g->entries, entry_from, entry_count);
    float *arrays[] = {s->cx, s->cy, s->cz, s->r};
    for (size_t k = 0; k < FL_COUNT_OF(arrays); k++)
        ok = ok && reorder(arrays[k], sizeof(float), sphere_from, sphere_count);
    ok = ok && reorder(s->center, sizeof *s->center, sphere_from, sphere_count) &&
         reorder(s->radius, sizeof *s->radius, sphere_from, sphere_count) &&
         reorder(s->object, sizeof *s->object, sphere_from, sphere_count);
    free(entry_from);
    free(sphere_from);
    return ok;
}

/* The boxes of the bounded entries; sets entry_origin_pad. */
static void measure_entries(fl_geometry *g, fl_bvh_box *out_boxes)
{
    double gain = 1.0;
    for (uint32_t k = 0; k < g->bounded_entry_count; k++) {
        entry_box b = bounds_of(g, &g->entries[k]);
        out_boxes[k] = b.box;
        gain = fl_max(b.gain, gain);
    }
    g->entry_origin_pad = (float)(entry_roundings * FL_EPSILON * gain);
}

static bool lay_out_boxes(fl_compiler *c)
{
    fl_geometry *g = c->geometry;
    fl_bvh_box boxes[FL_OBJECT_BVH_MIN];
    size_t groups = (g->bounded_entry_count + 7) / 8;
    g->entry_boxes = fl_arena_alloc(&c->out->arena, groups, sizeof *g->entry_boxes);
    if (!g->entry_boxes)
        return fl_out_of_memory(c->diags, "the boxes of objects");
    measure_entries(g, boxes);
    for (uint32_t k = 0; k < g->bounded_entry_count; k++)
        for (int a = 0; a < 3; a++) {
            g->entry_boxes[k / 8].lo[a][k % 8] = boxes[k].lo[a];
            g->entry_boxes[k / 8].hi[a][k % 8] = boxes[k].hi[a];
        }
    c->out->accel_bytes += groups * sizeof *g->entry_boxes;
    return true;
}

static bool build_object_bvh(fl_compiler *c)
{
    fl_geometry *g = c->geometry;
    fl_arena scratch = {0};
    fl_bvh_box *boxes = fl_arena_alloc(&scratch, g->bounded_entry_count, sizeof *boxes);
    g->object_bvh = fl_arena_alloc(&c->out->arena, 1, sizeof *g->object_bvh);
    bool ok = boxes && g->object_bvh;
    if (ok)
        measure_entries(g, boxes);
    const fl_bvh_input input = {
        .boxes = boxes, .count = g->bounded_entry_count, .origin_pad = g->entry_origin_pad};
    ok = ok && fl_bvh_build(g->object_bvh, &input, &c->out->arena, &c->out->arena, c->pool);
    fl_arena_deinit(&scratch);
    if (!ok || !gather_entries(c))
        return fl_out_of_memory(c->diags, "the hierarchy of objects");
    c->out->accel_bytes += g->object_bvh->node_count * sizeof *g->object_bvh->nodes;
    return true;
}

bool fl_compile_entries(fl_compiler *c)
{
    fl_geometry *g = c->geometry;
    size_t most = (size_t)g->spheres.baked_count + g->patches.baked_count +
                  g->revolutions.baked_count + g->instance_count;
    g->entries = fl_arena_alloc(&c->out->arena, most, sizeof *g->entries);
    if (!g->entries)
        return fl_out_of_memory(c->diags, "the hierarchy of objects");
    const struct {
        fl_object_kind kind;
        uint32_t count;
    } baked[] = {{FL_OBJECT_SPHERE, g->spheres.baked_count},
                 {FL_OBJECT_SQUARE, g->patches.baked_count},
                 {FL_OBJECT_REVOLUTION, g->revolutions.baked_count}};
    uint32_t count = 0;
    for (size_t b = 0; b < FL_COUNT_OF(baked); b++)
        for (uint32_t k = 0; k < baked[b].count; k++)
            g->entries[count++] = (fl_entry){false, baked[b].kind, k};
    for (uint32_t k = 0; k < g->instance_count; k++)
        if (g->instances[k].kind != FL_OBJECT_PLANE)
            g->entries[count++] = (fl_entry){true, g->instances[k].kind, k};
    g->bounded_entry_count = count;
    for (uint32_t k = 0; k < g->instance_count; k++)
        if (g->instances[k].kind == FL_OBJECT_PLANE)
            g->entries[count++] = (fl_entry){true, g->instances[k].kind, k};
    g->entry_count = count;
    if (c->options->accel != FL_ACCEL_BVH || g->bounded_entry_count <= FL_ENTRY_BOXES_MIN)
        return true;
    return g->bounded_entry_count > FL_OBJECT_BVH_MIN ? build_object_bvh(c) : lay_out_boxes(c);
}
