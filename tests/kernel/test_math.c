/* SPDX-License-Identifier: MIT
 *
 * Elementary functions: special values, and the same bits in every lane, instruction set and
 * compiler.
 */
#include "lane_check.h"

#include <math.h>
#include <time.h>

#include "core/math64.h"

enum { N = 3 << 16 };
#define SEED 0x3a7bu

static float a[N], b[N], got[2 * N], want[2 * N];

/* --- special values -------------------------------------------------------------------------- */

static void assert_sincos_deg(double degrees, double sine, double cosine)
{
    double s, c;
    fl_d_sincos_deg(degrees, &s, &c);
    assert_true(s == sine && c == cosine);
    fl_d_sincos_turns(degrees / 360.0, &s, &c);
    assert_true(s == sine && c == cosine);
}

static void test_exact_angles(void **state)
{
    (void)state;
    for (int turn = -3; turn <= 3; turn++) {
        assert_sincos_deg(360.0 * turn, 0.0, 1.0);
        assert_sincos_deg(360.0 * turn + 90.0, 1.0, 0.0);
        assert_sincos_deg(360.0 * turn + 180.0, 0.0, -1.0);
        assert_sincos_deg(360.0 * turn + 270.0, -1.0, 0.0);
    }
    assert_true(isinf(fl_d_tan_deg(90.0)));
    assert_true(fl_d_tan_deg(0.0) == 0.0);
    assert_true(fabs(fl_d_tan_deg(45.0) - 1.0) <= 0x1p-52);
    assert_true(fabs(fl_d_tan_deg(30.0) * sqrt(3.0) - 1.0) <= 0x1p-51);
}

static void test_atan2_quadrants(void **state)
{
    (void)state;
    static const struct {
        float y, x, angle;
    } cases[] = {
        {0.0f, 1.0f, 0.0f},
        {-0.0f, 1.0f, -0.0f},
        {0.0f, 0.0f, 0.0f},
        {0.0f, -1.0f, 0x1.921fb6p1f},
        {-0.0f, -1.0f, -0x1.921fb6p1f},
        {-0.0f, 0.0f, -0.0f},
        {1.0f, 0.0f, 0x1.921fb6p0f},
        {-1.0f, 0.0f, -0x1.921fb6p0f},
        {0.0f, -0.0f, 0x1.921fb6p1f},
        {1.0f, 1.0f, 0x1.921fb6p-1f},
        {1.0f, INFINITY, 0.0f},
        {INFINITY, 1.0f, 0x1.921fb6p0f},
        {0x1p-149f, 0x1p-149f, 0x1.921fb6p-1f},
        {0x1p127f, 0x1p127f, 0x1.921fb6p-1f},
    };
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        float angle = fl_f_atan2(cases[i].y, cases[i].x);
        assert_int_equal(float_bits(angle), float_bits(cases[i].angle));
    }
    assert_true(isnan(fl_f_atan2(NAN, 1.0f)) && isnan(fl_f_atan2(1.0f, NAN)));
    assert_true(isnan(fl_f_atan2(INFINITY, INFINITY)));
}

static void test_powers(void **state)
{
    (void)state;
    assert_true(fl_f_pow(0.0f, 0.0f) == 1.0f && fl_f_pow(INFINITY, 0.0f) == 1.0f);
    assert_true(fl_f_pow(0.0f, 1e-30f) == 0.0f && fl_f_pow(0.0f, 1e6f) == 0.0f);
    assert_true(isnan(fl_f_pow(-1.0f, 2.0f)) && isnan(fl_f_pow(NAN, 0.0f)));
    assert_true(isnan(fl_f_pow(0.5f, NAN)));
    assert_true(isinf(fl_f_log2(0.0f)) && isnan(fl_f_log2(-1.0f)) && isnan(fl_f_log2(NAN)));
    assert_true(fl_f_exp2(-INFINITY) == 0.0f && isinf(fl_f_exp2(INFINITY)) &&
                isnan(fl_f_exp2(NAN)));
    for (int k = -149; k < 128; k++) {
        assert_true(fl_f_log2(ldexpf(1.0f, k)) == (float)k);
        assert_true(fl_f_exp2((float)k) == ldexpf(1.0f, k));
    }
    for (uint32_t i = 0; i < 100000; i++) {
        float x = test_unit(SEED, i), y = test_unit(SEED + 1, i) * 1e6f;
        assert_true(fl_f_pow(x, 1.0f) == x);
        assert_true(fl_f_pow(x, 0.0f) == 1.0f && fl_f_pow(1.0f, y) == 1.0f);
        assert_true(fl_f_pow(x, y) >= 0.0f && fl_f_pow(x, y) <= 1.0f);
    }
}

