/* SPDX-License-Identifier: MIT
 *
 * Notices when files change on disk: a thread that sleeps in the kernel (inotify). Folders are
 * watched rather than files, because editors replace files; of a folder that is not there, the
 * nearest that is. A symbolic link is watched with the file it leads to. Where the system has no
 * inotify, or no watches are left, nothing is noticed and nothing is said: reloading by hand still
 * works.
 */
#ifndef VW_WATCH_H
#define VW_WATCH_H

#include "io/file_list.h"

typedef struct vw_watch vw_watch;

/** NULL: cannot watch. `notify` is called after a change, by the thread or in vw_watch_set. */
vw_watch *vw_watch_create(void (*notify)(void *context), void *context);
/** NULL is allowed, here and below. */
void vw_watch_destroy(vw_watch *watch);

/** Watch these files from now on, and no others; an empty list changes nothing. What was not
 * watched before and changed since files->begin counts as a change: it may have been read too
 * early. Borrowed for the call. */
void vw_watch_set(vw_watch *watch, const fl_file_list *files);

/** Whether one of them was written since the last call, or its folder came or went. */
bool vw_watch_take(vw_watch *watch);

#endif
