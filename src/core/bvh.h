/* SPDX-License-Identifier: MIT
 *
 * Layer 3: bounding volume hierarchy with eight children a node, over any boxes: a binary tree by
 * the surface area heuristic [Wald 2007], folded into nodes of eight whose area in all is least;
 * or, quickly, what follows in the order of a curve through space.
 * The tree depends on the boxes alone, never on the thread count.
 */
#ifndef FL_BVH_H
#define FL_BVH_H

#include "core/arena.h"
#include "core/pool.h"

enum {
    FL_BVH_WIDTH = 8, /**< Children a node, and items a leaf at most. */
    FL_BVH_STACK_MAX =
        640 /**< Entries that a depth-first walk can need: (width - 1) * depth + 1. */
};

/* A child is FL_NONE (absent), an inner node's index, or a leaf: flag, items - 1, leaf index. */
#define FL_BVH_LEAF          0x80000000u
#define FL_BVH_LEAF_INDEX(c) ((c)&0x0fffffffu)
#define FL_BVH_LEAF_COUNT(c) ((((c) >> 28) & 7u) + 1u)

/** Boxes of the children as planes: lo x, hi x, lo y, hi y, lo z, hi z. An absent child's box is
 *  inside out (+inf, -inf), so that no ray enters it. */
typedef struct fl_bvh_node {
    float plane[6][FL_BVH_WIDTH];
    uint32_t child[FL_BVH_WIDTH];
    uint32_t has_leaf;                 /**< 1 if any child is a leaf. */
    uint32_t unused[FL_BVH_WIDTH - 1]; /**< To four cache lines. */
} fl_bvh_node;

/** Node 0 is the root. Leaf k holds items[8 k] and on, in ascending order; unused places are
 * FL_NONE. */
typedef struct fl_bvh {
    fl_bvh_node *nodes;
    uint32_t *items;
    uint32_t node_count, leaf_count;
    float origin_pad; /**< A walk widens all boxes by this times the largest coordinate of the
                         origin. */
} fl_bvh;

/** lo <= hi, finite. */
typedef struct fl_bvh_box {
    float lo[3], hi[3];
} fl_bvh_box;

/** What a hierarchy is built from. */
typedef struct fl_bvh_input {
    const fl_bvh_box *boxes;
    uint32_t count;   /**< >= 1. */
    float pad;        /**< Every box is widened by this on all sides as it is stored. */
    float origin_pad; /**< Passed on. */
    bool are_packed;  /**< A ray tests the items of a leaf all at once, rather than one by one. */
} fl_bvh_input;

/** Build; nodes come from `arena`, items from `item_arena`. False: out of memory, more than 2^28
 * boxes, or the pool was cancelled. O(n log n). */
bool fl_bvh_build(fl_bvh *out_bvh, const fl_bvh_input *input, fl_arena *arena, fl_arena *item_arena,
                  fl_pool *pool);

/** The same, several times as fast; rays then take about half as long again. O(n). */
bool fl_bvh_build_quick(fl_bvh *out_bvh, const fl_bvh_input *input, fl_arena *arena,
                        fl_arena *item_arena, fl_pool *pool);

#endif
