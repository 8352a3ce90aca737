/* SPDX-License-Identifier: MIT */
#include "core/bvh_split.h"

#include <math.h>
#include <string.h>

enum { BIN_COUNT = 16 };

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

float fl_bvh_unit(const wide_box *box)
{
    fl_wf side = box->hi - box->lo;
    float longest = side[0] > side[1] ? side[0] : side[1];
    longest = side[2] > longest ? side[2] : longest;
    int exponent = 0;
    frexpf(longest, &exponent);
    return ldexpf(1.0f, exponent < -126 ? 126 : -exponent);
}

range fl_bvh_range(const item *items, uint32_t first, uint32_t count)
{
    range r = {first, count, box_empty(), box_empty()};
    for (uint32_t i = first; i < first + count; i++)
        range_grow(&r, &items[i]);
    return r;
}

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

/* What a box with so many items costs. Of packed ones a single ray tests eight at a time, but rays
 * that stay together test one after the other. */
static inline float side_cost(const wide_box *box, uint32_t count, float unit, bool are_packed)
{
    uint32_t packs = are_packed ? (count + FL_BVH_WIDTH - 1) / FL_BVH_WIDTH : 0;
    return box_half_area(box, unit) * (float)(FL_BVH_WIDTH * packs + count);
}

static void try_axis(const bins *b, int axis, float unit, bool are_packed, split *best)
{
    float right_cost[BIN_COUNT];
    wide_box box = box_empty();
    uint32_t count = 0;
    for (int i = BIN_COUNT - 1; i > 0; i--) {
        box_grow(&box, b->box[i].lo, b->box[i].hi);
        count += b->count[i];
        right_cost[i] = count ? side_cost(&box, count, unit, are_packed) : 0.0f;
    }
    uint32_t total = count + b->count[0];
    box = box_empty();
    count = 0;
    for (int i = 1; i < BIN_COUNT; i++) {
        box_grow(&box, b->box[i - 1].lo, b->box[i - 1].hi);
        count += b->count[i - 1];
        if (count == 0 || count == total)
            continue;
        float cost = side_cost(&box, count, unit, are_packed) + right_cost[i];
        if (cost < best->cost)
            *best = (split){axis, i, cost};
    }
}

static split find_split(const item *items, const range *r, float unit, bool are_packed)
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
            try_axis(&b[a], a, unit, are_packed, &best);
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

void fl_bvh_split(item *items, const range *r, float unit, bool are_packed, bool is_halved,
                  range *out_left, range *out_right)
{
    split best = {-1, 0, INFINITY};
    if (!is_halved)
        best = find_split(items, r, unit, are_packed);
    if (best.axis >= 0) {
        partition(items, r, &best, out_left, out_right);
        return;
    }
    uint32_t left = r->count / 2;
    *out_left = fl_bvh_range(items, r->first, left);
    *out_right = fl_bvh_range(items, r->first + left, r->count - left);
}
