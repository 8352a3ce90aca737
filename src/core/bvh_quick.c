/* SPDX-License-Identifier: MIT
 *
 * The quick way: items in the order of a Hilbert curve through their centres [Kamel and Faloutsos
 * 1993], every eight a leaf, every eight leaves a node, and so up to the root. What is near on the
 * curve is near in space; nothing is chosen by looking at all items again, so memory is passed over
 * a few times only, and every leaf and node is full but the last.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/bvh_split.h"

enum {
    AXIS_BITS = 16, /* The curve has 2^16 cells along each axis: codes of 48 bits. */
    HALF_BITS = AXIS_BITS / 2,
    DIGIT_BITS = 8, /* Of the code, for a pass of the sort. */
    DIGITS = 1 << DIGIT_BITS,
    CHUNKS_MAX = 64, /* Parts of a pass, done side by side. */
    CHUNK_ITEMS_MIN = 16384,
    LEVELS_MAX = 10
};

/* An item and where it comes on the curve. */
typedef struct key {
    uint64_t code;
    uint32_t item;
} key;

typedef struct chunk {
    wide_box centers;       /* Of its items, in the first order. */
    uint32_t start[DIGITS]; /* How many keys have each digit; then where they go. */
} chunk;

/* Nodes of one distance from the leaves. */
typedef struct level {
    uint32_t first, count;
} level;

typedef struct quick {
    const fl_bvh_input *in;
    key *keys, *sorted; /* Before and after a pass. */
    chunk *chunks;
    uint32_t chunk_items, chunk_count, shift;
    wide_box centers; /* Of all items: twice their centres. */
    float scale;      /* From there to cells. */
    level own, below; /* What is made, and of what; below.count 0: of leaves. */
    fl_bvh *out;
} quick;

static inline fl_wf twice_center(const fl_bvh_box *b)
{
    return (fl_wf){b->lo[0] + b->hi[0], b->lo[1] + b->hi[1], b->lo[2] + b->hi[2], 0.0f};
}

static uint32_t chunk_end(const quick *q, uint32_t c)
{
    return fl_min_u32((c + 1) * q->chunk_items, q->in->count);
}

/* --- The curve ------------------------------------------------------------------------------- */

static void bound_chunks(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const quick *q = context;
    (void)thread;
    for (uint32_t c = begin; c < end; c++) {
        uint32_t first = c * q->chunk_items;
        wide_box box = {twice_center(&q->in->boxes[first]), twice_center(&q->in->boxes[first])};
        for (uint32_t i = first; i < chunk_end(q, c); i++) {
            fl_wf center = twice_center(&q->in->boxes[i]);
            box.lo = fl_wf_min(center, box.lo);
            box.hi = fl_wf_max(center, box.hi);
        }
        q->chunks[c].centers = box;
    }
}

/* Cells are cubes: the longest side has 2^16. */
static void bound_centers(quick *q, fl_pool *pool)
{
    fl_parallel_for(pool, q->chunk_count, 1, bound_chunks, q);
    if (fl_pool_is_cancelled(pool))
        return; /* Not all chunks have bounds. */
    q->centers = q->chunks[0].centers;
    for (uint32_t c = 1; c < q->chunk_count; c++) {
        q->centers.lo = fl_wf_min(q->chunks[c].centers.lo, q->centers.lo);
        q->centers.hi = fl_wf_max(q->chunks[c].centers.hi, q->centers.hi);
    }
    fl_wf side = q->centers.hi - q->centers.lo;
    float longest = side[0] > side[1] ? side[0] : side[1];
    longest = side[2] > longest ? side[2] : longest;
    float scale = (float)(1 << AXIS_BITS) * 0.9999f / longest;
    q->scale = longest > 0.0f && scale < 1e30f ? scale : 0.0f;
}

/* Two zeros before each of the eight lowest bits. */
static inline fl_wu spread(fl_wu v)
{
    v = (v | v << 8) & 0x00f00f;
    v = (v | v << 4) & 0x0c30c3;
    return (v | v << 2) & 0x249249;
}

