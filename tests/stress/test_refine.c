/* SPDX-License-Identifier: MIT
 *
 * Rendering with a quick hierarchy and going on with the good one amid the picture: the film is
 * that of the good one from the start, to the bit, whenever the change comes.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <pthread.h>

#include "core/firstlight.h"

enum { SIDE = 48, SAMPLES = 6, RINGS = 40, FLOATS = 3 * SIDE * SIDE };

/* A bumpy ball of 2 * RINGS * RINGS triangles in a mirror that turns it, glass before it, and loose
 * triangles, of which there are enough to be large too. */
static const char scene_head[] =
    "firstlight 1\n"
    "PerspectiveCamera { center 0 0.5 4 direction 0 -0.1 -1 up 0 1 0 angle 40 aperture 0.1\n"
    "    focus 3 }\n"
    "Background { color 0.3 0.4 0.5 ambientLight 0.1 0.1 0.1 }\n"
    "Lights { numLights 1 DiskLight { position -2 3 3 direction 0.5 -0.7 -0.7 radius 0.6\n"
    "    color 1 1 1 } }\n"
    "Materials { numMaterials 2 Material { diffuseColor 0.7 0.5 0.3 reflect 0.3 }\n"
    "    Material { diffuseColor 0 0 0 refract 0.9 refractionIndex 1.4 } }\n"
    "Group { numObjects 6 MaterialIndex 0 TriangleMesh { obj_file ball normals smooth }\n"
    "    Transform { Translate 1.2 0.4 -1 UniformScale 0.5 TriangleMesh { obj_file ball } }\n"
    "    MaterialIndex 1 Sphere { center -0.4 0.1 1.3 radius 0.4 } MaterialIndex 0\n"
    "    Triangle { vertex0 -2 -0.9 1 vertex1 2 -0.9 1 vertex2 0 -0.8 -3 }\n"
    "    Triangle { vertex0 -2 -0.9 1 vertex1 -2 1.9 1 vertex2 -2 -0.8 -3 }\n"
    "    Triangle { vertex0 2 -0.9 1 vertex1 2 1.9 1 vertex2 2 -0.8 -3 } }\n";

static bool find_ball(void *context, const char *scene_path, const char *reference, char *out_path,
                      size_t out_bytes)
{
    (void)context, (void)scene_path;
    snprintf(out_path, out_bytes, "%s", reference);
    return true;
}

static fl_vec3 ball_point(uint32_t i, uint32_t j)
{
    double u = 6.283185307179586 * i / RINGS, v = 3.141592653589793 * j / RINGS;
    double r = 0.8 + 0.05 * sin(7.0 * u) * sin(5.0 * v);
    return fl_v3(r * sin(v) * cos(u), r * cos(v), r * sin(v) * sin(u));
}

static fl_mesh *make_ball(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)context, (void)path, (void)loc, (void)diags;
    fl_mesh *ball = fl_mesh_create();
    assert_non_null(ball);
    ball->position_count = RINGS * (RINGS + 1);
    ball->face_count = 2 * RINGS * RINGS;
    ball->positions = calloc(ball->position_count, sizeof *ball->positions);
    ball->faces = calloc(ball->face_count, sizeof *ball->faces);
    assert_true(ball->positions && ball->faces);
    fl_face *face = ball->faces;
    for (uint32_t i = 0; i < RINGS; i++)
        for (uint32_t j = 0; j <= RINGS; j++) {
            ball->positions[i * (RINGS + 1) + j] = ball_point(i, j);
            if (j == RINGS)
                continue;
            uint32_t a = i * (RINGS + 1) + j, b = (i + 1) % RINGS * (RINGS + 1) + j;
            const uint32_t corners[2][3] = {{a, b, b + 1}, {a, b + 1, a + 1}};
            for (int k = 0; k < 2; k++, face++) {
                memset(face, 0xff, sizeof *face);
                memcpy(face->position, corners[k], sizeof corners[k]);
            }
        }
    return ball;
}

static const fl_files files = {.find = find_ball, .load_mesh = make_ball};

typedef struct world {
    fl_scene *scene;
    fl_params params;
    fl_compiled *good, *quick;
    float *want; /* The film by the good one alone. */
} world;

static fl_render *start(fl_compiled *compiled, const fl_params *params, uint32_t threads,
                        uint32_t samples)
{
    fl_diags diags = {0};
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = threads}, &diags);
    assert_non_null(render);
    fl_render_set_limits(render, &(fl_render_limits){.samples = samples});
    assert_true(fl_render_restart(render, compiled, params, &diags));
    return render;
}

static float *film(fl_render *render)
{
    fl_progress progress;
    float *rgb = malloc(FLOATS * sizeof *rgb);
    assert_non_null(rgb);
    assert_true(fl_render_mean(render, rgb, FLOATS, &progress));
    assert_int_equal(progress.complete_samples, SAMPLES);
    return rgb;
}

