/* SPDX-License-Identifier: MIT */
#include "core/revolve_impl.h"

#include <string.h>

#include "core/math64.h"

#define MAX_SIZE 1e200 /* squares of sizes must neither overflow nor underflow */

double fl_revolve_power_above(double x)
{
    return fl_d_from_bits((fl_d_bits(x) & 0x7ff0000000000000u) + 0x0010000000000000u);
}

/* Keep the upper 24 bits: heights minus such a number lose as little as possible. */
static double shortened(double x)
{
    return fl_d_from_bits(fl_d_bits(x) & ~(uint64_t)0x1fffffff);
}

static bool check_profile(const fl_profile *profile, fl_diags *diags)
{
    if (profile->degree < 1 || profile->degree > FL_REVOLVE_MAX_DEGREE)
        return fl_error(diags, profile->loc, "a profile has degree 1 to %d, this one has %u",
                        FL_REVOLVE_MAX_DEGREE, profile->degree);
    if (profile->segment_count < 1 || profile->segment_count > FL_REVOLVE_MAX_SEGMENTS)
        return fl_error(diags, profile->loc, "a profile has 1 to %d segments, this one has %u",
                        FL_REVOLVE_MAX_SEGMENTS, profile->segment_count);
    for (uint32_t i = 0; i < profile->segment_count * (profile->degree + 1); i++)
        if (!isfinite(profile->points[i].x) || !isfinite(profile->points[i].y))
            return fl_error(diags, profile->loc, "point %u of the profile is not finite", i + 1);
    return true;
}

/* Set unit, y_center, tiny, scale from the extent of the control points. */
static bool measure(fl_revolve *r, const fl_profile *profile, fl_diags *diags)
{
    double radius = 0.0, lo = HUGE_VAL, hi = -HUGE_VAL;
    for (uint32_t i = 0; i < profile->segment_count * (profile->degree + 1); i++) {
        radius = fl_max(fabs(profile->points[i].x), radius);
        lo = fl_min(profile->points[i].y, lo);
        hi = fl_max(profile->points[i].y, hi);
    }
    double reach = fl_max(radius, fl_max(fabs(lo), fabs(hi)));
    if (reach > MAX_SIZE)
        return fl_error(diags, profile->loc, "coordinates of a profile are at most %g, found %g",
                        MAX_SIZE, reach);
    double size = fl_max(radius, hi - lo);
    if (!(size >= 1.0 / MAX_SIZE && size >= 1e-100 * reach))
        return fl_error(diags, profile->loc, "the profile is too small: its size is %g", size);
    r->unit = 2.0 / fl_revolve_power_above(size);
    r->y_center = shortened(0.5 * (lo + hi)) * r->unit;
    r->tiny = size * r->unit * 0x1p-53;
    r->scale = fl_max(size, reach);
    return true;
}

/* The segments as given, in powers of t, for the baseline. */
static bool keep_segments(fl_revolve *r, fl_arena *arena, const double *x, const double *y)
{
    uint32_t n = r->newton_degree;
    double *out = fl_arena_alloc(arena, (size_t)r->segment_count * 2 * (n + 1), sizeof *out);
    if (!out)
        return false;
    r->newton = out;
    for (uint32_t s = 0; s < r->segment_count; s++) {
        for (int axis = 0; axis < 2; axis++, out += n + 1) {
            double binomial = 1.0;
            memcpy(out, (axis ? y : x) + (size_t)s * (n + 1), (n + 1) * sizeof *out);
            for (uint32_t k = 1; k <= n; k++)
                for (uint32_t i = n; i >= k; i--)
                    out[i] -= out[i - 1];
            for (uint32_t k = 0; k <= n; k++) {
                out[k] *= binomial;
                binomial = binomial * (double)(n - k) / (double)(k + 1);
            }
        }
    }
    return true;
}

static void finish_bounds(fl_revolve *r)
{
    double to_object = 1.0 / r->unit, slack = 8.0 * r->tiny;
    double radius = (r->radius + slack) * to_object;
    double lo = (r->y_lo + r->y_center) * to_object, hi = (r->y_hi + r->y_center) * to_object;
    double pad = slack * to_object + 0x1p-51 * fl_max(fabs(lo), fabs(hi));
    r->bounds = (fl_box){{-radius, lo - pad, -radius}, {radius, hi + pad, radius}};
    r->v_lo = r->y_lo;
    r->v_scale = r->y_hi > r->y_lo ? 1.0 / (r->y_hi - r->y_lo) : 0.0;
    r->radius += FL_REVOLVE_PAD;
    r->y_lo -= FL_REVOLVE_PAD;
    r->y_hi += FL_REVOLVE_PAD;
}

