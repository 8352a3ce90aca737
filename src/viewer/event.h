/* SPDX-License-Identifier: MIT
 *
 * Input as plain values. Windows, logs and tests all produce these; nothing else reaches the
 * commands. Key, button, action and modifier codes are GLFW's, positions are framebuffer pixels
 * from the top left, so that a log means the same on every display.
 */
#ifndef VW_EVENT_H
#define VW_EVENT_H

#include "core/firstlight.h"

typedef enum vw_event_kind {
    VW_EVENT_KEY,
    VW_EVENT_BUTTON,
    VW_EVENT_CURSOR,
    VW_EVENT_SCROLL,
    VW_EVENT_RESIZE,
    VW_EVENT_DROP,
    VW_EVENT_RELOAD,  /**< The scene's files have changed: read it again. */
    VW_EVENT_PASTE,   /**< Text of the clipboard, in `path`, on one line. */
    VW_EVENT_FOCUS,   /**< The window lost the keyboard: everything held is released. */
    VW_EVENT_ICONIFY, /**< The window became an icon (action GLFW_PRESS), or a window again. */
    VW_EVENT_SCALE,   /**< The screen has another density: x pixels of text per point. */
    VW_EVENT_AXIS,    /**< A gamepad's stick or trigger: x, -1 to 1, 0 within the dead zone. */
    VW_EVENT_PAD,     /**< A gamepad's button. */
    VW_EVENT_CLOSE    /**< The user asked the window to close. */
} vw_event_kind;

enum { VW_PATH_MAX = 1024 };
#define VW_SCALE_MIN 0.5 /* Of VW_EVENT_SCALE. */
#define VW_SCALE_MAX 8.0

typedef struct vw_event {
    vw_event_kind kind;
    int code;    /**< Key or button. */
    int action;  /**< GLFW_PRESS, GLFW_RELEASE or GLFW_REPEAT. */
    int mods;    /**< GLFW_MOD_ bits: shift, control, alt, super; locks are masked out. */
    double x, y; /**< Cursor: position. Scroll: notches. */
    uint32_t width, height; /**< Resize: new framebuffer size. */
    char path[VW_PATH_MAX]; /**< Drop, paste. */
} vw_event;

/** GLFW's name of a key or mouse button without its prefix: "W", "LEFT_SHIFT", "F12"; "LEFT",
 * "MIDDLE". NULL: no such code. Static text. */
const char *vw_key_name(int key);
const char *vw_button_name(int button);

/** The code of a name, with or without GLFW_, KEY_ or MOUSE_BUTTON_ before it, any letter case; -1:
 * unknown. */
int vw_key_find(const char *name, size_t name_bytes);
int vw_button_find(const char *name, size_t name_bytes);

/** The GLFW_MOD_ bit that a key is held for; 0: it is an ordinary key. */
int vw_key_modifier(int key);

/** The key that a chord with Ctrl means: letters as the keyboard prints them (`label`, from the
 * platform; NULL: unknown), so that Ctrl+Z is where Z is; any other key by its place. */
int vw_key_of_label(int key, const char *label);

/** Names of a gamepad's axes and buttons: "LEFT_X", "RIGHT_TRIGGER"; "A", "DPAD_UP". */
const char *vw_axis_name(int axis);
const char *vw_pad_name(int button);
int vw_axis_find(const char *name, size_t name_bytes);
int vw_pad_find(const char *name, size_t name_bytes);

/** The known names nearest to a misspelt one, or NULL. Static text. */
const char *vw_key_nearest(const char *name, size_t name_bytes);
const char *vw_button_nearest(const char *name, size_t name_bytes);

/** A growing first-in first-out queue of events; zero-initialise. One thread. When memory runs out
 * the event is counted in dropped_count instead. */
typedef struct vw_event_queue {
    vw_event *items;
    size_t begin, count, capacity;
    size_t dropped_count;
} vw_event_queue;

void vw_event_push(vw_event_queue *queue, const vw_event *event);
bool vw_event_pop(vw_event_queue *queue, vw_event *out_event);
void vw_event_queue_deinit(vw_event_queue *queue);

#endif
