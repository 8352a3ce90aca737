/* SPDX-License-Identifier: MIT
 *
 * Studies of real pictures: what the samplers promise, what the error certificate promises, and
 * that a study is repeatable. Without an argument small pictures (a minute of one core); with
 * --all the sizes and the scenes that the figures of docs/accuracy.md name.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "cli/study_table.h"

static bool is_all;

typedef struct lab {
    fl_diags diags;
    cli_scene scene;
    study s;
    study_table *table;
} lab;

/* Run a study of tests/study/NAME (or, with a slash, of that path in the source tree). */
static void lab_run(lab *l, const char *name, uint32_t side, uint32_t knobs,
                    const study_settings *settings)
{
    static char path[1024];
    memset(l, 0, sizeof *l);
    snprintf(path, sizeof path, "%s/%s%s", FL_SOURCE_DIR, strchr(name, '/') ? "" : "tests/study/",
             name);
    l->scene.diags = &l->diags;
    cli_options options = {.threads = settings->threads};
    if (!cli_scene_open(&options, path, &l->scene))
        fail_msg("%s: %s", path, l->diags.items[0].message);
    uint32_t width = l->scene.params.width, height = l->scene.params.height;
    l->scene.params.width = width >= height ? side : side * width / height;
    l->scene.params.height = height >= width ? side : side * height / width;
    if (!study_run(&l->scene, settings, knobs, &l->s))
        fail_msg("%s: %s", path, l->diags.items[0].message);
    l->table = study_table_create(&l->s);
    assert_non_null(l->table);
}

static void lab_end(lab *l)
{
    free(l->table);
    study_close(&l->s);
    cli_scene_close(&l->scene);
    fl_diags_deinit(&l->diags);
}

static uint32_t config_called(const study *s, const char *name)
{
    for (uint32_t i = 0; i < s->plan.count; i++)
        if (strcmp(s->plan.configs[i].name, name) == 0)
            return i;
    fail_msg("no configuration %s", name);
    return 0;
}

/* Lens, soft shadow and edges at once. */
static void samplers_converge_as_promised(void **state)
{
    (void)state;
    lab l;
    study_settings settings = {.samples_max = 1024,
                               .repeats = 1,
                               .threads = 1,
                               .reference_factor = is_all ? 8 : 2,
                               .skips_warm_up = true};
    lab_run(&l, "lens.txt", 96, 1u << STUDY_SAMPLER, &settings);
    const study_column *sobol = &l.table->columns[0];
    const study_column *random = &l.table->columns[config_called(&l.s, "sampler=random")];
    const study_column *padded = &l.table->columns[config_called(&l.s, "sampler=padded")];
    double at_64 = sobol->cells[6].noise.value / random->cells[6].noise.value;
    print_message("slope 16-1024: sobol %.3f, random %.3f, padded %.3f; RMSE at 64: sobol %.5f, "
                  "random %.5f, ratio %.3f\n",
                  sobol->slope, random->slope, padded->slope, sobol->cells[6].noise.value,
                  random->cells[6].noise.value, at_64);
    assert_true(fabs(random->slope + 0.5) <= 0.03);
    assert_true(sobol->slope < -0.58);
    assert_true(at_64 <= 0.5);
    lab_end(&l);
}

/* Every (scene, n >= 8) by itself. */
static void predicted_errors_are_true(void **state)
{
    (void)state;
    static const char *const scenes[] = {"lens.txt",        "edges.txt",
                                         "glass.txt",       "tests/viewer/three.txt",
                                         "scenes/vase.txt", "scenes/bunny.txt"};
    double ratios[64];
    uint32_t count = 0, inside = 0, scene_count = is_all ? 6 : 4;
    for (uint32_t i = 0; i < scene_count; i++) {
        lab l;
        study_settings settings = {.samples_max = is_all ? 512 : 128,
                                   .repeats = is_all ? 4 : 2,
                                   .threads = 1,
                                   .reference_factor = is_all ? 16 : 8,
                                   .skips_warm_up = true};
        lab_run(&l, scenes[i], is_all ? 128 : 48, 0, &settings);
        print_message("%s:", scenes[i]);
        for (uint32_t level = 3; level < l.s.levels; level++) {
            double ratio = l.table->columns[0].cells[level].predicted_ratio;
            print_message(" %u %.2f", 1u << level, ratio);
            inside += ratio >= 0.75 && ratio <= 1.4;
            ratios[count++] = ratio;
        }
        print_message("\n");
        lab_end(&l);
    }
    study_spread spread = study_spread_of(ratios, count);
    print_message("predicted/true: median %.3f, %u of %u within [0.75, 1.4]\n", spread.median,
                  inside, count);
    assert_true(spread.median >= 0.9 && spread.median <= 1.15);
    assert_true(inside >= 0.95 * count);
}

