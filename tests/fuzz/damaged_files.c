/* SPDX-License-Identifier: MIT
 *
 * Files that other libraries decode inside our process, damaged: every one must be read or refused
 * with a located error. A child decodes them; when one ends it, or takes too long or too much
 * memory, its file is kept. usage: damaged_files pictures|meshes [RUNS [FIRST [KEEP_FOLDER
 * [PART_OF_NAME]]]]
 */
#define _DEFAULT_SOURCE
#include <dirent.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fuzz/check_mesh.h"
#include "fuzz/damage.h"
#include "fuzz/good_files.h"
#include "io/files.h"
#include "io/image_file.h"
#include "io/mesh_file.h"

enum {
    FILES_MAX = 40,
    ROOM = 65536,
    BATCH = 5000,
    SECONDS_MAX = 5,
    FAILED_MAX = 10,
    PATH_BYTES = 512
};
#define MEMORY_MAX ((size_t)512 << 20)

typedef struct good_file {
    char name[32];
    uint8_t *data;
    size_t bytes;
} good_file;

/* What parent and child both see. */
typedef struct tally {
    uint32_t at;
    bool is_memory;
    long most_memory;
    double most_seconds;
    uint32_t read[FILES_MAX], refused[FILES_MAX];
} tally;

static good_file files[FILES_MAX];
static uint32_t file_count;
static char folder[PATH_BYTES] = "/tmp/firstlight-damaged-XXXXXX";
static tally *shared;
static bool is_mesh;

/* ---- One file ---- */

static bool load_picture(const char *path, fl_diags *diags)
{
    fl_image *image = fl_image_load(path, (fl_loc){.file = path}, diags);
    if (!image)
        return false;
    MUST(image->width >= 1 && image->height >= 1);
    MUST(image->width <= FL_IMAGE_SIDE_MAX && image->height <= FL_IMAGE_SIDE_MAX);
    size_t bytes = fl_image_bytes(image);
    MUST(bytes <= FL_IMAGE_MAX_BYTES);
    if (image->format == FL_PIXEL_FLOAT)
        for (size_t i = 0; i < bytes / sizeof(float); i++)
            MUST(isfinite(((const float *)image->pixels)[i]));
    fl_image_release(image);
    return true;
}

static bool load_mesh(const char *path, fl_diags *diags)
{
    fl_mesh *mesh = fl_mesh_load(path, (fl_loc){.file = path}, diags);
    if (!mesh)
        return false;
    check_mesh(mesh);
    fl_mesh_release(mesh);
    return true;
}

/* Number `number` of all damaged files, in the folder. */
static void make_file(uint32_t number, char path[PATH_BYTES])
{
    static uint8_t data[ROOM];
    const good_file *from = &files[number % file_count],
                    *other = &files[fl_hash_step(number, 5) % file_count];
    memcpy(data, from->data, from->bytes);
    size_t bytes =
        damage_bytes(data, from->bytes, ROOM, other->data, other->bytes, number / file_count);
    snprintf(path, PATH_BYTES, "%.200s/damaged%s", folder, strchr(from->name, '.'));
    FILE *file = fopen(path, "wb");
    MUST(file && fwrite(data, 1, bytes, file) == bytes && fclose(file) == 0);
}

static double seconds_used(long *out_kilobytes)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    *out_kilobytes = usage.ru_maxrss;
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static void decode_one(uint32_t number)
{
    char path[PATH_BYTES];
    long before, after;
    const struct itimerval limit = {.it_value.tv_sec = SECONDS_MAX};
    shared->at = number;
    make_file(number, path);
    double start = seconds_used(&before);
    setitimer(ITIMER_PROF, &limit, NULL);
    fl_diags diags = {0};
    bool is_fine = is_mesh ? load_mesh(path, &diags) : load_picture(path, &diags);
    MUST(is_fine == (diags.error_count == 0));
    fl_diags_deinit(&diags);
    shared->most_seconds = fl_max(shared->most_seconds, seconds_used(&after) - start);
    shared->most_memory = after > shared->most_memory ? after : shared->most_memory;
    (is_fine ? shared->read : shared->refused)[number % file_count]++;
    shared->is_memory = (size_t)(after - before) * 1024 > MEMORY_MAX;
    if (shared->is_memory)
        _exit(2);
}

/* ---- All of them ---- */