fl_revolve *fl_revolve_build(fl_arena *arena, const fl_profile *profile, fl_diags *diags)
{
    fl_revolve shape = {0};
    if (!check_profile(profile, diags) || !measure(&shape, profile, diags))
        return NULL;
    fl_arena scratch = {0};
    size_t count = (size_t)profile->segment_count * (profile->degree + 1);
    double *x = fl_arena_alloc(&scratch, count, sizeof *x),
           *y = fl_arena_alloc(&scratch, count, sizeof *y);
    double *y_low = fl_arena_alloc(&scratch, count, sizeof *y_low);
    fl_revolve *r = fl_arena_alloc(arena, 1, sizeof *r);
    bool ok = x && y && y_low && r;
    if (!ok)
        fl_out_of_memory(diags, "a revolution surface");
    for (size_t i = 0; ok && i < count; i++) {
        double height = profile->points[i].y * shape.unit, high = height - shape.y_center,
               back = high + shape.y_center;
        x[i] = profile->points[i].x * shape.unit;
        y[i] = high;
        y_low[i] = (height - back) + (shape.y_center - (back - high));
    }
    shape.newton_degree = profile->degree;
    shape.segment_count = profile->segment_count;
    ok = ok && fl_revolve_split(&shape, arena, x, y, y_low, profile->segment_count, profile->degree,
                                profile->loc, diags);
    if (ok && (!fl_revolve_group_boxes(&shape, arena) || !keep_segments(&shape, arena, x, y)))
        ok = fl_out_of_memory(diags, "a revolution surface");
    fl_arena_deinit(&scratch);
    if (!ok)
        return NULL;
    finish_bounds(&shape);
    fl_revolve_set_isa(&shape, fl_cpu_best_isa());
    *r = shape;
    return r;
}

void fl_revolve_set_isa(fl_revolve *revolve, fl_isa isa)
{
    static const fl_revolve_ops *const ops[FL_ISA_COUNT] = FL_ISA_TABLE(fl_revolve_ops);
    FL_ASSERT((unsigned)isa < FL_ISA_COUNT && ops[isa]);
    revolve->ops = ops[isa];
}

fl_box fl_revolve_bounds(const fl_revolve *revolve)
{
    return revolve->bounds;
}

uint32_t fl_revolve_piece_count(const fl_revolve *revolve)
{
    return revolve->piece_count;
}

bool fl_revolve_nearest(const fl_revolve *revolve, const double o[3], const double d[3],
                        double u_min, double u_max, fl_revolve_solver solver,
                        fl_revolve_hit *out_hit)
{
    if (solver != FL_REVOLVE_ROBUST)
        return fl_revolve_newton(revolve, o, d, u_min, u_max, solver, out_hit);
    return revolve->ops->nearest(revolve, o, d, u_min, u_max, out_hit);
}

bool fl_revolve_any(const fl_revolve *revolve, const double o[3], const double d[3], double u_min,
                    double u_max, fl_revolve_solver solver)
{
    fl_revolve_hit hit;
    if (solver != FL_REVOLVE_ROBUST)
        return fl_revolve_newton(revolve, o, d, u_min, u_max, solver, &hit);
    return revolve->ops->any(revolve, o, d, u_min, u_max);
}

uint32_t fl_revolve_reject8(const fl_revolve *revolve, const fl_revolve_packet *rays, uint32_t mask)
{
    return revolve->ops->reject8(revolve, rays, mask);
}

static uint32_t newton8(const fl_revolve *revolve, const fl_revolve_packet *rays, uint32_t mask,
                        uint32_t starts, fl_revolve_hit *out_hits)
{
    uint32_t hits = 0;
    for (uint32_t i = 0; i < FL_REVOLVE_PACKET; i++) {
        double o[3] = {rays->ox[i], rays->oy[i], rays->oz[i]},
               d[3] = {rays->dx[i], rays->dy[i], rays->dz[i]};
        if ((mask >> i & 1u) &&
            fl_revolve_newton(revolve, o, d, rays->u_min[i], rays->u_max[i], starts, &out_hits[i]))
            hits |= 1u << i;
    }
    return hits;
}

