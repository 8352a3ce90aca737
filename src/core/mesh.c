/* SPDX-License-Identifier: MIT */
#include "core/mesh.h"

#include <stdlib.h>

#include "core/math64.h"

/* A cross product of vectors whose largest entries are 1 carries a rounding error of at most
 * 3 * 2^-53 an entry, and scaling the edges adds as much again: below this it says nothing. */
static const double degenerate_cross = 8.0 / 9007199254740992.0;

/* A sum of n unit vectors is known to n * 2^-52 only; shorter than this, the vectors cancel. */
static const double cancelled_sum = 1e-9;

fl_mesh *fl_mesh_create(void)
{
    fl_mesh *mesh = calloc(1, sizeof *mesh);
    if (mesh)
        fl_ref_init(&mesh->ref);
    return mesh;
}

fl_mesh *fl_mesh_retain(fl_mesh *mesh)
{
    fl_ref_retain(&mesh->ref);
    return mesh;
}

void fl_mesh_release(fl_mesh *mesh)
{
    if (!mesh || !fl_ref_release(&mesh->ref))
        return;
    free(mesh->positions);
    free(mesh->normals);
    free(mesh->uvs);
    free(mesh->faces);
    free(mesh);
}

size_t fl_mesh_bytes(const fl_mesh *mesh)
{
    return mesh->position_count * sizeof *mesh->positions +
           mesh->normal_count * sizeof *mesh->normals + mesh->uv_count * sizeof *mesh->uvs +
           mesh->face_count * sizeof *mesh->faces;
}

/* Angle in [0, pi] between two unit vectors, accurate near both ends [Kahan, "How Futile are
 * Mindless Assessments of Roundoff", section 12]. */
static double angle_between(fl_vec3 a, fl_vec3 b)
{
    double difference = fl_v3_length(fl_v3_sub(a, b)), sum = fl_v3_length(fl_v3_add(a, b));
    return 2.0 * fl_d_atan2(difference, sum);
}

/* Unit geometric normal; false for a face without area. Edges are scaled by one common factor
 * first, so that neither tiny nor huge models lose their normals. */
static bool face_normal(const fl_vec3 corner[3], fl_vec3 *out_normal)
{
    fl_vec3 a = fl_v3_sub(corner[1], corner[0]), b = fl_v3_sub(corner[2], corner[0]);
    double scale_a = fl_v3_max_abs(a), scale_b = fl_v3_max_abs(b);
    if (!(scale_a > 0.0 && scale_b > 0.0 && isfinite(scale_a) && isfinite(scale_b)))
        return false;
    fl_vec3 cross = fl_v3_cross(fl_v3(a.x / scale_a, a.y / scale_a, a.z / scale_a),
                                fl_v3(b.x / scale_b, b.y / scale_b, b.z / scale_b));
    if (!(fl_v3_max_abs(cross) > degenerate_cross))
        return false;
    *out_normal = fl_v3_normalize(cross);
    return true;
}

void fl_mesh_vertex_normals(const fl_mesh *mesh, fl_normals how, fl_vec3 *out_normals)
{
    FL_ASSERT(how == FL_NORMALS_SMOOTH || how == FL_NORMALS_ANGLE);
    for (uint32_t v = 0; v < mesh->position_count; v++)
        out_normals[v] = fl_v3(0, 0, 0);
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const fl_face *face = &mesh->faces[f];
        fl_vec3 corner[3], normal;
        for (int k = 0; k < 3; k++)
            corner[k] = mesh->positions[face->position[k]];
        if (!face_normal(corner, &normal))
            continue;
        for (int k = 0; k < 3; k++) {
            double weight = 1.0;
            if (how == FL_NORMALS_ANGLE) {
                fl_vec3 next = fl_v3_sub(corner[(k + 1) % 3], corner[k]);
                fl_vec3 last = fl_v3_sub(corner[(k + 2) % 3], corner[k]);
                weight = angle_between(fl_v3_normalize(next), fl_v3_normalize(last));
            }
            fl_vec3 *sum = &out_normals[face->position[k]];
            *sum = fl_v3_mad(*sum, normal, weight);
        }
    }
    for (uint32_t v = 0; v < mesh->position_count; v++) {
        bool has_direction = fl_v3_length(out_normals[v]) > cancelled_sum;
        out_normals[v] = has_direction ? fl_v3_normalize(out_normals[v]) : fl_v3(0, 0, 0);
    }
}
