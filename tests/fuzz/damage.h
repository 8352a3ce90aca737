/* SPDX-License-Identifier: MIT
 *
 * Damage to the bytes of a file, the same for the same number.
 */
#ifndef TEST_DAMAGE_H
#define TEST_DAMAGE_H

#include <stddef.h>
#include <stdint.h>

/** Bytes, lengths and numbers changed, pieces cut, doubled or taken from `other`, the end cut off.
 * In place; returns the new size, at most `room`. The checksums of a PNG are made right again. */
size_t damage_bytes(uint8_t *data, size_t bytes, size_t room, const uint8_t *other,
                    size_t other_bytes, uint32_t number);

#endif