/* Within an eighth of a turn there is nothing to reduce: the short way has the same bits. */
static void test_eighths(void **state)
{
    (void)state;
    for (uint32_t i = 0; i <= 1u << 20; i++) {
        float x = (float)i / (float)(1u << 23), s[4], c[4];
        fl_f_sincos_turns(x, &s[0], &c[0]);
        fl_f_sincos_eighth(x, &s[1], &c[1]);
        fl_f_sincos_turns(-x, &s[2], &c[2]);
        fl_f_sincos_eighth(-x, &s[3], &c[3]);
        assert_memory_equal(&s[0], &s[1], sizeof s[0]);
        assert_memory_equal(&c[0], &c[1], sizeof c[0]);
        assert_memory_equal(&s[2], &s[3], sizeof s[2]);
        assert_memory_equal(&c[2], &c[3], sizeof c[2]);
    }
}

static void test_clamps(void **state)
{
    (void)state;
    assert_true(fl_f_acos(1.5f) == 0.0f && fl_f_acos(1.0f) == 0.0f);
    assert_true(fl_f_acos(-1.5f) == 0x1.921fb6p1f && fl_f_acos(0.0f) == 0x1.921fb6p0f);
    assert_true(isnan(fl_f_acos(NAN)));
    assert_true(fl_f_srgb_encode(-1.0f) == 0.0f && fl_f_srgb_encode(NAN) == 0.0f);
    assert_true(fl_f_srgb_encode(1.0f) == 1.0f && fl_f_srgb_encode(INFINITY) == 1.0f);
    assert_true(fl_f_srgb_decode(0.0f) == 0.0f && fl_f_srgb_decode(1.0f) == 1.0f);
    for (int i = 0; i < 256; i++) { /* bytes survive the way to linear and back */
        float back = fl_f_srgb_encode(fl_f_srgb_decode((float)i / 255.0f));
        assert_int_equal((int)floorf(back * 255.0f + 0.5f), i);
    }
}

/* A brighter pixel never becomes a darker one, in 16 bits (or 8). In floats the standard's
 * constants leave one step down, of 5e-8 at 0.0031308, where its two pieces meet. */
static void test_srgb_is_monotone(void **state)
{
    (void)state;
    float encoded = 0.0f, decoded = 0.0f;
    for (uint32_t bits = 0; bits <= 0x3f800000u; bits += 61) {
        float x = float_from_bits(bits), next = fl_f_srgb_encode(x);
        assert_true(next >= encoded || (next * 65535.0f > 2650.6f && encoded * 65535.0f < 2651.4f));
        encoded = next;
        next = fl_f_srgb_decode(x);
        assert_true(next >= decoded);
        decoded = next;
    }
}

/* --- the same bits everywhere ---------------------------------------------------------------- */

