/* SPDX-License-Identifier: MIT
 *
 * A scene that was compiled quickly: looked at at once, refined meanwhile, the same picture.
 */
#include "viewer_kit.h"

#include "support/bell.h"
#include "viewer/words.h"

static const char scene_text[] =
    "firstlight 1\n"
    "PerspectiveCamera { center 0 0 4 direction 0 0 -1 up 0 1 0 angle 40 width 40 height 30 }\n"
    "Background { color 0.3 0.4 0.5 ambientLight 0.2 0.2 0.2 }\n"
    "Lights { numLights 1 DiskLight { position -2 3 3 direction 0.5 -0.7 -0.7 radius 0.6\n"
    "    color 1 1 1 } }\n"
    "Materials { numMaterials 1 Material { diffuseColor 0.7 0.5 0.3 reflect 0.3 } }\n"
    "Group { numObjects 3 MaterialIndex 0\n"
    "    Triangle { vertex0 -1 -1 0 vertex1 1 -1 0 vertex2 0 1 0 }\n"
    "    Triangle { vertex0 -2 -1 -1 vertex1 0 -1 -1 vertex2 -1 1 -1 }\n"
    "    Triangle { vertex0 0 -1 1 vertex1 2 -1 -1 vertex2 1 1 0 } }\n";

static uint32_t two_triangles = 2; /* For the loader: more are many. */

enum { SAMPLES = 4, FLOATS = 3 * 40 * 30 };

static bell the_bell = BELL_INITIALIZER;

static void open_rung(vw_session *session, const vw_options *options, const char *path)
{
    fl_diags diags = {0};
    assert_true(vw_session_open(session, options, path, 0, 0, &diags));
    session->state.look.sample_cap = SAMPLES;
    assert_true(vw_session_start(session, bell_ring, &the_bell, &diags));
    assert_true(vw_session_restart(session, &diags));
    assert_int_equal(diags.count, 0);
}

/* As the window does: look again each time somebody rings. */
static void await_refined(vw_session *session)
{
    uint32_t seen = 0;
    while (!vw_session_take_refined(session))
        seen = bell_wait(&the_bell, seen + 1);
}

static float *finished(vw_session *session)
{
    fl_diags diags = {0};
    fl_progress progress;
    assert_true(fl_render_wait(session->render, -1.0));
    float *rgb = vw_session_mean(session, &progress, &diags);
    assert_non_null(rgb);
    assert_int_equal(progress.complete_samples, SAMPLES);
    assert_int_equal(3 * progress.width * progress.height, FLOATS);
    return rgb;
}

static bool status_says(const vw_session *session, const char *what)
{
    vw_status items[VW_STATUS_MAX];
    uint32_t count = vw_words_status(&session->state, &session->progress, items);
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(items[i].value, what) == 0)
            return true;
    return false;
}

static void the_picture_is_the_same(void **unused)
{
    char path[256];
    (void)unused;
    write_file("triangles.txt", scene_text, path);
    vw_options options = viewer_test_options();
    vw_session plain, quick;
    open_rung(&plain, &options, path);
    assert_false(plain.state.is_refining);
    float *want = finished(&plain);
    vw_session_close(&plain);

    options.loader.context = &two_triangles;
    for (int round = 0; round < 8; round++) {
        open_rung(&quick, &options, path);
        assert_true(quick.scene.compiled->is_quick);
        assert_true(status_says(&quick, "refining the hierarchy"));
        if (round % 2) /* Else as it comes. */
            assert_true(fl_render_wait(quick.render, -1.0));
        await_refined(&quick);
        assert_false(quick.scene.compiled->is_quick);
        assert_false(status_says(&quick, "refining the hierarchy"));
        assert_false(vw_session_take_refined(&quick));
        float *got = finished(&quick);
        assert_memory_equal(got, want, FLOATS * sizeof *got);
        free(got);
        vw_session_close(&quick);
    }
    free(want);
}

static void another_scene_ends_it(void **unused)
{
    char path[256];
    fl_diags diags = {0};
    (void)unused;
    path_in_folder("triangles.txt", path);
    vw_options options = viewer_test_options();
    options.loader.context = &two_triangles;
    vw_session session;
    open_rung(&session, &options, path);
    for (int k = 0; k < 5; k++) { /* Read again while the last one is being refined. */
        assert_true(vw_session_load(&session, path, &diags));
        assert_true(session.state.is_refining);
        assert_true(vw_session_restart(&session, &diags));
    }
    assert_true(vw_session_load(&session, VIEWER_TEST_SCENE, &diags)); /* No mesh. */
    assert_false(session.state.is_refining);
    assert_true(vw_session_load(&session, path, &diags));
    assert_true(session.state.is_refining);
    vw_session_close(&session); /* In the middle. */
    assert_int_equal(diags.count, 0);
}

static int clean_up(void **unused)
{
    static const char *const names[] = {"triangles.txt"};
    (void)unused;
    return remove_files(names, FL_COUNT_OF(names));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_picture_is_the_same),
        cmocka_unit_test(another_scene_ends_it),
    };
    return cmocka_run_group_tests(tests, make_folder, clean_up);
}
