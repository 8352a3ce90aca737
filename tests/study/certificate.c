/* SPDX-License-Identifier: MIT
 *
 * How far the error that a picture predicts is from the true one, and what adaptive sampling buys,
 * over scenes.
 *
 * usage: certificate [--side PX] [--reference N] [--most N] [--details] SCENE...
 *
 * The true mean squared error is the mean of (x - R1)(x - R2) with two independent references,
 * whose own noise then cancels in the mean: one of Sobol points, one of padded ones (decision 030).
 * Prints a table, a row a scene; details are a line for each number of samples. Fails when the
 * predictions leave the bounds of issue 6: of all (scene, samples
 * >= 8), 95 % within [0.75, 1.4] and the median within [0.9, 1.15].
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/load.h"

enum { SEED_PICTURE = 7, SEED_R1 = 1001, SEED_R2 = 2002, RATIOS_MAX = 4096, LEVELS_MAX = 16 };

/* The column of the table. */
enum { SHOWN_LEVEL = 6, SHOWN_SAMPLES = 1 << SHOWN_LEVEL };

static uint32_t side = 96, reference_samples = 1024, most_samples = 128;
static double ratios[RATIOS_MAX], gains[RATIOS_MAX];
static uint32_t ratio_count, gain_count, interval_count;
static bool has_details;

/* Least and greatest of some numbers. */
typedef struct span {
    double low, high;
} span;

typedef struct pictures {
    size_t floats;
    float *r1, *r2, *x;
} pictures;

/* Mean of the product of the differences from both references; below 0 when the references are too
 * noisy for x. */
static double true_square(const pictures *p)
{
    double sum = 0.0;
    for (size_t i = 0; i < p->floats; i++)
        sum += ((double)p->x[i] - (double)p->r1[i]) * ((double)p->x[i] - (double)p->r2[i]);
    return sum / (double)p->floats;
}

static bool go_on(fl_render *render, uint32_t samples, float *out, size_t floats,
                  fl_progress *out_progress)
{
    fl_render_limits limits = {.samples = samples};
    fl_render_set_limits(render, &limits);
    return fl_render_wait(render, -1.0) && fl_render_mean(render, out, floats, out_progress);
}

static bool render_once(fl_render *render, const cli_scene *scene, uint32_t seed,
                        fl_sampler sampler, bool is_adaptive, uint32_t samples, float *out,
                        size_t floats, fl_progress *out_progress)
{
    fl_params params = scene->params;
    params.seed = seed;
    params.sampler = sampler;
    params.is_adaptive = is_adaptive;
    fl_render_limits limits = {.samples = samples};
    fl_render_set_limits(render, &limits);
    return fl_render_restart(render, scene->compiled, &params, scene->diags) &&
           go_on(render, samples, out, floats, out_progress);
}

static uint64_t rays(const fl_progress *p)
{
    return p->counts.camera_rays + p->counts.shadow_rays + p->counts.reflect_rays +
           p->counts.refract_rays;
}

static void widen(span *s, double x)
{
    s->low = s->low > 0.0 && s->low < x ? s->low : x;
    s->high = s->high > x ? s->high : x;
}

/* Keep the ratio. Returns the true error, 0 where there is none to speak of. */
static double judge(const char *name, const char *how, const fl_progress *progress,
                    const pictures *p, span *out_ratios)
{
    double square = true_square(p), truth = square > 0.0 ? sqrt(square) : 0.0;
    if (truth < 1e-6 || !progress->error.is_known || ratio_count == RATIOS_MAX)
        return 0.0;
    double ratio = progress->error.rmse / truth;
    bool is_inside = progress->error.low <= truth && truth <= progress->error.high;
    if (has_details)
        printf("%-22s %-8s %7.1f  rmse %.6f  predicted %.6f  ratio %.3f  in interval %s\n", name,
               how, progress->mean_samples, truth, progress->error.rmse, ratio,
               is_inside ? "yes" : "no");
    ratios[ratio_count++] = ratio;
    interval_count += is_inside;
    widen(out_ratios, ratio);
    return truth;
}

