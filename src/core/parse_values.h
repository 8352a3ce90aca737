/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to parse_tree.c and parse_values.c: the state of reading a tree, and the reading
 * of one key's values.
 */
#ifndef FL_PARSE_VALUES_H
#define FL_PARSE_VALUES_H

#include "core/parse_tree.h"

typedef struct fl_tree_parser {
    fl_lexer lexer;
    fl_token token;         /**< The next one; comments are already put aside. */
    uint32_t previous_line; /**< Of the token before; 0 at the start. */
    uint32_t dialects;      /**< Mask of the one dialect read. */
    fl_tree *tree;
    fl_arena *arena;
    fl_diags *diags;
    uint32_t errors_before;
    bool is_abandoned; /**< Out of memory or too many errors: the rest reads as the end of the text.
                        */
    fl_node *open;     /**< Innermost block: comments and new nodes go there. */
    fl_node *nodes;    /**< Unused nodes of the newest chunk. */
    uint32_t nodes_left;
    double *numbers; /**< Likewise. */
    uint32_t numbers_left;
} fl_tree_parser;

/** Make the next token that is not a comment the current one; comments become nodes of the open
 * block. */
void fl_tree_advance(fl_tree_parser *p);

/** Read the values of `node->key` into `node`, the key's name being the current token. After an
 * error, which is reported, the numbers that follow are skipped and number_count stays 0. */
void fl_tree_parse_values(fl_tree_parser *p, fl_node *node);

/** Whether a token is a number as a whole; inf and nan are. */
bool fl_token_number(const fl_token *token, double *out_value);

/** Skip numbers from the current token on. */
void fl_tree_skip_numbers(fl_tree_parser *p);

/** Zeroed numbers from the arena, or NULL after an error: the text is then abandoned. */
double *fl_tree_alloc_numbers(fl_tree_parser *p, uint32_t count);

#endif
