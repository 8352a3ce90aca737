/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/tables.h"
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

static int print_scene(void)
{
    fl_grammar_write_help(write_stdout, NULL);
    return CLI_DONE;
}

static int print_scene_markdown(void)
{
    fl_grammar_write_markdown(write_stdout, NULL);
    return CLI_DONE;
}

static int print_man(void)
{
    cli_print_man();
    return CLI_DONE;
}

/* What there is help on besides commands. */
static const struct {
    const char *name;
    int (*print)(void);
} topics[] = {{"scene", print_scene},
              {"scene-markdown", print_scene_markdown},
              {"keys", print_controls},
              {"man", print_man}};

static int unknown_topic(const char *topic)
{
    const char *names[FL_COUNT_OF(topics) + CLI_COMMAND_COUNT];
    for (size_t i = 0; i < FL_COUNT_OF(topics); i++)
        names[i] = topics[i].name;
    for (size_t i = 0; i < CLI_COMMAND_COUNT; i++)
        names[FL_COUNT_OF(topics) + i] = cli_command_table[i].name;
    const char *nearest = fl_nearest_name(topic, strlen(topic), names, FL_COUNT_OF(names));
    return cli_usage_error(CLI_COMMAND_COUNT, "there is no help on '%s'%s%s%s", topic,
                           nearest ? "; did you mean '" : "", nearest ? nearest : "",
                           nearest ? "'?" : "");
}

int cli_command_help(const cli_options *options)
{
    if (options->path_count > 1)
        return cli_usage_error(CLI_HELP, "expected one topic, got %u", options->path_count);
    const char *topic = options->path_count ? options->paths[0] : "";
    for (size_t i = 0; i < FL_COUNT_OF(topics); i++)
        if (strcmp(topic, topics[i].name) == 0)
            return topics[i].print();
    cli_command_id command = cli_command_find(topic);
    if (command == CLI_COMMAND_COUNT && *topic)
        return unknown_topic(topic);
    cli_print_help(command);
    return CLI_DONE;
}
