/* SPDX-License-Identifier: MIT */
#include "core/parse_tree.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "core/parse_values.h"

enum {
    NODES_PER_CHUNK = 256,
    ONCE_COUNT = 8,  /* above every fl_block.once */
    ERRORS_MAX = 256 /* after so many the text is not worth reading on */
};

static fl_loc here(const fl_tree_parser *p)
{
    return fl_token_loc(p->tree->name, &p->token);
}

static fl_loc place(const fl_tree_parser *p, const fl_token *token)
{
    return fl_token_loc(p->tree->name, token);
}

/* A new node at the end of the innermost open block. On failure the text is abandoned. */
static fl_node *append_node(fl_tree_parser *p, fl_node_kind kind, const fl_token *token)
{
    if (p->nodes_left == 0) {
        p->nodes = fl_arena_alloc(p->arena, NODES_PER_CHUNK, sizeof *p->nodes);
        if (!p->nodes) {
            fl_out_of_memory(p->diags, "the scene text");
            p->is_abandoned = true;
            return NULL;
        }
        p->nodes_left = NODES_PER_CHUNK;
    }
    fl_node *node = &p->nodes[--p->nodes_left];
    *node = (fl_node){.kind = kind, .token = *token};
    node->is_after_gap = token->line > p->previous_line + 1 && p->previous_line > 0;
    if (p->open) {
        if (p->open->last)
            p->open->last->next = node;
        else
            p->open->first = node;
        p->open->last = node;
    }
    return node;
}

void fl_tree_advance(fl_tree_parser *p)
{
    p->previous_line = p->token.line;
    if (p->diags->error_count - p->errors_before > ERRORS_MAX)
        p->is_abandoned = true;
    for (;;) {
        fl_token token = fl_lexer_next(&p->lexer);
        if (p->is_abandoned)
            token.kind = FL_TOKEN_END;
        if (token.kind != FL_TOKEN_COMMENT) {
            p->token = token;
            return;
        }
        fl_node *comment = append_node(p, FL_NODE_COMMENT, &token);
        if (comment)
            comment->is_trailing = token.line == p->previous_line;
        p->previous_line = token.line;
    }
}

/* Skip `{ … }` with everything in it; the brace is the current token. Its comments stay with the
 * open block. */
static void skip_braces(fl_tree_parser *p)
{
    int depth = 0;
    do {
        depth += p->token.kind == FL_TOKEN_OPEN_BRACE;
        depth -= p->token.kind == FL_TOKEN_CLOSE_BRACE;
        fl_tree_advance(p);
    } while (depth > 0 && p->token.kind != FL_TOKEN_END);
}

/* A material of which nothing is drawn; a lenient reader wants the first material or colour that it
 * mentions to stand in: it becomes the node's numbers. The current token is the '{'. */
static void parse_stand_in(fl_tree_parser *p, fl_node *node)
{
    int depth = 0;
    do {
        depth += p->token.kind == FL_TOKEN_OPEN_BRACE;
        depth -= p->token.kind == FL_TOKEN_CLOSE_BRACE;
        bool is_color = fl_token_is(&p->token, "color") || fl_token_is(&p->token, "diffuseColor");
        uint32_t count = fl_token_is(&p->token, "materialIndex") ? 1 : is_color ? 3 : 0;
        fl_tree_advance(p);
        if (count == 0 || node->number_count > 0)
            continue;
        double *numbers = fl_tree_alloc_numbers(p, count);
        for (uint32_t i = 0; numbers && i < count; i++) {
            if (!fl_token_number(&p->token, &numbers[i]) ||
                !(fabs(numbers[i]) <= (double)FLT_MAX)) /* as a material's own keys */
                count = 0;
            else
                fl_tree_advance(p);
        }
        node->numbers = numbers;
        node->number_count = numbers ? count : 0;
    } while (depth > 0 && p->token.kind != FL_TOKEN_END);
}

/* Checkerboard, Noise, Marble, Wood. */
static void parse_procedural(fl_tree_parser *p, fl_node *node)
{
    fl_loc loc = place(p, &node->token);
    if (p->tree->is_lenient)
        fl_warning(p->diags, loc,
                   "the procedural material '%s' is not supported; its first material or "
                   "colour stands in",
                   node->block->name);
    else
        fl_error(p->diags, loc, "the procedural material '%s' is not supported", node->block->name);
    parse_stand_in(p, node);
}

/* A material block of a kind that nobody here knows still takes a number. */
static void parse_unknown_material(fl_tree_parser *p, const fl_token *name)
{
    static const fl_block unknown = {.name = "Material", .id = FL_BLOCK_PROCEDURAL};
    fl_node *node = append_node(p, FL_NODE_BLOCK, name);
    if (!node)
        return;
    node->block = &unknown;
    p->tree->block_counts[FL_BLOCK_PROCEDURAL]++;
    parse_stand_in(p, node);
}

