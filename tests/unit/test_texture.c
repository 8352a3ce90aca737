/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/texture.h"

/* cmocka's own takes floats. */
static void assert_near(double got, double want, double bound)
{
    if (!(fabs(got - want) <= bound))
        fail_msg("got %.9g, want %.9g within %g", got, want, bound);
}

/* A small picture whose texels tell their place: red = column, green = row from the bottom. */
static fl_image *numbered(uint32_t width, uint32_t height)
{
    fl_image *image = fl_image_create(width, height, FL_PIXEL_FLOAT);
    assert_non_null(image);
    float *p = image->pixels;
    for (uint32_t row = 0; row < height; row++)
        for (uint32_t column = 0; column < width; column++) {
            float *texel = p + 3 * ((size_t)row * width + column);
            texel[0] = (float)column;
            texel[1] = (float)(height - 1 - row);
            texel[2] = 1.0f;
        }
    return image;
}

static fl_texture texture_of(fl_image *image, fl_filter filter, bool clamps_v)
{
    return (fl_texture){.image = image, .filter = filter, .scale = {1, 1}, .clamps_v = clamps_v};
}

static void texel_centers_are_exact(void **state)
{
    (void)state;
    fl_image *image = numbered(8, 4);
    for (int filter = FL_FILTER_BILINEAR; filter <= FL_FILTER_NEAREST; filter++) {
        fl_texture t = texture_of(image, (fl_filter)filter, false);
        for (int i = -16; i < 16; i++)
            for (int j = -8; j < 8; j++) {
                float rgb[3];
                fl_texture_eval(&t, ((float)i + 0.5f) / 8.0f, ((float)j + 0.5f) / 4.0f, rgb);
                assert_true(rgb[0] == (float)((i + 16) % 8));
                assert_true(rgb[1] == (float)((j + 8) % 4));
                assert_true(rgb[2] == 1.0f);
            }
    }
    fl_image_release(image);
}

/* Straight from the definition: weights of all texels under a tent of one texel's width. */
static void blend_slowly(const fl_texture *t, double u, double v, double rgb[3])
{
    const fl_image *image = t->image;
    double w = image->width, h = image->height;
    double x = (u - floor(u)) * w, y = t->clamps_v ? fl_clamp(v, 0, 1) * h : (v - floor(v)) * h;
    if (t->clamps_v)
        y = fl_clamp(y, 0.5, h - 0.5);
    rgb[0] = rgb[1] = rgb[2] = 0;
    for (int j = -1; j <= (int)h; j++)
        for (int i = -1; i <= (int)w; i++) {
            double weight = fl_max(0, 1 - fabs(x - i - 0.5)) * fl_max(0, 1 - fabs(y - j - 0.5));
            int column = (i + (int)w) % (int)w, row = (int)h - 1 - (j + (int)h) % (int)h;
            const float *texel = (const float *)image->pixels + 3 * (row * (int)w + column);
            for (int c = 0; c < 3; c++)
                rgb[c] += weight * (double)texel[c];
        }
}

static void bilinear_follows_its_definition(void **state)
{
    (void)state;
    uint32_t seed = 12345;
    print_message("seed %u\n", seed);
    for (int k = 0; k < 20000; k++) {
        if (k % 1000 == 0)
            seed = fl_lowbias32(seed + 1);
        fl_image *image = numbered(1 + (uint32_t)k % 7, 1 + (uint32_t)k % 5);
        fl_texture t = texture_of(image, FL_FILTER_BILINEAR, k % 2 == 0);
        seed = fl_lowbias32(seed + 0x9E3779B9u);
        float u = (float)(seed >> 8) * 0x1p-22f - 2.0f;
        seed = fl_lowbias32(seed + 0x9E3779B9u);
        float v = (float)(seed >> 8) * 0x1p-22f - 2.0f, rgb[3];
        double want[3];
        fl_texture_eval(&t, u, v, rgb);
        blend_slowly(&t, (double)u, (double)v, want);
        for (int c = 0; c < 3; c++)
            assert_near((double)rgb[c], want[c], 1e-5);
        fl_image_release(image);
    }
}

static void v_clamps_where_asked(void **state)
{
    (void)state;
    fl_image *image = numbered(2, 4);
    fl_texture t = texture_of(image, FL_FILTER_BILINEAR, true);
    float rgb[3];
    fl_texture_eval(&t, 0.25f, 0.0f, rgb);
    assert_true(rgb[1] == 0.0f);
    fl_texture_eval(&t, 0.25f, 1.0f, rgb);
    assert_true(rgb[1] == 3.0f);
    fl_texture_eval(&t, 0.25f, -7.0f, rgb);
    assert_true(rgb[1] == 0.0f);
    t.clamps_v = false; /* halfway between the last row and the first */
    fl_texture_eval(&t, 0.25f, 1.0f, rgb);
    assert_true(rgb[1] == 1.5f);
    t.scale[0] = 4;
    t.scale[1] = 0.25f;
    fl_texture_eval(&t, 0.0625f, 1.5f, rgb);
    assert_true(rgb[0] == 0.0f && rgb[1] == 1.0f);
    fl_image_release(image);
}

