/* SPDX-License-Identifier: MIT */
#include "viewer/watch.h"

#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

enum { FOLDER_BYTES = 4096, EVENT_BYTES = 16384 };

typedef struct watched {
    int folder; /* The kernel's number. */
    char *name; /* Of the file in it. */
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

static bool is_watched(vw_watch *watch, const struct inotify_event *event)
{
    bool is_found = false;
    pthread_mutex_lock(&watch->lock);
    for (size_t i = 0; i < watch->count && !is_found && event->len > 0; i++)
        is_found =
            watch->files[i].folder == event->wd && strcmp(watch->files[i].name, event->name) == 0;
    pthread_mutex_unlock(&watch->lock);
    return is_found;
}

static void read_events(vw_watch *watch)
{
    _Alignas(struct inotify_event) char buffer[EVENT_BYTES];
    ssize_t bytes = read(watch->inotify, buffer, sizeof buffer);
    bool has_changed = false;
    for (ssize_t at = 0; at < bytes;) {
        struct inotify_event event;
        memcpy(&event, buffer + at, sizeof event);
        has_changed |= is_watched(watch, (const struct inotify_event *)(void *)(buffer + at));
        at += (ssize_t)(sizeof event + event.len);
    }
    if (has_changed) {
        atomic_store(&watch->has_changed, true);
        watch->notify(watch->context);
    }
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
        free(files[i].name);
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

/* The folder's watch and the name in it; false: it cannot be watched. */
static bool watch_file(int inotify, const char *path, watched *out)
{
    char folder[FOLDER_BYTES];
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    int length = slash == path ? 1 : slash ? (int)(slash - path) : 0;
    if (snprintf(folder, sizeof folder, "%.*s", length, path) >= (int)sizeof folder)
        return false;
    out->folder = inotify_add_watch(inotify, length ? folder : ".",
                                    IN_CLOSE_WRITE | IN_MOVED_TO | IN_ONLYDIR);
    size_t bytes = strlen(name) + 1;
    out->name = out->folder >= 0 ? malloc(bytes) : NULL;
    if (out->name)
        memcpy(out->name, name, bytes);
    return out->name != NULL;
}

void vw_watch_set(vw_watch *watch, const char *const *paths, size_t count)
{
    if (!watch)
        return;
    watched *files = calloc(count ? count : 1, sizeof *files);
    size_t used = 0;
    for (size_t i = 0; files && i < count; i++)
        used += watch_file(watch->inotify, paths[i], &files[used]);
    pthread_mutex_lock(&watch->lock);
    watched *old = watch->files;
    size_t old_count = watch->count;
    watch->files = files;
    watch->count = used;
    pthread_mutex_unlock(&watch->lock);
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
