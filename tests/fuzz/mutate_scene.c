/* SPDX-License-Identifier: MIT
 *
 * New scene texts out of old ones, by the grammar's own table: blocks and keys where they belong,
 * with values near and far from their ranges; blocks doubled and dropped; words exchanged. One
 * change in four is libFuzzer's own, of bytes.
 */
#include <math.h>
#include <string.h>

#include "core/grammar.h"
#include "core/lex.h"
#include "core/number.h"
#include "fuzz/fuzz.h"

enum { PIECE_BYTES = 2048, TOKENS_MAX = 4096, DEPTH_MAX = 3 };

size_t LLVMFuzzerMutate(uint8_t *data, size_t bytes, size_t max_bytes);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t bytes, size_t max_bytes, unsigned seed);

typedef struct piece {
    char text[PIECE_BYTES];
    size_t bytes;
    uint32_t random;
} piece;

static uint32_t draw(piece *p, uint32_t below)
{
    p->random = fl_hash_step(p->random, 1);
    return p->random % below;
}

static void add(piece *p, const char *text)
{
    size_t bytes = strlen(text);
    if (p->bytes + bytes + 1 >= PIECE_BYTES)
        return;
    memcpy(p->text + p->bytes, text, bytes);
    p->bytes += bytes;
    p->text[p->bytes++] = ' ';
}

static void add_number(piece *p, double lo, double hi, bool is_whole)
{
    static const char *const odd[] = {"0",     "-0",       "1",     "-1",    "1e-6",  "1e6",
                                      "1e-30", "1e30",     "1e300", "1e39",  "1e-39", "1e-310",
                                      "-1e20", "16777217", "1.5",   "45",    "90",    "0.9999999",
                                      "180",   "inf",      "nan",   "1e999", "64",    "-1e-7",
                                      "3",     "2",        "0.1",   "999"};
    char text[32];
    if (!is_whole && draw(p, 4) == 0) {
        add(p, odd[draw(p, FL_COUNT_OF(odd))]);
        return;
    }
    lo = fl_max(lo, -4.0);
    hi = fl_min(hi, 4.0);
    double value = lo + (hi - lo) * draw(p, 1u << 12) * 0x1p-12;
    text[fl_number_format(is_whole ? floor(value) : value, text)] = '\0';
    add(p, text);
}

static void add_value(piece *p, const fl_key *key)
{
    static const char *const files[] = {"ring.obj", "bumps.obj", "slivers.obj", "checker.png",
                                        "glow.png", "ramp.png",  "sky",         "nothing"};
    uint32_t count = key->kind == FL_VALUE_COLOR && draw(p, 2) ? 1 : key->count;
    switch (key->kind) {
    case FL_VALUE_PATH:
        add(p, files[draw(p, FL_COUNT_OF(files))]);
        break;
    case FL_VALUE_CHOICE: {
        char word[32] = "0";
        sscanf(key->choices + draw(p, (uint32_t)strlen(key->choices)), " %31s", word);
        add(p, word);
        break;
    }
    case FL_VALUE_POINTS:
        for (uint32_t i = 2 + draw(p, 6); i > 0; i--) {
            add(p, "[");
            add_number(p, -0.5, 3.0, false);
            add_number(p, -3.0, 3.0, false);
            add(p, "0 ]");
        }
        break;
    case FL_VALUE_NOTHING:
        add(p, draw(p, 2) ? "BezierCurve { controls [ 1 0 0 ] [ 2 1 0 ] [ 0 2 0 ] }"
                          : "BsplineCurve { controls [1 0 0] [2 1 0] [1 2 0] [1 3 0] [0 4 0] }");
        break;
    case FL_VALUE_BRACED:
        add(p, "{");
        for (uint32_t i = 0; i < count; i++)
            add_number(p, i % 5 == 0 ? 1.0 : -1.0, i % 5 == 0 ? 1.5 : 1.0, false);
        add(p, "}");
        break;
    default:
        for (uint32_t i = 0; i < count; i++)
            add_number(p, key->lo, key->hi, key->kind == FL_VALUE_INTEGER);
    }
}

static void add_key(piece *p, const fl_key *key)
{
    add(p, key->name);
    add_value(p, key);
}

static const fl_block *child_of(piece *p, const fl_block *parent)
{
    const fl_block *found[64];
    uint32_t count = 0;
    for (uint32_t i = 0; i < fl_grammar_block_count && count < FL_COUNT_OF(found); i++)
        if (fl_grammar_blocks[i].parents >> parent->id & 1u)
            found[count++] = &fl_grammar_blocks[i];
    return count ? found[draw(p, count)] : NULL;
}

static void add_block(piece *p, const fl_block *block, int depth)
{
    add(p, block->name);
    if (block->is_named)
        add(p, "name");
    add(p, "{");
    for (uint32_t i = 0; i < block->key_count; i++) {
        const fl_key *key = &block->keys[i];
        bool counts = strncmp(key->name, "num", 3) == 0;
        if (draw(p, 40) == 0 ||
            (!counts && (key->flags & FL_KEY_REQUIRED ? draw(p, 20) : !draw(p, 3))))
            add_key(p, key);
    }
    if (depth < DEPTH_MAX)
        for (uint32_t i = draw(p, 3); i > 0; i--) {
            const fl_block *child = child_of(p, block);
            if (child)
                add_block(p, child, depth + 1);
        }
    add(p, "}");
}

