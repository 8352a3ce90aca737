/* SPDX-License-Identifier: MIT */
#include "viewer/keymap.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "io/files.h"
#include "viewer/event.h"

enum { FILE_BYTES_MAX = 1 << 20 };

void vw_keymap_init(vw_keymap *keymap)
{
    FL_ASSERT(vw_command_count <= VW_COMMANDS_MAX);
    memset(keymap, 0, sizeof *keymap);
    for (size_t i = 0; i < vw_command_count; i++)
        memcpy(keymap->bindings[i], vw_commands[i].bindings, sizeof keymap->bindings[i]);
}

typedef struct reader {
    vw_keymap *keymap;
    const char *name, *begin, *at, *end; /* Of the line. */
    uint32_t line;
    fl_diags *diags;
} reader;

typedef struct word {
    const char *text;
    size_t bytes;
} word;

static fl_loc loc_of(const reader *r, word w)
{
    return (fl_loc){.file = r->name,
                    .line = r->line,
                    .column = (uint32_t)(w.text - r->begin) + 1,
                    .length = (uint32_t)w.bytes};
}

static word next_word(reader *r)
{
    while (r->at < r->end && (*r->at == ' ' || *r->at == '\t' || *r->at == '\r'))
        r->at++;
    word w = {r->at, 0};
    while (r->at < r->end && *r->at != ' ' && *r->at != '\t' && *r->at != '\r')
        r->at++;
    w.bytes = (size_t)(r->at - w.text);
    return w;
}

static bool is_word(word w, const char *text)
{
    return strlen(text) == w.bytes && strncasecmp(w.text, text, w.bytes) == 0;
}

static int printed_key(word w)
{
    static const struct {
        const char *text;
        int key;
    } keys[] = {
        {"[", GLFW_KEY_LEFT_BRACKET}, {"]", GLFW_KEY_RIGHT_BRACKET}, {",", GLFW_KEY_COMMA},
        {".", GLFW_KEY_PERIOD},       {"-", GLFW_KEY_MINUS},         {"=", GLFW_KEY_EQUAL},
        {"/", GLFW_KEY_SLASH},        {";", GLFW_KEY_SEMICOLON},     {"'", GLFW_KEY_APOSTROPHE},
        {"\\", GLFW_KEY_BACKSLASH},   {"Esc", GLFW_KEY_ESCAPE},      {"PgUp", GLFW_KEY_PAGE_UP},
        {"PgDn", GLFW_KEY_PAGE_DOWN}};
    for (size_t i = 0; i < FL_COUNT_OF(keys); i++)
        if (is_word(w, keys[i].text))
            return keys[i].key;
    return -1;
}

static bool unknown(const reader *r, word w, const char *what, const char *nearest)
{
    if (nearest)
        return fl_error(r->diags, loc_of(r, w), "unknown %s '%.*s'; did you mean '%s'?", what,
                        (int)w.bytes, w.text, nearest);
    return fl_error(r->diags, loc_of(r, w), "unknown %s '%.*s'", what, (int)w.bytes, w.text);
}

/* Modifiers before a plus sign; the rest stays in *w. */
static int take_mods(word *w)
{
    static const struct {
        const char *text;
        int mod;
    } mods[] = {{"Ctrl+", GLFW_MOD_CONTROL},
                {"Control+", GLFW_MOD_CONTROL},
                {"Shift+", GLFW_MOD_SHIFT},
                {"Alt+", GLFW_MOD_ALT}};
    int all = 0;
    for (size_t i = 0; i < FL_COUNT_OF(mods); i++) {
        size_t bytes = strlen(mods[i].text);
        if (w->bytes > bytes && strncasecmp(w->text, mods[i].text, bytes) == 0) {
            all |= mods[i].mod;
            *w = (word){w->text + bytes, w->bytes - bytes};
            i = (size_t)-1; /* Again from the first. */
        }
    }
    return all;
}

/* What the chord is of, for a binding of that kind. */
static bool read_code(const reader *r, word w, vw_binding *binding)
{
    switch (binding->kind) {
    case VW_BIND_WHEEL:
        return is_word(w, "wheel") ||
               fl_error(r->diags, loc_of(r, w), "expected wheel, found '%.*s'", (int)w.bytes,
                        w.text);
    case VW_BIND_DRAG:
    case VW_BIND_CLICK:
        binding->code = vw_button_find(w.text, w.bytes);
        return binding->code >= 0 || unknown(r, w, "button", vw_button_nearest(w.text, w.bytes));
    case VW_BIND_PRESS:
    case VW_BIND_WHILE:
    case VW_BIND_HOLD:
    case VW_BIND_NONE:
        break;
    }
    binding->code = printed_key(w);
    if (binding->code < 0)
        binding->code = vw_key_find(w.text, w.bytes);
    if (binding->code < 0)
        return unknown(r, w, "key", vw_key_nearest(w.text, w.bytes));
    return !vw_key_modifier(binding->code) ||
           fl_error(r->diags, loc_of(r, w), "'%.*s' goes with other keys and is none by itself",
                    (int)w.bytes, w.text);
}

