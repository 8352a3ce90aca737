/* SPDX-License-Identifier: MIT
 *
 * Layer 1: three-dimensional vectors and affine maps in double, for everything outside the kernels
 * (scene description, compilation, picking). Kernels use structure-of-arrays floats instead.
 *
 * Conventions: right-handed; points and directions are columns; angles are in radians unless the
 * name says otherwise. Only sqrt and fabs of libm are used here, so results are the same bits
 * on every machine.
 */
#ifndef FL_VEC_H
#define FL_VEC_H

#include <math.h>

#include "core/base.h"

/** A point, a direction or a linear RGB colour. */
typedef struct fl_vec3 {
    double x, y, z;
} fl_vec3;

/** Affine map p -> M p + t; m[row][column], the fourth column is the translation t. */
typedef struct fl_affine {
    double m[3][4];
} fl_affine;

/** Axis-aligned box; empty when lo > hi in any axis. */
typedef struct fl_box {
    fl_vec3 lo, hi;
} fl_box;

static inline fl_vec3 fl_v3(double x, double y, double z)
{
    return (fl_vec3){x, y, z};
}

static inline fl_vec3 fl_v3_add(fl_vec3 a, fl_vec3 b)
{
    return fl_v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline fl_vec3 fl_v3_sub(fl_vec3 a, fl_vec3 b)
{
    return fl_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline fl_vec3 fl_v3_mul(fl_vec3 a, fl_vec3 b)
{
    return fl_v3(a.x * b.x, a.y * b.y, a.z * b.z);
}

static inline fl_vec3 fl_v3_scale(fl_vec3 a, double s)
{
    return fl_v3(a.x * s, a.y * s, a.z * s);
}

/** a + s b. */
static inline fl_vec3 fl_v3_mad(fl_vec3 a, fl_vec3 b, double s)
{
    return fl_v3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}

static inline double fl_v3_dot(fl_vec3 a, fl_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline fl_vec3 fl_v3_cross(fl_vec3 a, fl_vec3 b)
{
    return fl_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/** Orthonormal basis (u, v) of the plane with unit normal n. [Duff and others 2017] */
static inline void fl_v3_basis(fl_vec3 n, fl_vec3 *out_u, fl_vec3 *out_v)
{
    double sign = copysign(1.0, n.z);
    double a = -1.0 / (sign + n.z), b = n.x * n.y * a;
    *out_u = fl_v3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *out_v = fl_v3(b, sign + n.y * n.y * a, -n.y);
}

/** Largest absolute component. */
static inline double fl_v3_max_abs(fl_vec3 a)
{
    return fl_max(fl_max(fabs(a.x), fabs(a.y)), fabs(a.z));
}

/** Euclidean length, safe against overflow and underflow of the squares. */
static inline double fl_v3_length(fl_vec3 a)
{
    double scale = fl_v3_max_abs(a);
    if (!(scale > 0.0))
        return scale;
    fl_vec3 unit = fl_v3(a.x / scale, a.y / scale, a.z / scale);
    return scale * sqrt(fl_v3_dot(unit, unit));
}

/** Unit vector along `a`; the zero vector stays zero. */
static inline fl_vec3 fl_v3_normalize(fl_vec3 a)
{
    double scale = fl_v3_max_abs(a);
    if (!(scale > 0.0))
        return a;
    fl_vec3 unit = fl_v3(a.x / scale, a.y / scale, a.z / scale);
    return fl_v3_scale(unit, 1.0 / sqrt(fl_v3_dot(unit, unit)));
}

static inline bool fl_v3_is_finite(fl_vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

static inline fl_affine fl_affine_identity(void)
{
    return (fl_affine){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

/** The map "first b, then a". */
static inline fl_affine fl_affine_mul(const fl_affine *a, const fl_affine *b)
{
    fl_affine r;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            r.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] +
                        a->m[i][2] * b->m[2][j] + (j == 3 ? a->m[i][3] : 0.0);
    return r;
}

static inline fl_vec3 fl_affine_point(const fl_affine *a, fl_vec3 p)
{
    return fl_v3(a->m[0][0] * p.x + a->m[0][1] * p.y + a->m[0][2] * p.z + a->m[0][3],
                 a->m[1][0] * p.x + a->m[1][1] * p.y + a->m[1][2] * p.z + a->m[1][3],
                 a->m[2][0] * p.x + a->m[2][1] * p.y + a->m[2][2] * p.z + a->m[2][3]);
}

static inline fl_vec3 fl_affine_direction(const fl_affine *a, fl_vec3 d)
{
    return fl_v3(a->m[0][0] * d.x + a->m[0][1] * d.y + a->m[0][2] * d.z,
                 a->m[1][0] * d.x + a->m[1][1] * d.y + a->m[1][2] * d.z,
                 a->m[2][0] * d.x + a->m[2][1] * d.y + a->m[2][2] * d.z);
}

/** Multiply by the transpose of the linear part: with `a` the inverse of a map, this carries normals. */
static inline fl_vec3 fl_affine_transposed_direction(const fl_affine *a, fl_vec3 n)
{
    return fl_v3(a->m[0][0] * n.x + a->m[1][0] * n.y + a->m[2][0] * n.z,
                 a->m[0][1] * n.x + a->m[1][1] * n.y + a->m[2][1] * n.z,
                 a->m[0][2] * n.x + a->m[1][2] * n.y + a->m[2][2] * n.z);
}

static inline bool fl_affine_is_identity(const fl_affine *a)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (a->m[i][j] != (i == j ? 1.0 : 0.0))
                return false;
    return true;
}

/** Invert; false (and *out untouched) when the map is singular or not finite. Scale-free test. */
static inline bool fl_affine_invert(const fl_affine *a, fl_affine *out)
{
    fl_vec3 c0 = fl_v3(a->m[0][0], a->m[1][0], a->m[2][0]);
    fl_vec3 c1 = fl_v3(a->m[0][1], a->m[1][1], a->m[2][1]);
    fl_vec3 c2 = fl_v3(a->m[0][2], a->m[1][2], a->m[2][2]);
    /* Columns are normalised by their own largest entries, so a uniform scale of 1e-100 inverts too. */
    double s0 = fl_v3_max_abs(c0), s1 = fl_v3_max_abs(c1), s2 = fl_v3_max_abs(c2);
    if (!(s0 > 0.0 && s1 > 0.0 && s2 > 0.0 && isfinite(s0) && isfinite(s1) && isfinite(s2)))
        return false;
    c0 = fl_v3_scale(c0, 1.0 / s0);
    c1 = fl_v3_scale(c1, 1.0 / s1);
    c2 = fl_v3_scale(c2, 1.0 / s2);
    fl_vec3 r0 = fl_v3_cross(c1, c2), r1 = fl_v3_cross(c2, c0), r2 = fl_v3_cross(c0, c1);
    double det = fl_v3_dot(c0, r0);
    if (!(fabs(det) > 1e-14))
        return false;
    r0 = fl_v3_scale(r0, 1.0 / det / s0);
    r1 = fl_v3_scale(r1, 1.0 / det / s1);
    r2 = fl_v3_scale(r2, 1.0 / det / s2);
    fl_vec3 t = fl_v3(a->m[0][3], a->m[1][3], a->m[2][3]);
    fl_affine inverse = {{{r0.x, r0.y, r0.z, -fl_v3_dot(r0, t)},
                          {r1.x, r1.y, r1.z, -fl_v3_dot(r1, t)},
                          {r2.x, r2.y, r2.z, -fl_v3_dot(r2, t)}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!isfinite(inverse.m[i][j]))
                return false;
    *out = inverse;
    return true;
}

static inline fl_box fl_box_empty(void)
{
    return (fl_box){{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
}

static inline fl_box fl_box_grow(fl_box b, fl_vec3 p)
{
    return (fl_box){{fl_min(b.lo.x, p.x), fl_min(b.lo.y, p.y), fl_min(b.lo.z, p.z)},
                    {fl_max(b.hi.x, p.x), fl_max(b.hi.y, p.y), fl_max(b.hi.z, p.z)}};
}

static inline fl_box fl_box_union(fl_box a, fl_box b)
{
    return fl_box_grow(fl_box_grow(a, b.lo), b.hi);
}

static inline bool fl_box_is_empty(fl_box b)
{
    return !(b.lo.x <= b.hi.x && b.lo.y <= b.hi.y && b.lo.z <= b.hi.z);
}

#endif
