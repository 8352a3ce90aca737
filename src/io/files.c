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
#include "io/path.h"

/* Names tried for the file written beside the target before giving up: a name is only taken when an
 * earlier process of the same number died in between. */
enum { TEMP_NAMES_MAX = 100 };
/* Links followed one after the other, as many as the system itself follows. */
enum { LINKS_MAX = 40 };

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
    int folder_length = fl_path_folder_bytes(scene_path);
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
                              fl_path_folder_bytes(target), target, (long)getpid(), i);
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
    int length = snprintf(folder, sizeof folder, "%.*s.", fl_path_folder_bytes(target), target);
    if (length < 0 || length >= (int)sizeof folder)
        return;
    int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0)
        return;
    (void)fsync(file);
    close(file);
}

/* Where a path that leads to no file ends, behind all links: there the file is made, as by open.
 * False with errno set. */
static bool find_end(const char *path, char out_end[PATH_MAX])
{
    char link[PATH_MAX];
    struct stat status;
    int length = snprintf(out_end, PATH_MAX, "%s", path);
    for (int links = 0; length >= 0 && length < PATH_MAX; links++) {
        if (lstat(out_end, &status) != 0)
            return errno == ENOENT;
        if (!S_ISLNK(status.st_mode))
            return true;
        ssize_t bytes = readlink(out_end, link, sizeof link - 1);
        if (bytes < 0 || links == LINKS_MAX) {
            errno = bytes < 0 ? errno : ELOOP;
            return false;
        }
        link[bytes] = '\0';
        int folder = link[0] == '/' ? 0 : fl_path_folder_bytes(out_end);
        length = folder + snprintf(out_end + folder, (size_t)(PATH_MAX - folder), "%s", link);
    }
    errno = ENAMETOOLONG;
    return false;
}

bool fl_file_save(const char *path, const void *data, size_t bytes, fl_diags *diags)
{
    char target[PATH_MAX], temp_path[PATH_MAX];
    struct stat status;
    bool is_there = stat(path, &status) == 0;
    if (is_there && !S_ISREG(status.st_mode))
        return fl_environment_error(diags, "cannot write '%s': it is not a regular file", path);
    bool has_target = is_there ? realpath(path, target) && access(target, W_OK) == 0
                               : errno == ENOENT && find_end(path, target);
    int file = has_target ? create_beside(target, is_there ? 0600 : 0666, temp_path) : -1;
    if (file < 0)
        return fl_environment_error(diags, "cannot write '%s': %s", path, strerror(errno));
    if (is_there) /* Where permissions cannot be set, they are not worth the picture. */
        (void)!fchmod(file, status.st_mode & 0777);
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
