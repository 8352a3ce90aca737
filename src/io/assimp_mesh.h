/* SPDX-License-Identifier: MIT
 *
 * The door to assimp; part of the program fl_assimp only.
 */
#ifndef FL_IO_ASSIMP_MESH_H
#define FL_IO_ASSIMP_MESH_H

#include "core/firstlight.h"

/** Read a file of `bytes` bytes: all its meshes as one, placed by their nodes, identical positions
 * joined. STL's face normals are dropped: they belong to no vertex, and `auto` would be flat. NULL
 * after adding an error. May crash, or ask for any time and memory. */
fl_mesh *fl_mesh_load_assimp(const char *path, size_t bytes, fl_diags *diags);

#endif