static void any_coordinate_is_safe(void **state)
{
    (void)state;
    static const float odd[] = {0.0f,    -0.0f,       1.0f,  -1.0f,  1e-45f, -1e-45f,
                                -1e-20f, 0.99999994f, 1e20f, -1e38f, 3e38f};
    fl_image *image = numbered(3, 3);
    for (size_t i = 0; i < FL_COUNT_OF(odd) + 3; i++)
        for (size_t j = 0; j < FL_COUNT_OF(odd) + 3; j++)
            for (int kind = 0; kind < 4; kind++) {
                const float bad[] = {NAN, INFINITY, -INFINITY};
                float u = i < 3 ? bad[i] : odd[i - 3], v = j < 3 ? bad[j] : odd[j - 3], rgb[3];
                fl_texture t =
                    texture_of(image, kind & 1 ? FL_FILTER_NEAREST : FL_FILTER_BILINEAR, kind & 2);
                t.scale[0] = t.scale[1] = 1e30f;
                fl_texture_eval(&t, u, v, rgb);
                assert_true(rgb[0] >= 0.0f && rgb[0] <= 2.0f && rgb[1] >= 0.0f && rgb[1] <= 2.0f);
            }
    fl_image_release(image);
}

static void large_pictures_keep_their_texels(void **state)
{
    (void)state;
    fl_image *image = numbered(16384, 2);
    fl_texture t = texture_of(image, FL_FILTER_BILINEAR, false);
    for (uint32_t i = 0; i < 16384; i++) {
        float rgb[3];
        fl_texture_eval(&t, ((float)i + 0.5f) / 16384.0f, 0.25f, rgb);
        assert_true(rgb[0] == (float)i && rgb[1] == 0.0f);
    }
    fl_image_release(image);
}

static void bytes_are_decoded(void **state)
{
    (void)state;
    fl_image *image = fl_image_create(1, 1, FL_PIXEL_SRGB8);
    uint8_t *p = image->pixels;
    p[0] = 0;
    p[1] = 128;
    p[2] = 255;
    fl_texture t = texture_of(image, FL_FILTER_BILINEAR, false);
    float rgb[3];
    fl_texture_eval(&t, 0.3f, 0.8f, rgb);
    assert_true(rgb[0] == 0.0f && rgb[1] == fl_srgb8_to_linear[128] && rgb[2] == 1.0f);
    image->format = FL_PIXEL_LINEAR8;
    t.filter = FL_FILTER_NEAREST;
    fl_texture_eval(&t, 0.3f, 0.8f, rgb);
    assert_true(rgb[0] == 0.0f && rgb[1] == 128.0f / 255.0f && rgb[2] == 1.0f);
    fl_image_release(image);
}

/* A cube whose texels hold the direction that sees them, if pictures are upright from inside. */
static void cube_faces_meet_at_their_edges(void **state)
{
    (void)state;
    enum { N = 64 };
    static const double main_axis[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                           {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    static const double right[6][3] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0},
                                       {1, 0, 0}, {-1, 0, 0}, {1, 0, 0}};
    static const double up[6][3] = {{0, 1, 0},  {0, 1, 0}, {0, 0, 1},
                                    {0, 0, -1}, {0, 1, 0}, {0, 1, 0}};
    fl_image *faces[6];
    for (int f = 0; f < 6; f++) {
        /* Seen from inside: looking along `main`, `right` is on the right hand. */
        fl_vec3 m = fl_v3(main_axis[f][0], main_axis[f][1], main_axis[f][2]);
        fl_vec3 u = fl_v3(up[f][0], up[f][1], up[f][2]), r = fl_v3_cross(m, u);
        assert_true(r.x == right[f][0] && r.y == right[f][1] && r.z == right[f][2]);
        faces[f] = fl_image_create(N, N, FL_PIXEL_FLOAT);
        for (int row = 0; row < N; row++)
            for (int column = 0; column < N; column++)
                for (int c = 0; c < 3; c++) {
                    double s = (column + 0.5) / N * 2 - 1, t = 1 - (row + 0.5) / N * 2;
                    double d = main_axis[f][c] + s * right[f][c] + t * up[f][c];
                    ((float *)faces[f]->pixels)[3 * (row * N + column) + c] = (float)d;
                }
    }
    uint32_t seed = 99;
    for (int k = 0; k < 20000; k++) {
        float d[3], rgb[3], largest = 0.0f;
        for (int c = 0; c < 3; c++) {
            seed = fl_lowbias32(seed + 0x9E3779B9u);
            d[c] = (float)(seed >> 8) * 0x1p-23f - 1.0f;
            largest = fmaxf(largest, fabsf(d[c]));
        }
        fl_cube_eval(faces, d, false, rgb);
        for (int c = 0; c < 3; c++)
            assert_near((double)rgb[c], (double)(d[c] / largest), 1.01 / N);
    }
    float odd[3] = {NAN, 0, 0}, rgb[3];
    fl_cube_eval(faces, odd, false, rgb);
    assert_true(isfinite(rgb[0]));
    /* The course reads back mirrored. */
    float d[3] = {0.5f, 0.25f, -1.0f};
    fl_cube_eval(faces, d, true, rgb);
    assert_near((double)rgb[0], -0.5, 2.0 / N);
    assert_near((double)rgb[1], 0.25, 2.0 / N);
    for (int f = 0; f < 6; f++)
        fl_image_release(faces[f]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texel_centers_are_exact),
        cmocka_unit_test(bilinear_follows_its_definition),
        cmocka_unit_test(v_clamps_where_asked),
        cmocka_unit_test(any_coordinate_is_safe),
        cmocka_unit_test(large_pictures_keep_their_texels),
        cmocka_unit_test(bytes_are_decoded),
        cmocka_unit_test(cube_faces_meet_at_their_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
