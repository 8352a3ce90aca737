/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/bench_run.h"

/* A loop that touches registers only, on every thread: what this machine's threads could add at
 * best right now. */
static void spin(void *context, uint32_t begin, uint32_t end, uint32_t thread)
{
    (void)thread;
    for (uint32_t k = begin; k < end; k++) {
        double x = 1.0 + k;
        for (int i = 0; i < 4000000; i++)
            x = x * 0.999999 + 1e-6;
        ((double *)context)[8 * k] = x;
    }
}

enum { SPIN_PIECES = 16 };

/* Wall seconds of the register loop by `thread_count` threads; infinite if they could not be
 * started. */
static double spin_seconds(uint32_t thread_count, fl_diags *diags)
{
    double sink[8 * SPIN_PIECES];
    fl_pool *pool = fl_pool_create(thread_count, diags);
    if (!pool)
        return HUGE_VAL;
    double begin = bench_wall_seconds();
    fl_parallel_for(pool, SPIN_PIECES, 1, spin, sink);
    double seconds = bench_wall_seconds() - begin;
    fl_pool_destroy(pool);
    return seconds;
}

/* One render to 16 samples. */
static bool render_once(const cli_scene *scene, uint32_t thread_count, fl_progress *out,
                        fl_diags *diags)
{
    const fl_render_options options = {.thread_count = thread_count};
    const fl_render_limits limits = {.samples = 16};
    fl_render *render = fl_render_create(&options, diags);
    if (!render)
        return false;
    fl_render_set_limits(render, &limits);
    bool ok = fl_render_restart(render, scene->compiled, &scene->params, diags);
    ok = ok && fl_render_wait(render, -1.0);
    fl_render_progress(render, out);
    fl_render_destroy(render);
    return ok;
}

typedef struct times {
    double first_picture[BENCH_ROUNDS_MAX], first_sample[BENCH_ROUNDS_MAX], all[BENCH_ROUNDS_MAX],
        cpu[BENCH_ROUNDS_MAX];
    fl_progress last;
} times;

static bool render_round(const cli_scene *scene, uint32_t thread_count, uint32_t round, times *t,
                         fl_diags *diags)
{
    fl_progress *p = &t->last;
    if (!render_once(scene, thread_count, p, diags))
        return false;
    t->first_picture[round] = p->first_picture_seconds;
    t->first_sample[round] = p->first_sample_seconds;
    t->all[round] = p->seconds;
    t->cpu[round] = p->cpu_seconds;
    return true;
}

static void report(const bench_setup *setup, const cli_scene *scene, const char *kind, times *t,
                   double speedup, double possible)
{
    uint32_t n = setup->rounds;
    const fl_counts *c = &t->last.counts;
    double rays = (double)(c->camera_rays + c->shadow_rays + c->reflect_rays + c->refract_rays);
    bench_figure picture = bench_figure_of(t->first_picture, n),
                 sample = bench_figure_of(t->first_sample, n), all = bench_figure_of(t->all, n),
                 cpu = bench_figure_of(t->cpu, n);
    if (!setup->rows) {
        printf("%-22s %-9s first picture %7.2f ms, first sample %8.2f ms, 16 samples %8.1f ms "
               "(%.1f to %.1f), "
               "%6.1f ns/ray of CPU",
               scene->path, kind, picture.median * 1e3, sample.median * 1e3, all.median * 1e3,
               all.min * 1e3, all.max * 1e3, cpu.median / rays * 1e9);
        if (possible > 0.0)
            printf(", threads give %.2f of %.2f that a register loop gets", speedup, possible);
        putchar('\n');
        fflush(stdout);
        return;
    }
    json_t *line =
        json_pack("{s:s, s:s, s:f, s:f, s:f, s:f, s:f, s:I, s:f}", "scene", scene->path, "kind",
                  kind, "first_picture_ms", picture.median * 1e3, "first_sample_ms",
                  sample.median * 1e3, "samples16_ms", all.median * 1e3, "cpu_ms", cpu.median * 1e3,
                  "mrays", rays / cpu.median * 1e-6, "rays", (json_int_t)rays, "node_visits",
                  (double)c->isect.node_visits / rays);
    if (possible > 0.0) {
        json_object_set_new(line, "speedup", json_real(speedup));
        json_object_set_new(line, "speedup_possible", json_real(possible));
    }
    json_array_append_new(setup->rows, line);
}

bool bench_scene_run(const bench_setup *setup, const cli_scene *scene, uint32_t thread_count)
{
    times one, many;
    double speedup[BENCH_ROUNDS_MAX], possible[BENCH_ROUNDS_MAX];
    uint32_t threads = fl_thread_count(thread_count);
    for (uint32_t r = 0; r < setup->rounds; r++) {
        if (!render_round(scene, 1, r, &one, setup->diags) ||
            !render_round(scene, threads, r, &many, setup->diags))
            return false;
        speedup[r] = one.all[r] / many.all[r];
        possible[r] = spin_seconds(1, setup->diags) / spin_seconds(threads, setup->diags);
    }
    char kind[32];
    snprintf(kind, sizeof kind, "%u threads", threads);
    report(setup, scene, "1 thread", &one, 0.0, 0.0);
    report(setup, scene, kind, &many, bench_figure_of(speedup, setup->rounds).median,
           bench_figure_of(possible, setup->rounds).median);
    return true;
}
