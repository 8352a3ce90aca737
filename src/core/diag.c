/* SPDX-License-Identifier: MIT */
#include "core/diag.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MESSAGE_BYTES = 512, /* longer messages are cut */
    LINE_BYTES = 240,    /* longer source lines are cut; a place beyond is not quoted */
    WORD_BYTES = 64      /* longer words have no nearest name */
};

/* Stands for an error whose own message there was no memory for. Never freed. */
static const char no_memory[] = "out of memory, even for the message";

static void free_message(char *message)
{
    if (message != no_memory)
        free(message);
}

void fl_diags_set_text(fl_diags *diags, const char *file, const char *text, size_t text_bytes)
{
    diags->text_file = file;
    diags->text = text;
    diags->text_bytes = text_bytes;
}

/* Find line number `line` in the text; NULL when there is none. */
static const char *find_line(const fl_diags *diags, uint32_t line, size_t *out_bytes)
{
    const char *at = diags->text, *end = at + diags->text_bytes;
    for (uint32_t i = 1; i < line; i++) {
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        if (!newline)
            return NULL;
        at = newline + 1;
    }
    const char *newline = memchr(at, '\n', (size_t)(end - at));
    size_t bytes = (size_t)((newline ? newline : end) - at);
    if (bytes > 0 && at[bytes - 1] == '\r')
        bytes--;
    *out_bytes = bytes;
    return at;
}

/* Input may hold any bytes; what reaches a terminal holds no control characters but tabs. */
static void copy_printable(char *out, const char *text, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++) {
        unsigned char c = (unsigned char)text[i];
        out[i] = (c < 0x20 && c != '\t') || c == 0x7f ? '?' : (char)c;
    }
    out[bytes] = '\0';
}

/* The same text without the piece of a UTF-8 character that cutting may have left at its end. */
static size_t whole_characters(const char *text, size_t bytes)
{
    size_t begin = bytes;
    while (begin > 0 && bytes - begin < 3 && ((unsigned char)text[begin - 1] & 0xc0) == 0x80)
        begin--;
    if (begin == 0 || (unsigned char)text[begin - 1] < 0xc0)
        return bytes; /* plain, or no UTF-8 at all */
    unsigned char lead = (unsigned char)text[begin - 1];
    size_t wanted = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    return bytes - begin < wanted ? begin - 1 : bytes;
}

/* The list is full: give up the newest warning, with its notes, in favour of an error. */
static bool drop_newest_warning(fl_diags *diags)
{
    for (uint32_t i = diags->count; i-- > 0;) {
        if (diags->items[i].severity != FL_WARNING)
            continue;
        uint32_t end = i + 1;
        while (end < diags->count && diags->items[end].severity == FL_NOTE)
            end++;
        for (uint32_t j = i; j < end; j++)
            free_message(diags->items[j].message);
        memmove(&diags->items[i], &diags->items[end], (diags->count - end) * sizeof(fl_diag));
        diags->count -= end - i;
        diags->dropped_count++;
        return true;
    }
    return false;
}

static void add(fl_diags *diags, fl_severity severity, fl_cause cause, fl_loc loc,
                const char *format, va_list args) FL_PRINTF(5, 0);

static void add(fl_diags *diags, fl_severity severity, fl_cause cause, fl_loc loc,
                const char *format, va_list args)
{
    diags->error_count += severity == FL_ERROR;
    diags->warning_count += severity == FL_WARNING;
    bool has_room =
        diags->count < FL_DIAGS_MAX || (severity == FL_ERROR && drop_newest_warning(diags));
    if (severity == FL_NOTE && diags->dropped_count > 0)
        has_room = false; /* what it explains may have been dropped */

    char message[MESSAGE_BYTES];
    int printed = vsnprintf(message, sizeof message, format, args);
    size_t message_bytes = printed < 0 ? 0 : strlen(message);
    if (printed >= (int)sizeof message)
        message_bytes = whole_characters(message, message_bytes);
    const char *line = NULL;
    size_t line_bytes = 0;
    if (has_room && loc.file && loc.line > 0 && diags->text && diags->text_file &&
        strcmp(loc.file, diags->text_file) == 0)
        line = find_line(diags, loc.line, &line_bytes);
    if (line_bytes > LINE_BYTES)
        line_bytes = whole_characters(line, LINE_BYTES);
    if (loc.column > line_bytes + 1)
        line = NULL;

    /* One piece of memory holds message, file name and source line. */
    size_t file_bytes = loc.file ? strlen(loc.file) : 0;
    char *memory = has_room ? malloc(message_bytes + file_bytes + line_bytes + 3) : NULL;
    if (has_room && !memory &&
        severity == FL_ERROR) { /* The machine is the cause, whatever it was. */
        diags->items[diags->count++] = (fl_diag){
            .severity = FL_ERROR, .cause = FL_CAUSE_ENVIRONMENT, .message = (char *)no_memory};
        return;
    }
    if (!memory) {
        diags->dropped_count += severity != FL_NOTE;
        return;
    }
    fl_diag *diag = &diags->items[diags->count++];
    *diag = (fl_diag){.severity = severity, .cause = cause, .loc = loc, .message = memory};
    copy_printable(memory, message, message_bytes);
    memory += message_bytes + 1;
    copy_printable(memory, loc.file ? loc.file : "", file_bytes);
    diag->loc.file = loc.file ? memory : NULL;
    memory += file_bytes + 1;
    copy_printable(memory, line ? line : "", line ? line_bytes : 0);
    diag->source_line = line ? memory : NULL;
}

