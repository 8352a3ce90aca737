/* SPDX-License-Identifier: MIT
 *
 * compare_reference [--samples N] [--size N] [--random] [--exact] [--seed N]
 *                   [--accel bvh|octree|none] [--double] [--pixel X Y] [--extremes | SCENE ...]
 *
 * Renders each scene with the renderer and with the reference at the same sample points and
 * compares the means of each pixel. A scene agrees when at least 99.9 % of its pixels, excused ones
 * included, differ by at most 1/1024 in every channel. A differing pixel is excused if moving the
 * camera rays of its samples by at most 1e-5 of their length brings the reference within that; at
 * most ten a scene. With --double the renderer traces in double and the bounds are 1/100000 and
 * 1e-9. Scenes named exact_*, or all with --exact, follow their dialect's own rules. Without
 * scenes: all of scenes/, scenes/course/ and tests/reference/scenes/. With --extremes: the rows of
 * `firstlight study --extremes` that are judged by double there, in double here, where the bounds
 * are parts of the picture's root mean square if that is above 1. --pixel shows one pixel's
 * samples. Exit status 0: all agree; 1: not; 2: wrong use.
 */
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cli/extremes.h"
#include "core/firstlight.h"
#include "io/files.h"
#include "reference.h"

enum { EXCUSED_MAX = 10, SAMPLES_MAX = 64, LISTED_MAX = 6 };
static const double share_needed = 0.999;
static double tolerance = 1.0 / 1024.0, nudge_max = 1e-5; /* smaller with --double */

typedef struct options {
    uint32_t samples, size, seed;
    bool is_random, is_exact, is_double, is_extreme, has_pixel;
    uint32_t pixel[2];
    fl_accel accel;
} options;

typedef struct contest {
    const char *path;
    fl_diags diags;
    fl_scene *scene;
    fl_compiled *compiled;
    fl_params params;
    fl_render *render;
    ref_dump *dump;
    uint32_t samples;
} contest;

static void print_diags(const fl_diags *diags)
{
    char text[1024];
    for (uint32_t i = 0; i < diags->count; i++) {
        fl_diag_format(&diags->items[i], text, sizeof text);
        fprintf(stderr, "%s\n", text);
    }
}

static fl_scene *parse_file(const char *path, fl_diags *diags)
{
    size_t bytes;
    char *text =
        fl_file_load(path, "scene", FL_SCENE_FILE_MAX_BYTES, (fl_loc){.file = path}, diags, &bytes);
    fl_scene *scene =
        text ? fl_scene_parse(text, bytes, path, &(fl_parse_options){0}, &fl_files_on_disk, diags)
             : NULL;
    free(text);
    return scene;
}

/* `text`: of a row of extremes; NULL: what the file holds. */
static bool contest_open(contest *c, const options *o, const char *path, const char *text)
{
    *c = (contest){.path = path, .samples = o->samples};
    c->scene = text ? fl_scene_parse(text, strlen(text), path, &(fl_parse_options){0},
                                     &extreme_files, &c->diags)
                    : parse_file(path, &c->diags);
    if (!c->scene)
        return false;
    const char *slash = strrchr(path, '/');
    bool is_exact = o->is_exact || strncmp(slash ? slash + 1 : path, "exact_", 6) == 0;
    fl_params_from_scene(&c->params, c->scene, is_exact);
    if (is_exact)
        c->samples = 1;
    c->params.width = c->params.height = o->size;
    c->params.seed = o->seed;
    if (o->is_double)
        c->params.precision = FL_PRECISION_DOUBLE;
    if (o->is_random)
        c->params.sampler = FL_SAMPLER_RANDOM;
    fl_compile_options compile = {.accel = o->accel, .in_double = o->is_double};
    c->compiled = fl_compile(c->scene, &compile, NULL, &c->diags);
    fl_render_options render = {0};
    c->render = c->compiled ? fl_render_create(&render, &c->diags) : NULL;
    c->dump = c->render ? ref_dump_create(c->scene, &c->params) : NULL;
    return c->dump && reference_prepare(c->dump);
}

