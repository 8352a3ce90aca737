/* SPDX-License-Identifier: MIT
 *
 * Rows of the two tables behind the command line.
 */
#ifndef CLI_TABLES_H
#define CLI_TABLES_H

#include "cli/options.h"

typedef enum cli_kind {
    CLI_KIND_FLAG,
    CLI_KIND_COUNT,  /**< uint32_t in [lowest, highest] */
    CLI_KIND_COUNT_OR_AUTO, /**< likewise, or CLI_AUTO */
    CLI_KIND_NUMBER, /**< double in [lowest, highest] */
    CLI_KIND_NUMBER_OR_INF,
    CLI_KIND_SIZE,
    CLI_KIND_CROP,
    CLI_KIND_PIXEL, /**< x and y, and a sample unless that is left out */
    CLI_KIND_CAMERA,
    CLI_KIND_CHOICE,      /**< uint32_t: index into choices */
    CLI_KIND_CHOICE_TEXT, /**< the word itself, one of choices */
    CLI_KIND_TEXT,
    CLI_KIND_OUTPUT
} cli_kind;

typedef struct cli_option {
    const char *name;
    char letter;          /**< 0: no short form. */
    const char *argument; /**< As shown in help; NULL for flags and choices. */
    cli_kind kind;
    size_t offset; /**< Of its value in cli_options. */
    double lowest, highest;
    const char *const *choices; /**< NULL-terminated. */
    uint32_t commands;          /**< Bit per command that takes it. */
    const char *help;
} cli_option;

typedef struct cli_command {
    const char *name, *arguments, *help;
    const char *details; /**< A paragraph for --help and the man page. */
} cli_command;

extern const cli_option cli_option_table[CLI_OPT_COUNT];
extern const cli_command cli_command_table[CLI_COMMAND_COUNT];

#endif
