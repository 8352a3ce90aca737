/* SPDX-License-Identifier: MIT
 *
 * What belongs to the program and stands in files of its own, which are found from where the
 * program is: an installation may be moved. No state; any thread.
 */
#ifndef FL_IO_MODULE_H
#define FL_IO_MODULE_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

enum { FL_MODULE_PATH_BYTES = PATH_MAX + 64 };

/** Find the file `name` in the first of `count` folders, which are named as seen from the program's
 * and end in a slash, or are empty. False: in none; out_path is then the program's folder, with the
 * slash. */
bool fl_program_find(const char *const folders[], size_t count, const char *name,
                     char out_path[FL_MODULE_PATH_BYTES]);

/** Find a module or helper that few runs need: beside the running program, above it (test
 * programs), or in the library folder of an installation. False: as fl_program_find. */
bool fl_module_find(const char *name, char out_path[FL_MODULE_PATH_BYTES]);

#endif
