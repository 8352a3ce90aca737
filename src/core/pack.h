/* SPDX-License-Identifier: MIT
 *
 * Layer 1: state to bytes and back. A module writes one function that names its fields in order; it
 * measures, writes or reads them, as the pack says. Bytes are those of memory: for the same program
 * on machines of one byte order.
 */
#ifndef FL_PACK_H
#define FL_PACK_H

#include <string.h>

#include "core/base.h"

typedef enum fl_pack_mode {
    FL_PACK_MEASURE, /**< Only count bytes. */
    FL_PACK_WRITE,   /**< State to bytes. */
    FL_PACK_READ     /**< Bytes to state. */
} fl_pack_mode;

/** A cursor over borrowed bytes: {mode, data, capacity}. */
typedef struct fl_pack {
    fl_pack_mode mode;
    uint8_t *data; /**< Unused when measuring. */
    size_t capacity, bytes;
    bool has_failed; /**< Too few bytes, or a reader found nonsense: state read is worthless. */
} fl_pack;

/** `bytes` bytes of `state`, in the pack's direction; once failed it does nothing more. */
static inline void fl_pack_bytes(fl_pack *pack, void *state, size_t bytes)
{
    if (pack->mode != FL_PACK_MEASURE) {
        if (pack->has_failed || bytes > pack->capacity - pack->bytes) {
            pack->has_failed = true;
            return;
        }
        if (pack->mode == FL_PACK_WRITE)
            memcpy(pack->data + pack->bytes, state, bytes);
        else
            memcpy(state, pack->data + pack->bytes, bytes);
    }
    pack->bytes += bytes;
}

/** Where the two sides must agree: when reading, any other value than *value fails. */
static inline void fl_pack_check(fl_pack *pack, const void *value, size_t bytes)
{
    uint8_t seen[64];
    FL_ASSERT(bytes <= sizeof seen);
    memcpy(seen, value, bytes);
    fl_pack_bytes(pack, seen, bytes);
    if (memcmp(seen, value, bytes) != 0)
        pack->has_failed = true;
}

#endif
