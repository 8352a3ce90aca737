/* SPDX-License-Identifier: MIT
 *
 * The file of keys: what is accepted binds as the table does, to known keys, no chord to two
 * commands, and reads the same again when written out. What is not leaves the table's own keys, and
 * says where it is wrong.
 */
#define _POSIX_C_SOURCE 200809L
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "fuzz/fuzz.h"
#include "io/files.h"
#include "viewer/event.h"
#include "viewer/keymap.h"

/* The text is there already. */
char *fl_file_load(const char *path, const char *what, size_t max_bytes, fl_loc loc,
                   fl_diags *diags, size_t *out_bytes)
{
    (void)path, (void)what, (void)max_bytes, (void)loc, (void)diags, (void)out_bytes;
    abort();
}

static const char *code_name(const vw_binding *binding)
{
    if (binding->kind == VW_BIND_WHEEL)
        return "wheel";
    bool is_button = binding->kind == VW_BIND_DRAG || binding->kind == VW_BIND_CLICK;
    const char *name = is_button ? vw_button_name(binding->code) : vw_key_name(binding->code);
    MUST(name);
    return name;
}

static void check_command(const vw_keymap *keymap, size_t command, FILE *out)
{
    const vw_binding *table = vw_commands[command].bindings, *own = keymap->bindings[command];
    fprintf(out, "%s =%s", vw_commands[command].name, own->kind == VW_BIND_NONE ? " none" : "");
    for (size_t i = 0; own[i].kind != VW_BIND_NONE; i++) {
        double factor;
        MUST(i < VW_BINDINGS_MAX);
        MUST(own[i].kind == table[i].kind && own[i].factor == table[i].factor);
        MUST((own[i].mods & ~(GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT)) == 0);
        MUST(own[i].kind != VW_BIND_HOLD || own[i].mods == 0);
        MUST(vw_command_find(keymap, own[i].kind, own[i].code, own[i].mods, &factor) ==
             &vw_commands[command]);
        fprintf(out, " %s%s%s%s", own[i].mods & GLFW_MOD_CONTROL ? "Ctrl+" : "",
                own[i].mods & GLFW_MOD_SHIFT ? "Shift+" : "",
                own[i].mods & GLFW_MOD_ALT ? "Alt+" : "", code_name(&own[i]));
    }
    fprintf(out, "\n");
}

static void check_accepted(const vw_keymap *keymap)
{
    static vw_keymap again;
    size_t text_bytes, first, second;
    char *text = NULL;
    fl_diags diags = {0};
    FILE *out = open_memstream(&text, &text_bytes);
    MUST(out);
    MUST(!vw_keymap_find_conflict(keymap, &first, &second));
    for (size_t i = 0; i < vw_command_count; i++)
        check_command(keymap, i, out);
    fclose(out);
    vw_keymap_init(&again);
    MUST(vw_keymap_parse(&again, text, text_bytes, "written", &diags));
    for (size_t i = 0; i < vw_command_count; i++)
        for (size_t k = 0; k <= VW_BINDINGS_MAX; k++) {
            const vw_binding *a = &keymap->bindings[i][k], *b = &again.bindings[i][k];
            MUST(a->kind == b->kind && a->code == b->code && a->mods == b->mods);
        }
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    static vw_keymap keymap, table;
    fl_diags diags = {0};
    uint32_t lines = 1;
    for (size_t i = 0; i < bytes; i++)
        lines += data[i] == '\n';
    vw_keymap_init(&table);
    vw_keymap_init(&keymap);
    bool ok = vw_keymap_parse(&keymap, (const char *)data, bytes, "fuzz.keys", &diags);
    MUST(ok == (diags.error_count == 0));
    if (ok)
        check_accepted(&keymap);
    else
        MUST(memcmp(&keymap, &table, sizeof table) == 0);
    for (uint32_t i = 0; i < diags.count; i++) {
        MUST(diags.items[i].message[0]);
        MUST(diags.items[i].loc.line >= 1 && diags.items[i].loc.line <= lines);
        MUST(diags.items[i].loc.column >= 1 && diags.items[i].loc.column <= bytes + 1);
    }
    fl_diags_deinit(&diags);
    return 0;
}
