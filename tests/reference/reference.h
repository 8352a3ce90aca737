/* SPDX-License-Identifier: MIT
 *
 * The reference tracer, the judge of the renderer: scalar, double, recursive, brute force. Written
 * from the pages that say what a picture is, not from src/; it shares no code with the renderer.
 * Slow on purpose.
 */
#ifndef REFERENCE_H
#define REFERENCE_H

#include "dump.h"

/** Complete a dump: inverse matrices, shading normals of meshes, extents of profiles. Once, before
 * the first sample. False when memory runs out or a matrix is singular. */
bool reference_prepare(ref_dump *dump);

/** Radiance of sample `index` of the pixel in column x, row y from the top. The camera ray is moved
 * by `nudge[0]` and `nudge[1]` of its length to the right and up; NULL: not moved. Any thread. */
ref_vec reference_sample(const ref_dump *dump, uint32_t x, uint32_t y, uint32_t index,
                         const double *nudge);

#endif
