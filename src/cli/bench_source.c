/* SPDX-License-Identifier: MIT
 *
 * The comparison that the source project closes with: the same picture by an octree and by brute
 * force. Brute force there meets every triangle with every ray; ours looks at the mesh's box first,
 * so both are measured, the first by making that box endless.
 */
#include <math.h>
#include <stdio.h>

#include "cli/bench_run.h"
#include "cli/json_text.h"

enum { WAY_EVERY, WAY_SCALAR, WAY_WIDE, WAY_COUNT = 7, BASELINES = 3 };

static const struct way {
    const char *name;
    fl_accel accel;
    bool is_scalar, is_boxless;
} ways[WAY_COUNT] = {
    {"brute force, scalar, no box", FL_ACCEL_NONE, true, true},
    {"brute force, scalar", FL_ACCEL_NONE, true, false},
    {"brute force", FL_ACCEL_NONE, false, false},
    {"octree, scalar", FL_ACCEL_OCTREE, true, false},
    {"octree", FL_ACCEL_OCTREE, false, false},
    {"bvh, scalar", FL_ACCEL_BVH, true, false},
    {"bvh", FL_ACCEL_BVH, false, false},
};

/* CPU seconds a round: of the whole job, of its two stages that trace, of primary rays alone. */
typedef struct record {
    double job[BENCH_ROUNDS_MAX], tracing[BENCH_ROUNDS_MAX], primary[BENCH_ROUNDS_MAX];
    double rays, primary_rays;
} record;

static fl_compile_options options_of(const bench_setup *setup, const struct way *way)
{
    fl_compile_options options = setup->compile;
    options.accel = way->accel;
    if (way->is_scalar) {
        options.has_isa = true;
        options.isa = FL_ISA_SCALAR;
    }
    return options;
}

static void remove_boxes(fl_compiled *compiled)
{
    for (uint32_t k = 0; k < compiled->geometry.instance_count; k++)
        for (int a = 0; a < 3; a++) {
            compiled->geometry.instances[k].box.lo[a] = -1e30f;
            compiled->geometry.instances[k].box.hi[a] = 1e30f;
        }
}

/* The whole job: structure and picture. */
static bool run_job(const bench_setup *setup, const cli_scene *scene, const struct way *way,
                    uint32_t round, record *out)
{
    fl_compile_options options = options_of(setup, way);
    fl_params params = scene->params;
    fl_progress progress;
    params.width = params.height = setup->side;
    double begin = bench_thread_seconds();
    fl_compiled *compiled = fl_compile(scene->scene, &options, NULL, setup->diags);
    double built = bench_thread_seconds() - begin;
    if (!compiled)
        return false;
    if (way->is_boxless)
        remove_boxes(compiled);
    bool ok = bench_render(compiled, &params, 1, &progress, setup->diags);
    fl_compiled_release(compiled);
    const fl_counts *c = &progress.counts;
    out->rays = (double)(c->camera_rays + c->shadow_rays + c->reflect_rays + c->refract_rays);
    out->job[round] = built + progress.cpu_seconds;
    out->tracing[round] =
        progress.cost_seconds[FL_COST_NEAREST] + progress.cost_seconds[FL_COST_OCCLUDE];
    return ok;
}

static bool run_primary(const bench_setup *setup, const bench_mesh *mesh, const struct way *way,
                        uint32_t round, record *out)
{
    fl_compile_options options = options_of(setup, way);
    fl_compiled *compiled = bench_mesh_compile(mesh, &options, NULL, setup->diags);
    bench_rays rays = {0};
    bool ok =
        compiled && (bench_rays_create(mesh, compiled, BENCH_PRIMARY, setup->side, NULL, &rays) ||
                     fl_out_of_memory(setup->diags, "rays to measure with"));
    if (ok) {
        if (way->is_boxless)
            remove_boxes(compiled);
        double begin = bench_thread_seconds();
        bench_rays_trace(compiled, &rays, NULL);
        out->primary[round] = bench_thread_seconds() - begin;
        out->primary_rays = rays.rays.count;
    }
    bench_rays_deinit(&rays);
    fl_compiled_release(compiled);
    return ok;
}

