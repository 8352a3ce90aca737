/* SPDX-License-Identifier: MIT
 *
 * Notices when files change on disk: a thread that sleeps in the kernel (inotify). Folders are
 * watched rather than files, because editors replace files. Where the system has no inotify, or no
 * watches are left, nothing is noticed and nothing is said: reloading by hand still works.
 */
#ifndef VW_WATCH_H
#define VW_WATCH_H

#include "core/firstlight.h"

typedef struct vw_watch vw_watch;

/** NULL: cannot watch. `notify` is called by the thread after a change. */
vw_watch *vw_watch_create(void (*notify)(void *context), void *context);
/** NULL is allowed, here and below. */
void vw_watch_destroy(vw_watch *watch);

/** Watch these files from now on, and no others. Borrowed for the call. */
void vw_watch_set(vw_watch *watch, const char *const *paths, size_t count);

/** Whether one of them was written since the last call. */
bool vw_watch_take(vw_watch *watch);

#endif
