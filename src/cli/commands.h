/* SPDX-License-Identifier: MIT
 *
 * One function per command; each returns the program's exit code and prints its own messages.
 */
#ifndef CLI_COMMANDS_H
#define CLI_COMMANDS_H

#include "cli/load.h"

int cli_command_view(const cli_options *options);
int cli_command_render(const cli_options *options);
int cli_command_check(const cli_options *options);
int cli_command_study(const cli_options *options);
int cli_command_bench(const cli_options *options);
int cli_command_info(const cli_options *options);
int cli_command_convert(const cli_options *options);
int cli_command_replay(const cli_options *options);
int cli_command_help(const cli_options *options);

/** Say what is wrong with the words, where help is; returns CLI_WRONG_USAGE. */
int cli_usage_error(cli_command_id command, const char *format, ...) FL_PRINTF(2, 3);

#endif
