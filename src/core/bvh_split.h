/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to bvh: ranges of boxes, and cutting one in two.
 */
#ifndef FL_BVH_SPLIT_H
#define FL_BVH_SPLIT_H

#include "core/bvh.h"
#include "core/mesh.h"

/* x y z and one lane to spare, whatever the machine: the tree is the same everywhere. */
#define FL_W 4
#include "core/wide.h"

/** Corners as vectors; the fourth lane is free. */
typedef struct wide_box {
    fl_wf lo, hi;
} wide_box;

/** What is partitioned: boxes travel with their item, so every pass reads memory in order. */
typedef struct item {
    fl_wf lo; /**< Fourth: the item's number, as bits. */
    fl_wf hi; /**< Fourth: 0. */
} item;

/** Leaf indices have 28 bits. */
enum { FL_BVH_ITEMS_MAX = 1 << 28 };
_Static_assert((int)FL_FACES_MAX <= (int)FL_BVH_ITEMS_MAX, "every mesh that is read can be built");

typedef struct range {
    uint32_t first, count;
    wide_box box;
    wide_box centers; /**< Of lo + hi: twice the centres. */
} range;

/** Of the box in units of 1/unit: areas of boxes as large or small as floats go would leave their
 * range. With a power of two for `unit` all others are the same to the bit. */
FL_INLINE float box_half_area(const wide_box *box, float unit)
{
    fl_wf side = (box->hi - box->lo) * unit;
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

FL_INLINE uint32_t item_number(const item *it)
{
    return (uint32_t)((fl_wi)it->lo)[3];
}

/** Put `number` among the n ascending ones of a leaf; FL_NONE stays last. */
FL_INLINE void leaf_insert(uint32_t *leaf, uint32_t n, uint32_t number)
{
    for (; n > 0 && leaf[n - 1] > number; n--)
        leaf[n] = leaf[n - 1];
    leaf[n] = number;
}

/** A child that is leaf `leaf` of `count` items. */
FL_INLINE uint32_t leaf_child(uint32_t leaf, uint32_t count)
{
    return FL_BVH_LEAF | (count - 1) << 28 | leaf;
}

/** The power of two that brings the longest side of a box near 1. */
float fl_bvh_unit(const wide_box *box);

/** Items [first, first + count) with their bounds. */
range fl_bvh_range(const item *items, uint32_t first, uint32_t count);

/** Cut `r`, of two items or more, in two that are not empty: by the surface area heuristic in
 * 16 bins; by count when no plane separates the centres, or for is_halved. Reorders the items.
 * are_packed: as in fl_bvh_input. unit: of the whole tree, fl_bvh_unit. O(count). */
void fl_bvh_split(item *items, const range *r, float unit, bool are_packed, bool is_halved,
                  range *out_left, range *out_right);

#endif
