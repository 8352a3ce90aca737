/* SPDX-License-Identifier: MIT */
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/pool.h"

enum { COUNT_MAX = 5000 };

typedef struct visits {
    uint8_t seen[COUNT_MAX];
    uint32_t grain, thread_count;
    atomic_bool is_wrong;
    uint32_t last_end[FL_THREADS_MAX];
} visits;

static void visit(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    visits *v = context;
    if (thread >= v->thread_count || begin >= end || end - begin > v->grain ||
        begin < v->last_end[thread]) {
        atomic_store(&v->is_wrong,
                     true); /* Asserted later: cmocka's assertions belong to the main thread. */
        return;
    }
    v->last_end[thread] = end;
    for (uint32_t i = begin; i < end; i++)
        v->seen[i]++;
}

static void check_loop(fl_pool *pool, uint32_t count, uint32_t grain)
{
    visits *v = calloc(1, sizeof *v);
    assert_non_null(v);
    v->grain = grain;
    v->thread_count = fl_pool_thread_count(pool);
    fl_parallel_for(pool, count, grain, visit, v);
    assert_false(atomic_load(&v->is_wrong));
    for (uint32_t i = 0; i < COUNT_MAX; i++)
        assert_int_equal(v->seen[i], i < count);
    free(v);
}

static void every_index_is_visited_once(void **state)
{
    (void)state;
    fl_diags diags = {0};
    const uint32_t threads[] = {1, 2, 3, 7};
    for (size_t t = 0; t < FL_COUNT_OF(threads); t++) {
        fl_pool *pool = fl_pool_create(threads[t], &diags);
        assert_non_null(pool);
        assert_int_equal(fl_pool_thread_count(pool), threads[t]);
        for (uint32_t count = 0; count < 40; count++)
            check_loop(pool, count, 1 + count % 5);
        check_loop(pool, COUNT_MAX, 1);
        check_loop(pool, COUNT_MAX, 64);
        check_loop(pool, COUNT_MAX, COUNT_MAX + 1);
        fl_pool_destroy(pool);
    }
    assert_int_equal(diags.count, 0);
}

static void no_pool_means_this_thread(void **state)
{
    (void)state;
    assert_int_equal(fl_pool_thread_count(NULL), 1);
    check_loop(NULL, 1000, 7);
    fl_pool_destroy(NULL);
}

static void add_range(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    uint64_t *sums = context;
    for (uint32_t i = begin; i < end; i++)
        sums[thread] += i;
}

static void the_end_of_a_loop_shows_all_its_writes(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_pool *pool = fl_pool_create(3, &diags);
    assert_non_null(pool);
    uint64_t sums[3] = {0};
    for (uint32_t round = 0; round < 500; round++)
        fl_parallel_for(pool, 100, 3, add_range, sums);
    assert_int_equal(sums[0] + sums[1] + sums[2], 500 * 4950);
    fl_pool_destroy(pool);
}

static void a_count_near_the_limit_ends(void **state)
{
    (void)state;
    uint64_t first = 0;
    fl_parallel_for(NULL, 3, UINT32_MAX, add_range, &first);
    assert_int_equal(first, 3);
}

static void zero_threads_means_one_per_cpu(void **state)
{
    (void)state;
    assert_true(fl_thread_count(0) >= 1);
    assert_int_equal(fl_thread_count(5), 5);
    assert_int_equal(fl_thread_count(UINT32_MAX), FL_THREADS_MAX);
}

typedef struct broken {
    fl_pool *pool;
    atomic_uint done;
} broken;

static void break_off(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    broken *b = context;
    (void)thread;
    if (atomic_fetch_add(&b->done, end - begin) == 10)
        fl_pool_cancel(b->pool);
}

static void cancelled_loops_end_early(void **state)
{
    (void)state;
    fl_diags diags = {0};
    for (uint32_t threads = 1; threads <= 3; threads++) {
        broken b = {.pool = fl_pool_create(threads, &diags)};
        assert_non_null(b.pool);
        assert_false(fl_pool_is_cancelled(b.pool));
        fl_parallel_for(b.pool, 1000000000, 1, break_off, &b);
        assert_true(fl_pool_is_cancelled(b.pool));
        assert_true(atomic_load(&b.done) < 1000000000);
        atomic_store(&b.done, 0);
        fl_parallel_for(b.pool, 100, 1, break_off, &b); /* For good. */
        assert_int_equal(atomic_load(&b.done), 0);
        fl_pool_destroy(b.pool);
    }
    assert_false(fl_pool_is_cancelled(NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_index_is_visited_once),
        cmocka_unit_test(cancelled_loops_end_early),
        cmocka_unit_test(no_pool_means_this_thread),
        cmocka_unit_test(the_end_of_a_loop_shows_all_its_writes),
        cmocka_unit_test(a_count_near_the_limit_ends),
        cmocka_unit_test(zero_threads_means_one_per_cpu),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
