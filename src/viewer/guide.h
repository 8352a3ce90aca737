/* SPDX-License-Identifier: MIT
 *
 * What stands behind the pixels (core's aov), evaluated by one thread of its own, so that neither
 * the window nor the render waits for it. A coarse picture first, then the whole one; the newest
 * wish wins, but the coarse picture of each wish that is begun is shown.
 */
#ifndef VW_GUIDE_H
#define VW_GUIDE_H

#include "core/firstlight.h"

/** A kind besides those of fl_aov: the shape seen from the lens's left edge in red, from its right
 * in green and blue. */
enum { VW_GUIDE_RANGEFINDER = FL_AOV_COUNT };

typedef struct vw_guide vw_guide;

/** One finished or coarse picture; width * height * 3 floats. */
typedef struct vw_guide_picture {
    float *values; /**< Owned by whoever took it. */
    uint32_t width, height;
    int kind;
    uint64_t wish;
    bool is_coarse;
} vw_guide_picture;

/** Starts the thread, asleep. `notify`: called by it when there is a new picture; may be NULL. NULL
 * after adding an error. */
vw_guide *vw_guide_create(void (*notify)(void *context), void *context, fl_diags *diags);
/** Stops and joins; NULL is allowed. */
void vw_guide_destroy(vw_guide *guide);

/** Wish for a kind of this frame, of which it takes a reference. Returns the wish's number, from 1.
 * Never waits. */
uint64_t vw_guide_ask(vw_guide *guide, fl_frame *frame, int kind);

/** Take the newest picture, if there is one that was not taken yet: *out is then replaced, its old
 * values freed. */
bool vw_guide_take(vw_guide *guide, vw_guide_picture *out);

/** Block until the latest wish is done or the memory for it could not be had. */
void vw_guide_wait(vw_guide *guide);

#endif
