/* SPDX-License-Identifier: MIT */
#include "fuzz/damage.h"

#include <string.h>

#include "core/firstlight.h"

enum { CHANGES_MAX = 4, HEAD_BYTES = 128 };

typedef struct damage {
    uint8_t *data;
    size_t bytes, room;
    uint32_t random;
} damage;

static size_t draw(damage *d, size_t below)
{
    d->random = fl_hash_step(d->random, 1);
    return below ? d->random % below : 0;
}

/* Headers are hit as often as all the rest. */
static size_t draw_place(damage *d)
{
    return draw(d, draw(d, 2) && d->bytes > HEAD_BYTES ? HEAD_BYTES : d->bytes);
}

/* Replace `cut` bytes at `at` by others, as far as there is room. */
static void splice(damage *d, size_t at, size_t cut, const uint8_t *piece, size_t piece_bytes)
{
    if (d->bytes - cut + piece_bytes > d->room)
        return;
    memmove(d->data + at + piece_bytes, d->data + at + cut, d->bytes - at - cut);
    memcpy(d->data + at, piece, piece_bytes);
    d->bytes += piece_bytes - cut;
}

/* A whole number of 2, 4 or 8 bytes, in either order, that a length or a count is afraid of. */
static void put_length(damage *d, size_t at)
{
    static const uint64_t lengths[] = {0,          1,          2,          0x7F,       0xFF,
                                       0x100,      0x7FFF,     0xFFFF,     0x10000,    0x7FFFFFFF,
                                       0x80000000, 0xFFFFFFFF, 0xFFFFFFFE, 0x40000000, 0x1000000};
    uint64_t length = lengths[draw(d, FL_COUNT_OF(lengths))] + draw(d, 2) * d->bytes;
    size_t width = (size_t)2 << draw(d, 3);
    bool is_big = draw(d, 2);
    for (size_t i = 0; i < width && at + i < d->bytes; i++)
        d->data[at + i] = (uint8_t)(length >> 8 * (is_big ? width - 1 - i : i));
}

/* The digits at or behind a place, as another number. */
static void put_number(damage *d, size_t at)
{
    static const char *const numbers[] = {
        "0",   "-1",  "1e39", "4294967295", "4294967296", "99999999999",
        "nan", "-0",  "1",    "65536",      "1000000",    "2147483647",
        "7",   "0.5", "inf",  "5126",       "5",          "1e-320"};
    while (at < d->bytes && (d->data[at] < '0' || d->data[at] > '9'))
        at++;
    size_t end = at;
    while (end < d->bytes && d->data[end] >= '0' && d->data[end] <= '9')
        end++;
    const char *number = numbers[draw(d, FL_COUNT_OF(numbers))];
    if (end > at)
        splice(d, at, end - at, (const uint8_t *)number, strlen(number));
}

static void change(damage *d, const uint8_t *other, size_t other_bytes)
{
    uint8_t piece[256];
    size_t at = draw_place(d), left = d->bytes - at, length = 1 + draw(d, left < 200 ? left : 200);
    if (d->bytes == 0)
        return;
    length = length < left ? length : left;
    switch (draw(d, 9)) {
    case 0:
        d->data[at] ^= (uint8_t)(1u << draw(d, 8));
        break;
    case 1:
        d->data[at] = (uint8_t)draw(d, 256);
        break;
    case 2:
    case 3:
        put_length(d, at);
        break;
    case 4:
        put_number(d, at);
        break;
    case 5: /* Gone. */
        splice(d, at, length, piece, 0);
        break;
    case 6: /* Twice. */
        memcpy(piece, d->data + at, length);
        splice(d, at, 0, piece, length);
        break;
    case 7: { /* From another file. */
        size_t from = draw(d, other_bytes);
        length = length < other_bytes - from ? length : other_bytes - from;
        splice(d, at, draw(d, 2) && length <= left ? length : 0, other + from, length);
        break;
    }
    default:
        if (draw(d, 4) == 0)
            d->bytes = draw(d, d->bytes);
    }
}

static uint32_t checksum(const uint8_t *data, size_t bytes)
{
    uint32_t sum = 0xFFFFFFFF;
    for (size_t i = 0; i < bytes; i++) {
        sum ^= data[i];
        for (int k = 0; k < 8; k++)
            sum = sum >> 1 ^ (sum & 1 ? 0xEDB88320 : 0);
    }
    return ~sum;
}

static void mend_png(damage *d)
{
    if (d->bytes < 8 || memcmp(d->data, "\x89PNG\r\n\x1a\n", 8) != 0)
        return;
    for (size_t at = 8; d->bytes - at >= 12;) {
        const uint8_t *chunk = d->data + at;
        size_t length =
            (size_t)chunk[0] << 24 | (size_t)chunk[1] << 16 | (size_t)chunk[2] << 8 | chunk[3];
        if (length > d->bytes - at - 12)
            return;
        uint32_t sum = checksum(chunk + 4, length + 4);
        at += length + 12;
        for (size_t i = 0; i < 4; i++)
            d->data[at - 4 + i] = (uint8_t)(sum >> 8 * (3 - i));
    }
}

size_t damage_bytes(uint8_t *data, size_t bytes, size_t room, const uint8_t *other,
                    size_t other_bytes, uint32_t number)
{
    damage d = {data, bytes, room, number};
    for (size_t i = 1 + draw(&d, CHANGES_MAX); i > 0; i--)
        change(&d, other, other_bytes);
    mend_png(&d);
    return d.bytes;
}
