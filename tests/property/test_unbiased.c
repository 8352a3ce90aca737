/* SPDX-License-Identifier: MIT
 *
 * Scenes whose mean is known in closed form: over many seeds the mean of the samples is that,
 * within what its own spread allows (a z-test), for every sampler, with frozen sets too.
 */
#include "kernel/pipeline_world.h"

enum { SEEDS = 400, SAMPLES = 16 };

/* Five standard errors: for a right mean one test in a million fails, and seeds are fixed. */
#define Z_MAX 5.0

typedef struct sums {
    double value, square;
} sums;

/* The mean of SAMPLES samples of the one pixel of the picture. */
static double pixel_mean(const fl_frame *frame, fl_workspace *workspace)
{
    static const uint16_t zero = 0;
    double sum = 0.0;
    for (uint32_t s = 0; s < SAMPLES; s++) {
        fl_unit unit = {&zero, &zero, 1, s};
        fl_counts counts = {0};
        bool out_of_memory;
        assert_true(fl_pipeline_run(frame, &unit, workspace, NULL, 0, &counts, &out_of_memory));
        assert_int_equal(counts.invalid_samples, 0);
        sum += (double)fl_workspace_result(workspace)->g[0];
    }
    return sum / SAMPLES;
}

/* Means over seeds; each seed is an independent experiment. */
static void assert_mean(world *w, double want)
{
    static const fl_sampler samplers[] = {FL_SAMPLER_SOBOL, FL_SAMPLER_RANDOM, FL_SAMPLER_PADDED,
                                          FL_SAMPLER_STRATIFIED};
    fl_workspace *workspace = fl_workspace_create();
    assert_non_null(workspace);
    w->params.width = w->params.height = 1;
    w->params.strata = SAMPLES;
    for (size_t k = 0; k < FL_COUNT_OF(samplers); k++) {
        sums sum = {0};
        w->params.sampler = samplers[k];
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            w->params.seed = fl_hash_step(17, seed);
            fl_frame *frame = world_frame(w, FL_ISA_SCALAR);
            double mean = pixel_mean(frame, workspace);
            sum.value += mean;
            sum.square += mean * mean;
            fl_frame_release(frame);
        }
        double mean = sum.value / SEEDS;
        double variance = fl_max(sum.square / SEEDS - mean * mean, 0.0) / (SEEDS - 1);
        double z = fabs(mean - want) / sqrt(variance + 1e-14);
        if (!(z < Z_MAX))
            fail_msg("sampler %d: %.6f, not %.6f: z = %.1f", (int)samplers[k], mean, want, z);
    }
    fl_workspace_destroy(workspace);
}

/* The foot of a disk light of radius r at height h sees the mean cosine
 * 2 h (sqrt(h^2 + r^2) - h) / r^2 (no falloff, no cosine at the light). */
static double foot_cosine(double h, double r)
{
    return 2.0 * h * (sqrt(h * h + r * r) - h) / (r * r);
}

/* A floor seen from above, one point of it when the pixel is not an area. */
static fl_light *make_foot(world *w, double h, double r)
{
    world_init(w);
    w->params.camera.fov_deg = 1;
    w->params.exact.pixel = FL_PIXEL_CENTER;
    add_material(w);
    add_plane(w, fl_v3(0, 0, 1), 0);
    fl_light *light = add_light(w, FL_LIGHT_DISK, fl_v3(0, 0, h), gray(1));
    light->direction = fl_v3(0, 0, -1);
    light->radius = r;
    return light;
}

static void a_disk_light_gives_the_mean_cosine(void **state)
{
    (void)state;
    static const double radii[] = {0.5, 2.0, 8.0};
    for (size_t i = 0; i < FL_COUNT_OF(radii); i++)
        for (uint32_t m = 1; m <= 3; m += 2) {
            world w;
            make_foot(&w, 3.0, radii[i])->samples = m;
            assert_mean(&w, foot_cosine(3.0, radii[i]));
        }
}

/* A screen that covers half of the light leaves half of what arrives. */
static void half_a_light_gives_half(void **state)
{
    (void)state;
    world w;
    make_foot(&w, 3.0, 2.0);
    /* Its edge stands on the axis between the light and the foot, but above the eye. */
    add_square(&w, fl_v3(0, -50, 2), fl_v3(50, 0, 0), fl_v3(0, 100, 0));
    w.params.camera.center = fl_v3(0, 0, 1);
    assert_mean(&w, 0.5 * foot_cosine(3.0, 2.0));
}

/* Ambient light on one half plane, black behind it: what part of pixel and lens it covers. */
static void make_edge(world *w, double depth, double offset)
{
    world_init(w);
    w->params.ambient = gray(1);
    w->params.camera.fov_deg = 45;
    add_material(w)->diffuse = gray(1);
    add_square(w, fl_v3(offset, -500, 10 - depth), fl_v3(500, 0, 0), fl_v3(0, 1000, 0));
}

static void a_pixel_sees_the_covered_part(void **state)
{
    (void)state;
    static const double parts[] = {0.5, 0.3, 0.9};
    for (size_t i = 0; i < FL_COUNT_OF(parts); i++) {
        world w;
        double depth = 4.0, half = depth * 0.41421356237309503; /* tan(22.5 degrees) */
        make_edge(&w, depth, half * (1.0 - 2.0 * parts[i]));
        assert_mean(&w, parts[i]);
    }
}

/* By symmetry half, whatever the lens, sharp or not; of a lens with corners, too. */
static void a_lens_sees_half_of_an_edge_through_its_axis(void **state)
{
    (void)state;
    for (uint32_t code = 0; code < 4; code++) {
        world w;
        make_edge(&w, 4.0, 0.0);
        w.params.camera.aperture = 0.7;
        w.params.camera.focus = code % 2 ? 4.0 : 9.0;
        w.params.camera.blades = code / 2 ? 6 : 0;
        assert_mean(&w, 0.5);
    }
}

/* A closed white room under ambient light, mirrors in it: 1 + r + r^2 + ... + r^depth, every
 * sample. */
static void a_furnace_of_mirrors_is_even(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.ambient = gray(1);
    w.params.depth_limit = 5;
    w.params.weight_threshold = 0;
    w.params.camera.aperture = 0.3;
    w.params.camera.focus = 5;
    fl_material *m = add_material(&w);
    m->diffuse = gray(1);
    m->reflect = gray(0.5);
    add_sphere(&w, fl_v3(0, 0, 0), 40);
    add_sphere(&w, fl_v3(0, 0, 0), 2);
    assert_mean(&w, 1.96875);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_disk_light_gives_the_mean_cosine),
        cmocka_unit_test(half_a_light_gives_half),
        cmocka_unit_test(a_pixel_sees_the_covered_part),
        cmocka_unit_test(a_lens_sees_half_of_an_edge_through_its_axis),
        cmocka_unit_test(a_furnace_of_mirrors_is_even),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
