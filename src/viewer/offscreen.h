/* SPDX-License-Identifier: MIT
 *
 * What platforms without a window share: waiting, a clipboard in memory, no keyboard.
 */
#ifndef VW_OFFSCREEN_H
#define VW_OFFSCREEN_H

#include <pthread.h>

#include "viewer/platform.h"

typedef struct vw_offscreen vw_offscreen;

/** One way to get a context; each function gets the object that vw_offscreen_create made. */
typedef struct vw_offscreen_kind {
    size_t bytes;        /**< Of the object, whose first member is a vw_offscreen. */
    vw_platform_ops ops; /**< name, get_proc; the rest is filled in when it is created. */
    /** Load the library and open a context. False after adding an error. */
    bool (*open)(vw_platform *platform, fl_diags *diags);
    /** Make the context current with a framebuffer of that size. False after adding an error: as
     * it was. */
    bool (*set_size)(vw_platform *platform, uint32_t width, uint32_t height, fl_diags *diags);
    /** Undo open, however far it came. */
    void (*close)(vw_platform *platform);
} vw_offscreen_kind;

struct vw_offscreen {
    vw_platform base; /**< First: a vw_platform is a vw_offscreen. */
    const vw_offscreen_kind *kind;
    vw_platform_ops ops;
    uint32_t width, height;
    char *clipboard;
    pthread_mutex_t mutex;
    pthread_cond_t woken;
    bool is_awake; /**< Guarded by the mutex. */
};

/** NULL after adding an error. */
vw_platform *vw_offscreen_create(const vw_offscreen_kind *kind, const vw_window_desc *desc,
                                 fl_diags *diags);

/** A function of a library opened by dlopen; false: it has none of that name. */
bool vw_offscreen_find(void *library, const char *name, void *out_function, size_t bytes);

#endif
