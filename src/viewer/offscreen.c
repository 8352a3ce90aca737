/* SPDX-License-Identifier: MIT */
#include "viewer/offscreen.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

bool vw_offscreen_init(vw_offscreen *offscreen, const vw_platform_ops *ops,
                       const vw_window_desc *desc)
{
    offscreen->base.ops = ops;
    offscreen->width = desc->width;
    offscreen->height = desc->height;
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

void vw_offscreen_deinit(vw_offscreen *offscreen)
{
    pthread_cond_destroy(&offscreen->woken);
    pthread_mutex_destroy(&offscreen->mutex);
    vw_event_queue_deinit(&offscreen->base.events);
    free(offscreen->clipboard);
}

void vw_offscreen_pump(vw_platform *platform, double timeout_s)
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

void vw_offscreen_wake(vw_platform *platform)
{
    vw_offscreen *offscreen = (vw_offscreen *)platform;
    pthread_mutex_lock(&offscreen->mutex);
    offscreen->is_awake = true;
    pthread_cond_signal(&offscreen->woken);
    pthread_mutex_unlock(&offscreen->mutex);
}

void vw_offscreen_framebuffer_size(vw_platform *platform, uint32_t *out_width, uint32_t *out_height)
{
    *out_width = ((vw_offscreen *)platform)->width;
    *out_height = ((vw_offscreen *)platform)->height;
}

double vw_offscreen_content_scale(vw_platform *platform)
{
    (void)platform;
    return 1.0;
}

const char *vw_offscreen_clipboard(vw_platform *platform)
{
    return ((vw_offscreen *)platform)->clipboard;
}

void vw_offscreen_set_clipboard(vw_platform *platform, const char *text)
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

void vw_offscreen_set_title(vw_platform *platform, const char *title)
{
    (void)platform;
    (void)title;
}

const char *vw_offscreen_key_label(vw_platform *platform, int key)
{
    (void)platform;
    (void)key;
    return NULL;
}