static bool is_known_in(const fl_tree_parser *p, const fl_block *block, const fl_token *token)
{
    return token->kind == FL_TOKEN_WORD && (fl_grammar_find_key(block, token, p->dialects) ||
                                            fl_grammar_find_block(block, token, p->dialects));
}

/* Which other dialect knows this name here, or NULL. */
static const char *dialect_that_knows(const fl_block *block, const fl_token *token)
{
    for (int d = 0; d < FL_DIALECT_COUNT; d++)
        if (fl_grammar_find_key(block, token, 1u << d) ||
            fl_grammar_find_block(block, token, 1u << d))
            return fl_dialect_names[d];
    return NULL;
}

/* The block of that or nearly that name which stands elsewhere, or NULL. */
static const fl_block *block_elsewhere(const fl_tree_parser *p, const fl_token *name)
{
    const char *names[2 * FL_BLOCK_COUNT]; /* some blocks have two names */
    size_t count = 0;
    for (uint32_t i = 1; i < fl_grammar_block_count && count < FL_COUNT_OF(names); i++)
        if (fl_grammar_blocks[i].dialects & p->dialects)
            names[count++] = fl_grammar_blocks[i].name;
    const char *nearest = fl_nearest_name(name->text, name->bytes, names, count);
    for (uint32_t i = 1; nearest && i < fl_grammar_block_count; i++)
        if (fl_grammar_blocks[i].name == nearest)
            return &fl_grammar_blocks[i];
    return NULL;
}

/* The block that it usually stands in. */
static const char *home_of(const fl_block *block)
{
    bool is_curve = block->parents >> FL_BLOCK_REVOLUTION & 1u;
    for (uint32_t i = 0; i < fl_grammar_block_count; i++) {
        fl_block_id id = fl_grammar_blocks[i].id;
        if ((block->parents >> id & 1u) && (!is_curve || id == FL_BLOCK_REVOLUTION))
            return fl_grammar_blocks[i].name;
    }
    return fl_grammar_blocks[0].name;
}

static void report_unknown(fl_tree_parser *p, const fl_token *name, const fl_block *parent,
                           bool is_block)
{
    const char *what = is_block ? "block" : "key";
    fl_loc loc = place(p, name);
    int bytes = (int)name->bytes;
    if (p->tree->is_lenient) {
        fl_warning(p->diags, loc, "unknown %s '%.*s' in '%s' is skipped", what, bytes, name->text,
                   parent->name);
        return;
    }
    const char *other = dialect_that_knows(parent, name);
    const char *nearest = fl_grammar_nearest(parent, name, p->dialects);
    const fl_block *elsewhere = is_block ? block_elsewhere(p, name) : NULL;
    if (other)
        fl_error(p->diags, loc,
                 "unknown %s '%.*s' in '%s'; '%s' has it, but this text is read as '%s'", what,
                 bytes, name->text, parent->name, other, fl_dialect_names[p->tree->dialect]);
    else if (nearest)
        fl_error(p->diags, loc, "unknown %s '%.*s' in '%s'; did you mean '%s'?", what, bytes,
                 name->text, parent->name, nearest);
    else if (elsewhere)
        fl_error(p->diags, loc, "unknown %s '%.*s' in '%s'; '%s' stands in '%s'", what, bytes,
                 name->text, parent->name, elsewhere->name, home_of(elsewhere));
    else
        fl_error(p->diags, loc, "unknown %s '%.*s' in '%s'", what, bytes, name->text, parent->name);
}

/* A word that is neither key nor block here: skip what seems to belong to it. True: it was a block.
 */
static bool skip_unknown(fl_tree_parser *p, const fl_block *parent)
{
    fl_token name = p->token;
    fl_tree_advance(p);
    bool is_block = p->token.kind == FL_TOKEN_OPEN_BRACE;
    report_unknown(p, &name, parent, is_block);
    if (is_block) {
        if (parent->id == FL_BLOCK_MATERIALS)
            parse_unknown_material(p, &name);
        else
            skip_braces(p);
        return true;
    }
    if (p->token.kind == FL_TOKEN_WORD && !is_known_in(p, parent, &p->token))
        fl_tree_advance(p); /* a value: a number or a file name */
    fl_tree_skip_numbers(p);
    return false;
}

/* A second key or block where one is allowed: the courses let the last one count. */
static void report_duplicate(fl_tree_parser *p, fl_node *first, const fl_node *again)
{
    fl_loc loc = place(p, &again->token);
    int bytes = (int)again->token.bytes;
    if (p->tree->dialect != FL_DIALECT_FIRSTLIGHT) {
        fl_warning(p->diags, loc, "'%.*s' stands twice; the last one counts", bytes,
                   again->token.text);
        first->is_replaced = true;
    } else {
        fl_error(p->diags, loc, "'%.*s' stands twice", bytes, again->token.text);
    }
    fl_note(p->diags, place(p, &first->token), "the first one is here");
}

