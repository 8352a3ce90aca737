/* SPDX-License-Identifier: MIT
 *
 * OBJ text: a mesh with every index in range and every number finite, or located errors; and what
 * is a mesh can be compiled and traced.
 */
#include <string.h>

#include "fuzz/check_mesh.h"
#include "fuzz/render_small.h"
#include "io/obj.h"

static bool find(void *context, const char *scene_path, const char *reference, char *out_path,
                 size_t out_bytes)
{
    (void)context;
    (void)scene_path;
    return (size_t)snprintf(out_path, out_bytes, "%s", reference) < out_bytes;
}

static fl_mesh *load_mesh(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)path;
    (void)loc;
    (void)diags;
    return fl_mesh_retain(context);
}

static void render(fl_mesh *mesh)
{
    static const char text[] =
        "firstlight 1\nPerspectiveCamera { center 0.1 0.2 3 direction 0 0 -1 up 0 1 0 angle 60 }\n"
        "Lights { PointLight { position 1 2 3 color 1 1 1 } }\n"
        "Group { TriangleMesh { file m.obj normals smooth } Transform { XRotate 40 TriangleMesh { "
        "file m.obj } } }\n";
    fl_files files = {.context = mesh, .find = find, .load_mesh = load_mesh};
    fuzz_render_small(text, sizeof text - 1, false, &files);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    fl_diags diags = {0};
    fl_mesh *mesh = fl_obj_parse((const char *)data, bytes, "fuzz.obj", &diags);
    MUST(!mesh == (diags.error_count > 0));
    if (mesh) {
        check_mesh(mesh);
        if (mesh->face_count)
            render(mesh);
    }
    fl_mesh_release(mesh);
    fl_diags_deinit(&diags);
    return 0;
}
