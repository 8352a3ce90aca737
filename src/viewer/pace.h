/* SPDX-License-Identifier: MIT
 *
 * When the picture is looked at again. Plain arithmetic of the caller's clock: the window and a
 * measuring replay keep the same pace.
 *
 * After an edit: once, as late as one frame of the display allows, so that many Bayer ranks are
 * there; then each 33 ms while fewer than 8 ranks are done, 16 ms up to 4 samples, 100 ms in the
 * first second, 500 ms later - but never so often that looking takes more than a seventh of the
 * time: without a graphics processor it takes it from the tracer. Until the first look has shown
 * something of the edit a further restart waits: a fast mouse gets whole coarse pictures, not the
 * beginnings of pictures.
 */
#ifndef VW_PACE_H
#define VW_PACE_H

#include "core/firstlight.h"

enum {
    VW_PACE_FIRST_MS = 7, /**< Leaves a frame of 16 ms time for tone map, upload and drawing. */
    VW_PACE_HOLD_MS = 100 /**< No restart waits longer. */
};

/** Zero-initialise. */
typedef struct vw_pace {
    uint64_t since_ms;   /**< The first edit of which nothing was shown. */
    uint64_t shown_ms;   /**< When the picture was last looked at. */
    uint64_t took_ms;    /**< What the last look at something new took. */
    uint64_t generation; /**< That must be shown, or a later one. */
    bool is_waiting;     /**< For that. */
} vw_pace;

/** A restart was asked for: `newest` is its generation. */
void vw_pace_restart(vw_pace *pace, uint64_t newest, uint64_t now_ms);

/** The picture was looked at; `shown` is what it is of. */
void vw_pace_shown(vw_pace *pace, const fl_progress *shown, uint64_t now_ms);

/** Mapping, uploading and drawing what it showed have taken so long. */
void vw_pace_took(vw_pace *pace, uint64_t ms);

/** When to look next. `shown` is as of the last look. */
uint64_t vw_pace_due_ms(const vw_pace *pace, const fl_progress *shown);

/** The first look at an edit is so near that whatever else is to be drawn waits for it: until then
 * the tracer has the cores. 0: it is not. */
uint64_t vw_pace_draw_from_ms(const vw_pace *pace);

/** Until when a further restart waits; 0: it need not. */
uint64_t vw_pace_held_until_ms(const vw_pace *pace);

#endif
