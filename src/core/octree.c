/* SPDX-License-Identifier: MIT */
#include "core/octree.h"

#include <stdlib.h>
#include <string.h>

enum { LISTINGS_PER_BOX = 32, LEAF_ITEMS_MIN = 2 };

/* In tests of a ray against a triangle. */
static const double node_cost = 8.0;

typedef struct cell {
    float lo[3], size[3];
} cell;

typedef struct builder {
    const fl_bvh_box *boxes;
    float pad;
    uint32_t height;
    fl_octree_node *nodes;
    fl_octree_leaf *leaves;
    uint32_t *items;
    size_t node_count, node_capacity, leaf_count, leaf_capacity, item_count, item_capacity;
    bool failed;
} builder;

/* What became of a cell: a child, and the expected cost of a ray that meets the cell. */
typedef struct built {
    uint32_t child;
    double cost;
} built;

static bool reserve(void **array, size_t *capacity, size_t needed, size_t item_bytes)
{
    if (needed <= *capacity)
        return true;
    size_t grown = *capacity * 2 > needed ? *capacity * 2 : needed + 256;
    void *moved = realloc(*array, grown * item_bytes);
    if (!moved)
        return false;
    *array = moved;
    *capacity = grown;
    return true;
}

static cell octant(const cell *c, uint32_t k)
{
    cell child;
    for (int a = 0; a < 3; a++) {
        child.size[a] = 0.5f * c->size[a];
        child.lo[a] = k >> a & 1u ? c->lo[a] + child.size[a] : c->lo[a];
    }
    return child;
}

static bool overlaps(const builder *b, const cell *c, uint32_t item)
{
    const fl_bvh_box *box = &b->boxes[item];
    for (int a = 0; a < 3; a++)
        if (box->lo[a] - b->pad > c->lo[a] + c->size[a] || box->hi[a] + b->pad < c->lo[a])
            return false;
    return true;
}

/* --- Cutting --------------------------------------------------------------------------------- */

static built add_leaf(builder *b, const uint32_t *items, uint32_t count)
{
    void *leaves = b->leaves, *list = b->items;
    b->failed |= !reserve(&leaves, &b->leaf_capacity, b->leaf_count + 1, sizeof *b->leaves);
    b->leaves = leaves;
    b->failed |= !reserve(&list, &b->item_capacity, b->item_count + count, sizeof *b->items);
    b->items = list;
    if (b->failed)
        return (built){FL_NONE, 0.0};
    memcpy(&b->items[b->item_count], items, count * sizeof *items);
    b->leaves[b->leaf_count] = (fl_octree_leaf){(uint32_t)b->item_count, count, 0};
    b->item_count += count;
    return (built){FL_BVH_LEAF | (uint32_t)b->leaf_count++, count};
}

/* Lists of all octants behind each other; NULL where cutting cannot pay, and when out of memory. A
 * quarter of the rays that meet a cell meet an octant: that is its share of the surface. */
static uint32_t *distribute(builder *b, const cell *c, const uint32_t *items, uint32_t count,
                            size_t budget, uint32_t out_counts[8])
{
    uint32_t *lists = malloc(8 * (size_t)count * sizeof *lists), *out = lists;
    if (!lists) {
        b->failed = true;
        return NULL;
    }
    for (uint32_t k = 0; k < 8; k++) {
        cell child = octant(c, k);
        const uint32_t *begin = out;
        for (uint32_t i = 0; i < count; i++)
            if (overlaps(b, &child, items[i]))
                *out++ = items[i];
        out_counts[k] = (uint32_t)(out - begin);
    }
    size_t total = (size_t)(out - lists);
    if (total <= budget && node_cost + 0.25 * (double)total < count)
        return lists;
    free(lists);
    return NULL;
}

static uint32_t add_node(builder *b, const cell *c)
{
    void *nodes = b->nodes;
    b->failed |= !reserve(&nodes, &b->node_capacity, b->node_count + 1, sizeof *b->nodes);
    b->nodes = nodes;
    if (b->failed)
        return FL_NONE;
    cell first = octant(c, 0), last = octant(c, 7);
    fl_octree_node *node = &b->nodes[b->node_count];
    for (int a = 0; a < 3; a++) {
        node->plane[a][0] = first.lo[a] - b->pad;
        node->plane[a][1] = last.lo[a] - b->pad;
        node->plane[a][2] = first.lo[a] + first.size[a] + b->pad;
        node->plane[a][3] = last.lo[a] + last.size[a] + b->pad;
    }
    return (uint32_t)b->node_count++;
}

