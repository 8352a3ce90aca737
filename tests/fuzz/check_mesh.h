/* SPDX-License-Identifier: MIT
 *
 * What must hold for every mesh, whoever read it: indices in range, numbers finite.
 */
#ifndef TEST_CHECK_MESH_H
#define TEST_CHECK_MESH_H

#include <math.h>

#include "core/firstlight.h"
#include "fuzz/fuzz.h"

static inline void check_indices(const uint32_t index[3], uint32_t count, bool may_miss)
{
    for (int i = 0; i < 3; i++)
        MUST(index[i] < count || (may_miss && index[i] == FL_NONE));
}

static inline void check_mesh(const fl_mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->position_count; i++)
        MUST(fl_v3_is_finite(mesh->positions[i]));
    for (uint32_t i = 0; i < mesh->normal_count; i++)
        MUST(fl_v3_is_finite(mesh->normals[i]));
    for (uint32_t i = 0; i < mesh->uv_count; i++)
        MUST(isfinite(mesh->uvs[i].u) && isfinite(mesh->uvs[i].v));
    for (uint32_t i = 0; i < mesh->face_count; i++) {
        check_indices(mesh->faces[i].position, mesh->position_count, false);
        check_indices(mesh->faces[i].normal, mesh->normal_count, true);
        check_indices(mesh->faces[i].uv, mesh->uv_count, true);
    }
}

#endif
