/* SPDX-License-Identifier: MIT */
#include "io/image_whole.h"

#include <string.h>

static const uint8_t png_signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

/* Chunks: length, name, data, checksum; the last is IEND. */
static bool png_is_whole(const uint8_t *at, size_t left)
{
    while (left >= 12) {
        size_t length = (size_t)at[0] << 24 | (size_t)at[1] << 16 | (size_t)at[2] << 8 | at[3];
        if (length > left - 12)
            return false;
        if (memcmp(at + 4, "IEND", 4) == 0)
            return true;
        at += length + 12;
        left -= length + 12;
    }
    return false;
}

/* Segments with lengths up to the first scan; from there on FF D9 is the end and nothing else. */
static bool jpeg_is_whole(const uint8_t *at, size_t left)
{
    enum { SCAN = 0xDA, END = 0xD9 };
    while (left >= 4 && at[0] == 0xFF && at[1] != SCAN) {
        size_t length = at[1] == 0xFF ? 1 : 2 + ((size_t)at[2] << 8 | at[3]);
        if (length > left)
            return false;
        at += length;
        left -= length;
    }
    for (size_t i = 0; i + 1 < left; i++)
        if (at[i] == 0xFF && at[i + 1] == END)
            return true;
    return false;
}

bool fl_image_is_whole(const void *data, size_t bytes)
{
    const uint8_t *at = data;
    if (bytes >= sizeof png_signature && memcmp(at, png_signature, sizeof png_signature) == 0)
        return png_is_whole(at + sizeof png_signature, bytes - sizeof png_signature);
    if (bytes >= 3 && at[0] == 0xFF && at[1] == 0xD8 && at[2] == 0xFF)
        return jpeg_is_whole(at + 2, bytes - 2);
    return true;
}
