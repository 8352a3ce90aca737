/* SPDX-License-Identifier: MIT
 *
 * image_file.h: what is written is read back, the kinds of pixels a file may have, and every class
 * of wrong file.
 */
#include "temp_files.h"

#include <math.h>
#include <signal.h>
#include <sys/resource.h>

#include "io/image_file.h"
#include "io/image_whole.h"

static const fl_loc here = {"a.scene", 12, 5, 3};

static fl_image *load(const char *path)
{
    fl_diags diags = {0};
    fl_image *image = fl_image_load(path, here, &diags);
    expect_none(&diags);
    assert_non_null(image);
    return image;
}

static void refuse(const char *path, const char *part)
{
    fl_diags diags = {0};
    assert_null(fl_image_load(path, here, &diags));
    assert_int_equal(diags.items[0].loc.line, 12);
    expect_error(&diags, FL_CAUSE_INPUT, part);
}

static void save(const char *path, const fl_image *image)
{
    fl_diags diags = {0};
    assert_true(fl_image_save(path, image, NULL, 0, &diags));
    expect_none(&diags);
}

/* All byte values, in no order that a mistake could keep. */
static fl_image *make_bytes(fl_pixel_format format)
{
    fl_image *image = fl_image_create(37, 23, format);
    for (size_t i = 0; i < fl_image_bytes(image); i++)
        ((uint8_t *)image->pixels)[i] = (uint8_t)(i * 167 + i / 256);
    return image;
}

static fl_image *make_floats(void)
{
    fl_image *image = fl_image_create(19, 11, FL_PIXEL_FLOAT);
    for (size_t i = 0; i < 19 * 11 * 3; i++)
        ((float *)image->pixels)[i] = (float)i * (float)i / 39000.0f;
    return image;
}

/* ---- Written and read back ---- */

static void bytes_come_back_as_they_were(void **state)
{
    (void)state;
    static const char *const names[] = {"b.png", "b.tif", "B.TIFF", "b.bmp",
                                        "b l\xc3\xbc \xe8\x8a\xb1.png"};
    fl_image *image = make_bytes(FL_PIXEL_SRGB8);
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        save(temp_path(names[i]), image);
        fl_image *back = load(temp_path(names[i]));
        assert_int_equal(back->format, FL_PIXEL_SRGB8);
        assert_int_equal(back->width, 37);
        assert_int_equal(back->height, 23);
        assert_memory_equal(back->pixels, image->pixels, fl_image_bytes(image));
        fl_image_release(back);
    }
    save(temp_path("b.exr"), image); /* decoded to linear */
    fl_image *back = load(temp_path("b.exr"));
    assert_int_equal(back->format, FL_PIXEL_FLOAT);
    for (size_t i = 0; i < fl_image_bytes(image); i++)
        assert_true(((const float *)back->pixels)[i] ==
                    fl_srgb8_to_linear[((const uint8_t *)image->pixels)[i]]);
    fl_image_release(back);
    fl_image_release(image);
}

static void floats_come_back_as_the_file_can_hold_them(void **state)
{
    (void)state;
    fl_image *image = make_floats();
    const float *from = image->pixels;
    size_t count = 19 * 11 * 3;
    static const char *const exact[] = {"f.exr", "f.tif"};
    for (size_t k = 0; k < FL_COUNT_OF(exact); k++) {
        save(temp_path(exact[k]), image);
        fl_image *back = load(temp_path(exact[k]));
        assert_int_equal(back->format, FL_PIXEL_FLOAT);
        assert_memory_equal(back->pixels, image->pixels, fl_image_bytes(image));
        fl_image_release(back);
    }
    save(temp_path("f.png"), image);
    fl_image *deep = load(temp_path("f.png"));
    assert_int_equal(deep->format, FL_PIXEL_FLOAT);
    save(temp_path("f.bmp"), image);
    fl_image *flat = load(temp_path("f.bmp"));
    assert_int_equal(flat->format, FL_PIXEL_SRGB8);
    for (size_t i = 0; i < count; i++) {
        double want = fl_min((double)from[i], 1.0);
        double step = fl_srgb_to_linear(fl_srgb_from_linear(want) + 0.51 / 65535) - want;
        double got = (double)((const float *)deep->pixels)[i];
        assert_true(fabs(got - want) <= fl_max(step, 0.51 / 65535 * 2.3));
        int byte = (int)(fl_srgb_from_linear(want) * 255.0 + 0.5);
        assert_int_equal(((const uint8_t *)flat->pixels)[i], byte);
    }
    fl_image_release(deep);
    fl_image_release(flat);
    fl_image_release(image);
}

