/* SPDX-License-Identifier: MIT */
#include "core/revolve_impl.h"

enum { MAX_N = 2 * FL_REVOLVE_MAX_DEGREE, MAX_DEPTH = 48 };

typedef struct span {
    double b[MAX_N + 1]; /* Bernstein coefficients on [lo, hi] */
    double lo, hi;
    uint32_t depth;
} span;

/* The sign of a value that counts as 0 up to `noise`. */
static int sign_of(double value, double noise)
{
    return value > noise ? 1 : value < -noise ? -1 : 0;
}

static uint32_t variations(const double *b, uint32_t n, double noise)
{
    uint32_t count = 0;
    int last = 0;
    for (uint32_t i = 0; i <= n; i++) {
        int sign = sign_of(b[i], noise);
        if (sign && last && sign != last)
            count++;
        if (sign)
            last = sign;
    }
    return count;
}

/* de Casteljau: value at t, in [0, 1]. */
static double bernstein_value(const double *b, uint32_t n, double t)
{
    double w[MAX_N + 1];
    for (uint32_t i = 0; i <= n; i++)
        w[i] = b[i];
    for (uint32_t k = n; k > 0; k--)
        for (uint32_t i = 0; i < k; i++)
            w[i] += t * (w[i + 1] - w[i]);
    return w[0];
}

/* One change of sign: bisection, to the last bit that matters. */
static double only_root(const span *s, uint32_t n, double noise)
{
    double lo = 0.0, hi = 1.0;
    int at_lo = 0;
    for (uint32_t i = 0; i <= n && !at_lo; i++)
        at_lo = sign_of(s->b[i], noise);
    for (int step = 0; step < 60; step++) {
        double mid = 0.5 * (lo + hi), value = bernstein_value(s->b, n, mid);
        if (sign_of(value, 0.0) == at_lo)
            lo = mid;
        else
            hi = mid;
    }
    return s->lo + (s->hi - s->lo) * (0.5 * (lo + hi));
}

static void halve(const span *whole, uint32_t n, span *left, span *right)
{
    double mid = 0.5 * (whole->lo + whole->hi), w[MAX_N + 1];
    for (uint32_t i = 0; i <= n; i++)
        w[i] = whole->b[i];
    for (uint32_t k = 0; k <= n; k++) {
        left->b[k] = w[0];
        right->b[n - k] = w[n - k];
        for (uint32_t i = 0; i + k < n; i++)
            w[i] = 0.5 * (w[i] + w[i + 1]);
    }
    left->lo = whole->lo;
    left->hi = right->lo = mid;
    right->hi = whole->hi;
    left->depth = right->depth = whole->depth + 1;
}

static uint32_t append(double root, double *roots, uint32_t count, uint32_t room)
{
    if (count < room && root > 0.0 && root < 1.0 && (count == 0 || root > roots[count - 1]))
        roots[count++] = root;
    return count;
}

uint32_t fl_revolve_roots(const double *bernstein, uint32_t n, double noise, double *out_roots,
                          uint32_t room)
{
    span stack[MAX_DEPTH + 2];
    uint32_t count = 0, top = 1;
    FL_ASSERT(n <= MAX_N);
    stack[0] = (span){.lo = 0.0, .hi = 1.0};
    for (uint32_t i = 0; i <= n; i++)
        stack[0].b[i] = bernstein[i];
    while (top > 0) {
        span s = stack[--top];
        uint32_t changes = variations(s.b, n, noise);
        if (changes == 1) {
            count = append(only_root(&s, n, noise), out_roots, count, room);
        } else if (changes > 1 && s.depth >= MAX_DEPTH) {
            count = append(0.5 * (s.lo + s.hi), out_roots, count, room);
        } else if (changes > 1) {
            halve(&s, n, &stack[top + 1], &stack[top]); /* the left half is taken first */
            top += 2;
        } else if (s.hi < 1.0 && sign_of(s.b[n], noise) == 0) {
            count = append(s.hi, out_roots, count, room); /* a root at the cut itself */
        }
    }
    return count;
}
