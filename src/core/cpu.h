/* SPDX-License-Identifier: MIT
 *
 * Layer 1: the instruction sets that kernels are compiled for, and which of them this machine runs.
 */
#ifndef FL_CPU_H
#define FL_CPU_H

#include "core/base.h"

/** Each has FL_W lanes of 32 bits: 1, 4, 8 and 4. All give the same pictures, byte for byte. */
typedef enum fl_isa { FL_ISA_SCALAR, FL_ISA_SSE2, FL_ISA_AVX2, FL_ISA_NEON, FL_ISA_COUNT } fl_isa;

/** Initialiser of a table over fl_isa: &NAME_scalar and so on, NULL for sets of other machines. */
#if defined(__x86_64__)
#define FL_ISA_TABLE(name)                                                                         \
    {[FL_ISA_SCALAR] = &name##_scalar, [FL_ISA_SSE2] = &name##_sse2, [FL_ISA_AVX2] = &name##_avx2}
#elif defined(__aarch64__)
#define FL_ISA_TABLE(name) {[FL_ISA_SCALAR] = &name##_scalar, [FL_ISA_NEON] = &name##_neon}
#else
#define FL_ISA_TABLE(name) {[FL_ISA_SCALAR] = &name##_scalar}
#endif

/** Lower-case name as on the command line. Static storage. */
const char *fl_isa_name(fl_isa isa);

/** Find by name; "auto" is the best this machine has. False (and *out_isa untouched): no such name.
 *  The set found need not be one this machine has. */
bool fl_isa_find(const char *name, fl_isa *out_isa);

/** Whether this build has kernels for `isa` and this machine (and its system) can run them. */
bool fl_cpu_has(fl_isa isa);

/** The fastest of those fl_cpu_has. */
fl_isa fl_cpu_best_isa(void);

#endif
