/* SPDX-License-Identifier: MIT
 *
 * Files on disk: finding what a scene names, reading whole files, replacing files at once.
 * No state; any thread. Paths are bytes, passed to the system unchanged.
 */
#ifndef FL_IO_FILES_H
#define FL_IO_FILES_H

#include "core/firstlight.h"

/** Largest scene text that is read. */
#define FL_SCENE_FILE_MAX_BYTES ((size_t)FL_TEXT_BYTES_MAX)

/** How many folders above the scene's own are searched for a file that it names. */
enum { FL_FILES_PARENTS_MAX = 6 };

/** What the parser is given to reach the disk (parse.h). A reference is looked up as given, then
 *  from the folder of the scene, then from its parents up to FL_FILES_PARENTS_MAX. */
extern const fl_files fl_files_on_disk;

/** Check that `path` is a regular file of at most max_bytes that may be read; `what` names its role
 * in messages
 *  ("scene", "image"). Writes its size. False after adding an error at `loc`. */
bool fl_file_check(const char *path, const char *what, size_t max_bytes, fl_loc loc,
                   fl_diags *diags, size_t *out_bytes);

/** Read a whole regular file. Returns its bytes with a 0 behind them, from malloc, the caller's to
 * free; NULL after adding an error at `loc`. Pipes, devices and folders are refused without waiting
 * on them. */
char *fl_file_load(const char *path, const char *what, size_t max_bytes, fl_loc loc,
                   fl_diags *diags, size_t *out_bytes);

/** Put `bytes` bytes at `path`, all or nothing: written to a new file in the same folder,
 * synchronised, renamed. A file that stood there keeps its permissions, and its content if anything
 * fails. A symbolic link stays: what it leads to is replaced, or made if there is nothing yet; one
 * that leads round in a circle is an error. False after adding an environment error; nothing is
 * left behind. */
bool fl_file_save(const char *path, const void *data, size_t bytes, fl_diags *diags);

#endif
