/* SPDX-License-Identifier: MIT
 *
 * Hits of single primitives against closed forms in long double: the double path and the float
 * kernels, over radii and distances where the textbook's quadratic has no digits left.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cli/extremes.h"
#include "core/double_trace.h"
#include "core/trace_piece.h"

enum { RAYS = 20000 };

static uint64_t state;

static double unit(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 40) * 0x1p-24;
}

static fl_compiled *compile(const char *object)
{
    char text[1024];
    fl_diags diags = {0};
    snprintf(text, sizeof text,
             "firstlight 1\nMaterials { Material { } }\nGroup { MaterialIndex 0 %s }\n", object);
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), "form", &(fl_parse_options){0}, &extreme_files, &diags);
    assert_non_null(scene);
    fl_compiled *compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, &diags);
    assert_non_null(compiled);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    return compiled;
}

/* Hits of one ray, made of floats, by both. */
typedef struct both {
    bool in_float, in_double;
    double t_float, t_double;
} both;

static both trace(const fl_compiled *compiled, fl_vec3 o, fl_vec3 d)
{
    both out;
    fl_isect_context context = {0};
    fl_double_ray ray = {o, d, HUGE_VAL, FL_NONE, FL_NONE};
    fl_double_hit hit;
    float from[3] = {(float)o.x, (float)o.y, (float)o.z};
    float way[3] = {(float)d.x, (float)d.y, (float)d.z}, t;
    uint32_t object;
    /* The origin of the geometry is 0 here, so these are the same numbers. */
    out.in_double = fl_double_nearest(&compiled->geometry, &ray, &context, &hit);
    out.t_double = hit.t;
    assert_true(fl_trace_nearest(compiled, from, way, 1, &t, &object, NULL, NULL));
    out.in_float = object != FL_NONE;
    out.t_float = (double)t;
    return out;
}

static double rounded(double x)
{
    return (double)(float)x;
}

/* The nearer root, and by how much of r^2 the ray misses the silhouette. */
static long double sphere_root(fl_vec3 o, fl_vec3 d, long double r, long double *out_margin)
{
    long double ox = (long double)o.x, oy = (long double)o.y, oz = (long double)o.z;
    long double dx = (long double)d.x, dy = (long double)d.y, dz = (long double)d.z;
    long double a = dx * dx + dy * dy + dz * dz, b = -(ox * dx + oy * dy + oz * dz);
    long double lx = ox + b / a * dx, ly = oy + b / a * dy, lz = oz + b / a * dz;
    long double rest = r * r - (lx * lx + ly * ly + lz * lz);
    *out_margin = rest / (r * r);
    if (rest < 0.0L)
        return -1.0L;
    long double root = sqrtl(rest / a);
    return b / a > root ? b / a - root : b / a + root;
}

