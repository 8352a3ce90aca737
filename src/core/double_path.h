/* SPDX-License-Identifier: MIT
 *
 * Layer 6: `--precision double`: a unit of work one sample and one ray at a time in double, by the
 * rules of the tile pipeline and with its sampler, plan and shader tables. The built-in measure of
 * float error.
 */
#ifndef FL_DOUBLE_PATH_H
#define FL_DOUBLE_PATH_H

#include "core/pipeline.h"

/** As fl_pipeline_run, which calls it. Needs no memory. */
bool fl_double_run(const fl_frame *frame, const fl_unit *unit, const fl_unit_result *result,
                   const atomic_uint_least64_t *generation, uint64_t wanted, fl_counts *counts);

#endif
