/* SPDX-License-Identifier: MIT
 *
 * Frozen sampling sets stand still and nothing else does; shares of scenes whose noise has a known
 * origin; the same figures however often one stops.
 */
#include "core/noise.h"
#include "kernel/pipeline_world.h"

/* A floor under one disk light, seen by a pinhole: pixel and light are the only sets. */
static void make_floor(world *w, double radius)
{
    world_init(w);
    w->params.width = w->params.height = 32;
    add_material(w);
    add_plane(w, fl_v3(0, 0, 1), 0);
    add_sphere(w, fl_v3(0, 0, 2), 0.5);
    fl_light *light = add_light(w, FL_LIGHT_DISK, fl_v3(1, 2, 6), gray(1));
    light->direction = fl_v3(0, 0, -1);
    light->radius = radius;
}

static fl_noise *begin(world *w, uint32_t samples)
{
    fl_frame *frame = world_frame(w, FL_ISA_SCALAR);
    fl_diags diags = {0};
    fl_noise *noise = fl_noise_create(frame->scene, &frame->params, samples, &diags);
    assert_non_null(noise);
    fl_frame_release(frame);
    fl_diags_deinit(&diags);
    return noise;
}

static fl_noise_split measure(world *w, uint32_t rounds)
{
    fl_noise *noise = begin(w, FL_NOISE_SAMPLES);
    while (fl_noise_rounds(noise) < rounds)
        assert_true(fl_noise_step(noise));
    assert_int_equal(fl_noise_steps(noise), (uint64_t)rounds * fl_noise_round_steps(noise));
    fl_noise_split split;
    assert_true(fl_noise_read(noise, &split));
    fl_noise_destroy(noise);
    return split;
}

static const fl_noise_source *find(const fl_noise_split *split, fl_noise_kind kind)
{
    for (uint32_t i = 0; i < split->source_count; i++)
        if (split->sources[i].kind == kind)
            return &split->sources[i];
    fail_msg("no source of kind %d", (int)kind);
    return NULL;
}

static picture first, second;

/* With every set frozen all samples are the same; with one of them free they are not. */
static void frozen_sets_stand_still(void **state)
{
    (void)state;
    static const fl_sampler samplers[] = {FL_SAMPLER_SOBOL, FL_SAMPLER_RANDOM, FL_SAMPLER_PADDED,
                                          FL_SAMPLER_STRATIFIED};
    static const uint32_t bits[] = {FL_FREEZE_PIXEL, FL_FREEZE_LENS, FL_FREEZE_DEEPER, 1u << 3};
    for (size_t s = 0; s < 2 * FL_COUNT_OF(samplers); s++) {
        world w;
        make_floor(&w, 1.0);
        w.params.sampler = samplers[s / 2];
        w.params.strata = 8;
        w.params.precision = s % 2 ? FL_PRECISION_DOUBLE : FL_PRECISION_FLOAT;
        w.params.camera.aperture = 0.4;
        w.params.camera.focus = 4;
        w.materials[0].reflect = gray(0.5);
        w.lights[0].samples = 2;
        w.params.frozen = ~0u;
        world_render(&w, FL_ISA_SCALAR, 0, &first);
        world_render(&w, FL_ISA_SCALAR, 7, &second);
        assert_memory_equal(first.rgb, second.rgb, sizeof first.rgb);
        for (size_t b = 0; b < FL_COUNT_OF(bits); b++) {
            w.params.frozen = ~bits[b];
            world_render(&w, FL_ISA_SCALAR, 7, &second);
            assert_true(memcmp(first.rgb, second.rgb, sizeof first.rgb) != 0);
        }
    }
}

/* What is not frozen draws the very numbers it draws without freezing. */
static void free_sets_do_not_notice(void **state)
{
    (void)state;
    world w;
    make_floor(&w, 1.0);
    world_render(&w, FL_ISA_SCALAR, 5, &first);
    w.params.frozen = FL_FREEZE_LENS | FL_FREEZE_DEEPER | fl_freeze_light(1);
    world_render(&w, FL_ISA_SCALAR, 5, &second);
    assert_same_picture(&first, &second);
}

static void a_scene_without_random_numbers_has_no_noise(void **state)
{
    (void)state;
    world w;
    make_floor(&w, 0.0);
    w.params.exact.pixel = FL_PIXEL_CENTER;
    fl_noise_split split = measure(&w, 1);
    char advice[FL_NOISE_ADVICE_BYTES];
    assert_int_equal(split.source_count, 0);
    assert_true(split.variance == 0.0 && split.light_samples == 0.0);
    fl_noise_advice(&split, advice);
    assert_non_null(strstr(advice, "no noise"));
}

