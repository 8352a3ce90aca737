/* SPDX-License-Identifier: MIT */
#include "cli/bench_run.h"
#include "cli/json_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

double bench_thread_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bench_figure bench_figure_of(double *values, uint32_t count)
{
    qsort(values, count, sizeof *values, ascending);
    double middle = 0.5 * (values[(count - 1) / 2] + values[count / 2]);
    return (bench_figure){middle, values[0], values[count - 1]};
}

void bench_show_progress(uint32_t done, uint32_t all, double begin)
{
    if (!isatty(STDERR_FILENO))
        return;
    double spent = cli_wall_seconds() - begin;
    if (done == all)
        fprintf(stderr, "\r\033[K");
    else if (done == 0)
        fprintf(stderr, "\r\033[K0 of %u", all);
    else
        fprintf(stderr, "\r\033[K%u of %u, %.0f s left", done, all, spent / done * (all - done));
    fflush(stderr);
}

/* --- Rows ------------------------------------------------------------------------------------ */

typedef struct row {
    const bench_mesh *mesh;
    const char *kind;
    double mrays, ns, node_visits, primitive_tests; /* The last two a ray. */
    const char *peer, *peer_mode;                   /* peer NULL: nobody. */
    double peer_mrays;
    bench_figure ratio;
    uint32_t mismatches;
} row;

static void add_row(const bench_setup *setup, const row *r)
{
    if (!setup->rows) {
        printf("%-12s %8u  %-12s %8.2f M/s %7.2f nodes %7.2f tests", r->mesh->name,
               r->mesh->face_count, r->kind, r->mrays, r->node_visits, r->primitive_tests);
        if (r->peer)
            printf("  %s %-22s %8.2f M/s  ratio %.2f (%.2f to %.2f), %u differ", r->peer,
                   r->peer_mode, r->peer_mrays, r->ratio.median, r->ratio.min, r->ratio.max,
                   r->mismatches);
        putchar('\n');
        fflush(stdout);
        return;
    }
    json_t *line =
        json_pack("{s:o, s:I, s:s, s:f, s:f, s:f}", "mesh", cli_json_text(r->mesh->name),
                  "triangles", (json_int_t)r->mesh->face_count, "kind", r->kind, "mrays", r->mrays,
                  "node_visits", r->node_visits, "primitive_tests", r->primitive_tests);
    json_t *peer = r->peer
                       ? json_pack("{s:s, s:s, s:f, s:f, s:f, s:f, s:I}", "peer", r->peer,
                                   "peer_mode", r->peer_mode, "peer_mrays", r->peer_mrays, "ratio",
                                   r->ratio.median, "ratio_min", r->ratio.min, "ratio_max",
                                   r->ratio.max, "mismatches", (json_int_t)r->mismatches)
                       : json_pack("{s:n}", "peer");
    json_object_update(line, peer);
    json_decref(peer);
    json_array_append_new(setup->rows, line);
}

/* --- One kind of ray ------------------------------------------------------------------------- */

/* The other tracer with a scene for each of its two ways to build. */
typedef struct opponent {
    const bench_peer *peer;
    void *scene[2]; /* As fast as it goes; robust. */
} opponent;

/* One way of the opponent to trace the rays at hand. */
typedef struct contender {
    void *scene, *set;
    uint32_t mode;
    bool is_robust;
    double seconds[BENCH_ROUNDS_MAX];
} contender;

static double time_peer(const bench_peer *peer, const contender *c)
{
    peer->reset(c->set);
    double begin = bench_thread_seconds();
    peer->trace(c->scene, c->set);
    return bench_thread_seconds() - begin;
}

static double time_ours(const fl_compiled *scene, bench_rays *rays)
{
    double begin = bench_thread_seconds();
    bench_rays_trace(scene, rays, NULL);
    return bench_thread_seconds() - begin;
}

/* The mode with the best of three runs, loaded. False: out of memory. */
static bool choose_mode(const opponent *o, bool is_robust, const bench_rays *rays, contender *out)
{
    double best = HUGE_VAL;
    *out = (contender){.scene = o->scene[is_robust], .is_robust = is_robust};
    for (uint32_t mode = 0; mode < o->peer->mode_count; mode++) {
        contender c = {.scene = out->scene, .mode = mode, .is_robust = is_robust};
        c.set = o->peer->load(&rays->rays, mode, rays->kind == BENCH_SHADOW);
        if (!c.set)
            return false;
        double seconds = HUGE_VAL;
        for (int k = 0; k < 3; k++)
            seconds = fmin(seconds, time_peer(o->peer, &c));
        if (seconds < best) {
            best = seconds;
            o->peer->unload(out->set);
            *out = c;
        } else {
            o->peer->unload(c.set);
        }
    }
    return true;
}

/* Rays whose answers differ: one hits and the other does not, or the distances do. Another face at
 * the same distance is a common edge. */
