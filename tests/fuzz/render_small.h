/* SPDX-License-Identifier: MIT
 *
 * All the way through the core with a text that may be anything: parse, compile, 4 x 4 pixels of
 * one sample with at most 3 bounces, by two instruction sets that must agree in every bit.
 */
#ifndef TEST_RENDER_SMALL_H
#define TEST_RENDER_SMALL_H

#include "core/firstlight.h"

void fuzz_render_small(const char *text, size_t bytes, bool is_lenient, const fl_files *files);

#endif
