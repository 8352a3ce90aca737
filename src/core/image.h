/* SPDX-License-Identifier: MIT
 *
 * Layer 2: a picture in memory, as a texture or as the result of a render. How files become
 * pictures is not known here (src/io).
 */
#ifndef FL_IMAGE_H
#define FL_IMAGE_H

#include "core/ref.h"

typedef enum fl_pixel_format {
    FL_PIXEL_SRGB8,  /**< 3 bytes a pixel, sRGB-encoded. Decoded to linear by fl_srgb8_to_linear. */
    FL_PIXEL_LINEAR8, /**< 3 bytes a pixel, value/255 is linear (files that say so). */
    FL_PIXEL_FLOAT   /**< 3 floats a pixel, linear. */
} fl_pixel_format;

/** Reference counted and immutable once shared. Row 0 is the TOP row of the picture, pixels left to right,
 *  red green blue; no padding between rows. */
typedef struct fl_image {
    fl_ref ref;
    uint32_t width, height;
    fl_pixel_format format;
    void *pixels; /**< Owned: width * height * 3 bytes or floats, from malloc. */
} fl_image;

/** A picture with zeroed pixels and one reference. NULL: out of memory, or a side is 0, or the size in
 *  bytes overflows. */
fl_image *fl_image_create(uint32_t width, uint32_t height, fl_pixel_format format);
fl_image *fl_image_retain(fl_image *image);
/** Drop a reference; NULL is allowed. */
void fl_image_release(fl_image *image);

/** Bytes of its pixels. */
size_t fl_image_bytes(const fl_image *image);

/** The 256 linear values of the sRGB transfer function [IEC 61966-2-1], computed by the core, so that no
 *  library decides them. Each is the float nearest to the exact value. */
extern const float fl_srgb8_to_linear[256];

/** Sample i of the picture's 3 * width * height, linear. */
float fl_image_linear(const fl_image *image, size_t i);

/** The same curve and its inverse for values between; clamped to [0, 1], NaN becomes 0. */
double fl_srgb_to_linear(double encoded);
double fl_srgb_from_linear(double linear);

#endif