static void contest_close(contest *c)
{
    print_diags(&c->diags);
    ref_dump_destroy(c->dump);
    fl_render_destroy(c->render);
    fl_compiled_release(c->compiled);
    fl_scene_destroy(c->scene);
    fl_diags_deinit(&c->diags);
}

/* Mean of the first `samples` samples of the whole picture or, in `out_rgb`, of one pixel. */
static bool render_mean(contest *c, const uint32_t *pixel, uint32_t samples, float *out_rgb,
                        size_t floats)
{
    fl_params params = c->params;
    if (pixel) {
        params.crop_x = pixel[0];
        params.crop_y = pixel[1];
        params.crop_w = params.crop_h = 1;
    }
    fl_render_limits limits = {.samples = samples};
    fl_render_set_limits(c->render, &limits);
    fl_progress progress;
    if (!fl_render_restart(c->render, c->compiled, &params, &c->diags) ||
        !fl_render_wait(c->render, -1.0) || !fl_render_mean(c->render, out_rgb, floats, &progress))
        return false;
    if (progress.counts.dropped_branches || progress.counts.invalid_samples)
        printf("  renderer: %llu branches dropped, %llu samples invalid\n",
               (unsigned long long)progress.counts.dropped_branches,
               (unsigned long long)progress.counts.invalid_samples);
    return progress.complete_samples == samples;
}

static double difference(ref_vec a, ref_vec b)
{
    double d = fmax(fabs(a.x - b.x), fmax(fabs(a.y - b.y), fabs(a.z - b.z)));
    return isnan(d) ? HUGE_VAL : d;
}

/* The renderer's samples of one pixel, one by one: differences of running means. */
static bool render_samples(contest *c, const uint32_t pixel[2], ref_vec *out)
{
    ref_vec before = {0};
    for (uint32_t n = 1; n <= c->samples; n++) {
        float rgb[3];
        if (!render_mean(c, pixel, n, rgb, 3))
            return false;
        ref_vec sum = {(double)rgb[0] * n, (double)rgb[1] * n, (double)rgb[2] * n};
        out[n - 1] = (ref_vec){sum.x - before.x, sum.y - before.y, sum.z - before.z};
        before = sum;
    }
    return true;
}

/* The reference's sample nearest to `want`, with the camera ray as it is or moved in one of eight
 * ways by 1e-5 of its length or less, down to the rounding of a float: behind glass the picture
 * changes within that. */
static ref_vec nearest_moved(const contest *c, const uint32_t pixel[2], uint32_t index,
                             ref_vec want, double out_nudge[2])
{
    enum { DIRECTIONS = 8, LENGTHS = 5 };
    ref_vec best = reference_sample(c->dump, pixel[0], pixel[1], index, NULL);
    out_nudge[0] = out_nudge[1] = 0.0;
    for (int k = 0; k < DIRECTIONS * LENGTHS; k++) {
        double angle = k % DIRECTIONS * 0.78539816339744831;
        double length = ldexp(nudge_max, -2 * (k / DIRECTIONS));
        double nudge[2] = {length * cos(angle), length * sin(angle)};
        ref_vec moved = reference_sample(c->dump, pixel[0], pixel[1], index, nudge);
        if (difference(moved, want) < difference(best, want)) {
            best = moved;
            out_nudge[0] = nudge[0];
            out_nudge[1] = nudge[1];
        }
    }
    return best;
}

