/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE /* pipe2 */
#include "io/mesh_apart.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/files.h"
#include "io/mesh_file.h"
#include "io/module.h"

/* Start the reader; -1: with errno set. Its complaints on the terminal are of no use to anyone. */
static pid_t start(const char *program, const char *path, int *out_pipe)
{
    int ends[2];
    pid_t child = -1;
    char *argv[] = {(char *)program, (char *)path, NULL};
    posix_spawn_file_actions_t actions;
    if (pipe2(ends, O_CLOEXEC) != 0)
        return -1;
    int wrong = posix_spawn_file_actions_init(&actions);
    if (wrong == 0) {
        (void)(posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0) == 0 &&
               posix_spawn_file_actions_adddup2(&actions, ends[1], 1) == 0 &&
               posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0) == 0);
        wrong = posix_spawn(&child, program, &actions, NULL, argv, environ);
        posix_spawn_file_actions_destroy(&actions);
    }
    close(ends[1]);
    if (wrong == 0) {
        *out_pipe = ends[0];
        return child;
    }
    close(ends[0]);
    errno = wrong;
    return -1;
}

static bool read_all(int file, void *out, size_t bytes)
{
    char *at = out;
    while (bytes > 0) {
        ssize_t n = read(file, at, bytes);
        if (n == 0 || (n < 0 && errno != EINTR))
            return false;
        at += n > 0 ? n : 0;
        bytes -= n > 0 ? (size_t)n : 0;
    }
    return true;
}

static bool read_array(int file, void *out_array, uint32_t count, size_t item_bytes,
                       bool *is_short_of_memory)
{
    void *array = malloc(((size_t)count + 1) * item_bytes);
    memcpy(out_array, &array, sizeof array);
    *is_short_of_memory = !array;
    return array && read_all(file, array, count * item_bytes);
}

static bool read_mesh(int file, const fl_mesh_head *head, fl_mesh *mesh, bool *is_short)
{
    uint32_t most = fl_max_u32(fl_max_u32(head->position_count, head->normal_count),
                               fl_max_u32(head->uv_count, head->face_count));
    if (most > FL_MESH_ELEMENTS_MAX)
        return false;
    mesh->position_count = head->position_count;
    mesh->normal_count = head->normal_count;
    mesh->uv_count = head->uv_count;
    mesh->face_count = head->face_count;
    return read_array(file, &mesh->positions, mesh->position_count, sizeof *mesh->positions,
                      is_short) &&
           read_array(file, &mesh->normals, mesh->normal_count, sizeof *mesh->normals, is_short) &&
           read_array(file, &mesh->uvs, mesh->uv_count, sizeof *mesh->uvs, is_short) &&
           read_array(file, &mesh->faces, mesh->face_count, sizeof *mesh->faces, is_short);
}

static bool are_indices(const uint32_t index[3], uint32_t count, bool may_miss)
{
    bool is_fine = true;
    for (int k = 0; k < 3; k++)
        is_fine = is_fine && (index[k] < count || (may_miss && index[k] == FL_NONE));
    return is_fine;
}

/* What is wrong with it, or NULL. */
static const char *find_fault(const fl_mesh *mesh)
{
    if (mesh->face_count == 0)
        return "no faces";
    for (uint32_t i = 0; i < mesh->position_count; i++)
        if (!fl_v3_is_finite(mesh->positions[i]))
            return "a vertex that is not finite";
    for (uint32_t i = 0; i < mesh->normal_count; i++)
        if (!fl_v3_is_finite(mesh->normals[i]))
            return "a normal that is not finite";
    for (uint32_t i = 0; i < mesh->uv_count; i++)
        if (!isfinite(mesh->uvs[i].u) || !isfinite(mesh->uvs[i].v))
            return "a texture coordinate that is not finite";
    for (uint32_t i = 0; i < mesh->face_count; i++) {
        const fl_face *face = &mesh->faces[i];
        if (!are_indices(face->position, mesh->position_count, false) ||
            !are_indices(face->normal, mesh->normal_count, true) ||
            !are_indices(face->uv, mesh->uv_count, true))
            return "a corner out of range";
    }
    return NULL;
}

static bool report_end(int status, const char *path, fl_loc loc, fl_diags *diags)
{
    if (!WIFSIGNALED(status))
        return fl_environment_error(diags, "cannot read mesh '%s': %s does not work here", path,
                                    FL_MESH_READER);
    if (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)
        return fl_error(diags, loc,
                        "cannot read mesh '%s': it takes longer than a file of its size needs, "
                        "and so is damaged",
                        path);
    return fl_error(diags, loc,
                    "cannot read mesh '%s': it is damaged, or of a kind that the mesh library "
                    "crashes on (%s)",
                    path, strsignal(WTERMSIG(status)));
}

/* Everything that comes out of the pipe. False: it ends too early, and nothing is said yet. */
static bool receive(int file, fl_mesh *mesh, const char *path, fl_loc loc, fl_diags *diags)
{
    fl_mesh_head head;
    char message[FL_MESH_MESSAGE_BYTES];
    if (!read_all(file, &head, sizeof head))
        return false;
    if (head.message_bytes > 0) {
        if (head.message_bytes >= sizeof message || !read_all(file, message, head.message_bytes))
            return false;
        message[head.message_bytes] = '\0';
        if (head.cause == FL_CAUSE_ENVIRONMENT)
            fl_environment_error(diags, "%s", message);
        else
            fl_error(diags, loc, "%s", message);
        return true;
    }
    bool is_short_of_memory = false;
    if (!read_mesh(file, &head, mesh, &is_short_of_memory)) {
        if (is_short_of_memory)
            fl_out_of_memory(diags, path);
        return is_short_of_memory;
    }
    const char *fault = find_fault(mesh);
    if (fault)
        fl_error(diags, loc, "mesh '%s' has %s", path, fault);
    return true;
}

fl_mesh *fl_mesh_load_apart(const char *path, fl_loc loc, fl_diags *diags)
{
    char program[FL_MODULE_PATH_BYTES];
    size_t bytes;
    int file, status = 0;
    uint32_t errors_before = diags->error_count;
    if (!fl_file_check(path, "mesh", FL_MESH_FILE_MAX_BYTES, loc, diags, &bytes))
        return NULL;
    if (!fl_module_find(FL_MESH_READER, program)) {
        fl_environment_error(diags, "cannot read mesh '%s': %s is not in or near %s", path,
                             FL_MESH_READER, program);
        return NULL;
    }
    fl_mesh *mesh = fl_mesh_create();
    pid_t child = mesh ? start(program, path, &file) : -1;
    if (child < 0) {
        if (mesh)
            fl_environment_error(diags, "cannot start %s: %s", program, strerror(errno));
        else
            fl_out_of_memory(diags, path);
        fl_mesh_release(mesh);
        return NULL;
    }
    bool is_whole = receive(file, mesh, path, loc, diags);
    close(file);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!is_whole)
        report_end(status, path, loc, diags);
    if (diags->error_count == errors_before)
        return mesh;
    fl_mesh_release(mesh);
    return NULL;
}
