/* SPDX-License-Identifier: MIT
 *
 * Parses every *.scene of a folder and compares with what the file itself expects:
 *     # expect ok
 *     # expect LINE:COLUMN error: beginning of the message      (or warning, note)
 *     # options lenient m04               Errors and warnings must all be expected; notes may be.
 */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/scene_dump.h"

enum { TEXT_BYTES = 1 << 20, EXPECTATIONS = 64 };

/* The lines that begin with `prefix`, without it; cut into `text`. */
static int collect(char *text, const char *prefix, const char *out[EXPECTATIONS])
{
    int count = 0;
    size_t bytes = strlen(prefix);
    for (char *line = text; line && count < EXPECTATIONS; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, prefix, bytes) == 0)
            out[count++] = line + bytes;
    }
    for (int i = 0; i < count; i++)
        ((char *)(size_t)out[i])[strcspn(out[i], "\r\n")] = '\0';
    return count;
}

static void read_options(char *text, fl_parse_options *options)
{
    const char *lines[EXPECTATIONS];
    int count = collect(text, "# options ", lines);
    for (int i = 0; i < count; i++) {
        options->is_lenient |= strstr(lines[i], "lenient") != NULL;
        for (int d = 0; d < FL_DIALECT_COUNT; d++) {
            if (!strstr(lines[i], fl_dialect_names[d]))
                continue;
            options->has_dialect = true;
            options->dialect = (fl_dialect)d;
        }
    }
}

/* Compare; returns the number of differences. */
static int compare(const char *path, const fl_diags *diags, const char **expected, int count)
{
    static const char *const severities[] = {"note", "warning", "error"};
    bool is_met[EXPECTATIONS] = {false};
    int differences = 0;
    for (uint32_t i = 0; i < diags->count; i++) {
        char got[1024];
        bool is_expected = diags->items[i].severity == FL_NOTE;
        const fl_diag *diag = &diags->items[i];
        snprintf(got, sizeof got, "%u:%u %s: %s", diag->loc.line, diag->loc.column,
                 severities[diag->severity], diag->message);
        for (int k = 0; k < count; k++)
            if (strncmp(got, expected[k], strlen(expected[k])) == 0)
                is_expected = is_met[k] = true;
        if (!is_expected)
            differences += printf("%s: unexpected %s\n", path, got) > 0;
    }
    for (int k = 0; k < count; k++)
        if (!is_met[k] && strcmp(expected[k], "ok") != 0)
            differences += printf("%s: missing %s\n", path, expected[k]) > 0;
    if (count == 0)
        differences += printf("%s: expects nothing\n", path) > 0;
    return differences;
}

static int run_scene(const char *path)
{
    static char text[TEXT_BYTES], copy[TEXT_BYTES];
    FILE *file = fopen(path, "rb");
    size_t bytes = file ? fread(text, 1, TEXT_BYTES - 1, file) : 0;
    if (!file || fclose(file))
        return printf("%s: cannot be read\n", path) > 0;
    text[bytes] = '\0';
    memcpy(copy, text, bytes + 1);
    fake_files fake;
    fake_files_init(&fake);
    fl_parse_options options = {0};
    read_options(copy, &options);
    const char *expected[EXPECTATIONS];
    memcpy(copy, text, bytes + 1);
    int count = collect(copy, "# expect ", expected);
    fl_diags diags = {0};
    fl_scene *scene = fl_scene_parse(text, bytes, path, &options, &fake.files, &diags);
    int differences = compare(path, &diags, expected, count);
    if ((scene == NULL) != (diags.error_count > 0))
        differences += printf("%s: a scene and errors exclude each other\n", path) > 0;
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    return differences;
}

static int is_scene(const struct dirent *entry)
{
    const char *ending = strrchr(entry->d_name, '.');
    return ending && strcmp(ending, ".scene") == 0;
}

int main(int argc, char **argv)
{
    struct dirent **entries;
    int count = argc == 2 ? scandir(argv[1], &entries, is_scene, alphasort) : -1, differences = 0;
    if (count <= 0)
        return puts("usage: run_scenes FOLDER (which must hold scenes)"), 2;
    for (int i = 0; i < count; i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", argv[1], entries[i]->d_name);
        differences += run_scene(path);
        free(entries[i]);
    }
    free(entries);
    printf("%d scenes, %d differences\n", count, differences);
    return differences != 0;
}