static void hard_light_and_pinhole_leave_the_edges(void **state)
{
    (void)state;
    world w;
    make_floor(&w, 0.0);
    fl_noise_split split = measure(&w, 1);
    assert_int_equal(split.source_count, 1);
    assert_near(find(&split, FL_NOISE_PIXEL)->share, 1.0, 1e-12);
    assert_near(find(&split, FL_NOISE_PIXEL)->alone, 1.0, 1e-12);
    assert_true(find(&split, FL_NOISE_PIXEL)->held == 0.0);
}

/* A large light: the penumbra is everywhere, edges are few. */
static void a_large_light_makes_the_noise(void **state)
{
    (void)state;
    world w;
    make_floor(&w, 2.0);
    fl_noise_split split = measure(&w, 4);
    const fl_noise_source *light = find(&split, FL_NOISE_LIGHT);
    assert_true(light->share > 0.75 && light->light == 0);
    assert_near(light->share + find(&split, FL_NOISE_PIXEL)->share, 1.0, 1e-12);
    assert_near(light->alone + find(&split, FL_NOISE_PIXEL)->alone + split.joint, 1.0, 0.15);
    assert_true(split.shadows_per_path > 0.5 && split.shadows_per_path <= 1.0);
    assert_true(split.light_samples == 1.0 && split.path_seconds > 0.0);
}

/* Two equal lights share the noise equally, within what the measurement says of itself. */
static void equal_lights_have_equal_shares(void **state)
{
    (void)state;
    world w;
    make_floor(&w, 2.0);
    fl_light *other = add_light(&w, FL_LIGHT_DISK, fl_v3(-1, -2, 6), gray(1));
    other->direction = fl_v3(0, 0, -1);
    other->radius = 2.0;
    fl_noise_split split = measure(&w, 4);
    const fl_noise_source *a = &split.sources[1], *b = &split.sources[2];
    assert_true(a->kind == FL_NOISE_LIGHT && b->kind == FL_NOISE_LIGHT && b->light == 1);
    assert_near(a->share, b->share, 3.0 * (a->share_error + b->share_error));
    assert_true(a->share_error < 0.1 && b->share_error < 0.1);
}

/* Variances are a function of the scene, the parameters and the rounds. */
static void figures_repeat(void **state)
{
    (void)state;
    world w;
    make_floor(&w, 1.0);
    fl_noise_split a = measure(&w, 2), b = measure(&w, 2);
    assert_true(a.variance == b.variance && a.joint == b.joint);
    assert_memory_equal(a.sources, b.sources, a.source_count * sizeof a.sources[0]);
    w.params.seed = 1;
    b = measure(&w, 2);
    assert_true(a.variance != b.variance);
}

/* Nothing is said before a round is complete. */
static void a_round_is_the_least(void **state)
{
    (void)state;
    world w;
    make_floor(&w, 1.0);
    fl_noise *noise = begin(&w, 4);
    fl_noise_split split;
    char advice[FL_NOISE_ADVICE_BYTES];
    for (uint32_t i = 0; i < fl_noise_round_steps(noise); i++) {
        assert_false(fl_noise_read(noise, &split));
        fl_noise_advice(&split, advice);
        assert_non_null(strstr(advice, "not measured"));
        assert_true(fl_noise_step(noise));
    }
    assert_true(fl_noise_read(noise, &split));
    fl_noise_destroy(noise);
}

/* m* from shares and costs: a figure whose parts are known. */
static void advice_names_the_knob(void **state)
{
    (void)state;
    fl_noise_split split = {.source_count = 2,
                            .samples = 16,
                            .rounds = 1,
                            .variance = 1.0,
                            .light_samples = 1.0,
                            .light_samples_best = 3.0,
                            .light_samples_gain = 1.25};
    split.sources[0] = (fl_noise_source){.kind = FL_NOISE_LENS, .share = 0.1};
    split.sources[1] = (fl_noise_source){.kind = FL_NOISE_LIGHT, .light = 2, .share = 0.9};
    char advice[FL_NOISE_ADVICE_BYTES];
    fl_noise_advice(&split, advice);
    assert_string_equal(
        advice,
        "90 % light 3, 10 % lens: light samples up to 3: 0.80 times the error in the same time");
    split.light_samples_gain = 1.0;
    split.light_samples_best = 1.0;
    fl_noise_advice(&split, advice);
    assert_string_equal(
        advice,
        "90 % light 3, 10 % lens: raise samples: twice as many give about 0.66 times the error");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frozen_sets_stand_still),
        cmocka_unit_test(free_sets_do_not_notice),
        cmocka_unit_test(a_scene_without_random_numbers_has_no_noise),
        cmocka_unit_test(hard_light_and_pinhole_leave_the_edges),
        cmocka_unit_test(a_large_light_makes_the_noise),
        cmocka_unit_test(equal_lights_have_equal_shares),
        cmocka_unit_test(figures_repeat),
        cmocka_unit_test(a_round_is_the_least),
        cmocka_unit_test(advice_names_the_knob),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
