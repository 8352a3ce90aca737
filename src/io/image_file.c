/* SPDX-License-Identifier: MIT */
#include "io/image_file.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "io/files.h"
#include "io/image_whole.h"
#include "io/module.h"
#include "io/path.h"

/* ---- The codec module ---- */

static pthread_once_t codec_once = PTHREAD_ONCE_INIT;
static const fl_codec *codec;
static char codec_message[FL_CODEC_MESSAGE_BYTES];

static void load_codec(void)
{
    char path[FL_MODULE_PATH_BYTES];
    if (!fl_module_find(FL_CODEC_MODULE, path)) {
        snprintf(codec_message, sizeof codec_message, "%s is not in or near %.300s",
                 FL_CODEC_MODULE, path);
        return;
    }
    void *module = dlopen(path, RTLD_LAZY | RTLD_LOCAL);
    codec = module ? dlsym(module, FL_CODEC_SYMBOL) : NULL;
    if (!codec)
        snprintf(codec_message, sizeof codec_message, "%s", dlerror());
}

static const fl_codec *get_codec(fl_diags *diags)
{
    pthread_once(&codec_once, load_codec);
    if (!codec)
        fl_environment_error(diags, "cannot load the image module: %s", codec_message);
    return codec;
}

/* ---- Reading ---- */

static bool has_legal_size(const char *path, size_t file_bytes, const fl_codec_header *header,
                           fl_loc loc, fl_diags *diags)
{
    if (header->width < 1 || header->height < 1 || header->depth > 1)
        return fl_error(diags, loc, "image '%s' is not a flat picture", path);
    if (header->width > FL_IMAGE_SIDE_MAX || header->height > FL_IMAGE_SIDE_MAX)
        return fl_error(diags, loc, "image '%s' is too large: %jd x %jd pixels, at most %d a side",
                        path, (intmax_t)header->width, (intmax_t)header->height, FL_IMAGE_SIDE_MAX);
    uint64_t sample_bytes = header->sample == FL_CODEC_U8 ? 1 : sizeof(float);
    uint64_t bytes = (uint64_t)header->width * (uint64_t)header->height * 3 * sample_bytes;
    if (bytes > FL_IMAGE_MAX_BYTES)
        return fl_error(diags, loc, "image '%s' is too large: %ju bytes in memory, at most %zu",
                        path, (uintmax_t)bytes, FL_IMAGE_MAX_BYTES);
    if (bytes > FL_IMAGE_UNSUSPECTED_BYTES && bytes / FL_IMAGE_EXPANSION_MAX > file_bytes)
        return fl_error(
            diags, loc,
            "cannot read image '%s': it should have %jd x %jd pixels, and has %zu bytes", path,
            (intmax_t)header->width, (intmax_t)header->height, file_bytes);
    return true;
}

static bool make_finite_linear(fl_image *image, bool is_linear, const char *path, fl_loc loc,
                               fl_diags *diags)
{
    float *samples = image->pixels;
    size_t count = (size_t)image->width * image->height * 3;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(samples[i]))
            return fl_error(diags, loc,
                            "image '%s' has a pixel that is no finite number at %zu, %zu", path,
                            i / 3 % image->width, i / 3 / image->width);
        if (!is_linear)
            samples[i] = (float)fl_srgb_to_linear((double)samples[i]);
    }
    return true;
}

static fl_image *read_image(const fl_codec *from, void *reader, const fl_codec_header *header,
                            const char *path, size_t file_bytes, fl_loc loc, fl_diags *diags)
{
    char message[FL_CODEC_MESSAGE_BYTES];
    fl_pixel_format format = header->sample != FL_CODEC_U8 ? FL_PIXEL_FLOAT
                             : header->is_linear           ? FL_PIXEL_LINEAR8
                                                           : FL_PIXEL_SRGB8;
    if (!has_legal_size(path, file_bytes, header, loc, diags))
        return NULL;
    fl_image *image = fl_image_create((uint32_t)header->width, (uint32_t)header->height, format);
    if (!image) {
        fl_out_of_memory(diags, path);
        return NULL;
    }
    bool is_read = from->read(reader, image->pixels, message);
    if (!is_read)
        fl_error(diags, loc, "cannot read image '%s': %s", path, message);
    if (is_read && format == FL_PIXEL_FLOAT)
        is_read = make_finite_linear(image, header->is_linear, path, loc, diags);
    if (!is_read) {
        fl_image_release(image);
        return NULL;
    }
    return image;
}

/* The library takes a JPEG without its end as one with a grey end, lets libpng complain on the
 * terminal, and takes memory for what an EXR or a GIF says it has: all are looked over first. */
static bool check_whole(const char *path, fl_loc loc, fl_diags *diags, size_t *out_bytes)
{
    size_t bytes;
    char *data = fl_file_load(path, "image", FL_IMAGE_FILE_MAX_BYTES, loc, diags, &bytes);
    if (!data)
        return false;
    bool is_whole = fl_image_is_whole(data, bytes);
    if (bytes == 0)
        fl_error(diags, loc, "image '%s' is empty", path);
    else if (!is_whole)
        fl_error(diags, loc, "cannot read image '%s': it is cut off after %zu bytes", path, bytes);
    fl_codec_header claim = {.depth = 1, .sample = FL_CODEC_U8};
    bool is_fine = bytes > 0 && is_whole;
    if (is_fine && fl_image_claim(data, bytes, &claim.width, &claim.height))
        is_fine = has_legal_size(path, bytes, &claim, loc, diags);
    free(data);
    *out_bytes = bytes;
    return is_fine;
}

