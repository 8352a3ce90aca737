/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* realpath */
#include "viewer/watch.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

enum { EVENT_BYTES = 16384 };

#define IN_FOLDER (IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_DELETE_SELF | IN_MOVE_SELF)
#define GONE      (IN_DELETE_SELF | IN_MOVE_SELF | IN_UNMOUNT | IN_IGNORED)

typedef struct watched {
    int folder;       /* The kernel's number. */
    char *path;       /* Of the file, or of the folder on the way to it that is not there yet. */
    const char *name; /* Its last part, within path. */
} watched;

struct vw_watch {
    void (*notify)(void *context);
    void *context;
    int inotify, quit[2]; /* Descriptors; a byte in the pipe ends the thread. */
    pthread_t thread;
    atomic_bool has_changed;
    pthread_mutex_t lock; /* Guards the list. */
    watched *files;
    size_t count;
};

/* What is created is whole only if it is a folder or a link; a file is written first. */
static bool is_whole(const watched *file, uint32_t mask)
{
    struct stat status;
    if (!(mask & IN_CREATE) || (mask & IN_ISDIR))
        return true;
    return lstat(file->path, &status) == 0 && (S_ISLNK(status.st_mode) || status.st_nlink > 1);
}

static bool is_change(vw_watch *watch, const struct inotify_event *event)
{
    bool is_found = (event->mask & IN_Q_OVERFLOW) != 0; /* Nobody knows what was lost. */
    pthread_mutex_lock(&watch->lock);
    for (size_t i = 0; i < watch->count && !is_found; i++) {
        const watched *file = &watch->files[i];
        if (file->folder != event->wd)
            continue;
        is_found = event->len > 0
                       ? strcmp(file->name, event->name) == 0 && is_whole(file, event->mask)
                       : (event->mask & GONE) != 0;
    }
    pthread_mutex_unlock(&watch->lock);
    return is_found;
}

static void tell(vw_watch *watch)
{
    atomic_store(&watch->has_changed, true);
    watch->notify(watch->context);
}

static void read_events(vw_watch *watch)
{
    _Alignas(struct inotify_event) char buffer[EVENT_BYTES];
    ssize_t bytes = read(watch->inotify, buffer, sizeof buffer);
    bool has_changed = false;
    for (ssize_t at = 0; at < bytes;) {
        struct inotify_event event;
        memcpy(&event, buffer + at, sizeof event);
        has_changed |= is_change(watch, (const struct inotify_event *)(void *)(buffer + at));
        at += (ssize_t)(sizeof event + event.len);
    }
    if (has_changed)
        tell(watch);
}

static void *thread_main(void *context)
{
    vw_watch *watch = context;
    struct pollfd waits[2] = {{.fd = watch->inotify, .events = POLLIN},
                              {.fd = watch->quit[0], .events = POLLIN}};
    while (poll(waits, 2, -1) >= 0 && !waits[1].revents)
        if (waits[0].revents)
            read_events(watch);
    return NULL;
}

vw_watch *vw_watch_create(void (*notify)(void *context), void *context)
{
    vw_watch *watch = calloc(1, sizeof *watch);
    if (!watch)
        return NULL;
    watch->notify = notify;
    watch->context = context;
    atomic_init(&watch->has_changed, false);
    pthread_mutex_init(&watch->lock, NULL);
    watch->quit[0] = watch->quit[1] = -1;
    watch->inotify = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
    if (watch->inotify >= 0 && pipe(watch->quit) == 0 &&
        pthread_create(&watch->thread, NULL, thread_main, watch) == 0)
        return watch;
    const int descriptors[] = {watch->inotify, watch->quit[0], watch->quit[1]};
    for (size_t i = 0; i < FL_COUNT_OF(descriptors); i++)
        if (descriptors[i] >= 0)
            close(descriptors[i]);
    pthread_mutex_destroy(&watch->lock);
    free(watch);
    return NULL;
}

static void forget(watched *files, size_t count)
{
    for (size_t i = 0; i < count; i++)
        free(files[i].path);
    free(files);
}

