/* SPDX-License-Identifier: MIT
 *
 * The same for files: reading a mesh and a text from disk, saving bytes over a file. A save that
 * fails leaves the file as it was and nothing beside it.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "alloc/failing.h"
#include "io/files.h"
#include "io/obj.h"

static const char old_bytes[] = "old", new_bytes[] = "new bytes";
static char folder[] = "/tmp/firstlight-alloc-XXXXXX", obj_path[64], save_path[64];

/* Failed as it should: with an error that blames the machine, or for which there was no memory. */
static bool fails_well(fl_diags *diags)
{
    bool is_well = diags->error_count > 0 && failing_names_machine(diags);
    fl_diags_deinit(diags);
    return is_well;
}

static bool load_mesh(void *context)
{
    (void)context;
    fl_diags diags = {0};
    fl_mesh *mesh = fl_files_on_disk.load_mesh(NULL, obj_path, (fl_loc){.file = "scene"}, &diags);
    failing_end();
    if (!mesh) {
        assert_true(fails_well(&diags));
        return false;
    }
    assert_int_equal(mesh->face_count, 400);
    fl_mesh_release(mesh);
    fl_diags_deinit(&diags);
    return true;
}

static bool wrong_mesh(void *context)
{
    (void)context;
    static const char text[] = "v 1 2\nv 1 2 3\nf 1 2 3\nf 1 1 1";
    fl_diags diags = {0};
    assert_null(fl_obj_parse(text, sizeof text - 1, "wrong.obj", &diags));
    assert_true(diags.error_count > 0);
    fl_diags_deinit(&diags);
    return true;
}

static bool save(void *context)
{
    (void)context;
    fl_diags diags = {0};
    bool ok = fl_file_save(save_path, new_bytes, sizeof new_bytes, &diags);
    failing_end();
    assert_true(ok == (diags.error_count == 0));
    fl_diags_deinit(&diags);
    char read[32] = "";
    FILE *file = fopen(save_path, "rb");
    assert_non_null(file);
    size_t bytes = fread(read, 1, sizeof read, file);
    fclose(file);
    assert_int_equal(bytes, ok ? sizeof new_bytes : sizeof old_bytes);
    assert_memory_equal(read, ok ? new_bytes : old_bytes, bytes);
    file = fopen(save_path, "wb");
    assert_non_null(file);
    fwrite(old_bytes, 1, sizeof old_bytes, file);
    fclose(file);
    return ok;
}

static void write_files(void)
{
    snprintf(obj_path, sizeof obj_path, "%s/a.obj", folder);
    snprintf(save_path, sizeof save_path, "%s/b.png", folder);
    FILE *file = fopen(obj_path, "w");
    assert_non_null(file);
    for (int i = 0; i < 402; i++)
        fprintf(file, "v %d %d %d\nvt 0.5 %d\nvn 0 %d 1\n", i, i * i % 17, i % 5, i, i);
    for (int i = 1; i <= 400; i++)
        fprintf(file, "f %d/%d/%d %d %d\n", i, i, i, i + 1, i + 2);
    fclose(file);
    file = fopen(save_path, "wb");
    assert_non_null(file);
    fwrite(old_bytes, 1, sizeof old_bytes, file);
    fclose(file);
}

static void test_files(void **state)
{
    (void)state;
    assert_non_null(mkdtemp(folder));
    write_files();
    assert_true(load_mesh(NULL));
    assert_true(failing_every_call(load_mesh, NULL) > 5);
    assert_true(failing_every_call(wrong_mesh, NULL) > 0);
    assert_true(save(NULL));
    failing_every_call(save, NULL);
    DIR *left = opendir(folder);
    assert_non_null(left);
    int count = 0;
    while (readdir(left))
        count++;
    closedir(left);
    assert_int_equal(count, 4); /* . .. and the two files */
    unlink(obj_path);
    unlink(save_path);
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_files)};
    return cmocka_run_group_tests_name("alloc_io", tests, NULL, NULL);
}
