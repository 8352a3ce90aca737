/* SPDX-License-Identifier: MIT
 *
 * Layer 6: the stages of kernel_material.c, entries of fl_shade_kernels.
 */
#ifndef FL_KERNEL_MATERIAL_H
#define FL_KERNEL_MATERIAL_H

#include "core/kernel_shade.h"
#include "core/wide.h"

uint32_t FL_ISA_NAME(fl_shade_keep_hits)(fl_stage *stage);
bool FL_ISA_NAME(fl_shade_material)(const fl_frame *frame, fl_stage *stage,
                                    uint64_t *texture_lookups);
void FL_ISA_NAME(fl_shade_texture)(const fl_texture *texture, const float *u, const float *v,
                                   uint32_t count, fl_array3 out);

#endif
