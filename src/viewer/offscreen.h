/* SPDX-License-Identifier: MIT
 *
 * What platforms without a window share: waiting, a clipboard in memory, no keyboard.
 */
#ifndef VW_OFFSCREEN_H
#define VW_OFFSCREEN_H

#include <pthread.h>

#include "viewer/platform.h"

typedef struct vw_offscreen {
    vw_platform base; /**< First: a vw_platform is a vw_offscreen. */
    uint32_t width, height;
    char *clipboard;
    pthread_mutex_t mutex;
    pthread_cond_t woken;
    bool is_awake; /**< Guarded by the mutex. */
} vw_offscreen;

bool vw_offscreen_init(vw_offscreen *offscreen, const vw_platform_ops *ops,
                       const vw_window_desc *desc);
void vw_offscreen_deinit(vw_offscreen *offscreen);

/* Entries of the table. */
void vw_offscreen_pump(vw_platform *platform, double timeout_s);
void vw_offscreen_wake(vw_platform *platform);
void vw_offscreen_framebuffer_size(vw_platform *platform, uint32_t *out_width,
                                   uint32_t *out_height);
double vw_offscreen_content_scale(vw_platform *platform);
const char *vw_offscreen_clipboard(vw_platform *platform);
void vw_offscreen_set_clipboard(vw_platform *platform, const char *text);
void vw_offscreen_set_title(vw_platform *platform, const char *title);
const char *vw_offscreen_key_label(vw_platform *platform, int key);

#endif
