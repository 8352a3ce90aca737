/* SPDX-License-Identifier: MIT
 *
 * Three steps. The top: ranges are split in rounds, those of a round side by side, until they are
 * small. Subtrees: each small range is split down to leaves by one thread, and its binary tree
 * folded into nodes of eight. Last the top is folded in the same way, and all put together.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/bvh_pair.h"

enum {
    PIECE_ITEMS = 4096 /* Ranges up to this size are split by one thread. */
};

_Static_assert((FL_BVH_WIDTH - 1) * (FL_BVH_SAH_DEPTH_MAX + 28) + 1 <= FL_BVH_STACK_MAX,
               "stack too small");

typedef struct pair_ref {
    const pairs *in;
    uint32_t k;
} pair_ref;

/* Nodes and leaves in the order of their making. */
typedef struct tree {
    fl_bvh_node *nodes;
    uint32_t *leaf_items;
    uint32_t node_count, node_capacity, leaf_count, leaf_capacity;
} tree;

/* One thread's own. */
typedef struct workspace {
    pairs pairs;
    tree made;
    bool failed;
} workspace;

/* A range of items that one thread splits. */
typedef struct piece {
    range items;
    uint32_t depth;
    pair_ref root;
} piece;

/* A pair of the top that is to be split, and what comes of it. */
typedef struct waiting {
    range items, half[2];
    uint32_t pair;
} waiting;

/* What hangs on the top: a leaf or a subtree of nodes, in a workspace's tree. */
typedef struct branch {
    pair_ref root;
    uint32_t child; /* As if its nodes and leaves were the only ones. */
    uint32_t thread, first_node, node_count, first_leaf, leaf_count;
    uint32_t node_base, leaf_base; /* In the whole. */
} branch;

typedef struct builder {
    item *items;
    const fl_bvh_input *in;
    uint32_t thread_count;
    float unit; /* Of all areas. */
    /* The top. Pairs that are not split are pieces: `right` is the piece's number. */
    pairs pairs;
    tree top;
    waiting *round, *next; /* To be split in this round and the next. */
    uint32_t next_count, depth;
    piece *pieces;
    branch *branches;
    uint32_t piece_count, piece_capacity, branch_count, branch_capacity;
    workspace *workspaces;
    fl_bvh *out;
} builder;

/* --- Nodes of eight -------------------------------------------------------------------------- */

