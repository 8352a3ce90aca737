/* SPDX-License-Identifier: MIT */
#include "core/bvh.h"
#include "core/octree.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t next_bits(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return *state >> 33;
}

static float unit(uint64_t *state)
{
    return (float)(next_bits(state) & 0xffffff) * 0x1p-24f;
}

static fl_bvh_box *random_boxes(uint32_t count, uint64_t seed, float size)
{
    fl_bvh_box *boxes = malloc(count * sizeof *boxes);
    assert_non_null(boxes);
    for (uint32_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            boxes[i].lo[a] = unit(&seed);
            boxes[i].hi[a] = boxes[i].lo[a] + size * unit(&seed);
        }
    return boxes;
}

typedef struct census {
    const fl_bvh *bvh;
    const fl_bvh_box *boxes;
    float pad;
    uint8_t *seen;
    uint32_t items, depth;
} census;

/* Every item below slot k of `node` lies in the slot's box; every leaf is ascending. */
static void visit(census *c, uint32_t child, const float lo[3], const float hi[3], uint32_t depth)
{
    c->depth = depth > c->depth ? depth : c->depth;
    if (child & FL_BVH_LEAF) {
        const uint32_t *items = c->bvh->items + 8 * (size_t)FL_BVH_LEAF_INDEX(child);
        assert_true(FL_BVH_LEAF_INDEX(child) < c->bvh->leaf_count);
        for (uint32_t i = 0; i < 8; i++) {
            if (i >= FL_BVH_LEAF_COUNT(child)) {
                assert_int_equal(items[i], FL_NONE);
                continue;
            }
            assert_false(c->seen[items[i]]);
            assert_true(i == 0 || items[i - 1] < items[i]);
            c->seen[items[i]] = 1;
            c->items++;
            for (int a = 0; a < 3; a++) {
                assert_true(c->boxes[items[i]].lo[a] - c->pad >= lo[a]);
                assert_true(c->boxes[items[i]].hi[a] + c->pad <= hi[a]);
            }
        }
        return;
    }
    assert_true(child < c->bvh->node_count);
    const fl_bvh_node *node = &c->bvh->nodes[child];
    for (int k = 0; k < 8; k++) {
        float sub_lo[3], sub_hi[3];
        for (int a = 0; a < 3; a++) {
            sub_lo[a] = node->plane[2 * a][k];
            sub_hi[a] = node->plane[2 * a + 1][k];
        }
        if (node->child[k] == FL_NONE) {
            assert_true(sub_lo[0] > sub_hi[0]);
            continue;
        }
        for (int a = 0; a < 3; a++)
            assert_true(sub_lo[a] >= lo[a] && sub_hi[a] <= hi[a]);
        visit(c, node->child[k], sub_lo, sub_hi, depth + 1);
    }
}

static uint32_t check_tree(const fl_bvh *bvh, const fl_bvh_box *boxes, uint32_t count, float pad)
{
    static const float lo[3] = {-INFINITY, -INFINITY, -INFINITY};
    static const float hi[3] = {INFINITY, INFINITY, INFINITY};
    census c = {bvh, boxes, pad, calloc(count, 1), 0, 0};
    assert_non_null(c.seen);
    visit(&c, 0, lo, hi, 0);
    assert_int_equal(c.items, count);
    free(c.seen);
    return c.depth;
}

static bool build(fl_bvh *out, fl_arena *arena, const fl_bvh_box *boxes, uint32_t count, float pad,
                  bool are_packed, fl_pool *pool)
{
    const fl_bvh_input input = {boxes, count, pad, 0.5f, are_packed};
    return fl_bvh_build(out, &input, arena, arena, pool);
}

/* The quick tree: full leaves and nodes, the same for any number of threads, and leaves that are
 * small where boxes are many. */
static void quick_trees_are_full(void **state)
{
    static const uint32_t counts[] = {1, 2, 7, 8, 9, 64, 65, 513, 20000, 140000};
    (void)state;
    for (size_t k = 0; k < FL_COUNT_OF(counts); k++) {
        fl_bvh_box *boxes = random_boxes(counts[k], 7 + k, 0.001f);
        const fl_bvh_input input = {boxes, counts[k], 0.01f, 0.5f, true};
        fl_arena arenas[2] = {{0}};
        fl_bvh trees[2];
        fl_diags diags = {0};
        fl_pool *pools[2] = {NULL, fl_pool_create(3, &diags)};
        for (int t = 0; t < 2; t++) {
            assert_true(fl_bvh_build_quick(&trees[t], &input, &arenas[t], &arenas[t], pools[t]));
            assert_true(trees[t].origin_pad == 0.5f);
        }
        check_tree(&trees[0], boxes, counts[k], 0.01f);
        assert_int_equal(trees[0].leaf_count, (counts[k] + 7) / 8);
        assert_true(trees[0].node_count <= trees[0].leaf_count / 7 + 8);
        assert_int_equal(trees[1].node_count, trees[0].node_count);
        assert_memory_equal(trees[1].nodes, trees[0].nodes,
                            trees[0].node_count * sizeof *trees[0].nodes);
        assert_memory_equal(trees[1].items, trees[0].items,
                            trees[0].leaf_count * 8 * sizeof *trees[0].items);
        if (counts[k] == 140000) { /* 17,500 leaves in a unit cube: sides of 1/26 if cubes. */
            const fl_bvh_node *last = &trees[0].nodes[trees[0].node_count - 1];
            float side = last->plane[1][0] - last->plane[0][0];
            assert_true(last->has_leaf && side < 0.15f);
        }
        fl_pool_destroy(pools[1]);
        fl_arena_deinit(&arenas[0]);
        fl_arena_deinit(&arenas[1]);
        free(boxes);
    }
}