/* `budget`: listings that may come of the cell's, so that large boxes do not fill memory. Recursion
 * is bounded by the height. */
static built build_cell(builder *b, const cell *c, const uint32_t *items, uint32_t count,
                        size_t budget, uint32_t depth)
{
    if (count == 0 || b->failed)
        return (built){FL_NONE, 0.0};
    if (count <= LEAF_ITEMS_MIN || depth >= b->height)
        return add_leaf(b, items, count);
    uint32_t counts[8];
    uint32_t *lists = distribute(b, c, items, count, budget, counts);
    if (!lists)
        return add_leaf(b, items, count);
    const size_t nodes = b->node_count, leaves = b->leaf_count, listed = b->item_count;
    built result = {add_node(b, c), node_cost};
    size_t total = 0;
    for (uint32_t k = 0; k < 8; k++)
        total += counts[k];
    const uint32_t *list = lists;
    for (uint32_t k = 0; k < 8 && !b->failed; k++) {
        cell child = octant(c, k);
        size_t share = (size_t)((double)budget / (double)total * (double)counts[k]);
        built part = build_cell(b, &child, list, counts[k], share, depth + 1);
        b->nodes[result.child].child[k] = part.child;
        result.cost += 0.25 * part.cost;
        list += counts[k];
    }
    free(lists);
    if (result.cost < count || b->failed)
        return result;
    b->node_count = nodes;
    b->leaf_count = leaves;
    b->item_count = listed;
    return add_leaf(b, items, count);
}

static cell root_cell(const fl_bvh_box *boxes, uint32_t count, float pad)
{
    fl_bvh_box all = boxes[0];
    for (uint32_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            all.lo[a] = boxes[i].lo[a] < all.lo[a] ? boxes[i].lo[a] : all.lo[a];
            all.hi[a] = boxes[i].hi[a] > all.hi[a] ? boxes[i].hi[a] : all.hi[a];
        }
    cell c;
    for (int a = 0; a < 3; a++) {
        c.lo[a] = all.lo[a] - pad;
        c.size[a] = (all.hi[a] - all.lo[a]) + 3.0f * pad;
    }
    return c;
}

/* Copy the grown arrays to the arena. */
static bool settle(fl_octree *out, fl_arena *arena, const builder *b)
{
    out->nodes = fl_arena_alloc(arena, b->node_count, sizeof *out->nodes);
    out->leaves = fl_arena_alloc(arena, b->leaf_count, sizeof *out->leaves);
    out->items = fl_arena_alloc(arena, b->item_count, sizeof *out->items);
    if (!out->nodes || !out->leaves || !out->items || b->item_count >= FL_NONE)
        return false;
    if (b->node_count)
        memcpy(out->nodes, b->nodes, b->node_count * sizeof *out->nodes);
    memcpy(out->leaves, b->leaves, b->leaf_count * sizeof *out->leaves);
    memcpy(out->items, b->items, b->item_count * sizeof *out->items);
    out->node_count = (uint32_t)b->node_count;
    out->leaf_count = (uint32_t)b->leaf_count;
    out->item_count = (uint32_t)b->item_count;
    for (uint32_t i = 0; i < out->leaf_count; i++) {
        out->leaves[i].first_pack = out->pack_count;
        out->pack_count += (out->leaves[i].count + 7) / 8;
    }
    return true;
}

bool fl_octree_build(fl_octree *out_octree, fl_arena *arena, const fl_bvh_box *boxes,
                     uint32_t count, uint32_t height, float pad)
{
    FL_ASSERT(count >= 1 && height >= 1 && height <= FL_OCTREE_HEIGHT_MAX);
    uint32_t *all = malloc(count * sizeof *all);
    if (!all)
        return false;
    for (uint32_t i = 0; i < count; i++)
        all[i] = i;
    builder b = {.boxes = boxes, .pad = pad, .height = height};
    cell root = root_cell(boxes, count, pad);
    fl_octree result = {0};
    result.root = build_cell(&b, &root, all, count, (size_t)LISTINGS_PER_BOX * count, 0).child;
    memcpy(result.lo, root.lo, sizeof root.lo);
    memcpy(result.size, root.size, sizeof root.size);
    bool ok = !b.failed && settle(&result, arena, &b);
    free(all);
    free(b.nodes);
    free(b.leaves);
    free(b.items);
    if (ok)
        *out_octree = result;
    return ok;
}
