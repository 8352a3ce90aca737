/* SPDX-License-Identifier: MIT
 *
 * Files and folders: the program's own data, and places where something is to be written.
 */
#ifndef CLI_PLACES_H
#define CLI_PLACES_H

#include <limits.h>

#include "core/firstlight.h"

/** Find "scenes/NAME" or "assets/NAME": in the working directory, else in the checkout or
 * installation that the running program belongs to. False: nowhere; `out` then holds the name. */
bool cli_data_find(const char *name, char out[PATH_MAX]);

/** Whether a file can be put at `path`: its folder is there and may be written to, and nothing or a
 * file that may be replaced stands there. What is neither file nor folder is left to the writing
 * itself. False after adding an environment error. */
bool cli_place_check(const char *path, fl_diags *diags);

/** Make a folder, if it is not there. False after adding an environment error. */
bool cli_folder_open(const char *path, fl_diags *diags);

/** Whether both names lead to the same file or folder; of files that are not there yet, whether
 * they will. */
bool cli_places_are_same(const char *a, const char *b);

#endif