static uint32_t count_mismatches(const bench_peer *peer, const contender *c, const bench_rays *rays)
{
    uint32_t count = 0, face;
    for (uint32_t i = 0; i < rays->rays.count; i++) {
        float theirs = peer->result(c->set, i, &face);
        if (rays->kind == BENCH_SHADOW) {
            count += (theirs == 0.0f) != (rays->blocked[i] != 0);
            continue;
        }
        float ours = rays->hits.t[i];
        count += isinf(ours) != isinf(theirs) ||
                 (!isinf(ours) && fabsf(ours - theirs) > 1e-3f * (1.0f + fabsf(ours)));
    }
    return count;
}

static bool run_kind(const bench_setup *setup, const bench_mesh *mesh, const fl_compiled *scene,
                     const opponent *o, bench_rays *rays)
{
    contender other[2];
    uint32_t others = o->peer ? 2 : 0, rounds = setup->rounds;
    for (uint32_t k = 0; k < others; k++)
        if (!choose_mode(o, k == 1, rays, &other[k]))
            return fl_out_of_memory(setup->diags, "rays to compare with");
    double ours[BENCH_ROUNDS_MAX], sorted[BENCH_ROUNDS_MAX];
    fl_isect_counts counts = {0};
    bench_rays_trace(scene, rays, &counts);
    for (uint32_t r = 0; r < rounds; r++) {
        ours[r] = time_ours(scene, rays);
        for (uint32_t k = 0; k < others; k++)
            other[k].seconds[r] = time_peer(o->peer, &other[k]);
    }
    memcpy(sorted, ours, sizeof sorted);
    double n = rays->rays.count, mine = bench_figure_of(sorted, rounds).median;
    row line = {.mesh = mesh,
                .kind = bench_kind_names[rays->kind],
                .mrays = n / mine * 1e-6,
                .node_visits = (double)counts.node_visits / n,
                .primitive_tests = (double)counts.primitive_tests / n};
    if (!others)
        add_row(setup, &line);
    for (uint32_t k = 0; k < others; k++) {
        char mode[64];
        double ratio[BENCH_ROUNDS_MAX];
        for (uint32_t r = 0; r < rounds; r++)
            ratio[r] = other[k].seconds[r] / ours[r];
        snprintf(mode, sizeof mode, "%s%s", o->peer->modes[other[k].mode], k ? " robust" : "");
        line.peer = o->peer->name;
        line.peer_mode = mode;
        line.ratio = bench_figure_of(ratio, rounds);
        line.mismatches = count_mismatches(o->peer, &other[k], rays);
        line.peer_mrays = n / bench_figure_of(other[k].seconds, rounds).median * 1e-6;
        add_row(setup, &line);
        o->peer->unload(other[k].set);
    }
    return true;
}

static bool run_kinds(const bench_setup *setup, const bench_mesh *mesh, const fl_compiled *scene,
                      const opponent *o)
{
    bench_rays primary = {0}, rays = {0};
    bool ok = true;
    for (int kind = 0; ok && kind < BENCH_KIND_COUNT; kind++) {
        bench_rays *now = kind == BENCH_PRIMARY ? &primary : &rays;
        ok = bench_rays_create(mesh, scene, (bench_kind)kind, setup->side, &primary, now) ||
             fl_out_of_memory(setup->diags, "rays to measure with");
        ok = ok && run_kind(setup, mesh, scene, o, now);
        if (kind != BENCH_PRIMARY)
            bench_rays_deinit(&rays);
    }
    bench_rays_deinit(&primary);
    return ok;
}

/* --- Building -------------------------------------------------------------------------------- */

/* Builds of one and of all threads, in turn: ours, theirs. */
enum { BUILD_WAYS = 4, ONE = 0, ALL = 1, THEIR_ONE = 2, THEIR_ALL = 3 };

typedef struct builds {
    fl_mesh *copy;
    fl_pool *pool;
    uint32_t threads, rounds;
    double seconds[BUILD_WAYS][BENCH_ROUNDS_MAX]; /* CPU time by one thread, wall time by all. */
    double wall[BENCH_ROUNDS_MAX];                /* Of ours by one thread. */
} builds;

/* Ours in round r; the scene stays in *out_scene. */
static bool build_ours(const bench_setup *setup, const bench_mesh *mesh, builds *b, uint32_t r,
                       fl_compiled **out_scene)
{
    for (int way = ALL; way >= ONE; way--) {
        fl_compiled_release(*out_scene);
        double begin = bench_thread_seconds();
        *out_scene = bench_mesh_compile_copy(b->copy, mesh->name, &setup->compile,
                                             way == ALL ? b->pool : NULL, setup->diags);
        if (!*out_scene)
            return false;
        b->seconds[way][r] =
            way == ALL ? (*out_scene)->build_seconds : bench_thread_seconds() - begin;
        b->wall[r] = (*out_scene)->build_seconds;
    }
    return true;
}

static bool build_theirs(const bench_setup *setup, const bench_mesh *mesh, builds *b, uint32_t r,
                         opponent *o)
{
    for (int way = THEIR_ALL; way >= THEIR_ONE; way--) {
        o->peer->destroy(o->scene[0]);
        o->scene[0] = o->peer->build(mesh->position, mesh->position_count, mesh->index,
                                     mesh->face_count, false, way == THEIR_ALL ? b->threads : 1,
                                     setup->peer_config, &b->seconds[way][r]);
        if (!o->scene[0])
            return fl_environment_error(setup->diags, "%s could not build", o->peer->name);
    }
    return true;
}

