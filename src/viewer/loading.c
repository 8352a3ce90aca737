/* SPDX-License-Identifier: MIT */
#include "viewer/loading.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct vw_loading {
    const vw_loader *loader;
    void (*notify)(void *context);
    void *context;
    pthread_t thread;
    pthread_mutex_t lock; /* Guards what follows. */
    pthread_cond_t asked;
    bool has_wish, has_result, is_reading, should_quit;
    char wish[VW_PATH_MAX], path[VW_PATH_MAX]; /* Of the next load; of the result. */
    vw_scene scene;                            /* The result, not yet taken. */
    fl_diags diags;                            /* Its messages. */
};

void vw_scene_deinit(vw_scene *scene)
{
    fl_compiled_release(scene->compiled);
    fl_scene_destroy(scene->scene);
    fl_file_list_deinit(&scene->files);
    *scene = (vw_scene){0};
}

static void drop_result(vw_loading *loading)
{
    vw_scene_deinit(&loading->scene);
    fl_diags_deinit(&loading->diags);
    loading->diags = (fl_diags){0};
    loading->has_result = false;
}

/* The lock is held, except while reading. */
static void read_one(vw_loading *loading)
{
    char path[VW_PATH_MAX];
    vw_scene scene = {0};
    fl_diags diags = {0};
    memcpy(path, loading->wish, sizeof path);
    loading->has_wish = false;
    loading->is_reading = true;
    pthread_mutex_unlock(&loading->lock);
    loading->loader->load(loading->loader->context, path, &scene, &diags);
    pthread_mutex_lock(&loading->lock);
    drop_result(loading); /* Nobody took the one before: it is out of date. */
    loading->scene = scene;
    loading->diags = diags;
    memcpy(loading->path, path, sizeof path);
    loading->is_reading = false;
    loading->has_result = true;
}

static void *thread_main(void *argument)
{
    vw_loading *loading = argument;
    pthread_mutex_lock(&loading->lock);
    while (!loading->should_quit) {
        if (!loading->has_wish) {
            pthread_cond_wait(&loading->asked, &loading->lock);
            continue;
        }
        read_one(loading);
        pthread_mutex_unlock(&loading->lock);
        loading->notify(loading->context);
        pthread_mutex_lock(&loading->lock);
    }
    pthread_mutex_unlock(&loading->lock);
    return NULL;
}

vw_loading *vw_loading_create(const vw_loader *loader, void (*notify)(void *context), void *context,
                              fl_diags *diags)
{
    vw_loading *loading = calloc(1, sizeof *loading);
    if (!loading) {
        fl_out_of_memory(diags, "reading scenes");
        return NULL;
    }
    loading->loader = loader;
    loading->notify = notify;
    loading->context = context;
    pthread_mutex_init(&loading->lock, NULL);
    pthread_cond_init(&loading->asked, NULL);
    int error = pthread_create(&loading->thread, NULL, thread_main, loading);
    if (error == 0)
        return loading;
    fl_environment_error(diags, "cannot start the thread that reads scenes (error %d)", error);
    pthread_cond_destroy(&loading->asked);
    pthread_mutex_destroy(&loading->lock);
    free(loading);
    return NULL;
}

void vw_loading_destroy(vw_loading *loading)
{
    if (!loading)
        return;
    pthread_mutex_lock(&loading->lock);
    loading->should_quit = true;
    pthread_cond_signal(&loading->asked);
    pthread_mutex_unlock(&loading->lock);
    pthread_join(loading->thread, NULL);
    drop_result(loading);
    pthread_cond_destroy(&loading->asked);
    pthread_mutex_destroy(&loading->lock);
    free(loading);
}

void vw_loading_ask(vw_loading *loading, const char *path)
{
    pthread_mutex_lock(&loading->lock);
    snprintf(loading->wish, sizeof loading->wish, "%s", path);
    loading->has_wish = true;
    pthread_cond_signal(&loading->asked);
    pthread_mutex_unlock(&loading->lock);
}

bool vw_loading_take(vw_loading *loading, vw_scene *out_scene, char *out_path, fl_diags *diags)
{
    pthread_mutex_lock(&loading->lock);
    bool is_there = loading->has_result;
    if (is_there) {
        *out_scene = loading->scene;
        memcpy(out_path, loading->path, VW_PATH_MAX);
        fl_diags_deinit(diags);
        *diags = loading->diags;
        loading->scene = (vw_scene){0};
        loading->diags = (fl_diags){0};
        loading->has_result = false;
    }
    pthread_mutex_unlock(&loading->lock);
    return is_there;
}

bool vw_loading_is_busy(vw_loading *loading)
{
    pthread_mutex_lock(&loading->lock);
    bool is_busy = loading->has_wish || loading->is_reading || loading->has_result;
    pthread_mutex_unlock(&loading->lock);
    return is_busy;
}