uint32_t fl_revolve_nearest8(const fl_revolve *revolve, const fl_revolve_packet *rays,
                             uint32_t mask, fl_revolve_solver solver,
                             fl_revolve_hit out_hits[FL_REVOLVE_PACKET])
{
    if (solver != FL_REVOLVE_ROBUST)
        return newton8(revolve, rays, mask, solver, out_hits);
    return revolve->ops->nearest8(revolve, rays, mask, out_hits);
}

uint32_t fl_revolve_any8(const fl_revolve *revolve, const fl_revolve_packet *rays, uint32_t mask,
                         fl_revolve_solver solver)
{
    fl_revolve_hit hits[FL_REVOLVE_PACKET];
    if (solver != FL_REVOLVE_ROBUST)
        return newton8(revolve, rays, mask, solver, hits);
    return revolve->ops->any8(revolve, rays, mask);
}

/* Direction of the curve in its own sense at `t`, from the first derivative that is not lost in
 * rounding. Cusps are ends of pieces: near the far end, derivatives of even order point back. */
static void tangent(const double *cx, const double *cy, uint32_t n, double t, double *out_x,
                    double *out_y)
{
    double dx[FL_REVOLVE_MAX_DEGREE + 1], dy[FL_REVOLVE_MAX_DEGREE + 1], size = 0.0;
    for (uint32_t k = 0; k <= n; k++) {
        dx[k] = cx[k];
        dy[k] = cy[k];
        size = k ? size + fabs(cx[k]) + fabs(cy[k]) : size;
    }
    for (uint32_t order = 1; order <= n; order++) {
        uint32_t rest = n - order;
        for (uint32_t k = 0; k <= rest; k++) {
            dx[k] = (double)(k + 1) * dx[k + 1];
            dy[k] = (double)(k + 1) * dy[k + 1];
        }
        double x = fl_revolve_poly(dx, rest, t), y = fl_revolve_poly(dy, rest, t),
               length = sqrt(x * x + y * y);
        if (length > 1e-9 * size) {
            double sign = t > 0.5 && order % 2 == 0 ? -1.0 : 1.0;
            *out_x = sign * x / length;
            *out_y = sign * y / length;
            return;
        }
    }
    *out_x = 0.0;
    *out_y = 1.0;
}

void fl_revolve_resolve(const fl_revolve *revolve, const double o[3], const double d[3],
                        const fl_revolve_hit *hit, fl_revolve_point *out_point)
{
    const double *piece = fl_revolve_piece(revolve, hit->sheet);
    uint32_t n = revolve->degree;
    double x = fl_revolve_poly(piece, n, hit->local),
           y = fl_revolve_poly(piece + n + 1, n, hit->local);
    double tx, ty, px = o[0] + hit->u * d[0], pz = o[2] + hit->u * d[2];
    tangent(piece, piece + n + 1, n, hit->local, &tx, &ty);
    x = fl_max(x, 0.0);
    fl_vec3 radial = fl_v3_normalize(fl_v3(px, 0.0, pz));
    if (!(fl_v3_dot(radial, radial) > 0.0))
        radial = fl_v3(1.0, 0.0, 0.0);
    double object = 1.0 / revolve->unit, sign = revolve->normal_sign;
    out_point->position =
        fl_v3(radial.x * x * object, (y + revolve->y_center) * object, radial.z * x * object);
    if (x <= 4.0 * revolve->tiny && tx != 0.0) /* a pole: the mean of the normals around it */
        out_point->normal = fl_v3(0.0, -copysign(sign, tx), 0.0);
    else
        out_point->normal = fl_v3(sign * ty * radial.x, -sign * tx, sign * ty * radial.z);
    double turn = fl_d_atan2(radial.z, radial.x) * 0x1.45f306dc9c883p-3; /* 1 / 2 pi */
    out_point->u = turn < 0.0 ? -turn : 1.0 - turn;
    out_point->v = fl_clamp((y - revolve->v_lo) * revolve->v_scale, 0.0, 1.0);
    out_point->scale = revolve->scale;
}