static uint32_t add_node(tree *t)
{
    if (!fl_bvh_reserve(&t->nodes, &t->node_capacity, t->node_count + 1, sizeof *t->nodes))
        return FL_NONE;
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

static uint32_t add_leaf(tree *t, const item *items, uint32_t count)
{
    if (!fl_bvh_reserve(&t->leaf_items, &t->leaf_capacity, t->leaf_count + 1,
                        FL_BVH_WIDTH * sizeof *t->leaf_items))
        return FL_NONE;
    uint32_t *out = &t->leaf_items[(size_t)t->leaf_count * FL_BVH_WIDTH];
    for (uint32_t k = 0; k < FL_BVH_WIDTH; k++)
        leaf_insert(out, k, k < count ? item_number(&items[k]) : FL_NONE);
    return leaf_child(t->leaf_count++, count);
}

static const pair *pair_at(pair_ref r)
{
    return &r.in->at[r.k];
}

/* Pairs as `n` children of a node, in order; returns how many. */
static uint32_t children_of(const builder *b, pair_ref r, uint32_t n, pair_ref *out)
{
    FL_ASSERT(n >= 1);
    const pair *whole = pair_at(r);
    if (whole->left == FL_NONE && whole->right != FL_NONE)
        return children_of(b, b->pieces[whole->right].root, n, out);
    while (n > 1 && whole->left != FL_NONE && whole->share[n] == 0)
        n--;
    if (n == 1 || whole->left == FL_NONE) {
        *out = r;
        return 1;
    }
    pair_ref left = {r.in, whole->left}, right = {r.in, whole->right};
    uint32_t count = children_of(b, left, whole->share[n], out);
    return count + children_of(b, right, n - whole->share[n], out + count);
}

/* The children of the node that a pair is. */
static uint32_t own_children(const builder *b, pair_ref r, pair_ref out[FL_BVH_WIDTH])
{
    const pair *whole = pair_at(r);
    if (whole->left == FL_NONE && whole->right != FL_NONE)
        return own_children(b, b->pieces[whole->right].root, out);
    if (whole->left == FL_NONE)
        return children_of(b, r, 1, out);
    pair_ref left = {r.in, whole->left}, right = {r.in, whole->right};
    uint32_t count = children_of(b, left, whole->own_left, out);
    return count + children_of(b, right, whole->own_right, out + count);
}

/* Note what is not of the top for later. */
static uint32_t add_branch(builder *b, pair_ref r)
{
    if (!fl_bvh_reserve(&b->branches, &b->branch_capacity, b->branch_count + 1,
                        sizeof *b->branches))
        return FL_NONE;
    b->branches[b->branch_count] = (branch){.root = r};
    return FL_BVH_LEAF | b->branch_count++;
}

/* Add the child that a pair becomes to `out`, with all below it; returns its name. In the top, a
 * branch is named as if it were a leaf. FL_NONE: out of memory. */
static uint32_t make_child(const builder *b, builder *top, tree *out, pair_ref r)
{
    const pair *whole = pair_at(r);
    if (top && r.in != &top->pairs)
        return add_branch(top, r);
    if (whole->left == FL_NONE && !top)
        return add_leaf(out, &b->items[whole->first], whole->count);
    uint32_t index = add_node(out);
    if (index == FL_NONE)
        return FL_NONE;
    pair_ref part[FL_BVH_WIDTH];
    uint32_t count = own_children(b, r, part);
    for (uint32_t n = 0; n < count; n++) {
        uint32_t child = make_child(b, top, out, part[n]);
        if (child == FL_NONE)
            return FL_NONE;
        const wide_box *box = &pair_at(part[n])->box;
        fl_bvh_node *node = &out->nodes[index];
        node->child[n] = child;
        node->has_leaf |= child & FL_BVH_LEAF ? 1u : 0u;
        for (int a = 0; a < 3; a++) {
            node->plane[2 * a][n] = box->lo[a] - b->in->pad;
            node->plane[2 * a + 1][n] = box->hi[a] + b->in->pad;
        }
    }
    return index;
}

/* --- Steps ----------------------------------------------------------------------------------- */

static void fill_items(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const builder *b = context;
    (void)thread;
    for (uint32_t i = begin; i < end; i++) {
        const float *lo = b->in->boxes[i].lo, *hi = b->in->boxes[i].hi;
        fl_wi number = {0, 0, 0, (int32_t)i};
        fl_wf low = {lo[0], lo[1], lo[2], 0.0f};
        b->items[i].lo = (fl_wf)((fl_wi)low | number);
        b->items[i].hi = (fl_wf){hi[0], hi[1], hi[2], 0.0f};
    }
}

static void split_round(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const builder *b = context;
    (void)thread;
    for (uint32_t i = begin; i < end; i++) {
        waiting *w = &b->round[i];
        fl_bvh_split(b->items, &w->items, b->unit, b->in->are_packed,
                     b->depth >= FL_BVH_SAH_DEPTH_MAX, &w->half[0], &w->half[1]);
    }
}

/* A new pair of the top: to be split in the next round, or a piece. */
static uint32_t add_top(builder *b, const range *items)
{
    uint32_t k = fl_bvh_add_pair(&b->pairs, items);
    if (k == FL_NONE)
        return FL_NONE;
    if (items->count > PIECE_ITEMS) {
        b->next[b->next_count++] = (waiting){.items = *items, .pair = k};
        return k;
    }
    if (!fl_bvh_reserve(&b->pieces, &b->piece_capacity, b->piece_count + 1, sizeof *b->pieces))
        return FL_NONE;
    b->pairs.at[k].right = b->piece_count;
    b->pieces[b->piece_count++] = (piece){.items = *items, .depth = b->depth};
    return k;
}

/* Ranges that wait have no item in common, so there are few at a time. */
static bool split_top(builder *b, fl_pool *pool)
{
    size_t bytes = (b->in->count / PIECE_ITEMS + 1) * sizeof *b->round;
    b->round = malloc(bytes);
    b->next = malloc(bytes);
    if (!b->round || !b->next)
        return false;
    range all = fl_bvh_range(b->items, 0, b->in->count);
    b->unit = fl_bvh_unit(&all.box);
    if (add_top(b, &all) == FL_NONE)
        return false;
    while (b->next_count > 0) {
        waiting *round = b->next;
        uint32_t count = b->next_count;
        b->next = b->round;
        b->round = round;
        b->next_count = 0;
        fl_parallel_for(pool, count, 1, split_round, b);
        if (fl_pool_is_cancelled(pool))
            return false;
        b->depth++;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t left = add_top(b, &round[i].half[0]);
            uint32_t right = left == FL_NONE ? FL_NONE : add_top(b, &round[i].half[1]);
            if (right == FL_NONE)
                return false;
            b->pairs.at[round[i].pair].left = left;
            b->pairs.at[round[i].pair].right = right;
        }
    }
    return true;
}

