/* SPDX-License-Identifier: MIT
 *
 * The grammar table against itself: what a table can get wrong without anybody noticing.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/grammar.h"

#ifndef FL_SOURCE_DIR
#define FL_SOURCE_DIR "."
#endif

static fl_token word(const char *text)
{
    return (fl_token){.kind = FL_TOKEN_WORD, .text = text, .bytes = (uint32_t)strlen(text)};
}

static const fl_block *block_named(const char *name)
{
    for (uint32_t i = 0; i < fl_grammar_block_count; i++)
        if (strcmp(fl_grammar_blocks[i].name, name) == 0)
            return &fl_grammar_blocks[i];
    return NULL;
}

static void check_key(const fl_block *block, const fl_key *key)
{
    double numbers[4];
    assert_true(key->id > FL_KEY_NONE && key->id < FL_KEY_ID_COUNT);
    assert_true(key->dialects & block->dialects);
    assert_true(key->lo <= key->hi && key->unit && key->help && key->help[0]);
    assert_true(key->help[strlen(key->help) - 1] != '.');
    assert_true((key->kind == FL_VALUE_CHOICE) == (key->choices != NULL));
    assert_false((key->flags & FL_KEY_REQUIRED) && key->standard);
    uint32_t count = key->kind == FL_VALUE_CHOICE ? 0 : fl_key_default(key, numbers);
    for (uint32_t i = 0; i < count; i++)
        assert_true(numbers[i] >= key->lo && numbers[i] <= key->hi);
    if (key->standard && key->kind == FL_VALUE_CHOICE) {
        fl_token standard = word(key->standard);
        assert_int_not_equal(fl_key_choice(key, &standard), FL_NONE);
    } else if (key->standard) {
        assert_int_equal(count, key->count);
    }
}

static void test_rows(void **state)
{
    (void)state;
    unsigned keys = 0;
    for (uint32_t i = 0; i < fl_grammar_block_count; i++) {
        const fl_block *block = &fl_grammar_blocks[i];
        assert_true((i == 0) == (block->parents == 0));
        assert_true(block->help[0] && block->dialects && block->once < 8);
        for (uint32_t k = 0; k < block->key_count; k++, keys++)
            check_key(block, &block->keys[k]);
    }
    print_message("%u blocks, %u keys\n", fl_grammar_block_count, keys);
}

/* In one dialect a name means one thing in one block. */
static void test_unambiguous(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < fl_grammar_block_count; i++) {
        const fl_block *a = &fl_grammar_blocks[i];
        for (uint32_t j = i + 1; j < fl_grammar_block_count; j++) {
            const fl_block *b = &fl_grammar_blocks[j];
            assert_false(strcmp(a->name, b->name) == 0 && (a->dialects & b->dialects) &&
                         (a->parents & b->parents));
        }
        for (uint32_t k = 0; k < a->key_count; k++) {
            for (uint32_t l = k + 1; l < a->key_count; l++)
                assert_false(strcmp(a->keys[k].name, a->keys[l].name) == 0 &&
                             (a->keys[k].dialects & a->keys[l].dialects));
            fl_token name = word(a->keys[k].name);
            assert_null(fl_grammar_find_block(a, &name, a->keys[k].dialects));
        }
    }
}

static void test_find(void **state)
{
    (void)state;
    const fl_block *sphere = block_named("Sphere"), *material = block_named("Material");
    fl_token radius = word("radius"), exponent = word("exponent"), sphere_name = word("Sphere");
    assert_string_equal(fl_grammar_find_key(sphere, &radius, FL_IN_ALL)->name, "radius");
    assert_null(fl_grammar_find_key(sphere, &exponent, FL_IN_ALL));
    assert_null(fl_grammar_find_key(material, &exponent, FL_IN_OURS));
    assert_int_equal(fl_grammar_find_key(material, &exponent, FL_IN_M04)->id, FL_KEY_SHININESS);
    assert_ptr_equal(fl_grammar_find_block(block_named("Group"), &sphere_name, FL_IN_M12), sphere);
    assert_null(fl_grammar_find_block(&fl_grammar_blocks[0], &sphere_name, FL_IN_ALL));
    fl_token wrong = word("shinines");
    assert_string_equal(fl_grammar_nearest(material, &wrong, FL_IN_OURS), "shininess");
    double numbers[4];
    const fl_key *focus =
        fl_grammar_key_by_id(block_named("View"), FL_KEY_FOCUS, FL_DIALECT_FIRSTLIGHT);
    assert_int_equal(fl_key_default(focus, numbers), 1);
    assert_true(isinf(numbers[0]));
}

static void append(void *context, const char *text, size_t bytes)
{
    char *page = context;
    strncat(page, text, bytes);
}

/* Every block and key is in both texts. */
static void test_help(void **state)
{
    (void)state;
    enum { PAGE_BYTES = 1 << 17 };
    char *help = calloc(PAGE_BYTES, 1), *page = calloc(PAGE_BYTES, 1), row[64];
    assert_true(help && page);
    fl_grammar_write_help(append, help);
    fl_grammar_write_markdown(append, page);
    assert_true(strlen(help) > 4000 && strlen(page) > 4000);
    for (uint32_t i = 1; i < fl_grammar_block_count; i++) {
        const fl_block *block = &fl_grammar_blocks[i];
        assert_non_null(strstr(help, block->name));
        assert_non_null(strstr(page, block->name));
        for (uint32_t k = 0; k < block->key_count; k++) {
            snprintf(row, sizeof row, "    %s  <", block->keys[k].name);
            assert_non_null(strstr(help, row));
            snprintf(row, sizeof row, "| `%s` |", block->keys[k].name);
            assert_non_null(strstr(page, row));
        }
    }
    free(help);
    free(page);
}

/* The page in docs is what the table says now. */
static void test_page_is_fresh(void **state)
{
    (void)state;
    enum { PAGE_BYTES = 1 << 17 };
    char *page = calloc(PAGE_BYTES, 1), *kept = calloc(PAGE_BYTES, 1);
    FILE *file = fopen(FL_SOURCE_DIR "/docs/scene-format.md", "rb");
    assert_true(page && kept && file);
    size_t bytes = fread(kept, 1, PAGE_BYTES - 1, file);
    fclose(file);
    fl_grammar_write_markdown(append, page);
    assert_int_equal(bytes, strlen(page));
    assert_string_equal(kept, page);
    free(page);
    free(kept);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows),
                                       cmocka_unit_test(test_unambiguous),
                                       cmocka_unit_test(test_find), cmocka_unit_test(test_help),
                                       cmocka_unit_test(test_page_is_fresh)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
