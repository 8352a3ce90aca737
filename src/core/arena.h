/* SPDX-License-Identifier: MIT
 *
 * Layer 1: an arena gives out memory piece by piece and takes it back all at once.
 * Not thread-safe: one owner at a time.
 */
#ifndef FL_ARENA_H
#define FL_ARENA_H

#include "core/base.h"

typedef struct fl_arena_block fl_arena_block;

/** Zero-initialise ({0}) to begin; a zeroed arena owns nothing. */
typedef struct fl_arena {
    fl_arena_block *newest; /**< Blocks in order of age, newest first; owned. */
    size_t used_bytes;      /**< Given out so far, with alignment losses: for reports. */
} fl_arena;

/** Zeroed memory for `count` items of `item_bytes`, aligned to 64 bytes (a cache line, an AVX-512
 *  vector). NULL when out of memory or when the product overflows; never NULL for count 0.
 *  Lives until fl_arena_deinit. Amortised O(bytes). */
void *fl_arena_alloc(fl_arena *arena, size_t count, size_t item_bytes);

/** Copy of `text` with a terminating 0. NULL: out of memory. */
char *fl_arena_text(fl_arena *arena, const char *text, size_t text_bytes);

/** Free everything; the arena is then zeroed and may be used again. */
void fl_arena_deinit(fl_arena *arena);

#endif