static void split_pieces(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const builder *b = context;
    workspace *w = &b->workspaces[thread];
    for (uint32_t i = begin; i < end && !w->failed; i++) {
        piece *p = &b->pieces[i];
        p->root.in = &w->pairs;
        p->root.k =
            fl_bvh_grow(&w->pairs, b->items, &p->items, b->unit, b->in->are_packed, p->depth);
        w->failed = p->root.k == FL_NONE;
        for (uint32_t k = w->pairs.count; !w->failed && k-- > p->root.k;)
            fl_bvh_fold(&w->pairs, &w->pairs.at[k], b->unit);
    }
}

/* The top in nodes of eight, down to its branches. */
static bool make_top(builder *b)
{
    for (uint32_t k = b->pairs.count; k-- > 0;) {
        pair *p = &b->pairs.at[k];
        if (p->left == FL_NONE)
            memcpy(p->cost, pair_at(b->pieces[p->right].root)->cost, sizeof p->cost);
        else
            fl_bvh_fold(&b->pairs, p, b->unit);
    }
    return make_child(b, b, &b->top, (pair_ref){&b->pairs, 0}) != FL_NONE;
}

static void make_branches(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const builder *b = context;
    workspace *w = &b->workspaces[thread];
    for (uint32_t i = begin; i < end && !w->failed; i++) {
        branch *r = &b->branches[i];
        r->thread = thread;
        r->first_node = w->made.node_count;
        r->first_leaf = w->made.leaf_count;
        r->child = make_child(b, NULL, &w->made, r->root);
        w->failed = r->child == FL_NONE;
        r->node_count = w->made.node_count - r->first_node;
        r->leaf_count = w->made.leaf_count - r->first_leaf;
    }
}

/* --- Putting the parts together -------------------------------------------------------------- */

static uint32_t moved_child(const branch *r, uint32_t child)
{
    if (child == FL_NONE)
        return child;
    return child +
           (child & FL_BVH_LEAF ? r->leaf_base - r->first_leaf : r->node_base - r->first_node);
}

static void place_branches(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const builder *b = context;
    (void)thread;
    for (uint32_t i = begin; i < end; i++) {
        const branch *r = &b->branches[i];
        const tree *from = &b->workspaces[r->thread].made;
        for (uint32_t n = 0; n < r->node_count; n++) {
            fl_bvh_node *node = &b->out->nodes[r->node_base + n];
            *node = from->nodes[r->first_node + n];
            for (int k = 0; k < FL_BVH_WIDTH; k++)
                node->child[k] = moved_child(r, node->child[k]);
        }
        memcpy(&b->out->items[(size_t)r->leaf_base * FL_BVH_WIDTH],
               &from->leaf_items[(size_t)r->first_leaf * FL_BVH_WIDTH],
               (size_t)r->leaf_count * FL_BVH_WIDTH * sizeof *b->out->items);
    }
}

