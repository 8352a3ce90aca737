/* SPDX-License-Identifier: MIT
 *
 * The look at a picture's structure that comes before the image library sees it.
 */
#include "fuzz/fuzz.h"
#include "io/image_whole.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    fl_image_is_whole(data, bytes);
    return 0;
}
