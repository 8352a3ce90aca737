/* SPDX-License-Identifier: MIT
 *
 * Pictures on disk. Reads PNG, JPEG, EXR, HDR, TIFF, TGA, BMP, PNM, GIF and WebP, whatever the
 * file is called; writes .png .tif .tiff .bmp .exr.
 */
#ifndef FL_IO_IMAGE_FILE_H
#define FL_IO_IMAGE_FILE_H

#include "core/firstlight.h"
#include "io/image_codec.h"

/** Limits of a picture that is read, checked before memory is asked for. */
enum { FL_IMAGE_SIDE_MAX = 65536 };
#define FL_IMAGE_MAX_BYTES      ((size_t)1 << 30)
#define FL_IMAGE_FILE_MAX_BYTES ((size_t)1 << 30)

/** A picture above the first has a byte in its file for at most so many in memory, else its file is
 * damaged: a white one of a bit a pixel in PNG comes to 25,000. */
#define FL_IMAGE_UNSUSPECTED_BYTES ((size_t)64 << 20)
enum { FL_IMAGE_EXPANSION_MAX = 1 << 15 };

/** Read a picture as a texture. 8-bit files keep their bytes (SRGB8, or LINEAR8 where the file says
 * so); everything deeper becomes linear FLOAT, an sRGB file by the core's curve. Grey becomes RGB,
 * alpha is ignored (the colours are those stored). One reference is the caller's; NULL after adding
 * an error at `loc`. Any thread. */
fl_image *fl_image_load(const char *path, fl_loc loc, fl_diags *diags);

/** How a picture is best handed over for `path`: SRGB8 for .png .tif .tiff .bmp, FLOAT for .exr.
 * False after adding an error when nothing can be written under that name: call it before rendering
 * for an hour. Touches no disk. */
bool fl_image_format_for(const char *path, fl_diags *diags, fl_pixel_format *out_format);

/** Write a picture, all or nothing (fl_file_save). The extension chooses the file; what the file
 * cannot hold is converted: FLOAT into .png is 16-bit sRGB, into .bmp 8-bit sRGB, into .tif and
 * .exr linear float; 8-bit into .exr is decoded. `texts` are kept inside the file (.bmp has no room
 * for them); keys are one line without '='. The same input gives the same bytes: no date, no host.
 * `image->ref` is not touched, so a struct around borrowed pixels will do. False after adding an
 * error. Any thread. */
bool fl_image_save(const char *path, const fl_image *image, const fl_image_text *texts,
                   size_t text_count, fl_diags *diags);

/** Find a text that fl_image_save put into a file. *out_text is from malloc, the caller's to free,
 * or NULL if the file has no such key. False after adding an error at `loc`. */
bool fl_image_load_text(const char *path, const char *key, fl_loc loc, fl_diags *diags,
                        char **out_text);

#endif
