/* SPDX-License-Identifier: MIT */
#include "core/stream.h"

const fl_isect_kernels *fl_isect_kernels_of(fl_isa isa)
{
    static const fl_isect_kernels *const table[FL_ISA_COUNT] = {
        [FL_ISA_SCALAR] = &fl_isect_kernels_scalar,
#if defined(__x86_64__)
        [FL_ISA_SSE2] = &fl_isect_kernels_sse2,
        [FL_ISA_AVX2] = &fl_isect_kernels_avx2,
#elif defined(__aarch64__)
        [FL_ISA_NEON] = &fl_isect_kernels_neon,
#endif
    };
    FL_ASSERT(table[isa]);
    return table[isa];
}
