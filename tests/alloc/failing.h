/* SPDX-License-Identifier: MIT
 *
 * An allocator that fails when told to, put in place of the C library's by the linker
 * (--wrap): malloc, calloc, realloc, aligned_alloc, the start of a
 * thread, and the arena's every piece (its blocks alone would hide most places). Any thread. What
 * shared libraries ask for themselves is not touched.
 */
#ifndef TEST_FAILING_H
#define TEST_FAILING_H

#include <stdbool.h>
#include <stddef.h>

#include "core/diag.h"

/** Let call number `n` from now (1: the next) fail, and if `from_then_on` every later one; 0: none.
 */
void failing_begin(size_t n, bool from_then_on);
/** Stop failing. Whether any call failed. */
bool failing_end(void);
/** Blocks that were given out and not taken back. */
long failing_live_blocks(void);

/** Run `body` again and again, failing call 1, 2, 3 ... until none is left to fail; then likewise
 * with all later calls failing, too. `body` returns whether it succeeded. Checked here: it fails
 * only when a call did, and leaves no block behind. Returns how many calls failed. */
size_t failing_every_call(bool (*body)(void *context), void *context);

/** Whether an error blames the machine. */
bool failing_names_machine(const fl_diags *diags);

#endif
