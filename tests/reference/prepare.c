/* SPDX-License-Identifier: MIT
 *
 * What the reference derives from a dump before the first sample.
 */
#include <stdlib.h>

#include "reference.h"
#include "vector.h"

static bool invert(double m[3][4], double out[3][4])
{
    ref_vec c[3], t = vec(m[0][3], m[1][3], m[2][3]);
    for (int i = 0; i < 3; i++)
        c[i] = vec(m[0][i], m[1][i], m[2][i]);
    double det = dot(c[0], cross(c[1], c[2]));
    for (int i = 0; i < 3; i++) {
        ref_vec row = scale(cross(c[(i + 1) % 3], c[(i + 2) % 3]), 1.0 / det);
        out[i][0] = row.x;
        out[i][1] = row.y;
        out[i][2] = row.z;
        out[i][3] = -dot(row, t);
    }
    return det != 0.0;
}

/* Normals that triangles are shaded with (14): the file's, or the mean of the unit normals around a
 * vertex, by angle weighted if asked. */
static bool prepare_normals(ref_shape *s)
{
    bool all_have = true;
    for (uint32_t i = 0; i < s->triangle_count; i++)
        all_have = all_have && s->triangles[i].has_file_normals;
    bool from_file = s->normals == REF_NORMALS_FILE || (s->normals == REF_NORMALS_AUTO && all_have);
    ref_vec *sums = calloc(s->position_count + 1u, sizeof *sums);
    for (uint32_t i = 0; sums && i < s->triangle_count; i++) {
        const ref_triangle *f = &s->triangles[i];
        ref_vec n = unit(cross(sub(f->corner[1], f->corner[0]), sub(f->corner[2], f->corner[0])));
        for (int k = 0; k < 3; k++) {
            ref_vec a = unit(sub(f->corner[(k + 1) % 3], f->corner[k]));
            ref_vec b = unit(sub(f->corner[(k + 2) % 3], f->corner[k]));
            double angle =
                s->normals == REF_NORMALS_ANGLE ? acos(fmax(-1.0, fmin(1.0, dot(a, b)))) : 1.0;
            sums[f->index[k]] = add(sums[f->index[k]], scale(n, angle));
        }
    }
    for (uint32_t i = 0; sums && i < s->triangle_count; i++) {
        ref_triangle *f = &s->triangles[i];
        f->is_flat = s->normals == REF_NORMALS_FLAT || (from_file && !f->has_file_normals);
        for (int k = 0; k < 3; k++) {
            f->normal[k] = unit(from_file ? f->normal[k] : sums[f->index[k]]);
            f->is_flat = f->is_flat || length(f->normal[k]) == 0.0;
        }
    }
    free(sums);
    return sums;
}

bool reference_prepare(ref_dump *scene)
{
    enum { STEPS = 4096 };
    for (uint32_t i = 0; i < scene->shape_count; i++) {
        ref_shape *s = &scene->shapes[i];
        s->y_min = HUGE_VAL;
        s->y_max = -HUGE_VAL;
        double area = 0.0, dy = 0.0;
        for (uint32_t k = 0; k < s->segment_count * (STEPS + 1); k++) {
            const ref_segment *c = &s->segments[k / (STEPS + 1)];
            double t = (double)(k % (STEPS + 1)) / STEPS, y = curve(c->y, c->degree, t, &dy);
            s->y_min = fmin(s->y_min, y);
            s->y_max = fmax(s->y_max, y);
            area += fabs(curve(c->x, c->degree, t, NULL)) *
                    dy; /* with the axis, of the half plane's section */
        }
        s->is_clockwise = area < 0.0;
        if (!invert(s->to_world, s->to_object) || !prepare_normals(s))
            return false;
    }
    return true;
}