static void check_required(fl_tree_parser *p, const fl_node *node, fl_node *const *seen)
{
    const fl_block *block = node->block;
    for (uint32_t i = 0; i < block->key_count; i++) {
        const fl_key *key = &block->keys[i];
        if (!(key->flags & FL_KEY_REQUIRED) || !(key->dialects & p->dialects) || seen[key->id])
            continue;
        if (key != fl_grammar_key_by_id(block, key->id, p->tree->dialect))
            continue; /* another name of a key already missed */
        fl_error(p->diags, place(p, &node->token), "'%s' needs '%s': %s", block->name, key->name,
                 key->help);
    }
}

static void check_count(fl_tree_parser *p, const fl_node *count, const fl_block *block,
                        uint32_t members)
{
    if (!count || count->number_count == 0 || count->numbers[0] == (double)members)
        return;
    const char *format = "'%s' says %.0f, but this '%s' holds %u";
    fl_loc loc = place(p, &count->token);
    if (p->tree->is_lenient)
        fl_warning(p->diags, loc, format, count->key->name, count->numbers[0], block->name,
                   members);
    else
        fl_error(p->diags, loc, format, count->key->name, count->numbers[0], block->name, members);
}

/* A block while it is read. */
typedef struct scope {
    struct scope *outer;
    fl_node *node;
    fl_node *seen[FL_KEY_ID_COUNT];
    fl_node *once[ONCE_COUNT]; /* by fl_block.once */
    uint32_t members;          /* child blocks, unknown ones included */
} scope;

static fl_node *parse_block(fl_tree_parser *p, scope *outer, const fl_block *block);

static void parse_key(fl_tree_parser *p, scope *s, const fl_key *key)
{
    fl_node *node = append_node(p, FL_NODE_KEY, &p->token);
    if (!node)
        return;
    node->key = key;
    fl_node *first = s->seen[key->id];
    if (first && !(key->flags & FL_KEY_REPEATS))
        report_duplicate(p, first, node);
    if (s->node->block->id == FL_BLOCK_TRANSFORM && s->members > 0)
        fl_error(p->diags, here(p), "'%s' must stand before the object of its 'Transform'",
                 key->name);
    s->seen[key->id] = node;
    if (key->kind == FL_VALUE_PATH)
        p->tree->path_count += key->id == FL_KEY_CUBE_MAP ? FL_CUBE_FACES : 1;
    fl_tree_parse_values(p, node);
}

static void parse_child(fl_tree_parser *p, scope *s, const fl_block *block)
{
    s->members++;
    fl_node *node = parse_block(p, s, block);
    if (!node || !block->once || s->outer)
        return; /* groups within groups are many */
    if (s->once[block->once])
        report_duplicate(p, s->once[block->once], node);
    s->once[block->once] = node;
}

/* A name that means nothing here but something further out: the '}' is missing. */
static bool is_of_outer_block(const fl_tree_parser *p, const scope *s)
{
    for (const scope *outer = s->outer; outer; outer = outer->outer)
        if (is_known_in(p, outer->node->block, &p->token))
            return true;
    return false;
}

/* One entry of the open block. False: the block ends here. */
static bool parse_entry(fl_tree_parser *p, scope *s)
{
    const fl_block *block = s->node->block;
    if (p->token.kind == FL_TOKEN_END || (p->token.kind == FL_TOKEN_CLOSE_BRACE && s->outer))
        return false;
    if (p->token.kind == FL_TOKEN_OPEN_BRACE) {
        fl_error(p->diags, here(p), "'{' without a name before it");
        skip_braces(p);
        return true;
    }
    if (p->token.kind != FL_TOKEN_WORD) {
        fl_error(p->diags, here(p), "'%c' does not belong here", p->token.text[0]);
        fl_tree_advance(p);
        return true;
    }
    const fl_key *key = fl_grammar_find_key(block, &p->token, p->dialects);
    const fl_block *child = key ? NULL : fl_grammar_find_block(block, &p->token, p->dialects);
    if (key)
        parse_key(p, s, key);
    else if (child)
        parse_child(p, s, child);
    else if (is_of_outer_block(p, s))
        return false;
    else
        s->members += skip_unknown(p, block);
    return true;
}

static void check_members(fl_tree_parser *p, const scope *s)
{
    const fl_block *block = s->node->block;
    check_required(p, s->node, s->seen);
    check_count(p, s->seen[FL_KEY_COUNT_OF_MEMBERS], block, s->members);
    if (block->id == FL_BLOCK_TRANSFORM && s->members != 1)
        fl_error(p->diags, place(p, &s->node->token), "a 'Transform' holds one object, this one %u",
                 s->members);
    if (block->id == FL_BLOCK_REVOLUTION && s->members != 1)
        fl_error(p->diags, place(p, &s->node->token),
                 "a 'RevSurface' holds one BezierCurve or BsplineCurve, this one %u", s->members);
}

