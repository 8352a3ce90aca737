/* SPDX-License-Identifier: MIT */
#include "core/scene.h"

#include <stdlib.h>

void fl_scene_destroy(fl_scene *scene)
{
    if (!scene)
        return;
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        fl_mesh_release(scene->meshes[i].mesh);
    for (uint32_t i = 0; i < scene->image_count; i++)
        fl_image_release(scene->images[i].image);
    fl_arena_deinit(&scene->arena);
    free(scene);
}