bool fl_error(fl_diags *diags, fl_loc loc, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add(diags, FL_ERROR, FL_CAUSE_INPUT, loc, format, args);
    va_end(args);
    return false;
}

bool fl_environment_error(fl_diags *diags, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add(diags, FL_ERROR, FL_CAUSE_ENVIRONMENT, (fl_loc){0}, format, args);
    va_end(args);
    return false;
}

bool fl_out_of_memory(fl_diags *diags, const char *what)
{
    return fl_environment_error(diags, "out of memory for %s", what);
}

void fl_warning(fl_diags *diags, fl_loc loc, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add(diags, FL_WARNING, FL_CAUSE_INPUT, loc, format, args);
    va_end(args);
}

void fl_note(fl_diags *diags, fl_loc loc, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add(diags, FL_NOTE, FL_CAUSE_INPUT, loc, format, args);
    va_end(args);
}

/* Text into a buffer that may be too small: `length` counts what there would be. */
typedef struct sink {
    char *out;
    size_t capacity, length;
} sink;

static void put_bytes(sink *s, const char *text, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++, s->length++)
        if (s->length + 1 < s->capacity)
            s->out[s->length] = text[i];
}

static void put_text(sink *s, const char *text)
{
    put_bytes(s, text, strlen(text));
}

/* The line of text, and a caret line with the same tabs, so that it lines up in any terminal. */
static void put_source(sink *s, const fl_diag *diag)
{
    char gutter[32];
    snprintf(gutter, sizeof gutter, "\n%5u | ", (unsigned)diag->loc.line);
    put_text(s, gutter);
    put_text(s, diag->source_line);
    put_text(s, "\n      | ");
    size_t line_bytes = strlen(diag->source_line);
    size_t begin = diag->loc.column > 0 ? diag->loc.column - 1u : 0;
    for (size_t i = 0; i < begin && i < line_bytes; i++) {
        unsigned char c = (unsigned char)diag->source_line[i];
        if (c < 0x80 || c >= 0xc0) /* UTF-8 continuation bytes take no place */
            put_bytes(s, c == '\t' ? "\t" : " ", 1);
    }
    put_bytes(s, "^", 1);
    for (size_t i = begin + 1; i < begin + diag->loc.length && i < line_bytes; i++)
        put_bytes(s, "~", 1);
}

size_t fl_diag_format(const fl_diag *diag, char *out, size_t out_bytes)
{
    static const char *const severities[] = {"note", "warning", "error"};
    sink s = {.out = out, .capacity = out_bytes};
    if (diag->loc.file) {
        put_text(&s, diag->loc.file);
        char place[32] = ":";
        if (diag->loc.line > 0)
            snprintf(place, sizeof place, ":%u:%u:", (unsigned)diag->loc.line,
                     (unsigned)diag->loc.column);
        put_text(&s, place);
        put_text(&s, " ");
    }
    put_text(&s, severities[diag->severity]);
    put_text(&s, ": ");
    put_text(&s, diag->message);
    if (diag->source_line)
        put_source(&s, diag);
    if (out_bytes > 0)
        out[s.length < out_bytes ? s.length : out_bytes - 1] = '\0';
    return s.length;
}

void fl_diags_deinit(fl_diags *diags)
{
    for (uint32_t i = 0; i < diags->count; i++)
        free_message(diags->items[i].message);
    *diags = (fl_diags){0};
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

/* Twice the edit distance, so that a change of case can count half. Both at most WORD_BYTES long.
 * Restricted Damerau-Levenshtein: three rows of the dynamic programme. */
static unsigned edit_distance2(const char *a, size_t a_bytes, const char *b, size_t b_bytes)
{
    unsigned rows[3][WORD_BYTES + 1];
    unsigned *before = rows[0], *previous = rows[1], *current = rows[2];
    for (size_t j = 0; j <= b_bytes; j++)
        previous[j] = 2u * (unsigned)j;
    for (size_t i = 1; i <= a_bytes; i++) {
        current[0] = 2u * (unsigned)i;
        for (size_t j = 1; j <= b_bytes; j++) {
            char x = a[i - 1], y = b[j - 1];
            unsigned cost = x == y ? 0u : lower(x) == lower(y) ? 1u : 2u;
            unsigned best = previous[j - 1] + cost;
            best = fl_min_u32(best, previous[j] + 2u);
            best = fl_min_u32(best, current[j - 1] + 2u);
            if (i > 1 && j > 1 && x == b[j - 2] && a[i - 2] == y)
                best = fl_min_u32(best, before[j - 2] + 2u);
            current[j] = best;
        }
        unsigned *oldest = before;
        before = previous;
        previous = current;
        current = oldest;
    }
    return previous[b_bytes];
}

const char *fl_nearest_name(const char *word, size_t word_bytes, const char *const *candidates,
                            size_t candidate_count)
{
    const char *nearest = NULL;
    unsigned least = 2u * 2u + 1u;
    if (word_bytes == 0 || word_bytes > WORD_BYTES)
        return NULL;
    for (size_t i = 0; i < candidate_count; i++) {
        size_t bytes = strlen(candidates[i]);
        if (bytes > WORD_BYTES || bytes > word_bytes + 2 || word_bytes > bytes + 2)
            continue;
        unsigned distance = edit_distance2(word, word_bytes, candidates[i], bytes);
        if (distance < least && distance < 2u * word_bytes) {
            least = distance;
            nearest = candidates[i];
        }
    }
    return nearest;
}
