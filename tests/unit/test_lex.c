/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "core/lex.h"

static void test_tokens(void **state)
{
    (void)state;
    static const char text[] = "Group{a -1.}# one #\r\n\t[0.0] b#c\r\n#  \n\x0b}";
    static const struct {
        fl_token_kind kind;
        const char *text;
        uint32_t line, column;
    } expected[] = {{FL_TOKEN_WORD, "Group", 1, 1},
                    {FL_TOKEN_OPEN_BRACE, "{", 1, 6},
                    {FL_TOKEN_WORD, "a", 1, 7},
                    {FL_TOKEN_WORD, "-1.", 1, 9},
                    {FL_TOKEN_CLOSE_BRACE, "}", 1, 12},
                    {FL_TOKEN_COMMENT, "# one #", 1, 13},
                    {FL_TOKEN_OPEN_BRACKET, "[", 2, 2},
                    {FL_TOKEN_WORD, "0.0", 2, 3},
                    {FL_TOKEN_CLOSE_BRACKET, "]", 2, 6},
                    {FL_TOKEN_WORD, "b#c", 2, 8},
                    {FL_TOKEN_COMMENT, "#", 3, 1},
                    {FL_TOKEN_CLOSE_BRACE, "}", 4, 2},
                    {FL_TOKEN_END, "", 4, 3},
                    {FL_TOKEN_END, "", 4, 3}};
    fl_lexer lexer;
    fl_lexer_init(&lexer, text, strlen(text));
    for (size_t i = 0; i < FL_COUNT_OF(expected); i++) {
        fl_token token = fl_lexer_next(&lexer);
        assert_int_equal(token.kind, expected[i].kind);
        assert_int_equal(token.bytes, strlen(expected[i].text));
        assert_memory_equal(token.text, expected[i].text, token.bytes);
        assert_int_equal(token.line, expected[i].line);
        assert_int_equal(token.column, expected[i].column);
    }
}

static void test_token_is(void **state)
{
    (void)state;
    fl_lexer lexer;
    fl_lexer_init(&lexer, "center {", 8);
    fl_token token = fl_lexer_next(&lexer);
    assert_true(fl_token_is(&token, "center"));
    assert_false(fl_token_is(&token, "cente"));
    assert_false(fl_token_is(&token, "centers"));
    token = fl_lexer_next(&lexer);
    assert_false(fl_token_is(&token, "{"));
}

/* Tokens and white space together are the text, whatever its bytes. */
static void test_any_bytes(void **state)
{
    (void)state;
    uint32_t h = 12345;
    print_message("seed %u\n", h);
    for (int round = 0; round < 20000; round++) {
        char text[64];
        uint32_t bytes = (h = fl_hash_step(h, 1)) % 64;
        for (uint32_t i = 0; i < bytes; i++) {
            h = fl_hash_step(h, i);
            text[i] = h & 1 ? " \n\r\t{}[]#a"[h / 2 % 10] : (char)(h >> 8);
        }
        char *copy = malloc(bytes + 1); /* so that a sanitizer sees a read beyond the end */
        memcpy(copy, text, bytes);
        fl_lexer lexer;
        fl_lexer_init(&lexer, copy, bytes);
        const char *end = lexer.at;
        for (fl_token token; (token = fl_lexer_next(&lexer)).kind != FL_TOKEN_END;) {
            assert_true(token.bytes > 0 && token.text >= end);
            for (; end < token.text; end++)
                assert_true(*end == ' ' || (*end >= '\t' && *end <= '\r'));
            end = token.text + token.bytes;
        }
        assert_true(end <= copy + bytes);
        free(copy);
    }
}

static bool check(const char *text, size_t bytes, bool is_lenient, fl_diags *diags)
{
    return fl_lex_check(text, bytes, "x", is_lenient, diags);
}

static void assert_refused(const char *text, size_t bytes, uint32_t line, uint32_t column,
                           const char *message)
{
    fl_diags diags = {0};
    assert_false(check(text, bytes, false, &diags));
    assert_int_equal(diags.error_count, 1);
    assert_int_equal(diags.items[0].loc.line, line);
    assert_int_equal(diags.items[0].loc.column, column);
    assert_string_equal(diags.items[0].message, message);
    fl_diags_deinit(&diags);
}

static void test_control_bytes(void **state)
{
    (void)state;
    assert_refused("a\n b\0c", 6, 2, 3, "byte 0x00 does not belong in a scene text");
    assert_refused("# \x7f", 3, 1, 3, "byte 0x7f does not belong in a scene text");
    assert_refused("\xef\xbb\xbf{}", 5, 1, 1,
                   "a byte order mark before the text; save it without one");
    fl_diags diags = {0};
    assert_true(check("\xef\xbb\xbf{}", 5, true, &diags));
    assert_int_equal(diags.warning_count, 1);
    fl_diags_deinit(&diags);
    assert_true(check("", 0, false, &diags));
    assert_true(check("\xc3\xa4.obj \xff", 8, false, &diags));
    assert_int_equal(diags.count, 0);
}

static void test_limits(void **state)
{
    (void)state;
    fl_diags diags = {0};
    char *text = malloc((size_t)FL_TEXT_BYTES_MAX + 1);
    assert_non_null(text);
    memset(text, ' ', (size_t)FL_TEXT_BYTES_MAX + 1);
    assert_true(check(text, FL_TEXT_BYTES_MAX, false, &diags));
    assert_refused(text, (size_t)FL_TEXT_BYTES_MAX + 1, 0, 0,
                   "a scene text has at most 16777216 bytes, this one has 16777217");
    memset(text, 'w', FL_WORD_BYTES_MAX + 1);
    assert_true(check(text, FL_WORD_BYTES_MAX, false, &diags));
    assert_refused(text, FL_WORD_BYTES_MAX + 1, 1, 1,
                   "a word has at most 1024 bytes, this one has 1025");
    text[0] = '#';
    assert_true(check(text, FL_WORD_BYTES_MAX + 1, false, &diags));
    memset(text, '{', FL_NESTING_MAX + 1);
    assert_true(check(text, FL_NESTING_MAX, false, &diags));
    assert_refused(text, FL_NESTING_MAX + 1, 1, 65, "more than 64 braces are open at one time");
    assert_int_equal(diags.count, 0);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tokens), cmocka_unit_test(test_token_is),
        cmocka_unit_test(test_any_bytes), cmocka_unit_test(test_control_bytes),
        cmocka_unit_test(test_limits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
