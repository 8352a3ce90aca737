/* SPDX-License-Identifier: MIT
 *
 * The program: find the command, parse its options, run it. The only place that turns results into exit codes.
 */
#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/tables.h"

static int (*const run[CLI_COMMAND_COUNT])(const cli_options *) = {
    [CLI_VIEW] = cli_command_view,       [CLI_RENDER] = cli_command_render, [CLI_CHECK] = cli_command_check,
    [CLI_STUDY] = cli_command_study,     [CLI_BENCH] = cli_command_bench,
    [CLI_INFO] = cli_command_info,       [CLI_CONVERT] = cli_command_convert, [CLI_REPLAY] = cli_command_replay,
    [CLI_HELP] = cli_command_help,
};

int cli_usage_error(cli_command_id command, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fputs("firstlight: ", stderr);
    vfprintf(stderr, format, args);
    va_end(args);
    if (command == CLI_COMMAND_COUNT)
        fputs("\nTry 'firstlight --help'.\n", stderr);
    else
        fprintf(stderr, "\nTry 'firstlight help %s'.\n", cli_command_table[command].name);
    return CLI_WRONG_USAGE;
}

/* The command that argv asks for: a name, or view when the first word is a file or an option. Sets *skip to the number of
 * words that named it. */
static cli_command_id command_of(int argc, char **argv, int *skip)
{
    *skip = 0;
    if (argc < 2)
        return CLI_VIEW;
    cli_command_id command = cli_command_find(argv[1]);
    if (command != CLI_COMMAND_COUNT)
        *skip = 1;
    else if (argv[1][0] == '-' || strpbrk(argv[1], "./") || access(argv[1], F_OK) == 0)
        command = CLI_VIEW;
    return command;
}

static int run_words(int argc, char **argv)
{
    if (argc == 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)) {
        cli_print_help(CLI_COMMAND_COUNT);
        return CLI_DONE;
    }
    if (argc == 2 && strcmp(argv[1], "--version") == 0) {
        puts("firstlight " FL_VERSION);
        return CLI_DONE;
    }
    int skip;
    cli_command_id command = command_of(argc, argv, &skip);
    if (command == CLI_COMMAND_COUNT) {
        const char *nearest = cli_command_nearest(argv[1]);
        if (nearest)
            return cli_usage_error(command, "unknown command '%s'; did you mean '%s'?", argv[1], nearest);
        return cli_usage_error(command, "'%s' is neither a command nor the path of a scene", argv[1]);
    }
    cli_options options;
    char message[CLI_MESSAGE_BYTES];
    if (!cli_options_parse(command, argc - skip, argv + skip, &options, message, sizeof message))
        return cli_usage_error(command, "%s", message);
    if (cli_has(&options, CLI_OPT_HELP)) {
        cli_print_help(command);
        return CLI_DONE;
    }
    return run[command](&options);
}

int main(int argc, char **argv)
{
    /* A file size limit is a full disk: the write fails and says so, the program lives. */
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    int code = run_words(argc, argv);
    bool has_failed = ferror(stdout) != 0;
    errno = 0;
    if (fflush(stdout) == 0 && !has_failed)
        return code;
    fprintf(stderr, "firstlight: cannot write to standard output: %s\n", errno ? strerror(errno) : "not all of it got there");
    return code == CLI_DONE ? CLI_ENVIRONMENT : code;
}
