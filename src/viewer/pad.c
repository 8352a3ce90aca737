/* SPDX-License-Identifier: MIT */
#include "viewer/pad.h"

#include <string.h>

#define DEAD_ZONE  0.15
#define AXIS_STEPS 32.0

static double beyond_dead_zone(double size)
{
    return fl_clamp((size - DEAD_ZONE) / (1.0 - DEAD_ZONE), 0.0, 1.0);
}

static float stepped(double value)
{
    return (float)(copysign(floor(fabs(value) * AXIS_STEPS + 0.5), value) / AXIS_STEPS + 0.0);
}

static void read_stick(const GLFWgamepadstate *raw, int axis, float *out_axes)
{
    double x = (double)raw->axes[axis], y = (double)raw->axes[axis + 1], size = sqrt(x * x + y * y);
    double scale = size > 0.0 ? beyond_dead_zone(size) / size : 0.0;
    out_axes[axis] = stepped(fl_clamp(x * scale, -1.0, 1.0));
    out_axes[axis + 1] = stepped(fl_clamp(y * scale, -1.0, 1.0));
}

/* From -1, at rest, to 1. GLFW says 0 of a trigger that the pad's mapping lacks. */
static float read_trigger(float raw)
{
    return raw == 0.0f ? 0.0f : stepped(beyond_dead_zone(((double)raw + 1.0) / 2.0));
}

void vw_pad_tell(GLFWgamepadstate *told, const GLFWgamepadstate *raw, vw_event_queue *queue)
{
    GLFWgamepadstate now = {0};
    if (raw) {
        memcpy(now.buttons, raw->buttons, sizeof now.buttons);
        read_stick(raw, GLFW_GAMEPAD_AXIS_LEFT_X, now.axes);
        read_stick(raw, GLFW_GAMEPAD_AXIS_RIGHT_X, now.axes);
        for (int axis = GLFW_GAMEPAD_AXIS_LEFT_TRIGGER; axis <= GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER;
             axis++)
            now.axes[axis] = read_trigger(raw->axes[axis]);
    }
    for (int axis = 0; axis <= GLFW_GAMEPAD_AXIS_LAST; axis++)
        if (now.axes[axis] != told->axes[axis])
            vw_event_push(
                queue,
                &(vw_event){.kind = VW_EVENT_AXIS, .code = axis, .x = (double)now.axes[axis]});
    for (int button = 0; button <= GLFW_GAMEPAD_BUTTON_LAST; button++)
        if (now.buttons[button] != told->buttons[button])
            vw_event_push(
                queue,
                &(vw_event){.kind = VW_EVENT_PAD, .code = button, .action = now.buttons[button]});
    *told = now;
}

void vw_pad_forget_sticks(GLFWgamepadstate *told)
{
    memset(told->axes, 0, sizeof told->axes);
}
