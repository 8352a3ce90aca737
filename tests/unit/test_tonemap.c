/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/kernel_tonemap.h"
#include "core/tonemap.h"

enum { COUNT = 4096 };

static float float_of(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint8_t one(float x, double ev, bool truncates)
{
    uint8_t rgba[4];
    float rgb[3] = {x, x, x};
    fl_tonemap_rgba8(&(fl_tonemap){ev, truncates}, rgb, 1, rgba);
    assert_true(rgba[0] == rgba[1] && rgba[1] == rgba[2] && rgba[3] == 255);
    return rgba[0];
}

/* IEC 61966-2-1, times 255, in the widest type there is. */
static long double exact(float x)
{
    long double v = x <= 0.0031308f ? 12.92L * (long double)x
                                    : 1.055L * powl((long double)x, 1.0L / 2.4L) - 0.055L;
    return 255.0L * v;
}

/* Around every threshold, and at random between: the byte is the exact value rounded. Values whose
 * exact image is within 1e-9 of a half may go either way; there are none among floats near the
 * thresholds. */
static void bytes_are_the_rounded_curve(void **state)
{
    (void)state;
    for (uint32_t byte = 1; byte < 256; byte++) {
        uint32_t low = 0,
                 high = 0x3f800000u; /* Bisect for the first float whose image reaches the byte. */
        while (low < high) {
            uint32_t middle = low + (high - low) / 2;
            if (exact(float_of(middle)) >= (long double)byte - 0.5L)
                high = middle;
            else
                low = middle + 1;
        }
        assert_true(fabsl(exact(float_of(low)) - ((long double)byte - 0.5L)) > 1e-9L);
        assert_int_equal(one(float_of(low), 0.0, false), byte);
        assert_int_equal(one(float_of(low - 1), 0.0, false), byte - 1);
    }
}

static void it_is_monotone(void **state)
{
    (void)state;
    fl_tonemapper *mapper = fl_tonemapper_create();
    assert_non_null(mapper);
    static float rgb[3 * COUNT];
    static uint8_t rgba[4 * COUNT];
    uint8_t last = 0;
    for (uint32_t bits = 0; bits <= 0x3f810000u; bits += 3 * COUNT * 61) {
        for (uint32_t i = 0; i < 3 * COUNT; i++)
            rgb[i] = float_of(bits + i * 61);
        fl_tonemapper_run(mapper, &(fl_tonemap){0}, rgb, COUNT, rgba);
        for (uint32_t i = 0; i < 3 * COUNT; i++) {
            uint8_t byte = rgba[i / 3 * 4 + i % 3];
            assert_true(byte >= last);
            last = byte;
        }
    }
    assert_int_equal(last, 255);
    fl_tonemapper_destroy(mapper);
}

static void extremes(void **state)
{
    (void)state;
    const struct {
        float x;
        double ev;
        int want, truncated;
    } cases[] = {
        {0.0f, 0.0, 0, 0},          {-0.0f, 0.0, 0, 0},         {-1.0f, 0.0, 0, 0},
        {NAN, 0.0, 0, 0},           {1.0f, 0.0, 255, 255},      {2.0f, 0.0, 255, 255},
        {INFINITY, 0.0, 255, 255},  {-INFINITY, 0.0, 0, 0},     {0.5f, 1.0, 255, 255},
        {2.0f, -1.0, 255, 255},     {0.5f, 0.0, 188, 127},      {1e-40f, 0.0, 0, 0},
        {0.25f, 1.0, 188, 127},     {1e-30f, 1e9, 255, 255},    {1.0f, -1e9, 0, 0},
        {0.999999f, 0.0, 255, 254}, {INFINITY, -1e9, 255, 255},
    };
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        assert_int_equal(one(cases[i].x, cases[i].ev, false), cases[i].want);
        assert_int_equal(one(cases[i].x, cases[i].ev, true), cases[i].truncated);
    }
}

/* All instruction sets, all lengths with a tail, nothing written beyond the end. */
static void all_instruction_sets_agree(void **state)
{
    (void)state;
    static const struct {
        fl_isa isa;
        fl_tonemap_kernel *kernel;
    } table[] = {
#if defined(__x86_64__)
        {FL_ISA_SSE2, fl_tonemap_kernel_sse2},
        {FL_ISA_AVX2, fl_tonemap_kernel_avx2},
#elif defined(__aarch64__)
        {FL_ISA_NEON, fl_tonemap_kernel_neon},
#endif
        {FL_ISA_SCALAR, fl_tonemap_kernel_scalar},
    };
    fl_tonemapper *mapper = fl_tonemapper_create();
    assert_non_null(mapper);
    const fl_curve *curve = (const fl_curve *)(const void *)mapper;
    static float rgb[3 * COUNT];
    static uint8_t want[4 * COUNT + 1], got[4 * COUNT + 1];
    uint32_t h = 2026;
    printf("seed %u\n", h);
    for (uint32_t i = 0; i < 3 * COUNT; i++) {
        h = fl_hash_step(h, i);
        rgb[i] =
            i % 3 ? (float)(h >> 8) * 0x1p-24f : float_of(h); /* Uniform, and any float at all. */
    }
    for (size_t t = 0; t < FL_COUNT_OF(table); t++) {
        if (!fl_cpu_has(table[t].isa))
            continue;
        for (size_t n = 0; n <= COUNT; n = n < 20 ? n + 1 : n * 2)
            for (int truncates = 0; truncates < 2; truncates++) {
                memset(want, 7, sizeof want);
                memset(got, 7, sizeof got);
                fl_tonemap_kernel_scalar(rgb, n, 1.25f, truncates ? NULL : curve, want);
                table[t].kernel(rgb, n, 1.25f, truncates ? NULL : curve, got);
                assert_memory_equal(got, want, sizeof got);
            }
    }
    fl_tonemapper_destroy(mapper);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_are_the_rounded_curve),
        cmocka_unit_test(it_is_monotone),
        cmocka_unit_test(extremes),
        cmocka_unit_test(all_instruction_sets_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
