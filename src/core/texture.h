/* SPDX-License-Identifier: MIT
 *
 * Layer 6: reading textures and the background's cube map. Plain double arithmetic in one source
 * for all instruction sets, so the same bytes everywhere. Any float is a legal coordinate: a
 * non-finite one counts as 0. Thread: any. Cost: at most four texels.
 */
#ifndef FL_TEXTURE_H
#define FL_TEXTURE_H

#include "core/compile.h"

/** Linear colour at (u, v), each first multiplied by texture->scale. v = 0 is the bottom row, texel
 * centres lie at (i + 1/2) / size, u repeats, v clamps or repeats (decision 11). */
void fl_texture_eval(const fl_texture *texture, float u, float v, float out_rgb[3]);
/** The same with coordinates and colour that are not rounded. */
void fl_texture_eval_double(const fl_texture *texture, double u, double v, double out_rgb[3]);

/** Linear colour of the cube map in direction `d` (any length; 0 or not finite: the right face's
 * centre). Seen from inside: right is +x, up +y, front +z; `up` and `down` continue `back`, which
 * one sees looking along -z upright. Bilinear, clamped at the edges of a face. is_course: as M12's
 * own code reads it, `back` mirrored left to right, `down` upside down, and texel corners in the
 * place of texel centres. */
void fl_cube_eval(fl_image *const faces[FL_CUBE_FACES], const float d[3], bool is_course,
                  float out_rgb[3]);

/** The same without rounding. */
void fl_cube_eval_double(fl_image *const faces[FL_CUBE_FACES], const double d[3], bool is_course,
                         double out_rgb[3]);

#endif
