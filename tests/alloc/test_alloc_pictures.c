/* SPDX-License-Identifier: MIT
 *
 * The same for pictures, the state in them, checkpoints and meshes by the library. The module that
 * holds the image library is beyond the linker's reach: what it hands over is copied to memory that
 * may fail and is counted.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <dirent.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "alloc/failing.h"
#include "io/checkpoint_file.h"
#include "io/files.h"
#include "io/image_file.h"
#include "io/mesh_file.h"
#include "io/state_text.h"

void __real_free(void *block);
void *__real_dlsym(void *module, const char *name);
void *__wrap_dlsym(void *module, const char *name);

/* --- The module ------------------------------------------------------------------------------- */

static const fl_codec *real;
static fl_codec counted;

static bool counted_find_text(void *reader, const char *key, char **out_text)
{
    char *theirs;
    *out_text = NULL;
    if (!real->find_text(reader, key, &theirs) || !theirs)
        return !theirs;
    *out_text = malloc(strlen(theirs) + 1);
    if (*out_text)
        strcpy(*out_text, theirs);
    __real_free(theirs);
    return *out_text != NULL;
}

static bool counted_encode(const fl_codec_picture *picture, const fl_image_text *texts,
                           size_t text_count, void **out_bytes, size_t *out_count, char *message)
{
    void *theirs;
    if (!real->encode(picture, texts, text_count, &theirs, out_count, message))
        return false;
    *out_bytes = malloc(*out_count);
    if (*out_bytes)
        memcpy(*out_bytes, theirs, *out_count);
    else
        snprintf(message, FL_CODEC_MESSAGE_BYTES, "out of memory");
    __real_free(theirs);
    return *out_bytes != NULL;
}

void *__wrap_dlsym(void *module, const char *name)
{
    real = __real_dlsym(module, name);
    if (!real)
        return NULL;
    counted = *real;
    counted.find_text = counted_find_text;
    counted.encode = counted_encode;
    return &counted;
}

/* --- Files ------------------------------------------------------------------------------------ */

static char folder[] = "/tmp/firstlight-alloc-XXXXXX";
static const fl_loc here = {"scene", 1, 1, 1};
static const char scene_text[] =
    "firstlight 1\nPerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n"
    "Lights { PointLight { position 2 3 4 color 1 1 1 } }\n"
    "Group { Sphere { center 0 0 0 radius 1 } }\n";

