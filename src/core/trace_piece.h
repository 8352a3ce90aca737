/* SPDX-License-Identifier: MIT
 *
 * Layer 8, private to trace*.c and aov.c: a small stream of rays with what is found along them.
 */
#ifndef FL_TRACE_PIECE_H
#define FL_TRACE_PIECE_H

#include "core/trace.h"

/** Streams of one piece, all in `memory`. */
typedef struct fl_piece {
    float *memory;
    fl_rays rays;
    fl_hits hits;
    fl_surface surface;
} fl_piece;

/** `capacity` is a multiple of 16, so that every array is aligned to 64 bytes. False: out of
 * memory. */
bool fl_piece_init(fl_piece *piece, uint32_t capacity);
void fl_piece_deinit(fl_piece *piece);

/** Entries up to the next multiple of 8 become rays that hit nothing. */
void fl_piece_set_count(fl_rays *rays, uint32_t count);

#endif
