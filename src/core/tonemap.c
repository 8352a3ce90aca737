/* SPDX-License-Identifier: MIT */
#include "core/tonemap.h"

#include <stdlib.h>

#include "core/kernel_tonemap.h"
#include "core/math64.h"

/* 2^+-100 is a finite float, and beyond it no radiance worth showing is left. */
#define EXPOSURE_MAX_EV 100.0

static fl_tonemap_kernel *const kernels[FL_ISA_COUNT] = FL_ISA_TABLE(fl_tonemap_kernel);

static float float_of(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static bool reaches(uint32_t bits, uint32_t byte)
{
    return fl_d_srgb_encode((double)float_of(bits)) * 255.0 >= (double)byte - 0.5;
}

/* The least float that becomes `byte` or more: the inverse of the curve, then to the very float. */
static float least_float_of(uint32_t byte)
{
    uint32_t bits = bits_of((float)fl_d_srgb_decode(((double)byte - 0.5) / 255.0));
    while (!reaches(bits, byte))
        bits++;
    while (reaches(bits - 1, byte))
        bits--;
    return float_of(bits);
}

static void curve_make(fl_curve *out_curve)
{
    uint32_t byte = 0;
    float next = least_float_of(1);
    for (uint32_t i = 0; i < FL_CURVE_BUCKETS; i++) {
        float end = float_of((FL_CURVE_FIRST + i + 1) << FL_CURVE_SHIFT);
        out_curve->byte[i] = byte;
        out_curve->threshold[i] = 2.0f;
        if (byte == 255 || next >= end)
            continue;
        out_curve->threshold[i] = next;
        byte++;
        next = byte < 255 ? least_float_of(byte + 1) : 2.0f;
        FL_ASSERT(next >= end);
    }
    FL_ASSERT(byte == 255);
}

struct fl_tonemapper {
    fl_curve curve;
};

fl_tonemapper *fl_tonemapper_create(void)
{
    fl_tonemapper *mapper = malloc(sizeof *mapper);
    if (mapper)
        curve_make(&mapper->curve);
    return mapper;
}

void fl_tonemapper_destroy(fl_tonemapper *mapper)
{
    free(mapper);
}

void fl_tonemapper_run(const fl_tonemapper *mapper, const fl_tonemap *tonemap, const float *rgb,
                       size_t pixel_count, uint8_t *out_rgba)
{
    double ev = fl_clamp(tonemap->exposure_ev, -EXPOSURE_MAX_EV, EXPOSURE_MAX_EV);
    kernels[fl_cpu_best_isa()](rgb, pixel_count, (float)fl_d_exp2(ev),
                               tonemap->truncates ? NULL : &mapper->curve, out_rgba);
}

void fl_tonemap_rgba8(const fl_tonemap *tonemap, const float *rgb, size_t pixel_count,
                      uint8_t *out_rgba)
{
    fl_tonemapper mapper;
    if (!tonemap->truncates)
        curve_make(&mapper.curve);
    fl_tonemapper_run(&mapper, tonemap, rgb, pixel_count, out_rgba);
}
