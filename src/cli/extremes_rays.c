/* SPDX-License-Identifier: MIT
 *
 * Rays aimed at what triangles share: a closed ball must stop every one.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/extremes.h"

enum { PIECE = 4096, LEVEL = 4 };

static uint32_t random_bits(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 33);
}

static double random_unit(uint64_t *state)
{
    return (double)random_bits(state) * 0x1p-31;
}

/* A corner of a face, a point of an edge, or a point inside, by turns. */
static fl_vec3 target_on(const fl_mesh *mesh, uint64_t number, uint64_t *state)
{
    const uint32_t *at = mesh->faces[random_bits(state) % mesh->face_count].position;
    fl_vec3 a = mesh->positions[at[0]], b = mesh->positions[at[1]], c = mesh->positions[at[2]];
    double u = random_unit(state), v = random_unit(state);
    if (number % 3 == 0)
        return a;
    if (number % 3 == 1)
        return fl_v3_mad(a, fl_v3_sub(b, a), number % 6 == 1 ? 0.5 : u);
    return fl_v3_mad(fl_v3_mad(a, fl_v3_sub(b, a), u), fl_v3_sub(c, a), (1.0 - u) * v);
}

/* From somewhere inside towards the target; or through it from outside, at something that lies well
 * inside, so that rounding cannot make it a miss of the silhouette. */
static fl_vec3 origin_for(fl_vec3 target, double radius, double distance, uint64_t *state)
{
    fl_vec3 p = fl_v3(random_unit(state) - 0.5, random_unit(state) - 0.5, random_unit(state) - 0.5);
    fl_vec3 inside = fl_v3_scale(p, radius);
    if (distance <= 1.0)
        return inside;
    fl_vec3 out = fl_v3_normalize(fl_v3_sub(target, fl_v3_scale(inside, 0.5)));
    return fl_v3_mad(target, out, radius * distance);
}

static fl_compiled *compile(const fl_mesh *mesh, double scale)
{
    static const char text[] =
        "firstlight 1\nPerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 40 }\n"
        "Materials { Material { diffuseColor 1 1 1 } }\n"
        "Group { MaterialIndex 0 TriangleMesh { file ball.obj normals flat } }\n";
    fl_diags diags = {0};
    fl_compiled *compiled = NULL;
    fl_scene *scene = fl_scene_parse(text, sizeof text - 1, "rays", &(fl_parse_options){0},
                                     &extreme_files, &diags);
    if (scene) {
        fl_mesh_release(scene->meshes[0].mesh);
        scene->meshes[0].mesh = fl_mesh_retain((fl_mesh *)(uintptr_t)mesh);
        if (fl_scene_map(scene, scale, fl_v3(0, 0, 0), &diags))
            compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, &diags);
    }
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    return compiled;
}

bool extreme_rays(double scale, double distance, uint64_t count, extreme_result *out)
{
    fl_mesh *mesh = extreme_ball(LEVEL, 1.0);
    fl_compiled *compiled = mesh ? compile(mesh, scale) : NULL;
    float *o = malloc(3 * PIECE * sizeof *o), *d = malloc(3 * PIECE * sizeof *d);
    uint32_t *object = malloc(PIECE * sizeof *object);
    bool ok = compiled && o && d && object;
    uint64_t state = 7, lost = 0;
    for (uint64_t done = 0; ok && done < count; done += PIECE) {
        for (uint32_t i = 0; i < PIECE; i++) {
            fl_vec3 target = fl_v3_scale(target_on(mesh, done + i, &state), scale);
            fl_vec3 from = origin_for(target, scale, distance, &state);
            fl_vec3 way = fl_v3_sub(target, from);
            const double a[3] = {from.x, from.y, from.z}, b[3] = {way.x, way.y, way.z};
            for (uint32_t k = 0; k < 3; k++) {
                o[3 * i + k] = (float)a[k];
                d[3 * i + k] = (float)b[k];
            }
        }
        ok = fl_trace_nearest(compiled, o, d, PIECE, NULL, object, NULL, NULL);
        for (uint32_t i = 0; ok && i < PIECE; i++)
            lost += object[i] == FL_NONE ? 1 : 0;
    }
    uint64_t all = (count + PIECE - 1) / PIECE * PIECE;
    out->off = lost > UINT32_MAX ? UINT32_MAX : (uint32_t)lost;
    out->pixels = all > UINT32_MAX ? UINT32_MAX : (uint32_t)all;
    out->error = (double)lost / (double)all;
    out->passed = ok && lost == 0;
    free(o);
    free(d);
    free(object);
    fl_compiled_release(compiled);
    fl_mesh_release(mesh);
    return ok;
}
