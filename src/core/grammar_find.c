/* SPDX-License-Identifier: MIT */
#include "core/grammar.h"

#include <string.h>

#include "core/number.h"

enum { NAMES_MAX = 64 };

const fl_key *fl_grammar_find_key(const fl_block *block, const fl_token *name, uint32_t dialects)
{
    for (uint32_t i = 0; i < block->key_count; i++)
        if ((block->keys[i].dialects & dialects) && fl_token_is(name, block->keys[i].name))
            return &block->keys[i];
    return NULL;
}

static bool is_child(const fl_block *block, const fl_block *parent, uint32_t dialects)
{
    return (block->parents & (1u << parent->id)) && (block->dialects & dialects);
}

const fl_block *fl_grammar_find_block(const fl_block *parent, const fl_token *name,
                                      uint32_t dialects)
{
    for (uint32_t i = 0; i < fl_grammar_block_count; i++)
        if (is_child(&fl_grammar_blocks[i], parent, dialects) &&
            fl_token_is(name, fl_grammar_blocks[i].name))
            return &fl_grammar_blocks[i];
    return NULL;
}

const fl_key *fl_grammar_key_by_id(const fl_block *block, fl_key_id id, fl_dialect dialect)
{
    for (uint32_t i = 0; i < block->key_count; i++)
        if (block->keys[i].id == id && (block->keys[i].dialects & (1u << dialect)))
            return &block->keys[i];
    return NULL;
}

uint32_t fl_key_default(const fl_key *key, double out_numbers[4])
{
    uint32_t count = 0;
    const char *at = key->standard, *end = at ? at + strlen(at) : NULL;
    while (at && at < end && count < 4) {
        at = fl_number_parse(at, end, &out_numbers[count]);
        count += at != NULL;
        while (at && at < end && *at == ' ')
            at++;
    }
    return count;
}

const char *fl_grammar_nearest(const fl_block *parent, const fl_token *name, uint32_t dialects)
{
    const char *names[NAMES_MAX];
    size_t count = 0;
    for (uint32_t i = 0; i < parent->key_count && count < NAMES_MAX; i++)
        if (parent->keys[i].dialects & dialects)
            names[count++] = parent->keys[i].name;
    for (uint32_t i = 0; i < fl_grammar_block_count && count < NAMES_MAX; i++)
        if (is_child(&fl_grammar_blocks[i], parent, dialects))
            names[count++] = fl_grammar_blocks[i].name;
    return fl_nearest_name(name->text, name->bytes, names, count);
}

uint32_t fl_key_choice(const fl_key *key, const fl_token *word)
{
    uint32_t index = 0;
    for (const char *at = key->choices; *at; index++) {
        size_t bytes = strcspn(at, " ");
        if (bytes == word->bytes && memcmp(at, word->text, bytes) == 0)
            return index;
        at += bytes + (at[bytes] == ' ');
    }
    return FL_NONE;
}
