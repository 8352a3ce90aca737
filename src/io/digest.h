/* SPDX-License-Identifier: MIT
 *
 * SHA-256 of bytes: films and prepared files are named by it.
 */
#ifndef FL_IO_DIGEST_H
#define FL_IO_DIGEST_H

#include "core/firstlight.h"

/** Characters of a digest in hexadecimal, without the final 0. */
enum { FL_SHA256_HEX = 64 };

/** SHA-256 [FIPS 180-4] of `bytes` bytes as lower-case hexadecimal. Any thread. About 2 ns a byte.
 */
void fl_digest_sha256(const void *data, size_t bytes, char out_hex[FL_SHA256_HEX + 1]);

#endif
