/* SPDX-License-Identifier: MIT
 *
 * Scenes read by a thread of their own: the newest wish wins, errors come along, nothing is lost
 * when the window closes in the middle.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include "viewer/loading.h"
#include "viewer_loader.h"

/* A loader that waits at a gate, and says who came. */
typedef struct gate {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    uint32_t permits, entered, ended; /* Loads that may go on, have begun, were announced. */
    char last[VW_PATH_MAX];
} gate;

static gate the_gate = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

static bool load_at_gate(void *context, const char *path, vw_scene *out, fl_diags *diags)
{
    gate *g = context;
    pthread_mutex_lock(&g->lock);
    memcpy(g->last, path, strlen(path) + 1);
    g->entered++;
    pthread_cond_broadcast(&g->changed);
    while (g->permits == 0)
        pthread_cond_wait(&g->changed, &g->lock);
    g->permits--;
    pthread_mutex_unlock(&g->lock);
    return viewer_test_load(NULL, path, out, diags);
}

static void hear(void *context)
{
    gate *g = context;
    pthread_mutex_lock(&g->lock);
    g->ended++;
    pthread_cond_broadcast(&g->changed);
    pthread_mutex_unlock(&g->lock);
}

static void permit(uint32_t count)
{
    pthread_mutex_lock(&the_gate.lock);
    the_gate.permits += count;
    pthread_cond_broadcast(&the_gate.changed);
    pthread_mutex_unlock(&the_gate.lock);
}

static void await(const uint32_t *counter, uint32_t count)
{
    pthread_mutex_lock(&the_gate.lock);
    while (*counter < count)
        pthread_cond_wait(&the_gate.changed, &the_gate.lock);
    pthread_mutex_unlock(&the_gate.lock);
}

static vw_loading *begin(const vw_loader *loader)
{
    fl_diags diags = {0};
    the_gate.permits = the_gate.entered = the_gate.ended = 0;
    vw_loading *loading = vw_loading_create(loader, hear, &the_gate, &diags);
    assert_non_null(loading);
    assert_int_equal(diags.count, 0);
    return loading;
}

static const vw_loader loader = {.context = &the_gate, .load = load_at_gate};

static void the_newest_wish_wins(void **state)
{
    (void)state;
    vw_loading *loading = begin(&loader);
    vw_scene scene = {0};
    char path[VW_PATH_MAX];
    fl_diags diags = {0};
    assert_false(vw_loading_is_busy(loading));
    assert_false(vw_loading_take(loading, &scene, path, &diags));
    vw_loading_ask(loading, VIEWER_TEST_SCENE);
    await(&the_gate.entered, 1);
    assert_true(vw_loading_is_busy(loading));
    vw_loading_ask(loading, "skipped.txt"); /* Never opened: a newer wish comes before its turn. */
    vw_loading_ask(loading, FL_SOURCE_DIR "/scenes/disks.txt");
    permit(2);
    await(&the_gate.ended, 2);
    assert_int_equal(the_gate.entered, 2);
    assert_string_equal(the_gate.last, FL_SOURCE_DIR "/scenes/disks.txt");
    assert_true(vw_loading_take(loading, &scene, path, &diags));
    assert_string_equal(path, FL_SOURCE_DIR "/scenes/disks.txt");
    assert_non_null(scene.compiled);
    assert_int_equal(diags.error_count, 0);
    assert_false(vw_loading_take(loading, &scene, path, &diags)); /* Once. */
    assert_false(vw_loading_is_busy(loading));
    vw_scene_deinit(&scene);
    vw_loading_destroy(loading);
}

static void errors_come_along(void **state)
{
    (void)state;
    vw_loading *loading = begin(&loader);
    vw_scene scene = {0};
    char path[VW_PATH_MAX];
    fl_diags diags = {0};
    permit(1);
    vw_loading_ask(loading, "no such scene.txt");
    await(&the_gate.ended, 1);
    assert_true(vw_loading_take(loading, &scene, path, &diags));
    assert_null(scene.compiled);
    assert_int_equal(diags.error_count, 1);
    assert_non_null(strstr(diags.items[0].loc.file, "no such scene.txt"));
    assert_int_equal(scene.files.count, 1);
    assert_string_equal(scene.files.paths[0], "no such scene.txt");
    vw_scene_deinit(&scene);
    fl_diags_deinit(&diags);
    vw_loading_destroy(loading);
}

/* What a scene names and is missing or broken is said with it, so that it can be waited for. */
static void files_come_along_also_of_broken_scenes(void **state)
{
    (void)state;
    static const char text[] =
        "firstlight 1\n"
        "PerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 40 }\n"
        "Materials { numMaterials 1 Material { texture not-there.png } }\n"
        "Group { numObjects 3 MaterialIndex 0\n"
        "        TriangleMesh { obj_file not-there.obj } TriangleMesh { obj_file broken.obj }\n"
        "        TriangleMesh { obj_file /not/there.obj } }\n";
    static const char *const names[] = {"scene.txt", "not-there.png", "not-there.obj", "broken.obj",
                                        NULL};
    char folder[] = "firstlight-loading-XXXXXX", path[64], want[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/broken.obj", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("v 1 2\n", file);
    fclose(file);
    snprintf(want, sizeof want, "%s/scene.txt", folder);
    file = fopen(want, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    vw_scene scene = {0};
    fl_diags diags = {0};
    assert_false(viewer_test_load(NULL, want, &scene, &diags));
    assert_true(diags.error_count >= 4);
    assert_null(scene.scene);
    assert_int_equal(scene.files.count, 5);
    for (size_t i = 0; names[i]; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        assert_string_equal(scene.files.paths[i], path);
    }
    assert_string_equal(scene.files.paths[4], "/not/there.obj");
    vw_scene_deinit(&scene);
    fl_diags_deinit(&diags);
    unlink(want);
    snprintf(path, sizeof path, "%s/broken.obj", folder);
    unlink(path);
    assert_int_equal(rmdir(folder), 0);
}

/* What is not taken, is being read, or waits for its turn goes when the window does. */
static void closing_in_the_middle_loses_nothing(void **state)
{
    (void)state;
    vw_loading *loading = begin(&loader);
    permit(1);
    vw_loading_ask(loading, VIEWER_TEST_SCENE);
    await(&the_gate.ended, 1);
    vw_loading_ask(loading, VIEWER_TEST_SCENE);
    await(&the_gate.entered, 2);
    vw_loading_ask(loading, VIEWER_TEST_SCENE);
    permit(2); /* The third may get its turn before the end, or not. */
    vw_loading_destroy(loading);
    vw_loading_destroy(NULL);
    assert_in_range(the_gate.entered, 2, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_newest_wish_wins),
        cmocka_unit_test(errors_come_along),
        cmocka_unit_test(files_come_along_also_of_broken_scenes),
        cmocka_unit_test(closing_in_the_middle_loses_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
