/* SPDX-License-Identifier: MIT
 *
 * Files that are saved are noticed, however editors and exporters go about it; others are not.
 */
#include "viewer_kit.h"

#include <sys/stat.h>

#include "support/bell.h"
#include "viewer/watch.h"

static bell the_bell = BELL_INITIALIZER;

/* What changed may be told in more than one piece. */
static void wait_for_change(vw_watch *watch)
{
    pthread_mutex_lock(&the_bell.lock);
    while (!vw_watch_take(watch))
        pthread_cond_wait(&the_bell.rung, &the_bell.lock);
    pthread_mutex_unlock(&the_bell.lock);
}

/* Of now: the files that a test has made before are not news. */
static void set(vw_watch *watch, const char *first, const char *second)
{
    fl_file_list list = {0};
    fl_file_list_add(&list, first);
    if (second)
        fl_file_list_add(&list, second);
    list.begin.tv_sec += 1000;
    vw_watch_set(watch, &list);
    fl_file_list_deinit(&list);
}

static vw_watch *begin(void)
{
    the_bell.count = 0;
    return vw_watch_create(bell_ring, &the_bell);
}

static void saved_files_ring_and_others_do_not(void **unused)
{
    (void)unused;
    vw_watch *watch = begin();
    if (!watch)
        skip();
    char path[256], other[256], fresh[256];
    write_file("watched.txt", "1", path);
    set(watch, path, NULL);
    assert_false(vw_watch_take(watch));
    write_file("other.txt", "1", other);
    write_file("watched.txt", "2", path);
    bell_wait(&the_bell, 1);
    assert_true(vw_watch_take(watch));
    assert_false(vw_watch_take(watch));
    /* As editors do: a new file takes the place of the old one. */
    write_file("fresh.txt", "3", fresh);
    assert_int_equal(rename(fresh, path), 0);
    bell_wait(&the_bell, 2);
    assert_true(vw_watch_take(watch));
    /* Watched no more; nothing to watch: as before. */
    set(watch, other, NULL);
    vw_watch_set(watch, &(fl_file_list){0});
    write_file("watched.txt", "4", path);
    write_file("other.txt", "2", other);
    bell_wait(&the_bell, 3);
    assert_int_equal(bell_wait(&the_bell, 0), 3);
    vw_watch_destroy(watch);
}

static void a_link_rings_for_its_file(void **unused)
{
    (void)unused;
    vw_watch *watch = begin();
    if (!watch)
        skip();
    char sub[256], path[256], link[256];
    path_in_folder("sub", sub);
    assert_int_equal(mkdir(sub, 0700), 0);
    write_file("sub/file.txt", "1", path);
    path_in_folder("link.txt", link);
    assert_int_equal(symlink("sub/file.txt", link), 0);
    set(watch, link, NULL);
    write_file("sub/file.txt", "2", path);
    wait_for_change(watch);
    /* The link itself goes elsewhere. */
    unlink(link);
    assert_int_equal(symlink("watched.txt", link), 0);
    wait_for_change(watch);
    vw_watch_destroy(watch);
    unlink(link);
    unlink(path);
    rmdir(sub);
}

static void a_folder_that_is_made_again_is_watched(void **unused)
{
    (void)unused;
    vw_watch *watch = begin();
    if (!watch)
        skip();
    char sub[256], deep[256], path[256];
    path_in_folder("sub", sub);
    path_in_folder("sub/deep", deep);
    assert_int_equal(mkdir(sub, 0700) | mkdir(deep, 0700), 0);
    write_file("sub/deep/file.txt", "1", path);
    set(watch, path, NULL);
    unlink(path);
    rmdir(deep);
    rmdir(sub);
    wait_for_change(watch);
    /* As the window does, which reads and fails each time. */
    set(watch, path, NULL);
    vw_watch_take(watch);
    assert_int_equal(mkdir(sub, 0700), 0);
    wait_for_change(watch);
    set(watch, path, NULL);
    assert_int_equal(mkdir(deep, 0700), 0);
    wait_for_change(watch);
    set(watch, path, NULL);
    write_file("sub/deep/file.txt", "2", path);
    wait_for_change(watch);
    vw_watch_destroy(watch);
    unlink(path);
    rmdir(deep);
    rmdir(sub);
}

/* A file is news when it is closed, a hard link at once. */
static void a_new_file_is_news_when_it_is_whole(void **unused)
{
    (void)unused;
    vw_watch *watch = begin();
    if (!watch)
        skip();
    char path[256], other[256], fresh[256];
    path_in_folder("watched.txt", path);
    path_in_folder("other.txt", other);
    unlink(path);
    write_file("other.txt", "1", other);
    set(watch, path, other);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    write_file("other.txt", "2", other);
    bell_wait(&the_bell, 1);
    assert_int_equal(bell_wait(&the_bell, 0), 1);
    fclose(file);
    bell_wait(&the_bell, 2);
    unlink(path);
    write_file("fresh.txt", "1", fresh);
    assert_int_equal(link(fresh, path), 0);
    bell_wait(&the_bell, 3);
    vw_watch_destroy(watch);
}

/* What was saved between being read and being watched. */
static void a_change_before_the_watch_counts(void **unused)
{
    (void)unused;
    char path[256], other[256];
    write_file("watched.txt", "1", path);
    path_in_folder("other.txt", other);
    unlink(other);
    struct stat status;
    assert_int_equal(lstat(path, &status), 0);
    for (int is_late = 0; is_late < 2; is_late++) {
        vw_watch *watch = begin();
        if (!watch)
            skip();
        fl_file_list list = {0};
        fl_file_list_add(&list, path);
        fl_file_list_add(&list, other);
        list.begin = status.st_ctim;
        list.begin.tv_sec += !is_late;
        vw_watch_set(watch, &list);
        assert_int_equal(bell_wait(&the_bell, 0), is_late);
        assert_int_equal(vw_watch_take(watch), is_late);
        /* What was watched meanwhile has been told. */
        list.begin.tv_sec -= 1000;
        vw_watch_set(watch, &list);
        assert_false(vw_watch_take(watch));
        fl_file_list_deinit(&list);
        vw_watch_destroy(watch);
    }
    /* The list's own time is that of files. */
    fl_file_list list = {0};
    fl_file_list_add(&list, path);
    vw_watch *watch = begin();
    write_file("watched.txt", "2", path);
    vw_watch_set(watch, &list);
    assert_true(vw_watch_take(watch));
    fl_file_list_deinit(&list);
    vw_watch_destroy(watch);
}

static int finish(void **unused)
{
    (void)unused;
    static const char *const names[] = {"watched.txt", "other.txt", "fresh.txt"};
    return remove_files(names, FL_COUNT_OF(names));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(saved_files_ring_and_others_do_not),
        cmocka_unit_test(a_link_rings_for_its_file),
        cmocka_unit_test(a_folder_that_is_made_again_is_watched),
        cmocka_unit_test(a_new_file_is_news_when_it_is_whole),
        cmocka_unit_test(a_change_before_the_watch_counts),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
