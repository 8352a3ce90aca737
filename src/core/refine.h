/* SPDX-License-Identifier: MIT
 *
 * Layer 8: the good hierarchies of a quickly compiled scene, built in the background while the
 * scene is rendered. Functions are the owner's unless they say "any thread".
 */
#ifndef FL_REFINE_H
#define FL_REFINE_H

#include "core/compile.h"

typedef struct fl_refine fl_refine;

/** Start to refine `quick`, which is retained until that is done, with `thread_count` threads (as
 * fl_thread_count). `done` is called by one of them, once, at the end, when it is no longer busy:
 * with the refined scene, borrowed, or NULL where there is none. It must not call this module. NULL
 * after adding an error. */
fl_refine *fl_refine_start(fl_compiled *quick, uint32_t thread_count,
                           void (*done)(void *context, fl_compiled *refined), void *context,
                           fl_diags *diags);

/** The refined scene, a reference of the caller's, once; NULL before there is one, after it was
 * taken, and when memory was not enough: the quick one is then as good as it gets. */
fl_compiled *fl_refine_take(fl_refine *refine);

/** Whether it is still being built. False for NULL. Any thread. */
bool fl_refine_is_busy(fl_refine *refine);

/** Break off what is under way (within some 0.1 s for 10 million triangles) and let go of it. NULL
 * is allowed. */
void fl_refine_destroy(fl_refine *refine);

#endif
