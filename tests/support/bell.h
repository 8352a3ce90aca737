/* SPDX-License-Identifier: MIT
 *
 * Who waits for another thread to call: a counter with a lock and somebody to wake.
 */
#ifndef TEST_BELL_H
#define TEST_BELL_H

#include <pthread.h>
#include <stdint.h>

typedef struct bell {
    pthread_mutex_t lock;
    pthread_cond_t rung;
    uint32_t count; /**< Under the lock. */
} bell;

#define BELL_INITIALIZER                                                                           \
    {                                                                                              \
        .lock = PTHREAD_MUTEX_INITIALIZER, .rung = PTHREAD_COND_INITIALIZER                        \
    }

/** Ring; `context` is the bell. */
static inline void bell_ring(void *context)
{
    bell *b = context;
    pthread_mutex_lock(&b->lock);
    b->count++;
    pthread_cond_broadcast(&b->rung);
    pthread_mutex_unlock(&b->lock);
}

/** Wait until it has rung `count` times; returns how often it has. 0 does not wait. */
static inline uint32_t bell_wait(bell *b, uint32_t count)
{
    pthread_mutex_lock(&b->lock);
    while (b->count < count)
        pthread_cond_wait(&b->rung, &b->lock);
    uint32_t rung = b->count;
    pthread_mutex_unlock(&b->lock);
    return rung;
}

#endif
