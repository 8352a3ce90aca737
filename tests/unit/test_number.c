/* SPDX-License-Identifier: MIT
 *
 * number.h against the C library in the C locale, which is correctly rounded.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/number.h"
#include "support/seed.h"

static uint64_t random_state;

static uint64_t draw(void)
{
    return test_bits(&random_state);
}

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void assert_same_as_strtod(const char *text)
{
    char *c_end;
    double expected = strtod(text, &c_end), value = 1234.5;
    const char *end = fl_number_parse(text, text + strlen(text), &value);
    if (end != c_end || bits_of(value) != bits_of(expected))
        fail_msg("'%s': got %.17g (%d bytes), want %.17g (%d bytes)", text, value,
                 (int)(end ? end - text : -1), expected, (int)(c_end - text));
}

static void test_same_as_strtod(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "0",
        "-0",
        "+1",
        "-.16",
        "1.",
        "1e-3",
        "20}",
        "1e",
        "1e+",
        "1.e5x",
        "007.50",
        "1e400",
        "-1e400",
        "1e-400",
        "5e-324",
        "2.4703282292062327e-324",
        "2.4703282292062328e-324",
        "2.2250738585072011e-308",
        "2.2250738585072014e-308",
        "1.7976931348623157e308",
        "1.7976931348623158e308",
        "1.7976931348623159e308",
        "9007199254740993",
        "9007199254740992.999999999999999999999999",
        "9007199254740995",
        "9007199254740993.00000000000000000000000000000000000000000000000000000000001",
        "0.1",
        "0.3",
        "123456789012345678901234567890",
        "1e22",
        "1e23",
        "1e99999999999999999999",
        "0e99999999999999999999",
        "1e-99999999999999999999",
        "6.9294956446009195e15",
        "0.000000000000000000000000000000000000000000000000000000000000000000000000001"};
    for (size_t i = 0; i < FL_COUNT_OF(texts); i++)
        assert_same_as_strtod(texts[i]);
}

static void test_no_number(void **state)
{
    (void)state;
    static const char *const texts[] = {"",    "-", "+",   ".",  "-.", "e5",
                                        ".e5", "x", "--1", "in", "-na"};
    double value;
    for (size_t i = 0; i < FL_COUNT_OF(texts); i++)
        assert_null(fl_number_parse(texts[i], texts[i] + strlen(texts[i]), &value));
    assert_null(fl_number_parse(texts[0], texts[0], &value));
}

static void test_bounded_by_end(void **state)
{
    (void)state;
    const char *text = "123.5e10";
    double value;
    static const double expected[] = {0, 1, 12, 123, 123, 123.5, 123.5, 1235, 1.235e12};
    for (size_t n = 1; n <= 8; n++) {
        assert_non_null(fl_number_parse(text, text + n, &value));
        assert_true(value == expected[n]);
    }
}

static void test_named_values(void **state)
{
    (void)state;
    static const char *const texts[] = {"inf", "-INF", "Infinity", "nan", "-nan"};
    double value;
    for (size_t i = 0; i < FL_COUNT_OF(texts); i++) {
        const char *end = texts[i] + strlen(texts[i]);
        assert_ptr_equal(fl_number_parse(texts[i], end, &value), end);
        assert_true(i < 3 ? isinf(value) : isnan(value));
    }
    const char *hexadecimal = "0x10";
    assert_ptr_equal(fl_number_parse(hexadecimal, hexadecimal + 4, &value), hexadecimal + 1);
    assert_true(value == 0.0);
}

/* Random digits with random exponents: short ones, 17 to 40 digits, and halfway cases between
 * doubles. */
static void test_random_decimals(void **state)
{
    (void)state;
    random_state = 2024;
    print_message("seed %llu\n", (unsigned long long)random_state);
    char text[1200];
    for (int i = 0; i < 1000000; i++) {
        int digits = 1 + (int)(draw() % (i % 16 == 0 ? 40 : 20));
        int point = (int)(draw() % (uint64_t)(digits + 1)), n = 0;
        if (draw() & 1)
            text[n++] = '-';
        for (int k = 0; k < digits; k++) {
            if (k == point)
                text[n++] = '.';
            text[n++] = (char)('0' + draw() % 10);
        }
        int range = i % 8 == 0 ? 680 : 60;
        if (draw() % 4)
            n += sprintf(text + n, "e%d", (int)(draw() % (uint64_t)range) - range / 2);
        text[n] = '\0';
        assert_same_as_strtod(text);
    }
}