static void every_box_is_held_once(void **state)
{
    static const uint32_t counts[] = {1, 2, 7, 8, 9, 64, 65, 1000, 20000};
    (void)state;
    for (size_t k = 0; k < FL_COUNT_OF(counts); k++) {
        fl_bvh_box *boxes = random_boxes(counts[k], 7 + k, 0.05f);
        fl_arena arena = {0};
        fl_bvh bvh;
        assert_true(build(&bvh, &arena, boxes, counts[k], 0.01f, k % 2 == 0, NULL));
        assert_true(bvh.origin_pad == 0.5f);
        check_tree(&bvh, boxes, counts[k], 0.01f);
        if (counts[k] >= 1000) /* Nodes are well filled. */
            assert_true(bvh.node_count - 1 + bvh.leaf_count >= 5 * bvh.node_count);
        fl_arena_deinit(&arena);
        free(boxes);
    }
}

static void threads_do_not_change_the_tree(void **state)
{
    enum { COUNT = 30000 };
    (void)state;
    fl_bvh_box *boxes = random_boxes(COUNT, 99, 0.01f);
    fl_bvh trees[3];
    fl_arena arenas[3] = {{0}};
    for (uint32_t k = 0; k < 3; k++) {
        fl_diags diags = {0};
        fl_pool *pool = fl_pool_create(k + 1, &diags);
        assert_non_null(pool);
        assert_true(build(&trees[k], &arenas[k], boxes, COUNT, 0.0f, true, pool));
        fl_pool_destroy(pool);
        assert_int_equal(trees[k].node_count, trees[0].node_count);
        assert_int_equal(trees[k].leaf_count, trees[0].leaf_count);
        assert_memory_equal(trees[k].nodes, trees[0].nodes,
                            trees[0].node_count * sizeof *trees[0].nodes);
        assert_memory_equal(trees[k].items, trees[0].items,
                            trees[0].leaf_count * 8 * sizeof *trees[0].items);
    }
    for (int k = 0; k < 3; k++)
        fl_arena_deinit(&arenas[k]);
    free(boxes);
}

/* Areas of boxes near the ends of floats would be 0 or infinite: the tree is that of the same boxes
 * of ordinary size. */
static void size_does_not_change_the_tree(void **state)
{
    enum { COUNT = 5000 };
    static const int exponents[] = {61, 120, -40, -60};
    (void)state;
    fl_bvh_box *boxes = random_boxes(COUNT, 5, 0.3f), *scaled = malloc(COUNT * sizeof *scaled);
    assert_non_null(scaled);
    fl_arena arena = {0};
    fl_bvh want, tree;
    assert_true(build(&want, &arena, boxes, COUNT, 0.0f, true, NULL));
    for (size_t k = 0; k < FL_COUNT_OF(exponents); k++) {
        for (uint32_t i = 0; i < COUNT; i++)
            for (int a = 0; a < 3; a++) {
                scaled[i].lo[a] = ldexpf(boxes[i].lo[a], exponents[k]);
                scaled[i].hi[a] = ldexpf(boxes[i].hi[a], exponents[k]);
            }
        assert_true(build(&tree, &arena, scaled, COUNT, 0.0f, true, NULL));
        check_tree(&tree, scaled, COUNT, 0.0f);
        assert_int_equal(tree.node_count, want.node_count);
        assert_int_equal(tree.leaf_count, want.leaf_count);
        assert_memory_equal(tree.items, want.items, want.leaf_count * 8 * sizeof *want.items);
    }
    fl_arena_deinit(&arena);
    free(scaled);
    free(boxes);
}

/* One box without end over thousands of small ones: each way to fold the pairs above it costs the
 * same. */
static void boxes_without_end_are_held(void **state)
{
    enum { COUNT = 3000 };
    (void)state;
    fl_bvh_box *boxes = random_boxes(COUNT, 3, 0.01f);
    for (uint32_t i = 0; i < 40; i++)
        for (int a = 0; a < 3; a++) {
            boxes[70 * i].lo[a] = -1e37f;
            boxes[70 * i].hi[a] = 1e37f;
        }
    fl_arena arena = {0};
    fl_bvh bvh;
    assert_true(build(&bvh, &arena, boxes, COUNT, 1e30f, false, NULL));
    check_tree(&bvh, boxes, COUNT, 1e30f);
    fl_arena_deinit(&arena);
    free(boxes);
}

