/* SPDX-License-Identifier: MIT */
#if defined(__linux__)
#define _DEFAULT_SOURCE /* madvise */
#endif
#include "core/arena.h"

#include <stdlib.h>
#include <string.h>
#if defined(__linux__)
#include <sys/mman.h>
#endif

enum { ALIGN = 64, BLOCK_BYTES = 64 * 1024, HUGE_BYTES = 2 * 1024 * 1024 };

/* Memory for a block. Large ones begin on a large page where the system has those: trees of many
 * megabytes are read here and there, and with small pages half of that time goes into finding them.
 */
static void *block_memory(size_t bytes)
{
#if defined(__linux__)
    if (bytes >= 2 * (size_t)HUGE_BYTES && bytes <= SIZE_MAX - HUGE_BYTES) {
        size_t rounded = (bytes + HUGE_BYTES - 1) / HUGE_BYTES * HUGE_BYTES;
        void *memory = aligned_alloc(HUGE_BYTES, rounded);
        if (memory)
            madvise(memory, rounded,
                    MADV_HUGEPAGE); /* Advice: it does not matter if it is not taken. */
        return memory;
    }
#endif
    return aligned_alloc(ALIGN, bytes);
}

struct fl_arena_block {
    fl_arena_block *older;
    size_t capacity_bytes,
        used_bytes; /* of the payload, which begins ALIGN bytes after the block */
};

static void *block_payload(fl_arena_block *block)
{
    return (char *)block + ALIGN;
}

/* A block whose payload holds at least `bytes` (a multiple of ALIGN). */
static fl_arena_block *block_create(size_t bytes)
{
    size_t capacity = bytes < BLOCK_BYTES ? BLOCK_BYTES : bytes;
    if (capacity > SIZE_MAX - ALIGN)
        return NULL;
    fl_arena_block *block = block_memory(capacity + ALIGN);
    if (block)
        *block = (fl_arena_block){.capacity_bytes = capacity};
    return block;
}

void *fl_arena_alloc(fl_arena *arena, size_t count, size_t item_bytes)
{
    size_t bytes;
    if (!fl_size_mul(count, item_bytes, &bytes) || bytes > SIZE_MAX - 2 * ALIGN)
        return NULL;
    bytes = (bytes + ALIGN - 1) / ALIGN * ALIGN;
    if (bytes == 0)
        bytes = ALIGN;
    fl_arena_block *block = arena->newest;
    if (!block || block->capacity_bytes - block->used_bytes < bytes) {
        block = block_create(bytes);
        if (!block)
            return NULL;
        block->older = arena->newest;
        arena->newest = block;
    }
    void *memory = (char *)block_payload(block) + block->used_bytes;
    block->used_bytes += bytes;
    arena->used_bytes += bytes;
    return memset(memory, 0, bytes);
}

char *fl_arena_text(fl_arena *arena, const char *text, size_t text_bytes)
{
    if (text_bytes == SIZE_MAX)
        return NULL;
    char *copy = fl_arena_alloc(arena, text_bytes + 1, 1);
    if (copy)
        memcpy(copy, text, text_bytes);
    return copy;
}

void fl_arena_deinit(fl_arena *arena)
{
    for (fl_arena_block *block = arena->newest; block;) {
        fl_arena_block *older = block->older;
        free(block);
        block = older;
    }
    *arena = (fl_arena){0};
}
