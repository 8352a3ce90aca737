/* SPDX-License-Identifier: MIT
 *
 * A window with an OpenGL 3.3 core context, or the same without a display. Files implement the
 * table; nothing else differs between them. All functions are the creating thread's, except wake.
 * Events are queued as plain values; platform code touches no other state.
 */
#ifndef VW_PLATFORM_H
#define VW_PLATFORM_H

#include "viewer/event.h"
#include "viewer/gl.h"

typedef struct vw_platform vw_platform;

typedef struct vw_platform_ops {
    const char *name;
    void (*destroy)(vw_platform *platform);
    /** Gather events into the queue. timeout_s < 0: block until there is one or wake is called; 0:
     * only look. */
    void (*pump)(vw_platform *platform, double timeout_s);
    /** End a pump that blocks, now or the next one. Any thread. */
    void (*wake)(vw_platform *platform);
    void (*swap)(vw_platform *platform);
    void (*framebuffer_size)(vw_platform *platform, uint32_t *out_width, uint32_t *out_height);
    /** Pixels of text per point: 1 on a plain display, 2 on a dense one. VW_SCALE_MIN to
     * VW_SCALE_MAX; changes are events. NULL: 1. */
    double (*content_scale)(vw_platform *platform);
    vw_gl_proc (*get_proc)(void *platform, const char *name);
    /** Text of the clipboard, or NULL; valid until the next call. */
    const char *(*clipboard)(vw_platform *platform);
    void (*set_clipboard)(vw_platform *platform, const char *text);
    void (*set_title)(vw_platform *platform, const char *title);
    /** What the user's keyboard prints on that key ("w"), or NULL for keys that print nothing.
     */
    const char *(*key_label)(vw_platform *platform, int key);
    /** A gamepad is connected and the window has the keyboard: it has no events, so pump must be
     * called again and again. NULL: never. */
    bool (*has_pad)(vw_platform *platform);
    /** Change the framebuffer; offscreen only, NULL elsewhere. False after adding an error. */
    bool (*resize)(vw_platform *platform, uint32_t width, uint32_t height, fl_diags *diags);
} vw_platform_ops;

/** First member of every implementation. */
struct vw_platform {
    const vw_platform_ops *ops;
    vw_event_queue events;
};

typedef struct vw_window_desc {
    const char *title;
    uint32_t width,
        height; /**< GLFW: screen units, shrunk to fit the desktop; offscreen: pixels. */
} vw_window_desc;

/** NULL after adding an environment error with what to do instead. The context is current. */
vw_platform *vw_platform_glfw_create(const vw_window_desc *desc, fl_diags *diags);
vw_platform *vw_platform_osmesa_create(const vw_window_desc *desc, fl_diags *diags);
vw_platform *vw_platform_egl_create(const vw_window_desc *desc, fl_diags *diags);

/** By name; NULL for `name`: the window if `wants_window`, else osmesa, then egl. */
vw_platform *vw_platform_create(const char *name, bool wants_window, const vw_window_desc *desc,
                                fl_diags *diags);

#endif
