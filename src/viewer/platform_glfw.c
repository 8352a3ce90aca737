/* SPDX-License-Identifier: MIT
 *
 * A window by GLFW 3.3. Callbacks only turn what GLFW says into events; window positions and cursor
 * warps are not used, so Wayland is fine.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/pad.h"
#include "viewer/platform.h"

typedef struct platform_glfw {
    vw_platform base;
    GLFWwindow *window;
    GLFWgamepadstate pad; /* As last told. */
    bool has_keyboard;    /* A key was pressed. */
} platform_glfw;

enum { MODS = GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER };

static void push(GLFWwindow *window, const vw_event *event)
{
    platform_glfw *self = glfwGetWindowUserPointer(window);
    vw_event_push(&self->base.events, event);
}

static void on_key(GLFWwindow *window, int key, int scancode, int action, int mods)
{
    ((platform_glfw *)glfwGetWindowUserPointer(window))->has_keyboard = true;
    /* Here, so that a record replays the same on any keyboard. A key that is let go is the one
     * that was pressed: of those with Ctrl nothing is held. */
    if ((mods & GLFW_MOD_CONTROL) && action != GLFW_RELEASE)
        key = vw_key_of_label(key, glfwGetKeyName(key, scancode));
    push(window,
         &(vw_event){.kind = VW_EVENT_KEY, .code = key, .action = action, .mods = mods & MODS});
}

static void on_button(GLFWwindow *window, int button, int action, int mods)
{
    push(window,
         &(vw_event){
             .kind = VW_EVENT_BUTTON, .code = button, .action = action, .mods = mods & MODS});
}

/* GLFW speaks of screen units; the viewer of framebuffer pixels. */
static void on_cursor(GLFWwindow *window, double x, double y)
{
    int width, height, width_px, height_px;
    glfwGetWindowSize(window, &width, &height);
    glfwGetFramebufferSize(window, &width_px, &height_px);
    if (width > 0 && height > 0)
        push(window, &(vw_event){.kind = VW_EVENT_CURSOR,
                                 .x = x * width_px / width,
                                 .y = y * height_px / height});
}

static int held_mods(GLFWwindow *window)
{
    static const int keys[] = {GLFW_KEY_LEFT_SHIFT,    GLFW_KEY_RIGHT_SHIFT, GLFW_KEY_LEFT_CONTROL,
                               GLFW_KEY_RIGHT_CONTROL, GLFW_KEY_LEFT_ALT,    GLFW_KEY_RIGHT_ALT};
    int mods = 0;
    for (size_t i = 0; i < FL_COUNT_OF(keys); i++)
        if (glfwGetKey(window, keys[i]) == GLFW_PRESS)
            mods |= vw_key_modifier(keys[i]);
    return mods;
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    push(window, &(vw_event){.kind = VW_EVENT_SCROLL, .x = x, .y = y, .mods = held_mods(window)});
}

static void on_size(GLFWwindow *window, int width, int height)
{
    if (width > 0 && height > 0)
        push(window, &(vw_event){.kind = VW_EVENT_RESIZE,
                                 .width = (uint32_t)width,
                                 .height = (uint32_t)height});
}

/* Contents were damaged: a resize to the same size draws again. */
static void on_refresh(GLFWwindow *window)
{
    int width, height;
    glfwGetFramebufferSize(window, &width, &height);
    on_size(window, width, height);
}

static double scale_of(float raw)
{
    return fl_clamp((double)raw, VW_SCALE_MIN, VW_SCALE_MAX);
}

static void on_scale(GLFWwindow *window, float x, float y)
{
    (void)x;
    push(window, &(vw_event){.kind = VW_EVENT_SCALE, .x = scale_of(y)});
}

static void on_drop(GLFWwindow *window, int count, const char **paths)
{
    vw_event event = {.kind = VW_EVENT_DROP};
    if (count > 0 &&
        (size_t)snprintf(event.path, sizeof event.path, "%s", paths[0]) < sizeof event.path)
        push(window, &event);
}

static void on_focus(GLFWwindow *window, int is_focused)
{
    platform_glfw *self = glfwGetWindowUserPointer(window);
    if (is_focused)
        return;
    vw_pad_forget_sticks(&self->pad);
    push(window, &(vw_event){.kind = VW_EVENT_FOCUS});
}

static void on_iconify(GLFWwindow *window, int is_iconified)
{
    push(window,
         &(vw_event){.kind = VW_EVENT_ICONIFY, .action = is_iconified ? GLFW_PRESS : GLFW_RELEASE});
}

static void on_close(GLFWwindow *window)
{
    glfwSetWindowShouldClose(window, GLFW_FALSE);
    push(window, &(vw_event){.kind = VW_EVENT_CLOSE});
}

static void destroy(vw_platform *platform)
{
    platform_glfw *self = (platform_glfw *)platform;
    if (self->window)
        glfwDestroyWindow(self->window);
    glfwTerminate();
    vw_event_queue_deinit(&self->base.events);
    free(self);
}

/* The first gamepad, or none. */
static void poll_pad(platform_glfw *self)
{
    GLFWgamepadstate raw;
    bool is_there = false;
    for (int id = GLFW_JOYSTICK_1; id <= GLFW_JOYSTICK_LAST && !is_there; id++)
        is_there = glfwGetGamepadState(id, &raw);
    vw_pad_tell(&self->pad, is_there ? &raw : NULL, &self->base.events);
}