/* Where the cells (x, y, z) of four items come on the curve. [Skilling 2004] */
static void codes_of(fl_wu x[3], uint64_t out_code[FL_W])
{
    for (uint32_t bit = AXIS_BITS - 1; bit > 0; bit--) {
        const uint32_t lower = (1u << bit) - 1;
        for (int a = 0; a < 3; a++) {
            fl_wu is_set = (fl_wu)((x[a] >> bit & 1) != 0);
            fl_wu turned = (x[0] ^ x[a]) & lower & ~is_set;
            x[0] ^= (is_set & lower) | turned;
            x[a] ^= turned;
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    fl_wu below = fl_wu_set(0), high = below, low = below;
    for (uint32_t bit = AXIS_BITS - 1; bit > 0; bit--)
        below ^= (fl_wu)((x[2] >> bit & 1) != 0) & ((1u << bit) - 1);
    for (int a = 0; a < 3; a++) {
        fl_wu v = x[a] ^ below;
        high |= spread(v >> HALF_BITS) << (2 - a);
        low |= spread(v & ((1u << HALF_BITS) - 1)) << (2 - a);
    }
    for (int k = 0; k < FL_W; k++)
        out_code[k] = (uint64_t)high[k] << 3 * HALF_BITS | low[k];
}

static void fill_keys(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const quick *q = context;
    (void)thread;
    for (uint32_t i = begin; i < end; i += FL_W) {
        fl_wu cell[3] = {{0}, {0}, {0}};
        uint64_t code[FL_W];
        uint32_t count = fl_min_u32(end - i, FL_W);
        for (uint32_t k = 0; k < count; k++) {
            fl_wf at = (twice_center(&q->in->boxes[i + k]) - q->centers.lo) * q->scale;
            for (int a = 0; a < 3; a++)
                cell[a][k] = (uint32_t)(int32_t)at[a];
        }
        codes_of(cell, code);
        for (uint32_t k = 0; k < count; k++)
            q->keys[i + k] = (key){code[k], i + k};
    }
}

/* --- Sorting --------------------------------------------------------------------------------- */

static inline uint32_t digit_of(const quick *q, const key *k)
{
    return (uint32_t)(k->code >> q->shift) & (DIGITS - 1);
}

static void count_digits(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const quick *q = context;
    (void)thread;
    for (uint32_t c = begin; c < end; c++) {
        uint32_t *count = q->chunks[c].start;
        memset(count, 0, sizeof q->chunks[c].start);
        for (uint32_t i = c * q->chunk_items; i < chunk_end(q, c); i++)
            count[digit_of(q, &q->keys[i])]++;
    }
}

static void move_keys(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const quick *q = context;
    (void)thread;
    for (uint32_t c = begin; c < end; c++) {
        uint32_t *next = q->chunks[c].start;
        for (uint32_t i = c * q->chunk_items; i < chunk_end(q, c); i++)
            q->sorted[next[digit_of(q, &q->keys[i])]++] = q->keys[i];
    }
}

/* By code and then by number, since every pass keeps the order of equals. The last to be written
 * is `sorted`. */
static void sort_keys(quick *q, fl_pool *pool)
{
    for (q->shift = 0; q->shift < 3 * AXIS_BITS && !fl_pool_is_cancelled(pool);
         q->shift += DIGIT_BITS) {
        if (q->shift > 0) {
            key *swap = q->keys;
            q->keys = q->sorted;
            q->sorted = swap;
        }
        fl_parallel_for(pool, q->chunk_count, 1, count_digits, q);
        if (fl_pool_is_cancelled(pool))
            return;
        uint32_t at = 0;
        for (uint32_t digit = 0; digit < DIGITS; digit++)
            for (uint32_t c = 0; c < q->chunk_count; c++) {
                uint32_t count = q->chunks[c].start[digit];
                q->chunks[c].start[digit] = at;
                at += count;
            }
        fl_parallel_for(pool, q->chunk_count, 1, move_keys, q);
    }
}

/* --- Nodes ----------------------------------------------------------------------------------- */

static uint32_t eighth(uint32_t count)
{
    return (count + FL_BVH_WIDTH - 1) / FL_BVH_WIDTH;
}

/* Child and box of leaf `leaf`, whose items are entered. */
static uint32_t make_leaf(const quick *q, uint32_t leaf, float lo[3], float hi[3])
{
    uint32_t first = leaf * FL_BVH_WIDTH, count = fl_min_u32(q->in->count - first, FL_BVH_WIDTH);
    uint32_t *out = &q->out->items[first];
    for (uint32_t n = 0; n < FL_BVH_WIDTH; n++)
        leaf_insert(out, n, n < count ? q->sorted[first + n].item : FL_NONE);
    for (uint32_t n = 0; n < count; n++)
        for (int a = 0; a < 3; a++) {
            float l = q->in->boxes[out[n]].lo[a] - q->in->pad;
            float h = q->in->boxes[out[n]].hi[a] + q->in->pad;
            lo[a] = l < lo[a] ? l : lo[a];
            hi[a] = h > hi[a] ? h : hi[a];
        }
    return leaf_child(leaf, count);
}

/* Child and box of a finished node; absent children are inside out and change nothing. */
static uint32_t bound_node(const quick *q, uint32_t index, float lo[3], float hi[3])
{
    const fl_bvh_node *node = &q->out->nodes[index];
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < FL_BVH_WIDTH; k++) {
            float l = node->plane[2 * a][k], h = node->plane[2 * a + 1][k];
            lo[a] = l < lo[a] ? l : lo[a];
            hi[a] = h > hi[a] ? h : hi[a];
        }
    return index;
}

static void make_nodes(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    const quick *q = context;
    bool has_leaves = q->below.count == 0;
    uint32_t parts = has_leaves ? q->out->leaf_count : q->below.count;
    (void)thread;
    for (uint32_t n = begin; n < end; n++) {
        fl_bvh_node *node = &q->out->nodes[q->own.first + n];
        node->has_leaf = has_leaves;
        for (uint32_t k = 0; k < FL_BVH_WIDTH; k++) {
            uint32_t part = n * FL_BVH_WIDTH + k;
            float lo[3] = {INFINITY, INFINITY, INFINITY};
            float hi[3] = {-INFINITY, -INFINITY, -INFINITY};
            node->child[k] = part >= parts ? FL_NONE
                             : has_leaves  ? make_leaf(q, part, lo, hi)
                                           : bound_node(q, q->below.first + part, lo, hi);
            for (int a = 0; a < 3; a++) {
                node->plane[2 * a][k] = lo[a];
                node->plane[2 * a + 1][k] = hi[a];
            }
        }
    }
}

/* Level by level from the leaves, which stand last, to the root. */
static bool make_levels(quick *q, fl_arena *arena, fl_arena *item_arena, fl_pool *pool)
{
    fl_bvh *out = q->out;
    uint32_t counts[LEVELS_MAX], levels = 0;
    out->leaf_count = eighth(q->in->count);
    do {
        counts[levels] = eighth(levels ? counts[levels - 1] : out->leaf_count);
        out->node_count += counts[levels];
    } while (counts[levels++] > 1);
    out->nodes = fl_arena_alloc(arena, out->node_count, sizeof *out->nodes);
    out->items = fl_arena_alloc(item_arena, out->leaf_count, FL_BVH_WIDTH * sizeof *out->items);
    if (!out->nodes || !out->items)
        return false;
    q->own = (level){out->node_count, 0};
    for (uint32_t l = 0; l < levels; l++) {
        q->below = q->own;
        q->own = (level){q->below.first - counts[l], counts[l]};
        fl_parallel_for(pool, counts[l], 256, make_nodes, q);
    }
    return true;
}

bool fl_bvh_build_quick(fl_bvh *out_bvh, const fl_bvh_input *input, fl_arena *arena,
                        fl_arena *item_arena, fl_pool *pool)
{
    uint32_t count = input->count;
    FL_ASSERT(count >= 1);
    if (count > FL_BVH_ITEMS_MAX)
        return false;
    fl_bvh result = {.origin_pad = input->origin_pad};
    quick q = {.in = input, .out = &result};
    q.chunk_items = fl_max_u32((count + CHUNKS_MAX - 1) / CHUNKS_MAX, CHUNK_ITEMS_MIN);
    q.chunk_count = (count + q.chunk_items - 1) / q.chunk_items;
    q.keys = malloc(count * sizeof *q.keys);
    q.sorted = malloc(count * sizeof *q.sorted);
    q.chunks = aligned_alloc(_Alignof(chunk), q.chunk_count * sizeof *q.chunks);
    bool ok = q.keys && q.sorted && q.chunks;
    if (ok) {
        bound_centers(&q, pool);
        fl_parallel_for(pool, count, 16384, fill_keys, &q);
        sort_keys(&q, pool);
        ok = !fl_pool_is_cancelled(pool) && make_levels(&q, arena, item_arena, pool) &&
             !fl_pool_is_cancelled(pool);
    }
    free(q.keys);
    free(q.sorted);
    free(q.chunks);
    if (ok)
        *out_bvh = result;
    return ok;
}
