/* SPDX-License-Identifier: MIT */
#include "viewer/command.h"

#include "viewer/keymap.h"

#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

vw_dirty vw_command_run(const vw_command *command, vw_state *state, vw_amount amount)
{
    vw_dirty dirty = command->run(state, amount);
    FL_ASSERT(((unsigned)dirty & ~command->dirty) == 0);
    return dirty;
}

const vw_binding *vw_command_bindings(const vw_command *command, const vw_keymap *keymap)
{
    return keymap ? keymap->bindings[command - vw_commands] : command->bindings;
}

const vw_command *vw_command_find(const vw_keymap *keymap, vw_binding_kind kind, int code, int mods,
                                  double *out_factor)
{
    if (kind == VW_BIND_HOLD)
        mods &= ~(GLFW_MOD_SHIFT | GLFW_MOD_ALT);
    for (size_t i = 0; i < vw_command_count; i++) {
        for (const vw_binding *b = vw_command_bindings(&vw_commands[i], keymap);
             b->kind != VW_BIND_NONE; b++) {
            if (b->kind == kind && b->code == code && b->mods == mods) {
                *out_factor = b->factor;
                return &vw_commands[i];
            }
        }
    }
    return NULL;
}

const vw_command *vw_command_named(const char *name)
{
    for (size_t i = 0; i < vw_command_count; i++)
        if (strcmp(vw_commands[i].name, name) == 0)
            return &vw_commands[i];
    return NULL;
}