static int make_world(void **state)
{
    fl_diags diags = {0};
    world *w = calloc(1, sizeof *w);
    assert_non_null(w);
    w->scene = fl_scene_parse(scene_head, sizeof scene_head - 1, "ball", &(fl_parse_options){0},
                              &files, &diags);
    assert_non_null(w->scene);
    fl_params_from_scene(&w->params, w->scene, false);
    w->params.width = w->params.height = SIDE;
    w->good = fl_compile(w->scene, &(fl_compile_options){0}, NULL, &diags);
    w->quick = fl_compile(w->scene, &(fl_compile_options){.quick_above = 2}, NULL, &diags);
    assert_true(w->good && w->quick);
    fl_render *render = start(w->good, &w->params, 2, SAMPLES);
    assert_true(fl_render_wait(render, -1.0));
    w->want = film(render);
    fl_render_destroy(render);
    *state = w;
    return 0;
}

static int free_world(void **state)
{
    world *w = *state;
    fl_compiled_release(w->good);
    fl_compiled_release(w->quick);
    fl_scene_destroy(w->scene);
    free(w->want);
    free(w);
    return 0;
}

static void assert_wanted(const world *w, fl_render *render)
{
    float *got = film(render);
    assert_memory_equal(got, w->want, FLOATS * sizeof *got);
    free(got);
}

static fl_compiled *refine(const world *w)
{
    fl_diags diags = {0};
    fl_compiled *refined = fl_compile_refine(w->quick, NULL, &diags);
    assert_non_null(refined);
    return refined;
}

static void large_meshes_are_compiled_quickly(void **state)
{
    const world *w = *state;
    assert_false(w->good->is_quick);
    assert_null(w->good->base);
    assert_true(w->quick->is_quick);
    fl_compiled *refined = refine(w);
    assert_false(refined->is_quick);
    assert_ptr_equal(refined->base, w->quick->base);
    const fl_geometry *g[3] = {&w->good->geometry, &w->quick->geometry, &refined->geometry};
    for (uint32_t k = 0; k < g[0]->mesh_count; k++) { /* The refined is the good one. */
        assert_int_equal(g[2]->meshes[k].bvh->node_count, g[0]->meshes[k].bvh->node_count);
        assert_memory_equal(g[2]->meshes[k].bvh->nodes, g[0]->meshes[k].bvh->nodes,
                            g[0]->meshes[k].bvh->node_count * sizeof(fl_bvh_node));
        assert_ptr_equal(g[2]->meshes[k].position, g[1]->meshes[k].position);
    }
    assert_int_equal(refined->accel_bytes, w->good->accel_bytes);
    assert_int_equal(g[1]->meshes[0].pack_count, (g[1]->meshes[0].face_count + 7) / 8);
    fl_compiled_release(refined);

    fl_diags diags = {0};
    const fl_compile_options small = {.quick_above = 2 * RINGS * RINGS};
    fl_compiled *compiled = fl_compile(w->scene, &small, NULL, &diags);
    assert_non_null(compiled);
    assert_false(compiled->is_quick);
    fl_compiled_release(compiled);
}

/* The quick one alone, from the first ray to the last. */
static void quick_hits_are_the_same(void **state)
{
    const world *w = *state;
    fl_render *render = start(w->quick, &w->params, 2, SAMPLES);
    assert_true(fl_render_wait(render, -1.0));
    assert_wanted(w, render);
    fl_render_destroy(render);
}

/* At rest between samples, whose number is known. */
static void the_film_is_the_same_after_each_sample(void **state)
{
    const world *w = *state;
    fl_diags diags = {0};
    for (uint32_t at = 1; at <= SAMPLES; at++) {
        fl_render *render = start(w->quick, &w->params, 2, at);
        assert_true(fl_render_wait(render, -1.0));
        fl_compiled *refined = refine(w);
        assert_true(fl_render_replace_scene(render, refined, &diags));
        fl_compiled_release(refined);
        fl_progress progress;
        fl_render_progress(render, &progress);
        assert_int_equal(progress.generation, 1);
        assert_int_equal(progress.complete_samples, at);
        fl_render_set_limits(render, &(fl_render_limits){.samples = SAMPLES});
        assert_true(fl_render_wait(render, -1.0));
        assert_wanted(w, render);
        fl_render_destroy(render);
    }
}

