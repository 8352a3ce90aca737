/* SPDX-License-Identifier: MIT
 *
 * Single primitives, refraction and the lens against closed forms in long double: the double path
 * and the float kernels, over radii and distances where the textbook's quadratic has no digits
 * left, at grazing and critical angles, and for lenses focused anywhere.
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
#include "core/frame.h"
#include "core/raytree.h"
#include "core/trace_piece.h"
#include "support/rounded.h"

enum { RAYS = 20000 };

static uint64_t state;

static double unit(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 40) * 0x1p-24;
}

/* The text's scene, and its frame if that is asked for. */
static fl_compiled *compile_text(const char *text, fl_frame **out_frame)
{
    fl_diags diags = {0};
    fl_params params;
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), "form", &(fl_parse_options){0}, &extreme_files, &diags);
    assert_non_null(scene);
    fl_compiled *compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, &diags);
    assert_non_null(compiled);
    fl_params_from_scene(&params, scene, false);
    if (out_frame) {
        *out_frame = fl_frame_create(compiled, &params, &diags);
        assert_non_null(*out_frame);
    }
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    return compiled;
}

static fl_compiled *compile(const char *object)
{
    char text[1024];
    snprintf(text, sizeof text,
             "firstlight 1\nMaterials { Material { } }\nGroup { MaterialIndex 0 %s }\n", object);
    return compile_text(text, NULL);
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

/* --- Spheres -----------------------------------------------------------------------------------
 */

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

/* --- Flat shapes -------------------------------------------------------------------------------
 */

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
        long double t = (long double)o.y / -(long double)d.y;
        both got = trace(compiled, o, d);
        assert_true(got.in_float && got.in_double);
        worst[0] = fmax(worst[0], (double)(fabsl((long double)got.t_float - t) / t));
        worst[1] = fmax(worst[1], (double)(fabsl((long double)got.t_double - t) / t));
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

typedef struct real3 {
    long double x, y, z;
} real3;

static real3 real(fl_vec3 v)
{
    return (real3){(long double)v.x, (long double)v.y, (long double)v.z};
}

static real3 plus(real3 a, real3 b, long double s)
{
    return (real3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

static long double dot(real3 a, real3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static real3 cross(real3 a, real3 b)
{
    return (real3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static long double length(real3 a)
{
    return sqrtl(dot(a, a));
}

typedef enum flat_kind { SQUARE, DISK, TRIANGLE } flat_kind;

/* Corner (a disk: centre) and sides (two radii). */
typedef struct flat {
    flat_kind kind;
    fl_vec3 c, u, v;
} flat;

/* Where a ray meets the plane of a shape. */
typedef struct meeting {
    long double t, inside; /* How far from the border, in the sides' own units; below 0: outside. */
    long double lever;     /* What a rounding of the numbers that go in does to t, relatively. */
    long double far;       /* From the ray's origin to the corner, and on to where they meet. */
} meeting;

static meeting flat_root(const flat *f, fl_vec3 o, fl_vec3 d)
{
    real3 u = real(f->u), v = real(f->v), n = cross(u, v), way = real(d);
    real3 from = plus(real(o), real(f->c), -1.0L);
    long double height = dot(n, from), sink = dot(n, way), square = dot(n, n), t = -height / sink;
    real3 p = plus(from, way, t);
    long double a = dot(cross(p, v), n) / square, b = dot(cross(u, p), n) / square;
    long double rim = f->kind == DISK       ? 1.0L - sqrtl(a * a + b * b)
                      : f->kind == TRIANGLE ? 1.0L - a - b
                                            : fminl(1.0L - a, 1.0L - b);
    return (meeting){.t = t,
                     .inside = f->kind == DISK ? rim : fminl(fminl(a, b), rim),
                     .lever =
                         length(n) * (length(from) / fabsl(height) + length(way) / fabsl(sink)),
                     .far = length(from) + fabsl(t) * length(way)};
}

static fl_vec3 rounded3(double x, double y, double z)
{
    return fl_v3(rounded(x), rounded(y), rounded(z));
}

/* A tilted one in space, `width` in one direction and `height` in the other. */
static fl_compiled *compile_flat(flat_kind kind, double width, double height, flat *out)
{
    char text[512];
    fl_vec3 c = rounded3(-0.3 * width, 0.2 * width, 0.1 * width);
    fl_vec3 u = rounded3(0.8 * width, 0.1 * width, -0.59 * width);
    fl_vec3 v = rounded3(-0.2 * height, 0.97 * height, -0.1 * height);
    fl_vec3 cu = fl_v3_add(c, u), cv = fl_v3_add(c, v), n = fl_v3_normalize(fl_v3(1, 2, -3));
    cu = rounded3(cu.x, cu.y, cu.z);
    cv = rounded3(cv.x, cv.y, cv.z);
    *out = (flat){kind, c, fl_v3_sub(cu, c), fl_v3_sub(cv, c)};
    if (kind == SQUARE) {
        *out = (flat){kind, c, u, v};
        snprintf(text, sizeof text,
                 "Square { corner %.17g %.17g %.17g u %.17g %.17g %.17g v %.17g %.17g %.17g }", c.x,
                 c.y, c.z, u.x, u.y, u.z, v.x, v.y, v.z);
    } else if (kind == TRIANGLE) {
        snprintf(text, sizeof text,
                 "Triangle { vertex0 %.17g %.17g %.17g vertex1 %.17g %.17g %.17g vertex2 %.17g "
                 "%.17g %.17g }",
                 c.x, c.y, c.z, cu.x, cu.y, cu.z, cv.x, cv.y, cv.z);
    } else { /* Any two radii span it. */
        out->u = fl_v3_scale(fl_v3_normalize(fl_v3_cross(fl_v3(0, 1, 0), n)), width);
        out->v = fl_v3_cross(n, out->u);
        snprintf(text, sizeof text, "Disk { center %.17g %.17g %.17g normal 1 2 -3 radius %.17g }",
                 c.x, c.y, c.z, width);
    }
    return compile(text);
}

/* Rays at points in and about it, a third of them grazing. */
static void aim_at(const flat *f, double width, fl_vec3 *o, fl_vec3 *d)
{
    fl_vec3 n = fl_v3_normalize(fl_v3_cross(f->u, f->v));
    double a = 3.0 * unit() - 1.5, b = 3.0 * unit() - 1.5, far = width * (0.5 + 3.0 * unit());
    double lean = unit() < 0.33 ? 1e-3 : 1.0;
    fl_vec3 p = fl_v3_mad(fl_v3_mad(f->c, f->u, a), f->v, b);
    fl_vec3 from = fl_v3_mad(p, n, lean * far);
    from = fl_v3_mad(from, fl_v3_normalize(f->u), far * (2.0 * unit() - 1.0));
    from = fl_v3_mad(from, fl_v3_normalize(f->v), far * (2.0 * unit() - 1.0));
    *o = rounded3(from.x, from.y, from.z);
    *d = rounded3(p.x - o->x, p.y - o->y, p.z - o->z);
}

static void flat_shapes_at_all_slopes_and_sizes(void **unused)
{
    (void)unused;
    static const char *const names[] = {"square", "disk", "triangle"};
    static const struct {
        flat_kind kind;
        double width, ratio, most; /* Roundings that t may be off; twice what was measured. */
    } cases[] = {{SQUARE, 1, 1, 4},
                 {SQUARE, 1e-6, 1, 4},
                 {SQUARE, 1e6, 1, 4},
                 {SQUARE, 1, 1e-3, 4},
                 {DISK, 1, 1, 4},
                 {DISK, 1e-6, 1, 4},
                 {DISK, 1e6, 1, 4},
                 {TRIANGLE, 1, 1, 4},
                 {TRIANGLE, 1e-6, 1, 4},
                 {TRIANGLE, 1e6, 1, 4},
                 /* t is the mean of the corners', whose weights a sliver knows badly. */
                 {TRIANGLE, 1, 1e-3, 160},
                 {TRIANGLE, 1, 1e-5, 12000}};
    static const long double roundings[2] = {0x1p-24L, 0x1p-53L};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        flat f;
        double width = cases[i].width, ratio = cases[i].ratio, worst[2] = {0};
        uint32_t wrong[2] = {0}, judged[2] = {0};
        fl_compiled *compiled = compile_flat(cases[i].kind, width, ratio * width, &f);
        state = 50 + i;
        for (uint32_t k = 0; k < RAYS; k++) {
            fl_vec3 o, d;
            aim_at(&f, width, &o, &d);
            meeting m = flat_root(&f, o, d);
            both got = trace(compiled, o, d);
            const bool hit[2] = {got.in_float, got.in_double};
            const double found[2] = {got.t_float, got.t_double};
            for (int p = 0; p < 2; p++) {
                /* The place is off by t's error along the ray, and by its own. */
                long double step = roundings[p] * m.lever;
                long double doubt = 4.0L * (step + roundings[p]) * m.far;
                if (fabsl(m.inside) < doubt / (long double)(width * ratio))
                    continue;
                judged[p]++;
                wrong[p] += hit[p] != (m.inside > 0.0L && m.t > 0.0L) ? 1 : 0;
                double error =
                    hit[p] ? (double)(fabsl(((long double)found[p] - m.t) / m.t) / step) : 0.0;
                worst[p] = fmax(worst[p], error);
            }
        }
        print_message("%s of %g by %g: float %u of %u wrong, t %.1f roundings; double %u of %u, "
                      "%.1f\n",
                      names[f.kind], width, ratio * width, wrong[0], judged[0], worst[0], wrong[1],
                      judged[1], worst[1]);
        assert_int_equal(wrong[0], 0);
        assert_int_equal(wrong[1], 0);
        assert_true(judged[0] > RAYS / 100 && judged[1] > RAYS / 2);
        assert_true(worst[0] <= cases[i].most && worst[1] <= cases[i].most);
        fl_compiled_release(compiled);
    }
}

/* --- Refraction --------------------------------------------------------------------------------
 */

/* Leaving glass of 1.5 through y = 0, about so far from the critical angle: which way each ray
 * goes, and where. */
static void the_critical_angle_is_where_it_is(void **unused)
{
    (void)unused;
    static const double offsets[] = {-1e-3, -1e-6, 0.0, 1e-6, 1e-3};
    for (size_t i = 0; i < FL_COUNT_OF(offsets); i++) {
        char text[512];
        double angle = asin(1.0 / 1.5) + offsets[i];
        uint32_t wrong = 0, judged = 0, total = 0;
        long double worst_along = 0.0L, worst_across = 0.0L;
        snprintf(text, sizeof text,
                 "firstlight 1\nPerspectiveCamera { center 0 -1 0 direction %.17g %.17g 0 up 0 0 1 "
                 "angle 0.01 width 48 height 36 }\nMaterials { Material { diffuseColor 0 0 0 "
                 "refract 1 refractionIndex 1.5 } }\nGroup { MaterialIndex 0 Plane { normal 0 1 0 "
                 "offset 0 } }\n",
                 sin(angle), cos(angle));
        fl_frame *frame;
        fl_compiled *compiled = compile_text(text, &frame);
        fl_raytree tree = {0};
        for (uint32_t k = 0; k < 48 * 36; k++) {
            assert_true(fl_raytree_trace(frame, k % 48, k / 48, 0, &tree));
            assert_int_equal(tree.node_count, 2);
            const fl_raytree_node *up = &tree.nodes[0], *next = &tree.nodes[1];
            real3 d = {(long double)up->direction[0], (long double)up->direction[1],
                       (long double)up->direction[2]};
            long double size = length(d), x = 1.5L * d.x / size, z = 1.5L * d.z / size;
            long double across = 1.0L - x * x - z * z; /* Squared. */
            bool is_total = next->kind == FL_RAY_REFLECT;
            total += is_total ? 1 : 0;
            if (!is_total) {
                long double y = (long double)next->direction[1];
                worst_along = fmaxl(worst_along, fabsl((long double)next->direction[0] - x));
                worst_along = fmaxl(worst_along, fabsl((long double)next->direction[2] - z));
                worst_across = fmaxl(worst_across, fabsl(y * y - fmaxl(across, 0.0L)));
            }
            if (fabsl(across) < 5e-7L) /* Eight roundings. */
                continue;
            judged++;
            wrong += is_total != (across < 0.0L) ? 1 : 0;
        }
        print_message("critical angle %+g: %u of %u wrong, %u reflected; off by %.1e along, %.1e "
                      "across squared\n",
                      offsets[i], wrong, judged, total, (double)worst_along, (double)worst_across);
        assert_int_equal(wrong, 0);
        assert_true(judged > 1600);
        assert_true(worst_along <= 2.5e-7L && worst_across <= 5e-7L);
        fl_raytree_deinit(&tree);
        fl_frame_release(frame);
        fl_compiled_release(compiled);
    }
}

/* --- The lens ----------------------------------------------------------------------------------
 */

/* Whatever point of the lens a ray leaves from, it goes through the one point that is sharp there.
 */
static void rays_of_the_lens_meet_in_the_focus(void **unused)
{
    (void)unused;
    static const double focuses[] = {1e-6, 1e-3, 1.0, 7.0, 1e6, 1e20, HUGE_VAL};
    for (size_t i = 0; i < FL_COUNT_OF(focuses); i++) {
        char text[512];
        long double focus = (long double)focuses[i], worst = 0.0L, worst_pinhole = 0.0L;
        snprintf(text, sizeof text,
                 "firstlight 1\nPerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 "
                 "1 0 angle 40 width 48 height 36 aperture 0.1 focus %.17g }\nMaterials { Material "
                 "{ } }\nGroup { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } }\n",
                 focuses[i]);
        fl_frame *frame;
        fl_compiled *compiled = compile_text(text, &frame);
        real3 w = {-0.03L, -0.15L, -1.0L}, eye = {0.3L, 1.4L, 7.0L};
        w = plus((real3){0}, w, 1.0L / length(w));
        real3 h = cross(w, (real3){0, 1, 0});
        h = plus((real3){0}, h, 1.0L / length(h));
        real3 v = cross(h, w);
        long double pixel = 2.0L * tanl(20.0L / 180.0L * acosl(-1.0L)) / 36.0L;
        state = 4;
        for (uint32_t k = 0; k < RAYS; k++) {
            double x = 48.0 * unit(), y = 36.0 * unit(), lx = 2 * unit() - 1, ly = 2 * unit() - 1;
            fl_vec3 o, d, straight;
            fl_frame_ray(frame, x, y, 0.0, 0.0, &o, &straight);
            fl_frame_ray(frame, x, y, lx, ly, &o, &d);
            real3 sharp = plus(plus(w, h, pixel * ((long double)x - 24.0L)), v,
                               pixel * (18.0L - (long double)y));
            worst_pinhole = fmaxl(worst_pinhole, length(plus(real(straight), sharp, -1.0L)));
            if (isinf(focus)) {
                worst = fmaxl(worst, length(plus(real(d), real(straight), -1.0L)));
                continue;
            }
            real3 meets = plus(real(o), real(d), focus), want = plus(eye, sharp, focus);
            long double scale = length(real(o)) + focus * length(real(d));
            worst = fmaxl(worst, length(plus(meets, want, -1.0L)) / scale);
        }
        print_message("focus %g: off by %.1e, through the middle by %.1e\n", focuses[i],
                      (double)worst, (double)worst_pinhole);
        assert_true(worst <= 1e-15L && worst_pinhole <= 1e-15L);
        fl_frame_release(frame);
        fl_compiled_release(compiled);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_of_all_sizes_from_all_distances),
        cmocka_unit_test(planes_at_all_slopes),
        cmocka_unit_test(needles_are_hit_where_they_are),
        cmocka_unit_test(flat_shapes_at_all_slopes_and_sizes),
        cmocka_unit_test(the_critical_angle_is_where_it_is),
        cmocka_unit_test(rays_of_the_lens_meet_in_the_focus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
