/* SPDX-License-Identifier: MIT */
#include "wide_table.h"

#include "core/wide_sampler.h"

static fl_wf mask_value(fl_wm m)
{
    return fl_wf_select(m, fl_wf_set(1.0f), fl_wf_set(0.0f));
}

static fl_wm mask_from_bits(uint32_t bits)
{
    return ((fl_wi_set((int32_t)bits) >> fl_wi_iota()) & 1) != 0;
}

/* One body per operation: x and y are the operands, r and r2 the results. */
#define OP(name, results, body)                                                                    \
    static void run_##name(float *out, const float *a, const float *b, size_t n)                   \
    {                                                                                              \
        for (size_t i = 0; i < n; i += FL_W) {                                                     \
            fl_wf x = fl_wf_load(a + i), y = fl_wf_load(b + i), r, r2 = fl_wf_set(0.0f);           \
            (void)y;                                                                               \
            body;                                                                                  \
            fl_wf_store(out + i, r);                                                               \
            if ((results) == 2)                                                                    \
                fl_wf_store(out + n + i, r2);                                                      \
        }                                                                                          \
    }

OP(min, 1, r = fl_wf_min(x, y))
OP(max, 1, r = fl_wf_max(x, y))
OP(sqrt, 1, r = fl_wf_sqrt(x))
OP(floor, 1, r = fl_wf_floor(x))
OP(abs, 1, r = fl_wf_abs(x))
OP(copysign, 1, r = fl_wf_copysign(x, y))
OP(select, 1, r = fl_wf_select(x < y, x, y))
OP(is_finite, 1, r = mask_value(fl_wf_is_finite(x)))
OP(from_int, 1, r = fl_wf_from_wi((fl_wi)x))
OP(halves, 2, r = fl_wf_narrow(fl_wd_lo(x), fl_wd_hi(x));
   r2 = fl_wf_narrow(fl_wd_sqrt(fl_wd_abs(fl_wd_lo(x))), fl_wd_sqrt(fl_wd_abs(fl_wd_hi(x)))))
OP(half_masks, 1, r = mask_value(fl_wm_narrow(fl_wl_lo(x < y), fl_wl_hi(x < y))))
OP(half_min_max, 2,
   r = fl_wf_narrow(fl_wd_min(fl_wd_lo(x), fl_wd_lo(y)), fl_wd_min(fl_wd_hi(x), fl_wd_hi(y)));
   r2 = fl_wf_narrow(fl_wd_max(fl_wd_lo(x), fl_wd_lo(y)), fl_wd_max(fl_wd_hi(x), fl_wd_hi(y))))

OP(sincos, 2, fl_wf_sincos(x, &r, &r2))
OP(sincos_turns, 2, fl_wf_sincos_turns(x, &r, &r2))
OP(atan2, 1, r = fl_wf_atan2(x, y))
OP(pow, 1, r = fl_wf_pow(x, y))
OP(acos, 1, r = fl_wf_acos(x))
OP(log2, 1, r = fl_wf_log2(x))
OP(exp2, 1, r = fl_wf_exp2(x))
OP(srgb_encode, 1, r = fl_wf_srgb_encode(x))
OP(srgb_decode, 1, r = fl_wf_srgb_decode(x))

static uint32_t pack(float *out, const float *a, uint32_t mask)
{
    fl_wm m = mask_from_bits(mask);
    fl_wf_store_packed(out, fl_wf_load(a), fl_wm_order(m));
    return fl_wm_count(m);
}

static void store_masked(float *out, const float *a, uint32_t mask)
{
    fl_wf_store_masked(out, fl_wf_load(a), mask_from_bits(mask));
}

static void gather(float *out, const float *base, const int32_t *index)
{
    fl_wf_store(out, fl_wf_gather(base, fl_wi_load(index)));
}

static uint32_t mask_queries(uint32_t mask)
{
    fl_wm m = mask_from_bits(mask);
    return fl_wm_bits(m) << 16 | (uint32_t)fl_wm_any(m) << 1 | (uint32_t)fl_wm_all(m);
}

static uint32_t first(uint32_t count)
{
    return fl_wm_bits(fl_wm_first(count));
}

static void sample(float *out, const fl_sample_pass *pass, const uint32_t *pixel, size_t n)
{
    float *const numbers[] = {out, out + n, out + 2 * n, out + 3 * n};
    fl_sample_fill(pass, pixel, (uint32_t)n, 0, FL_SAMPLE_DIMENSIONS, numbers);
}

static void sample_light(float *out, const fl_sample_pass *pass, uint32_t light,
                         const uint32_t *pixel, const uint32_t *path, size_t n)
{
    float *const numbers[] = {out, out + n};
    fl_sample_fill_light(pass, light, pixel, path, (uint32_t)n, numbers);
}

static void path_child(uint32_t *out, uint32_t seed, const uint32_t *path, uint32_t branch,
                       size_t n)
{
    for (size_t i = 0; i < n; i += FL_W)
        fl_wu_store(out + i, fl_wu_path_child(seed, fl_wu_load(path + i), branch));
}

static void warp(float *out, const fl_aperture *aperture, const float *u, const float *v, size_t n)
{
    for (size_t i = 0; i < n; i += FL_W) {
        fl_wf x, y;
        fl_wf_warp_aperture(aperture, fl_wf_load(u + i), fl_wf_load(v + i), &x, &y);
        fl_wf_store(out + i, x);
        fl_wf_store(out + n + i, y);
    }
}

static void disk_light(float *out, const float *frame, const float *u, const float *v, size_t n)
{
    for (size_t i = 0; i < n; i += FL_W) {
        fl_wf point[3];
        fl_wf_warp_disk_light(frame, frame + 3, frame + 6, fl_wf_load(u + i), fl_wf_load(v + i),
                              point);
        for (size_t axis = 0; axis < 3; axis++)
            fl_wf_store(out + axis * n + i, point[axis]);
    }
}

#define ENTRY(name, results) {#name, results, run_##name},
const fl_wide_table FL_ISA_NAME(fl_wide_table) = {
    .width = FL_W,
    .ops = {FL_WIDE_OPS(ENTRY)},
    .math = {FL_WIDE_MATH_OPS(ENTRY)},
    .pack = pack,
    .store_masked = store_masked,
    .gather = gather,
    .mask_queries = mask_queries,
    .first = first,
    .sample = sample,
    .sample_light = sample_light,
    .path_child = path_child,
    .warp = warp,
    .disk_light = disk_light,
};
