/* SPDX-License-Identifier: MIT */
#include "core/lex.h"

#include <string.h>

static const char byte_order_mark[] = "\xef\xbb\xbf";

static bool has_byte_order_mark(const char *text, size_t text_bytes)
{
    return text_bytes >= 3 && memcmp(text, byte_order_mark, 3) == 0;
}

static bool is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static bool is_control(char c)
{
    return ((unsigned char)c < 0x20 && !is_space(c)) || c == 0x7f;
}

static fl_token_kind bracket_kind(char c)
{
    switch (c) {
    case '{':
        return FL_TOKEN_OPEN_BRACE;
    case '}':
        return FL_TOKEN_CLOSE_BRACE;
    case '[':
        return FL_TOKEN_OPEN_BRACKET;
    case ']':
        return FL_TOKEN_CLOSE_BRACKET;
    default:
        return FL_TOKEN_WORD;
    }
}

void fl_lexer_init(fl_lexer *lexer, const char *text, size_t text_bytes)
{
    size_t skip = has_byte_order_mark(text, text_bytes) ? 3 : 0;
    *lexer = (fl_lexer){
        .at = text + skip, .end = text + text_bytes, .line_begin = text + skip, .line = 1};
}

fl_token fl_lexer_next(fl_lexer *lexer)
{
    const char *at = lexer->at, *end = lexer->end;
    for (; at < end && is_space(*at); at++) {
        if (*at == '\n') {
            lexer->line++;
            lexer->line_begin = at + 1;
        }
    }
    fl_token token = {
        .text = at, .line = lexer->line, .column = (uint32_t)(at - lexer->line_begin) + 1};
    if (at == end) {
        token.kind = FL_TOKEN_END;
    } else if (*at == '#') {
        token.kind = FL_TOKEN_COMMENT;
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        const char *last = newline ? newline : end;
        at = last;
        while (is_space(last[-1]))
            last--;
        token.bytes = (uint32_t)(last - token.text);
    } else {
        token.kind = bracket_kind(*at++);
        if (token.kind == FL_TOKEN_WORD)
            while (at < end && !is_space(*at) && bracket_kind(*at) == FL_TOKEN_WORD)
                at++;
        token.bytes = (uint32_t)(at - token.text);
    }
    lexer->at = at;
    return token;
}

fl_loc fl_token_loc(const char *name, const fl_token *token)
{
    return (fl_loc){
        .file = name, .line = token->line, .column = token->column, .length = token->bytes};
}

bool fl_token_is(const fl_token *token, const char *word)
{
    return token->kind == FL_TOKEN_WORD && strlen(word) == token->bytes &&
           memcmp(token->text, word, token->bytes) == 0;
}

/* The place of one byte, counted from the start: for the one error that ends a check. */
static fl_loc byte_loc(const char *text, const char *at, const char *name)
{
    fl_loc loc = {.file = name, .line = 1, .length = 1};
    const char *line_begin = text;
    for (const char *c = text; c < at; c++) {
        if (*c == '\n') {
            loc.line++;
            line_begin = c + 1;
        }
    }
    loc.column = (uint32_t)(at - line_begin) + 1;
    return loc;
}

static bool check_bytes(const char *text, size_t text_bytes, const char *name, bool is_lenient,
                        fl_diags *diags)
{
    if (text_bytes > FL_TEXT_BYTES_MAX)
        return fl_error(diags, (fl_loc){.file = name},
                        "a scene text has at most %d bytes, this one has %zu", FL_TEXT_BYTES_MAX,
                        text_bytes);
    for (size_t i = 0; i < text_bytes; i++)
        if (is_control(text[i]))
            return fl_error(diags, byte_loc(text, text + i, name),
                            "byte 0x%02x does not belong in a scene text", (unsigned char)text[i]);
    if (has_byte_order_mark(text, text_bytes)) {
        fl_loc loc = {.file = name, .line = 1, .column = 1, .length = 3};
        if (!is_lenient)
            return fl_error(diags, loc, "a byte order mark before the text; save it without one");
        fl_warning(diags, loc, "a byte order mark before the text is ignored");
    }
    return true;
}

bool fl_lex_check(const char *text, size_t text_bytes, const char *name, bool is_lenient,
                  fl_diags *diags)
{
    if (!check_bytes(text, text_bytes, name, is_lenient, diags))
        return false;
    fl_lexer lexer;
    fl_lexer_init(&lexer, text, text_bytes);
    int depth = 0;
    for (;;) {
        fl_token token = fl_lexer_next(&lexer);
        if (token.kind == FL_TOKEN_END)
            return true;
        if (token.kind == FL_TOKEN_WORD && token.bytes > FL_WORD_BYTES_MAX)
            return fl_error(diags, fl_token_loc(name, &token),
                            "a word has at most %d bytes, this one has %u", FL_WORD_BYTES_MAX,
                            (unsigned)token.bytes);
        if (token.kind == FL_TOKEN_OPEN_BRACE && ++depth > FL_NESTING_MAX)
            return fl_error(diags, fl_token_loc(name, &token),
                            "more than %d braces are open at one time", FL_NESTING_MAX);
        if (token.kind == FL_TOKEN_CLOSE_BRACE && depth > 0)
            depth--;
    }
}