static void test_halfway_cases(void **state)
{
    (void)state;
    random_state = 7;
    print_message("seed %llu\n", (unsigned long long)random_state);
    char text[1600];
    for (int i = 0; i < 3000; i++) {
        uint64_t bits = draw() >> 1;
        if (i % 4 == 0)
            bits &= (1ull << 52) - 1; /* denormal */
        double low, high;
        memcpy(&low, &bits, sizeof low);
        high = nextafter(low, HUGE_VAL);
        if (!isfinite(low) || !isfinite(high))
            continue;
        /* The midpoint needs one bit more than a double has, which long double offers on this
         * target. */
        long double middle = ((long double)low + (long double)high) / 2;
        snprintf(text, sizeof text, "%.1100Lf", middle);
        assert_same_as_strtod(text);
        strcat(text, "1");
        assert_same_as_strtod(text);
    }
}

static void test_integers(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int64_t value;
        int bytes;
    } cases[] = {{"0", 0, 1},
                 {"-12}", -12, 3},
                 {"+7", 7, 2},
                 {"200.0", 200, 3},
                 {"007", 7, 3},
                 {"9223372036854775807", INT64_MAX, 19},
                 {"-9223372036854775808", INT64_MIN, 20}};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        int64_t value = 99;
        const char *text = cases[i].text;
        assert_ptr_equal(fl_integer_parse(text, text + strlen(text), &value),
                         text + cases[i].bytes);
        assert_int_equal(value, cases[i].value);
    }
    static const char *const wrong[] = {"",
                                        "-",
                                        "x",
                                        ".5",
                                        "9223372036854775808",
                                        "-9223372036854775809",
                                        "99999999999999999999999"};
    for (size_t i = 0; i < FL_COUNT_OF(wrong); i++) {
        int64_t value;
        assert_null(fl_integer_parse(wrong[i], wrong[i] + strlen(wrong[i]), &value));
    }
}

static void test_format(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *text;
    } cases[] = {{0.0, "0"},
                 {-0.0, "-0"},
                 {1.0, "1"},
                 {-0.16, "-0.16"},
                 {0.1, "0.1"},
                 {100.0, "100"},
                 {1e15, "1000000000000000"},
                 {1e16, "1e16"},
                 {12.5, "12.5"},
                 {0.00001, "0.00001"},
                 {1e-6, "1e-6"},
                 {1.5e300, "1.5e300"},
                 {5e-324, "5e-324"},
                 {1.0 / 3.0, "0.3333333333333333"}};
    char text[32];
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        assert_int_equal(fl_number_format(cases[i].value, text), strlen(cases[i].text));
        assert_string_equal(text, cases[i].text);
    }
    fl_number_format(HUGE_VAL, text);
    assert_string_equal(text, "inf");
    fl_number_format(-HUGE_VAL, text);
    assert_string_equal(text, "-inf");
    fl_number_format((double)NAN, text);
    assert_string_equal(text, "nan");
}

static void test_format_reads_back(void **state)
{
    (void)state;
    random_state = 99;
    print_message("seed %llu\n", (unsigned long long)random_state);
    for (int i = 0; i < 30000; i++) {
        uint64_t bits = draw();
        double value, back;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        char text[32];
        size_t bytes = fl_number_format(value, text);
        assert_true(bytes < sizeof text && bytes == strlen(text));
        assert_ptr_equal(fl_number_parse(text, text + bytes, &back), text + bytes);
        assert_true(bits_of(back) == bits);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_as_strtod),   cmocka_unit_test(test_no_number),
        cmocka_unit_test(test_bounded_by_end),   cmocka_unit_test(test_named_values),
        cmocka_unit_test(test_random_decimals),  cmocka_unit_test(test_halfway_cases),
        cmocka_unit_test(test_integers),         cmocka_unit_test(test_format),
        cmocka_unit_test(test_format_reads_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
