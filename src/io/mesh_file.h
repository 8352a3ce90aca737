/* SPDX-License-Identifier: MIT
 *
 * Meshes on disk: .obj by our own located reader, .ply .stl .gltf .glb by assimp in a process of
 * its own (mesh_apart.h).
 */
#ifndef FL_IO_MESH_FILE_H
#define FL_IO_MESH_FILE_H

#include "core/firstlight.h"

/** Largest mesh file that is read, and most elements of one kind (corners of faces, positions, ...)
 * in it. */
#define FL_MESH_FILE_MAX_BYTES ((size_t)2 << 30)
#define FL_MESH_ELEMENTS_MAX   ((uint32_t)100000000)

/** Read a mesh; the extension chooses the reader. One reference is the caller's. NULL after adding
 * an error: problems inside an .obj file are located in it, others at `loc`. Any thread. */
fl_mesh *fl_mesh_load(const char *path, fl_loc loc, fl_diags *diags);

#endif
