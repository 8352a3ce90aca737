/* SPDX-License-Identifier: MIT */
#include "core/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A double lies between 5e-324 and 1.8e308. 767 significant digits decide every tie exactly; what
 * follows them matters only by being zero or not. */
enum { DIGITS_MAX = 770, EXPONENT_MAX = 100000 };

/* An unsigned integer of at most 10^1130 with room for shifts; little end first. */
enum { WORDS = 200 };
typedef struct big {
    uint32_t word[WORDS];
    int count; /* words in use; the highest is not 0 */
} big;

static void big_mul_add(big *b, uint32_t factor, uint32_t addend)
{
    uint64_t carry = addend;
    for (int i = 0; i < b->count; i++) {
        carry += (uint64_t)b->word[i] * factor;
        b->word[i] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry) {
        FL_ASSERT(b->count < WORDS);
        b->word[b->count++] = (uint32_t)carry;
    }
}

static void big_mul_pow10(big *b, int exponent)
{
    for (; exponent >= 9; exponent -= 9)
        big_mul_add(b, 1000000000u, 0);
    for (; exponent > 0; exponent--)
        big_mul_add(b, 10u, 0);
}

static int big_bits(const big *b)
{
    return b->count == 0 ? 0 : 32 * b->count - __builtin_clz(b->word[b->count - 1]);
}

static void big_shift_left(big *b, int bits)
{
    int words = bits / 32, rest = bits % 32;
    if (b->count == 0)
        return;
    FL_ASSERT(b->count + words < WORDS);
    b->word[b->count] = 0;
    for (int i = b->count; i >= 0; i--) {
        uint64_t pair = (uint64_t)b->word[i] << 32 | (i > 0 ? b->word[i - 1] : 0u);
        b->word[i + words] = (uint32_t)(pair >> (32 - rest));
    }
    memset(b->word, 0, (size_t)words * sizeof b->word[0]);
    b->count += words + (b->word[b->count + words] != 0);
}

static int big_compare(const big *a, const big *b)
{
    if (a->count != b->count)
        return a->count < b->count ? -1 : 1;
    for (int i = a->count - 1; i >= 0; i--)
        if (a->word[i] != b->word[i])
            return a->word[i] < b->word[i] ? -1 : 1;
    return 0;
}

/* a -= b, where a >= b. */
static void big_subtract(big *a, const big *b)
{
    uint64_t borrow = 0;
    for (int i = 0; i < a->count; i++) {
        uint64_t d = (uint64_t)a->word[i] - (i < b->count ? b->word[i] : 0u) - borrow;
        a->word[i] = (uint32_t)d;
        borrow = d >> 63;
    }
    while (a->count > 0 && a->word[a->count - 1] == 0)
        a->count--;
}

