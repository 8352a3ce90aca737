/* SPDX-License-Identifier: MIT */
#include "io/file_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/files.h"
#include "io/path.h"

/* Files are dated by the last tick of the kernel's clock: the exact time would be later than the
 * date of a file that was written after it. */
#ifdef CLOCK_REALTIME_COARSE
#define FILE_CLOCK CLOCK_REALTIME_COARSE
#else
#define FILE_CLOCK CLOCK_REALTIME
#endif

void fl_file_list_add(fl_file_list *list, const char *path)
{
    if (!list)
        return;
    if (list->count == 0)
        clock_gettime(FILE_CLOCK, &list->begin);
    if (list->count == list->capacity) {
        size_t capacity = list->capacity ? 2 * list->capacity : 16;
        char **paths = realloc(list->paths, capacity * sizeof *paths);
        if (!paths)
            return;
        list->paths = paths;
        list->capacity = capacity;
    }
    size_t bytes = strlen(path) + 1;
    char *copy = malloc(bytes);
    if (copy)
        list->paths[list->count++] = memcpy(copy, path, bytes);
}

void fl_file_list_deinit(fl_file_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->paths[i]);
    free(list->paths);
    *list = (fl_file_list){0};
}

static bool find(void *context, const char *scene_path, const char *reference, char *out_path,
                 size_t out_bytes)
{
    bool is_found = fl_files_on_disk.find(NULL, scene_path, reference, out_path, out_bytes);
    int folder_bytes = *reference == '/' ? 0 : fl_path_folder_bytes(scene_path);
    if (!is_found && *reference &&
        (size_t)snprintf(out_path, out_bytes, "%.*s%s", folder_bytes, scene_path, reference) >=
            out_bytes)
        return false;
    if (*reference)
        fl_file_list_add(context, out_path);
    return is_found;
}

fl_files fl_files_listed(fl_file_list *list)
{
    fl_files files = fl_files_on_disk; /* whose functions ask for no context */
    files.context = list;
    files.find = find;
    return files;
}
