/* SPDX-License-Identifier: MIT */
#include "core/bvh_pair.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool fl_bvh_reserve(void *array, uint32_t *capacity, uint32_t needed, size_t item_bytes)
{
    void *old;
    memcpy(&old, array, sizeof old);
    if (needed <= *capacity)
        return true;
    uint32_t grown = fl_max_u32(2 * *capacity, fl_max_u32(needed, 64));
    void *moved = realloc(old, grown * item_bytes);
    if (!moved)
        return false;
    memcpy(array, &moved, sizeof moved);
    *capacity = grown;
    return true;
}

uint32_t fl_bvh_add_pair(pairs *p, const range *items)
{
    if (!fl_bvh_reserve(&p->at, &p->capacity, p->count + 1, sizeof *p->at))
        return FL_NONE;
    p->at[p->count] = (pair){.box = items->box,
                             .first = items->first,
                             .count = items->count,
                             .left = FL_NONE,
                             .right = FL_NONE};
    return p->count++;
}

/* Depth is bounded, so recursion is. */
uint32_t fl_bvh_grow(pairs *p, item *items, const range *r, float unit, bool are_packed,
                     uint32_t depth)
{
    range left, right;
    uint32_t k = fl_bvh_add_pair(p, r);
    if (k == FL_NONE || r->count <= FL_BVH_WIDTH)
        return k;
    fl_bvh_split(items, r, unit, are_packed, depth >= FL_BVH_SAH_DEPTH_MAX, &left, &right);
    uint32_t first = fl_bvh_grow(p, items, &left, unit, are_packed, depth + 1);
    uint32_t second =
        first == FL_NONE ? FL_NONE : fl_bvh_grow(p, items, &right, unit, are_packed, depth + 1);
    if (second == FL_NONE)
        return FL_NONE;
    p->at[k].left = first;
    p->at[k].right = second;
    return k;
}

void fl_bvh_fold(const pairs *p, pair *whole, float unit)
{
    if (whole->left == FL_NONE)
        return;
    const float *l = p->at[whole->left].cost, *r = p->at[whole->right].cost;
    float best = INFINITY;
    for (uint8_t n = 2; n <= FL_BVH_WIDTH; n++) {
        for (uint8_t k = 1; k < n; k++)
            if (n == 2 || l[k] + r[n - k] < best) {
                best = l[k] + r[n - k];
                whole->share[n] = k;
                whole->own_left = k;
                whole->own_right = (uint8_t)(n - k);
            }
        whole->cost[n] = best;
    }
    whole->cost[1] = best + box_half_area(&whole->box, unit);
    for (int n = 2; n <= FL_BVH_WIDTH; n++)
        if (whole->cost[1] <= whole->cost[n]) {
            whole->cost[n] = whole->cost[1];
            whole->share[n] = 0;
        }
}
