/* SPDX-License-Identifier: MIT */
#include "core/stream.h"

const fl_isect_kernels *fl_isect_kernels_of(fl_isa isa)
{
    static const fl_isect_kernels *const table[FL_ISA_COUNT] = FL_ISA_TABLE(fl_isect_kernels);
    FL_ASSERT(table[isa]);
    return table[isa];
}
