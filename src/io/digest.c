/* SPDX-License-Identifier: MIT */
#include "io/digest.h"

#include <nettle/base16.h>
#include <nettle/sha2.h>

_Static_assert(BASE16_ENCODE_LENGTH(SHA256_DIGEST_SIZE) == FL_SHA256_HEX, "two characters a byte");

void fl_digest_sha256(const void *data, size_t bytes, char out_hex[FL_SHA256_HEX + 1])
{
    struct sha256_ctx context;
    uint8_t digest[SHA256_DIGEST_SIZE];
    sha256_init(&context);
    sha256_update(&context, bytes, data);
    sha256_digest(&context, sizeof digest, digest);
    base16_encode_update(out_hex, sizeof digest, digest);
    out_hex[FL_SHA256_HEX] = '\0';
}
