/* SPDX-License-Identifier: MIT */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/cpu.h"

static void test_names_are_found_again(void **state)
{
    (void)state;
    for (int i = 0; i < FL_ISA_COUNT; i++) {
        fl_isa isa = FL_ISA_COUNT;
        assert_true(fl_isa_find(fl_isa_name((fl_isa)i), &isa));
        assert_int_equal(isa, i);
        for (int j = 0; j < i; j++)
            assert_string_not_equal(fl_isa_name((fl_isa)i), fl_isa_name((fl_isa)j));
    }
}

static void test_other_names_are_refused(void **state)
{
    (void)state;
    static const char *const wrong[] = {"", "AVX2", "avx", "avx22", "sse", "auto ", "avx512"};
    for (size_t i = 0; i < FL_COUNT_OF(wrong); i++) {
        fl_isa isa = FL_ISA_SSE2;
        assert_false(fl_isa_find(wrong[i], &isa));
        assert_int_equal(isa, FL_ISA_SSE2);
    }
}

static void test_best_is_there_and_auto_finds_it(void **state)
{
    (void)state;
    fl_isa isa = FL_ISA_COUNT;
    assert_true(fl_isa_find("auto", &isa));
    assert_int_equal(isa, fl_cpu_best_isa());
    assert_true(fl_cpu_has(isa));
    assert_true(fl_cpu_has(FL_ISA_SCALAR));
    for (int better = (int)isa + 1; better < FL_ISA_COUNT; better++)
        assert_false(fl_cpu_has((fl_isa)better));
#if defined(__x86_64__)
    assert_true(fl_cpu_has(FL_ISA_SSE2));
    assert_false(fl_cpu_has(FL_ISA_NEON));
#elif defined(__aarch64__)
    assert_true(isa == FL_ISA_NEON && !fl_cpu_has(FL_ISA_AVX2));
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names_are_found_again),
        cmocka_unit_test(test_other_names_are_refused),
        cmocka_unit_test(test_best_is_there_and_auto_finds_it),
    };
    return cmocka_run_group_tests_name("cpu", tests, NULL, NULL);
}
