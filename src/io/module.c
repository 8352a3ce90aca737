/* SPDX-License-Identifier: MIT */
#include "io/module.h"

#include <stdio.h>
#include <unistd.h>

#include "io/path.h"

bool fl_program_find(const char *const folders[], size_t count, const char *name,
                     char out_path[FL_MODULE_PATH_BYTES])
{
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    program[fl_path_folder_bytes(program)] = '\0';
    for (size_t i = 0; i < count; i++) {
        int bytes = snprintf(out_path, FL_MODULE_PATH_BYTES, "%s%s%s", program, folders[i], name);
        if (bytes < FL_MODULE_PATH_BYTES && access(out_path, R_OK) == 0)
            return true;
    }
    snprintf(out_path, FL_MODULE_PATH_BYTES, "%s", program);
    return false;
}

bool fl_module_find(const char *name, char out_path[FL_MODULE_PATH_BYTES])
{
    static const char *const folders[] = {"", "../", "../../", "../lib/firstlight/"};
    return fl_program_find(folders, sizeof folders / sizeof *folders, name, out_path);
}
