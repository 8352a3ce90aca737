/* SPDX-License-Identifier: MIT */
#include "core/revolve_impl.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_N = FL_REVOLVE_MAX_DEGREE, MAX_SPLITS = 8 * MAX_N + 2, MAX_HALVINGS = 7 };

/* When a piece is short and straight enough; 0.3 to 1.5 rad make no measurable difference in speed.
 */
#define MAX_TURN_COS 0.825336 /* cos 0.6 rad */
#define MAX_CHORD    0.35     /* of S */
#define MAX_STRAY    0.25     /* control points off the evenly divided chord, in chords */
#define SMALL_CHORD  1e-3     /* of S: never split further */
#define SNAP         1e-14    /* radius of an inner node that counts as on the axis */
#define JOIN         1e-14    /* ends of neighbouring segments this near are one node */

/* hi + lo, |lo| <= ulp(hi) / 2: coordinates of pieces are formed with twice the digits and rounded
 * once. */
typedef struct pair {
    double hi, lo;
} pair;

typedef struct pair2 {
    pair x, y;
} pair2;

static pair pair_of_sum(double a, double b)
{
    double sum = a + b, part = sum - a;
    return (pair){sum, (a - (sum - part)) + (b - part)};
}

/* Dekker's product: exact as long as nothing underflows. */
static pair pair_of_product(double a, double b)
{
    double p = a * b, ta = 134217729.0 * a, tb = 134217729.0 * b;
    double ah = ta - (ta - a), al = a - ah, bh = tb - (tb - b), bl = b - bh;
    return (pair){p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

static pair pair_add(pair a, pair b)
{
    pair s = pair_of_sum(a.hi, b.hi);
    return pair_of_sum(s.hi, s.lo + (a.lo + b.lo));
}

static pair pair_sub(pair a, pair b)
{
    return pair_add(a, (pair){-b.hi, -b.lo});
}

static pair pair_mul(pair a, pair b)
{
    pair p = pair_of_product(a.hi, b.hi);
    return pair_of_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

/* a + t (b - a) */
static pair pair_mix(pair a, pair b, pair t)
{
    return pair_add(a, pair_mul(t, pair_sub(b, a)));
}

static pair2 pair2_mix(pair2 a, pair2 b, pair t)
{
    return (pair2){pair_mix(a.x, b.x, t), pair_mix(a.y, b.y, t)};
}

typedef struct node {
    double x, y;
} node;

/* Everything about the segment in work, and the pieces so far. */
typedef struct splitter {
    fl_revolve *revolve;
    pair2 point[MAX_N + 1]; /* control points of the segment */
    uint32_t n;             /* their degree */
    uint32_t segment;
    node first, last; /* its end nodes, shared with the neighbours */
    double *pieces;   /* heap, until the number is known */
    uint8_t *is_convex;
    uint32_t *owner;
    uint32_t count, room;
    double area; /* integral of x dy over all pieces */
} splitter;

/* The control points of [a, b]: cut at b, then the left part at a / b. */
static void restrict_to(const splitter *s, double a, double b, pair2 *out)
{
    uint32_t n = s->n;
    memcpy(out, s->point, (n + 1) * sizeof *out);
    if (b < 1.0)
        for (uint32_t k = 1; k <= n; k++)
            for (uint32_t i = n; i >= k; i--)
                out[i] = pair2_mix(out[i - 1], out[i], (pair){b, 0.0});
    if (a > 0.0) {
        double quotient = a / b;
        pair back = pair_of_product(quotient, b);
        pair cut = {quotient, ((a - back.hi) - back.lo) / b};
        for (uint32_t k = n; k > 0; k--)
            for (uint32_t i = 0; i < k; i++)
                out[i] = pair2_mix(out[i], out[i + 1], cut);
    }
}

/* The node at parameter t: the same bits whoever asks. */
static node node_at(const splitter *s, double t)
{
    if (t <= 0.0)
        return s->first;
    if (t >= 1.0)
        return s->last;
    pair2 w[MAX_N + 1];
    memcpy(w, s->point, (s->n + 1) * sizeof *w);
    for (uint32_t k = s->n; k > 0; k--)
        for (uint32_t i = 0; i < k; i++)
            w[i] = pair2_mix(w[i], w[i + 1], (pair){t, 0.0});
    double x = fabs(w[0].x.hi);
    return (node){x < SNAP ? 0.0 : x, w[0].y.hi};
}

/* Whether the part with these control points is worth halving: bent, long or unevenly parametrised.
 */
static bool is_coarse(const pair2 *p, uint32_t n, double size)
{
    double cx = p[n].x.hi - p[0].x.hi, cy = p[n].y.hi - p[0].y.hi, chord2 = cx * cx + cy * cy;
    double dx[MAX_N], dy[MAX_N];
    if (chord2 > MAX_CHORD * MAX_CHORD * size * size)
        return true;
    for (uint32_t i = 1; i < n; i++) {
        double f = (double)i / n, ex = p[i].x.hi - (p[0].x.hi + f * cx),
               ey = p[i].y.hi - (p[0].y.hi + f * cy);
        double off2 = ex * ex + ey * ey;
        if (off2 > MAX_STRAY * MAX_STRAY * chord2 && off2 > SMALL_CHORD * SMALL_CHORD * size * size)
            return true;
    }
    if (chord2 < SMALL_CHORD * SMALL_CHORD * size * size)
        return false;
    for (uint32_t i = 0; i < n; i++) {
        dx[i] = p[i + 1].x.hi - p[i].x.hi;
        dy[i] = p[i + 1].y.hi - p[i].y.hi;
    }
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j < i; j++) {
            double dot = dx[i] * dx[j] + dy[i] * dy[j];
            double aa = dx[i] * dx[i] + dy[i] * dy[i], bb = dx[j] * dx[j] + dy[j] * dy[j];
            if (aa > 1e-6 * chord2 && bb > 1e-6 * chord2 && dot < MAX_TURN_COS * sqrt(aa * bb))
                return true;
        }
    }
    return false;
}

static bool make_room(splitter *s)
{
    if (s->count < s->room)
        return true;
    if (s->room >= FL_REVOLVE_MAX_PIECES)
        return false;
    uint32_t room = s->room ? 2 * s->room : 64;
    size_t stride = s->revolve->stride;
    double *pieces = realloc(s->pieces, room * stride * sizeof *pieces);
    if (pieces)
        s->pieces = pieces;
    uint8_t *is_convex = realloc(s->is_convex, room);
    if (is_convex)
        s->is_convex = is_convex;
    uint32_t *owner = realloc(s->owner, room * sizeof *owner);
    if (owner)
        s->owner = owner;
    if (!pieces || !is_convex || !owner)
        return false;
    s->room = room;
    return true;
}

/* Powers of t from control points: forward differences times binomial coefficients. */
static void to_powers(pair *c, uint32_t n, double *out)
{
    double binomial = 1.0;
    for (uint32_t k = 0; k <= n; k++) {
        out[k] = binomial * c[0].hi;
        for (uint32_t i = 0; i + k < n; i++)
            c[i] = pair_sub(c[i + 1], c[i]);
        binomial = binomial * (double)(n - k) / (double)(k + 1);
    }
}

/* Bends towards the axis side that makes every cut convex: (x'y'' - x''y') y' >= 0, see
 * docs/revolution.md. Neither factor changes sign within a piece, so its middle decides; noise
 * counts as 0. */
static bool is_piece_convex(const double *px, const double *py, uint32_t n)
{
    double x1 = 0.0, y1 = 0.0, x2 = 0.0, y2 = 0.0, power = 1.0;
    for (uint32_t k = 1; k <= n; k++, power *= 0.5) {
        x1 += k * px[k] * power;
        y1 += k * py[k] * power;
        x2 += 2.0 * k * (k - 1) * px[k] * power;
        y2 += 2.0 * k * (k - 1) * py[k] * power;
    }
    double noise = 1e-12 * (fabs(x1) + fabs(y1)) * (fabs(x1) + fabs(y1));
    double bend = x1 * y2 - x2 * y1;
    return fabs(bend) <= noise || bend * y1 >= 0.0;
}

static bool add_piece(splitter *s, const pair2 *p, double a, double b)
{
    if (!make_room(s))
        return false;
    fl_revolve *r = s->revolve;
    uint32_t n = r->degree;
    double *out = s->pieces + (size_t)s->count * r->stride, *px = out, *py = out + n + 1;
    pair cx[MAX_N + 1], cy[MAX_N + 1];
    double sum = 0.0;
    for (uint32_t i = 0; i <= s->n; i++) {
        cx[i] = p[i].x;
        cy[i] = p[i].y;
        sum += p[i].x.hi;
    }
    memset(out, 0, r->stride * sizeof *out);
    to_powers(cx, s->n, px);
    to_powers(cy, s->n, py);
    if (sum < 0.0)
        for (uint32_t k = 0; k <= n; k++)
            px[k] = -px[k];
    node from = node_at(s, a), to = node_at(s, b);
    px[0] = from.x;
    py[0] = from.y;
    double *tail = py + n + 1;
    tail[0] = to.x;
    tail[1] = to.y;
    tail[2] = a;
    tail[3] = b - a;
    s->area += 0.5 * (from.x + to.x) * (to.y - from.y);
    s->is_convex[s->count] = is_piece_convex(px, py, n);
    s->owner[s->count++] = s->segment;
    r->radius = fl_max(r->radius, fl_max(from.x, to.x));
    r->y_lo = fl_min(r->y_lo, fl_min(from.y, to.y));
    r->y_hi = fl_max(r->y_hi, fl_max(from.y, to.y));
    return true;
}

/* Halve [a, b] while it is coarse; pieces come out from left to right. */
static bool add_interval(splitter *s, double a, double b, double size, uint32_t halvings)
{
    pair2 p[MAX_N + 1];
    restrict_to(s, a, b, p);
    double mid = 0.5 * (a + b);
    if (halvings < MAX_HALVINGS && mid > a && mid < b && is_coarse(p, s->n, size))
        return add_interval(s, a, mid, size, halvings + 1) &&
               add_interval(s, mid, b, size, halvings + 1);
    return add_piece(s, p, a, b);
}

/* Product of two polynomials in Bernstein form, added to out times `sign`; sizes are those of
 * coefficients. */
static void bernstein_product(const double *f, uint32_t a, const double *g, uint32_t b, double sign,
                              double *out)
{
    static const uint32_t limit = 2 * MAX_N;
    double row_a[2 * MAX_N + 1], row_b[2 * MAX_N + 1], row[2 * MAX_N + 1];
    FL_ASSERT(a + b <= limit);
    double *rows[3] = {row_a, row_b, row};
    uint32_t degrees[3] = {a, b, a + b};
    for (int r = 0; r < 3; r++) {
        rows[r][0] = 1.0;
        for (uint32_t k = 0; k < degrees[r]; k++)
            rows[r][k + 1] = rows[r][k] * (double)(degrees[r] - k) / (double)(k + 1);
    }
    for (uint32_t i = 0; i <= a; i++)
        for (uint32_t j = 0; j <= b; j++)
            out[i + j] += sign * f[i] * g[j] * row_a[i] * row_b[j] / row[i + j];
}

/* Parameters where x, x', y' or the curvature changes sign; ascending, with 0 and 1. */
static uint32_t find_splits(const splitter *s, double *out)
{
    uint32_t n = s->n, count = 1;
    double x[MAX_N + 1], x1[MAX_N + 1], y1[MAX_N + 1], x2[MAX_N + 1], y2[MAX_N + 1],
        bend[2 * MAX_N + 1] = {0};
    double speed = 0.0, size = s->revolve->tiny;
    for (uint32_t i = 0; i <= n; i++)
        x[i] = s->point[i].x.hi;
    for (uint32_t i = 0; i < n; i++) {
        x1[i] = pair_sub(s->point[i + 1].x, s->point[i].x).hi;
        y1[i] = pair_sub(s->point[i + 1].y, s->point[i].y).hi;
        speed = fl_max(speed, fl_max(fabs(x1[i]), fabs(y1[i])));
    }
    out[0] = 0.0;
    count += fl_revolve_roots(x, n, size, out + count, MAX_SPLITS - 1 - count);
    count += fl_revolve_roots(x1, n - 1, 4.0 * size, out + count, MAX_SPLITS - 1 - count);
    count += fl_revolve_roots(y1, n - 1, 4.0 * size, out + count, MAX_SPLITS - 1 - count);
    if (n >= 2) {
        for (uint32_t i = 0; i + 1 < n; i++) {
            x2[i] = x1[i + 1] - x1[i];
            y2[i] = y1[i + 1] - y1[i];
        }
        bernstein_product(x1, n - 1, y2, n - 2, 1.0, bend);
        bernstein_product(y1, n - 1, x2, n - 2, -1.0, bend);
        count += fl_revolve_roots(bend, 2 * n - 3, 1e-13 * speed * speed, out + count,
                                  MAX_SPLITS - 1 - count);
    }
    for (uint32_t i = 1; i < count; i++) /* four ascending runs: insertion sort */
        for (uint32_t j = i; j > 0 && out[j] < out[j - 1]; j--) {
            double t = out[j];
            out[j] = out[j - 1];
            out[j - 1] = t;
        }
    uint32_t kept = 1;
    for (uint32_t i = 1; i < count; i++)
        if (out[i] > out[kept - 1] + 1e-13 && out[i] < 1.0 - 1e-13)
            out[kept++] = out[i];
    out[kept++] = 1.0;
    return kept;
}

/* Load segment i; its first node is the last one of its predecessor when they join. */
static void load_segment(splitter *s, uint32_t segment, const double *x, const double *y,
                         const double *y_low)
{
    const size_t at = (size_t)segment * (s->n + 1);
    for (uint32_t i = 0; i <= s->n; i++)
        s->point[i] = (pair2){{x[at + i], 0.0}, {y[at + i], y_low[at + i]}};
    node first = {fabs(x[at]), y[at]};
    bool joins =
        segment > 0 && fabs(first.x - s->last.x) <= JOIN && fabs(first.y - s->last.y) <= JOIN;
    s->first = joins ? s->last : first;
    s->last = (node){fabs(x[at + s->n]), y[at + s->n]};
    s->segment = segment;
}

/* A point, or a part of the axis, has no area. */
static bool has_area(const splitter *s)
{
    bool moves = false, leaves = false;
    for (uint32_t i = 0; i <= s->n; i++) {
        moves = moves || s->point[i].x.hi != s->point[0].x.hi ||
                s->point[i].y.hi != s->point[0].y.hi || s->point[i].y.lo != s->point[0].y.lo;
        leaves = leaves || s->point[i].x.hi != 0.0;
    }
    return moves && leaves;
}

static bool split_all(splitter *s, const double *x, const double *y, const double *y_low,
                      uint32_t segment_count, double size)
{
    uint32_t n = s->n;
    const size_t end = (size_t)segment_count * (n + 1) - 1;
    for (uint32_t i = 0; i < segment_count; i++) {
        double splits[MAX_SPLITS];
        load_segment(s, i, x, y, y_low);
        if (i + 1 == segment_count && fabs(fabs(x[end]) - fabs(x[0])) <= JOIN &&
            fabs(y[end] - y[0]) <= JOIN)
            s->last = (node){fabs(x[0]), y[0]}; /* a closed profile */
        if (!has_area(s))
            continue;
        uint32_t count = find_splits(s, splits);
        for (uint32_t k = 0; k + 1 < count; k++)
            if (!add_interval(s, splits[k], splits[k + 1], size, 0))
                return false;
    }
    return true;
}

/* Move what the heap holds into the arena. */
static bool keep(splitter *s, fl_arena *arena)
{
    fl_revolve *r = s->revolve;
    double *pieces = fl_arena_alloc(arena, (size_t)s->count * r->stride, sizeof *pieces);
    uint8_t *is_convex = fl_arena_alloc(arena, s->count, 1);
    uint32_t *owner = fl_arena_alloc(arena, s->count, sizeof *owner);
    if (!pieces || !is_convex || !owner)
        return false;
    memcpy(pieces, s->pieces, (size_t)s->count * r->stride * sizeof *pieces);
    memcpy(is_convex, s->is_convex, s->count);
    memcpy(owner, s->owner, s->count * sizeof *owner);
    r->pieces = pieces;
    r->is_convex = is_convex;
    r->segment = owner;
    r->piece_count = s->count;
    r->normal_sign = s->area < 0.0 ? -1.0 : 1.0;
    return true;
}

bool fl_revolve_split(fl_revolve *revolve, fl_arena *arena, const double *x, const double *y,
                      const double *y_low, uint32_t segment_count, uint32_t degree, fl_loc loc,
                      fl_diags *diags)
{
    splitter s = {.revolve = revolve, .n = degree};
    revolve->degree = degree < 3 ? 3 : degree;
    revolve->stride = 2 * revolve->degree + 6;
    revolve->radius = 0.0;
    revolve->y_lo = HUGE_VAL;
    revolve->y_hi = -HUGE_VAL;
    bool ok = split_all(&s, x, y, y_low, segment_count, revolve->tiny * 0x1p53);
    if (!ok)
        fl_out_of_memory(diags, "the pieces of a revolution surface");
    else if (s.count == 0)
        ok =
            fl_error(diags, loc, "the profile encloses no area: it is a point or lies on the axis");
    else if (!keep(&s, arena))
        ok = fl_out_of_memory(diags, "the pieces of a revolution surface");
    free(s.pieces);
    free(s.is_convex);
    free(s.owner);
    return ok;
}

static void widen(fl_revolve_group *g, uint32_t lane, double xlo, double xhi, double ylo,
                  double yhi)
{
    /* The pad is some 30 roundings to float, so to nearest is outward enough. */
    g->xlo[lane] = (float)(xlo - FL_REVOLVE_PAD);
    g->xhi[lane] = (float)(xhi + FL_REVOLVE_PAD);
    g->ylo[lane] = (float)(ylo - FL_REVOLVE_PAD);
    g->yhi[lane] = (float)(yhi + FL_REVOLVE_PAD);
}

/* The box around the used lanes of a group, without a pad of its own. */
static void widen_by_group(fl_revolve_group *g, uint32_t lane, const fl_revolve_group *inner)
{
    g->xlo[lane] = inner->xlo[0];
    g->xhi[lane] = inner->xhi[0];
    g->ylo[lane] = inner->ylo[0];
    g->yhi[lane] = inner->yhi[0];
    for (int i = 1; i < FL_REVOLVE_GROUP && inner->xhi[i] >= 0.0f; i++) {
        g->xlo[lane] = inner->xlo[i] < g->xlo[lane] ? inner->xlo[i] : g->xlo[lane];
        g->xhi[lane] = inner->xhi[i] > g->xhi[lane] ? inner->xhi[i] : g->xhi[lane];
        g->ylo[lane] = inner->ylo[i] < g->ylo[lane] ? inner->ylo[i] : g->ylo[lane];
        g->yhi[lane] = inner->yhi[i] > g->yhi[lane] ? inner->yhi[i] : g->yhi[lane];
    }
}

static fl_revolve_group *new_groups(fl_arena *arena, uint32_t count)
{
    fl_revolve_group *groups = fl_arena_alloc(arena, count, sizeof *groups);
    for (uint32_t g = 0; groups && g < count; g++)
        for (int i = 0; i < FL_REVOLVE_GROUP; i++)
            groups[g].xlo[i] = groups[g].xhi[i] = -1.0f;
    return groups;
}

bool fl_revolve_group_boxes(fl_revolve *revolve, fl_arena *arena)
{
    uint32_t n = revolve->degree,
             count = (revolve->piece_count + FL_REVOLVE_GROUP - 1) / FL_REVOLVE_GROUP;
    fl_revolve_group *groups = new_groups(arena, count);
    if (!groups)
        return false;
    for (uint32_t i = 0; i < revolve->piece_count; i++) {
        const double *p = fl_revolve_piece(revolve, i), *end = p + 2 * n + 2;
        widen(&groups[i / FL_REVOLVE_GROUP], i % FL_REVOLVE_GROUP, fl_min(p[0], end[0]),
              fl_max(p[0], end[0]), fl_min(p[n + 1], end[1]), fl_max(p[n + 1], end[1]));
    }
    revolve->groups[0] = groups;
    revolve->group_count[0] = count;
    revolve->level_count = 1;
    while (count > 1) {
        uint32_t inner_count = count, level = revolve->level_count;
        const fl_revolve_group *inner = revolve->groups[level - 1];
        count = (inner_count + FL_REVOLVE_GROUP - 1) / FL_REVOLVE_GROUP;
        groups = new_groups(arena, count);
        if (!groups)
            return false;
        for (uint32_t i = 0; i < inner_count; i++)
            widen_by_group(&groups[i / FL_REVOLVE_GROUP], i % FL_REVOLVE_GROUP, &inner[i]);
        revolve->groups[level] = groups;
        revolve->group_count[level] = count;
        revolve->level_count++;
    }
    revolve->first_level = 0;
    while (revolve->group_count[revolve->first_level] > 4)
        revolve->first_level++;
    return true;
}
