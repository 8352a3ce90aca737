/* SPDX-License-Identifier: MIT
 *
 * What belongs to the program and stands in files of its own: modules and helpers that few runs
 * need. No state; any thread.
 */
#ifndef FL_IO_MODULE_H
#define FL_IO_MODULE_H

#include <limits.h>
#include <stdbool.h>

enum { FL_MODULE_PATH_BYTES = PATH_MAX + 64 };

/** Find the file `name`: beside the running program, above it (test programs), or in the library
 * folder of an installation. False: nowhere; out_path is then the program's folder. */
bool fl_module_find(const char *name, char out_path[FL_MODULE_PATH_BYTES]);

#endif
