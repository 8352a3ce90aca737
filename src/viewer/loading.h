/* SPDX-License-Identifier: MIT
 *
 * Scenes read, parsed and compiled by a thread of their own, so that the window goes on with the
 * old picture meanwhile. One at a time; of those asked for in between only the newest is read. The
 * owner's thread, except where said.
 */
#ifndef VW_LOADING_H
#define VW_LOADING_H

#include "viewer/viewer.h"

typedef struct vw_loading vw_loading;

/** `loader` is borrowed; its load is called by the thread, one load at a time. `notify` is
 * called by the thread when a load has ended. NULL after adding an error. */
vw_loading *vw_loading_create(const vw_loader *loader, void (*notify)(void *context), void *context,
                              fl_diags *diags);
/** Waits for a load that is under way: reading cannot be broken off. NULL is allowed. */
void vw_loading_destroy(vw_loading *loading);

/** Ask for the scene at `path`, shorter than VW_PATH_MAX. Never waits. */
void vw_loading_ask(vw_loading *loading, const char *path);

/** What the newest ended load brought; true once for each. *out_scene is then the caller's; when
 * the load failed for what was added to `diags` there are at most the files in it. `out_path`:
 * VW_PATH_MAX bytes. */
bool vw_loading_take(vw_loading *loading, vw_scene *out_scene, char *out_path, fl_diags *diags);

/** Whether something was asked for and has not been taken. */
bool vw_loading_is_busy(vw_loading *loading);

/** Release what a vw_scene holds and zero it. Any thread. */
void vw_scene_deinit(vw_scene *scene);

#endif
