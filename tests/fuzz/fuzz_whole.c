/* SPDX-License-Identifier: MIT
 *
 * The look at a picture's structure that comes before the image library sees it: of the input as it
 * is, and as what PNG and JPEG files hold between their frames. Those are whole, whatever they
 * hold, and cut anywhere they are not.
 */
#include <string.h>

#include "fuzz/fuzz.h"
#include "io/image_whole.h"

enum { PAYLOAD_MAX = 8192, CUTS = 64 };

typedef struct picture {
    uint8_t data[4 * PAYLOAD_MAX];
    size_t bytes;
} picture;

static void put(picture *p, const void *data, size_t bytes)
{
    memcpy(p->data + p->bytes, data, bytes);
    p->bytes += bytes;
}

static void put_chunk(picture *p, const char *name, const uint8_t *data, size_t bytes)
{
    const uint8_t length[4] = {0, (uint8_t)(bytes >> 16), (uint8_t)(bytes >> 8), (uint8_t)bytes};
    put(p, length, 4);
    put(p, name, 4);
    put(p, data, bytes);
    put(p, "\1\2\3", 4); /* a checksum, right or wrong */
}

static void make_png(picture *p, const uint8_t *data, size_t bytes)
{
    p->bytes = 0;
    put(p, "\x89PNG\r\n\x1a\n", 8);
    put_chunk(p, "IHDR", data, bytes < 13 ? bytes : 13);
    put_chunk(p, "IDAT", data, bytes);
    put_chunk(p, "IEND", data, 0);
}

/* A segment holds anything; in the scan a zero follows each FF. */
static void make_jpeg(picture *p, const uint8_t *data, size_t bytes)
{
    const uint8_t segment[4] = {0xFF, 0xE1, (uint8_t)((bytes + 2) >> 8), (uint8_t)(bytes + 2)};
    p->bytes = 0;
    put(p, "\xFF\xD8", 2);
    put(p, segment, 4);
    put(p, data, bytes);
    put(p, "\xFF\xDA\0\2", 4);
    for (size_t i = 0; i < bytes; i++)
        put(p, data[i] == 0xFF ? "\xFF" : (const char *)&data[i], data[i] == 0xFF ? 2 : 1);
    put(p, "\xFF\xD9", 2);
}

/* From `first` on the format can be told. */
static void check_cuts(const picture *p, size_t first)
{
    MUST(fl_image_is_whole(p->data, p->bytes));
    size_t step = 1 + p->bytes / CUTS;
    for (size_t n = first; n < p->bytes; n += n + 16 < p->bytes ? step : 1)
        MUST(!fl_image_is_whole(p->data, n));
}

static int64_t largest(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* An EXR that says its window, and a GIF, in the input's own numbers. */
static void check_claims(const uint8_t *data, size_t bytes)
{
    int64_t width, height;
    int32_t window[4];
    if (bytes < sizeof window)
        return;
    memcpy(window, data, sizeof window);
    picture p = {.bytes = 0};
    put(&p, "\x76\x2F\x31\x01\2\0\0", 8);
    put(&p, "dataWindow\0box2i\0\x10\0\0", 21);
    put(&p, window, sizeof window);
    put(&p, "", 1);
    check_cuts(&p, 8);
    MUST(fl_image_claim(p.data, p.bytes, &width, &height));
    MUST(width == largest(0, (int64_t)window[2] - window[0] + 1));
    MUST(height == largest(0, (int64_t)window[3] - window[1] + 1));
    p.bytes = 0;
    put(&p, "GIF89a", 6);
    put(&p, data, 4);
    MUST(fl_image_claim(p.data, p.bytes, &width, &height));
    MUST(width == (data[0] | data[1] << 8) && height == (data[2] | data[3] << 8));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    static picture p;
    int64_t width, height;
    bool is_whole = fl_image_is_whole(data, bytes);
    /* More behind it changes nothing; less does not make it whole. */
    for (size_t n = 8; n < bytes; n += 1 + bytes / CUTS)
        MUST(is_whole || !fl_image_is_whole(data, n));
    if (fl_image_claim(data, bytes, &width, &height))
        MUST(width >= 0 && width <= 0x100000000 && height >= 0 && height <= 0x100000000);
    bytes = bytes < PAYLOAD_MAX ? bytes : PAYLOAD_MAX;
    make_png(&p, data, bytes);
    check_cuts(&p, 8);
    make_jpeg(&p, data, bytes);
    check_cuts(&p, 3);
    check_claims(data, bytes);
    return 0;
}
