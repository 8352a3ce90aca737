/* SPDX-License-Identifier: MIT
 *
 * Runs one target over files, and over all files of folders: the corpus and every input that once
 * broke something. usage: replay_NAME FILE_OR_FOLDER...
 */
#include <dirent.h>
#include <string.h>
#include <sys/stat.h>

#include "fuzz/fuzz.h"

enum { PATH_BYTES = 4096 };

static size_t file_count;

static void run_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint8_t *data = NULL;
    size_t bytes = 0, room = 1024, got;
    MUST(file);
    do { /* a size of its own, so that a sanitizer sees the end */
        room *= 2;
        data = realloc(data, room);
        MUST(data);
        got = fread(data + bytes, 1, room - bytes, file);
        bytes += got;
    } while (got && bytes == room);
    fclose(file);
    uint8_t *exact = realloc(data, bytes ? bytes : 1);
    MUST(exact);
    printf("%s\n", path);
    fflush(stdout);
    LLVMFuzzerTestOneInput(exact, bytes);
    free(exact);
    file_count++;
}

static void run_path(const char *path)
{
    struct stat status;
    MUST(stat(path, &status) == 0);
    if (!S_ISDIR(status.st_mode)) {
        run_file(path);
        return;
    }
    struct dirent **entries;
    int count = scandir(path, &entries, NULL, alphasort);
    MUST(count >= 0);
    for (int i = 0; i < count; i++) {
        char inner[PATH_BYTES];
        snprintf(inner, sizeof inner, "%s/%s", path, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.' && stat(inner, &status) == 0 && S_ISREG(status.st_mode))
            run_file(inner);
        free(entries[i]);
    }
    free(entries);
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++)
        run_path(argv[i]);
    printf("%zu inputs\n", file_count);
    return file_count ? 0 : 1;
}
