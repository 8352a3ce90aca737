/* SPDX-License-Identifier: MIT
 *
 * Layer 4: the winner of a search, solved again in double. One scalar source for all instruction
 * sets.
 */
#ifndef FL_RESOLVE_H
#define FL_RESOLVE_H

#include "core/stream.h"

/** As fl_isect_kernels.resolve. */
void fl_resolve(const fl_geometry *geometry, const fl_rays *rays, const fl_hits *hits,
                const uint8_t *needs_uv, fl_surface *out_surface, fl_isect_context *context);

#endif
