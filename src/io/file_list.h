/* SPDX-License-Identifier: MIT
 *
 * The files that a scene is made from, noted while it is read, for those who watch them. No state;
 * any thread.
 */
#ifndef FL_IO_FILE_LIST_H
#define FL_IO_FILE_LIST_H

#include <time.h>

#include "core/firstlight.h"

/** Zero-initialise; free with fl_file_list_deinit. */
typedef struct fl_file_list {
    char **paths; /**< Owned, as they were opened. */
    size_t count, capacity;
    struct timespec begin; /**< When the first was noted, by the clock that dates files: what was
                              written since may not have been read. */
} fl_file_list;

/** Note a path. NULL is allowed; where memory is short the path is left out. */
void fl_file_list_add(fl_file_list *list, const char *path);
void fl_file_list_deinit(fl_file_list *list);

/** fl_files_on_disk, noting what is found and, of what is missing, where it would be found in the
 * scene's folder. `list` is borrowed; NULL: nothing is noted. */
fl_files fl_files_listed(fl_file_list *list);

#endif
