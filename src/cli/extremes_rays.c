/* SPDX-License-Identifier: MIT
 *
 * Rays aimed at what triangles share: a closed ball must stop every one, on its near side.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/extremes.h"

enum { PIECE = 4096, LEVEL = 4, TRIANGLE_BYTES = 320 };

static const char head[] = "firstlight 1\nMaterials { Material { diffuseColor 1 1 1 } }\n"
                           "Group { MaterialIndex 0 ";

typedef struct range {
    const extreme_aim *aim;
    fl_mesh *ball;
    fl_affine to_world; /* From the ball's own space. */
    fl_compiled *compiled;
    void *memory;
    fl_rays rays;
    fl_hits hits;
    uint64_t random;
} range;

static uint32_t random_bits(range *r)
{
    r->random = r->random * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(r->random >> 33);
}

static double random_unit(range *r)
{
    return (double)random_bits(r) * 0x1p-31;
}

/* --- The ball ----------------------------------------------------------------------------------
 */

/* The faces as so many `Triangle`s; from malloc. */
static char *loose_text(const fl_mesh *ball)
{
    size_t room = sizeof head + (size_t)ball->face_count * TRIANGLE_BYTES + 8, length = 0;
    char *text = malloc(room);
    if (!text)
        return NULL;
    length += (size_t)snprintf(text, room, "%s", head);
    for (uint32_t f = 0; f < ball->face_count; f++) {
        length += (size_t)snprintf(text + length, room - length, "Triangle {");
        for (int k = 0; k < 3; k++) {
            fl_vec3 p = ball->positions[ball->faces[f].position[k]];
            length += (size_t)snprintf(text + length, room - length, " vertex%d %.17g %.17g %.17g",
                                       k, p.x, p.y, p.z);
        }
        length += (size_t)snprintf(text + length, room - length, " }\n");
    }
    snprintf(text + length, room - length, "}\n");
    return text;
}

static char *mesh_text(const char *objects)
{
    size_t room = sizeof head + strlen(objects) + 8;
    char *text = malloc(room);
    if (text)
        snprintf(text, room, "%s%s }\n", head, objects);
    return text;
}

/* The objects at their scale and place, with the ball that the rays are aimed at for ball.obj. */
static bool compile(range *r)
{
    const extreme_aim *aim = r->aim;
    double far = aim->moved * aim->scale;
    fl_vec3 offset = fl_v3(far, -0.5 * far, 0.25 * far);
    char *text = aim->objects ? mesh_text(aim->objects) : loose_text(r->ball);
    fl_diags diags = {0};
    fl_scene *scene = text ? fl_scene_parse(text, strlen(text), "rays", &(fl_parse_options){0},
                                            &extreme_files, &diags)
                           : NULL;
    if (scene) {
        if (scene->mesh_count > 0) {
            fl_mesh_release(scene->meshes[0].mesh);
            scene->meshes[0].mesh = fl_mesh_retain(r->ball);
        }
        uint32_t transform = scene->objects[0].transform;
        r->to_world = transform == FL_NONE ? fl_affine_identity() : scene->transforms[transform];
        if (fl_scene_map(scene, aim->scale, offset, &diags))
            r->compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, &diags);
    }
    for (int i = 0; r->compiled && i < 3; i++) {
        const fl_vec3 origin = r->compiled->geometry.origin;
        const double move[3] = {offset.x - origin.x, offset.y - origin.y, offset.z - origin.z};
        for (int j = 0; j < 4; j++)
            r->to_world.m[i][j] = r->to_world.m[i][j] * aim->scale + (j == 3 ? move[i] : 0.0);
    }
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    free(text);
    return r->compiled != NULL;
}

static bool open_range(range *r)
{
    enum { ARRAYS = 12 };
    r->ball = extreme_ball(LEVEL, 1.0);
    float *next = r->memory = aligned_alloc(64, ARRAYS * PIECE * sizeof *next);
    if (!r->ball || !next || !compile(r))
        return false;
    float **floats[] = {&r->rays.ox, &r->rays.oy, &r->rays.oz,    &r->rays.dx,
                        &r->rays.dy, &r->rays.dz, &r->rays.t_max, &r->hits.t};
    for (size_t i = 0; i < FL_COUNT_OF(floats); i++, next += PIECE)
        *floats[i] = next;
    uint32_t **words[] = {&r->rays.source_object, &r->rays.source_prim, &r->hits.object,
                          &r->hits.prim};
    for (size_t i = 0; i < FL_COUNT_OF(words); i++, next += PIECE)
        *words[i] = (uint32_t *)(void *)next;
    r->rays.count = r->rays.capacity = PIECE;
    return true;
}

static void close_range(range *r)
{
    free(r->memory);
    fl_compiled_release(r->compiled);
    fl_mesh_release(r->ball);
}

/* --- The rays ----------------------------------------------------------------------------------
 */

/* A corner of a face, a point of an edge, or a point inside, by turns. */
static fl_vec3 target_on(range *r, uint64_t number)
{
    const fl_mesh *mesh = r->ball;
    const uint32_t *at = mesh->faces[random_bits(r) % mesh->face_count].position;
    fl_vec3 a = mesh->positions[at[0]], b = mesh->positions[at[1]], c = mesh->positions[at[2]];
    double u = random_unit(r), v = random_unit(r);
    if (number % 3 == 0)
        return a;
    if (number % 3 == 1)
        return fl_v3_mad(a, fl_v3_sub(b, a), number % 6 == 1 ? 0.5 : u);
    return fl_v3_mad(fl_v3_mad(a, fl_v3_sub(b, a), u), fl_v3_sub(c, a), (1.0 - u) * v);
}

/* From somewhere inside through the target; or from outside through it towards something that lies
 * well inside, where the ray ends: what passes the near wall must not be stopped by the far one. */
static void aim_ray(range *r, uint32_t i, uint64_t number)
{
    fl_vec3 target = target_on(r, number);
    double x = random_unit(r) - 0.5, y = random_unit(r) - 0.5, z = random_unit(r) - 0.5;
    fl_vec3 inside = fl_v3(x, y, z), from = inside;
    double end = HUGE_VAL, distance = r->aim->distance;
    if (distance > 0.0) {
        inside = fl_v3_scale(inside, 0.5);
        double depth = fl_v3_length(fl_v3_sub(target, inside));
        from = fl_v3_mad(target, fl_v3_sub(target, inside), distance / depth);
        end = 1.0 + depth / distance;
    }
    fl_vec3 o = fl_affine_point(&r->to_world, from);
    fl_vec3 d = fl_v3_sub(fl_affine_point(&r->to_world, target), o);
    fl_rays_set(&r->rays, i, o, d, (float)end);
}

bool extreme_rays(const extreme_aim *aim, extreme_result *out)
{
    range r = {.aim = aim, .random = 7};
    bool ok = open_range(&r);
    uint64_t lost = 0, all = 0;
    for (; ok && all < aim->count; all += PIECE) {
        for (uint32_t i = 0; i < PIECE; i++)
            aim_ray(&r, i, all + i);
        fl_trace_stream_nearest(r.compiled, &r.rays, &r.hits, NULL);
        for (uint32_t i = 0; i < PIECE; i++)
            lost += r.hits.object[i] == FL_NONE ? 1 : 0;
    }
    close_range(&r);
    out->off = lost > UINT32_MAX ? UINT32_MAX : (uint32_t)lost;
    out->pixels = all > UINT32_MAX ? UINT32_MAX : (uint32_t)all;
    out->error = all > 0 ? (double)lost / (double)all : 0.0;
    out->passed = ok && lost == 0;
    return ok;
}
