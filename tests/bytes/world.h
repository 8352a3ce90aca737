/* SPDX-License-Identifier: MIT
 *
 * Files that exist only in memory, made by exact arithmetic: the same bits with every compiler and
 * on every machine. Meshes: ring (texture coordinates), bumps (normals and texture coordinates),
 * slivers (needles, duplicates, triangles without area). Pictures: checker (sRGB bytes), ramp
 * (linear bytes), glow (floats), and the six of the folder sky. Endings are `.obj` and `.png`.
 */
#ifndef TEST_WORLD_H
#define TEST_WORLD_H

#include "core/firstlight.h"

/** Finds and reads the files above and no others. */
extern const fl_files test_world;

#endif
