/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "io/files.h"

int cli_command_convert(const cli_options *options)
{
    if (options->path_count != 2)
        return cli_usage_error(CLI_CONVERT, "expected a scene and where to write it, got %u words",
                               options->path_count);
    const char *in = options->paths[0], *out = options->paths[1];
    fl_diags diags = {0};
    size_t text_bytes, bytes;
    char *text = fl_file_load(in, "scene", FL_SCENE_FILE_MAX_BYTES, (fl_loc){.file = in}, &diags, &text_bytes);
    fl_parse_options parse = {.has_dialect = cli_has(options, CLI_OPT_DIALECT),
                              .dialect = (fl_dialect)options->dialect,
                              .is_lenient = cli_has(options, CLI_OPT_LENIENT)};
    char *ours = text ? fl_scene_format(text, text_bytes, in, &parse, &bytes, &diags) : NULL;
    if (ours && strcmp(out, "-") == 0)
        fwrite(ours, 1, bytes, stdout);
    else if (ours)
        fl_file_save(out, ours, bytes, &diags);
    free(ours);
    free(text);
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    fl_diags_deinit(&diags);
    return code;
}
