/* SPDX-License-Identifier: MIT */
#include "core/parse_values.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/number.h"

enum { NUMBERS_PER_CHUNK = 1024, NUMBERS_MAX = 16, RANGE_BYTES = 160, GOT_BYTES = 96 };

static fl_loc here(const fl_tree_parser *p)
{
    return fl_token_loc(p->tree->name, &p->token);
}

double *fl_tree_alloc_numbers(fl_tree_parser *p, uint32_t count)
{
    if (p->numbers_left < count) {
        uint32_t chunk = fl_max_u32(count, NUMBERS_PER_CHUNK);
        p->numbers = fl_arena_alloc(p->arena, chunk, sizeof *p->numbers);
        p->numbers_left = p->numbers ? chunk : 0;
        if (!p->numbers) {
            fl_out_of_memory(p->diags, "the numbers of the scene text");
            p->is_abandoned = true;
            return NULL;
        }
    }
    double *numbers = p->numbers;
    p->numbers += count;
    p->numbers_left -= count;
    return numbers;
}

bool fl_token_number(const fl_token *token, double *out_value)
{
    const char *end = token->text + token->bytes;
    return token->kind == FL_TOKEN_WORD && fl_number_parse(token->text, end, out_value) == end;
}

void fl_tree_skip_numbers(fl_tree_parser *p)
{
    double ignored;
    while (fl_token_number(&p->token, &ignored))
        fl_tree_advance(p);
}

/* What stands at the current place, for "expected …, got …". */
static const char *got(const fl_tree_parser *p, char out[GOT_BYTES])
{
    if (p->token.kind == FL_TOKEN_END)
        return "the end of the text";
    snprintf(out, GOT_BYTES, "'%.*s'", (int)fl_min_u32(p->token.bytes, GOT_BYTES - 4),
             p->token.text);
    return out;
}

/* "above 0 scene units", "from 0.01 to 179 degrees", "at least 0". */
static void describe_range(const fl_key *key, char out[RANGE_BYTES])
{
    char lo[32], hi[32];
    fl_number_format(key->lo, lo);
    fl_number_format(key->hi, hi);
    const char *gap = key->unit[0] ? " " : "";
    if (key->hi < HUGE_VAL)
        snprintf(out, RANGE_BYTES, "from %s to %s%s%s", lo, hi, gap, key->unit);
    else
        snprintf(out, RANGE_BYTES, "%s %s%s%s", key->flags & FL_KEY_ABOVE_LO ? "above" : "at least",
                 lo, gap, key->unit);
}

/* Check one number; false after an error at the current token. */
static bool check_number(fl_tree_parser *p, const fl_key *key, double value)
{
    bool is_inf_taken = (key->flags & FL_KEY_TAKES_INF) && value > 0.0;
    if (!isfinite(value) && !is_inf_taken)
        return fl_error(p->diags, here(p), "'%s' must be a finite number, got '%.*s'", key->name,
                        (int)p->token.bytes, p->token.text);
    bool is_in = value >= key->lo && value <= key->hi &&
                 !((key->flags & FL_KEY_ABOVE_LO) && value == key->lo);
    /* An index of refraction divides; 0 is opaque in one dialect. */
    bool must_be_normal =
        (key->flags & FL_KEY_ABOVE_LO) || (key->id == FL_KEY_REFRACTION_INDEX && value != 0.0);
    bool is_float = fabs(value) <= (double)FLT_MAX && (!must_be_normal || value >= (double)FLT_MIN);
    if (is_in && (key->flags & FL_KEY_FLOAT) && !is_float)
        return fl_error(p->diags, here(p), "'%s' must fit in a float (1.2e-38 to 3.4e38), got %.*s",
                        key->name, (int)p->token.bytes, p->token.text);
    if (is_in)
        return true;
    char range[RANGE_BYTES];
    describe_range(key, range);
    return fl_error(p->diags, here(p), "'%s' must be %s, got %.*s", key->name, range,
                    (int)p->token.bytes, p->token.text);
}

static bool parse_numbers(fl_tree_parser *p, const fl_key *key, uint32_t count, double *out_numbers)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!fl_token_number(&p->token, &out_numbers[i])) {
            char text[GOT_BYTES];
            return fl_error(p->diags, here(p), "expected %u number%s for '%s', got %s after %u",
                            (unsigned)count, count == 1 ? "" : "s", key->name, got(p, text),
                            (unsigned)i);
        }
        if (!check_number(p, key, out_numbers[i]))
            return false;
        fl_tree_advance(p);
    }
    return true;
}

static bool parse_integer(fl_tree_parser *p, const fl_key *key, double *out_number)
{
    const char *end = p->token.text + p->token.bytes;
    int64_t integer = 0;
    double real = 0.0;
    char text[GOT_BYTES];
    bool is_real = fl_token_number(&p->token, &real);
    if (is_real && fl_integer_parse(p->token.text, end, &integer) == end) {
        real = (double)integer;
    } else if (is_real && isfinite(real) && floor(real) == real && p->tree->is_lenient) {
        fl_warning(p->diags, here(p), "'%s' is a whole number, written %s", key->name,
                   got(p, text));
    } else {
        return fl_error(p->diags, here(p), "expected a whole number for '%s', got %s", key->name,
                        got(p, text));
    }
    if (!check_number(p, key, real))
        return false;
    *out_number = real;
    fl_tree_advance(p);
    return true;
}

static bool expect(fl_tree_parser *p, fl_token_kind kind, const char *what, const fl_key *key)
{
    char text[GOT_BYTES];
    if (p->token.kind != kind)
        return fl_error(p->diags, here(p), "expected '%s' in '%s', got %s", what, key->name,
                        got(p, text));
    fl_tree_advance(p);
    return true;
}