static void close_block(fl_tree_parser *p, const scope *s)
{
    const fl_token *name = &s->node->token;
    if (p->token.kind == FL_TOKEN_CLOSE_BRACE) {
        fl_tree_advance(p);
        return;
    }
    if (p->is_abandoned)
        return;
    if (p->token.kind == FL_TOKEN_END)
        fl_error(p->diags, here(p), "the text ends inside '%.*s'; a '}' is missing",
                 (int)name->bytes, name->text);
    else
        fl_error(p->diags, here(p), "expected '}' before '%.*s'", (int)p->token.bytes,
                 p->token.text);
    fl_note(p->diags, place(p, name), "this '%.*s' begins here", (int)name->bytes, name->text);
    if (p->token.kind == FL_TOKEN_END)
        p->is_abandoned = true; /* once is enough */
}

static void parse_head(fl_tree_parser *p, fl_node *node)
{
    const fl_block *block = node->block;
    fl_tree_advance(p);
    if (!block->is_named)
        return;
    if (p->token.kind != FL_TOKEN_WORD) {
        fl_error(p->diags, here(p), "expected a name after '%s'", block->name);
        return;
    }
    node->word = p->token;
    fl_tree_advance(p);
}

/* Everything from the name of a block to its '}'. NULL: out of memory. */
static fl_node *parse_block(fl_tree_parser *p, scope *outer, const fl_block *block)
{
    fl_node *node = append_node(p, FL_NODE_BLOCK, &p->token);
    if (!node)
        return NULL;
    node->block = block;
    p->tree->block_counts[block->id]++;
    parse_head(p, node);
    if (p->token.kind != FL_TOKEN_OPEN_BRACE) {
        fl_error(p->diags, here(p), "expected '{' after '%s'", block->name);
        return node;
    }
    if (block->id == FL_BLOCK_PROCEDURAL) {
        parse_procedural(p, node);
        return node;
    }
    scope s = {.outer = outer, .node = node};
    p->open = node;
    fl_tree_advance(p);
    while (parse_entry(p, &s)) {
    }
    p->open = outer->node;
    check_members(p, &s);
    close_block(p, &s);
    return node;
}

/* `firstlight 1` at the very beginning: it is not a key, for it decides what the keys are. */
static void parse_version(fl_tree_parser *p)
{
    if (!fl_token_is(&p->token, "firstlight"))
        return;
    fl_tree_advance(p);
    double version = 0.0;
    if (!fl_token_number(&p->token, &version) || version != 1.0)
        fl_error(p->diags, here(p), "expected 'firstlight 1': this is the only version");
    fl_tree_skip_numbers(p);
}

bool fl_tree_parse(fl_tree *out_tree, const char *text, size_t text_bytes, const char *name,
                   fl_dialect dialect, bool is_lenient, fl_arena *arena, fl_diags *diags)
{
    *out_tree = (fl_tree){.name = name, .dialect = dialect, .is_lenient = is_lenient};
    fl_tree_parser p = {.dialects = 1u << dialect,
                        .tree = out_tree,
                        .arena = arena,
                        .diags = diags,
                        .errors_before = diags->error_count};
    fl_lexer_init(&p.lexer, text, text_bytes);
    scope s = {.node = append_node(&p, FL_NODE_BLOCK, &(fl_token){.text = text})};
    if (!s.node)
        return false;
    s.node->block = &fl_grammar_blocks[0];
    out_tree->top = p.open = s.node;
    fl_tree_advance(&p);
    parse_version(&p);
    while (parse_entry(&p, &s)) {
    }
    return diags->error_count == p.errors_before;
}

static const fl_node *skip_silent(const fl_node *node)
{
    while (node && (node->kind == FL_NODE_COMMENT || node->is_replaced))
        node = node->next;
    return node;
}

const fl_node *fl_node_first(const fl_node *parent)
{
    return skip_silent(parent->first);
}

const fl_node *fl_node_next(const fl_node *node)
{
    return skip_silent(node->next);
}

const fl_node *fl_node_key(const fl_node *block, fl_key_id id)
{
    for (const fl_node *node = fl_node_first(block); node; node = fl_node_next(node))
        if (node->kind == FL_NODE_KEY && node->key->id == id)
            return node;
    return NULL;
}

const fl_node *fl_node_block(const fl_node *block, fl_block_id id)
{
    for (const fl_node *node = fl_node_first(block); node; node = fl_node_next(node))
        if (node->kind == FL_NODE_BLOCK && node->block->id == id)
            return node;
    return NULL;
}
