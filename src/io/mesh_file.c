/* SPDX-License-Identifier: MIT */
#include "io/mesh_file.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "io/files.h"
#include "io/mesh_apart.h"
#include "io/obj.h"
#include "io/path.h"

static fl_mesh *load_obj(const char *path, fl_loc loc, fl_diags *diags)
{
    size_t bytes;
    char *text = fl_file_load(path, "mesh", FL_MESH_FILE_MAX_BYTES, loc, diags, &bytes);
    if (!text)
        return NULL;
    fl_mesh *mesh = fl_obj_parse(text, bytes, path, diags);
    free(text);
    return mesh;
}

typedef struct mesh_kind {
    const char *extension;
    fl_mesh *(*load)(const char *path, fl_loc loc, fl_diags *diags);
} mesh_kind;

static const mesh_kind kinds[] = {
    {".obj", load_obj},           {".ply", fl_mesh_load_apart},
    {".stl", fl_mesh_load_apart}, {".gltf", fl_mesh_load_apart},
    {".glb", fl_mesh_load_apart},
};

fl_mesh *fl_mesh_load(const char *path, fl_loc loc, fl_diags *diags)
{
    for (size_t i = 0; i < FL_COUNT_OF(kinds); i++)
        if (strcasecmp(fl_path_ending(path), kinds[i].extension) == 0)
            return kinds[i].load(path, loc, diags);
    fl_error(diags, loc, "cannot read mesh '%s': the name must end in .obj .ply .stl .gltf or .glb",
             path);
    return NULL;
}
