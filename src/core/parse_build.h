/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to the parser and the formatter: a checked tree to a scene. Every function here
 * adds an error and goes on where it can; the caller asks the list of diagnostics at the end.
 */
#ifndef FL_PARSE_BUILD_H
#define FL_PARSE_BUILD_H

#include "core/parse.h"
#include "core/parse_tree.h"

/** State while a scene is built. */
typedef struct fl_builder {
    fl_scene *scene;
    const fl_tree *tree;
    const fl_files
        *files; /**< NULL: files are not looked for; their handles keep the name as written. */
    fl_diags *diags;
    const char *text; /**< To quote from again after a file was read. */
    size_t text_bytes;
    const char **mesh_references,
        **image_references; /**< As written, beside scene->meshes and images. */
    uint64_t
        file_bytes;    /**< In memory, of meshes and pictures so far, with what meshes will need. */
    uint32_t material; /**< The current MaterialIndex; FL_NONE before the first. */
    uint32_t default_material; /**< FL_NONE until an object needs it. */
} fl_builder;

/** A scene from a tree without errors; NULL after an error. `path` is copied; the tree's text may
 * go. */
fl_scene *fl_build_scene(const fl_tree *tree, const char *text, size_t text_bytes,
                         const fl_files *files, fl_diags *diags);

/** Parts of it, each from the node of its block. */
void fl_build_camera(fl_builder *b, const fl_node *node, fl_camera *out_camera);
void fl_build_background(fl_builder *b, const fl_node *node);
void fl_build_render(fl_builder *b, const fl_node *node);
void fl_build_light(fl_builder *b, const fl_node *node, fl_light *out_light);
void fl_build_material(fl_builder *b, const fl_node *node, fl_material *out_material);
void fl_build_objects(fl_builder *b, const fl_node *group);
/** Index of a new profile, or FL_NONE after an error. */
uint32_t fl_build_profile(fl_builder *b, const fl_node *curve);
/** The map of a Transform's own keys; false after an error. */
bool fl_build_transform(fl_builder *b, const fl_node *node, fl_affine *out_map);

/** Handle of a mesh or picture by the name in the text; each is read once. FL_NONE after an error.
 */
uint32_t fl_build_mesh_file(fl_builder *b, const fl_node *key);
uint32_t fl_build_image_file(fl_builder *b, const fl_node *key);
/** The six pictures of a cube map's folder. */
void fl_build_cube_map(fl_builder *b, const fl_node *key, uint32_t out_images[FL_CUBE_FACES]);

/** Numbers of the key `id` in `block`, else its default in the grammar table, else nothing (returns
 * 0). At most 4. */
uint32_t fl_build_numbers(const fl_builder *b, const fl_node *block, fl_key_id id,
                          double out_numbers[4]);
double fl_build_number(const fl_builder *b, const fl_node *block, fl_key_id id);
fl_vec3 fl_build_vec3(const fl_builder *b, const fl_node *block, fl_key_id id);
/** Position of the choice given, else of the default. */
uint32_t fl_build_choice(const fl_builder *b, const fl_node *block, fl_key_id id);

/** A direction of unit length; a zero one is an error at its key. */
fl_vec3 fl_build_direction(fl_builder *b, const fl_node *block, fl_key_id id);

/** Place of a node's name. */
fl_loc fl_build_loc(const fl_builder *b, const fl_node *node);

#endif