static void the_same_picture_is_the_same_file(void **state)
{
    (void)state;
    static const char *const names[] = {"1.png", "1.exr", "1.tif", "1.bmp"};
    const fl_image_text text = {"firstlight:camera", "0 1 2"};
    fl_image *image = make_bytes(FL_PIXEL_SRGB8);
    fl_diags diags = {0};
    size_t count[2];
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        assert_true(fl_image_save(temp_path(names[i]), image, &text, 1, &diags));
        unsigned char *first = temp_read(temp_path(names[i]), &count[0]);

        assert_true(fl_image_save(temp_path(names[i]), image, &text, 1, &diags));
        unsigned char *second = temp_read(temp_path(names[i]), &count[1]);
        assert_int_equal(count[0], count[1]);
        assert_memory_equal(first, second, count[0]);
        free(first);
        free(second);
    }
    fl_image_release(image);
}

static void texts_are_kept_in_the_file(void **state)
{
    (void)state;
    static const char *const names[] = {"t.png", "t.exr", "t.tif"};
    const fl_image_text texts[] = {{"firstlight:scene", "Gr\xc3\xbc\xc3\x9f"
                                                        "e = a\\nb\nline two\n"},
                                   {"firstlight:empty", ""},
                                   {"firstlight:samples", "16"}};
    fl_image *image = make_bytes(FL_PIXEL_SRGB8);
    fl_diags diags = {0};
    char *text;
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        assert_true(fl_image_save(temp_path(names[i]), image, texts, 3, &diags));
        for (size_t k = 0; k < 3; k += 2) {
            assert_true(fl_image_load_text(temp_path(names[i]), texts[k].key, here, &diags, &text));
            assert_non_null(text);
            assert_string_equal(text, texts[k].value);
            free(text);
        }
        assert_true(
            fl_image_load_text(temp_path(names[i]), "firstlight:none", here, &diags, &text));
        assert_null(text);
    }
    expect_none(&diags);
    assert_false(fl_image_load_text(temp_path("none.png"), "a", here, &diags, &text));
    expect_error(&diags, FL_CAUSE_INPUT, "No such file");
    fl_image_release(image);
}

/* ---- Files of others ---- */

static void put_u32(uint8_t *at, uint32_t x)
{
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(x >> (24 - 8 * i));
}

