/* SPDX-License-Identifier: MIT
 *
 * Sample points of the reference (decision 6) and their maps to a disc and a polygon.
 */
#ifndef REFERENCE_POINTS_H
#define REFERENCE_POINTS_H

#include "vector.h"

static const double pi = 3.14159265358979323846;

static inline uint32_t mix(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

static inline uint32_t hash(uint32_t seed, int count, const uint32_t *values)
{
    uint32_t h = seed;
    for (int i = 0; i < count; i++)
        h = mix(h ^ (values[i] * 0x9E3779B9u + 0x7F4A7C15u));
    return h;
}
#define HASH(seed, ...)                                                                            \
    hash(seed, sizeof((uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t), (uint32_t[]){__VA_ARGS__})

static inline uint32_t reversed(uint32_t x)
{
    uint32_t r = 0;
    for (int i = 0; i < 32; i++)
        r |= (x >> i & 1u) << (31 - i);
    return r;
}

static inline uint32_t owen(uint32_t x, uint32_t s)
{
    uint32_t n = reversed(x);
    n ^= n * 0x3d20adeau;
    n += s;
    n *= s >> 16 | 1u;
    n ^= n * 0x05526c56u;
    n ^= n * 0x53a22864u;
    return reversed(n);
}

/* Point k of Sobol dimension d from the direction numbers of its primitive polynomial (Joe, Kuo).
 */
static inline uint32_t sobol(uint32_t k, uint32_t d)
{
    static const uint32_t degree[4] = {0, 1, 2, 3}, coefficients[4] = {0, 0, 1, 1};
    static const uint32_t first[4][3] = {{1}, {1}, {1, 3}, {1, 3, 1}};
    uint32_t m[32], s = degree[d], x = 0;
    for (uint32_t i = 0; i < 32; i++) {
        if (s == 0 || i < s) {
            m[i] = s == 0 ? 1u : first[d][i];
        } else {
            m[i] = m[i - s] ^ m[i - s] << s;
            for (uint32_t j = 1; j < s; j++)
                m[i] ^= (coefficients[d] >> (s - 1 - j) & 1u) ? m[i - j] << j : 0u;
        }
        if (k >> i & 1u)
            x ^= m[i] << (31 - i);
    }
    return x;
}

/* Coordinate d of point i of set q in pixel p, in [0, 1). */
static inline double coordinate(const ref_dump *scene, uint32_t p, uint32_t i, uint32_t q,
                                uint32_t d)
{
    uint32_t x = scene->is_random
                     ? HASH(scene->seed, 3, p, i, q, d)
                     : owen(sobol(owen(i, HASH(scene->seed, q)), d), HASH(scene->seed, p, q, d));
    return (x >> 8) * 0x1p-24;
}

/* Concentric map of the unit square to the unit disc [Shirley, Chiu 1997]. */
static inline void disc_point(double u, double v, double *out_x, double *out_y)
{
    double a = 2.0 * u - 1.0, b = 2.0 * v - 1.0, r, phi;
    if (fabs(a) > fabs(b)) {
        r = a;
        phi = pi / 4.0 * (b / a);
    } else {
        r = b;
        phi = b == 0.0 ? 0.0 : pi / 2.0 - pi / 4.0 * (a / b);
    }
    *out_x = r * cos(phi);
    *out_y = r * sin(phi);
}

/* Point of a regular polygon of circumradius 1: wedge k, then area-true in that triangle. */
static inline void polygon_point(uint32_t sides, double turn, double u, double v, double *out_x,
                                 double *out_y)
{
    double k = floor(u * sides), along = u * sides - k, r = sqrt(v);
    double a = turn + 2.0 * pi * k / sides, b = turn + 2.0 * pi * (k + 1.0) / sides;
    *out_x = r * ((1.0 - along) * cos(a) + along * cos(b));
    *out_y = r * ((1.0 - along) * sin(a) + along * sin(b));
}

/* An orthonormal basis of the plane across n [Duff et al. 2017]. */
static inline void basis(ref_vec n, ref_vec *out_u, ref_vec *out_v)
{
    double sign = copysign(1.0, n.z), a = -1.0 / (sign + n.z), b = n.x * n.y * a;
    *out_u = vec(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *out_v = vec(b, sign + n.y * n.y * a, -n.y);
}

#endif