void vw_watch_destroy(vw_watch *watch)
{
    if (!watch)
        return;
    /* Closing the writing end wakes the thread. */
    close(watch->quit[1]);
    pthread_join(watch->thread, NULL);
    close(watch->quit[0]);
    close(watch->inotify);
    forget(watch->files, watch->count);
    pthread_mutex_destroy(&watch->lock);
    free(watch);
}

/* Watch the folder of the file, or the nearest there is, for the next part of the way. False: it
 * cannot be watched. */
static bool watch_file(int inotify, const char *path, watched *out)
{
    size_t bytes = strlen(path) + 1;
    *out = (watched){.folder = -1, .path = malloc(bytes)};
    if (!out->path)
        return false;
    memcpy(out->path, path, bytes);
    for (bool goes_on = true; goes_on;) {
        char *slash = strrchr(out->path, '/');
        const char *folder = !slash ? "." : slash == out->path ? "/" : out->path;
        out->name = slash ? slash + 1 : out->path;
        if (slash)
            *slash = 0;
        out->folder = inotify_add_watch(inotify, folder, IN_FOLDER | IN_ONLYDIR);
        if (out->folder >= 0) {
            if (slash)
                *slash = '/';
            return true;
        }
        goes_on = slash && slash != out->path && (errno == ENOENT || errno == ENOTDIR);
    }
    free(out->path);
    return false;
}

static bool is_same_file(const watched *a, const watched *b)
{
    return a->folder == b->folder && strcmp(a->name, b->name) == 0;
}

/* As named, and where that leads. Returns how many entries were written. */
static size_t watch_name(int inotify, const char *path, watched out[2])
{
    size_t count = watch_file(inotify, path, &out[0]);
    char *real = realpath(path, NULL);
    if (real && watch_file(inotify, real, &out[count])) {
        if (count > 0 && is_same_file(&out[0], &out[1]))
            free(out[1].path);
        else
            count++;
    }
    free(real);
    return count;
}

/* Of the state of a file, not its contents: one that was renamed to its place is new there. */
static bool has_changed_since(const watched *file, const struct timespec *begin)
{
    struct stat status;
    if (lstat(file->path, &status) != 0)
        return false;
    return status.st_ctim.tv_sec > begin->tv_sec ||
           (status.st_ctim.tv_sec == begin->tv_sec && status.st_ctim.tv_nsec >= begin->tv_nsec);
}

void vw_watch_set(vw_watch *watch, const fl_file_list *list)
{
    watched *files = watch && list->count > 0 ? calloc(2 * list->count, sizeof *files) : NULL;
    if (!files)
        return;
    size_t used = 0;
    for (size_t i = 0; i < list->count; i++)
        used += watch_name(watch->inotify, list->paths[i], &files[used]);
    pthread_mutex_lock(&watch->lock);
    watched *old = watch->files;
    size_t old_count = watch->count;
    watch->files = files;
    watch->count = used;
    pthread_mutex_unlock(&watch->lock);
    bool has_changed = false;
    for (size_t i = 0; i < used && !has_changed; i++) {
        bool is_known = false;
        for (size_t j = 0; j < old_count && !is_known; j++)
            is_known = is_same_file(&files[i], &old[j]);
        has_changed = !is_known && has_changed_since(&files[i], &list->begin);
    }
    if (has_changed)
        tell(watch);
    /* Folders no longer needed are let go. */
    for (size_t i = 0; i < old_count; i++) {
        bool is_needed = false;
        for (size_t j = 0; j < used; j++)
            is_needed |= files[j].folder == old[i].folder;
        for (size_t j = 0; j < i; j++)
            is_needed |= old[j].folder == old[i].folder; /* Done already. */
        if (!is_needed)
            inotify_rm_watch(watch->inotify, old[i].folder);
    }
    forget(old, old_count);
}

bool vw_watch_take(vw_watch *watch)
{
    return watch && atomic_exchange(&watch->has_changed, false);
}
