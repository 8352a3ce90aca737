/* SPDX-License-Identifier: MIT
 *
 * A scene with all that it names in one file, pictures decoded and meshes as arrays, just as the
 * parser is handed them (parse.h). Written by flatten, where the libraries are; read by bytes,
 * where the core stands alone.
 *
 * Little endian, nothing between the fields:
 *
 *   8 bytes "flscene1"
 *   u32   width, height and samples of the golden picture
 *   text  the scene
 *   u32   how many files it names; of each:
 *         text  what the scene calls it
 *         u32   0: a mesh, 1: a picture
 *         mesh:    u32 positions, normals, texture coordinates, faces; the arrays, in this order:
 *                  3 doubles, 3 doubles, 2 floats, 9 u32 as in fl_face
 *         picture: u32 width, height, fl_pixel_format; 3 bytes or 3 floats a pixel, top row first
 *
 * where text is u32 bytes, then the bytes.
 */
#ifndef TEST_FLAT_H
#define TEST_FLAT_H

#include "core/firstlight.h"

typedef struct flat_file {
    char *name;
    fl_mesh *mesh; /**< One of the two, the other is NULL. */
    fl_image *image;
} flat_file;

/** All owned by whoever fills it; what flat_read has filled is freed by flat_close. */
typedef struct flat_scene {
    uint32_t width, height, samples;
    char *text; /**< With a 0 behind it. */
    flat_file *files;
    uint32_t file_count;
} flat_scene;

/** False: it cannot be written. */
bool flat_write(flat_scene *scene, const char *path);

/** False: it cannot be read, or is no such file; nothing is to be freed then. */
bool flat_read(flat_scene *out_scene, const char *path);
void flat_close(flat_scene *scene);

/** Hands the parser the files of `scene` and no others; borrows it. */
fl_files flat_files(flat_scene *scene);

#endif