static size_t put_chunk(uint8_t *at, const char *name, const uint8_t *data, uint32_t bytes)
{
    uint32_t crc = 0xFFFFFFFFu;
    put_u32(at, bytes);
    memcpy(at + 4, name, 4);
    memcpy(at + 8, data, bytes);
    for (uint32_t i = 0; i < bytes + 4; i++) {
        crc ^= at[4 + i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    }
    put_u32(at + 8 + bytes, ~crc);
    return bytes + 12;
}

/* A PNG of one row, 8 bits a channel; gamma 100000 says linear, 0 says nothing. */
static const char *write_png(const char *name, uint32_t width, uint8_t color_type, uint32_t gamma,
                             const uint8_t *row, uint32_t row_bytes)
{
    uint8_t file[512], data[256] = {0};
    size_t used = 8;
    memcpy(file, "\x89PNG\r\n\x1a\n", 8);
    put_u32(data, width);
    put_u32(data + 4, 1);
    memcpy(data + 8, (const uint8_t[]){8, color_type, 0, 0, 0}, 5);
    used += put_chunk(file + used, "IHDR", data, 13);
    put_u32(data, gamma);
    if (gamma)
        used += put_chunk(file + used, "gAMA", data, 4);
    uint32_t a = 1, b = 0, n = row_bytes + 1;
    memcpy(data, (const uint8_t[]){0x78, 1, 1, (uint8_t)n, 0, (uint8_t)~n, 0xFF, 0}, 8);
    memcpy(data + 8, row, row_bytes);
    for (uint32_t i = 0; i < n; i++) {
        a = (a + data[7 + i]) % 65521;
        b = (b + a) % 65521;
    }
    put_u32(data + 7 + n, b << 16 | a);
    used += put_chunk(file + used, "IDAT", data, 11 + n);
    used += put_chunk(file + used, "IEND", data, 0);
    return temp_write(name, file, used);
}

static void grey_alpha_and_linear_files_are_understood(void **state)
{
    (void)state;
    static const uint8_t row[] = {10, 200, 30, 0, 40, 50, 60, 128};
    static const struct {
        uint8_t color_type;
        uint32_t width, row_bytes, gamma;
        fl_pixel_format format;
        uint8_t want[6];
    } cases[] = {
        {0, 2, 2, 0, FL_PIXEL_SRGB8, {10, 10, 10, 200, 200, 200}},     /* grey */
        {4, 2, 4, 0, FL_PIXEL_SRGB8, {10, 10, 10, 30, 30, 30}},        /* grey, alpha */
        {2, 2, 6, 0, FL_PIXEL_SRGB8, {10, 200, 30, 0, 40, 50}},        /* RGB */
        {6, 2, 8, 0, FL_PIXEL_SRGB8, {10, 200, 30, 40, 50, 60}},       /* RGB, alpha 0 and 1/2 */
        {2, 2, 6, 100000, FL_PIXEL_LINEAR8, {10, 200, 30, 0, 40, 50}}, /* says linear */
        {2, 2, 6, 45455, FL_PIXEL_SRGB8, {10, 200, 30, 0, 40, 50}},    /* 1/2.2: sRGB */
    };
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        fl_image *image = load(write_png("kind.png", cases[i].width, cases[i].color_type,
                                         cases[i].gamma, row, cases[i].row_bytes));
        assert_int_equal(image->format, cases[i].format);
        assert_int_equal(fl_image_bytes(image), 6);
        assert_memory_equal(image->pixels, cases[i].want, 6);
        fl_image_release(image);
    }
}

static void a_wrong_extension_does_not_matter(void **state)
{
    (void)state;
    fl_image *image = make_bytes(FL_PIXEL_SRGB8);
    save(temp_path("real.png"), image);
    assert_int_equal(rename(temp_path("real.png"), temp_path("called.bmp")), 0);
    fl_image *back = load(temp_path("called.bmp"));
    assert_memory_equal(back->pixels, image->pixels, fl_image_bytes(image));
    fl_image_release(back);
    fl_image_release(image);
}

static void what_is_no_picture_is_refused(void **state)
{
    (void)state;
    refuse(temp_path("none.png"), "No such file");
    refuse(temp_folder, "it is a folder");
    refuse(temp_write("empty.png", "", 0), "is empty");
    refuse(temp_write("text.png", "not a picture at all\n", 21), "it is no PNG, JPEG, EXR");
    refuse(temp_write("text", "not a picture at all\n", 21), "cannot read image");
    refuse("/dev/zero", "not a regular file");
    assert_int_equal(mkfifo(temp_path("pipe.png"), 0666), 0);
    refuse(temp_path("pipe.png"), "not a regular file");
    /* A header that promises 60,000 x 60,000 pixels, and one beyond the side limit. */
    static const char huge[] = "P6\n60000 60000\n255\nabc";
    refuse(temp_write("huge.ppm", huge, sizeof huge - 1), "too large");
    static const char wide[] = "P6\n70000 1\n255\nabc";
    refuse(temp_write("wide.ppm", wide, sizeof wide - 1), "at most 65536 a side");
}

