/* SPDX-License-Identifier: MIT */
#include "core/refine.h"

#include <pthread.h>
#include <stdlib.h>

struct fl_refine {
    fl_compiled *quick; /* The thread's own reference. */
    fl_pool *pool;
    void (*done)(void *context, fl_compiled *refined);
    void *context;
    pthread_t thread;
    pthread_mutex_t lock; /* Guards what follows. */
    bool is_busy;
    fl_compiled *refined; /* Not yet taken. */
};

static void *thread_main(void *argument)
{
    fl_refine *refine = argument;
    fl_diags diags = {0}; /* Nothing can go wrong but memory, and then all stays as it is. */
    fl_compiled *refined = fl_compile_refine(refine->quick, refine->pool, &diags);
    fl_diags_deinit(&diags);
    fl_compiled_release(refine->quick);
    if (refined)
        fl_compiled_retain(refined);
    pthread_mutex_lock(&refine->lock);
    refine->refined = refined;
    refine->is_busy = false;
    pthread_mutex_unlock(&refine->lock);
    refine->done(refine->context, refined);
    fl_compiled_release(refined);
    return NULL;
}

fl_refine *fl_refine_start(fl_compiled *quick, uint32_t thread_count,
                           void (*done)(void *context, fl_compiled *refined), void *context,
                           fl_diags *diags)
{
    fl_refine *refine = calloc(1, sizeof *refine);
    uint32_t threads = (fl_thread_count(thread_count) + 1) / 2;
    fl_pool *pool = refine ? fl_pool_create(threads, diags) : NULL;
    if (!pool) {
        if (!refine)
            fl_out_of_memory(diags, "refining the hierarchy");
        free(refine);
        return NULL;
    }
    *refine = (fl_refine){.quick = fl_compiled_retain(quick),
                          .pool = pool,
                          .done = done,
                          .context = context,
                          .is_busy = true};
    pthread_mutex_init(&refine->lock, NULL);
    int error = pthread_create(&refine->thread, NULL, thread_main, refine);
    if (error == 0)
        return refine;
    fl_environment_error(diags, "cannot start the thread that refines the hierarchy (error %d)",
                         error);
    pthread_mutex_destroy(&refine->lock);
    fl_compiled_release(quick);
    fl_pool_destroy(pool);
    free(refine);
    return NULL;
}

fl_compiled *fl_refine_take(fl_refine *refine)
{
    pthread_mutex_lock(&refine->lock);
    fl_compiled *refined = refine->refined;
    refine->refined = NULL;
    pthread_mutex_unlock(&refine->lock);
    return refined;
}

bool fl_refine_is_busy(fl_refine *refine)
{
    if (!refine)
        return false;
    pthread_mutex_lock(&refine->lock);
    bool is_busy = refine->is_busy;
    pthread_mutex_unlock(&refine->lock);
    return is_busy;
}

void fl_refine_destroy(fl_refine *refine)
{
    if (!refine)
        return;
    fl_pool_cancel(refine->pool);
    pthread_join(refine->thread, NULL);
    fl_pool_destroy(refine->pool);
    pthread_mutex_destroy(&refine->lock);
    fl_compiled_release(refine->refined);
    free(refine);
}
