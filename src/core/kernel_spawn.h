/* SPDX-License-Identifier: MIT
 *
 * Layer 6: the stage of kernel_spawn.c, an entry of fl_shade_kernels.
 */
#ifndef FL_KERNEL_SPAWN_H
#define FL_KERNEL_SPAWN_H

#include "core/kernel_shade.h"
#include "core/wide.h"

void FL_ISA_NAME(fl_shade_spawn)(const fl_frame *frame, const fl_stage *stage, fl_array3 throughput,
                                 const uint32_t *slot, fl_branches *out);

#endif
