/* SPDX-License-Identifier: MIT
 *
 * Meshes that a library reads, in a process of its own: the library crashes, hangs and asks for
 * any amount of memory on damaged files (docs/decisions/066), and a window must outlive that.
 * mesh_apart.c starts the program `fl_assimp` (assimp_mesh.c), which reads the file and writes to
 * its standard output a head and then either a message or positions, normals, texture coordinates
 * and faces.
 */
#ifndef FL_IO_MESH_APART_H
#define FL_IO_MESH_APART_H

#include "core/firstlight.h"

#define FL_MESH_READER "fl_assimp"

enum { FL_MESH_MESSAGE_BYTES = 1024 };

typedef struct fl_mesh_head {
    uint32_t message_bytes; /**< Above 0: this is all there is, a message. */
    uint32_t cause;         /**< fl_cause of the message. */
    uint32_t position_count, normal_count, uv_count, face_count;
} fl_mesh_head;

/** Read a mesh with that program. NULL after adding an error at `loc`; what the program says is
 * checked as any file is. Any thread; about 10 ms above reading it here. */
fl_mesh *fl_mesh_load_apart(const char *path, fl_loc loc, fl_diags *diags);

#endif
