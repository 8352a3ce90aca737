/* SPDX-License-Identifier: MIT
 *
 * Layer 4: the winners of a search, solved again in double, FL_WD rays at a time. One source for
 * all instruction sets; the arithmetic of a ray does not depend on its neighbours, so the same bits
 * from each. Rays near each other in the stream that met the same kind of object go together.
 */
#ifndef FL_KERNEL_RESOLVE_H
#define FL_KERNEL_RESOLVE_H

#include "core/stream.h"
#include "core/wide.h"

/** As fl_isect_kernels.resolve. */
void FL_ISA_NAME(fl_resolve)(const fl_geometry *geometry, const fl_rays *rays, const fl_hits *hits,
                             const uint8_t *needs_uv, fl_surface *out_surface,
                             fl_isect_context *context);

#endif
