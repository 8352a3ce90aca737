/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "viewer/viewer.h"

static void write_stdout(void *context, const char *text, size_t bytes)
{
    (void)context;
    fwrite(text, 1, bytes, stdout);
}

static int print_controls(void)
{
    size_t bytes = vw_controls_markdown(NULL, 0) + 1;
    char *text = malloc(bytes);
    if (!text)
        return CLI_ENVIRONMENT;
    vw_controls_markdown(text, bytes);
    fputs(text, stdout);
    free(text);
    return CLI_DONE;
}

int cli_command_help(const cli_options *options)
{
    const char *topic = options->path_count ? options->paths[0] : "";
    if (!*topic) {
        cli_print_help(CLI_COMMAND_COUNT);
    } else if (strcmp(topic, "scene") == 0) {
        fl_grammar_write_help(write_stdout, NULL);
    } else if (strcmp(topic, "scene-markdown") == 0) {
        fl_grammar_write_markdown(write_stdout, NULL);
    } else if (strcmp(topic, "keys") == 0) {
        return print_controls();
    } else if (strcmp(topic, "man") == 0) {
        cli_print_man();
    } else {
        cli_command_id command = cli_command_find(topic);
        if (command == CLI_COMMAND_COUNT)
            return cli_usage_error(command, "there is no help on '%s'", topic);
        cli_print_help(command);
    }
    return CLI_DONE;
}
