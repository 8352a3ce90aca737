/* SPDX-License-Identifier: MIT
 *
 * Is a picture file all there? Looks at the structure only, decodes nothing.
 */
#ifndef FL_IO_IMAGE_WHOLE_H
#define FL_IO_IMAGE_WHOLE_H

#include "core/firstlight.h"

/** False for a PNG or JPEG that stops before its end mark, and for an EXR before the end of its
 * head. True for every other kind of file: the image library reports those itself. Bytes behind the
 * end mark are legal. O(bytes), any thread. */
bool fl_image_is_whole(const void *data, size_t bytes);

/** The size that an EXR or a GIF says it has, of several the largest: the image library takes
 * memory by these before it can be asked. False: another kind of file, or not whole. The size may
 * be any of an int, and 0. O(head), any thread. */
bool fl_image_claim(const void *data, size_t bytes, int64_t *out_width, int64_t *out_height);

#endif
