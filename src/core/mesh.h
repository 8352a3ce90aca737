/* SPDX-License-Identifier: MIT
 *
 * Layer 2: a triangle mesh as read from a file: indexed, in object space, with the file's own normals and
 * texture coordinates if it has them. How files become meshes is not known here (src/io).
 */
#ifndef FL_MESH_H
#define FL_MESH_H

#include "core/ref.h"
#include "core/vec.h"

/** Most faces of a mesh: what its hierarchies can number. */
enum { FL_FACES_MAX = 1 << 28 };

/** Three corners of a face; each an index into the mesh's arrays, FL_NONE where the file gives none. */
typedef struct fl_face {
    uint32_t position[3];
    uint32_t normal[3];
    uint32_t uv[3];
} fl_face;

typedef struct fl_uv {
    float u, v;
} fl_uv;

/** Reference counted and immutable once shared. Polygons have been cut into triangle fans, in file order;
 *  degenerate faces are kept (they are never hit, but they count). Every index is in range. */
typedef struct fl_mesh {
    fl_ref ref;
    fl_vec3 *positions; /**< Object space; finite. Owned, from malloc; so are the arrays below. */
    fl_vec3 *normals;   /**< As in the file, not necessarily unit length. */
    fl_uv *uvs;
    fl_face *faces;
    uint32_t position_count, normal_count, uv_count, face_count;
} fl_mesh;

/** How vertex normals come about (decision 14). */
typedef enum fl_normals {
    FL_NORMALS_AUTO,   /**< The file's if every face has them, else smooth. */
    FL_NORMALS_FLAT,   /**< One geometric normal a face. */
    FL_NORMALS_SMOOTH, /**< Mean of the unit normals of the faces around a vertex. */
    FL_NORMALS_ANGLE,  /**< The same, each weighted by the face's angle at the vertex. */
    FL_NORMALS_FILE    /**< The file's; an error if it has none. */
} fl_normals;

/** An empty mesh with one reference; NULL: out of memory. The creator fills the arrays. */
fl_mesh *fl_mesh_create(void);
fl_mesh *fl_mesh_retain(fl_mesh *mesh);
/** Drop a reference; NULL is allowed. */
void fl_mesh_release(fl_mesh *mesh);

/** Bytes of its arrays. */
size_t fl_mesh_bytes(const fl_mesh *mesh);

/** Normals per position by SMOOTH or ANGLE, unit length, written to out_normals[position_count]. A vertex
 *  whose faces are all degenerate or cancel gets the zero vector: its faces are then shaded flat.
 *  Sums run in face order, in double: the same bits everywhere. O(faces). */
void fl_mesh_vertex_normals(const fl_mesh *mesh, fl_normals how, fl_vec3 *out_normals);

#endif
