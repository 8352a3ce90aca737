/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/bench_run.h"
#include "cli/json_text.h"

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
    double begin = cli_wall_seconds();
    fl_parallel_for(pool, SPIN_PIECES, 1, spin, sink);
    double seconds = cli_wall_seconds() - begin;
    fl_pool_destroy(pool);
    return seconds;
}

bool bench_render(fl_compiled *compiled, const fl_params *params, uint32_t thread_count,
                  fl_progress *out, fl_diags *diags)
{
    const fl_render_options options = {.thread_count = thread_count};
    const fl_render_limits limits = {.samples = BENCH_SAMPLES};
    fl_render *render = fl_render_create(&options, diags);
    if (!render)
        return false;
    fl_render_set_limits(render, &limits);
    bool ok = fl_render_restart(render, compiled, params, diags);
    ok = ok && fl_render_wait(render, -1.0);
    fl_render_progress(render, out);
    fl_render_destroy(render);
    return ok;
}

/* What all rounds of one way to render took. */
typedef struct times {
    double first_picture[BENCH_ROUNDS_MAX], first_sample[BENCH_ROUNDS_MAX], all[BENCH_ROUNDS_MAX],
        cpu[BENCH_ROUNDS_MAX], cost[FL_COST_COUNT][BENCH_ROUNDS_MAX];
    fl_progress last;
} times;

static bool render_round(fl_compiled *compiled, const cli_scene *scene, uint32_t thread_count,
                         uint32_t round, times *t, fl_diags *diags)
{
    fl_progress *p = &t->last;
    if (!bench_render(compiled, &scene->params, thread_count, p, diags))
        return false;
    t->first_picture[round] = p->first_picture_seconds;
    t->first_sample[round] = p->first_sample_seconds;
    t->all[round] = p->seconds;
    t->cpu[round] = p->cpu_seconds;
    for (int k = 0; k < FL_COST_COUNT; k++)
        t->cost[k][round] = p->cost_seconds[k];
    return true;
}

static double ray_count(const fl_counts *c)
{
    return (double)(c->camera_rays + c->shadow_rays + c->reflect_rays + c->refract_rays);
}

/* What a second thread and more bring, and of what a register loop gets in the same minute. */
typedef struct scaling {
    double speedup, possible, share;
} scaling;

static void report(const bench_setup *setup, const cli_scene *scene, const char *kind, times *t,
                   const scaling *gain)
{
    uint32_t n = setup->rounds;
    double rays = ray_count(&t->last.counts);
    bench_figure picture = bench_figure_of(t->first_picture, n),
                 sample = bench_figure_of(t->first_sample, n), all = bench_figure_of(t->all, n),
                 cpu = bench_figure_of(t->cpu, n);
    if (!setup->rows) {
        printf("%-22s %-9s first picture %7.2f ms, first sample %8.2f ms, 16 samples %8.1f ms "
               "(%.1f to %.1f), "
               "%6.1f ns/ray of CPU",
               scene->path, kind, picture.median * 1e3, sample.median * 1e3, all.median * 1e3,
               all.min * 1e3, all.max * 1e3, cpu.median / rays * 1e9);
        if (gain)
            printf(", threads give %.2f; a register loop gets %.2f: a share of %.2f", gain->speedup,
                   gain->possible, gain->share);
        putchar('\n');
        fflush(stdout);
        return;
    }
    json_t *line = json_pack("{s:o, s:s, s:f, s:f, s:f, s:f, s:f, s:I, s:f}", "scene",
                             cli_json_text(scene->path), "kind", kind, "first_picture_ms",
                             picture.median * 1e3, "first_sample_ms", sample.median * 1e3,
                             "samples16_ms", all.median * 1e3, "cpu_ms", cpu.median * 1e3, "mrays",
                             rays / cpu.median * 1e-6, "rays", (json_int_t)rays, "node_visits",
                             (double)t->last.counts.isect.node_visits / rays);
    if (gain) {
        json_object_set_new(line, "speedup", json_real(gain->speedup));
        json_object_set_new(line, "speedup_possible", json_real(gain->possible));
        json_object_set_new(line, "speedup_share", json_real(gain->share));
    }
    json_array_append_new(setup->rows, line);
}

/* --- Stages ---------------------------------------------------------------------------------- */

/* What went through a stage, and the work it took; 0 where that says nothing. */
typedef struct stage_work {
    double rays, node_visits, primitive_tests;
} stage_work;

