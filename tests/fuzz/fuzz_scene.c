/* SPDX-License-Identifier: MIT
 *
 * Scene texts of every dialect, from the words to the pixels. Texts of odd length are read
 * leniently. mutate_scene.c makes new ones from the grammar.
 */
#include "bytes/world.h"
#include "fuzz/fuzz.h"
#include "fuzz/render_small.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    fuzz_render_small((const char *)data, bytes, bytes & 1, &test_world);
    return 0;
}
