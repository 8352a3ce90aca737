/* SPDX-License-Identifier: MIT
 *
 * Is a picture file all there? Looks at the structure only, decodes nothing.
 */
#ifndef FL_IO_IMAGE_WHOLE_H
#define FL_IO_IMAGE_WHOLE_H

#include "core/firstlight.h"

/** False for a PNG or JPEG that stops before its end mark. True for every other kind of file: the
 * image library reports those itself. Bytes behind the end mark are legal. O(bytes), any thread. */
bool fl_image_is_whole(const void *data, size_t bytes);

#endif