static const char *path_of(const char *name)
{
    static char paths[4][128];
    static unsigned next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void write_file(const char *name, const char *text)
{
    FILE *file = fopen(path_of(name), "wb");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static bool is_file(const char *name, const char *text)
{
    char got[256] = "";
    FILE *file = fopen(path_of(name), "rb");
    assert_non_null(file);
    size_t bytes = fread(got, 1, sizeof got - 1, file);
    fclose(file);
    return bytes == strlen(text) && strcmp(got, text) == 0;
}

/* The end of a go: what went wrong is told, and blamed on the machine. */
static bool end(bool ok, fl_diags *diags)
{
    failing_end();
    assert_true(ok == (diags->error_count == 0));
    assert_true(ok || failing_names_machine(diags));
    fl_diags_deinit(diags);
    return ok;
}

static void try_all(const char *name, bool (*body)(void *context), void *context)
{
    assert_true(body(context));
    print_message("%s: ", name);
    assert_true(failing_every_call(body, context) > 0);
}

/* --- Pictures --------------------------------------------------------------------------------- */

static fl_scene *parse(fl_diags *diags)
{
    return fl_scene_parse(scene_text, sizeof scene_text - 1, path_of("scene.txt"),
                          &(fl_parse_options){0}, NULL, diags);
}

/* With its whole state, the light at another place. */
static bool save_picture(void *name)
{
    static float rgb[12] = {0.1f, 0.2f, 0.3f, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    fl_diags diags = {0};
    fl_scene *scene = parse(&diags);
    bool ok = scene != NULL;
    if (ok) {
        fl_params params;
        fl_state_texts texts;
        fl_params_from_scene(&params, scene, false);
        fl_light light = scene->lights[0];
        light.position.x = 5.0;
        params.lights = &light;
        params.width = params.height = 2;
        fl_state_texts_fill(&texts, scene->path, scene, &params,
                            &(fl_progress){.width = 2, .height = 2, .complete_samples = 3}, rgb);
        fl_image image = {.width = 2, .height = 2, .format = FL_PIXEL_FLOAT, .pixels = rgb};
        ok = fl_image_save(path_of(name), &image, texts.items, FL_COUNT_OF(texts.items), &diags);
        assert_true(ok || is_file(name, "old"));
    }
    fl_scene_destroy(scene);
    return end(ok, &diags);
}

static bool save_over(void *name)
{
    write_file(name, "old");
    return save_picture(name);
}

static bool load_picture(void *name)
{
    fl_diags diags = {0};
    fl_image *image = fl_image_load(path_of(name), here, &diags);
    if (image) {
        assert_int_equal(image->width, 2);
        assert_true(fl_image_linear(image, 0) > 0.09f && fl_image_linear(image, 0) < 0.11f);
    }
    bool ok = image != NULL;
    fl_image_release(image);
    return end(ok, &diags);
}

/* Opened again: everything that was said, the light where it was put. */
static bool load_state(void *name)
{
    fl_diags diags = {0};
    fl_saved_state state;
    fl_scene *scene = parse(&diags);
    bool ok = scene && fl_saved_state_load(path_of(name), &state, &diags);
    if (ok) {
        fl_params params;
        fl_params_from_scene(&params, scene, false);
        assert_int_equal(state.samples, 3);
        ok = fl_saved_state_apply(&state, scene, &params) || fl_out_of_memory(&diags, "lights");
        assert_true(!ok || params.lights[0].position.x == 5.0);
        assert_true(!ok || params.width == 2);
    }
    if (scene)
        fl_saved_state_deinit(&state);
    fl_scene_destroy(scene);
    return end(ok, &diags);
}

static void pictures(void **state)
{
    (void)state;
    static char names[][16] = {"a.png", "a.exr", "a.tif"};
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        try_all("save", save_over, names[i]);
        write_file(names[i], "old");
        assert_true(save_picture(names[i]));
        try_all("load", load_picture, names[i]);
        try_all("state", load_state, names[i]);
    }
}

/* --- Checkpoints ------------------------------------------------------------------------------ */

static bool checkpoint_key(char key[FL_CHECKPOINT_KEY_BYTES], fl_diags *diags)
{
    fl_params params;
    fl_scene *scene = parse(diags);
    bool ok = scene != NULL;
    if (ok) {
        fl_params_from_scene(&params, scene, false);
        ok = fl_checkpoint_key(scene, &params, key, diags);
    }
    fl_scene_destroy(scene);
    return ok;
}

static bool save_checkpoint(void *name)
{
    char key[FL_CHECKPOINT_KEY_BYTES];
    fl_diags diags = {0};
    write_file(name, "old");
    bool ok = checkpoint_key(key, &diags) &&
              fl_checkpoint_save(path_of(name), key, "some bytes", 10, &diags);
    assert_true(ok || is_file(name, "old"));
    return end(ok, &diags);
}

static bool load_checkpoint(void *name)
{
    char key[FL_CHECKPOINT_KEY_BYTES], *file = NULL;
    const void *data = NULL;
    size_t bytes;
    fl_diags diags = {0};
    bool ok = checkpoint_key(key, &diags) &&
              fl_checkpoint_load(path_of(name), key, &file, &data, &bytes, &diags);
    if (ok) {
        assert_int_equal(bytes, 10);
        assert_memory_equal(data, "some bytes", 10);
    }
    free(file);
    return end(ok, &diags);
}

static void checkpoints(void **state)
{
    (void)state;
    static char name[] = "state";
    try_all("save", save_checkpoint, name);
    assert_true(save_checkpoint(name));
    try_all("load", load_checkpoint, name);
}

/* --- Meshes by the library, whose own memory is its own ----------------------------------------
 */

static bool load_mesh(void *name)
{
    fl_diags diags = {0};
    fl_mesh *mesh = fl_mesh_load(path_of(name), here, &diags);
    if (mesh)
        assert_int_equal(mesh->face_count, 1);
    bool ok = mesh != NULL;
    fl_mesh_release(mesh);
    return end(ok, &diags);
}

static void meshes(void **state)
{
    (void)state;
    static char ply[] = "a.ply", gltf[] = "a.gltf";
    write_file(ply, "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                    "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                    "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    try_all("ply", load_mesh, ply);
    write_file("a.bin", "000011112222333344445555666677778888");
    write_file(gltf,
               "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
               "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
               "\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
               "\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}],\"bufferViews\":[{"
               "\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":"
               "\"a.bin\"}]}");
    try_all("gltf", load_mesh, gltf);
}

/* --------------------------------------------------------------------------------------------- */

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    write_file("scene.txt", scene_text);
    return 0;
}

/* Nothing but what was meant to be there is there. */
static int remove_folder(void **state)
{
    (void)state;
    static const char *const names[] = {"scene.txt", "a.png", "a.exr", "a.tif",
                                        "state",     "a.ply", "a.bin", "a.gltf"};
    for (size_t i = 0; i < FL_COUNT_OF(names); i++)
        unlink(path_of(names[i]));
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pictures), cmocka_unit_test(checkpoints),
                                       cmocka_unit_test(meshes)};
    return cmocka_run_group_tests_name("alloc_pictures", tests, make_folder, remove_folder);
}
