// SPDX-License-Identifier: MIT
//
// Small pictures in every format that we read, written by OpenImageIO: what damaged_files.c then
// damages.
#include "fuzz/good_files.h"

#include <OpenImageIO/imageio.h>

#include <cstdio>
#include <string>
#include <vector>

namespace
{

enum { WIDTH = 21, HEIGHT = 18, TILE = 16 };

// `type` 0: 8 bits, 1: 16 bits, 2: half, 3: float.
const struct {
    const char *name, *format;
    int channels, type;
    bool is_tiled;
    const char *compression;
} kinds[] = {
    {"rgb.png", "png", 3, 0, false, ""},          {"grey.png", "png", 1, 0, false, ""},
    {"deep.png", "png", 4, 1, false, ""},         {"rgb.jpg", "jpeg", 3, 0, false, ""},
    {"grey.jpg", "jpeg", 1, 0, false, ""},        {"zip.exr", "openexr", 3, 2, false, "zip"},
    {"piz.exr", "openexr", 4, 2, false, "piz"},   {"rle.exr", "openexr", 3, 2, true, "rle"},
    {"pxr.exr", "openexr", 1, 3, false, "pxr24"}, {"b44.exr", "openexr", 3, 2, false, "b44a"},
    {"dwa.exr", "openexr", 3, 2, false, "dwaa"},  {"plain.exr", "openexr", 3, 3, true, "none"},
    {"light.hdr", "hdr", 3, 3, false, ""},        {"plain.tif", "tiff", 3, 0, false, "none"},
    {"lzw.tif", "tiff", 3, 0, false, "lzw"},      {"zip.tif", "tiff", 4, 1, true, "zip"},
    {"float.tif", "tiff", 3, 3, false, "zip"},    {"pack.tif", "tiff", 1, 0, false, "packbits"},
    {"jpeg.tif", "tiff", 3, 0, false, "jpeg"},    {"rle.tga", "targa", 3, 0, false, "rle"},
    {"plain.tga", "targa", 4, 0, false, "none"},  {"rgb.bmp", "bmp", 3, 0, false, ""},
    {"grey.bmp", "bmp", 1, 0, false, ""},         {"rgb.ppm", "pnm", 3, 0, false, ""},
    {"grey.pgm", "pnm", 1, 0, false, ""},         {"rgb.webp", "webp", 3, 0, false, ""},
    {"rgb.gif", "gif", 3, 0, false, ""},
};

} // namespace

extern "C" bool good_pictures(const char *folder)
{
    static const OIIO::TypeDesc types[] = {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16,
                                           OIIO::TypeDesc::HALF, OIIO::TypeDesc::FLOAT};
    for (const auto &kind : kinds) {
        std::vector<float> pixels;
        for (int i = 0; i < WIDTH * HEIGHT * kind.channels; i++)
            pixels.push_back(static_cast<float>((i * 37 + i / 40) % 256) / 255.0f);
        OIIO::ImageSpec spec(WIDTH, HEIGHT, kind.channels, types[kind.type]);
        if (kind.is_tiled)
            spec.tile_width = spec.tile_height = TILE;
        if (*kind.compression)
            spec.attribute("compression", kind.compression);
        auto output = OIIO::ImageOutput::create(kind.format);
        std::string path = std::string(folder) + "/" + kind.name;
        if (!output || !output->open(path, spec) ||
            !output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) || !output->close()) {
            std::fprintf(stderr, "cannot write %s: %s\n", kind.name,
                         output ? output->geterror().c_str() : OIIO::geterror().c_str());
            return false;
        }
    }
    return true;
}
