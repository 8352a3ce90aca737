// SPDX-License-Identifier: MIT
//
// OpenImageIO behind plain C (image_codec.h). Every function is noexcept and catches everything.
#include "io/image_codec.h"

#include <OpenImageIO/imageio.h>

#include <cstdlib>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <strings.h>
#include <sys/mman.h>
#include <unistd.h>
#include <vector>

extern "C" {
extern const fl_codec fl_codec_oiio;
}

namespace
{

// One line of at most FL_CODEC_MESSAGE_BYTES, whatever the library says.
void put_message(const std::string &text, char *message) noexcept
{
    size_t length = 0;
    for (char c : text) {
        if (length + 1 == FL_CODEC_MESSAGE_BYTES)
            break;
        message[length++] = (unsigned char)c < ' ' ? ' ' : c;
    }
    while (length > 0 && (message[length - 1] == ' ' || message[length - 1] == '.'))
        length--;
    message[length] = '\0';
    if (length == 0)
        std::snprintf(message, FL_CODEC_MESSAGE_BYTES, "the image library gives no reason");
}

// The message of whatever is being thrown; called inside a catch-all.
void put_exception(char *message) noexcept
{
    try {
        throw;
    } catch (const std::exception &e) {
        put_message(e.what(), message);
    } catch (...) {
        put_message("unknown exception in the image library", message);
    }
}

char *copy_text(const std::string &text) noexcept
{
    char *copy = static_cast<char *>(std::malloc(text.size() + 1));
    if (copy)
        std::memcpy(copy, text.c_str(), text.size() + 1);
    return copy;
}

struct reader {
    std::unique_ptr<OIIO::ImageInput> input;
    fl_codec_header header;
};

// Integer samples are sRGB unless the file denies it; floating-point ones are linear unless it says
// sRGB.
bool is_linear(const OIIO::ImageSpec &spec)
{
    std::string space(spec.get_string_attribute("oiio:ColorSpace"));
    for (char &c : space)
        c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    if (space == "linear" || space == "scene_linear" || space == "lin_srgb" ||
        space == "lin_rec709")
        return true;
    return space.empty() && spec.format.is_floating_point();
}

bool begins_with(const std::string &head, size_t at, const char *text)
{
    return head.compare(at, std::strlen(text), text) == 0;
}

// The library's name of a file's format. Left to itself it believes the name and then tries every
// format that it knows, of which some are as large as a film player.
const char *find_format(const std::string &path, const std::string &head)
{
    static const struct {
        const char *start, *format;
    } starts[] = {{"\x89PNG", "png"},
                  {"\xFF\xD8\xFF", "jpeg"},
                  {"\x76\x2F\x31\x01", "openexr"},
                  {"#?", "hdr"},
                  {"II*", "tiff"},
                  {"II+", "tiff"},
                  {"MM", "tiff"},
                  {"BM", "bmp"},
                  {"GIF8", "gif"}};
    for (const auto &row : starts)
        if (begins_with(head, 0, row.start))
            return row.format;
    if (begins_with(head, 0, "RIFF") && head.size() >= 12 && begins_with(head, 8, "WEBP"))
        return "webp";
    if (head.size() >= 2 && head[0] == 'P' && std::strchr("123456Ff", head[1]))
        return "pnm";
    // The one format that does not say what it is.
    std::string ending = path.size() < 4 ? "" : path.substr(path.size() - 4);
    return strcasecmp(ending.c_str(), ".tga") == 0 ? "targa" : nullptr;
}

std::string read_head(const char *path)
{
    char bytes[16];
    std::FILE *file = std::fopen(path, "rb");
    size_t count = file ? std::fread(bytes, 1, sizeof bytes, file) : 0;
    if (file)
        std::fclose(file);
    return std::string(bytes, count);
}

void *open_reader(const char *path, fl_codec_header *out_header, char *message) noexcept
{
    try {
        const char *format = find_format(path, read_head(path));
        if (!format) {
            put_message("it is no PNG, JPEG, EXR, HDR, TIFF, TGA, BMP, PNM, GIF or WebP", message);
            return nullptr;
        }
        OIIO::ImageSpec spec, hints;
        hints.attribute("oiio:UnassociatedAlpha", 1); // Dropping alpha must not darken colours.
        auto input = OIIO::ImageInput::create(format);
        if (!input || !input->open(path, spec, hints)) {
            put_message(input ? input->geterror() : OIIO::geterror(), message);
            return nullptr;
        }
        if (spec.nchannels < 1 || spec.deep) {
            put_message("it has no plain colour channels", message);
            return nullptr;
        }
        bool is_8bit = spec.format == OIIO::TypeDesc::UINT8 && spec.channelformats.empty();
        *out_header = {spec.width, spec.height, spec.depth, is_8bit ? FL_CODEC_U8 : FL_CODEC_FLOAT,
                       is_linear(spec)};
        return new reader{std::move(input), *out_header};
    } catch (...) {
        put_exception(message);
        return nullptr;
    }
}

template <typename T> void spread_grey(T *rgb, size_t pixel_count)
{
    for (size_t i = 0; i < pixel_count; i++)
        rgb[3 * i + 1] = rgb[3 * i + 2] = rgb[3 * i];
}

bool read_pixels(void *opaque, void *out_rgb, char *message) noexcept
{
    try {
        reader *from = static_cast<reader *>(opaque);
        bool is_8bit = from->header.sample == FL_CODEC_U8;
        OIIO::TypeDesc type = is_8bit ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT;
        bool is_color = from->input->spec().nchannels >= 3;
        auto stride = static_cast<OIIO::stride_t>(3 * type.size());
        if (!from->input->read_image(0, 0, 0, is_color ? 3 : 1, type, out_rgb, stride)) {
            put_message(from->input->geterror(), message);
            return false;
        }
        size_t pixel_count =
            static_cast<size_t>(from->header.width) * static_cast<size_t>(from->header.height);
        if (!is_color && is_8bit)
            spread_grey(static_cast<uint8_t *>(out_rgb), pixel_count);
        else if (!is_color)
            spread_grey(static_cast<float *>(out_rgb), pixel_count);
        return true;
    } catch (...) {
        put_exception(message);
        return false;
    }
}

// TIFF has one field for free text: the pairs stand in it as lines "key=value", values last and
// whole.
std::string description_line(const fl_image_text &text)
{
    std::string line = std::string(text.key) + "=";
    for (const char *c = text.value; *c; c++)
        line += *c == '\\' ? "\\\\" : *c == '\n' ? "\\n" : std::string(1, *c);
    return line + "\n";
}

// False: there is none.
bool find_in_description(const std::string &description, const std::string &key, std::string &value)
{
    std::string start = key + "=";
    for (size_t at = 0; at < description.size();) {
        size_t end = description.find('\n', at);
        end = end == std::string::npos ? description.size() : end;
        if (description.compare(at, start.size(), start) == 0) {
            for (size_t i = at + start.size(); i < end; i++) {
                bool is_escape = description[i] == '\\' && i + 1 < end;
                i += is_escape;
                value += is_escape && description[i] == 'n' ? '\n' : description[i];
            }
            return true;
        }
        at = end + 1;
    }
    return false;
}

bool find_text(void *opaque, const char *key, char **out_text) noexcept
{
    *out_text = nullptr;
    try {
        const OIIO::ImageSpec &spec = static_cast<reader *>(opaque)->input->spec();
        const OIIO::ParamValue *found = spec.find_attribute(key, OIIO::TypeDesc::STRING);
        std::string value;
        if (found)
            value = found->get_string();
        else if (!find_in_description(std::string(spec.get_string_attribute("ImageDescription")),
                                      key, value))
            return true;
        *out_text = copy_text(value);
    } catch (...) {
    }
    return *out_text != nullptr;
}

void close_reader(void *opaque) noexcept
{
    try {
        delete static_cast<reader *>(opaque);
    } catch (...) {
    }
}

OIIO::ImageSpec make_spec(const fl_codec_picture *picture, OIIO::TypeDesc type,
                          const fl_image_text *texts, size_t text_count)
{
    OIIO::ImageSpec spec(static_cast<int>(picture->width), static_cast<int>(picture->height), 3,
                         type);
    spec.attribute("oiio:ColorSpace", picture->is_linear ? "Linear" : "sRGB");
    // Always the same, so that the same picture is the same file.
    spec.attribute("Software", "firstlight");
    spec.attribute("DateTime", "2000:01:01 00:00:00");
    if (std::strcmp(picture->format, "tiff") != 0) {
        for (size_t i = 0; i < text_count; i++)
            spec.attribute(texts[i].key, texts[i].value);
        return spec;
    }
    spec.attribute("compression", "zip");
    std::string description;
    for (size_t i = 0; i < text_count; i++)
        description += description_line(texts[i]);
    if (!description.empty())
        spec.attribute("ImageDescription", description);
    return spec;
}

// A file without a name, in memory. The library writes it by its path under /proc; its own memory
// buffers do not serve, as its TIFF writer needs to read back what it wrote.
struct memory_file {
    int file = memfd_create("firstlight", MFD_CLOEXEC);
    ~memory_file()
    {
        if (file >= 0)
            close(file);
    }
    memory_file() = default;
    memory_file(const memory_file &) = delete;
    memory_file &operator=(const memory_file &) = delete;
    std::string path() const { return "/proc/self/fd/" + std::to_string(file); }
};

// Copy the whole file to memory from malloc.
bool take_bytes(const memory_file &from, void **out_bytes, size_t *out_count)
{
    off_t size = lseek(from.file, 0, SEEK_END);
    char *bytes = size > 0 ? static_cast<char *>(std::malloc(static_cast<size_t>(size))) : nullptr;
    off_t got = 0;
    while (bytes && got < size) {
        ssize_t n = pread(from.file, bytes + got, static_cast<size_t>(size - got), got);
        if (n <= 0) {
            std::free(bytes);
            return false;
        }
        got += n;
    }
    *out_bytes = bytes;
    *out_count = static_cast<size_t>(size);
    return bytes != nullptr;
}

// The library does not notice every write that fails, so what it has written must read back. Not
// PNG: reading a cut one leaks, and its structure is enough (fl_image_is_whole).
bool reads_back(const memory_file &written, const fl_codec_picture *picture, OIIO::TypeDesc type)
{
    if (std::strcmp(picture->format, "png") == 0)
        return true;
    std::vector<unsigned char> pixels(size_t{3} * picture->width * picture->height * type.size());
    auto input = OIIO::ImageInput::create(picture->format);
    OIIO::ImageSpec spec;
    return input && input->open(written.path(), spec) &&
           spec.image_bytes(true) == static_cast<OIIO::imagesize_t>(pixels.size()) &&
           input->read_image(0, 0, 0, 3, type, pixels.data());
}

bool encode(const fl_codec_picture *picture, const fl_image_text *texts, size_t text_count,
            void **out_bytes, size_t *out_count, char *message) noexcept
{
    try {
        OIIO::TypeDesc type = picture->sample == FL_CODEC_U8    ? OIIO::TypeDesc::UINT8
                              : picture->sample == FL_CODEC_U16 ? OIIO::TypeDesc::UINT16
                                                                : OIIO::TypeDesc::FLOAT;
        memory_file memory;
        auto output = OIIO::ImageOutput::create(picture->format);
        if (!output) {
            put_message(OIIO::geterror(), message);
            return false;
        }
        OIIO::ImageSpec spec = make_spec(picture, type, texts, text_count);
        if (!output->open(memory.path(), spec) || !output->write_image(type, picture->pixels) ||
            !output->close()) {
            put_message(output->geterror(), message);
            return false;
        }
        if (!reads_back(memory, picture, type)) {
            put_message("not all of it could be written", message);
            return false;
        }
        if (!take_bytes(memory, out_bytes, out_count)) {
            put_message("out of memory", message);
            return false;
        }
        return true;
    } catch (...) {
        put_exception(message);
        return false;
    }
}

} // namespace

extern "C" __attribute__((visibility("default")))
const fl_codec fl_codec_oiio = {open_reader, read_pixels, find_text, close_reader, encode};
