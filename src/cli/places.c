/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* realpath */
#include "cli/places.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/module.h"
#include "io/path.h"

bool cli_data_find(const char *name, char out[PATH_MAX])
{
    /* From PREFIX/bin, or build/PRESET of a checkout. */
    static const char *const roots[] = {"../share/firstlight/", "../../"};
    char found[FL_MODULE_PATH_BYTES];
    bool is_here = access(name, R_OK) == 0;
    if (!is_here && fl_program_find(roots, FL_COUNT_OF(roots), name, found) &&
        snprintf(out, PATH_MAX, "%s", found) < PATH_MAX)
        return true;
    return snprintf(out, PATH_MAX, "%s", name) < PATH_MAX && is_here;
}

/* The folder that the last component of `path` stands in. False: too long. */
static bool folder_of(const char *path, char out[PATH_MAX])
{
    return snprintf(out, PATH_MAX, "%.*s.", fl_path_folder_bytes(path), path) < PATH_MAX;
}

static bool refuse(const char *path, const char *why, fl_diags *diags)
{
    return fl_environment_error(diags, "cannot write '%s': %s", path, why);
}

bool cli_place_check(const char *path, fl_diags *diags)
{
    struct stat there;
    char resolved[PATH_MAX], folder[PATH_MAX];
    bool is_there = stat(path, &there) == 0;
    if (!is_there && errno != ENOENT)
        return refuse(path, strerror(errno), diags);
    if (is_there && S_ISDIR(there.st_mode))
        return refuse(path, "it is a folder", diags);
    if (is_there && !S_ISREG(there.st_mode))
        return true;
    if (is_there && (access(path, W_OK) != 0 || !realpath(path, resolved)))
        return refuse(path, strerror(errno), diags);
    /* Files are replaced, not written over: their folder matters too. */
    if (!folder_of(is_there ? resolved : path, folder))
        return refuse(path, strerror(ENAMETOOLONG), diags);
    if (stat(folder, &there) != 0)
        return refuse(path, errno == ENOENT ? "there is no such folder" : strerror(errno), diags);
    return access(folder, W_OK | X_OK) == 0 || refuse(path, strerror(errno), diags);
}

bool cli_folder_open(const char *path, fl_diags *diags)
{
    struct stat there;
    int reason = mkdir(path, 0777) == 0 ? 0 : errno;
    if (reason == EEXIST)
        reason = stat(path, &there) != 0 ? errno : S_ISDIR(there.st_mode) ? 0 : ENOTDIR;
    if (reason == 0 && access(path, W_OK | X_OK) != 0)
        reason = errno;
    return reason == 0 ||
           fl_environment_error(diags, "cannot write into folder '%s': %s", path, strerror(reason));
}

static bool is_same_file(const char *a, const char *b)
{
    struct stat left, right;
    return stat(a, &left) == 0 && stat(b, &right) == 0 && left.st_dev == right.st_dev &&
           left.st_ino == right.st_ino;
}

bool cli_places_are_same(const char *a, const char *b)
{
    char left[PATH_MAX], right[PATH_MAX];
    if (strcmp(a, b) == 0 || is_same_file(a, b))
        return true;
    return strcmp(fl_path_name(a), fl_path_name(b)) == 0 && folder_of(a, left) &&
           folder_of(b, right) && is_same_file(left, right);
}