/* The squared bias of every pixel together: pairs of pictures with different seeds have nothing in
 * common but the truth. And of the mean of all pixels, whose deviation is known from the rounds. */
static void pictures_are_right_on_average(void **state)
{
    (void)state;
    lab l;
    study_settings settings = {.samples_max = 4,
                               .repeats = 32,
                               .threads = 1,
                               .reference_factor = 1024,
                               .skips_warm_up = true};
    lab_run(&l, "lens.txt", 40, 1u << STUDY_SAMPLER | 1u << STUDY_LIGHT_SAMPLES, &settings);
    const study_reference *own = &l.s.own;
    for (uint32_t i = 0; i < l.s.plan.count; i++) {
        const study_cell *cell = &l.table->columns[i].cells[2];
        const study_sum *sum = &l.s.pictures[i];
        double z = cell->bias.mean / cell->bias_se, mse = 0.0;
        for (uint32_t round = 0; round < 32; round++)
            mse += study_at(&l.s, i, round, 2)->noise.mse;
        double floor2 =
            study_floor_mse(sum->rgb, sum->count, mse, own->rgb[0], own->rgb[1], 40 * 40);
        double share = floor2 / pow(cell->noise.value, 2.0);
        print_message("%s: z of the mean %.2f, squared bias %.4f of the variance\n",
                      l.s.plan.configs[i].name, z, share);
        assert_true(fabs(z) < 4.0);
        /* If a tenth of the pixels carry the noise, evenly and grey: deviation
         * sqrt(2 / (32 * 31 * 160)) = 0.0036; four of them are allowed. */
        assert_true(fabs(share) < 0.0144);
    }
    lab_end(&l);
}

static void the_furnace_is_white(void **state)
{
    (void)state;
    lab l;
    study_settings settings = {
        .samples_max = 16, .repeats = 2, .threads = 1, .reference_factor = 4};
    lab_run(&l, "furnace.txt", 32, 1u << STUDY_SAMPLER | 1u << STUDY_SCALE, &settings);
    for (uint32_t i = 0; i < l.s.plan.count; i++)
        for (size_t k = 0; k < 3 * 32 * 32; k++)
            assert_true(fabs((double)l.s.pictures[i].rgb[k] / 2.0 - 1.0) < 1e-6);
    lab_end(&l);
}

static void assert_same_error(const study_error *a, const study_error *b)
{
    assert_memory_equal(a, b, sizeof *a);
}

/* Counts and error figures are a function of scene and settings: whatever the number of threads. */
static void studies_repeat(void **state)
{
    (void)state;
    lab a, b;
    study_settings settings = {
        .samples_max = 8, .repeats = 2, .threads = 1, .reference_factor = 16};
    lab_run(&a, "glass.txt", 32, ~0u, &settings);
    settings.threads = 3;
    lab_run(&b, "glass.txt", 32, ~0u, &settings);
    assert_int_equal(a.s.plan.count, b.s.plan.count);
    assert_true(a.s.own.samples == b.s.own.samples && a.s.own.rmse == b.s.own.rmse);
    assert_true(a.s.deep.samples == b.s.deep.samples && a.s.deep.rmse == b.s.deep.rmse);
    for (uint32_t i = 0; i < a.s.plan.count; i++)
        for (uint32_t round = 0; round < 2; round++)
            for (uint32_t level = 0; level < study_levels_of(&a.s.plan.configs[i]); level++) {
                const study_measure *x = study_at(&a.s, i, round, level);
                const study_measure *y = study_at(&b.s, i, round, level);
                assert_true(x->is_there && y->is_there);
                assert_memory_equal(&x->counts, &y->counts, sizeof x->counts);
                assert_same_error(&x->error, &y->error);
                assert_same_error(&x->noise, &y->noise);
                assert_true(x->predicted.rmse == y->predicted.rmse);
                assert_int_equal(x->counts.invalid_samples, 0);
            }
    lab_end(&a);
    lab_end(&b);
}

