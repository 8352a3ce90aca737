/* SPDX-License-Identifier: MIT
 *
 * The parts of a path's name. Nothing is asked of the disk; no errors.
 */
#ifndef FL_IO_PATH_H
#define FL_IO_PATH_H

#include <string.h>

/** Length of the part before the last component: 0, or up to and with the last slash. */
static inline int fl_path_folder_bytes(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (int)(slash - path) + 1 : 0;
}

/** The last component, in `path`. */
static inline const char *fl_path_name(const char *path)
{
    return path + fl_path_folder_bytes(path);
}

/** The last dot of the last component with what follows, in `path`; its end when there is none. */
static inline const char *fl_path_ending(const char *path)
{
    const char *dot = strrchr(fl_path_name(path), '.');
    return dot ? dot : path + strlen(path);
}

#endif
