/* SPDX-License-Identifier: MIT
 *
 * The one door to OpenImageIO. image_codec.cpp implements it as a module of its own that
 * image_file.c loads when the first picture is read or written: linking the library outright costs
 * every start of the program a quarter of a second (it brings some 250 others along). Plain types
 * only: nothing of the library, of C++ or of the core's reference counting crosses this line, and
 * no exception does.
 */
#ifndef FL_IO_IMAGE_CODEC_H
#define FL_IO_IMAGE_CODEC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** File name of the module and the name of the fl_codec it exports. */
#define FL_CODEC_MODULE "fl_oiio.so"
#define FL_CODEC_SYMBOL "fl_codec_oiio"

/** Room for a message of the library; longer ones are cut. */
enum { FL_CODEC_MESSAGE_BYTES = 400 };

typedef enum fl_codec_sample { FL_CODEC_U8, FL_CODEC_U16, FL_CODEC_FLOAT } fl_codec_sample;

/** What a file says about itself before any pixel is read. */
typedef struct fl_codec_header {
    int64_t width, height, depth;
    fl_codec_sample sample; /**< U8, or FLOAT for everything that has more precision. */
    bool is_linear;         /**< Values are proportional to light; else sRGB-encoded. */
} fl_codec_header;

/** A picture to encode: 3 samples a pixel, top row first, no padding. */
typedef struct fl_codec_picture {
    const char *format; /**< The library's name: "png", "openexr", "tiff", "bmp". */
    uint32_t width, height;
    fl_codec_sample sample;
    bool is_linear;
    const void *pixels;
} fl_codec_picture;

/** A line of text stored inside a picture. */
typedef struct fl_image_text {
    const char *key, *value;
} fl_image_text;

/** Functions that return NULL or false have written why into `message`, in one line. Any thread; a
 * reader belongs to one thread at a time. */
typedef struct fl_codec {
    /** Open and read the header. The reader is closed by the caller. */
    void *(*open)(const char *path, fl_codec_header *out_header,
                  char message[FL_CODEC_MESSAGE_BYTES]);
    /** Read all pixels as RGB of the header's sample type: grey is spread, alpha and the rest
     * dropped. */
    bool (*read)(void *reader, void *out_rgb, char message[FL_CODEC_MESSAGE_BYTES]);
    /** The text stored under `key`, from malloc; NULL: none. False: out of memory. */
    bool (*find_text)(void *reader, const char *key, char **out_text);
    void (*close)(void *reader);
    /** Encode into memory from malloc, the caller's to free. */
    bool (*encode)(const fl_codec_picture *picture, const fl_image_text *texts, size_t text_count,
                   void **out_bytes, size_t *out_count, char message[FL_CODEC_MESSAGE_BYTES]);
} fl_codec;

#endif
