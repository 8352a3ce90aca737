/* SPDX-License-Identifier: MIT */
#include "viewer/log.h"

#include <stdlib.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

typedef struct word {
    const char *text;
    size_t bytes;
} word;

typedef struct reader {
    const char *name;
    uint32_t line;
    const char *line_begin, *at, *end; /* end: of the line, blanks and \r cut off */
    uint64_t ms;
    vw_log *log;
    size_t capacity;
    fl_diags *diags;
} reader;

typedef bool parse_fn(reader *r, vw_log_entry *entry);

static fl_loc loc_at(const reader *r, const char *at, size_t bytes)
{
    return (fl_loc){.file = r->name,
                    .line = r->line,
                    .column = (uint32_t)(at - r->line_begin) + 1,
                    .length = (uint32_t)bytes};
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

static void skip_blanks(reader *r)
{
    while (r->at < r->end && is_blank(*r->at))
        r->at++;
}

/* The next word; empty at the end of the line. */
static word next_word(reader *r)
{
    skip_blanks(r);
    word w = {r->at, 0};
    while (r->at < r->end && !is_blank(*r->at))
        r->at++;
    w.bytes = (size_t)(r->at - w.text);
    return w;
}

static bool is_word(word w, const char *text)
{
    return strlen(text) == w.bytes && memcmp(w.text, text, w.bytes) == 0;
}

static bool is_word_any_case(word w, const char *lower)
{
    if (strlen(lower) != w.bytes)
        return false;
    for (size_t i = 0; i < w.bytes; i++) {
        char c = w.text[i];
        if ((c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c) != lower[i])
            return false;
    }
    return true;
}

static bool expected(reader *r, word w, const char *what)
{
    if (w.bytes == 0)
        return fl_error(r->diags, loc_at(r, w.text, 1), "expected %s, found the end of the line",
                        what);
    return fl_error(r->diags, loc_at(r, w.text, w.bytes), "expected %s, found '%.*s'", what,
                    (int)w.bytes, w.text);
}

static bool read_count(reader *r, const char *what, int64_t least, int64_t most, uint32_t *out)
{
    word w = next_word(r);
    int64_t value;
    if (w.bytes == 0 || fl_integer_parse(w.text, w.text + w.bytes, &value) != w.text + w.bytes)
        return expected(r, w, what);
    if (value < least || value > most)
        return fl_error(r->diags, loc_at(r, w.text, w.bytes), "%s must be %lld to %lld, got %lld",
                        what, (long long)least, (long long)most, (long long)value);
    *out = (uint32_t)value;
    return true;
}

static bool read_number(reader *r, const char *what, double *out)
{
    word w = next_word(r);
    if (w.bytes == 0 || fl_number_parse(w.text, w.text + w.bytes, out) != w.text + w.bytes)
        return expected(r, w, what);
    if (!isfinite(*out) || fabs(*out) > 1e6)
        return fl_error(r->diags, loc_at(r, w.text, w.bytes), "%s must be -1e6 to 1e6, got '%.*s'",
                        what, (int)w.bytes, w.text);
    return true;
}

static bool read_action(reader *r, bool may_repeat, int *out)
{
    word w = next_word(r);
    const char *text = w.text;
    if (w.bytes > 5 && memcmp(text, "GLFW_", 5) == 0)
        w = (word){text + 5, w.bytes - 5};
    if (is_word_any_case(w, "press"))
        *out = GLFW_PRESS;
    else if (is_word_any_case(w, "release"))
        *out = GLFW_RELEASE;
    else if (may_repeat && is_word_any_case(w, "repeat"))
        *out = GLFW_REPEAT;
    else
        return expected(r, w, may_repeat ? "press, release or repeat" : "press or release");
    return true;
}

/* Modifiers, up to the end of the line. */
static bool read_mods(reader *r, int *out)
{
    static const struct {
        int mod;
        const char *name, *long_name;
    } mods[] = {{GLFW_MOD_SHIFT, "shift", "mod_shift"},
                {GLFW_MOD_CONTROL, "control", "mod_control"},
                {GLFW_MOD_ALT, "alt", "mod_alt"},
                {GLFW_MOD_SUPER, "super", "mod_super"}};
    for (word w = next_word(r); w.bytes > 0; w = next_word(r)) {
        word bare =
            w.bytes > 5 && memcmp(w.text, "GLFW_", 5) == 0 ? (word){w.text + 5, w.bytes - 5} : w;
        bool is_known = false;
        for (size_t i = 0; i < FL_COUNT_OF(mods) && !is_known; i++) {
            is_known =
                is_word_any_case(bare, mods[i].name) || is_word_any_case(bare, mods[i].long_name);
            *out |= is_known ? mods[i].mod : 0;
        }
        if (!is_known)
            return expected(r, w, "SHIFT, CONTROL, ALT, SUPER or the end of the line");
    }
    return true;
}

static bool read_end(reader *r)
{
    word w = next_word(r);
    return w.bytes == 0 || expected(r, w, "the end of the line");
}

/* All that is left of the line, or up to `stop`. */
static bool read_path(reader *r, const char *stop, const char *what, char out[VW_PATH_MAX])
{
    skip_blanks(r);
    const char *end = stop;
    while (end > r->at && is_blank(end[-1]))
        end--;
    if (end <= r->at)
        return expected(r, (word){r->at, 0}, what);
    size_t bytes = (size_t)(end - r->at);
    if (bytes >= VW_PATH_MAX || memchr(r->at, 0, bytes))
        return fl_error(r->diags, loc_at(r, r->at, bytes),
                        "%s is longer than %d bytes or holds a zero byte", what, VW_PATH_MAX - 1);
    memcpy(out, r->at, bytes);
    out[bytes] = 0;
    r->at = stop;
    return true;
}

static bool unknown_name(reader *r, word w, const char *what, const char *nearest)
{
    if (w.bytes == 0)
        return expected(r, w, what);
    if (nearest)
        return fl_error(r->diags, loc_at(r, w.text, w.bytes),
                        "unknown %s '%.*s'; did you mean '%s'?", what, (int)w.bytes, w.text,
                        nearest);
    return fl_error(r->diags, loc_at(r, w.text, w.bytes), "unknown %s '%.*s'; the names are GLFW's",
                    what, (int)w.bytes, w.text);
}

static bool parse_key(reader *r, vw_log_entry *entry)
{
    word w = next_word(r);
    entry->event.kind = VW_EVENT_KEY;
    entry->event.code = vw_key_find(w.text, w.bytes);
    if (entry->event.code < 0)
        return unknown_name(r, w, "key", vw_key_nearest(w.text, w.bytes));
    return read_action(r, true, &entry->event.action) && read_mods(r, &entry->event.mods);
}

static bool parse_button(reader *r, vw_log_entry *entry)
{
    word w = next_word(r);
    entry->event.kind = VW_EVENT_BUTTON;
    entry->event.code = vw_button_find(w.text, w.bytes);
    if (entry->event.code < 0)
        return unknown_name(r, w, "button", vw_button_nearest(w.text, w.bytes));
    return read_action(r, false, &entry->event.action) && read_mods(r, &entry->event.mods);
}

static bool parse_axis(reader *r, vw_log_entry *entry)
{
    word w = next_word(r);
    entry->event.kind = VW_EVENT_AXIS;
    entry->event.code = vw_axis_find(w.text, w.bytes);
    if (entry->event.code < 0)
        return unknown_name(r, w, "axis", NULL);
    skip_blanks(r);
    word value = {r->at, (size_t)(r->end - r->at)};
    if (!read_number(r, "the axis", &entry->event.x))
        return false;
    if (fabs(entry->event.x) > 1.0)
        return fl_error(r->diags, loc_at(r, value.text, value.bytes), "the axis must be -1 to 1");
    return read_end(r);
}

static bool parse_pad(reader *r, vw_log_entry *entry)
{
    word w = next_word(r);
    entry->event.kind = VW_EVENT_PAD;
    entry->event.code = vw_pad_find(w.text, w.bytes);
    if (entry->event.code < 0)
        return unknown_name(r, w, "gamepad button", NULL);
    return read_action(r, false, &entry->event.action) && read_end(r);
}

static bool parse_cursor(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_CURSOR;
    return read_number(r, "the cursor's x", &entry->event.x) &&
           read_number(r, "the cursor's y", &entry->event.y) && read_end(r);
}

static bool parse_scroll(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_SCROLL;
    return read_number(r, "the scroll's x", &entry->event.x) &&
           read_number(r, "the scroll's y", &entry->event.y) && read_mods(r, &entry->event.mods);
}

static bool parse_resize(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_RESIZE;
    return read_count(r, "the width", 1, FL_SIDE_MAX, &entry->event.width) &&
           read_count(r, "the height", 1, FL_SIDE_MAX, &entry->event.height) && read_end(r);
}

static bool parse_scale(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_SCALE;
    skip_blanks(r);
    word value = {r->at, (size_t)(r->end - r->at)};
    if (!read_number(r, "the scale", &entry->event.x))
        return false;
    if (!(entry->event.x >= VW_SCALE_MIN && entry->event.x <= VW_SCALE_MAX))
        return fl_error(r->diags, loc_at(r, value.text, value.bytes), "the scale must be %g to %g",
                        VW_SCALE_MIN, VW_SCALE_MAX);
    return read_end(r);
}

static bool parse_drop(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_DROP;
    return read_path(r, r->end, "a file", entry->event.path);
}

static bool parse_reload(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_RELOAD;
    return read_end(r);
}

static bool parse_paste(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_PASTE;
    return read_path(r, r->end, "a camera as text", entry->event.path);
}

static bool parse_focus(reader *r, vw_log_entry *entry)
{
    word w = next_word(r);
    entry->event.kind = VW_EVENT_FOCUS;
    return is_word(w, "lost") ? read_end(r) : expected(r, w, "lost");
}

static bool parse_iconify(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_ICONIFY;
    entry->event.action = GLFW_PRESS;
    return read_end(r);
}

static bool parse_restore(reader *r, vw_log_entry *entry)
{
    entry->event.kind = VW_EVENT_ICONIFY;
    entry->event.action = GLFW_RELEASE;
    return read_end(r);
}

static bool parse_picture(reader *r, vw_log_kind kind, vw_log_entry *entry)
{
    /* The file's name may hold blanks: the number of samples is the last word. */
    const char *number = r->end;
    while (number > r->at && !is_blank(number[-1]))
        number--;
    entry->kind = kind;
    return read_path(r, number, "a file and a number of samples", entry->file) &&
           read_count(r, "the number of samples", 1, VW_LOG_SAMPLES_MAX, &entry->samples);
}

static bool parse_snapshot(reader *r, vw_log_entry *entry)
{
    return parse_picture(r, VW_LOG_SNAPSHOT, entry);
}

static bool parse_window(reader *r, vw_log_entry *entry)
{
    return parse_picture(r, VW_LOG_WINDOW, entry);
}

static bool parse_quit(reader *r, vw_log_entry *entry)
{
    entry->kind = VW_LOG_QUIT;
    return read_end(r);
}

static const struct {
    const char *name;
    parse_fn *parse;
} kinds[] = {
    {"key", parse_key},         {"button", parse_button},     {"cursor", parse_cursor},
    {"scroll", parse_scroll},   {"resize", parse_resize},     {"drop", parse_drop},
    {"focus", parse_focus},     {"snapshot", parse_snapshot}, {"quit", parse_quit},
    {"paste", parse_paste},     {"window", parse_window},     {"iconify", parse_iconify},
    {"restore", parse_restore}, {"axis", parse_axis},         {"pad", parse_pad},
    {"scale", parse_scale},     {"reload", parse_reload},
};

static bool add_entry(reader *r, const vw_log_entry *entry)
{
    if (r->log->entry_count == r->capacity) {
        size_t capacity = r->capacity ? 2 * r->capacity : 64;
        vw_log_entry *entries = realloc(r->log->entries, capacity * sizeof *entries);
        if (!entries)
            return fl_out_of_memory(r->diags, "the log");
        r->log->entries = entries;
        r->capacity = capacity;
    }
    r->log->entries[r->log->entry_count++] = *entry;
    return true;
}

static bool parse_line(reader *r)
{
    word w = next_word(r);
    if (w.bytes == 0 || w.text[0] == '#')
        return true;
    vw_log_entry entry = {.line = r->line};
    int64_t ms;
    if (fl_integer_parse(w.text, w.text + w.bytes, &ms) != w.text + w.bytes || ms < 0 ||
        ms > (int64_t)1 << 40)
        return expected(r, w, "a time in whole milliseconds");
    if ((uint64_t)ms < r->ms)
        return fl_error(r->diags, loc_at(r, w.text, w.bytes),
                        "time goes back: %lld ms after %llu ms", (long long)ms,
                        (unsigned long long)r->ms);
    entry.ms = r->ms = (uint64_t)ms;
    w = next_word(r);
    const char *names[FL_COUNT_OF(kinds)];
    for (size_t i = 0; i < FL_COUNT_OF(kinds); i++) {
        if (is_word(w, kinds[i].name))
            return kinds[i].parse(r, &entry) && add_entry(r, &entry);
        names[i] = kinds[i].name;
    }
    const char *nearest =
        w.bytes ? fl_nearest_name(w.text, w.bytes, names, FL_COUNT_OF(names)) : NULL;
    if (nearest)
        return unknown_name(r, w, "event", nearest);
    return expected(r, w,
                    "key, button, cursor, scroll, resize, drop, reload, paste, snapshot, window or "
                    "quit");
}

static bool parse_header(reader *r)
{
    word magic = next_word(r), version = next_word(r);
    if (!is_word(magic, "firstlight-log"))
        return expected(r, magic, "'firstlight-log 1 WIDTHxHEIGHT SCENE' as the first line");
    if (!is_word(version, "1"))
        return expected(r, version, "version 1");
    word size = next_word(r);
    const char *end = size.text + size.bytes;
    int64_t width, height;
    const char *x = fl_integer_parse(size.text, end, &width);
    const char *last = x && x < end && *x == 'x' ? fl_integer_parse(x + 1, end, &height) : NULL;
    if (last != end || !last)
        return expected(r, size, "a size like 640x480");
    if (width < 1 || height < 1 || width > FL_SIDE_MAX || height > FL_SIDE_MAX)
        return fl_error(r->diags, loc_at(r, size.text, size.bytes), "the sides must be 1 to %d",
                        FL_SIDE_MAX);
    r->log->width = (uint32_t)width;
    r->log->height = (uint32_t)height;
    return read_path(r, r->end, "a scene", r->log->scene);
}

bool vw_log_parse(const char *text, size_t text_bytes, const char *name, vw_log *out,
                  fl_diags *diags)
{
    *out = (vw_log){0};
    reader r = {.name = name, .log = out, .diags = diags};
    uint32_t errors_before = diags->error_count;
    fl_diags_set_text(diags, name, text, text_bytes);
    const char *end = text + text_bytes;
    for (const char *line = text; line < end || r.line == 0;) {
        const char *stop = line < end ? memchr(line, '\n', (size_t)(end - line)) : NULL;
        stop = stop ? stop : end;
        r.line++;
        r.line_begin = r.at = line;
        r.end = stop;
        while (r.end > line && is_blank(r.end[-1]))
            r.end--;
        bool is_fine = r.line == 1 ? parse_header(&r) : parse_line(&r);
        if (!is_fine && r.line == 1)
            break;
        line = stop < end ? stop + 1 : end;
    }
    fl_diags_set_text(diags, NULL, NULL, 0);
    if (diags->error_count == errors_before)
        return true;
    vw_log_deinit(out);
    return false;
}

void vw_log_deinit(vw_log *log)
{
    free(log->entries);
    *log = (vw_log){0};
}
