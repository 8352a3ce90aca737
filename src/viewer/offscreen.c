/* SPDX-License-Identifier: MIT */
#include "viewer/offscreen.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

bool vw_offscreen_find(void *library, const char *name, void *out_function, size_t bytes)
{
    void *symbol = dlsym(library, name);
    memcpy(out_function, &symbol, bytes);
    return symbol != NULL;
}

static bool init_waiting(vw_offscreen *offscreen)
{
    pthread_condattr_t attributes;
    if (pthread_mutex_init(&offscreen->mutex, NULL) != 0)
        return false;
    bool is_ready = pthread_condattr_init(&attributes) == 0;
    if (is_ready) {
        is_ready = pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC) == 0 &&
                   pthread_cond_init(&offscreen->woken, &attributes) == 0;
        pthread_condattr_destroy(&attributes);
    }
    if (!is_ready)
        pthread_mutex_destroy(&offscreen->mutex);
    return is_ready;
}

static void destroy(vw_platform *platform)
{
    vw_offscreen *offscreen = (vw_offscreen *)platform;
    offscreen->kind->close(platform);
    pthread_cond_destroy(&offscreen->woken);
    pthread_mutex_destroy(&offscreen->mutex);
    vw_event_queue_deinit(&offscreen->base.events);
    free(offscreen->clipboard);
    free(offscreen);
}

static void pump(vw_platform *platform, double timeout_s)
{
    vw_offscreen *offscreen = (vw_offscreen *)platform;
    if (platform->events.count > 0)
        return;
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    if (timeout_s > 0.0) {
        double seconds = floor(timeout_s);
        until.tv_sec += (time_t)seconds;
        until.tv_nsec += (long)((timeout_s - seconds) * 1e9);
        if (until.tv_nsec >= 1000000000L) {
            until.tv_sec++;
            until.tv_nsec -= 1000000000L;
        }
    }
    pthread_mutex_lock(&offscreen->mutex);
    int error = 0;
    while (!offscreen->is_awake && timeout_s != 0.0 && error == 0)
        error = timeout_s < 0.0
                    ? pthread_cond_wait(&offscreen->woken, &offscreen->mutex)
                    : pthread_cond_timedwait(&offscreen->woken, &offscreen->mutex, &until);
    offscreen->is_awake = false;
    pthread_mutex_unlock(&offscreen->mutex);
}

static void wake(vw_platform *platform)
{
    vw_offscreen *offscreen = (vw_offscreen *)platform;
    pthread_mutex_lock(&offscreen->mutex);
    offscreen->is_awake = true;
    pthread_cond_signal(&offscreen->woken);
    pthread_mutex_unlock(&offscreen->mutex);
}

static void framebuffer_size(vw_platform *platform, uint32_t *out_width, uint32_t *out_height)
{
    *out_width = ((vw_offscreen *)platform)->width;
    *out_height = ((vw_offscreen *)platform)->height;
}

static const char *clipboard(vw_platform *platform)
{
    return ((vw_offscreen *)platform)->clipboard;
}

static void set_clipboard(vw_platform *platform, const char *text)
{
    vw_offscreen *offscreen = (vw_offscreen *)platform;
    size_t bytes = strlen(text) + 1;
    char *copy = malloc(bytes);
    if (!copy)
        return;
    memcpy(copy, text, bytes);
    free(offscreen->clipboard);
    offscreen->clipboard = copy;
}

static void set_title(vw_platform *platform, const char *title)
{
    (void)platform;
    (void)title;
}

static const char *key_label(vw_platform *platform, int key)
{
    (void)platform;
    (void)key;
    return NULL;
}

static void swap(vw_platform *platform)
{
    (void)platform;
}

static bool resize(vw_platform *platform, uint32_t width, uint32_t height, fl_diags *diags)
{
    vw_offscreen *offscreen = (vw_offscreen *)platform;
    if (!offscreen->kind->set_size(platform, width, height, diags))
        return false;
    offscreen->width = width;
    offscreen->height = height;
    return true;
}

vw_platform *vw_offscreen_create(const vw_offscreen_kind *kind, const vw_window_desc *desc,
                                 fl_diags *diags)
{
    vw_offscreen *offscreen = calloc(1, kind->bytes);
    if (!offscreen || !init_waiting(offscreen)) {
        free(offscreen);
        fl_out_of_memory(diags, "the offscreen window");
        return NULL;
    }
    offscreen->kind = kind;
    offscreen->ops = (vw_platform_ops){.name = kind->ops.name,
                                       .destroy = destroy,
                                       .pump = pump,
                                       .wake = wake,
                                       .swap = swap,
                                       .framebuffer_size = framebuffer_size,
                                       .get_proc = kind->ops.get_proc,
                                       .clipboard = clipboard,
                                       .set_clipboard = set_clipboard,
                                       .set_title = set_title,
                                       .key_label = key_label,
                                       .resize = resize};
    offscreen->base.ops = &offscreen->ops;
    if (kind->open(&offscreen->base, diags) &&
        resize(&offscreen->base, desc->width, desc->height, diags))
        return &offscreen->base;
    destroy(&offscreen->base);
    return NULL;
}
