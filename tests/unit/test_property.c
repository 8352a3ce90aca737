/* SPDX-License-Identifier: MIT
 *
 * What finds the smallest failing case of property tests (tests/support/property.h): for rules
 * whose smallest exception is known, it is that one.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>

#include "support/property.h"

static unsigned calls;

/* "Nothing in a list reaches 1000": wrong first for the list of 1000 alone. */
static bool lists_stay_small(property *p, void *data)
{
    (void)data;
    uint64_t count = property_given(p, 40, 100), most = 0;
    for (uint64_t i = 0; i < count; i++) {
        property_mark(p);
        property_below(p, 7); /* plays no part */
        uint64_t number = property_below(p, 5000);
        most = number > most ? number : most;
    }
    calls++;
    return most < 1000 || property_fail(p, "%llu", (unsigned long long)most);
}

/* "No number lies beyond 3/4", of [-1, 1): 3/4 itself is the roundest that does. */
static bool numbers_stay_small(property *p, void *data)
{
    (void)data;
    property_between(p, 5.0, 6.0);
    double x = property_between(p, -1.0, 1.0);
    return fabs(x) < 0.75 || property_fail(p, "%g", x);
}

static bool all_is_well(property *p, void *data)
{
    (void)data;
    double x = property_between(p, -3.0, 2.0), y = property_between(p, 7.0, 8.0);
    uint64_t k = property_below(p, 10);
    return (x >= -3.0 && x <= 2.0 && y >= 7.0 && y <= 8.0 && k < 10) ||
           property_fail(p, "out of range");
}

static void the_smallest_list_is_found(void **state)
{
    (void)state;
    property_case found;
    const char *message;
    for (uint64_t seed = 1; seed < 20; seed++) {
        assert_false(property_check(lists_stay_small, NULL, seed, &found, &message));
        assert_string_equal(message, "1000");
        assert_int_equal(found.count, 3);
        assert_int_equal(found.choices[0], 1);
        assert_int_equal(found.choices[1], 0);
        assert_int_equal(found.choices[2], 1000);
    }
    assert_true(calls < 19 * 2000);
}

static void the_roundest_number_is_found(void **state)
{
    (void)state;
    property_case found;
    const char *message;
    unsigned failed = 0;
    for (uint64_t seed = 1; seed < 40; seed++) {
        if (property_check(numbers_stay_small, NULL, seed, &found, &message))
            continue;
        failed++;
        assert_string_equal(message, "0.75");
        assert_int_equal(found.choices[0], 0);
    }
    assert_true(failed > 3 && failed < 20);
}

static void what_holds_is_left_alone(void **state)
{
    (void)state;
    static const uint64_t kept[] = {~UINT64_C(0), 3, UINT64_C(1) << 60};
    const property_case cases[] = {PROPERTY_CASE(kept)};
    property_run(all_is_well, NULL, 5, 2000, cases, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_smallest_list_is_found),
        cmocka_unit_test(the_roundest_number_is_found),
        cmocka_unit_test(what_holds_is_left_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