/* A picture of so many pixels that has none of its bytes. */
static const char *write_head(uint32_t width, uint32_t height)
{
    char head[64];
    int bytes = snprintf(head, sizeof head, "P6\n%u %u\n255\n", width, height);
    return temp_write("head.ppm", head, (size_t)bytes);
}

static void sizes_are_limited(void **state)
{
    (void)state;
    const char *path = write_head(FL_IMAGE_SIDE_MAX, 1);
    assert_int_equal(truncate(path, 20 + 3 * FL_IMAGE_SIDE_MAX), 0);
    fl_image *image = load(path);
    assert_int_equal(image->width, FL_IMAGE_SIDE_MAX);
    fl_image_release(image);
    refuse(write_head(FL_IMAGE_SIDE_MAX + 1, 1), "65537 x 1 pixels, at most 65536 a side");
    refuse(write_head(1, FL_IMAGE_SIDE_MAX + 1), "1 x 65537 pixels, at most 65536 a side");
    const uint32_t rows = (uint32_t)(FL_IMAGE_MAX_BYTES / (3 * FL_IMAGE_SIDE_MAX));
    refuse(write_head(FL_IMAGE_SIDE_MAX, rows), "it should have 65536 x 5461 pixels, and has");
    refuse(write_head(FL_IMAGE_SIDE_MAX, rows + 1),
           "1073872896 bytes in memory, at most 1073741824");
}

/* A kilobyte of an EXR or a GIF whose head asks for gigabytes: refused before the library takes
 * them. */
static void heads_that_promise_too_much_are_refused(void **state)
{
    (void)state;
    size_t count, at = 0;
    fl_image *image = make_bytes(FL_PIXEL_SRGB8);
    save(temp_path("large.exr"), image);
    fl_image_release(image);
    uint8_t *bytes = temp_read(temp_path("large.exr"), &count);
    while (memcmp(bytes + at, "dataWindow\0box2i", 17) != 0)
        at++;
    memcpy(bytes + at + 21, (const uint8_t[16]){[8] = 0xFF, 0xFF, 0, 0, 0xFF, 0xFF}, 16);
    refuse(temp_write("large.exr", bytes, count), "too large");
    memcpy(bytes + at + 21, (const uint8_t[16]){[8] = 0xFF, 0x3F, 0, 0, 0xFF, 0x1F}, 16);
    refuse(temp_write("large.exr", bytes, count), "should have 16384 x 8192 pixels, and has");
    memcpy(bytes + at + 17, (const uint8_t[4]){0, 0, 0, 0x40}, 4);
    refuse(temp_write("large.exr", bytes, count), "cut off");
    free(bytes);
    refuse(temp_write("large.gif", "GIF89a\xFF\x7F\xFF\x1F\x80\0\0", 13), "32767 x 8191 pixels");
}

static void cut_off_files_are_refused(void **state)
{
    (void)state;
    static const char *const names[] = {"cut.png", "cut.exr", "cut.tif", "cut.bmp"};
    fl_image *image = make_bytes(FL_PIXEL_SRGB8);
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        size_t count;
        save(temp_path(names[i]), image);
        unsigned char *bytes = temp_read(temp_path(names[i]), &count);
        for (size_t eighths = 1; eighths < 8; eighths++)
            refuse(temp_write(names[i], bytes, count * eighths / 8), "cannot read image");
        free(bytes);
    }
    fl_image_release(image);
}

static void the_end_of_a_jpeg_is_looked_for_where_it_is(void **state)
{
    (void)state;
    /* A thumbnail's end in a comment, fill bytes, a scan with a stuffed FF and a restart, an end.
     */
    static const uint8_t jpeg[] = {0xFF, 0xD8, 0xFF, 0xFE, 0, 4,    0xFF, 0xD9, 0xFF, 0xFF, 0xDA,
                                   0,    2,    1,    0xFF, 0, 0xFF, 0xD0, 7,    0xFF, 0xD9, 9};
    for (size_t i = 0; i <= sizeof jpeg; i++) /* from three bytes on it is known for a JPEG */
        assert_int_equal(fl_image_is_whole(jpeg, i), i < 3 || i >= sizeof jpeg - 1);
}