/* Examine a differing pixel, and say so if `is_listed`. True: it is excused. */
static bool examine(contest *c, const uint32_t pixel[2], bool is_listed)
{
    ref_vec mine[SAMPLES_MAX], off = {0};
    if (!render_samples(c, pixel, mine))
        return false;
    for (uint32_t i = 0; i < c->samples; i++) {
        double nudge[2];
        ref_vec plain = reference_sample(c->dump, pixel[0], pixel[1], i, NULL);
        ref_vec near = nearest_moved(c, pixel, i, mine[i], nudge);
        off = (ref_vec){off.x + mine[i].x - near.x, off.y + mine[i].y - near.y,
                        off.z + mine[i].z - near.z};
        if (is_listed && difference(mine[i], plain) > tolerance)
            printf("    sample %u: renderer %.5f %.5f %.5f, reference %.5f %.5f %.5f, moved (%g "
                   "%g) %.5f %.5f %.5f\n",
                   i, mine[i].x, mine[i].y, mine[i].z, plain.x, plain.y, plain.z, nudge[0],
                   nudge[1], near.x, near.y, near.z);
    }
    bool is_excused = difference(off, (ref_vec){0}) <= tolerance * c->samples;
    if (is_listed)
        printf("  pixel %u %u: %s\n", pixel[0], pixel[1],
               is_excused ? "excused: a ray moved by a little agrees" : "NOT excused");
    return is_excused;
}

static ref_vec reference_pixel(const contest *c, uint32_t x, uint32_t y)
{
    ref_vec sum = {0};
    for (uint32_t i = 0; i < c->samples; i++) {
        ref_vec s = reference_sample(c->dump, x, y, i, NULL);
        sum = (ref_vec){sum.x + s.x, sum.y + s.y, sum.z + s.z};
    }
    double n = c->samples;
    return (ref_vec){sum.x / n, sum.y / n, sum.z / n};
}

/* Colours of extremes may be huge, and differences are in parts of what is seen. */
static double picture_scale(const float *rgb, size_t floats)
{
    double sum = 0.0;
    for (size_t i = 0; i < floats; i++)
        sum += (double)rgb[i] * (double)rgb[i];
    return fmax(1.0, sqrt(sum / (double)floats));
}

static bool contest_judge(contest *c, const options *o)
{
    const double plain_tolerance = tolerance;
    size_t floats = (size_t)3 * o->size * o->size;
    float *mean = malloc(floats * sizeof *mean);
    bool ok = mean && render_mean(c, NULL, c->samples, mean, floats);
    if (ok && o->is_extreme)
        tolerance *= picture_scale(mean, floats);
    uint32_t differing = 0, excused = 0;
    double worst = 0.0, worst_agreeing = 0.0;
    clock_t begin = clock();
    for (uint32_t y = 0; ok && y < o->size; y++)
        for (uint32_t x = 0; x < o->size; x++) {
            const float *rgb = &mean[3 * ((size_t)y * o->size + x)];
            double d = difference((ref_vec){(double)rgb[0], (double)rgb[1], (double)rgb[2]},
                                  reference_pixel(c, x, y));
            worst = fmax(worst, d);
            if (d <= tolerance)
                worst_agreeing = fmax(worst_agreeing, d);
            else if (differing++ < 4 * LISTED_MAX)
                excused += examine(c, (uint32_t[]){x, y}, differing <= LISTED_MAX);
        }
    free(mean);
    tolerance = plain_tolerance;
    if (!ok)
        return false;
    double pixels = (double)o->size * o->size;
    double share = (pixels - differing) / pixels,
           with_excused = (pixels - differing + excused) / pixels;
    ok = with_excused >= share_needed && excused <= EXCUSED_MAX;
    printf("%s %s: %.3f %% agree, %u of %u differing pixels excused, largest difference %.2e, of "
           "agreeing %.2e, %.1f s\n",
           ok ? "ok  " : "FAIL", c->path, 100.0 * share, excused, differing, worst, worst_agreeing,
           (double)(clock() - begin) / CLOCKS_PER_SEC);
    fflush(stdout);
    return ok;
}

static bool compare(const options *o, const char *path, const char *text)
{
    contest c;
    bool ok = contest_open(&c, o, path, text);
    if (!ok)
        printf("FAIL %s: cannot be opened\n", path);
    else if (o->has_pixel)
        ok = examine(&c, o->pixel, true);
    else
        ok = contest_judge(&c, o);
    contest_close(&c);
    return ok;
}

/* Rows judged by double, and the scene that others scale; returns how many, and how many differ.
 * Not those that are judged by their mean: from 1e6 away the reference's quadratic has 1e-4 left.
 */
