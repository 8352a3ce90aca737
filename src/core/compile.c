/* SPDX-License-Identifier: MIT */
#include "core/compile.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/compile_build.h"

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool choose_isa(fl_compiler *c)
{
    c->out->isa = c->options->has_isa ? c->options->isa : fl_cpu_best_isa();
    if (fl_cpu_has(c->out->isa))
        return true;
    return fl_environment_error(c->diags, "this machine does not have the instruction set '%s'",
                                fl_isa_name(c->out->isa));
}

static bool allocate_objects(fl_compiler *c)
{
    fl_geometry *g = c->geometry;
    fl_arena *arena = &c->out->arena;
    size_t count = g->object_count = c->scene->object_count;
    g->object_entry = fl_arena_alloc(arena, count, sizeof *g->object_entry);
    g->object_instance = fl_arena_alloc(arena, count, sizeof *g->object_instance);
    g->object_kind = fl_arena_alloc(arena, count, sizeof *g->object_kind);
    g->instances = fl_arena_alloc(arena, count, sizeof *g->instances);
    if (!g->object_entry || !g->object_instance || !g->object_kind || !g->instances)
        return fl_out_of_memory(c->diags, "the scene's objects");
    memset(g->object_entry, 0xff, count * sizeof *g->object_entry);
    memset(g->object_instance, 0xff, count * sizeof *g->object_instance);
    for (size_t i = 0; i < count; i++)
        g->object_kind[i] = c->scene->objects[i].kind;
    return true;
}

fl_compiled *fl_compile(const fl_scene *scene, const fl_compile_options *options, fl_pool *pool,
                        fl_diags *diags)
{
    fl_compiled *out = calloc(1, sizeof *out);
    if (!out) {
        fl_out_of_memory(diags, "the compiled scene");
        return NULL;
    }
    fl_ref_init(&out->ref);
    out->geometry.accel = options->accel;
    fl_compiler c = {.scene = scene,
                     .options = options,
                     .pool = pool,
                     .diags = diags,
                     .out = out,
                     .geometry = &out->geometry};
    double start = seconds_now();
    if (!choose_isa(&c) || !allocate_objects(&c) || !fl_compile_origin(&c) ||
        !fl_compile_meshes(&c) || !fl_compile_shapes(&c) || !fl_compile_entries(&c) ||
        !fl_compile_shading(&c)) {
        fl_compiled_release(out);
        return NULL;
    }
    out->build_seconds = seconds_now() - start;
    out->geometry_bytes = out->arena.used_bytes - out->accel_bytes;
    return out;
}

fl_compiled *fl_compiled_retain(fl_compiled *compiled)
{
    fl_ref_retain(&compiled->ref);
    return compiled;
}

void fl_compiled_release(fl_compiled *compiled)
{
    if (!compiled || !fl_ref_release(&compiled->ref))
        return;
    for (uint32_t k = 0; k < compiled->texture_count; k++)
        fl_image_release(compiled->textures[k].image);
    for (int k = 0; k < FL_CUBE_FACES; k++)
        fl_image_release(compiled->cube[k]);
    fl_arena_deinit(&compiled->arena);
    free(compiled);
}
