/* SPDX-License-Identifier: MIT
 *
 * wide.h: every operation of every instruction set against plain C, bit for bit.
 */
#include "lane_check.h"

#include <math.h>
#include <stdlib.h>

enum { N = 3 << 16 };
#define SEED 0x51a5u

static float a[N], b[N], got[2 * N], want[2 * N];

static float plain(int op, float x, float y, float *out_second)
{
    double dx = (double)x, dy = (double)y;
    int32_t integer;
    memcpy(&integer, &x, sizeof integer);
    *out_second = 0.0f;
    switch (op) {
    case FL_WIDE_OP_min:
    case FL_WIDE_OP_select:
        return x < y ? x : y;
    case FL_WIDE_OP_max:
        return x > y ? x : y;
    case FL_WIDE_OP_sqrt:
        return sqrtf(x);
    case FL_WIDE_OP_floor:
        return floorf(x);
    case FL_WIDE_OP_abs:
        return fabsf(x);
    case FL_WIDE_OP_copysign:
        return copysignf(x, y);
    case FL_WIDE_OP_is_finite:
        return isfinite(x) ? 1.0f : 0.0f;
    case FL_WIDE_OP_from_int:
        return (float)integer;
    case FL_WIDE_OP_halves:
        *out_second = (float)sqrt(fabs(dx));
        return x;
    case FL_WIDE_OP_half_masks:
        return x < y ? 1.0f : 0.0f;
    default:
        *out_second = (float)(dx > dy ? dx : dy);
        return (float)(dx < dy ? dx : dy);
    }
}

static void test_ops_equal_plain_c(void **state)
{
    (void)state;
    print_message("seed %#x, %d operand pairs\n", SEED, N);
    test_operands(SEED, a, b, N);
    const fl_wide_table *table;
    for (int t = 0; (table = fl_wide_table_at(t)); t++) {
        for (int op = 0; op < FL_WIDE_OP_COUNT; op++) {
            table->ops[op].run(got, a, b, N);
            for (size_t i = 0; i < N; i++)
                want[i] = plain(op, a[i], b[i], &want[N + i]);
            assert_same_lanes(table->ops[op].name, table->width, got, want, a, b, N);
            if (table->ops[op].results == 2)
                assert_same_lanes(table->ops[op].name, table->width, got + N, want + N, a, b, N);
        }
    }
}

/* copysign and abs must also keep NaN bits: they only touch the sign. */
static void test_sign_operations_touch_only_the_sign(void **state)
{
    (void)state;
    test_operands(SEED + 1, a, b, N);
    const fl_wide_table *table;
    for (int t = 0; (table = fl_wide_table_at(t)); t++) {
        table->ops[FL_WIDE_OP_abs].run(got, a, b, N);
        for (size_t i = 0; i < N; i++)
            assert_int_equal(float_bits(got[i]), float_bits(a[i]) & 0x7fffffffu);
        table->ops[FL_WIDE_OP_copysign].run(got, a, b, N);
        for (size_t i = 0; i < N; i++)
            assert_int_equal(float_bits(got[i]),
                             (float_bits(a[i]) & 0x7fffffffu) | (float_bits(b[i]) & 0x80000000u));
    }
}

static void test_every_mask(void **state)
{
    (void)state;
    static const float lanes[8] = {10, 11, 12, 13, 14, 15, 16, 17};
    const fl_wide_table *table;
    for (int t = 0; (table = fl_wide_table_at(t)); t++) {
        uint32_t all = (1u << table->width) - 1u;
        for (uint32_t mask = 0; mask <= all; mask++) {
            uint32_t queries = table->mask_queries(mask);
            assert_int_equal(queries >> 16, mask);
            assert_int_equal(queries & 3u, (uint32_t)(mask != 0) << 1 | (uint32_t)(mask == all));

            float packed[8], stored[8] = {0};
            uint32_t count = table->pack(packed, lanes, mask), expected = 0;
            table->store_masked(stored, lanes, mask);
            for (uint32_t i = 0; i < table->width; i++) {
                bool is_set = mask >> i & 1u;
                assert_true(stored[i] == (is_set ? lanes[i] : 0.0f));
                if (is_set)
                    assert_true(packed[expected++] == lanes[i]);
            }
            assert_int_equal(count, expected);
        }
        for (uint32_t count = 0; count < 20; count++)
            assert_int_equal(table->first(count), (1u << fl_min_u32(count, table->width)) - 1u);
        assert_int_equal(table->first(UINT32_MAX), all);
    }
}

/* A masked store and a gather must not touch memory of their neighbours: exact heap blocks, so the
 * address sanitizer sees a slip. */
static void test_memory_bounds(void **state)
{
    (void)state;
    const fl_wide_table *table;
    for (int t = 0; (table = fl_wide_table_at(t)); t++) {
        for (uint32_t count = 1; count <= table->width; count++) {
            float *block = calloc(count, sizeof *block), out[8], lanes[8];
            assert_non_null(block);
            int32_t index[8];
            for (uint32_t i = 0; i < 8; i++) {
                lanes[i] = (float)i + 1.0f;
                index[i] = (int32_t)((i * 5u) % count);
            }
            table->store_masked(block, lanes, (1u << count) - 1u);
            table->gather(out, block, index);
            for (uint32_t i = 0; i < table->width; i++)
                assert_true(out[i] == (float)index[i] + 1.0f);
            free(block);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ops_equal_plain_c),
        cmocka_unit_test(test_sign_operations_touch_only_the_sign),
        cmocka_unit_test(test_every_mask),
        cmocka_unit_test(test_memory_bounds),
    };
    return cmocka_run_group_tests_name("wide", tests, NULL, NULL);
}