/* Sorts neither. */
static bench_figure ratio_of(const double *theirs, const double *ours, uint32_t rounds)
{
    double ratio[BENCH_ROUNDS_MAX];
    for (uint32_t r = 0; r < rounds; r++)
        ratio[r] = theirs[r] / ours[r];
    return bench_figure_of(ratio, rounds);
}

static void report_all_threads(const bench_setup *setup, const bench_mesh *mesh, builds *b,
                               const opponent *o)
{
    bench_figure times = ratio_of(b->wall, b->seconds[ALL], b->rounds), ratio = {0};
    double theirs = 0.0;
    if (o->peer) {
        ratio = ratio_of(b->seconds[THEIR_ALL], b->seconds[ALL], b->rounds);
        theirs = bench_figure_of(b->seconds[THEIR_ALL], b->rounds).median;
    }
    double one = bench_figure_of(b->wall, b->rounds).median,
           all = bench_figure_of(b->seconds[ALL], b->rounds).median;
    if (setup->rows) {
        json_t *line = json_pack(
            "{s:o, s:I, s:s, s:I, s:f, s:f, s:f, s:f, s:f}", "mesh", cli_json_text(mesh->name),
            "triangles", (json_int_t)mesh->face_count, "kind", "build-wall", "threads",
            (json_int_t)b->threads, "ms_1_thread", one * 1e3, "ms", all * 1e3, "speedup",
            times.median, "speedup_min", times.min, "speedup_max", times.max);
        if (o->peer)
            json_object_update_new(line,
                                   json_pack("{s:s, s:f, s:f, s:f, s:f}", "peer", o->peer->name,
                                             "peer_ms", theirs * 1e3, "ratio", ratio.median,
                                             "ratio_min", ratio.min, "ratio_max", ratio.max));
        json_array_append_new(setup->rows, line);
        return;
    }
    printf("%-12s %8u  %-12s %8.2f ms by 1 thread, %8.2f ms by %u: %.2f (%.2f to %.2f)", mesh->name,
           mesh->face_count, "build-wall", one * 1e3, all * 1e3, b->threads, times.median,
           times.min, times.max);
    if (o->peer)
        printf("  %s by %u %8.2f ms  ratio %.2f (%.2f to %.2f)", o->peer->name, b->threads,
               theirs * 1e3, ratio.median, ratio.min, ratio.max);
    putchar('\n');
    fflush(stdout);
}

static void report_one_thread(const bench_setup *setup, const bench_mesh *mesh, builds *b,
                              const opponent *o)
{
    double n = mesh->face_count;
    row line = {.mesh = mesh, .kind = "build"};
    if (o->peer) {
        line.peer = o->peer->name;
        line.peer_mode = "medium";
        line.ratio = ratio_of(b->seconds[THEIR_ONE], b->seconds[ONE], b->rounds);
        line.peer_mrays = n / bench_figure_of(b->seconds[THEIR_ONE], b->rounds).median * 1e-6;
    }
    line.mrays = n / bench_figure_of(b->seconds[ONE], b->rounds).median * 1e-6;
    add_row(setup, &line);
}

/* The last scene of each by one thread stays, theirs built in both of its ways. */
static bool run_build(const bench_setup *setup, const bench_mesh *mesh, builds *b,
                      fl_compiled **out_scene, opponent *o)
{
    double seconds;
    for (uint32_t r = 0; r < b->rounds; r++)
        if (!build_ours(setup, mesh, b, r, out_scene) ||
            (o->peer && !build_theirs(setup, mesh, b, r, o)))
            return false;
    if (o->peer)
        o->scene[1] = o->peer->build(mesh->position, mesh->position_count, mesh->index,
                                     mesh->face_count, true, 1, setup->peer_config, &seconds);
    if (o->peer && !o->scene[1])
        return fl_environment_error(setup->diags, "%s could not build", o->peer->name);
    report_all_threads(setup, mesh, b, o); /* Before the other, which sorts. */
    report_one_thread(setup, mesh, b, o);
    return true;
}

bool bench_mesh_run(const bench_setup *setup, const bench_mesh *mesh)
{
    opponent o = {.peer = setup->peer};
    fl_compiled *scene = NULL;
    builds *b = calloc(1, sizeof *b);
    if (!b)
        return fl_out_of_memory(setup->diags, "times");
    b->copy = bench_mesh_create(mesh, setup->diags);
    b->pool = b->copy ? fl_pool_create(setup->thread_count, setup->diags) : NULL;
    b->threads = fl_thread_count(setup->thread_count);
    b->rounds = mesh->face_count > 2000000 ? 1 : setup->rounds;
    bool ok = b->pool && run_build(setup, mesh, b, &scene, &o);
    fl_pool_destroy(b->pool);
    fl_mesh_release(b->copy);
    free(b);
    ok = ok && run_kinds(setup, mesh, scene, &o);
    for (int k = 0; o.peer && k < 2; k++)
        o.peer->destroy(o.scene[k]);
    fl_compiled_release(scene);
    return ok;
}
