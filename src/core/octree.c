/* SPDX-License-Identifier: MIT */
#include "core/octree.h"

#include <stdlib.h>
#include <string.h>

enum { LISTINGS_PER_BOX = 32 };

typedef struct cell {
    float lo[3], size[3];
} cell;

typedef struct builder {
    const fl_bvh_box *boxes;
    float pad;
    uint32_t height;
    size_t listing_count, listing_max; /* Over all cells not yet finished and finished. */
    fl_octree_node *nodes;
    fl_octree_leaf *leaves;
    uint32_t *items;
    size_t node_count, node_capacity, leaf_count, leaf_capacity, item_count, item_capacity;
    bool failed;
} builder;

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

static uint32_t add_leaf(builder *b, const uint32_t *items, uint32_t count)
{
    void *leaves = b->leaves, *list = b->items;
    b->failed |= !reserve(&leaves, &b->leaf_capacity, b->leaf_count + 1, sizeof *b->leaves);
    b->leaves = leaves;
    b->failed |= !reserve(&list, &b->item_capacity, b->item_count + count, sizeof *b->items);
    b->items = list;
    if (b->failed)
        return FL_NONE;
    memcpy(&b->items[b->item_count], items, count * sizeof *items);
    b->leaves[b->leaf_count] = (fl_octree_leaf){(uint32_t)b->item_count, count, 0};
    b->item_count += count;
    return FL_BVH_LEAF | (uint32_t)b->leaf_count++;
}

/* Lists of all octants behind each other; NULL with *is_worth false when cutting does not pay. */
static uint32_t *distribute(builder *b, const cell *c, const uint32_t *items, uint32_t count,
                            uint32_t out_counts[8], bool *is_worth)
{
    size_t total = 0;
    *is_worth = false;
    for (uint32_t k = 0; k < 8; k++) {
        cell child = octant(c, k);
        out_counts[k] = 0;
        for (uint32_t i = 0; i < count; i++)
            out_counts[k] += overlaps(b, &child, items[i]);
        total += out_counts[k];
    }
    if (b->listing_count + total > b->listing_max || total >= (size_t)8 * count)
        return NULL;
    *is_worth = true;
    uint32_t *lists = malloc((total + 1) * sizeof *lists), *out = lists;
    if (!lists) {
        b->failed = true;
        return NULL;
    }
    for (uint32_t k = 0; k < 8; k++) {
        cell child = octant(c, k);
        for (uint32_t i = 0; i < count; i++)
            if (overlaps(b, &child, items[i]))
                *out++ = items[i];
    }
    b->listing_count += total > count ? total - count : 0;
    return lists;
}

/* Recursion is bounded by the height. */
static uint32_t build_cell(builder *b, const cell *c, const uint32_t *items, uint32_t count,
                           uint32_t depth)
{
    if (count == 0 || b->failed)
        return FL_NONE;
    if (count <= FL_OCTREE_LEAF_ITEMS || depth >= b->height)
        return add_leaf(b, items, count);
    uint32_t counts[8];
    bool is_worth;
    uint32_t *lists = distribute(b, c, items, count, counts, &is_worth);
    if (!is_worth)
        return add_leaf(b, items, count);
    void *nodes = b->nodes;
    b->failed |= !lists || !reserve(&nodes, &b->node_capacity, b->node_count + 1, sizeof *b->nodes);
    b->nodes = nodes;
    if (b->failed) {
        free(lists);
        return FL_NONE;
    }
    uint32_t node = (uint32_t)b->node_count++;
    const uint32_t *list = lists;
    for (uint32_t k = 0; k < 8; k++) {
        cell child = octant(c, k);
        uint32_t built = build_cell(b, &child, list, counts[k], depth + 1);
        b->nodes[node].child[k] = built;
        list += counts[k];
    }
    free(lists);
    return node;
}

static cell root_cell(const fl_bvh_box *boxes, uint32_t count, float pad)
{
    fl_bvh_box all = boxes[0];
    for (uint32_t i = 1; i < count; i++)
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
                     uint32_t count, uint32_t height, float pad, float origin_pad)
{
    FL_ASSERT(count >= 1 && height >= 1 && height <= FL_OCTREE_HEIGHT_MAX);
    uint32_t *all = malloc(count * sizeof *all);
    if (!all)
        return false;
    for (uint32_t i = 0; i < count; i++)
        all[i] = i;
    builder b = {.boxes = boxes,
                 .pad = pad,
                 .height = height,
                 .listing_count = count,
                 .listing_max = (size_t)LISTINGS_PER_BOX * count};
    cell root = root_cell(boxes, count, pad);
    fl_octree result = {.pad = pad, .origin_pad = origin_pad};
    result.root = build_cell(&b, &root, all, count, 0);
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
