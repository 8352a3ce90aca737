/* SPDX-License-Identifier: MIT
 *
 * Layer 3: scene text to scene.
 */
#ifndef FL_PARSE_H
#define FL_PARSE_H

#include "core/scene.h"

/** How the parser reaches files that a scene names; implemented in src/io, faked in tests. The core itself
 *  opens nothing. `context` is passed back unchanged. */
typedef struct fl_files {
    void *context;
    /** Find the file or folder that `reference` names in the scene `scene_path`: as given, then the scene's folder,
     *  then its parents. Writes a path of at most out_bytes with its 0. False: no such file. */
    bool (*find)(void *context, const char *scene_path, const char *reference, char *out_path,
                 size_t out_bytes);
    /** Read a mesh. NULL after adding an error; problems inside the file are located in it, others at `loc`. */
    fl_mesh *(*load_mesh)(void *context, const char *path, fl_loc loc, fl_diags *diags);
    /** Read a picture. NULL after adding an error at `loc`. */
    fl_image *(*load_image)(void *context, const char *path, fl_loc loc, fl_diags *diags);
} fl_files;

typedef struct fl_parse_options {
    bool has_dialect; /**< False: recognise it from the text. */
    fl_dialect dialect;
    bool is_lenient; /**< Turn the listed slips of real course files into warnings. */
} fl_parse_options;

/** Parse scene text. `name` labels messages (usually the path) and is copied. The text may hold any bytes.
 *  Returns a scene owned by the caller (fl_scene_destroy), or NULL after adding at least one error to `diags`; keeps
 *  going after an error to report up to FL_DIAGS_MAX of them. Reads meshes and images through `files`, each distinct
 *  path once. O(text) besides those. */
fl_scene *fl_scene_parse(const char *text, size_t text_bytes, const char *name,
                         const fl_parse_options *options, const fl_files *files, fl_diags *diags);

/** Names as on the command line: "firstlight", "pa1", "m04", "m12". */
extern const char *const fl_dialect_names[FL_DIALECT_COUNT];

#endif
