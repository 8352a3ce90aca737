/* SPDX-License-Identifier: MIT
 *
 * Layer 3: octree by uniform subdivision: every cell is cut into eight equal ones, a box is listed
 * in every leaf that it overlaps, height at most 8. The classic structure of the
 * source project, kept beside the hierarchy of boxes to compare with.
 */
#ifndef FL_OCTREE_H
#define FL_OCTREE_H

#include "core/bvh.h"

enum { FL_OCTREE_HEIGHT_MAX = 8, FL_OCTREE_STACK_MAX = 7 * FL_OCTREE_HEIGHT_MAX + 1 };

/* A child is FL_NONE (an empty cell), an inner node's index, or FL_BVH_LEAF | leaf index. */
typedef struct fl_octree_node {
    /** Where its octants end along each axis, widened: the lower half from [0] to [2], the upper
     * one from [1] to [3]. Seen from the other side the same holds of 3 - k. */
    float plane[3][4];
    uint32_t child[8]; /**< Bit 0: upper half in x; bit 1: y; bit 2: z. */
} fl_octree_node;

/** Its items are items[first .. first + count), ascending. */
typedef struct fl_octree_leaf {
    uint32_t first, count;
    uint32_t first_pack; /**< For whoever lays out packs of eight, leaf after leaf. */
} fl_octree_leaf;

typedef struct fl_octree {
    fl_octree_node *nodes;
    fl_octree_leaf *leaves;
    uint32_t *items;
    uint32_t root; /**< A child as above. */
    uint32_t node_count, leaf_count, item_count, pack_count;
    float lo[3], size[3]; /**< The root's cell, not widened. */
} fl_octree;

/** Build over boxes[0 .. count), count >= 1, in cells widened by `pad`. Cells are cut as long as
 * the surface area heuristic calls that cheaper; listings stay below 32 a box. False: out of
 * memory. O(n * height). */
bool fl_octree_build(fl_octree *out_octree, fl_arena *arena, const fl_bvh_box *boxes,
                     uint32_t count, uint32_t height, float pad);

#endif
