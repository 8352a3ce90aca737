/* SPDX-License-Identifier: MIT
 *
 * Elementary functions: their error in units in the last place (ulp) against MPFR.
 *
 *     test_math_error               every 4099th float
 *     test_math_error --all [name]  every float of the domain; makes the figures that docs quote
 *                                   (some minutes a function)
 *
 * Each value is compared with long double first; a value that would raise the maximum is measured
 * again with MPFR at 200 bits, so the reported maximum is MPFR's. Scalars only: test_math holds the
 * vector forms to their bits.
 */
#include "lane_check.h"

#include <math.h>

#include <mpfr.h>

#include "core/math64.h"

#define SEED 0x3a7bu
#define PI_L 3.141592653589793238462643383279502884L

static uint32_t stride = 4099;
static bool runs_all;
static const char *only;

/* --- the functions under test, their long double and MPFR counterparts, their domains -------- */

#define SPLIT(name)                                                                                \
    static float name##_sin(float x)                                                               \
    {                                                                                              \
        float s, c;                                                                                \
        fl_f_##name(x, &s, &c);                                                                    \
        return s;                                                                                  \
    }                                                                                              \
    static float name##_cos(float x)                                                               \
    {                                                                                              \
        float s, c;                                                                                \
        fl_f_##name(x, &s, &c);                                                                    \
        return c;                                                                                  \
    }
SPLIT(sincos)
SPLIT(sincos_turns)

static long double ref_turns(float x, long long quarter)
{
    long double t = (long double)x * 4.0L, k = rintl(t), r = (t - k) * (PI_L / 2.0L);
    switch (((long long)k + quarter) & 3) {
    case 0:
        return sinl(r);
    case 1:
        return cosl(r);
    case 2:
        return -sinl(r);
    default:
        return -cosl(r);
    }
}

static long double ref_sin_turns(float x)
{
    return ref_turns(x, 0);
}

static long double ref_cos_turns(float x)
{
    return ref_turns(x, 1);
}

static long double ref_sin(float x)
{
    return sinl((long double)x);
}

static long double ref_cos(float x)
{
    return cosl((long double)x);
}

static long double ref_acos(float x)
{
    return acosl((long double)x);
}

static long double ref_log2(float x)
{
    return log2l((long double)x);
}

static long double ref_exp2(float x)
{
    return exp2l((long double)x);
}

static long double ref_encode(float x)
{
    long double t = (long double)x;
    return t <= 0.0031308L ? 12.92L * t : 1.055L * powl(t, 1.0L / 2.4L) - 0.055L;
}

static long double ref_decode(float x)
{
    long double t = (long double)x;
    return t <= 0.04045L ? t / 12.92L : powl((t + 0.055L) / 1.055L, 2.4L);
}

static void big_sin_turns(mpfr_t r, float x)
{
    mpfr_set_flt(r, x, MPFR_RNDN);
    mpfr_sinu(r, r, 1, MPFR_RNDN);
}

static void big_cos_turns(mpfr_t r, float x)
{
    mpfr_set_flt(r, x, MPFR_RNDN);
    mpfr_cosu(r, r, 1, MPFR_RNDN);
}

#define BIG(name)                                                                                  \
    static void big_##name(mpfr_t r, float x)                                                      \
    {                                                                                              \
        mpfr_set_flt(r, x, MPFR_RNDN);                                                             \
        mpfr_##name(r, r, MPFR_RNDN);                                                              \
    }
BIG(sin)
BIG(cos)
BIG(acos)
BIG(log2)
BIG(exp2)

/* r = r * factor, r + term, r ^ power with decimal constants. */
static void big_step(mpfr_t r, char operation, const char *decimal)
{
    mpfr_t c;
    mpfr_init2(c, 200);
    mpfr_set_str(c, decimal, 10, MPFR_RNDN);
    if (operation == '*')
        mpfr_mul(r, r, c, MPFR_RNDN);
    else if (operation == '/')
        mpfr_div(r, r, c, MPFR_RNDN);
    else if (operation == '+')
        mpfr_add(r, r, c, MPFR_RNDN);
    else
        mpfr_pow(r, r, c, MPFR_RNDN);
    mpfr_clear(c);
}