/* Uniform from 8 samples on, each power of two; then adaptive likewise. */
static bool measure(const char *name, fl_render *render, const cli_scene *scene, const pictures *p)
{
    fl_progress progress;
    double even[LEVELS_MAX] = {0};
    uint64_t even_rays[LEVELS_MAX] = {0};
    span found[2] = {{0.0, 0.0}, {0.0, 0.0}}, gain = {0.0, 0.0};
    for (int a = 0; a < 2; a++) {
        uint32_t first = a ? 32 : 8, level = a ? 5 : 3;
        if (!render_once(render, scene, SEED_PICTURE, FL_SAMPLER_SOBOL, a != 0, first, p->x,
                         p->floats, &progress))
            return false;
        for (uint32_t n = first; n <= most_samples && level < LEVELS_MAX; n *= 2, level++) {
            if (!go_on(render, n, p->x, p->floats, &progress))
                return false;
            double truth = judge(name, a ? "adaptive" : "uniform", &progress, p, &found[a]);
            if (!a) {
                even[level] = truth;
                even_rays[level] = rays(&progress);
            } else if (truth > 0.0 && even[level] > 0.0 && gain_count < RATIOS_MAX) {
                /* At equal rays: the error falls like n^-0.6. */
                double equal =
                    even[level] * pow((double)even_rays[level] / (double)rays(&progress), 0.6);
                widen(&gain, equal / truth);
                if (n == SHOWN_SAMPLES)
                    gains[gain_count++] = equal / truth;
            }
        }
    }
    bool has_gain = gain.high > 0.0 && most_samples >= SHOWN_SAMPLES;
    printf("| %.*s | %.2g | %.2f to %.2f | %.2f to %.2f | %.2f | %.2f |\n", (int)strcspn(name, "."),
           name, even[SHOWN_LEVEL], found[0].low, found[0].high, found[1].low, found[1].high,
           has_gain ? gains[gain_count - 1] : 0.0, gain.low);
    fflush(stdout);
    return true;
}

static bool run_scene(const char *path, fl_diags *diags)
{
    cli_options options = {.given = (uint64_t)1 << CLI_OPT_SIZE, .size = {side, side}};
    cli_scene scene = {.diags = diags};
    fl_render_options render_options = {0};
    fl_render *render = NULL;
    pictures p = {.floats = (size_t)3 * side * side};
    p.r1 = malloc(p.floats * sizeof *p.r1);
    p.r2 = malloc(p.floats * sizeof *p.r2);
    p.x = malloc(p.floats * sizeof *p.x);
    const char *slash = strrchr(path, '/');
    fl_progress progress;
    bool ok = p.r1 && p.r2 && p.x && cli_scene_open(&options, path, &scene) &&
              (render = fl_render_create(&render_options, diags)) &&
              render_once(render, &scene, SEED_R1, FL_SAMPLER_SOBOL, false, reference_samples, p.r1,
                          p.floats, &progress) &&
              render_once(render, &scene, SEED_R2, FL_SAMPLER_PADDED, false, reference_samples,
                          p.r2, p.floats, &progress) &&
              measure(slash ? slash + 1 : path, render, &scene, &p);
    fl_render_destroy(render);
    cli_scene_close(&scene);
    free(p.r1);
    free(p.r2);
    free(p.x);
    return ok;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double geometric_mean(const double *values, uint32_t count)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++)
        sum += log(values[i]);
    return count ? exp(sum / count) : 0.0;
}

static int summarise(void)
{
    uint32_t inside = 0;
    for (uint32_t i = 0; i < ratio_count; i++)
        inside += ratios[i] >= 0.75 && ratios[i] <= 1.4;
    qsort(ratios, ratio_count, sizeof *ratios, by_size);
    qsort(gains, gain_count, sizeof *gains, by_size);
    double median = ratio_count ? ratios[ratio_count / 2] : 0.0;
    printf("predicted / true: %u of %u within [0.75, 1.4], median %.3f, from %.3f to %.3f; "
           "interval holds the truth in %u\n",
           inside, ratio_count, median, ratio_count ? ratios[0] : 0.0,
           ratio_count ? ratios[ratio_count - 1] : 0.0, interval_count);
    if (gain_count)
        printf("adaptive at 64 samples: geometric mean gain %.2f, median %.2f, from %.2f to %.2f\n",
               geometric_mean(gains, gain_count), gains[gain_count / 2], gains[0],
               gains[gain_count - 1]);
    return ratio_count > 0 && inside >= 0.95 * ratio_count && median >= 0.9 && median <= 1.15 ? 0
                                                                                              : 1;
}

int main(int argc, char **argv)
{
    fl_diags diags = {0};
    bool ok = true;
    printf(
        "| scene | RMSE at 64 | predicted / true, uniform | adaptive | gain at 64 | least gain |\n"
        "|---|---|---|---|---|---|\n");
    for (int i = 1; i < argc && ok; i++) {
        uint32_t *number = !strcmp(argv[i], "--side")        ? &side
                           : !strcmp(argv[i], "--reference") ? &reference_samples
                           : !strcmp(argv[i], "--most")      ? &most_samples
                                                             : NULL;
        if (number && i + 1 < argc)
            *number = (uint32_t)strtoul(argv[++i], NULL, 10);
        else if (!strcmp(argv[i], "--details"))
            has_details = true;
        else
            ok = run_scene(argv[i], &diags);
    }
    cli_print_diags(&diags);
    fl_diags_deinit(&diags);
    return ok ? summarise() : 3;
}
