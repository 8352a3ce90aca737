/* SPDX-License-Identifier: MIT */
#include "core/arena.h"

#include <stdlib.h>
#include <string.h>

enum { ALIGN = 64, BLOCK_BYTES = 64 * 1024 };

struct fl_arena_block {
    fl_arena_block *older;
    size_t capacity_bytes, used_bytes; /* Of the payload: the first aligned byte behind, and on. */
    bool is_zeroed;
};

_Static_assert(sizeof(fl_arena_block) <= ALIGN, "a block needs more than it asks for");

static void *block_payload(fl_arena_block *block)
{
    uintptr_t behind = (uintptr_t)block + sizeof *block;
    return (char *)block + sizeof *block + (ALIGN - behind % ALIGN) % ALIGN;
}

/* A block whose payload holds at least `bytes` (a multiple of ALIGN). A large one is zero as it
 * comes from the system, page by page when it is first touched: by the threads that fill it. */
static fl_arena_block *block_create(size_t bytes)
{
    bool is_large = bytes > BLOCK_BYTES;
    size_t capacity = is_large ? bytes : BLOCK_BYTES;
    if (capacity > SIZE_MAX - 2 * ALIGN)
        return NULL;
    fl_arena_block *block =
        is_large ? calloc(1, capacity + 2 * ALIGN) : malloc(capacity + 2 * ALIGN);
    if (!block)
        return NULL;
    *block = (fl_arena_block){.capacity_bytes = capacity, .is_zeroed = is_large};
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
    return block->is_zeroed ? memory : memset(memory, 0, bytes);
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
