/* SPDX-License-Identifier: MIT
 *
 * Which inputs reach which command: the table's, or what a small file makes of them:
 *
 *     # command = its chords, in the order of the help
 *     forward = KP_8 KP_2
 *     focus-at = Alt+left
 *     exposure = Ctrl+B Ctrl+Shift+B
 *     print = none
 *
 * The i-th chord does what the i-th chord of the table does. Names of keys are GLFW's (any case) or
 * what a US keyboard prints; buttons are left, middle and right, the wheel is wheel; modifiers are
 * Ctrl, Shift, Alt.
 */
#ifndef VW_KEYMAP_H
#define VW_KEYMAP_H

#include "viewer/command.h"

enum { VW_COMMANDS_MAX = 96 };

struct vw_keymap {
    vw_binding bindings[VW_COMMANDS_MAX][VW_BINDINGS_MAX + 1];
    uint32_t lines[VW_COMMANDS_MAX]; /**< Of the file; 0: as in the table. */
};

/** The table's own. */
void vw_keymap_init(vw_keymap *keymap);

/** Put what a file says over it. False after adding at least one located error: unknown names with
 * the nearest ones, chords bound twice; *keymap is then the table's. */
bool vw_keymap_parse(vw_keymap *keymap, const char *text, size_t text_bytes, const char *name,
                     fl_diags *diags);

/** Read `path`, or with NULL the user's own file, if there is one:
 * $XDG_CONFIG_HOME/firstlight/keys. */
bool vw_keymap_load(vw_keymap *keymap, const char *path, fl_diags *diags);

/** Two commands that one chord would reach, as indices into the table; false: there are none. */
bool vw_keymap_find_conflict(const vw_keymap *keymap, size_t *out_first, size_t *out_second);

#endif