static const fl_block *block_called(const fl_token *name)
{
    for (uint32_t i = 1; i < fl_grammar_block_count; i++)
        if (fl_token_is(name, fl_grammar_blocks[i].name))
            return &fl_grammar_blocks[i];
    return &fl_grammar_blocks[0];
}

static const char *any_name(piece *p)
{
    const fl_block *block = &fl_grammar_blocks[draw(p, fl_grammar_block_count)];
    return block->key_count && draw(p, 2) ? block->keys[draw(p, block->key_count)].name
                                          : block->name;
}

/* Replace `cut` bytes at `at` by the piece; the new size, or the old one when there is no room. */
static size_t splice(uint8_t *data, size_t bytes, size_t max_bytes, size_t at, size_t cut,
                     const piece *p)
{
    if (bytes - cut + p->bytes > max_bytes)
        return bytes;
    memmove(data + at + p->bytes, data + at + cut, bytes - at - cut);
    memcpy(data + at, p->text, p->bytes);
    return bytes - cut + p->bytes;
}

/* The token after the brace that closes the one at `open`. */
static uint32_t after_block(const fl_token *tokens, uint32_t count, uint32_t open)
{
    uint32_t depth = 0;
    for (uint32_t i = open; i < count; i++) {
        depth += tokens[i].kind == FL_TOKEN_OPEN_BRACE;
        depth -= tokens[i].kind == FL_TOKEN_CLOSE_BRACE && depth > 0;
        if (depth == 0)
            return i + 1;
    }
    return count;
}

/* At the brace of token number `open`: something new inside, the block twice, or no block. */
static size_t change_block(uint8_t *data, size_t bytes, size_t max_bytes, piece *p,
                           const fl_token *tokens, uint32_t count, uint32_t open)
{
    const fl_token *name = &tokens[open - 1];
    const fl_block *block = block_called(name);
    size_t inside = (size_t)((const uint8_t *)tokens[open].text - data) + 1;
    size_t begin = (size_t)((const uint8_t *)name->text - data);
    uint32_t after = after_block(tokens, count, open);
    size_t end = after < count ? (size_t)((const uint8_t *)tokens[after].text - data) : bytes;
    switch (draw(p, 5)) {
    case 0:
        if (block->key_count)
            add_key(p, &block->keys[draw(p, block->key_count)]);
        break;
    case 1:
        for (size_t i = begin; i < end && p->bytes < PIECE_BYTES; i++)
            p->text[p->bytes++] = (char)data[i];
        return splice(data, bytes, max_bytes, end, 0, p);
    case 2:
        return splice(data, bytes, max_bytes, begin, end - begin, p);
    default: {
        const fl_block *child = child_of(p, block);
        if (child)
            add_block(p, child, 0);
    }
    }
    return splice(data, bytes, max_bytes, inside, 0, p);
}

static size_t change_word(uint8_t *data, size_t bytes, size_t max_bytes, piece *p,
                          const fl_token *word)
{
    double value;
    bool is_number = fl_number_parse(word->text, word->text + word->bytes, &value) != NULL;
    if (is_number && draw(p, 20))
        add_number(p, -4.0, 4.0, draw(p, 3) == 0);
    else
        add(p, any_name(p));
    return splice(data, bytes, max_bytes, (size_t)((const uint8_t *)word->text - data), word->bytes,
                  p);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t bytes, size_t max_bytes, unsigned seed)
{
    static fl_token tokens[TOKENS_MAX];
    static piece p;
    p.bytes = 0;
    p.random = seed;
    if (draw(&p, 4) == 0)
        return LLVMFuzzerMutate(data, bytes, max_bytes);
    fl_lexer lexer;
    fl_lexer_init(&lexer, (const char *)data, bytes);
    uint32_t count = 0, opens[TOKENS_MAX], open_count = 0, words[TOKENS_MAX], word_count = 0;
    while (count < TOKENS_MAX && (tokens[count] = fl_lexer_next(&lexer)).kind != FL_TOKEN_END) {
        if (tokens[count].kind == FL_TOKEN_OPEN_BRACE && count > 0)
            opens[open_count++] = count;
        if (tokens[count].kind == FL_TOKEN_WORD)
            words[word_count++] = count;
        count++;
    }
    if (open_count && draw(&p, 2))
        return change_block(data, bytes, max_bytes, &p, tokens, count, opens[draw(&p, open_count)]);
    if (word_count && draw(&p, 8))
        return change_word(data, bytes, max_bytes, &p, &tokens[words[draw(&p, word_count)]]);
    const fl_block *child = child_of(&p, &fl_grammar_blocks[0]);
    if (child)
        add_block(&p, child, 0);
    return splice(data, bytes, max_bytes, bytes, 0, &p);
}