static double double_from_bits(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Nearest double, ties to even, of num/den by binary long division; both above 0. */
static double nearest_quotient(big *num, big *den)
{
    int exponent = big_bits(num) - big_bits(den);
    if (exponent >= 0)
        big_shift_left(den, exponent);
    else
        big_shift_left(num, -exponent);
    if (big_compare(num, den) < 0) {
        big_shift_left(num, 1);
        exponent--;
    }
    /* Now num/den is in [1, 2) and the value is num/den * 2^exponent. */
    if (exponent > 1023)
        return HUGE_VAL;
    int precision = exponent >= -1022 ? 53 : 53 - (-1022 - exponent);
    if (precision < 0)
        return 0.0;
    uint64_t mantissa = 0;
    for (int i = 0; i < precision; i++) {
        mantissa <<= 1;
        if (big_compare(num, den) >= 0) {
            big_subtract(num, den);
            mantissa |= 1;
        }
        big_shift_left(num, 1);
    }
    int rest = big_compare(num, den);
    mantissa += rest > 0 || (rest == 0 && (mantissa & 1));
    /* A carry out of the mantissa moves into the exponent field, up to infinity, as it should. */
    if (exponent < -1022)
        return double_from_bits(mantissa);
    return double_from_bits(((uint64_t)(exponent + 1022) << 52) + mantissa);
}

/* A decimal number as written: digits[0..count) * 10^exponent, without leading zeros. */
typedef struct decimal {
    uint8_t digits[DIGITS_MAX];
    int count, exponent;
    bool has_more; /* a digit that is not 0 was cut off at the end */
} decimal;

static double decimal_to_double(const decimal *d)
{
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (d->count == 0 || d->count + d->exponent < -330)
        return 0.0;
    if (d->count + d->exponent > 310)
        return HUGE_VAL;
    /* Both operands exact, so one correctly rounded operation gives the answer [Clinger 1990]. */
    if (d->count <= 15 && !d->has_more && d->exponent >= -22 && d->exponent <= 22) {
        uint64_t integer = 0;
        for (int i = 0; i < d->count; i++)
            integer = integer * 10 + d->digits[i];
        return d->exponent < 0 ? (double)integer / powers[-d->exponent]
                               : (double)integer * powers[d->exponent];
    }
    big num = {.count = 0}, den = {.word = {1}, .count = 1};
    for (int i = 0; i < d->count; i++)
        big_mul_add(&num, 10u, d->digits[i]);
    int exponent = d->exponent;
    if (d->has_more) {
        big_mul_add(&num, 10u, 1u);
        exponent--;
    }
    big_mul_pow10(exponent < 0 ? &den : &num, exponent < 0 ? -exponent : exponent);
    return nearest_quotient(&num, &den);
}

static bool is_digit(const char *at, const char *end)
{
    return at < end && *at >= '0' && *at <= '9';
}

/* Append a digit that stands `after_point` (or before the point); leading zeros only move the
 * exponent. */
static void decimal_push(decimal *d, uint8_t digit, bool is_after_point)
{
    if (is_after_point && d->exponent > -EXPONENT_MAX)
        d->exponent--;
    if (d->count == 0 && digit == 0)
        return;
    if (d->count < DIGITS_MAX) {
        d->digits[d->count++] = digit;
        return;
    }
    d->has_more |= digit != 0;
    if (d->exponent < EXPONENT_MAX)
        d->exponent++;
}

static const char *skip_word(const char *at, const char *end, const char *word)
{
    for (; *word; word++, at++)
        if (at >= end || (*at | 0x20) != *word)
            return NULL;
    return at;
}

static const char *parse_special(const char *at, const char *end, double *out_value)
{
    const char *after = skip_word(at, end, "infinity");
    if (!after)
        after = skip_word(at, end, "inf");
    *out_value = HUGE_VAL;
    if (after)
        return after;
    *out_value = (double)NAN;
    return skip_word(at, end, "nan");
}

/* The part after `e`, if there is one: it counts only with at least one digit. */
static const char *parse_exponent(const char *at, const char *end, int *out_exponent)
{
    if (at >= end || (*at | 0x20) != 'e')
        return at;
    const char *from = at + 1;
    bool is_negative = from < end && *from == '-';
    if (from < end && (*from == '-' || *from == '+'))
        from++;
    if (!is_digit(from, end))
        return at;
    int exponent = 0;
    for (; is_digit(from, end); from++)
        if (exponent < 2 * EXPONENT_MAX)
            exponent = exponent * 10 + (*from - '0');
    *out_exponent = is_negative ? -exponent : exponent;
    return from;
}

const char *fl_number_parse(const char *text, const char *end, double *out_value)
{
    const char *at = text;
    bool is_negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    double value = 0.0;
    if (!is_digit(at, end) && !(at < end && *at == '.' && is_digit(at + 1, end))) {
        at = parse_special(at, end, &value);
        if (at)
            *out_value = is_negative ? -value : value;
        return at;
    }
    decimal d = {.count = 0};
    for (; is_digit(at, end); at++)
        decimal_push(&d, (uint8_t)(*at - '0'), false);
    if (at < end && *at == '.')
        for (at++; is_digit(at, end); at++)
            decimal_push(&d, (uint8_t)(*at - '0'), true);
    int exponent = 0;
    at = parse_exponent(at, end, &exponent);
    d.exponent += exponent;
    value = decimal_to_double(&d);
    *out_value = is_negative ? -value : value;
    return at;
}

const char *fl_integer_parse(const char *text, const char *end, int64_t *out_value)
{
    const char *at = text;
    bool is_negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    if (!is_digit(at, end))
        return NULL;
    int64_t value = 0; /* kept negative: that side reaches one further */
    for (; is_digit(at, end); at++)
        if (__builtin_mul_overflow(value, 10, &value) ||
            __builtin_sub_overflow(value, *at - '0', &value))
            return NULL;
    if (!is_negative && value == INT64_MIN)
        return NULL;
    *out_value = is_negative ? value : -value;
    return at;
}

/* Digits of `value` (> 0, finite) rounded to `count` of them, and the power of ten of the first.
 * Only digits are taken from the C library's text, since its decimal point depends on the locale.
 */
static int digits_of(double value, int count, char digits[20])
{
    char text[48];
    snprintf(text, sizeof text, "%.*e", count - 1, value);
    const char *at = text;
    int n = 0;
    for (; *at != 'e'; at++)
        if (*at >= '0' && *at <= '9')
            digits[n++] = *at;
    int64_t exponent = 0;
    fl_integer_parse(at + 1, text + strlen(text), &exponent);
    return (int)exponent;
}

/* Lay out digits as 0.00123, 12300, 1.23 or 1.23e-07; returns the length. */
static size_t lay_out(const char *digits, int count, int exponent, char *out)
{
    char *o = out;
    bool is_plain = exponent >= -5 && exponent < 16;
    int point = is_plain ? exponent + 1 : 1; /* digits before the point */
    if (point <= 0)
        *o++ = '0';
    for (int i = 0; i < point; i++)
        *o++ = i < count ? digits[i] : '0';
    if (count > point)
        *o++ = '.';
    for (int i = point; i < 0; i++)
        *o++ = '0';
    for (int i = point > 0 ? point : 0; i < count; i++)
        *o++ = digits[i];
    *o = '\0';
    if (!is_plain)
        o += snprintf(o, 8, "e%d", exponent);
    return (size_t)(o - out);
}

size_t fl_number_format(double value, char out[32])
{
    char *o = out;
    if (signbit(value) && !isnan(value))
        *o++ = '-';
    double magnitude = fabs(value);
    if (!(magnitude > 0.0 && magnitude < HUGE_VAL)) {
        const char *word = magnitude == 0.0 ? "0" : isnan(value) ? "nan" : "inf";
        memcpy(o, word, strlen(word) + 1);
        return (size_t)(o - out) + strlen(word);
    }
    for (int count = 1;; count++) {
        char digits[20];
        int exponent = digits_of(magnitude, count, digits);
        size_t bytes = lay_out(digits, count, exponent, o);
        double back;
        if (fl_number_parse(o, o + bytes, &back) && back == magnitude)
            return (size_t)(o - out) + bytes;
    }
}
