/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to bvh: binary trees of ranges, and how each node is best folded into nodes of
 * eight.
 */
#ifndef FL_BVH_PAIR_H
#define FL_BVH_PAIR_H

#include "core/bvh_split.h"

/** Deeper, ranges are halved by count: 28 more levels reach any size. */
enum { FL_BVH_SAH_DEPTH_MAX = 56 };

/** A node of the binary tree, with its cheapest forms. */
typedef struct pair {
    wide_box box;
    uint32_t first, count;           /* Of items. */
    uint32_t left, right;            /* left FL_NONE: not split. */
    float cost[FL_BVH_WIDTH + 1];    /* [n]: area of all nodes, as n children of another at most. */
    uint8_t share[FL_BVH_WIDTH + 1]; /* [n]: how many of the n come from the left; 0: as n - 1. */
    uint8_t own_left, own_right;     /* Children as a node of its own. */
} pair;

/** Binary nodes, children behind their parents. */
typedef struct pairs {
    pair *at;
    uint32_t count, capacity;
} pairs;

/** Room for `needed` items in *array, a pointer to memory from malloc or NULL; it may move. False:
 * out of memory, nothing changed. */
bool fl_bvh_reserve(void *array, uint32_t *capacity, uint32_t needed, size_t item_bytes);

/** A node that is not split; its number, or FL_NONE: out of memory. */
uint32_t fl_bvh_add_pair(pairs *p, const range *items);

/** Split down to ranges of FL_BVH_WIDTH items, reordering them; `depth` of the range itself, `unit`
 * as in fl_bvh_split. Returns the root or FL_NONE: out of memory. */
uint32_t fl_bvh_grow(pairs *p, item *items, const range *r, float unit, bool are_packed,
                     uint32_t depth);

/** The cheapest forms of a pair from those of its halves, which come first: among all ways to leave
 * out nodes of the binary tree the one whose nodes have the least area in all, for a walk visits
 * the fewest. Where areas are no numbers to compare, some form is chosen. */
void fl_bvh_fold(const pairs *p, pair *whole, float unit);

#endif
