/* SPDX-License-Identifier: MIT
 *
 * Memory that runs out at any moment: every allocation of parsing, formatting, compiling,
 * rendering, showing and picking fails once, alone and with all that follow. Either the picture
 * comes out as ever, or an error says that the machine is the cause; nothing leaks, nothing
 * crashes.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "alloc/failing.h"
#include "bytes/scenes.h"
#include "bytes/world.h"

enum { SIDE = 8, FLOATS = SIDE * SIDE * 3, BYTES = SIDE * SIDE * 4 };

typedef struct trial {
    const test_scene *test;
    fl_accel accel;
    uint32_t threads;
    bool has_expected;
    float film[FLOATS], expected[FLOATS];
} trial;

/* All that a program does with a compiled scene. False: something failed; `diags` may know what. */
static bool use(const trial *t, fl_render *render, const fl_scene *scene, fl_compiled *compiled,
                float *film, fl_diags *diags)
{
    fl_params params;
    fl_progress progress;
    fl_params_from_scene(&params, scene, t->test->is_exact);
    params.width = params.height = SIDE;
    params.sampler = t->test->sampler;
    params.solver = t->test->solver;
    params.precision = t->test->is_double ? FL_PRECISION_DOUBLE : FL_PRECISION_FLOAT;
    uint64_t revision = 0;
    uint8_t shown[BYTES];
    if (!fl_params_check(&params, diags) || !fl_render_restart(render, compiled, &params, diags))
        return false;
    fl_render_wait(render, -1.0);
    fl_render_progress(render, &progress);
    if (progress.state == FL_RENDER_FAILED)
        return fl_out_of_memory(diags, "rendering"); /* as the command line does */
    assert_true(progress.state == FL_RENDER_DONE);
    assert_true(fl_render_mean(render, film, FLOATS, &progress));
    fl_tonemap tonemap = {.exposure_ev = 1.0};
    assert_true(fl_render_display(render, &revision, &tonemap, shown, BYTES, &progress));
    params.seed = 1; /* again, with what is there */
    if (!fl_render_restart(render, compiled, &params, diags))
        return false;
    fl_frame *frame = fl_frame_create(compiled, &params, diags);
    if (!frame)
        return false;
    fl_pick pick;
    fl_trace_pick(frame, 4.2, 4.4, &pick);
    fl_frame_release(frame);
    return true;
}

static bool load_and_use(const trial *t, float *film, fl_diags *diags)
{
    fl_parse_options parse = {0};
    size_t bytes = strlen(t->test->text), formatted_bytes;
    char *formatted =
        fl_scene_format(t->test->text, bytes, t->test->name, &parse, &formatted_bytes, diags);
    if (!formatted)
        return false;
    free(formatted);
    fl_scene *scene =
        fl_scene_parse(t->test->text, bytes, t->test->name, &parse, &test_world, diags);
    assert_true(!scene == (diags->error_count > 0));
    if (!scene)
        return false;
    bool ok = false;
    fl_compile_options options = {.accel = t->accel};
    fl_pool *pool = fl_pool_create(t->threads, diags);
    fl_compiled *compiled = pool ? fl_compile(scene, &options, pool, diags) : NULL;
    fl_pool_destroy(pool);
    assert_true(!compiled == (diags->error_count > 0));
    fl_render *render =
        compiled ? fl_render_create(&(fl_render_options){.thread_count = t->threads}, diags) : NULL;
    if (render) {
        fl_render_set_limits(render, &(fl_render_limits){.samples = 1});
        ok = use(t, render, scene, compiled, film, diags);
        fl_render_destroy(render);
    }
    fl_compiled_release(compiled);
    fl_scene_destroy(scene);
    return ok;
}

static bool run(void *context)
{
    trial *t = context;
    fl_diags diags = {0};
    bool ok = load_and_use(t, t->film, &diags);
    bool did_fail = failing_end();
    assert_true(ok == (diags.error_count == 0));
    if (ok && t->has_expected)
        assert_memory_equal(t->film, t->expected, sizeof t->film);
    if (!ok && did_fail && !failing_names_machine(&diags)) {
        char text[512];
        fl_diag_format(&diags.items[0], text, sizeof text);
        fail_msg("memory is not named as the cause: %s", text);
    }
    fl_diags_deinit(&diags);
    return ok;
}

static void test_every_scene(void **state)
{
    (void)state;
    static trial t;
    for (uint32_t i = 0; i < test_scene_count; i++) {
        t = (trial){.test = &test_scenes[i],
                    .threads = 1 + i % 2,
                    .accel = i % 3 == 2 ? FL_ACCEL_OCTREE : FL_ACCEL_BVH};
        assert_true(run(&t));
        memcpy(t.expected, t.film, sizeof t.film);
        t.has_expected = true;
        print_message("%s: ", t.test->name);
        assert_true(failing_every_call(run, &t) > 20);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_scene)};
    return cmocka_run_group_tests_name("alloc", tests, NULL, NULL);
}