static double median_ratio(const double *slow, const double *fast, uint32_t count)
{
    double ratio[BENCH_ROUNDS_MAX];
    for (uint32_t r = 0; r < count; r++)
        ratio[r] = slow[r] / fast[r];
    return bench_figure_of(ratio, count).median;
}

typedef struct ratios {
    double job[BASELINES], tracing[BASELINES], primary[BASELINES];
} ratios;

static void report(const bench_setup *setup, const cli_scene *scene, const struct way *way,
                   const ratios *x, record *t)
{
    bench_figure job = bench_figure_of(t->job, setup->rounds),
                 tracing = bench_figure_of(t->tracing, setup->rounds),
                 primary = bench_figure_of(t->primary, setup->rounds);
    double job_ns = job.median / t->rays * 1e9, primary_ns = primary.median / t->primary_rays * 1e9;
    if (!setup->rows) {
        printf("%-28s job %8.1f ms %7.1f ns/ray x%.1f x%.1f x%.1f   tracing %8.1f ms x%.1f x%.1f "
               "x%.1f   primary %7.1f ns x%.1f x%.1f x%.1f\n",
               way->name, job.median * 1e3, job_ns, x->job[0], x->job[1], x->job[2],
               tracing.median * 1e3, x->tracing[0], x->tracing[1], x->tracing[2], primary_ns,
               x->primary[0], x->primary[1], x->primary[2]);
        return;
    }
    json_array_append_new(
        setup->rows,
        json_pack("{s:o, s:s, s:s, s:I, s:f, s:f, s:f, s:f, s:[f,f,f], s:[f,f,f], s:[f,f,f]}",
                  "scene", cli_json_text(scene->path), "kind", "source-comparison", "way",
                  way->name, "rays", (json_int_t)t->rays, "job_ms", job.median * 1e3,
                  "job_ns_per_ray", job_ns, "tracing_ms", tracing.median * 1e3,
                  "primary_ns_per_ray", primary_ns, "job_ratios", x->job[0], x->job[1], x->job[2],
                  "tracing_ratios", x->tracing[0], x->tracing[1], x->tracing[2], "primary_ratios",
                  x->primary[0], x->primary[1], x->primary[2]));
}

bool bench_source_run(const bench_setup *setup, const cli_scene *scene, const bench_mesh *mesh)
{
    record t[WAY_COUNT];
    ratios x[WAY_COUNT];
    uint32_t steps = setup->rounds * WAY_COUNT;
    double begin = cli_wall_seconds();
    for (uint32_t r = 0; r < setup->rounds; r++)
        for (uint32_t k = 0; k < WAY_COUNT; k++) {
            if (cli_was_interrupted())
                return true;
            bench_show_progress(r * WAY_COUNT + k, steps, begin);
            if (!run_job(setup, scene, &ways[k], r, &t[k]) ||
                !run_primary(setup, mesh, &ways[k], r, &t[k]))
                return false;
        }
    bench_show_progress(steps, steps, begin);
    for (uint32_t k = 0; k < WAY_COUNT; k++)
        for (uint32_t b = 0; b < BASELINES; b++) {
            x[k].job[b] = median_ratio(t[b].job, t[k].job, setup->rounds);
            x[k].tracing[b] = median_ratio(t[b].tracing, t[k].tracing, setup->rounds);
            x[k].primary[b] = median_ratio(t[b].primary, t[k].primary, setup->rounds);
        }
    if (!setup->rows)
        printf("%s at %ux%u, %d samples, %.0f rays; %s alone; ratios to the first three\n",
               scene->path, setup->side, setup->side, BENCH_SAMPLES, t[0].rays, mesh->name);
    for (uint32_t k = 0; k < WAY_COUNT; k++)
        report(setup, scene, &ways[k], &x[k], &t[k]);
    return true;
}
