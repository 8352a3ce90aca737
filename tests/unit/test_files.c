/* SPDX-License-Identifier: MIT
 *
 * files.h and digest.h: lookup order, refusals, all-or-nothing writes.
 */
#include "temp_files.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>

#include "io/digest.h"
#include "io/files.h"

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
        cmocka_unit_test(failing_writes_leave_everything_as_it_was),
        cmocka_unit_test(a_read_only_file_stays),
        cmocka_unit_test(two_writers_never_mix),
        cmocka_unit_test(digests_match_the_standard),
    };
    return cmocka_run_group_tests(tests, temp_begin, temp_end);
}
