/* SPDX-License-Identifier: MIT
 *
 * Layer 1: a fixed set of threads that run loops. Used by builders; the render has workers of its
 * own.
 */
#ifndef FL_POOL_H
#define FL_POOL_H

#include "core/diag.h"

typedef struct fl_pool fl_pool;

enum { FL_THREADS_MAX = 1024 };

/** The number of threads that a wish of `wanted` gives: 0 means one per online CPU; at most
 * FL_THREADS_MAX. */
uint32_t fl_thread_count(uint32_t wanted);

/** Start thread_count - 1 helper threads (the caller of a loop is the last one); 0 means one per
 * online CPU. NULL after adding an environment error. */
fl_pool *fl_pool_create(uint32_t thread_count, fl_diags *diags);

/** Stop and join. No loop may be running. NULL is allowed. */
void fl_pool_destroy(fl_pool *pool);

/** Threads that take part in a loop, the caller included; 1 for NULL. */
uint32_t fl_pool_thread_count(const fl_pool *pool);

/** Call body(context, begin, end, thread) for disjoint ranges that cover [0, count), each at most
 * `grain` long; returns when all are done. thread < fl_pool_thread_count. Ranges go out in
 * ascending order. `pool` NULL: all on the calling thread. Not re-entrant: a body must not start
 * another loop on the same pool. */
void fl_parallel_for(fl_pool *pool, uint32_t count, uint32_t grain,
                     void (*body)(void *context, uint32_t begin, uint32_t end, uint32_t thread),
                     void *context);

/** From now on loops hand out nothing more and soon return, with parts of their work not done. Any
 * thread, any time. */
void fl_pool_cancel(fl_pool *pool);

/** Whether that was called; false for NULL. After a loop: whether it may be incomplete. */
bool fl_pool_is_cancelled(const fl_pool *pool);

#endif
