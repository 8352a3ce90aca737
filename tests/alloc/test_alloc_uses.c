/* SPDX-License-Identifier: MIT
 *
 * The same for what is done with a scene besides rendering it plainly: other precisions and ways to
 * sample, quick hierarchies refined meanwhile, checkpoints, maps, where noise comes from, the tree
 * of rays, a scene at another place. The scene is read and compiled before memory runs out, except
 * where that is the thing tried.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <semaphore.h>
#include <stdlib.h>
#include <string.h>

#include "alloc/failing.h"
#include "bytes/scenes.h"
#include "bytes/world.h"

enum { SIDE = 8, PIXELS = SIDE * SIDE, FLOATS = PIXELS * 3 };

typedef struct bench {
    fl_scene *scene;
    fl_compiled *compiled;
    fl_params params;
    uint32_t threads, samples;
    float values[FLOATS], expected[FLOATS]; /* What a use shows for itself. */
    bool has_expected;
} bench;

static const test_scene *scene_named(const char *name)
{
    for (uint32_t i = 0; i < test_scene_count; i++)
        if (strcmp(test_scenes[i].name, name) == 0)
            return &test_scenes[i];
    fail_msg("there is no scene '%s'", name);
    return NULL;
}

static fl_scene *parse(const char *name, fl_diags *diags)
{
    const test_scene *test = scene_named(name);
    return fl_scene_parse(test->text, strlen(test->text), test->name, &(fl_parse_options){0},
                          &test_world, diags);
}

static void set_up(bench *b, const char *name)
{
    fl_diags diags = {0};
    *b = (bench){.threads = 1, .samples = 2};
    b->scene = parse(name, &diags);
    assert_non_null(b->scene);
    b->compiled = fl_compile(b->scene, &(fl_compile_options){0}, NULL, &diags);
    assert_non_null(b->compiled);
    fl_params_from_scene(&b->params, b->scene, false);
    b->params.width = b->params.height = SIDE;
}

static void tear_down(bench *b)
{
    fl_compiled_release(b->compiled);
    fl_scene_destroy(b->scene);
}

typedef bool use(bench *b, fl_diags *diags);

typedef struct trial {
    bench *bench;
    use *use;
} trial;

/* One go; what comes out is always the same. */
static bool run(void *context)
{
    trial *t = context;
    bench *b = t->bench;
    fl_diags diags = {0};
    bool ok = t->use(b, &diags);
    failing_end();
    assert_true(ok == (diags.error_count == 0));
    assert_true(ok || failing_names_machine(&diags));
    fl_diags_deinit(&diags);
    if (ok && b->has_expected)
        assert_memory_equal(b->values, b->expected, sizeof b->values);
    return ok;
}

static void try_all(bench *b, const char *name, use *what)
{
    trial t = {b, what};
    assert_true(run(&t));
    memcpy(b->expected, b->values, sizeof b->values);
    b->has_expected = true;
    print_message("%s: ", name);
    assert_true(failing_every_call(run, &t) > 0);
}

/* --- Renders ---------------------------------------------------------------------------------- */

static fl_render *create(const bench *b, uint32_t samples, fl_diags *diags)
{
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = b->threads}, diags);
    if (render)
        fl_render_set_limits(render, &(fl_render_limits){.samples = samples});
    return render;
}

/* Wait, and take the film. */
static bool finish(bench *b, fl_render *render, fl_diags *diags)
{
    fl_progress progress;
    fl_render_wait(render, -1.0);
    fl_render_progress(render, &progress);
    if (progress.state == FL_RENDER_FAILED)
        return fl_out_of_memory(diags, "rendering");
    assert_true(progress.state == FL_RENDER_DONE);
    assert_true(fl_render_mean(render, b->values, FLOATS, &progress));
    return true;
}

static bool render_plainly(bench *b, fl_diags *diags)
{
    fl_render *render = create(b, b->samples, diags);
    bool ok = render && fl_render_restart(render, b->compiled, &b->params, diags) &&
              finish(b, render, diags);
    fl_render_destroy(render);
    return ok;
}

static void ways_to_sample(void **state)
{
    (void)state;
    bench b;
    set_up(&b, "glass");
    b.params.precision = FL_PRECISION_DOUBLE;
    try_all(&b, "double", render_plainly);
    b.has_expected = false;
    b.threads = 2;
    b.params.precision = FL_PRECISION_FLOAT;
    b.params.sampler = FL_SAMPLER_STRATIFIED;
    b.params.strata = b.samples;
    try_all(&b, "stratified", render_plainly);
    tear_down(&b);

    set_up(&b, "lens");
    b.params.is_adaptive = true;
    b.samples = 40;
    try_all(&b, "adaptive", render_plainly);
    tear_down(&b);
}

static bool break_off_and_resume(bench *b, fl_diags *diags)
{
    void *data = NULL;
    size_t bytes = 0;
    fl_render *render = create(b, 2, diags);
    bool ok = render && fl_render_restart(render, b->compiled, &b->params, diags) &&
              finish(b, render, diags) && fl_render_checkpoint(render, &data, &bytes, diags);
    fl_render_destroy(render);
    assert_true(!ok || data);
    render = ok ? create(b, 5, diags) : NULL;
    ok = render && fl_render_resume(render, b->compiled, &b->params, data, bytes, diags) &&
         finish(b, render, diags);
    fl_render_destroy(render);
    free(data);
    return ok;
}

static void checkpoints(void **state)
{
    (void)state;
    bench b;
    set_up(&b, "lens");
    b.samples = 5;
    trial whole = {&b, render_plainly};
    assert_true(run(&whole));
    memcpy(b.expected, b.values, sizeof b.values);
    b.has_expected = true;
    try_all(&b, "checkpoint", break_off_and_resume);
    tear_down(&b);
}