/* Check and open. NULL after adding an error. */
static void *open_image(const char *path, fl_loc loc, fl_diags *diags, const fl_codec **out_codec,
                        fl_codec_header *out_header, size_t *out_bytes)
{
    char message[FL_CODEC_MESSAGE_BYTES];
    if (!check_whole(path, loc, diags, out_bytes))
        return NULL;
    *out_codec = get_codec(diags);
    if (!*out_codec)
        return NULL;
    void *reader = (*out_codec)->open(path, out_header, message);
    if (!reader)
        fl_error(diags, loc, "cannot read image '%s': %s", path, message);
    return reader;
}

fl_image *fl_image_load(const char *path, fl_loc loc, fl_diags *diags)
{
    const fl_codec *from;
    fl_codec_header header;
    size_t bytes;
    void *reader = open_image(path, loc, diags, &from, &header, &bytes);
    if (!reader)
        return NULL;
    fl_image *image = read_image(from, reader, &header, path, bytes, loc, diags);
    from->close(reader);
    return image;
}

bool fl_image_load_text(const char *path, const char *key, fl_loc loc, fl_diags *diags,
                        char **out_text)
{
    const fl_codec *from;
    fl_codec_header header;
    size_t bytes;
    void *reader = open_image(path, loc, diags, &from, &header, &bytes);
    if (!reader)
        return false;
    bool is_read = from->find_text(reader, key, out_text);
    from->close(reader);
    return is_read || fl_out_of_memory(diags, path);
}

/* ---- Writing ---- */

/* What each extension holds: the sample type for an 8-bit picture and for a float one. */
typedef struct image_kind {
    const char *extension, *codec_format;
    fl_pixel_format best;
    fl_codec_sample of_bytes, of_floats;
} image_kind;

static const image_kind kinds[] = {
    {".png", "png", FL_PIXEL_SRGB8, FL_CODEC_U8, FL_CODEC_U16},
    {".exr", "openexr", FL_PIXEL_FLOAT, FL_CODEC_FLOAT, FL_CODEC_FLOAT},
    {".tif", "tiff", FL_PIXEL_SRGB8, FL_CODEC_U8, FL_CODEC_FLOAT},
    {".tiff", "tiff", FL_PIXEL_SRGB8, FL_CODEC_U8, FL_CODEC_FLOAT},
    {".bmp", "bmp", FL_PIXEL_SRGB8, FL_CODEC_U8, FL_CODEC_U8},
};

static const image_kind *find_kind(const char *path, fl_diags *diags)
{
    for (size_t i = 0; i < FL_COUNT_OF(kinds); i++)
        if (strcasecmp(fl_path_ending(path), kinds[i].extension) == 0)
            return &kinds[i];
    fl_error(diags, (fl_loc){0},
             "cannot write '%s': the name must end in .png .exr .tif .tiff or .bmp", path);
    return NULL;
}

bool fl_image_format_for(const char *path, fl_diags *diags, fl_pixel_format *out_format)
{
    const image_kind *kind = find_kind(path, diags);
    if (kind)
        *out_format = kind->best;
    return kind != NULL;
}

/* The samples as `sample` type, linear if float, else sRGB-encoded; NULL: out of memory. */
static void *convert_samples(const fl_image *image, fl_codec_sample sample)
{
    size_t count = (size_t)image->width * image->height * 3;
    size_t sample_bytes = sample == FL_CODEC_U8 ? 1 : sample == FL_CODEC_U16 ? 2 : sizeof(float);
    void *samples = malloc(count * sample_bytes);
    for (size_t i = 0; samples && i < count; i++) {
        float linear = fl_image_linear(image, i);
        double encoded = sample == FL_CODEC_FLOAT ? 0.0 : fl_srgb_from_linear((double)linear);
        if (sample == FL_CODEC_FLOAT)
            ((float *)samples)[i] = linear;
        else if (sample == FL_CODEC_U16)
            ((uint16_t *)samples)[i] = (uint16_t)(encoded * 65535.0 + 0.5);
        else
            ((uint8_t *)samples)[i] = (uint8_t)(encoded * 255.0 + 0.5);
    }
    return samples;
}

bool fl_image_save(const char *path, const fl_image *image, const fl_image_text *texts,
                   size_t text_count, fl_diags *diags)
{
    char message[FL_CODEC_MESSAGE_BYTES];
    const image_kind *kind = find_kind(path, diags);
    const fl_codec *to = kind ? get_codec(diags) : NULL;
    if (!to)
        return false;
    bool is_float = image->format == FL_PIXEL_FLOAT;
    fl_codec_sample sample = is_float ? kind->of_floats : kind->of_bytes;
    bool is_same = (image->format == FL_PIXEL_SRGB8 && sample == FL_CODEC_U8) ||
                   (is_float && sample == FL_CODEC_FLOAT);
    void *converted = is_same ? NULL : convert_samples(image, sample);
    if (!is_same && !converted)
        return fl_out_of_memory(diags, path);
    fl_codec_picture picture = {.format = kind->codec_format,
                                .width = image->width,
                                .height = image->height,
                                .sample = sample,
                                .is_linear = sample == FL_CODEC_FLOAT,
                                .pixels = is_same ? image->pixels : converted};
    void *bytes = NULL;
    size_t byte_count = 0;
    bool is_saved = to->encode(&picture, texts, text_count, &bytes, &byte_count, message);
    if (!is_saved)
        fl_environment_error(diags, "cannot write '%s': %s", path, message);
    else if (!fl_image_is_whole(bytes, byte_count)) /* PNG */
        is_saved =
            fl_environment_error(diags, "cannot write '%s': not all of it could be written", path);
    else
        is_saved = fl_file_save(path, bytes, byte_count, diags);
    free(bytes);
    free(converted);
    return is_saved;
}
