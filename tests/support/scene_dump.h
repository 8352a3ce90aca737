/* SPDX-License-Identifier: MIT
 *
 * For tests: what a scene says, as text to compare; and files that exist without a disk.
 */
#ifndef FL_TEST_SCENE_DUMP_H
#define FL_TEST_SCENE_DUMP_H

#include "core/parse.h"

/** Everything a scene says except places, dialect and file contents, one value a line, numbers
 * exact. From malloc. */
char *scene_dump(const fl_scene *scene);

/** Counts what a parser asked for. */
typedef struct fake_files {
    fl_files files; /**< Give &fake.files to the parser. */
    uint32_t find_count, mesh_count, image_count;
} fake_files;

/** Files of which every one exists, a mesh being one triangle and a picture one white pixel; names
 * that hold "missing" do not exist, and names that hold "broken" cannot be read. */
void fake_files_init(fake_files *fake);

#endif
