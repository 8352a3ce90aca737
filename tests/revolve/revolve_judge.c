/* SPDX-License-Identifier: MIT
 *
 * usage: revolve_judge CASES [ANSWERS]
 * Solves every ray of a corpus one by one and in packets of eight and compares with the certified
 * oracle of the shared pages (linked in; ANSWERS are its lines for CASES, without which it is run
 * here). Prints the counts and every miss, and fails on a false hit, on a miss that is not excused
 * or on a residual beyond its bound.
 *
 * For each ray the nearest root is wanted, to |du| |d| cos <= 256 u (S + dist), u = 2^-53, S the
 * size of the profile, dist the length of the ray. Where solver and oracle differ: rounding   the
 * solver's point is on the surface and the ray to 64 u (S + dist) and lies nearer than the root:
 *                touches and the like, where the exact answer is that of another ray within
 * rounding unstable   the oracle's own answer changes for rays moved or turned by 1e-12 S (its flag
 * 4) ruling     the ray lies within 64 u (S + dist) of the surface all the way from the root to the
 * answer, or for 1e-3 S around the root: it runs along a straight line of the surface missed
 * anything else with a farther answer or none false      anything else with an answer; rays of
 * category `again` (revolve_secondary) get no excuse by rounding
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "corpus_read.h"
#include "rev.h"

#define U            0x1p-53
#define HIT_BOUND    256.0 /* of grading, in u (S + dist) */
#define ROUND_BOUND  64.0
#define POINT_BOUND  32.0 /* the promise for returned points */
#define CAMERA_BOUND 8.0

enum { MAX_ROOTS = 512 };

typedef struct tally {
    long rays, wanted, hits, rounding, unstable, ruling, missed, wrong, packet_differs, any_differs,
        near;
    double worst, worst_camera; /* residuals, in u (S + dist) */
} tally;

typedef struct task {
    const corpus *c;
    FILE *answers;
    RevProfile oracle; /* of the profile in work */
    fl_revolve *revolve;
    double size;
    tally sum;
} task;

/* The roots of a ray over the whole line, ascending. */
static int oracle_roots(task *k, const corpus_ray *r, RevHit *out, unsigned *flags)
{
    if (!k->answers)
        return rev_oracle(&k->oracle, r->o, r->d, out, MAX_ROOTS, flags);
    long id;
    int count;
    if (fscanf(k->answers, " A %ld %u %d", &id, flags, &count) != 3 || id != r->id ||
        count > MAX_ROOTS) {
        fprintf(stderr, "answers and cases do not match at ray %ld\n", r->id);
        exit(2);
    }
    for (int i = 0; i < count; i++)
        if (fscanf(k->answers, "%lf %lf %d %d %lf %lf", &out[i].u, &out[i].t, &out[i].seg,
                   &out[i].mult, &out[i].cosi, &out[i].margin) != 6)
            exit(2);
    return count;
}

/* Distance of the ray's point at u from the surface near (seg, t): the least residual around t. */
static double gap(const task *k, const corpus_ray *r, double u, int seg, double t)
{
    double step = 0.25, best = rev_residual(&k->oracle, r->o, r->d, u, seg, t);
    for (int i = 0; i < 200 && step > 1e-17; i++) {
        double a = rev_residual(&k->oracle, r->o, r->d, u, seg, fmax(t - step, 0.0));
        double b = rev_residual(&k->oracle, r->o, r->d, u, seg, fmin(t + step, 1.0));
        if (fmin(a, b) < best) {
            best = fmin(a, b);
            t = a < b ? fmax(t - step, 0.0) : fmin(t + step, 1.0);
        } else {
            step *= 0.5;
        }
    }
    return best;
}

/* Whether the ray stays at the surface from u0 to u1. */
static bool runs_along(const task *k, const corpus_ray *r, int seg, double t, double u0, double u1,
                       double bound)
{
    for (int i = 0; i <= 16; i++)
        if (gap(k, r, u0 + (u1 - u0) * i / 16.0, seg, t) > bound)
            return false;
    return true;
}

