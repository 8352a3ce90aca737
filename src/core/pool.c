/* SPDX-License-Identifier: MIT */
#include "core/pool.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct fl_loop {
    uint32_t count, grain;
    void (*body)(void *context, uint32_t begin, uint32_t end, uint32_t thread);
    void *context;
} fl_loop;

typedef struct fl_helper {
    fl_pool *pool;
    pthread_t thread;
    uint32_t index; /* 1 ...; 0 is the caller of a loop. */
} fl_helper;

struct fl_pool {
    pthread_mutex_t lock;
    pthread_cond_t begin, end;
    fl_loop loop;     /* Written under the lock before `number` changes. */
    uint64_t number;  /* Of the current loop; under the lock. */
    uint32_t running; /* Helpers that have not finished it; under the lock. */
    bool should_stop; /* Under the lock. */
    atomic_bool is_cancelled;
    atomic_uint_least64_t next; /* First index not handed out; 64 bits so that it cannot wrap. */
    uint32_t helper_count;
    fl_helper helpers[];
};

static void run_loop(const fl_pool *pool, const fl_loop *loop, atomic_uint_least64_t *next,
                     uint32_t thread)
{
    while (!fl_pool_is_cancelled(pool)) {
        uint64_t begin = atomic_fetch_add_explicit(next, loop->grain, memory_order_relaxed);
        if (begin >= loop->count)
            return;
        uint64_t end = begin + loop->grain;
        loop->body(loop->context, (uint32_t)begin, end < loop->count ? (uint32_t)end : loop->count,
                   thread);
    }
}

static void *helper_main(void *argument)
{
    fl_helper *helper = argument;
    fl_pool *pool = helper->pool;
    uint64_t seen = 0;
    pthread_mutex_lock(&pool->lock);
    for (;;) {
        while (!pool->should_stop && pool->number == seen)
            pthread_cond_wait(&pool->begin, &pool->lock);
        if (pool->should_stop)
            break;
        seen = pool->number;
        fl_loop loop = pool->loop;
        pthread_mutex_unlock(&pool->lock);
        run_loop(pool, &loop, &pool->next, helper->index);
        pthread_mutex_lock(&pool->lock);
        if (--pool->running == 0)
            pthread_cond_signal(&pool->end);
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

static uint32_t online_cpus(void)
{
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : count > FL_THREADS_MAX ? FL_THREADS_MAX : (uint32_t)count;
}

uint32_t fl_thread_count(uint32_t wanted)
{
    return wanted == 0 ? online_cpus() : fl_min_u32(wanted, FL_THREADS_MAX);
}

fl_pool *fl_pool_create(uint32_t thread_count, fl_diags *diags)
{
    uint32_t wanted = fl_thread_count(thread_count) - 1;
    fl_pool *pool = calloc(1, sizeof *pool + wanted * sizeof pool->helpers[0]);
    if (!pool) {
        fl_out_of_memory(diags, "the thread pool");
        return NULL;
    }
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->begin, NULL);
    pthread_cond_init(&pool->end, NULL);
    atomic_init(&pool->next, 0);
    atomic_init(&pool->is_cancelled, false);
    while (pool->helper_count < wanted) {
        fl_helper *helper = &pool->helpers[pool->helper_count];
        helper->pool = pool;
        helper->index = pool->helper_count + 1;
        int error = pthread_create(&helper->thread, NULL, helper_main, helper);
        if (error != 0) {
            fl_environment_error(diags, "cannot start thread %u of %u (error %d)",
                                 helper->index + 1, wanted + 1, error);
            fl_pool_destroy(pool);
            return NULL;
        }
        pool->helper_count++;
    }
    return pool;
}

void fl_pool_destroy(fl_pool *pool)
{
    if (!pool)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->should_stop = true;
    pthread_cond_broadcast(&pool->begin);
    pthread_mutex_unlock(&pool->lock);
    for (uint32_t i = 0; i < pool->helper_count; i++)
        pthread_join(pool->helpers[i].thread, NULL);
    pthread_cond_destroy(&pool->end);
    pthread_cond_destroy(&pool->begin);
    pthread_mutex_destroy(&pool->lock);
    free(pool);
}

uint32_t fl_pool_thread_count(const fl_pool *pool)
{
    return pool ? pool->helper_count + 1 : 1;
}

void fl_parallel_for(fl_pool *pool, uint32_t count, uint32_t grain,
                     void (*body)(void *context, uint32_t begin, uint32_t end, uint32_t thread),
                     void *context)
{
    fl_loop loop = {count, fl_max_u32(grain, 1), body, context};
    if (!pool || pool->helper_count == 0 || count <= loop.grain) {
        atomic_uint_least64_t next;
        atomic_init(&next, 0);
        run_loop(pool, &loop, &next, 0);
        return;
    }
    pthread_mutex_lock(&pool->lock);
    FL_ASSERT(pool->running == 0);
    pool->loop = loop;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    pool->running = pool->helper_count;
    pool->number++;
    pthread_cond_broadcast(&pool->begin);
    pthread_mutex_unlock(&pool->lock);

    run_loop(pool, &loop, &pool->next, 0);

    pthread_mutex_lock(&pool->lock);
    while (pool->running > 0)
        pthread_cond_wait(&pool->end, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

void fl_pool_cancel(fl_pool *pool)
{
    atomic_store_explicit(&pool->is_cancelled, true, memory_order_relaxed);
}

bool fl_pool_is_cancelled(const fl_pool *pool)
{
    return pool && atomic_load_explicit(&pool->is_cancelled, memory_order_relaxed);
}
