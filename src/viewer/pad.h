/* SPDX-License-Identifier: MIT
 *
 * From what a gamepad is like to what has changed about it. GLFW tells states, not events; which
 * numbers are events, and when a stick is at rest, is decided here. Plain values: tests make them
 * up.
 */
#ifndef VW_PAD_H
#define VW_PAD_H

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/event.h"

/** Push what differs between *told and `raw` (as glfwGetGamepadState fills it; NULL: there is no
 * gamepad) as VW_EVENT_AXIS and VW_EVENT_PAD, and note it in *told, which is zero-initialised.
 *
 * A stick is at rest within 0.15 of its middle, whatever its direction, and from there on its
 * distance runs from 0 to 1 in its own direction; triggers rest at -1 and run from 0 to 1. Steps of
 * 1/32 are finer than a thumb, and logs stay small. */
void vw_pad_tell(GLFWgamepadstate *told, const GLFWgamepadstate *raw, vw_event_queue *queue);

/** The window lost the keyboard, and with it what the sticks said: it is told again afterwards. */
void vw_pad_forget_sticks(GLFWgamepadstate *told);

#endif
