/* SPDX-License-Identifier: MIT
 *
 * Undo and redo of everything that decides the picture. One gesture is one step, however many
 * events it has. Plain values, log time: the same in a replay.
 */
#ifndef VW_HISTORY_H
#define VW_HISTORY_H

#include "viewer/command.h"

enum {
    VW_HISTORY_MAX = 128,     /**< Steps kept; the oldest goes first. */
    VW_HISTORY_QUIET_MS = 500 /**< A gesture that rests so long has ended. */
};

typedef struct vw_moment {
    vw_look look;
    vw_mode mode;
    fl_vec3 pivot;
    double saved_aperture; /**< Comes along: by itself it is no step. */
    double speed[2]; /**< Before and after the step that led here: what it did to it, as reset does,
                        goes and comes with it; what a hand did since stays. */
} vw_moment;

/** Zero-initialise, then vw_history_begin. */
typedef struct vw_history {
    vw_moment now;
    vw_moment past[VW_HISTORY_MAX], future[VW_HISTORY_MAX]; /**< The nearest last. */
    uint32_t past_count, future_count;
    double speed;            /**< When the last input had been noted. */
    const vw_command *cause; /**< Of the gesture under way; NULL: none. */
    uint64_t changed_ms;
} vw_history;

/** Take the state as it is, without a step: after loading. `forgets`: another scene, no way back.
 */
void vw_history_begin(vw_history *history, const vw_state *state, bool forgets);

/** The scene was read again, and `state` rebased on it; `before`: its start till then. Every moment
 * follows as the state did. */
void vw_history_rebase(vw_history *history, const vw_state *state, const vw_look *before);

/** Look at what an input did. `cause`: its command (NULL: none of them); `is_gesture`: it goes on
 * with the same command, as a drag does. */
void vw_history_note(vw_history *history, const vw_state *state, const vw_command *cause,
                     bool is_gesture);

/** Step back or forth; says so, or that there is nowhere to go. */
vw_dirty vw_history_undo(vw_history *history, vw_state *state);
vw_dirty vw_history_redo(vw_history *history, vw_state *state);

#endif
