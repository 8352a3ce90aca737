/* SPDX-License-Identifier: MIT
 *
 * Layer 3, private to revolve*.c: a preprocessed profile and the entry points compiled per
 * instruction set.
 *
 * Units. Lengths inside are object lengths times `unit`, a power of two that brings the size S
 * (larger of the greatest radius and the height) into [1, 2); heights are relative to `y_center`.
 * Tolerances below are therefore absolute numbers.
 *
 * A piece is a part of a segment on which x >= 0 and x(t), y(t) and the direction of the tangent
 * are monotone. Pieces that meet share their node bit for bit, so the sign of the ray's equation
 * there is one sign.
 */
#ifndef FL_REVOLVE_IMPL_H
#define FL_REVOLVE_IMPL_H

#include "core/revolve.h"

enum {
    FL_REVOLVE_GROUP = 8,  /* boxes tested by one instruction */
    FL_REVOLVE_LEVELS = 9, /* 8^9 pieces: more than fit in uint32_t */
    FL_REVOLVE_MAX_PIECES = 1 << 24
};

/* Every box is padded outward by this much, and so are the bounds of the ray's equation in the
 * float cull. Float rounding there stays below 40 * 2^-24. */
#define FL_REVOLVE_PAD 4e-6

/** Boxes of eight pieces, or of eight groups one level down. Unused lanes have xhi < 0. */
typedef struct fl_revolve_group {
    float xlo[FL_REVOLVE_GROUP], xhi[FL_REVOLVE_GROUP], ylo[FL_REVOLVE_GROUP],
        yhi[FL_REVOLVE_GROUP];
} fl_revolve_group;

/** Entry points of one instruction set. */
typedef struct fl_revolve_ops {
    bool (*nearest)(const fl_revolve *revolve, const double o[3], const double d[3], double u_min,
                    double u_max, fl_revolve_hit *out_hit);
    bool (*any)(const fl_revolve *revolve, const double o[3], const double d[3], double u_min,
                double u_max);
    uint32_t (*reject8)(const fl_revolve *revolve, const fl_revolve_packet *rays, uint32_t mask);
    uint32_t (*nearest8)(const fl_revolve *revolve, const fl_revolve_packet *rays, uint32_t mask,
                         fl_revolve_hit *out_hits);
    uint32_t (*any8)(const fl_revolve *revolve, const fl_revolve_packet *rays, uint32_t mask);
} fl_revolve_ops;

extern const fl_revolve_ops fl_revolve_ops_scalar;
#if defined(__x86_64__)
extern const fl_revolve_ops fl_revolve_ops_sse2, fl_revolve_ops_avx2;
#elif defined(__aarch64__)
extern const fl_revolve_ops fl_revolve_ops_neon;
#endif

struct fl_revolve {
    const fl_revolve_ops *ops;
    double unit, y_center;     /**< y_center in units. */
    double radius, y_lo, y_hi; /**< Of the surface, padded; in units, y relative to y_center. */
    double tiny;               /**< 2^-53 S. */
    uint32_t degree;           /**< n >= 3: lower degrees have zeros at the end. */
    uint32_t stride;           /**< 2 n + 6 doubles a piece; 96 bytes for cubics. */
    uint32_t piece_count;
    uint32_t level_count, first_level; /**< Rays begin with all groups of first_level. */
    const fl_revolve_group *groups[FL_REVOLVE_LEVELS];
    uint32_t group_count[FL_REVOLVE_LEVELS];
    /** Per piece: n+1 coefficients of x in powers of t, n+1 of y, x(1), y(1), then t = begin +
     * width * local. */
    const double *pieces;
    const uint8_t *is_convex; /**< Per piece: cut by any plane parallel to the axis, it gives a
                                 convex curve. */
    const uint32_t *segment;  /**< Per piece. */
    double normal_sign;       /**< +1 or -1: turns (y', -x') outward. */
    double v_lo, v_scale;     /**< Texture v = (y - v_lo) * v_scale, in units. */
    double scale;             /**< Object units: fl_revolve_point.scale. */
    fl_box bounds;
    /* The Newton baseline: the segments as given, n+1 coefficients of x and of y in powers of t
     * each. */
    const double *newton;
    uint32_t newton_degree, segment_count;
};

static inline const double *fl_revolve_piece(const fl_revolve *revolve, uint32_t piece)
{
    return revolve->pieces + (size_t)piece * revolve->stride;
}

/** c[0] + c[1] t + ... + c[n] t^n. Cubics take the shorter chain of operations. */
static inline double fl_revolve_poly(const double *c, uint32_t n, double t)
{
    if (n == 3)
        return (c[0] + c[1] * t) + (t * t) * (c[2] + c[3] * t);
    double value = c[n];
    for (uint32_t i = n; i-- > 0;)
        value = value * t + c[i];
    return value;
}

/** The same, and the derivative. */
static inline double fl_revolve_poly_slope(const double *c, uint32_t n, double t, double *out_slope)
{
    double value = c[n], slope = c[n];
    if (n == 3) {
        *out_slope = c[1] + t * (2.0 * c[2] + 3.0 * c[3] * t);
        return fl_revolve_poly(c, n, t);
    }
    for (uint32_t i = n - 1; i > 0; i--) {
        value = value * t + c[i];
        slope = slope * t + value;
    }
    *out_slope = slope;
    return value * t + c[0];
}

/** Smallest power of two above |x|, for finite x > 0 within the normal range. */
double fl_revolve_power_above(double x);

/** Roots of a polynomial in Bernstein form of degree n <= 2 FL_REVOLVE_MAX_DEGREE, strictly between
 * 0 and 1, where the sign changes or the value is lost in rounding; ascending, at most `room`.
 * Values up to `noise` count as 0. Returns their number. */
uint32_t fl_revolve_roots(const double *bernstein, uint32_t n, double noise, double *out_roots,
                          uint32_t room);

/** Fill pieces, is_convex, segment, piece_count, radius, y_lo, y_hi, tiny, normal_sign from points
 * already in units (x and y of `points`, y relative to y_center as y + y_low). False: out of memory
 * or no area, and `diags` says so. Layer-private step of fl_revolve_build. */
bool fl_revolve_split(fl_revolve *revolve, fl_arena *arena, const double *x, const double *y,
                      const double *y_low, uint32_t segment_count, uint32_t degree, fl_loc loc,
                      fl_diags *diags);

/** Boxes of the pieces and the levels above them. False: out of memory. */
bool fl_revolve_group_boxes(fl_revolve *revolve, fl_arena *arena);

/** The baseline, from `starts` points a segment. */
bool fl_revolve_newton(const fl_revolve *revolve, const double o[3], const double d[3],
                       double u_min, double u_max, uint32_t starts, fl_revolve_hit *out_hit);

#endif
