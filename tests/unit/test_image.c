/* SPDX-License-Identifier: MIT
 *
 * image.h: life of a picture, and the sRGB table against the formula in long double.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdint.h>

#include "core/image.h"

static void a_picture_begins_black_and_counts_its_bytes(void **state)
{
    (void)state;
    static const struct {
        fl_pixel_format format;
        size_t bytes;
    } cases[] = {{FL_PIXEL_SRGB8, 63}, {FL_PIXEL_LINEAR8, 63}, {FL_PIXEL_FLOAT, 252}};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        fl_image *image = fl_image_create(7, 3, cases[i].format);
        assert_non_null(image);
        assert_int_equal(fl_image_bytes(image), cases[i].bytes);
        for (size_t b = 0; b < cases[i].bytes; b++)
            assert_int_equal(((const uint8_t *)image->pixels)[b], 0);
        assert_ptr_equal(fl_image_retain(image), image);
        fl_image_release(image);
        assert_int_equal(image->width, 7);
        fl_image_release(image);
    }
    fl_image_release(NULL);
}

static void an_impossible_picture_is_refused(void **state)
{
    (void)state;
    assert_null(fl_image_create(0, 5, FL_PIXEL_SRGB8));
    assert_null(fl_image_create(5, 0, FL_PIXEL_FLOAT));
    assert_null(fl_image_create(UINT32_MAX, UINT32_MAX, FL_PIXEL_FLOAT));
}

static long double exact_srgb(int byte)
{
    long double c = byte / 255.0L;
    return c <= 0.04045L ? c / 12.92L : powl((c + 0.055L) / 1.055L, 2.4L);
}

static void each_table_value_is_the_nearest_float(void **state)
{
    (void)state;
    for (int i = 0; i < 256; i++) {
        float value = fl_srgb8_to_linear[i];
        long double exact = exact_srgb(i), error = fabsl((long double)value - exact);
        float below = nextafterf(value, -1.0f), above = nextafterf(value, 2.0f);
        assert_true(error <= fabsl((long double)below - exact));
        assert_true(error <= fabsl((long double)above - exact));
        assert_true(i == 0 || value > fl_srgb8_to_linear[i - 1]);
    }
    assert_true(fl_srgb8_to_linear[0] == 0.0f && fl_srgb8_to_linear[255] == 1.0f);
}

static void the_curve_agrees_with_the_table_and_its_inverse(void **state)
{
    (void)state;
    for (int i = 0; i < 256; i++)
        assert_true(fabs(fl_srgb_to_linear(i / 255.0) - (double)exact_srgb(i)) < 1e-7);
    for (int i = 0; i <= 65535; i++) {
        double there = fl_srgb_to_linear(i / 65535.0);
        assert_int_equal((int)(fl_srgb_from_linear(there) * 65535.0 + 0.5), i);
    }
    assert_true(fl_srgb_to_linear(-1.0) == 0.0 && fl_srgb_from_linear(-1.0) == 0.0);
    assert_true(fabs(fl_srgb_to_linear(7.0) - 1.0) < 1e-9);
    assert_true(fl_srgb_from_linear((double)NAN) == 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_begins_black_and_counts_its_bytes),
        cmocka_unit_test(an_impossible_picture_is_refused),
        cmocka_unit_test(each_table_value_is_the_nearest_float),
        cmocka_unit_test(the_curve_agrees_with_the_table_and_its_inverse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
