/* SPDX-License-Identifier: MIT
 *
 * Wavefront OBJ text to a mesh, with located diagnostics.
 */
#ifndef FL_IO_OBJ_H
#define FL_IO_OBJ_H

#include "core/firstlight.h"

/** Errors after which a file is given up: a wrong file is wrong on every line. */
enum { FL_OBJ_ERRORS_MAX = 8 };

/** Parse OBJ text. `name` labels messages (its path).
 *  Read: v (3 coordinates; a weight or a colour behind them is skipped), vt (1 to 3, the third
 * skipped), vn, and f of 3 or more corners a, a/b, a//c, a/b/c, also mixed; an index counts from 1,
 * or backwards from -1 at the face; 0 is "none" for b and c. Polygons become fans. `#` comments,
 * `\` at the end of a line, CRLF and CR line ends, a byte-order mark and a last line without an end
 * are fine; statements of other names are skipped. Returns a mesh with one reference, or NULL after
 * adding at least one error. Touches no disk; any thread. O(text). */
fl_mesh *fl_obj_parse(const char *text, size_t text_bytes, const char *name, fl_diags *diags);

#endif