/* Any number of `[ x y z ]`. */
static bool parse_points(fl_tree_parser *p, fl_node *node)
{
    uint32_t count = 0, capacity = 0;
    double *points = NULL;
    while (p->token.kind == FL_TOKEN_OPEN_BRACKET) {
        if (count == FL_CONTROLS_MAX)
            return fl_error(p->diags, here(p), "'%s' holds more than %d points", node->key->name,
                            FL_CONTROLS_MAX);
        if (count == capacity) {
            capacity = capacity ? 2 * capacity : 16;
            double *larger = fl_tree_alloc_numbers(p, 3 * capacity);
            if (!larger)
                return false;
            if (points)
                memcpy(larger, points, 3 * count * sizeof *points);
            points = larger;
        }
        fl_tree_advance(p);
        if (!parse_numbers(p, node->key, 3, &points[3 * count]) ||
            !expect(p, FL_TOKEN_CLOSE_BRACKET, "]", node->key))
            return false;
        count++;
    }
    node->numbers = points;
    node->number_count = 3 * count;
    return true;
}

static bool parse_choice(fl_tree_parser *p, fl_node *node)
{
    const fl_key *key = node->key;
    node->choice = p->token.kind == FL_TOKEN_WORD ? fl_key_choice(key, &p->token) : FL_NONE;
    if (node->choice == FL_NONE) {
        char text[GOT_BYTES];
        fl_error(p->diags, here(p), "'%s' must be one of: %s; got %s", key->name, key->choices,
                 got(p, text));
        if (p->token.kind == FL_TOKEN_WORD)
            fl_tree_advance(p);
        return false;
    }
    node->word = p->token;
    fl_tree_advance(p);
    return true;
}

static bool parse_path(fl_tree_parser *p, fl_node *node)
{
    char text[GOT_BYTES];
    if (p->token.kind != FL_TOKEN_WORD)
        return fl_error(p->diags, here(p), "expected a file name for '%s', got %s", node->key->name,
                        got(p, text));
    node->word = p->token;
    fl_tree_advance(p);
    return true;
}

static bool parse_fixed(fl_tree_parser *p, fl_node *node)
{
    const fl_key *key = node->key;
    double numbers[NUMBERS_MAX], ignored;
    uint32_t count = key->count;
    FL_ASSERT(count <= NUMBERS_MAX);
    bool is_braced = key->kind == FL_VALUE_BRACED;
    if (p->token.kind == FL_TOKEN_OPEN_BRACE && !is_braced && p->tree->is_lenient) {
        fl_warning(p->diags, here(p), "'%s' takes no braces",
                   key->name); /* the 2003 course has them */
        is_braced = true;
    }
    if (is_braced && !expect(p, FL_TOKEN_OPEN_BRACE, "{", key))
        return false;
    if (key->kind == FL_VALUE_INTEGER) {
        if (!parse_integer(p, key, numbers))
            return false;
    } else if (key->kind == FL_VALUE_COLOR) {
        if (!parse_numbers(p, key, 1, numbers))
            return false;
        numbers[1] = numbers[2] = numbers[0];
        if (fl_token_number(&p->token, &ignored) && !parse_numbers(p, key, 2, numbers + 1))
            return false;
    } else if (!parse_numbers(p, key, count, numbers)) {
        return false;
    }
    if (is_braced && !expect(p, FL_TOKEN_CLOSE_BRACE, "}", key))
        return false;
    double *kept = fl_tree_alloc_numbers(p, count);
    if (!kept)
        return false;
    memcpy(kept, numbers, count * sizeof *kept);
    node->numbers = kept;
    node->number_count = count;
    return true;
}

/* After an error: go on at the next thing that has a meaning here. */
static void skip_wrong_value(fl_tree_parser *p, const fl_key *key)
{
    const fl_block *block = p->open->block;
    double ignored;
    if (p->token.kind == FL_TOKEN_WORD && !fl_grammar_find_key(block, &p->token, p->dialects) &&
        !fl_grammar_find_block(block, &p->token, p->dialects))
        fl_tree_advance(p);
    while (key->kind == FL_VALUE_POINTS &&
           (p->token.kind == FL_TOKEN_OPEN_BRACKET || p->token.kind == FL_TOKEN_CLOSE_BRACKET ||
            fl_token_number(&p->token, &ignored)))
        fl_tree_advance(p);
}

void fl_tree_parse_values(fl_tree_parser *p, fl_node *node)
{
    double ignored;
    bool is_good = true;
    fl_tree_advance(p);
    switch (node->key->kind) {
    case FL_VALUE_NUMBERS:
    case FL_VALUE_BRACED:
    case FL_VALUE_COLOR:
    case FL_VALUE_INTEGER:
        is_good = parse_fixed(p, node);
        break;
    case FL_VALUE_POINTS:
        is_good = parse_points(p, node);
        break;
    case FL_VALUE_PATH:
        is_good = parse_path(p, node);
        break;
    case FL_VALUE_CHOICE:
        is_good = parse_choice(p, node);
        break;
    case FL_VALUE_NOTHING:
        break;
    }
    if (is_good && fl_token_number(&p->token, &ignored)) {
        const char *format = "nothing should follow the value of '%s', but '%.*s' does";
        int bytes = (int)p->token.bytes;
        if (p->tree->is_lenient)
            fl_warning(p->diags, here(p), format, node->key->name, bytes, p->token.text);
        else
            fl_error(p->diags, here(p), format, node->key->name, bytes, p->token.text);
    }
    if (!is_good)
        skip_wrong_value(p, node->key);
    fl_tree_skip_numbers(p);
}