static void spheres_of_all_sizes_from_all_distances(void **unused)
{
    (void)unused;
    static const struct {
        double radius, distance; /* of the eye from the centre */
        double float_error;      /* of t, relative; measured at half of it or less */
    } cases[] = {{1, 5, 4e-6},        {1, 1e2, 2e-7},     {1, 1e3, 2e-7},   {1, 1e4, 2e-7},
                 {1e-2, 1e3, 1e-7},   {1e-6, 1e-5, 1e-6}, {1e8, 3e8, 6e-6}, {1e4, 1e4 + 5, 3e-5},
                 {1e6, 1e6 + 5, 6e-3} /* the winner is then solved in double */};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        char object[128];
        double r = rounded(cases[i].radius), z = rounded(cases[i].distance), worst[2] = {0};
        uint32_t wrong[2] = {0};
        snprintf(object, sizeof object, "Sphere { center 0 0 0 radius %.17g }", r);
        fl_compiled *compiled = compile(object);
        state = 5 + i;
        for (uint32_t k = 0; k < RAYS; k++) {
            double spread = 1.2 * cases[i].radius / cases[i].distance;
            spread = spread < 1.0 ? spread : 1.0;
            fl_vec3 o = fl_v3(0, 0, z), d = fl_v3(rounded(spread * (2 * unit() - 1)),
                                                  rounded(spread * (2 * unit() - 1)), -1);
            long double margin, t = sphere_root(o, d, (long double)r, &margin);
            both got = trace(compiled, o, d);
            const bool hit[2] = {got.in_float, got.in_double};
            const double found[2] = {got.t_float, got.t_double};
            /* Within the rounding of its own squares, a silhouette may go either way. */
            const long double doubt[2] = {1e-6L * (long double)(z / r),
                                          1e-14L * (long double)(z / r)};
            for (int p = 0; p < 2; p++) {
                if (fabsl(margin) < doubt[p])
                    continue;
                wrong[p] += hit[p] != (t > 0.0L) ? 1 : 0;
                double error =
                    t > 0.0L && hit[p] ? (double)fabsl(((long double)found[p] - t) / t) : 0;
                worst[p] = error > worst[p] ? error : worst[p];
            }
        }
        print_message("r %g from %g: float %u wrong, t %.1e; double %u wrong, t %.1e\n", r, z,
                      wrong[0], worst[0], wrong[1], worst[1]);
        assert_int_equal(wrong[0], 0);
        assert_int_equal(wrong[1], 0);
        assert_true(worst[0] <= cases[i].float_error);
        assert_true(worst[1] <= 1e-9);
        fl_compiled_release(compiled);
    }
}

static void planes_at_all_slopes(void **unused)
{
    (void)unused;
    fl_compiled *compiled = compile("Plane { normal 0 1 0 offset 0 }");
    double worst[2] = {0};
    state = 3;
    for (uint32_t k = 0; k < RAYS; k++) {
        double slope = pow(10.0, -8.0 * unit()), height = pow(10.0, 6.0 * unit() - 6.0);
        fl_vec3 o = fl_v3(rounded(unit()), rounded(height), rounded(unit()));
        fl_vec3 d = fl_v3(rounded(unit() - 0.5), -rounded(slope), rounded(unit() - 0.5));
        double t = o.y / -d.y; /* one rounding */
        both got = trace(compiled, o, d);
        assert_true(got.in_float && got.in_double);
        worst[0] = fmax(worst[0], fabs(got.t_float - t) / t);
        worst[1] = fmax(worst[1], fabs(got.t_double - t) / t);
    }
    print_message("plane: float t %.1e, double t %.1e\n", worst[0], worst[1]);
    assert_true(worst[0] <= 1e-7 && worst[1] <= 1e-15);
    fl_compiled_release(compiled);
}

/* A triangle of 1 : 1e6, aimed at with points that are inside or outside by at least 1e-3 of its
 * width. */
static void needles_are_hit_where_they_are(void **unused)
{
    (void)unused;
    fl_compiled *compiled = compile("Triangle { vertex0 -1 0 0 vertex1 1 0 0 vertex2 0 1e-6 0 }");
    uint32_t wrong[2] = {0};
    state = 9;
    for (uint32_t k = 0; k < RAYS; k++) {
        double x = 2.2 * unit() - 1.1, width = 1e-6 * (1.0 - fabs(x));
        double y = 1e-6 * (2.0 * unit() - 0.5);
        fl_vec3 o = fl_v3(rounded(x), rounded(y), 1), d = fl_v3(0, 0, -1);
        width = 1e-6 * (1.0 - fabs(o.x));
        if (fabs(o.y) < 1e-9 || fabs(o.y - width) < 1e-9)
            continue;
        bool is_inside = o.y > 0.0 && o.y < width;
        both got = trace(compiled, o, d);
        wrong[0] += got.in_float != is_inside ? 1 : 0;
        wrong[1] += got.in_double != is_inside ? 1 : 0;
    }
    assert_int_equal(wrong[0], 0);
    assert_int_equal(wrong[1], 0);
    fl_compiled_release(compiled);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_of_all_sizes_from_all_distances),
        cmocka_unit_test(planes_at_all_slopes),
        cmocka_unit_test(needles_are_hit_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