static void judge_difference(task *k, const corpus_ray *r, const RevHit *roots, int count,
                             const RevHit *want, const fl_revolve_hit *hit)
{
    double length = sqrt(r->d[0] * r->d[0] + r->d[1] * r->d[1] + r->d[2] * r->d[2]);
    const char *family = k->c->families[r->profile];
    if (hit && (!want || hit->u < want->u)) {
        double unit = U * (k->size + hit->u * length);
        bool is_again = strcmp(r->category, "again") ==
                        0; /* a point to rounding is where it left: a self-hit */
        if (!is_again && rev_residual(&k->oracle, r->o, r->d, hit->u, (int)hit->segment, hit->t) <=
                             ROUND_BOUND * unit) {
            k->sum.rounding++;
            return;
        }
        k->sum.wrong++;
        printf("false: ray %ld, %s %s\n", r->id, family, r->category);
        return;
    }
    double distance = sqrt(r->o[0] * r->o[0] + r->o[1] * r->o[1] + r->o[2] * r->o[2]);
    if (!rev_stable(&k->oracle, r->o, r->d, roots, count,
                    fmax(1e-12 * k->size, 4e-16 * distance))) {
        k->sum.unstable++;
        return;
    }
    double bound = ROUND_BOUND * U * (k->size + want->u * length), reach = 1e-3 * k->size / length;
    if ((hit && runs_along(k, r, want->seg, want->t, want->u, hit->u, bound)) ||
        runs_along(k, r, want->seg, want->t, want->u, want->u + reach, bound) ||
        runs_along(k, r, want->seg, want->t, want->u, want->u - reach, bound)) {
        k->sum.ruling++;
        printf("ruling: ray %ld, %s %s\n", r->id, family, r->category);
        return;
    }
    k->sum.missed++;
    printf("missed: ray %ld, %s %s, u %.17g instead of %.17g, cosine %g, margin %g\n", r->id,
           family, r->category, hit ? hit->u : HUGE_VAL, want->u, want->cosi, want->margin);
}

static void judge_ray(task *k, const corpus_ray *r, const fl_revolve_hit *hit)
{
    RevHit roots[MAX_ROOTS];
    const RevHit *want = NULL;
    unsigned flags = 0;
    int count = oracle_roots(k, r, roots, &flags);
    double length = sqrt(r->d[0] * r->d[0] + r->d[1] * r->d[1] + r->d[2] * r->d[2]);
    k->sum.rays++;
    if (hit) {
        double residual = rev_residual(&k->oracle, r->o, r->d, hit->u, (int)hit->segment, hit->t);
        double scaled = residual / (U * (k->size + hit->u * length));
        k->sum.hits++;
        k->sum.near += hit->u * length < 1e-6 * k->size;
        k->sum.worst = fmax(k->sum.worst, scaled);
        if (scaled > POINT_BOUND)
            printf("residual: ray %ld, %s %s, %g u (S + dist)\n", r->id, k->c->families[r->profile],
                   r->category, scaled);
        if (strcmp(r->category, "cam") == 0)
            k->sum.worst_camera = fmax(k->sum.worst_camera, scaled);
    }
    if (flags & REV_COINCIDENT)
        return;
    for (int i = 0; i < count && !want; i++)
        if (roots[i].u > 0.0)
            want = &roots[i];
    k->sum.wanted += want != NULL;
    if (!want && !hit)
        return;
    if (want && hit &&
        fabs(hit->u - want->u) * length * want->cosi <=
            HIT_BOUND * U * (k->size + fabs(want->u) * length))
        return;
    judge_difference(k, r, roots, count, want, hit);
}

static bool equal_hits(const fl_revolve_hit *a, const fl_revolve_hit *b)
{
    return a->u == b->u && a->t == b->t && a->segment == b->segment && a->sheet == b->sheet &&
           a->local == b->local;
}

/* Up to eight consecutive rays of one profile: packet, single and any-hit answers must be the same.
 */