static bool is_focused(vw_platform *platform)
{
    return glfwGetWindowAttrib(((platform_glfw *)platform)->window, GLFW_FOCUSED);
}

static bool has_pad(vw_platform *platform)
{
    if (!is_focused(platform))
        return false;
    for (int id = GLFW_JOYSTICK_1; id <= GLFW_JOYSTICK_LAST; id++)
        if (glfwJoystickIsGamepad(id))
            return true;
    return false;
}

static void pump(vw_platform *platform, double timeout_s)
{
    if (timeout_s == 0.0 || platform->events.count > 0)
        glfwPollEvents();
    else if (timeout_s < 0.0)
        glfwWaitEvents();
    else
        glfwWaitEventsTimeout(timeout_s);
    if (is_focused(platform))
        poll_pad((platform_glfw *)platform);
}

static void wake(vw_platform *platform)
{
    (void)platform;
    glfwPostEmptyEvent();
}

static void swap(vw_platform *platform)
{
    glfwSwapBuffers(((platform_glfw *)platform)->window);
}

static void framebuffer_size(vw_platform *platform, uint32_t *out_width, uint32_t *out_height)
{
    int width, height;
    glfwGetFramebufferSize(((platform_glfw *)platform)->window, &width, &height);
    *out_width = (uint32_t)width;
    *out_height = (uint32_t)height;
}

static double content_scale(vw_platform *platform)
{
    float x = 1.0f, y = 1.0f;
    glfwGetWindowContentScale(((platform_glfw *)platform)->window, &x, &y);
    return scale_of(y);
}

static vw_gl_proc get_proc(void *platform, const char *name)
{
    (void)platform;
    return glfwGetProcAddress(name);
}

static const char *clipboard(vw_platform *platform)
{
    return glfwGetClipboardString(((platform_glfw *)platform)->window);
}

static void set_clipboard(vw_platform *platform, const char *text)
{
    glfwSetClipboardString(((platform_glfw *)platform)->window, text);
}

static void set_title(vw_platform *platform, const char *title)
{
    glfwSetWindowTitle(((platform_glfw *)platform)->window, title);
}

static const char *key_label(vw_platform *platform, int key)
{
    /* GLFW 3.3 crashes on Wayland when it is asked before there is a keyboard. */
    return ((platform_glfw *)platform)->has_keyboard ? glfwGetKeyName(key, 0) : NULL;
}

static const vw_platform_ops ops = {
    .name = "glfw",
    .destroy = destroy,
    .pump = pump,
    .wake = wake,
    .swap = swap,
    .framebuffer_size = framebuffer_size,
    .content_scale = content_scale,
    .get_proc = get_proc,
    .clipboard = clipboard,
    .set_clipboard = set_clipboard,
    .set_title = set_title,
    .key_label = key_label,
    .has_pad = has_pad,
};

/* The largest size of the wanted shape that fits the desktop. */
static void fit_desktop(int *width, int *height)
{
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    if (!monitor)
        return;
    int x, y, room_width = 0, room_height = 0;
    glfwGetMonitorWorkarea(monitor, &x, &y, &room_width, &room_height);
    if (room_width <= 0 || room_height <= 0)
        return;
    double scale = fl_min(1.0, fl_min((double)room_width / *width, (double)room_height / *height));
    *width = (int)fl_max(1.0, floor(*width * scale));
    *height = (int)fl_max(1.0, floor(*height * scale));
}

static void set_callbacks(GLFWwindow *window)
{
    glfwSetKeyCallback(window, on_key);
    glfwSetMouseButtonCallback(window, on_button);
    glfwSetCursorPosCallback(window, on_cursor);
    glfwSetScrollCallback(window, on_scroll);
    glfwSetFramebufferSizeCallback(window, on_size);
    glfwSetWindowRefreshCallback(window, on_refresh);
    glfwSetWindowContentScaleCallback(window, on_scale);
    glfwSetDropCallback(window, on_drop);
    glfwSetWindowFocusCallback(window, on_focus);
    glfwSetWindowIconifyCallback(window, on_iconify);
    glfwSetWindowCloseCallback(window, on_close);
}

static bool fail(fl_diags *diags, const char *what)
{
    const char *reason = NULL;
    glfwGetError(&reason);
    return fl_environment_error(
        diags, "%s (%s); without a display use 'firstlight render SCENE -o out.png'", what,
        reason ? reason : "no reason given");
}

vw_platform *vw_platform_glfw_create(const vw_window_desc *desc, fl_diags *diags)
{
    platform_glfw *self = calloc(1, sizeof *self);
    if (!self) {
        fl_out_of_memory(diags, "the window");
        return NULL;
    }
    self->base.ops = &ops;
    if (!glfwInit()) {
        fail(diags, "no display to open a window on");
        free(self);
        return NULL;
    }
    int width = (int)desc->width, height = (int)desc->height;
    fit_desktop(&width, &height);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    self->window = glfwCreateWindow(width, height, desc->title, NULL, NULL);
    if (!self->window) {
        fail(diags, "no window with OpenGL 3.3");
        destroy(&self->base);
        return NULL;
    }
    glfwSetWindowUserPointer(self->window, self);
    set_callbacks(self->window);
    glfwMakeContextCurrent(self->window);
    /* Drawing is paced by the application; waiting in swap would stall for hidden windows. */
    glfwSwapInterval(0);
    return &self->base;
}
