/* SPDX-License-Identifier: MIT
 *
 * From events to commands: which keys are held, which drag is on, and the clock that motion runs
 * on. Motion advances in fixed steps of 1/60 s of log time, so a log replayed on any machine moves
 * by the same bytes as the hand did.
 */
#ifndef VW_INPUT_H
#define VW_INPUT_H

#include "viewer/command.h"
#include "viewer/event.h"

enum { VW_TICKS_PER_SECOND = 60, VW_KEY_COUNT = 512, VW_BUTTON_COUNT = 8, VW_AXIS_COUNT = 6 };

/** Zero-initialise. */
typedef struct vw_input {
    uint64_t tick;                /**< Steps of the clock that are done. */
    bool is_held[VW_KEY_COUNT];   /**< Keys that move, while they are down. */
    bool has_moved[VW_KEY_COUNT]; /**< A held key that already moved for a step: a short tap moves
                                     for one. */
    uint32_t held_count;
    const vw_command *while_on; /**< The command of a key that is down, with the key; NULL: none. */
    int while_key;
    double axes[VW_AXIS_COUNT]; /**< Of a gamepad. */
    uint32_t axis_count;        /**< Not at rest. */
    bool is_pad_fast, is_pad_slow;
    bool is_racking;        /**< The focus is on its way by itself. */
    const vw_command *last; /**< What changed the state last, and how it was reached. */
    vw_binding_kind last_kind;
    int held_mods;             /**< From the modifier keys themselves. */
    double cursor_x, cursor_y; /**< Framebuffer pixels. */
    const vw_command *drag;    /**< The drag that is on, with its button; NULL: none. */
    int drag_button;
} vw_input;

/** What a gamepad does: a row for each axis that moves and each button. Ends with command NULL. */
typedef struct vw_pad_binding {
    bool is_axis;
    int code;
    const char *command;
    double x, y; /**< Axis: amount at full deflection, a second (look: in picture heights). */
} vw_pad_binding;
extern const vw_pad_binding vw_pad_bindings[];

/** Run the clock up to `ms` (log time, never backwards): motion of held keys. Sets state->now_ms.
 */
vw_dirty vw_input_advance(vw_input *input, vw_state *state, uint64_t ms);

/** The clock up to `ms`, then one event. Resize changes the state's window size; drop, paste and
 * close are the caller's. */
vw_dirty vw_input_event(vw_input *input, vw_state *state, const vw_event *event, uint64_t ms);

/** True while time alone changes the picture. */
bool vw_input_is_moving(const vw_input *input);

/** Log time of the next step of the clock, milliseconds, rounded up. */
uint64_t vw_input_next_tick_ms(const vw_input *input);

#endif
