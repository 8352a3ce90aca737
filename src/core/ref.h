/* SPDX-License-Identifier: MIT
 *
 * Layer 0: a reference count. Embed it; the object dies with its last reference.
 */
#ifndef FL_REF_H
#define FL_REF_H

#include <stdatomic.h>

#include "core/base.h"

typedef struct fl_ref {
    atomic_uint count;
} fl_ref;

/** A new object has one reference, its creator's. */
static inline void fl_ref_init(fl_ref *ref)
{
    atomic_init(&ref->count, 1u);
}

/** Any thread that holds a reference. */
static inline void fl_ref_retain(fl_ref *ref)
{
    atomic_fetch_add_explicit(&ref->count, 1u, memory_order_relaxed);
}

/** True when this was the last reference: the caller then destroys the object. Any thread. */
static inline bool fl_ref_release(fl_ref *ref)
{
    return atomic_fetch_sub_explicit(&ref->count, 1u, memory_order_acq_rel) == 1u;
}

#endif
