/* SPDX-License-Identifier: MIT
 *
 * Layer 3: scene text of any dialect to scene text of ours.
 */
#ifndef FL_FORMAT_H
#define FL_FORMAT_H

#include "core/parse.h"

/** The same scene written as `firstlight 1`: blocks, keys, groups and transforms in their order,
 * one key a line, numbers as short as they can be without loss, comments kept, names of files as
 * written. What a course's keys mean is spelled out in our keys, so that parsing the result gives
 * the same scene. Formatting twice changes nothing more. Reads no files. Returns text from malloc
 * with a final newline and a 0 after *out_bytes bytes; NULL after adding an error to `diags`.
 * O(text). */
char *fl_scene_format(const char *text, size_t text_bytes, const char *name,
                      const fl_parse_options *options, size_t *out_bytes, fl_diags *diags);

#endif
