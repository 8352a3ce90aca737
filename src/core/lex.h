/* SPDX-License-Identifier: MIT
 *
 * Layer 2: scene text to tokens.
 *
 * A token is a brace or bracket, a comment, or a word: a run of bytes up to white space, a brace, a
 * bracket or the end. So a number may touch a brace (`20}`). `#` begins a comment, up to the end of
 * the line, where a token may begin; inside a word it is an ordinary byte, so that file names may
 * hold it. Words are numbers or names by what the grammar expects at their place.
 */
#ifndef FL_LEX_H
#define FL_LEX_H

#include "core/diag.h"

enum {
    FL_TEXT_BYTES_MAX = 16 << 20, /**< Of a whole scene text. */
    FL_WORD_BYTES_MAX = 1024,     /**< Of one word; comments may be longer. */
    FL_NESTING_MAX = 64 /**< Open braces at one time: bounds every recursion over the text. */
};

typedef enum fl_token_kind {
    FL_TOKEN_END,
    FL_TOKEN_WORD,
    FL_TOKEN_OPEN_BRACE,
    FL_TOKEN_CLOSE_BRACE,
    FL_TOKEN_OPEN_BRACKET,
    FL_TOKEN_CLOSE_BRACKET,
    FL_TOKEN_COMMENT /**< From `#` to the last byte before the end of the line that is not white
                        space. */
} fl_token_kind;

/** A piece of the text; `text` points into it and has no terminating 0. */
typedef struct fl_token {
    fl_token_kind kind;
    uint32_t bytes;
    const char *text;
    uint32_t line, column; /**< 1-based; the column counts bytes. */
} fl_token;

typedef struct fl_lexer {
    const char *at, *end, *line_begin;
    uint32_t line;
} fl_lexer;

/** Begin at the first byte of `text`, which is borrowed. A UTF-8 byte order mark is skipped. */
void fl_lexer_init(fl_lexer *lexer, const char *text, size_t text_bytes);

/** The next token; at the end FL_TOKEN_END for ever. Never fails: any byte belongs to some token or
 * to white space. O(bytes of the token). */
fl_token fl_lexer_next(fl_lexer *lexer);

/** Check what holds for every text before any grammar: its size, no byte order mark (a warning if
 * `is_lenient`), no control characters, no word and no nesting beyond the limits. False after
 * adding one error. O(text). */
bool fl_lex_check(const char *text, size_t text_bytes, const char *name, bool is_lenient,
                  fl_diags *diags);

/** The place of a token in the text called `name`. */
fl_loc fl_token_loc(const char *name, const fl_token *token);

/** Whether a token is the word `word`. */
bool fl_token_is(const fl_token *token, const char *word);

#endif
