/* SPDX-License-Identifier: MIT
 *
 * files.h and digest.h: lookup order, refusals, all-or-nothing writes.
 */
#include "temp_files.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>

#include "io/checkpoint_file.h"
#include "io/digest.h"
#include "io/files.h"
#include "io/image_file.h"
#include "io/mesh_file.h"

static const char *find(const char *scene, const char *reference)
{
    static char path[4096];
    bool is_found = fl_files_on_disk.find(NULL, scene, reference, path, sizeof path);
    return is_found ? path : NULL;
}

static void files_are_found_from_near_to_far(void **state)
{
    (void)state;
    char scene[512];
    assert_int_equal(mkdir(temp_path("a"), 0777), 0);
    assert_int_equal(mkdir(temp_path("a/b"), 0777), 0);
    assert_int_equal(mkdir(temp_path("a/b/c"), 0777), 0);
    snprintf(scene, sizeof scene, "%s", temp_path("a/b/c/my scene.txt"));

    assert_null(find(scene, "m.obj"));
    temp_write("m.obj", "", 0);
    assert_non_null(strstr(find(scene, "m.obj"), "a/b/c/../../../m.obj"));
    temp_write("a/m.obj", "", 0);
    assert_non_null(strstr(find(scene, "m.obj"), "a/b/c/../../m.obj"));
    temp_write("a/b/m.obj", "", 0);
    assert_non_null(strstr(find(scene, "m.obj"), "a/b/c/../m.obj"));
    temp_write("a/b/c/m.obj", "", 0);
    assert_string_equal(find(scene, "m.obj"), temp_path("a/b/c/m.obj"));
    assert_non_null(find(scene, "../../b")); /* a folder will do: cube maps are folders */
    assert_string_equal(find("x", temp_path("m.obj")), temp_path("m.obj"));
    assert_null(find(scene, ""));
    assert_null(find(scene, temp_path("none.obj")));
    assert_null(find(scene, "a\xffno such \xc3\xbc.obj"));

    assert_int_equal(chdir(temp_folder), 0);
    assert_string_equal(find("a/b/s.txt", "m.obj"), "m.obj"); /* as given wins */
    assert_string_equal(find("a/b/s.txt", "c/m.obj"), "a/b/c/m.obj");
    assert_string_equal(find("s.txt", "a/m.obj"), "a/m.obj");
    char small[8];
    assert_false(fl_files_on_disk.find(NULL, "a/b/s.txt", "c/m.obj", small, sizeof small));
}

static void whole_files_are_read(void **state)
{
    (void)state;
    fl_diags diags = {0};
    size_t bytes = 99;
    const char *path = temp_write("t\xc3\xa4xt file", "one\0two", 7);
    char *text = fl_file_load(path, "scene", 7, (fl_loc){0}, &diags, &bytes);
    assert_non_null(text);
    assert_int_equal(bytes, 7);
    assert_memory_equal(text, "one\0two", 8); /* with the 0 behind it */
    free(text);
    text = fl_file_load(temp_write("nil", "", 0), "scene", 7, (fl_loc){0}, &diags, &bytes);
    assert_non_null(text);
    assert_int_equal(bytes, 0);
    free(text);
    assert_null(fl_file_load(path, "scene", 6, (fl_loc){0}, &diags, &bytes));
    expect_error(&diags, FL_CAUSE_INPUT, "too large: 7 bytes, at most 6");
}

static void what_is_no_regular_file_is_refused_at_once(void **state)
{
    (void)state;
    fl_diags diags = {0};
    size_t bytes;
    assert_null(fl_file_load(temp_path("none"), "scene", 9, (fl_loc){0}, &diags, &bytes));
    expect_error(&diags, FL_CAUSE_INPUT, "cannot open scene");
    assert_null(fl_file_load(temp_folder, "scene", 9, (fl_loc){0}, &diags, &bytes));
    expect_error(&diags, FL_CAUSE_INPUT, "it is a folder");
    assert_int_equal(mkfifo(temp_path("pipe"), 0666), 0);
    assert_null(fl_file_load(temp_path("pipe"), "scene", 9, (fl_loc){0}, &diags, &bytes));
    expect_error(&diags, FL_CAUSE_INPUT, "not a regular file");
    assert_null(fl_file_load("/dev/zero", "scene", 9, (fl_loc){0}, &diags, &bytes));
    expect_error(&diags, FL_CAUSE_INPUT, "not a regular file");
}

static void an_unreadable_file_is_refused(void **state)
{
    (void)state;
    if (geteuid() == 0)
        skip(); /* root reads everything */
    fl_diags diags = {0};
    size_t bytes;
    const char *path = temp_write("secret", "x", 1);
    assert_int_equal(chmod(path, 0), 0);
    assert_null(fl_file_load(path, "scene", 9, (fl_loc){0}, &diags, &bytes));
    expect_error(&diags, FL_CAUSE_INPUT, "Permission denied");
}