static bool read_chords(reader *r, size_t command)
{
    const vw_binding *table = vw_commands[command].bindings;
    vw_binding *out = r->keymap->bindings[command];
    size_t count = 0;
    memset(out, 0, sizeof r->keymap->bindings[command]);
    for (word w = next_word(r); w.bytes > 0 && w.text[0] != '#'; w = next_word(r)) {
        if (count == 0 && is_word(w, "none"))
            return true;
        if (table[count].kind == VW_BIND_NONE)
            return fl_error(r->diags, loc_of(r, w), "'%s' takes %zu chord%s at most",
                            vw_commands[command].name, count, count == 1 ? "" : "s");
        word whole = w;
        vw_binding binding = table[count];
        binding.mods = take_mods(&w);
        if (!read_code(r, w, &binding))
            return false;
        if (binding.kind == VW_BIND_HOLD && binding.mods)
            return fl_error(r->diags, loc_of(r, whole),
                            "'%s' takes keys alone: Shift and Alt make it fast and slow",
                            vw_commands[command].name);
        out[count++] = binding;
    }
    return count > 0 || fl_error(r->diags, loc_of(r, (word){r->at, 1}),
                                 "expected a chord or none, found the end of the line");
}

static bool read_line(reader *r)
{
    const char *names[VW_COMMANDS_MAX];
    word name = next_word(r);
    if (name.bytes == 0 || name.text[0] == '#')
        return true;
    for (size_t i = 0; i < vw_command_count; i++) {
        names[i] = vw_commands[i].name;
        if (!is_word(name, names[i]))
            continue;
        word equals = next_word(r);
        if (!is_word(equals, "="))
            return fl_error(r->diags, loc_of(r, equals), "expected '=' after '%s'", names[i]);
        if (r->keymap->lines[i])
            return fl_error(r->diags, loc_of(r, name), "'%s' was given in line %u", names[i],
                            r->keymap->lines[i]);
        r->keymap->lines[i] = r->line;
        return read_chords(r, i);
    }
    return unknown(r, name, "command",
                   fl_nearest_name(name.text, name.bytes, names, vw_command_count));
}

/* Whether one input would reach both. A held key takes its key from presses, with Shift and Alt
 * too; a click and a drag share buttons only by modifiers. */
static bool is_same_chord(const vw_binding *a, const vw_binding *b)
{
    static const int device[] = {[VW_BIND_PRESS] = 1, [VW_BIND_WHILE] = 1, [VW_BIND_HOLD] = 1,
                                 [VW_BIND_DRAG] = 2,  [VW_BIND_CLICK] = 2, [VW_BIND_WHEEL] = 3};
    int free_mods =
        a->kind == VW_BIND_HOLD || b->kind == VW_BIND_HOLD ? GLFW_MOD_SHIFT | GLFW_MOD_ALT : 0;
    return device[a->kind] == device[b->kind] && a->code == b->code &&
           (a->mods & ~free_mods) == (b->mods & ~free_mods);
}

bool vw_keymap_find_conflict(const vw_keymap *keymap, size_t *out_first, size_t *out_second)
{
    for (size_t i = 0; i < vw_command_count; i++)
        for (size_t j = i; j < vw_command_count; j++)
            for (const vw_binding *a = keymap->bindings[i]; a->kind != VW_BIND_NONE; a++)
                for (const vw_binding *b = i == j ? a + 1 : keymap->bindings[j];
                     b->kind != VW_BIND_NONE; b++)
                    if (is_same_chord(a, b)) {
                        *out_first = i;
                        *out_second = j;
                        return true;
                    }
    return false;
}

static void report_conflict(const reader *r)
{
    size_t first, second;
    if (!vw_keymap_find_conflict(r->keymap, &first, &second))
        return;
    /* At the file's line: the table alone has none. */
    size_t own = r->keymap->lines[second] ? second : first, other = own == second ? first : second;
    fl_error(r->diags, (fl_loc){.file = r->name, .line = r->keymap->lines[own], .column = 1},
             "a chord of '%s' belongs to '%s' too: give that one another, or none",
             vw_commands[own].name, vw_commands[other].name);
}

bool vw_keymap_parse(vw_keymap *keymap, const char *text, size_t text_bytes, const char *name,
                     fl_diags *diags)
{
    reader r = {.keymap = keymap, .name = name, .diags = diags};
    uint32_t errors_before = diags->error_count;
    const char *end = text + text_bytes;
    fl_diags_set_text(diags, name, text, text_bytes);
    for (const char *line = text; line < end;) {
        const char *stop = memchr(line, '\n', (size_t)(end - line));
        r.begin = r.at = line;
        r.end = stop ? stop : end;
        r.line++;
        read_line(&r);
        line = stop ? stop + 1 : end;
    }
    if (diags->error_count == errors_before)
        report_conflict(&r);
    fl_diags_set_text(diags, NULL, NULL, 0);
    if (diags->error_count == errors_before)
        return true;
    vw_keymap_init(keymap);
    return false;
}

bool vw_keymap_load(vw_keymap *keymap, const char *path, fl_diags *diags)
{
    char own[1200];
    if (!path) {
        const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
        bool is_named = config && config[0];
        int bytes = snprintf(own, sizeof own, "%s%s/firstlight/keys",
                             is_named ? config : (home ? home : ""), is_named ? "" : "/.config");
        if (bytes < 0 || (size_t)bytes >= sizeof own || access(own, F_OK) != 0)
            return true;
        path = own;
    }
    size_t text_bytes;
    char *text =
        fl_file_load(path, "keys", FILE_BYTES_MAX, (fl_loc){.file = path}, diags, &text_bytes);
    bool is_fine = text && vw_keymap_parse(keymap, text, text_bytes, path, diags);
    free(text);
    return is_fine;
}
