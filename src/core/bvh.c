/* SPDX-License-Identifier: MIT */
#include "core/bvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* x y z and one lane to spare, whatever the machine: the tree is the same everywhere. */
#define FL_W 4
#include "core/wide.h"

enum {
    BIN_COUNT = 16,
    SAH_DEPTH_MAX = 28,   /* Deeper, ranges are halved by count: 12 more levels reach any size. */
    SUBTREE_ITEMS = 4096, /* Ranges up to this size are built as one piece by one thread. */
    ITEM_COUNT_MAX = 1 << 28 /* Leaf indices have 28 bits. */
};

_Static_assert((FL_BVH_WIDTH - 1) * (SAH_DEPTH_MAX + 12) + 1 <= FL_BVH_STACK_MAX,
               "stack too small");

typedef struct wide_box {
    fl_wf lo, hi;
} wide_box;

/* What is partitioned: boxes travel with their item, so every pass reads memory in order. */
typedef struct item {
    fl_wf lo; /* Fourth: the item's number, as bits. */
    fl_wf hi; /* Fourth: 0. */
} item;

typedef struct range {
    uint32_t first, count;
    wide_box box;
    wide_box centers; /* Of lo + hi: twice the centres. */
} range;

/* Nodes and leaves of one subtree, with indices of their own; put together at the end. */
typedef struct tree {
    fl_bvh_node *nodes;
    uint32_t *leaf_items;
    uint32_t node_count, node_capacity, leaf_count, leaf_capacity;
    bool failed;
} tree;

/* A subtree that hangs on a slot of a node of the top tree. */
typedef struct pending {
    range items;
    uint32_t node, slot, depth;
    tree built;
} pending;

typedef struct builder {
    item *items;
    float pad;
    pending *pending; /* NULL: ranges are built to the end where they occur. */
    uint32_t pending_count, pending_capacity;
} builder;

static inline wide_box box_empty(void)
{
    return (wide_box){{INFINITY, INFINITY, INFINITY, INFINITY},
                      {-INFINITY, -INFINITY, -INFINITY, -INFINITY}};
}

static inline void box_grow(wide_box *box, fl_wf lo, fl_wf hi)
{
    box->lo = fl_wf_min(lo, box->lo);
    box->hi = fl_wf_max(hi, box->hi);
}

