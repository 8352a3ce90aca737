/* SPDX-License-Identifier: MIT
 *
 * Command lines, one word a line, the first one the command. What is accepted lies in its range.
 */
#include <math.h>
#include <string.h>

#include "cli/tables.h"
#include "fuzz/fuzz.h"

enum { WORDS_MAX = 64 };

static void check_value(const cli_options *options, const cli_option *row)
{
    const char *field = (const char *)options + row->offset;
    uint32_t count;
    double number;
    switch (row->kind) {
    case CLI_KIND_COUNT:
        memcpy(&count, field, sizeof count);
        MUST(count >= row->lowest && count <= row->highest);
        break;
    case CLI_KIND_COUNT_OR_AUTO:
        memcpy(&count, field, sizeof count);
        MUST(count == CLI_AUTO || (count >= row->lowest && count <= row->highest));
        break;
    case CLI_KIND_NUMBER:
    case CLI_KIND_NUMBER_OR_INF:
        memcpy(&number, field, sizeof number);
        MUST(number >= row->lowest);
        MUST(number <= row->highest || (row->kind == CLI_KIND_NUMBER_OR_INF && isinf(number)));
        break;
    case CLI_KIND_CAMERA:
        for (int i = 0; i < 10; i++)
            MUST(isfinite(options->camera[i]));
        break;
    default:
        break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    char *text = malloc(bytes + 1), *argv[WORDS_MAX + 1], message[256] = "";
    MUST(text);
    memcpy(text, data, bytes);
    text[bytes] = '\0';
    int argc = 0;
    for (char *word = text; word && argc < WORDS_MAX; argc++) {
        argv[argc] = word;
        word = strchr(word, '\n');
        if (word)
            *word++ = '\0';
    }
    argv[argc] = NULL;
    cli_command_id command = cli_command_find(argv[0]);
    if (command == CLI_COMMAND_COUNT) {
        cli_command_nearest(argv[0]);
        command = CLI_RENDER;
    }
    cli_options options;
    bool ok = cli_options_parse(command, argc, argv, &options, message, sizeof message);
    MUST(ok == (message[0] == '\0'));
    if (ok) {
        MUST(options.path_count < (uint32_t)argc || argc == 0);
        MUST(options.output_count <= CLI_OUTPUTS_MAX);
        for (int id = 0; id < CLI_OPT_COUNT; id++)
            if (cli_has(&options, (cli_option_id)id))
                check_value(&options, &cli_option_table[id]);
    }
    free(text);
    return 0;
}
