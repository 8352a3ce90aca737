/* SPDX-License-Identifier: MIT
 *
 * What the window shows of a session: the picture itself, or what layer, focus help and comparison
 * make of it. Never what is saved.
 */
#ifndef VW_SHOW_H
#define VW_SHOW_H

#include "viewer/guide.h"
#include "viewer/paint.h"

/** A picture kept to compare with. */
typedef struct vw_pin {
    float *rgb; /**< Linear means; NULL: nothing is pinned. Owned. */
    uint8_t *rgba;
    double exposure_ev; /**< Of rgba. */
    uint32_t width, height;
    uint32_t samples; /**< 0: it was read from a file. */
} vw_pin;

/** Zero-initialise. */
typedef struct vw_show {
    vw_guide *guide; /**< NULL until first needed. */
    vw_guide_picture picture;
    uint64_t wish; /**< That the present state asked for last. */
    int wish_kind;
    bool is_asked; /**< The present state has asked, if it wants anything. */
    uint8_t *rgba; /**< Composed, when it is not the picture as it is. */
    float *values; /**< Maps, and the present means. */
    size_t pixels; /**< Room in both. */
    bool is_composed;
    bool is_stale; /**< To be composed again although nothing new came. */
    vw_pin pin;
    vw_difference difference; /**< Of the present picture from the pinned one, when sizes agree. */
    bool has_difference;
    double low, high; /**< What the ends of the layer's colours mean. */
} vw_show;

#endif