static void big_encode(mpfr_t r, float x)
{
    mpfr_set_flt(r, x, MPFR_RNDN);
    if ((long double)x <= 0.0031308L) {
        big_step(r, '*', "12.92");
        return;
    }
    mpfr_rootn_ui(r, r, 12, MPFR_RNDN); /* 1 / 2.4 = 5 / 12 */
    mpfr_pow_ui(r, r, 5, MPFR_RNDN);
    big_step(r, '*', "1.055");
    big_step(r, '+', "-0.055");
}

static void big_decode(mpfr_t r, float x)
{
    mpfr_set_flt(r, x, MPFR_RNDN);
    if ((long double)x <= 0.04045L) {
        big_step(r, '/', "12.92");
        return;
    }
    big_step(r, '+', "0.055");
    big_step(r, '/', "1.055");
    big_step(r, '^', "2.4");
}

typedef struct unary {
    const char *name;
    float (*run)(float);
    long double (*ref)(float);
    void (*big)(mpfr_t, float);
    float lo, hi; /* tested: lo <= x <= hi */
    /* 1: f(-x) = f(x), -1: f(-x) = -f(x); held exactly, so only half the range needs measuring. */
    int symmetry;
} unary;

/* Beyond the bounds: sincos_turns of 2^22 and more is 0 or +-1 exactly; exp2 is 0 or infinite. */
static const unary unaries[] = {
    {"sin_turns", sincos_turns_sin, ref_sin_turns, big_sin_turns, -0x1p22f, 0x1p22f, -1},
    {"cos_turns", sincos_turns_cos, ref_cos_turns, big_cos_turns, -0x1p22f, 0x1p22f, 1},
    {"sin", sincos_sin, ref_sin, big_sin, -0x1p20f, 0x1p20f, -1},
    {"cos", sincos_cos, ref_cos, big_cos, -0x1p20f, 0x1p20f, 1},
    {"acos", fl_f_acos, ref_acos, big_acos, -1.0f, 1.0f, 0},
    {"log2", fl_f_log2, ref_log2, big_log2, 0x1p-149f, 0x1.fffffep127f, 0},
    {"exp2", fl_f_exp2, ref_exp2, big_exp2, -150.0f, 0x1.fffffep6f, 0},
    {"srgb_encode", fl_f_srgb_encode, ref_encode, big_encode, 0.0f, 1.0f, 0},
    {"srgb_decode", fl_f_srgb_decode, ref_decode, big_decode, 0.0f, 1.0f, 0},
};

/* --- error measurement ----------------------------------------------------------------------- */

/* Distance between neighbouring floats around `exact`. */
static long double float_spacing(long double exact)
{
    int exponent;
    (void)frexpl(exact, &exponent);
    return ldexpl(1.0L, (exponent < -125 ? -125 : exponent) - 24);
}

static long double big_error(const mpfr_t exact, float x)
{
    mpfr_t difference;
    mpfr_init2(difference, 200);
    mpfr_sub_d(difference, exact, (double)x, MPFR_RNDN);
    long double spacing = float_spacing(mpfr_get_ld(exact, MPFR_RNDN));
    long double error = fabsl(mpfr_get_ld(difference, MPFR_RNDN)) / spacing;
    mpfr_clear(difference);
    return error;
}

static double measure_unary(const unary *f, float *out_worst, uint64_t *out_count)
{
    long double worst = 0.0L;
    uint64_t count = 0;
    mpfr_t exact;
    mpfr_init2(exact, 200);
    for (uint64_t bits = 0; bits < (uint64_t)1 << 32; bits += stride) {
        float x = float_from_bits((uint32_t)bits);
        if (!(x >= f->lo && x <= f->hi))
            continue;
        count++;
        float value = f->run(x);
        if (f->symmetry && x < 0.0f) {
            float mirrored = f->run(-x);
            assert_true(value == (f->symmetry < 0 ? -mirrored : mirrored));
            continue;
        }
        long double ref = f->ref(x);
        if (fabsl(ref - (long double)value) <= worst * float_spacing(ref))
            continue;
        f->big(exact, x);
        long double error = big_error(exact, value);
        if (!(error <= worst)) {
            worst = error;
            *out_worst = x;
        }
    }
    mpfr_clear(exact);
    *out_count = count;
    return (double)worst;
}