static stage_work work_of(const fl_counts *c, fl_cost stage)
{
    double shadow = (double)c->shadow_rays, others = ray_count(c) - shadow;
    if (stage == FL_COST_OCCLUDE)
        return (stage_work){shadow, (double)c->occlude.node_visits,
                            (double)c->occlude.primitive_tests};
    if (stage == FL_COST_NEAREST)
        return (stage_work){others, (double)(c->isect.node_visits - c->occlude.node_visits),
                            (double)(c->isect.primitive_tests - c->occlude.primitive_tests)};
    if (stage == FL_COST_LIGHT)
        return (stage_work){shadow, 0, 0};
    if (stage == FL_COST_SPAWN)
        return (stage_work){(double)(c->reflect_rays + c->refract_rays), 0, 0};
    if (stage == FL_COST_GENERATE || stage == FL_COST_ACCUMULATE || stage == FL_COST_FILM)
        return (stage_work){(double)c->camera_rays, 0, 0};
    return (stage_work){others, 0, 0};
}

static void report_stages(const bench_setup *setup, const cli_scene *scene, times *t)
{
    double seconds[FL_COST_COUNT], sum = 0.0;
    for (int k = 0; k < FL_COST_COUNT; k++) {
        seconds[k] = bench_figure_of(t->cost[k], setup->rounds).median;
        sum += seconds[k];
    }
    for (int k = 0; k < FL_COST_COUNT; k++) {
        stage_work w = work_of(&t->last.counts, (fl_cost)k);
        double rays = fl_max(w.rays, 1.0), share = seconds[k] / sum;
        if (setup->rows)
            json_array_append_new(setup->rows,
                                  json_pack("{s:o, s:s, s:s, s:f, s:f, s:I, s:f, s:f}", "scene",
                                            cli_json_text(scene->path), "kind", "stage", "stage",
                                            fl_cost_names[k], "share", share, "ns_per_ray",
                                            seconds[k] / rays * 1e9, "rays", (json_int_t)w.rays,
                                            "node_visits", w.node_visits / rays, "primitive_tests",
                                            w.primitive_tests / rays));
        else
            printf("%-22s %-10s %5.1f %%  %9.0f rays %7.1f ns %7.2f nodes %7.2f tests a ray\n",
                   scene->path, fl_cost_names[k], 100.0 * share, w.rays, seconds[k] / rays * 1e9,
                   w.node_visits / rays, w.primitive_tests / rays);
    }
    fflush(stdout);
}

/* --- Instruction sets ------------------------------------------------------------------------ */

static bool run_isas(const bench_setup *setup, const cli_scene *scene)
{
    times t[FL_ISA_COUNT];
    fl_compiled *compiled[FL_ISA_COUNT] = {NULL};
    bool ok = true;
    for (uint32_t r = 0; ok && r < setup->rounds; r++)
        for (int k = 0; ok && k < FL_ISA_COUNT; k++) {
            fl_compile_options options = setup->compile;
            options.has_isa = true;
            options.isa = (fl_isa)k;
            if (!fl_cpu_has(options.isa))
                continue;
            if (!compiled[k])
                compiled[k] = fl_compile(scene->scene, &options, NULL, setup->diags);
            ok = compiled[k] && render_round(compiled[k], scene, 1, r, &t[k], setup->diags);
        }
    for (int k = 0; k < FL_ISA_COUNT; k++) {
        if (ok && compiled[k])
            report(setup, scene, fl_isa_name((fl_isa)k), &t[k], NULL);
        fl_compiled_release(compiled[k]);
    }
    return ok;
}

bool bench_scene_run(const bench_setup *setup, const cli_scene *scene, uint32_t thread_count)
{
    times one, many;
    double speedup[BENCH_ROUNDS_MAX], possible[BENCH_ROUNDS_MAX], share[BENCH_ROUNDS_MAX];
    uint32_t threads = fl_thread_count(thread_count), n = setup->rounds;
    for (uint32_t r = 0; r < n; r++) {
        if (!render_round(scene->compiled, scene, 1, r, &one, setup->diags) ||
            !render_round(scene->compiled, scene, threads, r, &many, setup->diags))
            return false;
        speedup[r] = one.all[r] / many.all[r];
        possible[r] = spin_seconds(1, setup->diags) / spin_seconds(threads, setup->diags);
        share[r] = speedup[r] / possible[r];
    }
    char kind[32];
    snprintf(kind, sizeof kind, "%u threads", threads);
    scaling gain = {bench_figure_of(speedup, n).median, bench_figure_of(possible, n).median,
                    bench_figure_of(share, n).median};
    report(setup, scene, "1 thread", &one, NULL);
    report(setup, scene, kind, &many, &gain);
    report_stages(setup, scene, &one);
    return setup->compile.has_isa || run_isas(setup, scene);
}