static int compare_extremes(const options *o, int *failures)
{
    int count = 0;
    for (uint32_t i = 0; i < extreme_family_count; i++) {
        const extreme_family *f = &extreme_families[i];
        bool is_one = f->judge == EXTREME_SCALED;
        bool is_judged = is_one || f->judge == EXTREME_DOUBLE;
        for (const char *const *text = f->values; is_judged && *text; text++) {
            if (is_one && text != f->values)
                break;
            char scene[EXTREME_TEXT_MAX], name[320];
            extreme_value v;
            extreme_value_read(f, *text, &v);
            if (v.is_slow)
                continue;
            extreme_text(f, &v, scene);
            snprintf(name, sizeof name, "%s: %s", f->name, v.text);
            *failures += !compare(o, name, scene);
            count++;
        }
    }
    return count;
}

static uint32_t number(const char *text)
{
    return text ? (uint32_t)strtoul(text, NULL, 10) : 0;
}

/* Options from argv; *out_first is the first scene. False: wrong use. */
static bool read_options(int argc, char **argv, options *o, int *out_first)
{
    static const char *const accels[] = {"bvh", "octree", "none"};
    static const fl_accel accel_values[] = {FL_ACCEL_BVH, FL_ACCEL_OCTREE, FL_ACCEL_NONE};
    *o = (options){.samples = 4, .size = 96, .accel = FL_ACCEL_BVH};
    int i = 1;
    for (; i < argc && strncmp(argv[i], "--", 2) == 0; i++) {
        bool ok = true;
        if (strcmp(argv[i], "--samples") == 0) {
            o->samples = number(argv[++i]);
        } else if (strcmp(argv[i], "--size") == 0) {
            o->size = number(argv[++i]);
        } else if (strcmp(argv[i], "--seed") == 0) {
            o->seed = number(argv[++i]);
        } else if (strcmp(argv[i], "--random") == 0) {
            o->is_random = true;
        } else if (strcmp(argv[i], "--exact") == 0) {
            o->is_exact = true;
        } else if (strcmp(argv[i], "--double") == 0 || strcmp(argv[i], "--extremes") == 0) {
            o->is_double = true;
            o->is_extreme |= argv[i][2] == 'e';
            tolerance = 1e-5;
            nudge_max = 1e-9;
        } else if (strcmp(argv[i], "--pixel") == 0 && i + 2 < argc) {
            o->has_pixel = true;
            o->pixel[0] = number(argv[++i]);
            o->pixel[1] = number(argv[++i]);
        } else if (strcmp(argv[i], "--accel") == 0 && i + 1 < argc) {
            ok = false;
            for (size_t k = 0; k < FL_COUNT_OF(accels); k++)
                if (strcmp(argv[i + 1], accels[k]) == 0) {
                    o->accel = accel_values[k];
                    ok = true;
                }
            i++;
        } else {
            ok = false;
        }
        if (!ok)
            return false;
    }
    *out_first = i;
    return o->samples >= 1 && o->samples <= SAMPLES_MAX && o->size >= 2;
}

int main(int argc, char **argv)
{
    options o;
    int first, failures = 0, count = 0;
    if (!read_options(argc, argv, &o, &first)) {
        fprintf(stderr, "compare_reference: see the head of compare_reference.c\n");
        return 2;
    }
    for (int i = first; i < argc; i++, count++)
        failures += !compare(&o, argv[i], NULL);
    if (o.is_extreme) {
        count = compare_extremes(&o, &failures);
    } else if (first == argc) {
        glob_t found = {0};
        glob(FL_SOURCE_DIR "/scenes/*.txt", 0, NULL, &found);
        glob(FL_SOURCE_DIR "/scenes/course/*.txt", GLOB_APPEND, NULL, &found);
        glob(FL_SOURCE_DIR "/tests/reference/scenes/*.txt", GLOB_APPEND, NULL, &found);
        for (size_t i = 0; i < found.gl_pathc; i++, count++)
            failures += !compare(&o, found.gl_pathv[i], NULL);
        globfree(&found);
    }
    printf("%d scenes, %d failed\n", count, failures);
    return failures || !count;
}
