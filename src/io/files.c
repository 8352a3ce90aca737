/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* realpath */
#include "io/files.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/image_file.h"
#include "io/mesh_file.h"

/* Names tried for the file written beside the target before giving up: a name is only taken when an
 * earlier process of the same number died in between. */
enum { TEMP_NAMES_MAX = 100 };

static bool find(void *context, const char *scene_path, const char *reference, char *out_path,
                 size_t out_bytes)
{
    (void)context;
    if (!*reference)
        return false;
    int length = snprintf(out_path, out_bytes, "%s", reference);
    if (length < 0 || (size_t)length >= out_bytes)
        return false;
    if (access(out_path, F_OK) == 0)
        return true;
    if (*reference == '/')
        return false;
    const char *slash = strrchr(scene_path, '/');
    int folder_length = slash ? (int)(slash - scene_path) + 1 : 0;
    for (int level = 0; level <= FL_FILES_PARENTS_MAX; level++) {
        static const char parents[] = "../../../../../../";
        _Static_assert(sizeof parents - 1 == 3 * FL_FILES_PARENTS_MAX, "one ../ a level");
        length = snprintf(out_path, out_bytes, "%.*s%.*s%s", folder_length, scene_path, 3 * level,
                          parents, reference);
        if (length < 0 || (size_t)length >= out_bytes)
            return false;
        if (access(out_path, F_OK) == 0)
            return true;
    }
    return false;
}

static fl_mesh *load_mesh(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)context;
    return fl_mesh_load(path, loc, diags);
}

static fl_image *load_image(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)context;
    return fl_image_load(path, loc, diags);
}

const fl_files fl_files_on_disk = {NULL, find, load_mesh, load_image};

/* Open for reading without waiting for the other end of a pipe. Returns -1 after adding an error.
 */
static int open_regular(const char *path, const char *what, size_t max_bytes, fl_loc loc,
                        fl_diags *diags, size_t *out_bytes)
{
    struct stat status;
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0 || fstat(file, &status) != 0) {
        fl_error(diags, loc, "cannot open %s '%s': %s", what, path, strerror(errno));
    } else if (S_ISDIR(status.st_mode)) {
        fl_error(diags, loc, "cannot read %s '%s': it is a folder", what, path);
    } else if (!S_ISREG(status.st_mode)) {
        fl_error(diags, loc, "cannot read %s '%s': it is not a regular file", what, path);
    } else if ((uintmax_t)status.st_size > max_bytes) {
        fl_error(diags, loc, "%s '%s' is too large: %jd bytes, at most %zu are read", what, path,
                 (intmax_t)status.st_size, max_bytes);
    } else {
        *out_bytes = (size_t)status.st_size;
        return file;
    }
    if (file >= 0)
        close(file);
    return -1;
}

bool fl_file_check(const char *path, const char *what, size_t max_bytes, fl_loc loc,
                   fl_diags *diags, size_t *out_bytes)
{
    int file = open_regular(path, what, max_bytes, loc, diags, out_bytes);
    if (file < 0)
        return false;
    close(file);
    return true;
}

char *fl_file_load(const char *path, const char *what, size_t max_bytes, fl_loc loc,
                   fl_diags *diags, size_t *out_bytes)
{
    size_t bytes, got = 0;
    int file = open_regular(path, what, max_bytes, loc, diags, &bytes);
    if (file < 0)
        return NULL;
    char *text = malloc(bytes + 1);
    if (!text) {
        fl_out_of_memory(diags, path);
        close(file);
        return NULL;
    }
    while (got < bytes) {
        ssize_t n = read(file, text + got, bytes - got);
        if (n > 0) {
            got += (size_t)n;
        } else if (n == 0) {
            break; /* It shrank meanwhile: what is there is read. */
        } else if (errno != EINTR) {
            fl_environment_error(diags, "cannot read %s '%s': %s", what, path, strerror(errno));
            free(text);
            close(file);
            return NULL;
        }
    }
    close(file);
    text[got] = '\0';
    *out_bytes = got;
    return text;
}

/* Length of the part of `path` before its last component: 0, or up to and with the last slash. */
static int folder_bytes(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (int)(slash - path) + 1 : 0;
}

static bool write_all(int file, const void *data, size_t bytes)
{
    const char *at = data;
    while (bytes > 0) {
        ssize_t n = write(file, at, bytes);
        if (n < 0 && errno != EINTR)
            return false;
        if (n > 0) {
            at += n;
            bytes -= (size_t)n;
        }
    }
    return true;
}

/* Create a file that did not exist, hidden beside `target`. Returns -1 with errno set. */
static int create_beside(const char *target, mode_t mode, char temp_path[PATH_MAX])
{
    for (int i = 0; i < TEMP_NAMES_MAX; i++) {
        int length = snprintf(temp_path, PATH_MAX, "%.*s.firstlight-%ld-%d.tmp",
                              folder_bytes(target), target, (long)getpid(), i);
        if (length < 0 || length >= PATH_MAX) {
            errno = ENAMETOOLONG;
            return -1;
        }
        int file = open(temp_path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (file >= 0 || errno != EEXIST)
            return file;
    }
    return -1;
}

/* Make the renaming itself last. Some file systems cannot synchronise a folder: not an error. */
static void sync_folder(const char *target)
{
    char folder[PATH_MAX];
    int length = snprintf(folder, sizeof folder, "%.*s.", folder_bytes(target), target);
    if (length < 0 || length >= (int)sizeof folder)
        return;
    int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0)
        return;
    (void)fsync(file);
    close(file);
}

bool fl_file_save(const char *path, const void *data, size_t bytes, fl_diags *diags)
{
    char resolved[PATH_MAX], temp_path[PATH_MAX];
    const char *target = path;
    mode_t mode = 0666;
    struct stat status;
    if (stat(path, &status) == 0) {
        if (!S_ISREG(status.st_mode))
            return fl_environment_error(diags, "cannot write '%s': it is not a regular file", path);
        if (!realpath(path, resolved) || access(resolved, W_OK) != 0)
            return fl_environment_error(diags, "cannot write '%s': %s", path, strerror(errno));
        target = resolved;
        mode = status.st_mode & 0777;
    }
    int file = create_beside(target, mode, temp_path);
    if (file < 0)
        return fl_environment_error(diags, "cannot write '%s': %s", path, strerror(errno));
    bool is_written = write_all(file, data, bytes) && fsync(file) == 0;
    int reason = errno;
    if (close(file) != 0 && is_written) {
        is_written = false;
        reason = errno;
    }
    if (is_written && rename(temp_path, target) != 0) {
        is_written = false;
        reason = errno;
    }
    if (!is_written) {
        unlink(temp_path);
        return fl_environment_error(diags, "cannot write '%s': %s", path, strerror(reason));
    }
    sync_folder(target);
    return true;
}