static bool keep(uint32_t number, const char *how, const char *keep_folder)
{
    char from[PATH_BYTES], command[3 * PATH_BYTES];
    make_file(number, from);
    fprintf(stderr, "%s: damaged file %u: %s\n", files[number % file_count].name, number, how);
    if (!keep_folder)
        return false;
    snprintf(command, sizeof command, "cp '%s' '%s/%u-%s'", from, keep_folder, number,
             files[number % file_count].name);
    return system(command) == 0;
}

static uint32_t decode_all(uint32_t first, uint32_t end, const char *keep_folder)
{
    uint32_t failed = 0;
    for (uint32_t next = first; next < end && failed < FAILED_MAX;) {
        uint32_t stop = fl_min_u32(end, next + BATCH);
        int status;
        shared->is_memory = false;
        pid_t child = fork();
        MUST(child >= 0);
        if (child == 0) {
            for (uint32_t number = next; number < stop; number++)
                decode_one(number);
            _exit(0);
        }
        MUST(waitpid(child, &status, 0) == child);
        next = stop;
        if (status != 0) {
            keep(shared->at,
                 shared->is_memory     ? "takes too much memory"
                 : WIFSIGNALED(status) ? strsignal(WTERMSIG(status))
                                       : "ends the process",
                 keep_folder);
            failed++;
            next = shared->at + 1;
        }
    }
    return failed;
}

/* Whether a child says so: the library starts threads, which no later child of this process would
 * have. */
static bool is_so_apart(bool (*says)(const char *path), const char *path)
{
    int status;
    pid_t child = fork();
    MUST(child >= 0);
    if (child == 0)
        _exit(!says(path));
    return waitpid(child, &status, 0) == child && status == 0;
}

static bool write_good_files(const char *path)
{
    return is_mesh ? good_meshes(path) : good_pictures(path);
}

static bool is_read(const char *path)
{
    fl_diags diags = {0};
    bool is_fine = is_mesh ? load_mesh(path, &diags) : load_picture(path, &diags);
    for (uint32_t k = 0; k < diags.count; k++)
        fprintf(stderr, "%s\n", diags.items[k].message);
    return is_fine;
}

/* The good files whose names contain `part`; undamaged, all are read. */
static void make_good_files(const char *part)
{
    struct dirent **entries;
    MUST(mkdtemp(folder) && is_so_apart(write_good_files, folder));
    int count = scandir(folder, &entries, NULL, alphasort);
    MUST(count >= 0);
    for (int i = 0; i < count; i++) {
        char path[PATH_BYTES];
        fl_diags diags = {0};
        snprintf(path, sizeof path, "%.200s/%.255s", folder, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.' && strstr(entries[i]->d_name, part)) {
            MUST(file_count < FILES_MAX && is_so_apart(is_read, path));
            good_file *file = &files[file_count++];
            snprintf(file->name, sizeof file->name, "%.30s", entries[i]->d_name);
            file->data =
                (uint8_t *)fl_file_load(path, "file", ROOM, (fl_loc){0}, &diags, &file->bytes);
            MUST(file->data);
        }
        free(entries[i]);
    }
    free(entries);
    MUST(file_count > 0);
}

int main(int argc, char **argv)
{
    is_mesh = argc > 1 && strcmp(argv[1], "meshes") == 0;
    uint32_t runs = argc > 2 ? (uint32_t)atoi(argv[2]) : 2000,
             first = argc > 3 ? (uint32_t)atoi(argv[3]) : 0;
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    MUST(shared != MAP_FAILED);
    make_good_files(argc > 5 ? argv[5] : "");
    uint32_t failed = decode_all(first, first + runs, argc > 4 ? argv[4] : NULL);
    for (uint32_t i = 0; i < file_count; i++)
        printf("%-12s %5u read, %5u refused\n", files[i].name, shared->read[i], shared->refused[i]);
    struct rusage usage;
    getrusage(RUSAGE_CHILDREN, &usage);
    printf("%u files, %u failed; %ld s, the longest %.2f s; %ld MB at most\n", runs, failed,
           (long)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec), shared->most_seconds,
           shared->most_memory / 1024);
    for (uint32_t i = 0; i < file_count; i++)
        free(files[i].data);
    char command[PATH_BYTES + 16];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command) != 0 || failed > 0;
}
