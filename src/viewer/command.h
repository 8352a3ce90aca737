/* SPDX-License-Identifier: MIT
 *
 * The commands: ONE table of rows that drives dispatch, the help overlay, docs/controls.md and the
 * tests. A new command is a new row.
 */
#ifndef VW_COMMAND_H
#define VW_COMMAND_H

#include "viewer/state.h"

/** How an input reaches a command, and what its amount then is. */
typedef enum vw_binding_kind {
    VW_BIND_NONE,  /**< Ends a row's list. */
    VW_BIND_PRESS, /**< Key goes down (and repeats, if the command repeats): x = factor. */
    VW_BIND_WHILE, /**< x = 1 when the key goes down, 0 when it comes up. */
    VW_BIND_HOLD, /**< While a key is down, every 1/60 s: x = factor * seconds * (Shift 4, Alt 1/4).
                   */
    VW_BIND_DRAG, /**< Mouse moves while a button is down: x, y = picture pixels. */
    VW_BIND_CLICK, /**< Button goes down: x, y = position, picture pixels. */
    VW_BIND_WHEEL  /**< x = factor * notches. */
} vw_binding_kind;

typedef struct vw_binding {
    vw_binding_kind kind;
    int code; /**< GLFW key or button; 0 for the wheel. */
    int mods; /**< Exactly these GLFW_MOD_ bits; a hold ignores Shift and Alt. */
    double factor;
} vw_binding;

typedef struct vw_amount {
    double x, y;
} vw_amount;

typedef enum vw_group {
    VW_GROUP_MOVE,
    VW_GROUP_LENS,
    VW_GROUP_PICTURE,
    VW_GROUP_UNDERSTAND,
    VW_GROUP_PROGRAM,
    VW_GROUP_COUNT
} vw_group;

extern const char *const vw_group_titles[VW_GROUP_COUNT];

enum { VW_BINDINGS_MAX = 10, VW_VALUE_MAX = 48 };

typedef struct vw_command {
    const char *name;
    vw_group group;
    vw_binding bindings[VW_BINDINGS_MAX + 1];
    bool repeats;     /**< Fires again while its key is held down. */
    unsigned dirty;   /**< All the bits that `run` may return. */
    const char *help; /**< What it does, a few words. */
    vw_dirty (*run)(vw_state *state, vw_amount amount);
    /** Write the value it governs, as shown in the help (at most VW_VALUE_MAX bytes); NULL: none.
     */
    void (*value)(const vw_state *state, char out[VW_VALUE_MAX]);
} vw_command;

extern const vw_command vw_commands[];
extern const size_t vw_command_count;

/** Apply a command and report what it made stale. No I/O, no GL: the application acts on the bits.
 */
vw_dirty vw_command_run(const vw_command *command, vw_state *state, vw_amount amount);

typedef struct vw_keymap vw_keymap;

/** Its bindings there; NULL: those of the table. */
const vw_binding *vw_command_bindings(const vw_command *command, const vw_keymap *keymap);

/** The command bound to that input, with its factor; NULL: none. For holds `mods` may add Shift and
 * Alt. */
const vw_command *vw_command_find(const vw_keymap *keymap, vw_binding_kind kind, int code, int mods,
                                  double *out_factor);

/** The command of that name, or NULL. */
const vw_command *vw_command_named(const char *name);

#endif