static void post(void *done, fl_compiled *refined)
{
    (void)refined;
    sem_post(done);
}

/* Compiled quickly, refined by a thread of its own, and the film goes on with that. */
static bool compile_quickly(bench *b, fl_diags *diags)
{
    sem_t done;
    sem_init(&done, 0, 0);
    fl_pool *pool = fl_pool_create(b->threads, diags);
    fl_compile_options options = {.quick_above = 1};
    fl_compiled *quick = pool ? fl_compile(b->scene, &options, pool, diags) : NULL;
    fl_pool_destroy(pool);
    assert_true(!quick || quick->is_quick);
    fl_render *render = quick ? create(b, b->samples, diags) : NULL;
    bool ok = render && fl_render_restart(render, quick, &b->params, diags);
    fl_refine *refine = ok ? fl_refine_start(quick, b->threads, post, &done, diags) : NULL;
    if (refine) {
        while (sem_wait(&done) != 0)
            ;
        fl_compiled *refined = fl_refine_take(refine); /* NULL: the quick one serves on. */
        ok = !refined || fl_render_replace_scene(render, refined, diags);
        fl_compiled_release(refined);
        fl_refine_destroy(refine);
    }
    ok = ok && refine && finish(b, render, diags);
    fl_render_destroy(render);
    fl_compiled_release(quick);
    sem_destroy(&done);
    return ok;
}

static void quick_hierarchies(void **state)
{
    (void)state;
    bench b;
    set_up(&b, "meshes");
    trial plain = {&b, render_plainly};
    assert_true(run(&plain));
    memcpy(b.expected, b.values, sizeof b.values);
    b.has_expected = true;
    for (b.threads = 1; b.threads <= 2; b.threads++)
        try_all(&b, "quick and refined", compile_quickly);
    tear_down(&b);
}

/* --- Other looks at a scene ------------------------------------------------------------------- */

static bool look_behind(bench *b, fl_diags *diags)
{
    static const fl_aov_grid grid = {.step = 1, .width = SIDE, .height = SIDE};
    fl_frame *frame = fl_frame_create(b->compiled, &b->params, diags);
    bool ok = frame != NULL;
    for (int kind = 0; ok && kind < FL_AOV_COUNT; kind++)
        ok = fl_aov_eval(frame, (fl_aov)kind, NULL, &grid, b->values) ||
             fl_out_of_memory(diags, fl_aov_names[kind]);
    fl_frame_release(frame);
    return ok;
}

static bool copy_maps(bench *b, fl_diags *diags)
{
    fl_progress progress;
    fl_render *render = create(b, 4, diags);
    bool ok = render && fl_render_restart(render, b->compiled, &b->params, diags) &&
              finish(b, render, diags);
    if (ok) {
        assert_true(fl_render_copy_map(render, FL_RENDER_SAMPLES, b->values, PIXELS, &progress));
        ok = fl_render_copy_map(render, FL_RENDER_ERROR, b->values + PIXELS, PIXELS, &progress) ||
             fl_out_of_memory(diags, "the map");
    }
    fl_render_destroy(render);
    return ok;
}

static bool split_noise(bench *b, fl_diags *diags)
{
    fl_noise_split split;
    fl_noise *noise = fl_noise_create(b->compiled, &b->params, 4, diags);
    bool ok = noise != NULL;
    while (ok && fl_noise_rounds(noise) == 0)
        ok = fl_noise_step(noise) || fl_out_of_memory(diags, "the noise measurement");
    if (ok) {
        assert_true(fl_noise_read(noise, &split));
        b->values[0] = (float)split.variance;
        b->values[1] = (float)split.sources[0].alone;
    }
    fl_noise_destroy(noise);
    return ok;
}

static bool draw_tree(bench *b, fl_diags *diags)
{
    fl_raytree tree = {0};
    fl_frame *frame = fl_frame_create(b->compiled, &b->params, diags);
    bool ok =
        frame &&
        ((fl_raytree_trace(frame, 4, 4, 0, &tree) && fl_raytree_find_blockers(frame, &tree)) ||
         fl_out_of_memory(diags, "the tree of rays"));
    fl_raytree_deinit(&tree);
    fl_frame_release(frame);
    return ok;
}

static bool move_scene(bench *b, fl_diags *diags)
{
    fl_scene *scene = parse("meshes", diags);
    bool ok = scene && fl_scene_map(scene, 2.0, fl_v3(1, 2, 3), diags);
    if (ok)
        b->values[0] = (float)scene->meshes[0].mesh->positions[0].x;
    fl_scene_destroy(scene);
    return ok;
}

static void other_looks(void **state)
{
    (void)state;
    static const struct {
        const char *name, *scene;
        use *use;
    } rows[] = {{"maps of the first hit", "meshes", look_behind},
                {"maps of the film", "lens", copy_maps},
                {"noise", "lens", split_noise},
                {"tree of rays", "glass", draw_tree},
                {"scene moved", "meshes", move_scene}};
    for (size_t i = 0; i < FL_COUNT_OF(rows); i++) {
        bench b;
        set_up(&b, rows[i].scene);
        try_all(&b, rows[i].name, rows[i].use);
        tear_down(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ways_to_sample), cmocka_unit_test(checkpoints),
        cmocka_unit_test(quick_hierarchies), cmocka_unit_test(other_looks)};
    return cmocka_run_group_tests_name("alloc_uses", tests, NULL, NULL);
}
