/* SPDX-License-Identifier: MIT
 *
 * Vectors, maps and Bezier curves of the reference, in double.
 */
#ifndef REFERENCE_VECTOR_H
#define REFERENCE_VECTOR_H

#include <math.h>
#include <string.h>

#include "dump.h"

static inline ref_vec vec(double x, double y, double z)
{
    return (ref_vec){x, y, z};
}

static inline ref_vec add(ref_vec a, ref_vec b)
{
    return vec(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline ref_vec scale(ref_vec a, double s)
{
    return vec(a.x * s, a.y * s, a.z * s);
}

static inline ref_vec sub(ref_vec a, ref_vec b)
{
    return add(a, scale(b, -1.0));
}

static inline ref_vec times(ref_vec a, ref_vec b)
{
    return vec(a.x * b.x, a.y * b.y, a.z * b.z);
}

static inline double dot(ref_vec a, ref_vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline ref_vec cross(ref_vec a, ref_vec b)
{
    return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline double length(ref_vec a)
{
    return sqrt(dot(a, a));
}

static inline ref_vec unit(ref_vec a)
{
    double l = length(a);
    return l > 0.0 ? scale(a, 1.0 / l) : a;
}

static inline double largest(ref_vec a)
{
    return fmax(a.x, fmax(a.y, a.z));
}

/* m applied to a point (w = 1) or a direction (w = 0). */
static inline ref_vec transform(const double m[3][4], ref_vec p, double w)
{
    return vec(dot(vec(m[0][0], m[0][1], m[0][2]), p) + w * m[0][3],
               dot(vec(m[1][0], m[1][1], m[1][2]), p) + w * m[1][3],
               dot(vec(m[2][0], m[2][1], m[2][2]), p) + w * m[2][3]);
}

/* The transpose of m's linear part applied to n: with the inverse map, what carries normals. */
static inline ref_vec transform_normal(const double m[3][4], ref_vec n)
{
    return unit(vec(m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z,
                    m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
                    m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z));
}

/* Bezier curve of one coordinate; its derivative too. By de Casteljau. */
static inline double curve(const double *points, uint32_t degree, double t, double *out_slope)
{
    double p[REF_DEGREE_MAX + 1];
    memcpy(p, points, (degree + 1) * sizeof *p);
    if (out_slope)
        *out_slope = 0.0;
    for (uint32_t n = degree; n > 0; n--) {
        if (n == 1 && out_slope)
            *out_slope = degree * (p[1] - p[0]);
        for (uint32_t i = 0; i < n; i++)
            p[i] += t * (p[i + 1] - p[i]);
    }
    return p[0];
}

#endif
