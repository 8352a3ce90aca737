/* SPDX-License-Identifier: MIT
 *
 * The program fl_assimp: reads one mesh by assimp and writes it to its standard output, as
 * mesh_apart.h says. Takes no more processor time and memory than a file of that size may need.
 * usage: fl_assimp FILE
 */
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "io/assimp_mesh.h"
#include "io/mesh_apart.h"

/* What any file may use, and what each of its bytes adds. Sound meshes of 700,000 triangles took 3
 * to 7 bytes of memory a byte of the file, and a second for 20 to 60 MB. */
#define MEMORY_BASE     ((rlim_t)512 << 20)
#define MEMORY_PER_BYTE ((rlim_t)32)
enum { SECONDS_BASE = 5, BYTES_PER_SECOND = 1 << 20 };

/* Sanitizers map more than any limit; and what crashes must end as it does without them. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define FL_HAS_SHADOW
__attribute__((visibility("default"))) const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "handle_segv=0:abort_on_error=1:detect_leaks=0";
}
#endif

static void limit(int what, rlim_t most)
{
    const struct rlimit both = {most, most + 1}; /* the signal first, which says why */
    (void)setrlimit(what, &both);
}

static void limit_all(size_t bytes)
{
#ifndef FL_HAS_SHADOW
    limit(RLIMIT_AS, MEMORY_BASE + MEMORY_PER_BYTE * bytes);
#endif
    limit(RLIMIT_CPU, SECONDS_BASE + bytes / BYTES_PER_SECOND);
    limit(RLIMIT_CORE, 0);
}

static bool put(const void *data, size_t item_bytes, uint32_t count)
{
    return count == 0 || fwrite(data, item_bytes, count, stdout) == count;
}

static bool put_mesh(const fl_mesh *mesh)
{
    const fl_mesh_head head = {.position_count = mesh->position_count,
                               .normal_count = mesh->normal_count,
                               .uv_count = mesh->uv_count,
                               .face_count = mesh->face_count};
    return put(&head, sizeof head, 1) &&
           put(mesh->positions, sizeof *mesh->positions, mesh->position_count) &&
           put(mesh->normals, sizeof *mesh->normals, mesh->normal_count) &&
           put(mesh->uvs, sizeof *mesh->uvs, mesh->uv_count) &&
           put(mesh->faces, sizeof *mesh->faces, mesh->face_count);
}

static bool put_message(const fl_diag *error)
{
    size_t bytes = strlen(error->message);
    bytes = bytes < FL_MESH_MESSAGE_BYTES ? bytes : FL_MESH_MESSAGE_BYTES - 1;
    const fl_mesh_head head = {.message_bytes = (uint32_t)bytes, .cause = error->cause};
    return put(&head, sizeof head, 1) && put(error->message, 1, (uint32_t)bytes);
}

int main(int argc, char **argv)
{
    sigset_t none;
    struct stat status;
    fl_diags diags = {0};
    if (argc != 2 || stat(argv[1], &status) != 0)
        return 2;
    /* The one who asked decides what an interrupt means, and takes this program along. */
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    signal(SIGINT, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    limit_all((size_t)status.st_size);
    fl_mesh *mesh = fl_mesh_load_assimp(argv[1], (size_t)status.st_size, &diags);
    bool is_written = mesh ? put_mesh(mesh) : put_message(&diags.items[0]);
    fl_mesh_release(mesh);
    fl_diags_deinit(&diags);
    return fflush(stdout) != 0 || !is_written;
}
