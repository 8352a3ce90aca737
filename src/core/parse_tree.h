/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to the parser and the formatter: a scene text as a tree of blocks, keys and
 * comments, checked against the grammar table (names, types, ranges, counts, required keys). What
 * the values mean together is not known here.
 */
#ifndef FL_PARSE_TREE_H
#define FL_PARSE_TREE_H

#include "core/arena.h"
#include "core/grammar.h"

typedef enum fl_node_kind { FL_NODE_BLOCK, FL_NODE_KEY, FL_NODE_COMMENT } fl_node_kind;

typedef struct fl_node fl_node;
struct fl_node {
    fl_node_kind kind;
    bool is_trailing;  /**< Comment: on the line of the token before it. */
    bool is_after_gap; /**< An empty line stands before it. */
    bool
        is_replaced; /**< A later block or key of the same kind counts instead (course dialects). */
    fl_token token;  /**< The name of the block or key; the comment. */
    fl_token word;   /**< Path or choice; name of a View. */
    const fl_block *block;
    const fl_key *key;
    const double *numbers; /**< Of a key; in the arena. */
    uint32_t number_count;
    uint32_t choice; /**< Position among the key's choices. */
    fl_node *first, *last, *next;
};

typedef struct fl_tree {
    fl_node *top;
    const char *name; /**< Of the text, for places. */
    fl_dialect dialect;
    bool is_lenient;
    uint32_t block_counts[FL_BLOCK_COUNT]; /**< Nodes of each kind: bounds what a scene can need. */
    uint32_t path_count;                   /**< Keys that name a file; a cube map counts as six. */
} fl_tree;

/** Build the tree of a text that passed fl_lex_check. `name` and `text` are borrowed by the tree,
 * nodes live in `arena`. Reports every error it can make sense of; false if there was one. O(text).
 */
bool fl_tree_parse(fl_tree *out_tree, const char *text, size_t text_bytes, const char *name,
                   fl_dialect dialect, bool is_lenient, fl_arena *arena, fl_diags *diags);

/** Which dialect a text follows; *out_reason is a sentence in `arena` (NULL: out of memory).
 * O(text). */
fl_dialect fl_dialect_recognise(const char *text, size_t text_bytes, fl_arena *arena,
                                const char **out_reason);

/** Nodes in order that count: blocks and keys, neither comments nor replaced ones. NULL: no more.
 */
const fl_node *fl_node_first(const fl_node *parent);
const fl_node *fl_node_next(const fl_node *node);

/** The key with that meaning among the children, or NULL. O(children). */
const fl_node *fl_node_key(const fl_node *block, fl_key_id id);

/** The child block of that kind, or NULL. */
const fl_node *fl_node_block(const fl_node *block, fl_block_id id);

#endif