/* Equal boxes cannot be told apart, and ever smaller ones invite a tree as deep as there are boxes.
 */
static void degenerate_boxes_stay_shallow(void **state)
{
    enum { COUNT = 20000 };
    (void)state;
    fl_bvh_box *boxes = calloc(COUNT, sizeof *boxes);
    assert_non_null(boxes);
    for (int kind = 0; kind < 3; kind++) {
        float x = 1.0f;
        for (uint32_t i = 0; i < COUNT; i++) {
            x = i % 200 == 0 ? 1.0f : x * 0.7f;
            for (int a = 0; a < 3; a++) {
                boxes[i].lo[a] = kind == 0 ? 1.0f : kind == 1 ? x : -x;
                boxes[i].hi[a] = kind == 0 ? 1.0f : x;
            }
        }
        fl_arena arena = {0};
        fl_bvh bvh;
        assert_true(build(&bvh, &arena, boxes, COUNT, 0.0f, true, NULL));
        uint32_t depth = check_tree(&bvh, boxes, COUNT, 0.0f);
        assert_true((FL_BVH_WIDTH - 1) * depth + 1 <= FL_BVH_STACK_MAX);
        fl_arena_deinit(&arena);
    }
    free(boxes);
}

typedef struct octree_census {
    const fl_octree *tree;
    const fl_bvh_box *boxes;
    uint32_t count;
    float pad;
} octree_census;

/* A leaf lists exactly the widened boxes that overlap its cell, in ascending order. */
static void visit_cell(const octree_census *c, uint32_t child, const float lo[3],
                       const float size[3])
{
    if (child != FL_NONE && !(child & FL_BVH_LEAF)) {
        const fl_octree_node *node = &c->tree->nodes[child];
        for (uint32_t k = 0; k < 8; k++) {
            float sub_lo[3], half[3];
            for (int a = 0; a < 3; a++) {
                uint32_t is_upper = k >> a & 1u;
                half[a] = 0.5f * size[a];
                sub_lo[a] = is_upper ? lo[a] + half[a] : lo[a];
                assert_true(node->plane[a][is_upper] == sub_lo[a] - c->pad);
                assert_true(node->plane[a][is_upper + 2] == sub_lo[a] + half[a] + c->pad);
            }
            visit_cell(c, node->child[k], sub_lo, half);
        }
        return;
    }
    const fl_octree_leaf *leaf = child == FL_NONE ? NULL : &c->tree->leaves[child & ~FL_BVH_LEAF];
    uint32_t found = 0;
    for (uint32_t i = 0; i < c->count; i++) {
        bool overlaps = true;
        for (int a = 0; a < 3; a++)
            overlaps &= c->boxes[i].lo[a] - c->pad <= lo[a] + size[a] &&
                        c->boxes[i].hi[a] + c->pad >= lo[a];
        if (overlaps) {
            assert_non_null(leaf);
            assert_true(found < leaf->count);
            assert_int_equal(c->tree->items[leaf->first + found], i);
            found++;
        }
    }
    assert_int_equal(found, leaf ? leaf->count : 0);
}

static void octree_leaves_list_what_overlaps(void **state)
{
    static const uint32_t counts[] = {1, 8, 9, 300, 1500};
    (void)state;
    for (size_t k = 0; k < FL_COUNT_OF(counts); k++)
        for (uint32_t height = 1; height <= 4; height += 3) {
            fl_bvh_box *boxes = random_boxes(counts[k], 40 + k, 0.1f);
            fl_arena arena = {0};
            fl_octree tree;
            assert_true(fl_octree_build(&tree, &arena, boxes, counts[k], height, 1e-4f));
            octree_census c = {&tree, boxes, counts[k], 1e-4f};
            visit_cell(&c, tree.root, tree.lo, tree.size);
            if (counts[k] == 1500 && height == 4)
                assert_true(tree.node_count > 1);
            fl_arena_deinit(&arena);
            free(boxes);
        }
}

/* Large boxes overlap nearly every cell: cutting must give up before memory does. */
static void octree_of_overlapping_boxes_stays_small(void **state)
{
    enum { COUNT = 5000 };
    (void)state;
    fl_bvh_box *boxes = random_boxes(COUNT, 3, 1.0f);
    fl_arena arena = {0};
    fl_octree tree;
    assert_true(fl_octree_build(&tree, &arena, boxes, COUNT, 8, 0.0f));
    assert_true(tree.item_count <= 32u * COUNT);
    fl_arena_deinit(&arena);
    free(boxes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quick_trees_are_full),
        cmocka_unit_test(every_box_is_held_once),
        cmocka_unit_test(threads_do_not_change_the_tree),
        cmocka_unit_test(size_does_not_change_the_tree),
        cmocka_unit_test(boxes_without_end_are_held),
        cmocka_unit_test(degenerate_boxes_stay_shallow),
        cmocka_unit_test(octree_leaves_list_what_overlaps),
        cmocka_unit_test(octree_of_overlapping_boxes_stays_small),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
