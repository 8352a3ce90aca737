/* SPDX-License-Identifier: MIT
 *
 * Layer 1: located diagnostics. The core never prints: it adds values to a bounded list, and the
 * program's main formats them. A stage that needs its predecessor clean runs only when
 * `error_count` is 0.
 */
#ifndef FL_DIAG_H
#define FL_DIAG_H

#include "core/base.h"

/** At most this many diagnostics are kept; later ones are only counted (`dropped_count`). */
enum { FL_DIAGS_MAX = 32 };

/** A place in a text. `file` is borrowed for the duration of the call that takes the location.
 *  line 0: the file as a whole. file NULL: no place at all (out of memory, a failing system call). */
typedef struct fl_loc {
    const char *file;
    uint32_t line, column; /**< 1-based; the column counts bytes. */
    uint32_t length;       /**< Bytes to underline; 0 counts as 1. */
} fl_loc;

typedef enum fl_severity { FL_NOTE, FL_WARNING, FL_ERROR } fl_severity;

/** What went wrong, by kind: it decides the exit code of a program. */
typedef enum fl_cause {
    FL_CAUSE_INPUT,      /**< A scene, image, mesh or log is wrong: exit 3. */
    FL_CAUSE_ENVIRONMENT /**< Out of memory, disk full, no display: exit 4. */
} fl_cause;

/** One message. All text is owned by the list it stands in. */
typedef struct fl_diag {
    fl_severity severity;
    fl_cause cause;
    fl_loc loc;        /**< loc.file points into this diagnostic's own memory. */
    char *message;     /**< One sentence, lower case, no full stop, no place. */
    char *source_line; /**< The line of text at `loc`, without its end, or NULL. */
} fl_diag;

/** Zero-initialise ({0}) to begin. Not thread-safe. */
typedef struct fl_diags {
    fl_diag items[FL_DIAGS_MAX];
    uint32_t count, dropped_count;
    uint32_t error_count, warning_count; /**< Dropped ones included. */
    const char *text;                    /**< Text in which source lines are looked up, or NULL. */
    size_t text_bytes;
    const char *text_file; /**< Name of that text: only diagnostics with this file quote it. */
} fl_diags;

/** Set the text from which later diagnostics for `file` quote their line. Borrowed until the next
 *  call; pass NULL to unset. Returns nothing to restore: save the three fields to nest. */
void fl_diags_set_text(fl_diags *diags, const char *file, const char *text, size_t text_bytes);

/** Add an error. Always false, so a failing check reads: return fl_error(diags, loc, ...). */
bool fl_error(fl_diags *diags, fl_loc loc, const char *format, ...) FL_PRINTF(3, 4);

/** Add an error that has no place in an input: memory, disk, display. Always false. */
bool fl_environment_error(fl_diags *diags, const char *format, ...) FL_PRINTF(2, 3);

/** Add an environment error for memory that could not be had; `what` names the thing. Always false. */
bool fl_out_of_memory(fl_diags *diags, const char *what);

void fl_warning(fl_diags *diags, fl_loc loc, const char *format, ...) FL_PRINTF(3, 4);

/** Explain the diagnostic before it ("this 'Sphere' begins here"). */
void fl_note(fl_diags *diags, fl_loc loc, const char *format, ...) FL_PRINTF(3, 4);

/** Write `diag` as users see it into `out` (at most out_bytes with the final 0, cut if too long):
 *      file:line:column: error: message
 *         14 |     radious 0.5
 *            |     ^~~~~~~
 *  with no trailing newline. Returns the length before cutting, like snprintf. */
size_t fl_diag_format(const fl_diag *diag, char *out, size_t out_bytes);

/** Free all messages; the list is then zeroed. */
void fl_diags_deinit(fl_diags *diags);

/** The candidate nearest to `word` in edit distance (insert, delete, replace, swap of neighbours;
 *  letter case counts half), if the distance is at most 2 and below the length of `word`;
 *  NULL: none. The first of equals wins. O(candidate_count * length^2). */
const char *fl_nearest_name(const char *word, size_t word_bytes, const char *const *candidates,
                            size_t candidate_count);

#endif