static void test_unary_error(void **state)
{
    (void)state;
    for (size_t i = 0; i < FL_COUNT_OF(unaries); i++) {
        const unary *f = &unaries[i];
        if (only && strcmp(only, f->name) != 0)
            continue;
        float at = 0.0f;
        uint64_t count;
        double error = measure_unary(f, &at, &count);
        print_message("%-12s %.6f ulp at %a, %llu floats in [%g, %g]\n", f->name, error, (double)at,
                      (unsigned long long)count, (double)f->lo, (double)f->hi);
        assert_true(error <= 0.51);
    }
}

/* Operands of use: y/x of any quadrant and ratio; x^y whose result is not far below the floats. */
static void binary_operands(uint32_t i, bool is_pow, float *x, float *y)
{
    uint32_t h = fl_hash_step(SEED, 4 * i);
    float u = test_unit(SEED, 4 * i + 1), v = test_unit(SEED, 4 * i + 2);
    if (!is_pow) {
        *x = ldexpf(u + 0.5f, (int)(h % 60) - 30) * (h >> 31 ? -1.0f : 1.0f);
        *y = h & 0x1000000u ? *x * (v * 4.0f - 2.0f) : ldexpf(v + 0.5f, (int)(h >> 8 & 63) - 32);
        return;
    }
    *y = h & 1u ? v * 1e6f : ldexpf(v + 0.5f, (int)(h >> 8 & 31) - 12);
    double drop = (double)u * 150.0 / ((double)*y < 1.0 ? 1.0 : (double)*y);
    *x = h & 2u ? u : fl_f_exp2((float)-drop);
}

static double measure_binary(bool is_pow, uint32_t count, float out_worst[2])
{
    long double worst = 0.0L;
    mpfr_t exact, other;
    mpfr_inits2(200, exact, other, (mpfr_ptr)NULL);
    for (uint32_t i = 0; i < count; i++) {
        float x, y;
        binary_operands(i, is_pow, &x, &y);
        float value = is_pow ? fl_f_pow(x, y) : fl_f_atan2(y, x);
        mpfr_set_flt(exact, is_pow ? x : y, MPFR_RNDN);
        mpfr_set_flt(other, is_pow ? y : x, MPFR_RNDN);
        if (is_pow)
            mpfr_pow(exact, exact, other, MPFR_RNDN);
        else
            mpfr_atan2(exact, exact, other, MPFR_RNDN);
        long double error = big_error(exact, value);
        if (!(error <= worst)) {
            worst = error;
            out_worst[0] = x;
            out_worst[1] = y;
        }
    }
    mpfr_clears(exact, other, (mpfr_ptr)NULL);
    return (double)worst;
}

static void test_binary_error(void **state)
{
    (void)state;
    uint32_t count = runs_all ? 4000000u : 100000u;
    if (only && strcmp(only, "binary") != 0)
        skip();
    for (int is_pow = 0; is_pow < 2; is_pow++) {
        float at[2] = {0};
        double error = measure_binary(is_pow, count, at);
        print_message("%-12s %.6f ulp at x %a, y %a; %u pairs, seed %#x\n",
                      is_pow ? "pow" : "atan2", error, (double)at[0], (double)at[1], count, SEED);
        assert_true(error <= 0.51);
    }
}

/* The float functions' double halves keep what math_body.inc says: nothing is left to chance
 * between the floats that were tried. */
