/* SPDX-License-Identifier: MIT */
#include "core/cpu.h"

#include <string.h>

static const char *const names[FL_ISA_COUNT] = {
    [FL_ISA_SCALAR] = "scalar",
    [FL_ISA_SSE2] = "sse2",
    [FL_ISA_AVX2] = "avx2",
    [FL_ISA_NEON] = "neon",
};

const char *fl_isa_name(fl_isa isa)
{
    FL_ASSERT((unsigned)isa < FL_ISA_COUNT);
    return names[isa];
}

bool fl_isa_find(const char *name, fl_isa *out_isa)
{
    if (strcmp(name, "auto") == 0) {
        *out_isa = fl_cpu_best_isa();
        return true;
    }
    for (int isa = 0; isa < FL_ISA_COUNT; isa++) {
        if (strcmp(name, names[isa]) == 0) {
            *out_isa = (fl_isa)isa;
            return true;
        }
    }
    return false;
}

#if defined(__x86_64__)

/* SSE2 is part of x86-64. The compiler's run-time library also asks the system whether it saves the
 * wide registers. */
bool fl_cpu_has(fl_isa isa)
{
    return isa == FL_ISA_SCALAR || isa == FL_ISA_SSE2 ||
           (isa == FL_ISA_AVX2 && __builtin_cpu_supports("avx2"));
}

#elif defined(__aarch64__)

/* NEON is part of AArch64. */
bool fl_cpu_has(fl_isa isa)
{
    return isa == FL_ISA_SCALAR || isa == FL_ISA_NEON;
}

#else

bool fl_cpu_has(fl_isa isa)
{
    return isa == FL_ISA_SCALAR;
}

#endif

fl_isa fl_cpu_best_isa(void)
{
    for (int isa = FL_ISA_COUNT - 1; isa > FL_ISA_SCALAR; isa--)
        if (fl_cpu_has((fl_isa)isa))
            return (fl_isa)isa;
    return FL_ISA_SCALAR;
}
