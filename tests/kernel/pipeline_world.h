/* SPDX-License-Identifier: MIT
 *
 * Scenes made by hand and rendered by the tile pipeline alone, for tests of it.
 */
#ifndef PIPELINE_WORLD_H
#define PIPELINE_WORLD_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/pipeline.h"

enum { WORLD_MAX = 16, WORLD_SIDE = 64 };

/** Everything a scene needs, in fixed arrays. */
typedef struct world {
    fl_scene scene;
    fl_light lights[WORLD_MAX];
    fl_material materials[WORLD_MAX];
    fl_object objects[WORLD_MAX];
    fl_scene_image images[WORLD_MAX];
    fl_params params;
} world;

/* cmocka's own takes floats. */
static inline void assert_near(double got, double want, double bound)
{
    if (!(fabs(got - want) <= bound))
        fail_msg("got %.9g, want %.9g within %g", got, want, bound);
}

static inline fl_vec3 gray(double x)
{
    return fl_v3(x, x, x);
}

/** A camera at (0, 0, 10) looking along -z, 45 degrees, 16x16; black background. */
static inline void world_init(world *w)
{
    memset(w, 0, sizeof *w);
    fl_scene *s = &w->scene;
    s->path = "test";
    s->dialect = FL_DIALECT_FIRSTLIGHT;
    s->lights = w->lights;
    s->materials = w->materials;
    s->objects = w->objects;
    s->images = w->images;
    for (int i = 0; i < FL_CUBE_FACES; i++)
        s->background.cube_image[i] = FL_NONE;
    fl_params_from_scene(&w->params, s, false);
    w->params.camera.fov_deg = 45;
    w->params.width = w->params.height = 16;
}

static inline fl_material *add_material(world *w)
{
    fl_material *m = &w->materials[w->scene.material_count++];
    *m = (fl_material){
        .diffuse = gray(1), .refraction_index = 1, .image = FL_NONE, .texture_scale = {1, 1}};
    return m;
}

static inline fl_object *add_object(world *w, fl_object_kind kind)
{
    fl_object *o = &w->objects[w->scene.object_count++];
    *o = (fl_object){.kind = kind, .material = w->scene.material_count - 1, .transform = FL_NONE};
    return o;
}

/** Objects take the newest material. */
static inline void add_sphere(world *w, fl_vec3 center, double radius)
{
    fl_object *o = add_object(w, FL_OBJECT_SPHERE);
    o->as.sphere.center = center;
    o->as.sphere.radius = radius;
}

static inline void add_plane(world *w, fl_vec3 normal, double offset)
{
    fl_object *o = add_object(w, FL_OBJECT_PLANE);
    o->as.plane.normal = normal;
    o->as.plane.offset = offset;
}

static inline void add_square(world *w, fl_vec3 corner, fl_vec3 u, fl_vec3 v)
{
    fl_object *o = add_object(w, FL_OBJECT_SQUARE);
    o->as.square.corner = corner;
    o->as.square.u = u;
    o->as.square.v = v;
}

static inline fl_light *add_light(world *w, fl_light_kind kind, fl_vec3 at, fl_vec3 color)
{
    fl_light *l = &w->lights[w->scene.light_count++];
    *l = (fl_light){.kind = kind,
                    .position = at,
                    .direction = fl_v3(0, -1, 0),
                    .color = color,
                    .attenuation = {1, 0, 0},
                    .is_two_sided = true};
    if (kind == FL_LIGHT_DIRECTIONAL)
        l->direction = fl_v3_normalize(at);
    return l;
}

/** Scene and parameters made ready. */
static inline fl_frame *world_frame(world *w, fl_isa isa)
{
    fl_diags diags = {0};
    fl_compile_options options = {.accel = FL_ACCEL_BVH, .has_isa = true, .isa = isa};
    fl_compiled *compiled = fl_compile(&w->scene, &options, NULL, &diags);
    fl_params params = w->params;
    params.lights = w->scene.lights;
    params.light_count = w->scene.light_count;
    fl_frame *frame = compiled ? fl_frame_create(compiled, &params, &diags) : NULL;
    for (uint32_t i = 0; i < diags.count; i++)
        print_message("%s\n", diags.items[i].message);
    fl_diags_deinit(&diags);
    fl_compiled_release(compiled);
    assert_non_null(frame);
    return frame;
}

/** Samples of a picture, every one by itself. */
typedef struct picture {
    float rgb[WORLD_SIDE * WORLD_SIDE][3];
    uint8_t is_valid[WORLD_SIDE * WORLD_SIDE];
    uint32_t count;
    fl_counts counts;
} picture;

/** Sample number `sample` of every pixel, in units of `unit_size` pixels, the last pixel first if
 * asked. */
static inline void picture_render(picture *out, const fl_frame *frame, uint32_t sample,
                                  uint32_t unit_size, bool is_reversed)
{
    static uint16_t x[FL_UNIT_PIXELS], y[FL_UNIT_PIXELS];
    fl_workspace *workspace = fl_workspace_create();
    assert_non_null(workspace);
    memset(out, 0, sizeof *out);
    out->count = frame->width * frame->height;
    assert_true(out->count <= WORLD_SIDE * WORLD_SIDE);
    for (uint32_t begin = 0; begin < out->count; begin += unit_size) {
        fl_unit unit = {x, y, fl_min_u32(unit_size, out->count - begin), sample};
        bool out_of_memory;
        for (uint32_t i = 0; i < unit.count; i++) {
            uint32_t at = is_reversed ? out->count - 1 - (begin + i) : begin + i;
            x[i] = (uint16_t)(frame->x0 + at % frame->width);
            y[i] = (uint16_t)(frame->y0 + at / frame->width);
        }
        assert_true(
            fl_pipeline_run(frame, &unit, workspace, NULL, 0, &out->counts, &out_of_memory));
        const fl_unit_result *result = fl_workspace_result(workspace);
        for (uint32_t i = 0; i < unit.count; i++) {
            uint32_t at = is_reversed ? out->count - 1 - (begin + i) : begin + i;
            out->rgb[at][0] = result->r[i];
            out->rgb[at][1] = result->g[i];
            out->rgb[at][2] = result->b[i];
            out->is_valid[at] = result->is_valid[i];
        }
    }
    fl_workspace_destroy(workspace);
}

static inline void world_render(world *w, fl_isa isa, uint32_t sample, picture *out)
{
    fl_frame *frame = world_frame(w, isa);
    picture_render(out, frame, sample, FL_UNIT_PIXELS, false);
    fl_frame_release(frame);
}

static inline void assert_same_picture(const picture *a, const picture *b)
{
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->rgb, b->rgb, sizeof a->rgb);
    assert_memory_equal(a->is_valid, b->is_valid, sizeof a->is_valid);
}

#endif