static void assert_content(const char *path, const char *expected)
{
    size_t count;
    unsigned char *bytes = temp_read(path, &count);
    assert_int_equal(count, strlen(expected));
    assert_memory_equal(bytes, expected, count);
    free(bytes);
}

static void saving_replaces_and_keeps_permissions(void **state)
{
    (void)state;
    fl_diags diags = {0};
    struct stat status;
    const char *path = temp_path("out");
    assert_true(fl_file_save(path, "first", 5, &diags));
    assert_content(path, "first");
    assert_int_equal(chmod(path, 0640), 0);
    int entries = temp_count();
    assert_true(fl_file_save(path, "the second", 10, &diags));
    assert_content(path, "the second");
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
    assert_int_equal(temp_count(), entries);

    assert_int_equal(symlink("out", temp_path("link")), 0);
    assert_true(fl_file_save(temp_path("link"), "via link", 8, &diags));
    assert_content(path, "via link");
    assert_int_equal(lstat(temp_path("link"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));

    assert_int_equal(chdir(temp_folder), 0);
    assert_true(fl_file_save("plain name", "", 0, &diags));
    assert_content(temp_path("plain name"), "");
    expect_none(&diags);
}

/* As opening it would: what a link leads to is made, links stay. */
static void links_are_followed_to_their_end(void **state)
{
    (void)state;
    fl_diags diags = {0};
    struct stat status;
    assert_int_equal(mkdir(temp_path("far"), 0777), 0);
    assert_int_equal(symlink("far/chain", temp_path("dangling")), 0);
    assert_int_equal(symlink("../made", temp_path("far/chain")), 0);
    assert_true(fl_file_save(temp_path("dangling"), "new", 3, &diags));
    expect_none(&diags);
    assert_content(temp_path("made"), "new");
    assert_int_equal(lstat(temp_path("dangling"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(lstat(temp_path("far/chain"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));

    int entries = temp_count();
    assert_int_equal(symlink("circle", temp_path("circle")), 0);
    assert_int_equal(symlink("no folder/x", temp_path("nowhere")), 0);
    assert_int_equal(symlink(temp_path("far"), temp_path("folder link")), 0);
    assert_false(fl_file_save(temp_path("circle"), "x", 1, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "circle': Too many levels of symbolic links");
    assert_false(fl_file_save(temp_path("nowhere"), "x", 1, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "nowhere': No such file or directory");
    assert_false(fl_file_save(temp_path("folder link"), "x", 1, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "not a regular file");
    assert_false(fl_file_save(temp_path("made/x"), "x", 1, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "made/x': Not a directory");
    assert_int_equal(temp_count(), entries + 3);
    assert_int_equal(lstat(temp_path("circle"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));
}

static void permissions_are_kept_whatever_the_mask(void **state)
{
    (void)state;
    fl_diags diags = {0};
    struct stat status;
    const char *path = temp_write("shared by a group", "old", 3);
    assert_int_equal(chmod(path, 0664), 0);
    mode_t before = umask(077);
    bool is_saved = fl_file_save(path, "new", 3, &diags);
    umask(before);
    assert_true(is_saved);
    expect_none(&diags);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0664);
}

/* --- Files of the largest size, which take no room on the disk ------------------------------- */

static bool load_scene(const char *path, fl_diags *diags)
{
    size_t bytes;
    char *text = fl_file_load(path, "scene", FL_SCENE_FILE_MAX_BYTES, (fl_loc){0}, diags, &bytes);
    free(text);
    return text != NULL;
}

static bool load_mesh(const char *path, fl_diags *diags)
{
    fl_mesh *mesh = fl_mesh_load(path, (fl_loc){0}, diags);
    fl_mesh_release(mesh);
    return mesh != NULL;
}

static bool load_image(const char *path, fl_diags *diags)
{
    fl_image *image = fl_image_load(path, (fl_loc){0}, diags);
    fl_image_release(image);
    return image != NULL;
}

static bool load_checkpoint(const char *path, fl_diags *diags)
{
    char *file;
    const void *data;
    size_t bytes;
    bool is_loaded = fl_checkpoint_load(path, "key", &file, &data, &bytes, diags);
    free(file);
    return is_loaded;
}

static void each_kind_of_file_has_a_largest_size(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t most;
        bool (*load)(const char *path, fl_diags *diags);
        const char *message;
    } rows[] = {
        {"a.txt", FL_SCENE_FILE_MAX_BYTES, load_scene, "16777217 bytes, at most 16777216"},
        {"a.obj", FL_MESH_FILE_MAX_BYTES, load_mesh, "2147483649 bytes, at most 2147483648"},
        {"a.ply", FL_MESH_FILE_MAX_BYTES, load_mesh, "2147483649 bytes, at most 2147483648"},
        {"a.png", FL_IMAGE_FILE_MAX_BYTES, load_image, "1073741825 bytes, at most 1073741824"},
        {"a.check", FL_CHECKPOINT_MAX_BYTES, load_checkpoint,
         "42949672961 bytes, at most 42949672960"},
    };
    for (size_t i = 0; i < FL_COUNT_OF(rows); i++) {
        fl_diags diags = {0};
        size_t bytes;
        const char *path = temp_write(rows[i].name, "", 0);
        assert_int_equal(truncate(path, (off_t)rows[i].most), 0);
        assert_true(fl_file_check(path, "file", rows[i].most, (fl_loc){0}, &diags, &bytes));
        assert_int_equal(bytes, rows[i].most);
        expect_none(&diags);
        assert_int_equal(truncate(path, (off_t)rows[i].most + 1), 0);
        assert_false(rows[i].load(path, &diags));
        expect_error(&diags, FL_CAUSE_INPUT, rows[i].message);
    }
}

static void failing_writes_leave_everything_as_it_was(void **state)
{
    (void)state;
    fl_diags diags = {0};
    assert_false(fl_file_save(temp_path("no folder/out"), "x", 1, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "No such file or directory");
    assert_false(fl_file_save(temp_folder, "x", 1, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "not a regular file");
    assert_false(fl_file_save("/dev/null", "x", 1, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "not a regular file");

    /* A full disk, as far as a process without privileges can make one. */
    static char big[100000];
    const char *path = temp_write("kept", "old", 3);
    int entries = temp_count();
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = (struct rlimit){4096, before.rlim_max};
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    bool is_saved = fl_file_save(path, big, sizeof big, &diags);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, SIG_DFL);
    assert_false(is_saved);
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "kept': File too large");
    assert_content(path, "old");
    assert_int_equal(temp_count(), entries);
}

static void a_read_only_file_stays(void **state)
{
    (void)state;
    if (geteuid() == 0)
        skip(); /* root writes everything */
    fl_diags diags = {0};
    const char *path = temp_write("fixed", "old", 3);
    assert_int_equal(chmod(path, 0444), 0);
    assert_false(fl_file_save(path, "new", 3, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "Permission denied");
    assert_content(path, "old");
}

static char shared_path[512];

static void *save_often(void *text)
{
    fl_diags diags = {0};
    for (int i = 0; i < 50; i++)
        if (!fl_file_save(shared_path, text, strlen(text), &diags))
            return text;
    return NULL;
}

static void two_writers_never_mix(void **state)
{
    (void)state;
    char a[] = "aaaaaaaaaaaaaaaaaaaa", b[] = "bbbbbbbbbb";
    pthread_t other;
    size_t count;
    int entries = temp_count();
    snprintf(shared_path, sizeof shared_path, "%s", temp_path("shared"));
    assert_int_equal(pthread_create(&other, NULL, save_often, a), 0);
    void *mine = save_often(b), *theirs;
    assert_int_equal(pthread_join(other, &theirs), 0);
    assert_null(mine);
    assert_null(theirs);
    unsigned char *bytes = temp_read(shared_path, &count);
    assert_true((count == strlen(a) && memcmp(bytes, a, count) == 0) ||
                (count == strlen(b) && memcmp(bytes, b, count) == 0));
    free(bytes);
    assert_int_equal(temp_count(), entries + 1);
}

/* The examples of FIPS 180-4's test vectors. */
static void digests_match_the_standard(void **state)
{
    (void)state;
    char hex[FL_SHA256_HEX + 1];
    static char million[1000000];
    fl_digest_sha256("", 0, hex);
    assert_string_equal(hex, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    fl_digest_sha256("abc", 3, hex);
    assert_string_equal(hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    memset(million, 'a', sizeof million);
    fl_digest_sha256(million, sizeof million, hex);
    assert_string_equal(hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_are_found_from_near_to_far),
        cmocka_unit_test(whole_files_are_read),
        cmocka_unit_test(what_is_no_regular_file_is_refused_at_once),
        cmocka_unit_test(an_unreadable_file_is_refused),
        cmocka_unit_test(saving_replaces_and_keeps_permissions),
        cmocka_unit_test(links_are_followed_to_their_end),
        cmocka_unit_test(permissions_are_kept_whatever_the_mask),
        cmocka_unit_test(each_kind_of_file_has_a_largest_size),
        cmocka_unit_test(failing_writes_leave_everything_as_it_was),
        cmocka_unit_test(a_read_only_file_stays),
        cmocka_unit_test(two_writers_never_mix),
        cmocka_unit_test(digests_match_the_standard),
    };
    return cmocka_run_group_tests(tests, temp_begin, temp_end);
}