static void a_float_that_is_no_number_is_refused(void **state)
{
    (void)state;
    fl_image *image = make_floats();
    ((float *)image->pixels)[(5 * 19 + 4) * 3 + 1] = NAN;
    save(temp_path("nan.exr"), image);
    refuse(temp_path("nan.exr"), "no finite number at 4, 5");
    fl_image_release(image);
}

/* ---- Writing ---- */

static void names_choose_the_format(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_pixel_format format;
    assert_true(fl_image_format_for("a/b.PNG", &diags, &format) && format == FL_PIXEL_SRGB8);
    assert_true(fl_image_format_for("x.exr", &diags, &format) && format == FL_PIXEL_FLOAT);
    static const char *const bad[] = {"", "png", "a.png/b", "x.jpg", "x.png ", "."};
    for (size_t i = 0; i < FL_COUNT_OF(bad); i++) {
        assert_false(fl_image_format_for(bad[i], &diags, &format));
        expect_error(&diags, FL_CAUSE_INPUT, ".png .exr .tif .tiff or .bmp");
    }
}

static void a_failed_write_keeps_the_old_file(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_image *image = make_bytes(FL_PIXEL_SRGB8);
    assert_false(fl_image_save(temp_path("no folder/x.png"), image, NULL, 0, &diags));
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "No such file or directory");

    /* A full disk, or memory: limits that bite at once, in the middle and in the last bytes. */
    static const char *const names[] = {"old.png", "old.exr", "old.tif", "old.bmp"};
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, SIG_IGN);
    for (size_t i = 0; i < 3 * FL_COUNT_OF(names); i++) {
        size_t count;
        const char *path = temp_path(names[i / 3]);
        assert_true(fl_image_save(path, image, NULL, 0, &diags));
        free(temp_read(path, &count));
        temp_write(names[i / 3], "old", 3);
        int entries = temp_count();
        rlim_t limit = i % 3 == 0 ? 100 : i % 3 == 1 ? count / 2 : count - 1;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, before.rlim_max}), 0);
        bool is_saved = fl_image_save(path, image, NULL, 0, &diags);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
        if (is_saved)
            fail_msg("%s was cut at %ju of %zu bytes and called good", path, (uintmax_t)limit,
                     count);
        expect_error(&diags, FL_CAUSE_ENVIRONMENT, "cannot write");
        unsigned char *bytes = temp_read(path, &count);
        assert_int_equal(count, 3);
        assert_memory_equal(bytes, "old", 3);
        free(bytes);
        assert_int_equal(temp_count(), entries);
    }
    signal(SIGXFSZ, SIG_DFL);
    fl_image_release(image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_come_back_as_they_were),
        cmocka_unit_test(floats_come_back_as_the_file_can_hold_them),
        cmocka_unit_test(the_same_picture_is_the_same_file),
        cmocka_unit_test(texts_are_kept_in_the_file),
        cmocka_unit_test(grey_alpha_and_linear_files_are_understood),
        cmocka_unit_test(a_wrong_extension_does_not_matter),
        cmocka_unit_test(what_is_no_picture_is_refused),
        cmocka_unit_test(sizes_are_limited),
        cmocka_unit_test(heads_that_promise_too_much_are_refused),
        cmocka_unit_test(cut_off_files_are_refused),
        cmocka_unit_test(the_end_of_a_jpeg_is_looked_for_where_it_is),
        cmocka_unit_test(a_float_that_is_no_number_is_refused),
        cmocka_unit_test(names_choose_the_format),
        cmocka_unit_test(a_failed_write_keeps_the_old_file),
    };
    return cmocka_run_group_tests(tests, temp_begin, temp_end);
}