static void judge_packet(task *k, const corpus_ray *rays, uint32_t count)
{
    fl_revolve_packet packet = {0};
    fl_revolve_hit hits[FL_REVOLVE_PACKET];
    uint32_t mask = (1u << count) - 1u;
    for (uint32_t i = 0; i < count; i++) {
        packet.ox[i] = rays[i].o[0];
        packet.oy[i] = rays[i].o[1];
        packet.oz[i] = rays[i].o[2];
        packet.dx[i] = rays[i].d[0];
        packet.dy[i] = rays[i].d[1];
        packet.dz[i] = rays[i].d[2];
        packet.u_max[i] = HUGE_VAL;
    }
    uint32_t found = fl_revolve_nearest8(k->revolve, &packet, mask, FL_REVOLVE_ROBUST, hits);
    uint32_t blocked = fl_revolve_any8(k->revolve, &packet, mask, FL_REVOLVE_ROBUST);
    k->sum.any_differs += __builtin_popcount(found ^ blocked);
    for (uint32_t i = 0; i < count; i++) {
        fl_revolve_hit one;
        bool is_hit = found >> i & 1u;
        bool is_one = fl_revolve_nearest(k->revolve, rays[i].o, rays[i].d, 0.0, HUGE_VAL,
                                         FL_REVOLVE_ROBUST, &one);
        k->sum.packet_differs += is_one != is_hit || (is_hit && !equal_hits(&one, &hits[i]));
        judge_ray(k, &rays[i], is_hit ? &hits[i] : NULL);
    }
}

static void set_oracle_profile(task *k, const fl_profile *p)
{
    size_t count = (size_t)p->segment_count * (p->degree + 1);
    free(k->oracle.cx);
    free(k->oracle.cy);
    k->oracle = (RevProfile){.deg = (int)p->degree,
                             .nseg = (int)p->segment_count,
                             .cx = malloc(count * sizeof(double)),
                             .cy = malloc(count * sizeof(double))};
    if (p->degree > REV_MAXDEG || !k->oracle.cx || !k->oracle.cy)
        exit(2);
    for (size_t i = 0; i < count; i++) {
        k->oracle.cx[i] = p->points[i].x;
        k->oracle.cy[i] = p->points[i].y;
    }
    k->size = rev_size(&k->oracle);
}

static bool judge_all(task *k)
{
    fl_arena arena = {0};
    fl_diags diags = {0};
    uint32_t built = FL_NONE;
    for (size_t i = 0, count; i < k->c->ray_count; i += count) {
        const corpus_ray *r = &k->c->rays[i];
        if (r->profile != built) {
            fl_arena_deinit(&arena);
            k->revolve = fl_revolve_build(&arena, &k->c->profiles[r->profile], &diags);
            if (!k->revolve) {
                fprintf(stderr, "%s\n", diags.items[0].message);
                return false;
            }
            built = r->profile;
            set_oracle_profile(k, &k->c->profiles[built]);
        }
        for (count = 1;
             count < FL_REVOLVE_PACKET && i + count < k->c->ray_count && r[count].profile == built;)
            count++;
        judge_packet(k, r, (uint32_t)count);
    }
    free(k->oracle.cx);
    free(k->oracle.cy);
    fl_diags_deinit(&diags);
    fl_arena_deinit(&arena);
    return true;
}

int main(int argc, char **argv)
{
    FILE *cases = argc > 1 ? fopen(argv[1], "r") : NULL;
    corpus c;
    if (!cases || !corpus_load(&c, cases)) {
        fprintf(stderr, "usage: revolve_judge CASES [ANSWERS]\n");
        return 2;
    }
    fclose(cases);
    task k = {.c = &c, .answers = argc > 2 ? fopen(argv[2], "r") : NULL};
    bool ok = judge_all(&k);
    const tally *s = &k.sum;
    printf("%ld rays, %ld with a root, %ld hit: %ld missed, %ld false; %ld along a ruling, %ld "
           "equal to rounding, "
           "%ld where the answer is unstable\n",
           s->rays, s->wanted, s->hits, s->missed, s->wrong, s->ruling, s->rounding, s->unstable);
    if (s->near)
        printf("%ld hits within 1e-6 S of the origin\n", s->near);
    printf("worst residual %.2f u (S + dist), camera rays %.2f; packets differ %ld, any-hit "
           "differs %ld\n",
           s->worst, s->worst_camera, s->packet_differs, s->any_differs);
    if (k.answers)
        fclose(k.answers);
    corpus_deinit(&c);
    return ok && s->missed == 0 && s->wrong == 0 && s->ruling <= 10 && s->worst <= POINT_BOUND &&
                   s->worst_camera <= CAMERA_BOUND && s->packet_differs == 0 && s->any_differs == 0
               ? 0
               : 1;
}