static void test_core_error(void **state)
{
    (void)state;
    mpfr_t exact;
    mpfr_init2(exact, 200);
    double worst_log2 = 0.0, worst_exp2 = 0.0;
    for (uint32_t i = 0; i < 100000; i++) {
        double u = (double)fl_hash_step(SEED, i) * 0x1p-32;
        double x = i & 1 ? 0.5 + u : ldexp(1.0 + u, (int)(i % 250) - 125), y = (u - 0.5) * 300.0;
        mpfr_set_d(exact, x, MPFR_RNDN);
        mpfr_log2(exact, exact, MPFR_RNDN);
        mpfr_d_div(exact, fl_d_log2(x), exact, MPFR_RNDN);
        mpfr_sub_ui(exact, exact, 1, MPFR_RNDN);
        worst_log2 = fl_max(fabs(mpfr_get_d(exact, MPFR_RNDN)), worst_log2);
        mpfr_set_d(exact, y, MPFR_RNDN);
        mpfr_exp2(exact, exact, MPFR_RNDN);
        mpfr_d_div(exact, fl_d_exp2(y), exact, MPFR_RNDN);
        mpfr_sub_ui(exact, exact, 1, MPFR_RNDN);
        worst_exp2 = fl_max(fabs(mpfr_get_d(exact, MPFR_RNDN)), worst_exp2);
    }
    mpfr_clear(exact);
    print_message("double, relative: log2 2^%.2f exp2 2^%.2f\n", log2(worst_log2),
                  log2(worst_exp2));
    assert_true(worst_log2 < 0x1p-43 && worst_exp2 < 0x1p-41);
}

/* Doubles, for rotations and fields of view: error relative to the largest value, 1 or pi. */
static void test_double_error(void **state)
{
    (void)state;
    mpfr_t exact, angle;
    mpfr_inits2(200, exact, angle, (mpfr_ptr)NULL);
    double worst_sin = 0.0, worst_cos = 0.0, worst_atan = 0.0, worst_acos = 0.0;
    for (uint32_t i = 0; i < 50000; i++) {
        double x = ((double)fl_hash_step(SEED, i) * 0x1p-32 - 0.5) * (i & 1 ? 720.0 : 4000.0);
        double s, c, y = (double)fl_hash_step(SEED + 1, i) * 0x1p-31 - 1.0;
        fl_d_sincos_deg(x, &s, &c);
        mpfr_set_d(angle, x, MPFR_RNDN);
        mpfr_sinu(exact, angle, 360, MPFR_RNDN);
        mpfr_sub_d(exact, exact, s, MPFR_RNDN);
        worst_sin = fl_max(fabs(mpfr_get_d(exact, MPFR_RNDN)), worst_sin);
        mpfr_cosu(exact, angle, 360, MPFR_RNDN);
        mpfr_sub_d(exact, exact, c, MPFR_RNDN);
        worst_cos = fl_max(fabs(mpfr_get_d(exact, MPFR_RNDN)), worst_cos);
        mpfr_set_d(exact, y, MPFR_RNDN);
        mpfr_atan2(exact, exact, angle, MPFR_RNDN);
        mpfr_sub_d(exact, exact, fl_d_atan2(y, x), MPFR_RNDN);
        worst_atan = fl_max(fabs(mpfr_get_d(exact, MPFR_RNDN)), worst_atan);
        mpfr_set_d(exact, y, MPFR_RNDN);
        mpfr_acos(exact, exact, MPFR_RNDN);
        mpfr_sub_d(exact, exact, fl_d_acos(y), MPFR_RNDN);
        worst_acos = fl_max(fabs(mpfr_get_d(exact, MPFR_RNDN)), worst_acos);
    }
    mpfr_clears(exact, angle, (mpfr_ptr)NULL);
    print_message("double, absolute: sin_deg %.2g cos_deg %.2g atan2 %.2g acos %.2g\n", worst_sin,
                  worst_cos, worst_atan, worst_acos);
    assert_true(worst_sin < 4e-16 && worst_cos < 4e-16);   /* 2 units of the last place of 1 */
    assert_true(worst_atan < 9e-16 && worst_acos < 9e-16); /* 2 units of the last place of pi */
}

int main(int argc, char **argv)
{
    runs_all = argc > 1 && strcmp(argv[1], "--all") == 0;
    only = argc > 2 ? argv[2] : NULL;
    if (runs_all)
        stride = 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_core_error),
        cmocka_unit_test(test_double_error),
        cmocka_unit_test(test_binary_error),
        cmocka_unit_test(test_unary_error),
    };
    return cmocka_run_group_tests_name("math error", tests, NULL, NULL);
}
