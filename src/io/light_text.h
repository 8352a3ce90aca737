/* SPDX-License-Identifier: MIT
 *
 * Lights that a user has changed, as text: what a saved picture, a bookmark and the clipboard keep
 * of them. No state; any thread.
 */
#ifndef FL_IO_LIGHT_TEXT_H
#define FL_IO_LIGHT_TEXT_H

#include "core/firstlight.h"

enum { FL_LIGHT_TEXT_MAX = 6144, FL_LIGHT_TEXT_LIGHTS = 16 };

/** Count, then position, direction, radius and colour of each, every number read back exactly. At
 * most FL_LIGHT_TEXT_LIGHTS; of more: an empty text. */
void fl_lights_text(const fl_light *lights, uint32_t count, char out[FL_LIGHT_TEXT_MAX]);

/** Put such numbers over lights that have their other properties. False, and nothing changed: the
 * text is not of so many lights, or not within bounds. */
bool fl_lights_read(const char *text, fl_light *lights, uint32_t count);

/** As a `Lights` block of scene text. Length as snprintf. */
size_t fl_lights_scene_text(const fl_light *lights, uint32_t count, char *out, size_t out_bytes);

#endif
