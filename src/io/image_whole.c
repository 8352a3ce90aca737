/* SPDX-License-Identifier: MIT */
#include "io/image_whole.h"

#include <string.h>

enum { EXR_HEAD = 8, EXR_PARTS = 0x10, GIF_HEAD = 10 };

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
    while (left >= 2 && at[0] == 0xFF && at[1] != SCAN && at[1] != END) {
        if (left < 4 && at[1] != 0xFF)
            return false;
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

typedef struct cursor {
    const uint8_t *at;
    size_t left;
} cursor;

/* The text that stands here, behind it the next; NULL: it does not end. */
static const char *take_text(cursor *c)
{
    const uint8_t *text = c->at, *end = c->left ? memchr(text, 0, c->left) : NULL;
    if (!end)
        return NULL;
    c->left -= (size_t)(end + 1 - text);
    c->at = end + 1;
    return (const char *)text;
}

static uint32_t little(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

/* Attributes: name, type, length, value; an empty name ends a head, of which some files have
 * several, and then one more. Writes the largest window, 0 x 0 where there is none. */
static bool exr_is_whole(const uint8_t *data, size_t bytes, int64_t *out_width, int64_t *out_height)
{
    bool has_parts = data[5] & EXR_PARTS, was_end = false;
    cursor c = {data + EXR_HEAD, bytes - EXR_HEAD};
    *out_width = *out_height = 0;
    for (const char *name = take_text(&c); name; name = take_text(&c)) {
        if (!*name && (!has_parts || was_end))
            return true;
        was_end = !*name;
        if (was_end)
            continue;
        if (!take_text(&c) || c.left < 4 || little(c.at) > c.left - 4)
            return false;
        uint32_t length = little(c.at);
        if (strcmp(name, "dataWindow") == 0 && length == 16) {
            int64_t width = (int64_t)(int32_t)little(c.at + 12) - (int32_t)little(c.at + 4) + 1;
            int64_t height = (int64_t)(int32_t)little(c.at + 16) - (int32_t)little(c.at + 8) + 1;
            *out_width = *out_width > width ? *out_width : width;
            *out_height = *out_height > height ? *out_height : height;
        }
        c.at += 4 + length;
        c.left -= 4 + length;
    }
    return false;
}

static bool is_exr(const void *data, size_t bytes)
{
    return bytes >= EXR_HEAD && memcmp(data, "\x76\x2F\x31\x01", 4) == 0;
}

bool fl_image_is_whole(const void *data, size_t bytes)
{
    const uint8_t *at = data;
    if (bytes >= sizeof png_signature && memcmp(at, png_signature, sizeof png_signature) == 0)
        return png_is_whole(at + sizeof png_signature, bytes - sizeof png_signature);
    if (bytes >= 3 && at[0] == 0xFF && at[1] == 0xD8 && at[2] == 0xFF)
        return jpeg_is_whole(at + 2, bytes - 2);
    int64_t width, height;
    return !is_exr(data, bytes) || exr_is_whole(data, bytes, &width, &height);
}

bool fl_image_claim(const void *data, size_t bytes, int64_t *out_width, int64_t *out_height)
{
    const uint8_t *at = data;
    if (is_exr(data, bytes))
        return exr_is_whole(data, bytes, out_width, out_height);
    if (bytes < GIF_HEAD || memcmp(at, "GIF8", 4) != 0)
        return false;
    *out_width = at[6] | at[7] << 8;
    *out_height = at[8] | at[9] << 8;
    return true;
}
