/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* realpath */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/places.h"
#include "io/files.h"
#include "io/path.h"

/* Whether our dialect has a key of that name whose value is a file or folder. */
static bool is_path_key(const fl_token *word)
{
    for (uint32_t i = 0; i < fl_grammar_block_count; i++) {
        const fl_block *block = &fl_grammar_blocks[i];
        for (uint32_t k = 0; k < block->key_count; k++)
            if (block->keys[k].kind == FL_VALUE_PATH &&
                (block->keys[k].dialects & FL_IN_FIRSTLIGHT) &&
                fl_token_is(word, block->keys[k].name))
                return true;
    }
    return false;
}

/* `path` as seen from `folder`, both absolute and without links. */
static bool relative_path(const char *folder, const char *path, char out[PATH_MAX])
{
    size_t common = 0;
    for (size_t i = 0; folder[i] == path[i] && path[i]; i++)
        if (path[i] == '/')
            common = i + 1;
    size_t folder_bytes = strlen(folder);
    if (strncmp(folder, path, folder_bytes) == 0 && path[folder_bytes] == '/')
        common = folder_bytes + 1;
    size_t used = 0;
    for (const char *at = folder + (common < folder_bytes ? common : folder_bytes); *at;
         at += strcspn(at, "/")) {
        at += *at == '/';
        if (used + 3 >= PATH_MAX)
            return false;
        memcpy(out + used, "../", 3);
        used += 3;
    }
    return snprintf(out + used, PATH_MAX - used, "%s", path + common) < (int)(PATH_MAX - used);
}

/* Whether the scene `out` that names `reference` means the file at `path`. */
static bool leads_to(const char *out, const char *reference, const char *path)
{
    char found[PATH_MAX];
    size_t bytes = strlen(reference);
    bool is_word = bytes > 0 && bytes <= FL_WORD_BYTES_MAX && reference[0] != '#' &&
                   !strpbrk(reference, " \t\r\n\v\f{}[]");
    return is_word && fl_files_on_disk.find(NULL, out, reference, found, sizeof found) &&
           cli_places_are_same(found, path);
}

/* Where a scene is read and written. */
typedef struct move {
    const char *in, *out;
    char folder[PATH_MAX]; /* of `out`, absolute */
} move;

/* What to write in place of a name, so that it still leads to the same file: the name itself where
 * that will do, or where it leads nowhere. False: no word does; `out_name` is the name then. */
static bool move_name(const move *m, const fl_token *name, char out_name[PATH_MAX])
{
    char found[PATH_MAX], path[PATH_MAX], moved[PATH_MAX];
    snprintf(out_name, PATH_MAX, "%.*s", (int)name->bytes, name->text);
    if (!fl_files_on_disk.find(NULL, m->in, out_name, found, sizeof found) ||
        leads_to(m->out, out_name, found) || !realpath(found, path))
        return true;
    const char *better =
        relative_path(m->folder, path, moved) && leads_to(m->out, moved, path) ? moved : path;
    if (!leads_to(m->out, better, path))
        return false;
    snprintf(out_name, PATH_MAX, "%s", better);
    return true;
}

/* Write our text with all names of files moved. */
static void write_moved(const move *m, const char *text, size_t bytes, FILE *file, fl_diags *diags)
{
    const char *written = text; /* up to here */
    bool is_after_key = false;
    fl_lexer lexer;
    fl_lexer_init(&lexer, text, bytes);
    for (fl_token token; (token = fl_lexer_next(&lexer)).kind != FL_TOKEN_END;) {
        if (is_after_key && token.kind == FL_TOKEN_WORD) {
            char name[PATH_MAX];
            if (!move_name(m, &token, name))
                fl_warning(diags, fl_token_loc(m->out, &token),
                           "'%s' is left as it was written: a scene cannot name its file from here",
                           name);
            fwrite(written, 1, (size_t)(token.text - written), file);
            fputs(name, file);
            written = token.text + token.bytes;
        }
        is_after_key = !is_after_key && token.kind == FL_TOKEN_WORD && is_path_key(&token);
    }
    fwrite(written, 1, (size_t)(text + bytes - written), file);
}

static bool save(const char *in, const char *out, const char *text, size_t bytes, fl_diags *diags)
{
    move m = {.in = in, .out = out};
    char folder[PATH_MAX];
    snprintf(folder, sizeof folder, "%.*s.", fl_path_folder_bytes(out), out);
    if (!cli_place_check(out, diags))
        return false;
    if (!realpath(folder, m.folder))
        return fl_environment_error(diags, "cannot write '%s': %s", out, strerror(errno));
    char *moved = NULL;
    size_t moved_bytes = 0;
    FILE *file = open_memstream(&moved, &moved_bytes);
    if (file)
        write_moved(&m, text, bytes, file, diags);
    bool ok = file && fclose(file) == 0 ? fl_file_save(out, moved, moved_bytes, diags)
                                        : fl_out_of_memory(diags, out);
    free(moved);
    return ok;
}

int cli_command_convert(const cli_options *options)
{
    if (options->path_count != 2)
        return cli_usage_error(CLI_CONVERT, "expected a scene and where to write it, got %u words",
                               options->path_count);
    const char *in = options->paths[0], *out = options->paths[1];
    fl_diags diags = {0};
    size_t text_bytes, bytes;
    char *text = fl_file_load(in, "scene", FL_SCENE_FILE_MAX_BYTES, (fl_loc){.file = in}, &diags,
                              &text_bytes);
    fl_parse_options parse = {.has_dialect = cli_has(options, CLI_OPT_DIALECT),
                              .dialect = (fl_dialect)options->dialect,
                              .is_lenient = cli_has(options, CLI_OPT_LENIENT)};
    char *ours = text ? fl_scene_format(text, text_bytes, in, &parse, &bytes, &diags) : NULL;
    if (text && !ours)
        cli_note_slips(text, text_bytes, in, &parse, &diags);
    if (ours && strcmp(out, "-") == 0)
        fwrite(ours, 1, bytes, stdout);
    else if (ours)
        save(in, out, ours, bytes, &diags);
    free(ours);
    free(text);
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    fl_diags_deinit(&diags);
    return code;
}
