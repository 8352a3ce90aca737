/* SPDX-License-Identifier: MIT
 *
 * Profiles of surfaces of revolution: all curves become Bezier segments.
 */
#include <string.h>

#include "core/parse_build.h"

static fl_vec3 point(const fl_node *controls, uint32_t i)
{
    return fl_v3(controls->numbers[3 * i], controls->numbers[3 * i + 1], 0.0);
}

static bool check_flat(fl_builder *b, const fl_node *controls, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (controls->numbers[3 * i + 2] != 0.0)
            return fl_error(b->diags, fl_build_loc(b, controls),
                            "a profile lies in the plane z = 0, but control point %u has z = %g",
                            (unsigned)i + 1, controls->numbers[3 * i + 2]);
    return true;
}

/* Numbers of points that a Bezier curve may have, and the degree of its segments. */
static bool bezier_degree(fl_builder *b, const fl_node *curve, const fl_node *controls,
                          uint32_t count, uint32_t *out_degree)
{
    fl_loc loc = fl_build_loc(b, controls);
    bool is_piecewise = fl_build_choice(b, curve, FL_KEY_PIECEWISE) == 1;
    bool is_cubics = count >= 4 && count % 3 == 1;
    *out_degree = is_piecewise ? 3 : count - 1;
    if (is_piecewise)
        return is_cubics ||
               fl_error(b->diags, loc,
                        "a piecewise BezierCurve has 3k+1 control points, at least 4; this "
                        "one has %u",
                        (unsigned)count);
    if (count < 2 || count > FL_DEGREE_MAX + 1)
        return fl_error(b->diags, loc, "a BezierCurve has 2 to %d control points, this one has %u",
                        FL_DEGREE_MAX + 1, (unsigned)count);
    if (b->tree->dialect != FL_DIALECT_PA1 || is_cubics)
        return true;
    const char *format =
        "the course asks for 3k+1 control points, at least 4; this BezierCurve has %u";
    if (!b->tree->is_lenient)
        return fl_error(b->diags, loc, format, (unsigned)count);
    fl_warning(b->diags, loc, format, (unsigned)count);
    return true;
}

/* Span j of a uniform cubic B-spline over points j to j+3, as a Bezier segment. Neighbouring
 * segments compute the shared end point from the same numbers in the same order, so that it is the
 * same bits. */
static void bspline_segment(const fl_node *controls, uint32_t j, fl_vec3 out[4])
{
    fl_vec3 p[4];
    for (uint32_t i = 0; i < 4; i++)
        p[i] = point(controls, j + i);
    for (int end = 0; end < 2; end++) {
        fl_vec3 sum = fl_v3_add(fl_v3_mad(p[end], p[end + 1], 4.0), p[end + 2]);
        out[3 * end] = fl_v3(sum.x / 6.0, sum.y / 6.0, 0.0);
        fl_vec3 inner = fl_v3_mad(p[2 - end], p[1 + end], 2.0);
        out[1 + end] = fl_v3(inner.x / 3.0, inner.y / 3.0, 0.0);
    }
}

uint32_t fl_build_profile(fl_builder *b, const fl_node *curve)
{
    const fl_node *controls = fl_node_key(curve, FL_KEY_CONTROLS);
    uint32_t count = controls->number_count / 3;
    bool is_bspline = curve->block->id == FL_BLOCK_BSPLINE;
    fl_profile profile = {.degree = 3, .loc = fl_build_loc(b, curve)};
    if (!check_flat(b, controls, count))
        return FL_NONE;
    if (is_bspline && count < 4) {
        fl_error(b->diags, fl_build_loc(b, controls),
                 "a BsplineCurve has at least 4 control points, this one has %u", (unsigned)count);
        return FL_NONE;
    }
    if (!is_bspline && !bezier_degree(b, curve, controls, count, &profile.degree))
        return FL_NONE;
    profile.segment_count = is_bspline ? count - 3 : (count - 1) / profile.degree;
    uint32_t order = profile.degree + 1;
    profile.points = fl_arena_alloc(&b->scene->arena, (size_t)profile.segment_count * order,
                                    sizeof *profile.points);
    if (!profile.points) {
        fl_out_of_memory(b->diags, "a profile");
        return FL_NONE;
    }
    for (uint32_t j = 0; j < profile.segment_count; j++) {
        if (is_bspline) {
            bspline_segment(controls, j, &profile.points[j * order]);
            continue;
        }
        for (uint32_t i = 0; i < order; i++)
            profile.points[j * order + i] = point(controls, j * profile.degree + i);
    }
    b->scene->profiles[b->scene->profile_count] = profile;
    return b->scene->profile_count++;
}
