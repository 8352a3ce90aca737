/* SPDX-License-Identifier: MIT */
#include "alloc/failing.h"

#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>

#include "core/arena.h"

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t bytes);
void *__real_realloc(void *old, size_t bytes);
void *__real_aligned_alloc(size_t align, size_t bytes);
void __real_free(void *block);
void *__real_fl_arena_alloc(fl_arena *arena, size_t count, size_t item_bytes);
char *__real_fl_arena_text(fl_arena *arena, const char *text, size_t text_bytes);
int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*body)(void *), void *context);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t bytes);
void *__wrap_realloc(void *old, size_t bytes);
void *__wrap_aligned_alloc(size_t align, size_t bytes);
void __wrap_free(void *block);
void *__wrap_fl_arena_alloc(fl_arena *arena, size_t count, size_t item_bytes);
char *__wrap_fl_arena_text(fl_arena *arena, const char *text, size_t text_bytes);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*body)(void *), void *context);

static atomic_size_t calls, fail_at;
static atomic_bool fails_on, has_failed;
static atomic_long live;

static bool fails(void)
{
    size_t at = atomic_load(&fail_at), call = atomic_fetch_add(&calls, 1) + 1;
    if (at == 0 || call < at || (call > at && !atomic_load(&fails_on)))
        return false;
    atomic_store(&has_failed, true);
    errno = ENOMEM;
    return true;
}

static void *count(void *block)
{
    if (block)
        atomic_fetch_add(&live, 1);
    return block;
}

void *__wrap_malloc(size_t bytes)
{
    return fails() ? NULL : count(__real_malloc(bytes));
}

void *__wrap_calloc(size_t items, size_t bytes)
{
    return fails() ? NULL : count(__real_calloc(items, bytes));
}

void *__wrap_realloc(void *old, size_t bytes)
{
    if (fails())
        return NULL;
    void *block = __real_realloc(old, bytes);
    return old ? block : count(block);
}

void *__wrap_aligned_alloc(size_t align, size_t bytes)
{
    return fails() ? NULL : count(__real_aligned_alloc(align, bytes));
}

void __wrap_free(void *block)
{
    if (block)
        atomic_fetch_sub(&live, 1);
    __real_free(block);
}

void *__wrap_fl_arena_alloc(fl_arena *arena, size_t items, size_t item_bytes)
{
    return fails() ? NULL : __real_fl_arena_alloc(arena, items, item_bytes);
}

char *__wrap_fl_arena_text(fl_arena *arena, const char *text, size_t text_bytes)
{
    return fails() ? NULL : __real_fl_arena_text(arena, text, text_bytes);
}

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*body)(void *), void *context)
{
    return fails() ? EAGAIN : __real_pthread_create(thread, attributes, body, context);
}

void failing_begin(size_t n, bool from_then_on)
{
    atomic_store(&calls, 0);
    atomic_store(&has_failed, false);
    atomic_store(&fails_on, from_then_on);
    atomic_store(&fail_at, n);
}

bool failing_end(void)
{
    atomic_store(&fail_at, 0);
    return atomic_load(&has_failed);
}

bool failing_names_machine(const fl_diags *diags)
{
    bool is_named = false;
    for (uint32_t i = 0; i < diags->count; i++)
        is_named |= diags->items[i].cause == FL_CAUSE_ENVIRONMENT;
    return is_named;
}

long failing_live_blocks(void)
{
    return atomic_load(&live);
}

size_t failing_every_call(bool (*body)(void *context), void *context)
{
    size_t failed = 0, harmless = 0;
    for (int from_then_on = 0; from_then_on < 2; from_then_on++) {
        for (size_t n = 1;; n++) {
            long before = failing_live_blocks();
            failing_begin(n, from_then_on);
            bool ok = body(context);
            bool did_fail = failing_end();
            if (failing_live_blocks() != before)
                fail_msg("%ld blocks are left after call %zu failed",
                         failing_live_blocks() - before, n);
            if (!ok && !did_fail)
                fail_msg("an error without a cause, call %zu", n);
            if (!did_fail)
                break;
            failed++;
            harmless += ok;
        }
    }
    print_message("%zu calls failed, %zu of them without consequence\n", failed, harmless);
    return failed;
}