/* More bounces never hurt, and the floors know which setting leaves out how much. */
static void floors_fall_with_depth(void **state)
{
    (void)state;
    lab l;
    study_settings settings = {
        .samples_max = 16, .repeats = 4, .threads = 1, .reference_factor = 16};
    lab_run(&l, "glass.txt", 40, 1u << STUDY_DEPTH, &settings);
    static const char *const names[] = {"depth=0", "depth=1", "depth=2", "depth=3", "depth=12"};
    double before = (double)INFINITY;
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        const study_column *column = &l.table->columns[config_called(&l.s, names[i])];
        print_message("%s: floor %.5f, by fit %.5f\n", names[i], column->floor, column->fit.floor);
        assert_true(column->floor < before);
        before = column->floor;
    }
    const study_column *flat = &l.table->columns[config_called(&l.s, "depth=0")];
    assert_true(fabs(flat->fit.floor / flat->floor - 1.0) < 0.1);
    assert_true(fabs(flat->apart / flat->floor - 1.0) < 0.1);
    assert_true(before < 0.1 * flat->floor);
    lab_end(&l);
}

static uint32_t questions;

static bool stop_late(void)
{
    return ++questions > 40;
}

/* Whatever is there when the user has had enough can be read, and nothing else is. */
static void interrupted_studies_keep_what_they_have(void **state)
{
    (void)state;
    lab l;
    study_settings settings = {.samples_max = 16,
                               .repeats = STUDY_REPEATS_MAX,
                               .threads = 1,
                               .reference_factor = 1,
                               .skips_warm_up = true,
                               .should_stop = stop_late};
    questions = 0;
    lab_run(&l, "edges.txt", 32, 1u << STUDY_SAMPLER, &settings);
    assert_true(l.s.was_interrupted && l.s.rounds < 40);
    uint32_t before = STUDY_REPEATS_MAX;
    for (uint32_t level = 0; level < l.s.levels; level++) {
        uint32_t rounds = l.table->columns[0].cells[level].rounds;
        assert_true(rounds <= before && rounds < 40);
        before = rounds;
    }
    lab_end(&l);
    settings.budget_s = 1e-3;
    settings.should_stop = NULL;
    lab_run(&l, "edges.txt", 32, 1u << STUDY_SAMPLER, &settings);
    assert_true(l.s.ran_out_of_budget && !l.s.was_interrupted);
    lab_end(&l);
}

static void knobs_have_names(void **state)
{
    (void)state;
    char word[STUDY_NAME_BYTES];
    uint32_t knobs;
    assert_true(study_knobs_parse("depth,accel", &knobs, word));
    assert_int_equal(knobs, 1u << STUDY_DEPTH | 1u << STUDY_ACCEL);
    assert_false(study_knobs_parse("depth,,accel", &knobs, word));
    assert_false(study_knobs_parse("depth,light", &knobs, word));
    assert_string_equal(word, "light");
}

int main(int argc, char **argv)
{
    is_all = argc > 1 && strcmp(argv[1], "--all") == 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knobs_have_names),
        cmocka_unit_test(samplers_converge_as_promised),
        cmocka_unit_test(predicted_errors_are_true),
        cmocka_unit_test(pictures_are_right_on_average),
        cmocka_unit_test(the_furnace_is_white),
        cmocka_unit_test(studies_repeat),
        cmocka_unit_test(floors_fall_with_depth),
        cmocka_unit_test(interrupted_studies_keep_what_they_have),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