static void place_top(const builder *b)
{
    for (uint32_t n = 0; n < b->top.node_count; n++) {
        fl_bvh_node *node = &b->out->nodes[n];
        *node = b->top.nodes[n];
        node->has_leaf = 0;
        for (int k = 0; k < FL_BVH_WIDTH; k++) {
            if (node->child[k] == FL_NONE)
                continue;
            if (node->child[k] & FL_BVH_LEAF) {
                const branch *r = &b->branches[node->child[k] & ~FL_BVH_LEAF];
                node->child[k] = moved_child(r, r->child);
            }
            node->has_leaf |= node->child[k] & FL_BVH_LEAF ? 1u : 0u;
        }
    }
}

/* The nodes of the top come first, then the branches in order. */
static bool put_together(builder *b, fl_arena *arena, fl_arena *item_arena, fl_pool *pool)
{
    fl_bvh *out = b->out;
    out->node_count = b->top.node_count;
    for (uint32_t i = 0; i < b->branch_count; i++) {
        branch *r = &b->branches[i];
        r->node_base = out->node_count;
        r->leaf_base = out->leaf_count;
        out->node_count += r->node_count;
        out->leaf_count += r->leaf_count;
    }
    out->nodes = fl_arena_alloc(arena, out->node_count, sizeof *out->nodes);
    out->items = fl_arena_alloc(item_arena, out->leaf_count, FL_BVH_WIDTH * sizeof *out->items);
    if (!out->nodes || !out->items)
        return false;
    place_top(b);
    fl_parallel_for(pool, b->branch_count, 16, place_branches, b);
    return true;
}

/* Out of memory, or loops were broken off. */
static bool has_failed(const builder *b, const fl_pool *pool)
{
    if (fl_pool_is_cancelled(pool))
        return true;
    for (uint32_t t = 0; t < b->thread_count; t++)
        if (b->workspaces[t].failed)
            return true;
    return false;
}

static bool build(builder *b, fl_arena *arena, fl_arena *item_arena, fl_pool *pool)
{
    if (!b->items || !b->workspaces)
        return false;
    fl_parallel_for(pool, b->in->count, 65536, fill_items, b);
    if (has_failed(b, pool) || !split_top(b, pool))
        return false;
    fl_parallel_for(pool, b->piece_count, 1, split_pieces, b);
    if (has_failed(b, pool) || !make_top(b))
        return false;
    fl_parallel_for(pool, b->branch_count, 1, make_branches, b);
    return !has_failed(b, pool) && put_together(b, arena, item_arena, pool) && !has_failed(b, pool);
}

static void builder_deinit(builder *b)
{
    for (uint32_t t = 0; b->workspaces && t < b->thread_count; t++) {
        free(b->workspaces[t].pairs.at);
        free(b->workspaces[t].made.nodes);
        free(b->workspaces[t].made.leaf_items);
    }
    free(b->workspaces);
    free(b->branches);
    free(b->pieces);
    free(b->next);
    free(b->round);
    free(b->top.nodes);
    free(b->pairs.at);
    free(b->items);
}

bool fl_bvh_build(fl_bvh *out_bvh, const fl_bvh_input *input, fl_arena *arena, fl_arena *item_arena,
                  fl_pool *pool)
{
    uint32_t count = input->count, threads = fl_pool_thread_count(pool);
    FL_ASSERT(count >= 1);
    if (count > FL_BVH_ITEMS_MAX)
        return false;
    fl_bvh result = {.origin_pad = input->origin_pad};
    builder b = {.items = aligned_alloc(64, (count * sizeof *b.items + 63) / 64 * 64),
                 .in = input,
                 .thread_count = threads,
                 .workspaces = calloc(threads, sizeof *b.workspaces),
                 .out = &result};
    /* One piece is not worth waking others for. */
    bool ok = build(&b, arena, item_arena, count > PIECE_ITEMS ? pool : NULL);
    builder_deinit(&b);
    if (ok)
        *out_bvh = result;
    return ok;
}