static inline float box_half_area(const wide_box *box)
{
    fl_wf side = box->hi - box->lo;
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

/* The number is kept out of the sum: as a float it would be a slow one. */
static inline fl_wf twice_center(const item *it)
{
    const fl_wi xyz = {-1, -1, -1, 0};
    return (fl_wf)((fl_wi)it->lo & xyz) + it->hi;
}

static inline void range_grow(range *r, const item *it)
{
    fl_wf center = twice_center(it);
    box_grow(&r->box, it->lo, it->hi);
    box_grow(&r->centers, center, center);
}

static range range_of(const item *items, uint32_t first, uint32_t count)
{
    range r = {first, count, box_empty(), box_empty()};
    for (uint32_t i = first; i < first + count; i++)
        range_grow(&r, &items[i]);
    return r;
}

/* --- Choosing a split ------------------------------------------------------------------------ */

typedef struct bins {
    wide_box box[BIN_COUNT];
    uint32_t count[BIN_COUNT];
} bins;

typedef struct split {
    int axis; /* -1: none. */
    int bin;  /* Items in lower bins go left. */
    float cost;
} split;

static inline int bin_of(fl_wf center, int axis, float lo, float scale)
{
    int bin = (int)((center[axis] - lo) * scale);
    return bin < BIN_COUNT - 1 ? bin : BIN_COUNT - 1;
}

static float bin_scale(const range *r, int axis)
{
    float extent = r->centers.hi[axis] - r->centers.lo[axis];
    float scale = (float)BIN_COUNT * 0.9999f / extent;
    return extent > 0.0f && scale < 1e30f ? scale : 0.0f;
}

static void try_axis(const bins *b, int axis, split *best)
{
    float right_cost[BIN_COUNT];
    wide_box box = box_empty();
    uint32_t count = 0;
    for (int i = BIN_COUNT - 1; i > 0; i--) {
        box_grow(&box, b->box[i].lo, b->box[i].hi);
        count += b->count[i];
        right_cost[i] = count ? box_half_area(&box) * (float)count : 0.0f;
    }
    uint32_t total = count + b->count[0];
    box = box_empty();
    count = 0;
    for (int i = 1; i < BIN_COUNT; i++) {
        box_grow(&box, b->box[i - 1].lo, b->box[i - 1].hi);
        count += b->count[i - 1];
        if (count == 0 || count == total)
            continue;
        float cost = box_half_area(&box) * (float)count + right_cost[i];
        if (cost < best->cost)
            *best = (split){axis, i, cost};
    }
}

static split find_split(const item *items, const range *r)
{
    split best = {-1, 0, INFINITY};
    bins b[3];
    float scale[3], lo[3];
    for (int a = 0; a < 3; a++) {
        lo[a] = r->centers.lo[a];
        scale[a] = bin_scale(r, a);
        memset(b[a].count, 0, sizeof b[a].count);
        for (int i = 0; i < BIN_COUNT; i++)
            b[a].box[i] = box_empty();
    }
    for (uint32_t i = r->first; i < r->first + r->count; i++) {
        const item *it = &items[i];
        fl_wf center = twice_center(it);
        for (int a = 0; a < 3; a++) {
            int bin = bin_of(center, a, lo[a], scale[a]);
            box_grow(&b[a].box[bin], it->lo, it->hi);
            b[a].count[bin]++;
        }
    }
    for (int a = 0; a < 3; a++)
        if (scale[a] > 0.0f)
            try_axis(&b[a], a, &best);
    return best;
}

/* Put items of lower bins first; both sides are measured on the way. */
static void partition(item *items, const range *r, const split *at, range *out_left,
                      range *out_right)
{
    float scale = bin_scale(r, at->axis), lo = r->centers.lo[at->axis];
    uint32_t i = r->first, j = r->first + r->count;
    range left = {r->first, 0, box_empty(), box_empty()}, right = left;
    while (i < j) {
        item it = items[i];
        if (bin_of(twice_center(&it), at->axis, lo, scale) < at->bin) {
            range_grow(&left, &it);
            i++;
        } else {
            range_grow(&right, &it);
            items[i] = items[--j];
            items[j] = it;
        }
    }
    left.count = i - r->first;
    right.first = i;
    right.count = r->count - left.count;
    *out_left = left;
    *out_right = right;
}

/* Cut `r` in two. By count when no plane separates the centres, or far down a degenerate tree. */
static void split_range(item *items, const range *r, uint32_t depth, range *out_left,
                        range *out_right)
{
    split best = {-1, 0, INFINITY};
    if (depth < SAH_DEPTH_MAX)
        best = find_split(items, r);
    if (best.axis >= 0) {
        partition(items, r, &best, out_left, out_right);
        return;
    }
    uint32_t left = r->count / 2;
    *out_left = range_of(items, r->first, left);
    *out_right = range_of(items, r->first + left, r->count - left);
}

/* --- Growing a tree -------------------------------------------------------------------------- */

static bool reserve(void **array, uint32_t *capacity, uint32_t needed, size_t item_bytes)
{
    if (needed <= *capacity)
        return true;
    uint32_t grown = *capacity ? *capacity * 2 : 64;
    void *moved = realloc(*array, grown * item_bytes);
    if (!moved)
        return false;
    *array = moved;
    *capacity = grown;
    return true;
}

static uint32_t add_node(tree *t)
{
    void *nodes = t->nodes;
    if (!reserve(&nodes, &t->node_capacity, t->node_count + 1, sizeof *t->nodes)) {
        t->failed = true;
        return FL_NONE;
    }
    t->nodes = nodes;
    fl_bvh_node *node = &t->nodes[t->node_count];
    memset(node, 0, sizeof *node);
    for (int k = 0; k < FL_BVH_WIDTH; k++) {
        node->child[k] = FL_NONE;
        for (int a = 0; a < 3; a++) {
            node->plane[2 * a][k] = INFINITY;
            node->plane[2 * a + 1][k] = -INFINITY;
        }
    }
    return t->node_count++;
}

static uint32_t item_number(const item *it)
{
    return (uint32_t)((fl_wi)it->lo)[3];
}

static uint32_t add_leaf(tree *t, const item *items, const range *r)
{
    void *leaves = t->leaf_items;
    if (!reserve(&leaves, &t->leaf_capacity, t->leaf_count + 1,
                 FL_BVH_WIDTH * sizeof *t->leaf_items)) {
        t->failed = true;
        return FL_NONE;
    }
    t->leaf_items = leaves;
    uint32_t *out = &t->leaf_items[(size_t)t->leaf_count * FL_BVH_WIDTH];
    for (uint32_t k = 0; k < FL_BVH_WIDTH; k++)
        out[k] = k < r->count ? item_number(&items[r->first + k]) : FL_NONE;
    for (uint32_t k = 1; k < r->count; k++)
        for (uint32_t j = k; j > 0 && out[j] < out[j - 1]; j--) {
            uint32_t swap = out[j];
            out[j] = out[j - 1];
            out[j - 1] = swap;
        }
    return FL_BVH_LEAF | (r->count - 1) << 28 | t->leaf_count++;
}

/* Up to eight ranges: the one with the largest area that is no leaf yet is split, again and again.
 */
static uint32_t split_to_width(const builder *b, const range *r, uint32_t depth,
                               range out[FL_BVH_WIDTH])
{
    uint32_t count = 1;
    out[0] = *r;
    while (count < FL_BVH_WIDTH) {
        uint32_t widest = FL_NONE;
        float widest_area = -1.0f;
        for (uint32_t k = 0; k < count; k++) {
            float area = box_half_area(&out[k].box);
            if (out[k].count > FL_BVH_WIDTH && area > widest_area) {
                widest = k;
                widest_area = area;
            }
        }
        if (widest == FL_NONE)
            break;
        range whole = out[widest];
        split_range(b->items, &whole, depth, &out[widest], &out[count]);
        count++;
    }
    return count;
}

static void set_child(const builder *b, fl_bvh_node *node, uint32_t k, const wide_box *box,
                      uint32_t child)
{
    node->child[k] = child;
    node->has_leaf |= child != FL_NONE && child & FL_BVH_LEAF ? 1u : 0u;
    for (int a = 0; a < 3; a++) {
        node->plane[2 * a][k] = box->lo[a] - b->pad;
        node->plane[2 * a + 1][k] = box->hi[a] + b->pad;
    }
}

/* Put `r` off to the parallel phase if there is one and it is small enough. */
static bool put_off(builder *b, tree *t, const range *r, uint32_t node, uint32_t slot,
                    uint32_t depth)
{
    if (b->pending_capacity == 0 || r->count > SUBTREE_ITEMS)
        return false;
    if (b->pending_count == b->pending_capacity) {
        void *moved = realloc(b->pending, 2 * b->pending_capacity * sizeof *b->pending);
        if (!moved) {
            t->failed = true;
            return true;
        }
        b->pending = moved;
        b->pending_capacity *= 2;
    }
    b->pending[b->pending_count++] = (pending){*r, node, slot, depth, {0}};
    return true;
}

/* Depth is at most SAH_DEPTH_MAX + 12, so recursion is bounded. */
static uint32_t build_node(builder *b, tree *t, const range *r, uint32_t depth)
{
    uint32_t node = add_node(t);
    if (node == FL_NONE)
        return FL_NONE;
    range part[FL_BVH_WIDTH];
    uint32_t count = split_to_width(b, r, depth, part);
    for (uint32_t k = 0; k < count && !t->failed; k++) {
        uint32_t child = FL_NONE;
        if (part[k].count <= FL_BVH_WIDTH)
            child = add_leaf(t, b->items, &part[k]);
        else if (!put_off(b, t, &part[k], node, k, depth + 1))
            child = build_node(b, t, &part[k], depth + 1);
        set_child(b, &t->nodes[node], k, &part[k].box, child);
    }
    return node;
}

static void build_pending(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    builder *b = context;
    (void)thread;
    for (uint32_t i = begin; i < end; i++) {
        builder whole = {b->items, b->pad, NULL, 0, 0};
        build_node(&whole, &b->pending[i].built, &b->pending[i].items, b->pending[i].depth);
    }
}

/* --- Putting the parts together -------------------------------------------------------------- */

static void append(fl_bvh *bvh, const tree *t)
{
    uint32_t node_base = bvh->node_count, leaf_base = bvh->leaf_count;
    for (uint32_t i = 0; i < t->node_count; i++) {
        fl_bvh_node *node = &bvh->nodes[node_base + i];
        *node = t->nodes[i];
        for (int k = 0; k < FL_BVH_WIDTH; k++)
            if (node->child[k] != FL_NONE)
                node->child[k] += node->child[k] & FL_BVH_LEAF ? leaf_base : node_base;
    }
    if (t->leaf_count)
        memcpy(&bvh->items[(size_t)leaf_base * FL_BVH_WIDTH], t->leaf_items,
               (size_t)t->leaf_count * FL_BVH_WIDTH * sizeof *bvh->items);
    bvh->node_count += t->node_count;
    bvh->leaf_count += t->leaf_count;
}

static bool assemble(fl_bvh *out, fl_arena *arena, const tree *top, const builder *b)
{
    uint32_t node_count = top->node_count, leaf_count = top->leaf_count;
    bool failed = top->failed;
    for (uint32_t i = 0; i < b->pending_count; i++) {
        node_count += b->pending[i].built.node_count;
        leaf_count += b->pending[i].built.leaf_count;
        failed |= b->pending[i].built.failed;
    }
    if (failed)
        return false;
    out->nodes = fl_arena_alloc(arena, node_count, sizeof *out->nodes);
    out->items = fl_arena_alloc(arena, leaf_count, FL_BVH_WIDTH * sizeof *out->items);
    if (!out->nodes || !out->items)
        return false;
    append(out, top);
    for (uint32_t i = 0; i < b->pending_count; i++) {
        const pending *p = &b->pending[i];
        out->nodes[p->node].child[p->slot] = out->node_count;
        append(out, &p->built);
    }
    return true;
}

static void tree_free(tree *t)
{
    free(t->nodes);
    free(t->leaf_items);
}

bool fl_bvh_build(fl_bvh *out_bvh, fl_arena *arena, const fl_bvh_box *boxes, uint32_t count,
                  float pad, float origin_pad, fl_pool *pool)
{
    FL_ASSERT(count >= 1);
    if (count > ITEM_COUNT_MAX)
        return false;
    tree top = {0};
    builder b = {aligned_alloc(64, (count * sizeof *b.items + 63) / 64 * 64), pad,
                 malloc(64 * sizeof *b.pending), 0, 64};
    bool ok = b.items && b.pending;
    fl_bvh result = {.origin_pad = origin_pad};
    if (ok) {
        for (uint32_t i = 0; i < count; i++) {
            const float *lo = boxes[i].lo, *hi = boxes[i].hi;
            fl_wi number = {0, 0, 0, (int32_t)i};
            fl_wf low = {lo[0], lo[1], lo[2], 0.0f};
            b.items[i].lo = (fl_wf)((fl_wi)low | number);
            b.items[i].hi = (fl_wf){hi[0], hi[1], hi[2], 0.0f};
        }
        range all = range_of(b.items, 0, count);
        build_node(&b, &top, &all, 0);
        if (!top.failed)
            fl_parallel_for(pool, b.pending_count, 1, build_pending, &b);
        ok = assemble(&result, arena, &top, &b);
    }
    for (uint32_t i = 0; i < b.pending_count; i++)
        tree_free(&b.pending[i].built);
    tree_free(&top);
    free(b.pending);
    free(b.items);
    if (ok)
        *out_bvh = result;
    return ok;
}
