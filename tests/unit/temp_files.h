/* SPDX-License-Identifier: MIT
 *
 * For tests that touch the disk: one folder a program, emptied and removed at its end; and the
 * shape of an expected error.
 */
#ifndef TEMP_FILES_H
#define TEMP_FILES_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/firstlight.h"

static char temp_folder[256];

static inline int temp_begin(void **state)
{
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(temp_folder, sizeof temp_folder, "%s/firstlight-test-XXXXXX", base ? base : "/tmp");
    return mkdtemp(temp_folder) ? 0 : -1;
}

static inline void temp_remove(const char *folder)
{
    char path[1024];
    DIR *entries = opendir(folder);
    if (!entries)
        return;
    for (struct dirent *e = readdir(entries); e; e = readdir(entries)) {
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0)
            continue;
        if (snprintf(path, sizeof path, "%s/%s", folder, e->d_name) >= (int)sizeof path)
            continue;
        if (unlink(path) != 0)
            temp_remove(path);
    }
    closedir(entries);
    rmdir(folder);
}

static inline int temp_end(void **state)
{
    (void)state;
    temp_remove(temp_folder);
    return 0;
}

/** Full path of `name` in the folder; valid for the next 7 calls. */
static inline const char *temp_path(const char *name)
{
    static char paths[8][512];
    static unsigned next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", temp_folder, name);
    return path;
}

static inline const char *temp_write(const char *name, const void *bytes, size_t count)
{
    const char *path = temp_path(name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, count, file), count);
    assert_int_equal(fclose(file), 0);
    return path;
}

/** Bytes of a file, from malloc. */
static inline unsigned char *temp_read(const char *path, size_t *out_count)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *out_count = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*out_count + 1);
    assert_int_equal(fread(bytes, 1, *out_count, file), *out_count);
    fclose(file);
    return bytes;
}

/** How many entries the folder has. */
static inline int temp_count(void)
{
    int count = -2; /* . and .. */
    DIR *entries = opendir(temp_folder);
    assert_non_null(entries);
    while (readdir(entries))
        count++;
    closedir(entries);
    return count;
}

/** Exactly one error of that cause whose message has `part`; the list is emptied. */
static inline void expect_error(fl_diags *diags, fl_cause cause, const char *part)
{
    assert_int_equal(diags->error_count, 1);
    if (!strstr(diags->items[0].message, part))
        fail_msg("'%s' is not in '%s'", part, diags->items[0].message);
    assert_int_equal(diags->items[0].cause, cause);
    fl_diags_deinit(diags);
}

static inline void expect_none(fl_diags *diags)
{
    if (diags->count > 0)
        fail_msg("unexpected: %s", diags->items[0].message);
}

#endif