/* Whether node visits show that the good one took over. */
static void what_follows_is_traced_by_the_good_one(void **state)
{
    const world *w = *state;
    fl_diags diags = {0};
    fl_progress quick, good, both;
    fl_compiled *const scenes[] = {w->quick, w->good};
    fl_progress *const out[] = {&quick, &good};
    for (int k = 0; k < 2; k++) {
        fl_render *render = start(scenes[k], &w->params, 1, SAMPLES);
        assert_true(fl_render_wait(render, -1.0));
        fl_render_progress(render, out[k]);
        fl_render_destroy(render);
    }
    fl_render *render = start(w->quick, &w->params, 1, 1);
    assert_true(fl_render_wait(render, -1.0));
    fl_compiled *refined = refine(w);
    assert_true(fl_render_replace_scene(render, refined, &diags));
    fl_compiled_release(refined);
    fl_render_set_limits(render, &(fl_render_limits){.samples = SAMPLES});
    assert_true(fl_render_wait(render, -1.0));
    fl_render_progress(render, &both);
    fl_render_destroy(render);
    assert_true(both.counts.isect.primitive_tests < quick.counts.isect.primitive_tests);
    assert_true(both.counts.isect.primitive_tests > good.counts.isect.primitive_tests);
}

typedef struct arrival {
    fl_render *render;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool has_ended, is_refined;
} arrival;

static void go_on_with(void *context, fl_compiled *refined)
{
    arrival *a = context;
    fl_diags diags = {0};
    bool is_replaced = refined && fl_render_replace_scene(a->render, refined, &diags);
    pthread_mutex_lock(&a->lock);
    a->is_refined = is_replaced;
    a->has_ended = true;
    pthread_cond_broadcast(&a->changed);
    pthread_mutex_unlock(&a->lock);
}

static void await(arrival *a)
{
    pthread_mutex_lock(&a->lock);
    while (!a->has_ended)
        pthread_cond_wait(&a->changed, &a->lock);
    pthread_mutex_unlock(&a->lock);
}

/* By a thread of its own, at moments as they come, with restarts in between. */
static void the_film_is_the_same_whenever_it_comes(void **state)
{
    const world *w = *state;
    fl_diags diags = {0};
    for (uint32_t round = 0; round < 12; round++) {
        arrival a = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
        a.render = start(w->quick, &w->params, 1 + round % 3, SAMPLES);
        if (round % 4 == 1)
            fl_render_set_paused(a.render, true);
        fl_refine *r = fl_refine_start(w->quick, 2, go_on_with, &a, &diags);
        assert_non_null(r);
        if (round % 4 == 2) /* The second may be pending as the good one comes. */
            for (int k = 0; k < 3; k++)
                assert_true(fl_render_restart(a.render, w->quick, &w->params, &diags));
        if (round % 4 != 3)
            await(&a);
        fl_render_set_paused(a.render, false);
        assert_true(fl_render_wait(a.render, -1.0));
        assert_wanted(w, a.render);
        await(&a);
        assert_true(a.is_refined);
        assert_false(fl_refine_is_busy(r));
        fl_compiled *refined = fl_refine_take(r);
        assert_non_null(refined);
        assert_null(fl_refine_take(r));
        assert_true(fl_render_restart(a.render, refined, &w->params, &diags));
        fl_compiled_release(refined);
        assert_true(fl_render_wait(a.render, -1.0));
        assert_wanted(w, a.render);
        fl_refine_destroy(r);
        fl_render_destroy(a.render);
        pthread_cond_destroy(&a.changed);
        pthread_mutex_destroy(&a.lock);
    }
}

static void pictures_of_other_scenes_are_left_alone(void **state)
{
    const world *w = *state;
    fl_diags diags = {0};
    fl_render *render = start(w->good, &w->params, 2, SAMPLES);
    fl_compiled *refined = refine(w);
    unsigned before = atomic_load(&refined->ref.count);
    assert_true(fl_render_replace_scene(render, refined, &diags));
    assert_int_equal(atomic_load(&refined->ref.count), before);
    fl_compiled_release(refined);
    assert_true(fl_render_wait(render, -1.0));
    assert_wanted(w, render);
    fl_render_destroy(render);
}

static void refining_can_be_broken_off(void **state)
{
    const world *w = *state;
    fl_diags diags = {0};
    for (int round = 0; round < 20; round++) {
        arrival a = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
        a.render = start(w->quick, &w->params, 1, SAMPLES);
        fl_refine *r = fl_refine_start(w->quick, 4, go_on_with, &a, &diags);
        assert_non_null(r);
        fl_refine_destroy(r);
        assert_true(a.has_ended);
        fl_render_destroy(a.render);
    }
    fl_pool *pool = fl_pool_create(2, &diags);
    assert_non_null(pool);
    fl_pool_cancel(pool);
    assert_null(fl_compile_refine(w->quick, pool, &diags));
    fl_pool_destroy(pool);
    fl_diags_deinit(&diags);
    fl_refine_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(large_meshes_are_compiled_quickly),
        cmocka_unit_test(quick_hits_are_the_same),
        cmocka_unit_test(the_film_is_the_same_after_each_sample),
        cmocka_unit_test(what_follows_is_traced_by_the_good_one),
        cmocka_unit_test(the_film_is_the_same_whenever_it_comes),
        cmocka_unit_test(pictures_of_other_scenes_are_left_alone),
        cmocka_unit_test(refining_can_be_broken_off),
    };
    return cmocka_run_group_tests(tests, make_world, free_world);
}