static void scalar_math(int op, float x, float y, float *out, float *out_second)
{
    switch (op) {
    case FL_WIDE_OP_sincos:
        fl_f_sincos(x, out, out_second);
        break;
    case FL_WIDE_OP_sincos_turns:
        fl_f_sincos_turns(x, out, out_second);
        break;
    case FL_WIDE_OP_atan2:
        *out = fl_f_atan2(x, y);
        break;
    case FL_WIDE_OP_pow:
        *out = fl_f_pow(x, y);
        break;
    case FL_WIDE_OP_acos:
        *out = fl_f_acos(x);
        break;
    case FL_WIDE_OP_log2:
        *out = fl_f_log2(x);
        break;
    case FL_WIDE_OP_exp2:
        *out = fl_f_exp2(x);
        break;
    case FL_WIDE_OP_srgb_encode:
        *out = fl_f_srgb_encode(x);
        break;
    default:
        *out = fl_f_srgb_decode(x);
        break;
    }
}

/* Hashes of the results over the operands below, so that builds of other compilers and machines are
 * held to the same bits: gcc 12 and clang 14 on x86-64 and AArch64 give these. */
static const uint32_t pinned[FL_WIDE_MATH_OP_COUNT] = {
    [FL_WIDE_OP_sincos] = 0xb678c008,      [FL_WIDE_OP_sincos_turns] = 0x4e1c13c0,
    [FL_WIDE_OP_atan2] = 0x3d7dc15e,       [FL_WIDE_OP_pow] = 0xe767b029,
    [FL_WIDE_OP_acos] = 0x7e1a38a7,        [FL_WIDE_OP_log2] = 0x57dfe0f7,
    [FL_WIDE_OP_exp2] = 0x80c10bed,        [FL_WIDE_OP_srgb_encode] = 0x0dfcd055,
    [FL_WIDE_OP_srgb_decode] = 0x92149a75,
};

static void test_lanes_equal_scalars_and_pins(void **state)
{
    (void)state;
    print_message("seed %#x, %d operand pairs\n", SEED, N);
    test_operands(SEED, a, b, N);
    for (int op = 0; op < FL_WIDE_MATH_OP_COUNT; op++) {
        memset(want, 0, sizeof want);
        for (size_t i = 0; i < N; i++)
            scalar_math(op, a[i], b[i], &want[i], &want[N + i]);
        const fl_wide_table *table;
        for (int t = 0; (table = fl_wide_table_at(t)); t++) {
            memset(got, 0, sizeof got);
            table->math[op].run(got, a, b, N);
            assert_same_lanes(table->math[op].name, table->width, got, want, a, b, N);
            assert_same_lanes(table->math[op].name, table->width, got + N, want + N, a, b, N);
        }
        uint32_t hash = hash_floats(2166136261u, want, FL_COUNT_OF(want));
        if (hash != pinned[op])
            fail_msg("%s: results hash to 0x%08x, should be 0x%08x",
                     fl_wide_table_scalar.math[op].name, hash, pinned[op]);
    }
}

/* Cost, printed and not asserted. */
static void test_print_cost(void **state)
{
    (void)state;
    const fl_wide_table *table;
    for (size_t i = 0; i < N; i++) {
        a[i] = test_unit(SEED, (uint32_t)(2 * i));
        b[i] = test_unit(SEED, (uint32_t)(2 * i + 1)) * 100.0f;
    }
    for (int t = 0; (table = fl_wide_table_at(t)); t++) {
        print_message("width %u, ns a value:", table->width);
        for (int op = 0; op < FL_WIDE_MATH_OP_COUNT; op++) {
            clock_t begin = clock();
            for (int round = 0; round < 20; round++)
                table->math[op].run(got, a, b, N);
            double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
            print_message(" %s %.2f", table->math[op].name, seconds * 1e9 / (20.0 * N));
        }
        print_message("\n");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact_angles),
        cmocka_unit_test(test_atan2_quadrants),
        cmocka_unit_test(test_powers),
        cmocka_unit_test(test_eighths),
        cmocka_unit_test(test_clamps),
        cmocka_unit_test(test_srgb_is_monotone),
        cmocka_unit_test(test_lanes_equal_scalars_and_pins),
        cmocka_unit_test(test_print_cost),
    };
    return cmocka_run_group_tests_name("math", tests, NULL, NULL);
}
