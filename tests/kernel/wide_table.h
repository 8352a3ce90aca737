/* SPDX-License-Identifier: MIT
 *
 * The operations of the wide headers behind plain function pointers: wide_table.c is compiled once
 * per instruction set, so one test program can hold all of them against the scalar definitions.
 */
#ifndef FL_WIDE_TABLE_H
#define FL_WIDE_TABLE_H

#include "core/cpu.h"
#include "core/sample_warp.h"
#include "core/sampler.h"

/** Apply an operation to a[i], b[i] for i < n, n a multiple of 8. The first result goes to out[i],
 * a second one to out[n + i]; operations with one result leave the second half alone. */
typedef void fl_wide_run(float *out, const float *a, const float *b, size_t n);

/* name, results. Masks come out as 0.0 or 1.0. */
#define FL_WIDE_OPS(X)                                                                             \
    X(min, 1)                                                                                      \
    X(max, 1)                                                                                      \
    X(sqrt, 1)                                                                                     \
    X(floor, 1)                                                                                    \
    X(abs, 1)                                                                                      \
    X(copysign, 1) X(select, 1) X(is_finite, 1) X(from_int, 1) X(halves, 2) X(half_masks, 1)       \
        X(half_min_max, 2)
#define FL_WIDE_MATH_OPS(X)                                                                        \
    X(sincos, 2)                                                                                   \
    X(sincos_turns, 2)                                                                             \
    X(atan2, 1) X(pow, 1) X(acos, 1) X(log2, 1) X(exp2, 1) X(srgb_encode, 1) X(srgb_decode, 1)

#define FL_WIDE_OP_ENUM(name, results) FL_WIDE_OP_##name,
enum { FL_WIDE_OPS(FL_WIDE_OP_ENUM) FL_WIDE_OP_COUNT };
enum { FL_WIDE_MATH_OPS(FL_WIDE_OP_ENUM) FL_WIDE_MATH_OP_COUNT };

typedef struct fl_wide_op {
    const char *name;
    int results;
    fl_wide_run *run;
} fl_wide_op;

typedef struct fl_wide_table {
    uint32_t width;
    fl_wide_op ops[FL_WIDE_OP_COUNT];
    fl_wide_op math[FL_WIDE_MATH_OP_COUNT];

    /** Left-pack the lanes of `a` chosen by `mask` bits into out (width elements). Returns their
     * count. */
    uint32_t (*pack)(float *out, const float *a, uint32_t mask);
    void (*store_masked)(float *out, const float *a, uint32_t mask);
    void (*gather)(float *out, const float *base, const int32_t *index);
    /** Bits: any << 1 | all, and the mask read back in the upper 16. */
    uint32_t (*mask_queries)(uint32_t mask);
    uint32_t (*first)(uint32_t count);

    /** All four dimensions, n numbers each. */
    void (*sample)(float *out, const fl_sample_pass *pass, const uint32_t *pixel, size_t n);
    /** The two dimensions of a light, n numbers each. */
    void (*sample_light)(float *out, const fl_sample_pass *pass, uint32_t light,
                         const uint32_t *pixel, const uint32_t *path, size_t n);
    void (*path_child)(uint32_t *out, uint32_t seed, const uint32_t *path, uint32_t branch,
                       size_t n);
    void (*warp)(float *out, const fl_aperture *aperture, const float *u, const float *v, size_t n);
    void (*disk_light)(float *out, const float *frame, const float *u, const float *v, size_t n);
} fl_wide_table;

extern const fl_wide_table fl_wide_table_scalar;
#if defined(__x86_64__)
extern const fl_wide_table fl_wide_table_sse2, fl_wide_table_avx2;
#elif defined(__aarch64__)
extern const fl_wide_table fl_wide_table_neon;
#endif

/** The tables this machine can run, NULL at the end. */
static inline const fl_wide_table *fl_wide_table_at(int i)
{
    const fl_wide_table *tables[FL_ISA_COUNT + 1] = {NULL};
    int count = 0;
    tables[count++] = &fl_wide_table_scalar;
#if defined(__x86_64__)
    tables[count++] = &fl_wide_table_sse2;
    if (fl_cpu_has(FL_ISA_AVX2))
        tables[count++] = &fl_wide_table_avx2;
#elif defined(__aarch64__)
    tables[count++] = &fl_wide_table_neon;
#endif
    return i < count ? tables[i] : NULL;
}

#endif
