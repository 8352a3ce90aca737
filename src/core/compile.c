/* SPDX-License-Identifier: MIT */
#include "core/compile.h"

#include <stddef.h>
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

/* --- Large meshes ----------------------------------------------------------------------------- */

static bool has_large_meshes(const fl_compiled *scene)
{
    for (uint32_t k = 0; k < scene->geometry.mesh_count; k++)
        if (scene->geometry.meshes[k].face_count > 0 && !scene->geometry.meshes[k].packs)
            return true;
    return false;
}

/* `base` with hierarchies for the meshes that have none; their table is the only one copied. */
static fl_compiled *complete(fl_compiled *base, bool is_quick, fl_pool *pool, fl_diags *diags)
{
    static const fl_compile_options options = {.accel = FL_ACCEL_BVH};
    double start = seconds_now();
    fl_compiled *out = malloc(sizeof *out);
    if (!out) {
        fl_out_of_memory(diags, "the compiled scene");
        return NULL;
    }
    /* All but the count of references, which others may be changing. */
    const size_t rest = offsetof(fl_compiled, arena);
    memcpy((char *)out + rest, (const char *)base + rest, sizeof *out - rest);
    fl_ref_init(&out->ref);
    out->arena = (fl_arena){0};
    out->base = fl_compiled_retain(base);
    out->is_quick = is_quick;
    fl_geometry *g = &out->geometry;
    size_t bytes = g->mesh_count * sizeof *g->meshes;
    g->meshes = fl_arena_alloc(&out->arena, g->mesh_count, sizeof *g->meshes);
    bool ok = g->meshes || fl_out_of_memory(diags, "the scene's meshes");
    if (ok)
        memcpy(g->meshes, base->geometry.meshes, bytes);
    fl_compiler c = {.options = &options,
                     .pool = pool,
                     .diags = diags,
                     .out = out,
                     .geometry = g,
                     .is_quick = is_quick};
    for (uint32_t k = 0; ok && k < g->mesh_count; k++)
        if (g->meshes[k].face_count > 0 && !g->meshes[k].packs)
            ok = fl_compile_accel(&c, &g->meshes[k]);
    out->build_seconds += seconds_now() - start;
    if (ok && !fl_pool_is_cancelled(pool))
        return out;
    fl_compiled_release(out);
    return NULL;
}

fl_compiled *fl_compile_refine(const fl_compiled *quick, fl_pool *pool, fl_diags *diags)
{
    FL_ASSERT(quick->is_quick);
    return complete(quick->base, false, pool, diags);
}

/* --- All of it -------------------------------------------------------------------------------- */

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
    if (!has_large_meshes(out))
        return out;
    fl_compiled *quick = complete(out, true, pool, diags);
    fl_compiled_release(out);
    return quick;
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
    bool owns_pictures = !compiled->base;
    for (uint32_t k = 0; owns_pictures && k < compiled->texture_count; k++)
        fl_image_release(compiled->textures[k].image);
    for (int k = 0; owns_pictures && k < FL_CUBE_FACES; k++)
        fl_image_release(compiled->cube[k]);
    fl_compiled_release(compiled->base);
    fl_arena_deinit(&compiled->arena);
    free(compiled);
}
