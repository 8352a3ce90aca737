/* SPDX-License-Identifier: MIT */
#include "core/pipeline_work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Allocates from one arena and remembers whether all went well. */
typedef struct maker {
    fl_arena *arena;
    size_t count;
    bool has_failed;
} maker;

static void *make(maker *m, size_t item_bytes)
{
    void *p = fl_arena_alloc(m->arena, m->count, item_bytes);
    m->has_failed |= !p;
    return p;
}

static float *make_floats(maker *m)
{
    return make(m, sizeof(float));
}

static uint32_t *make_words(maker *m)
{
    return make(m, sizeof(uint32_t));
}

static fl_array3 make3(maker *m)
{
    return (fl_array3){make_floats(m), make_floats(m), make_floats(m)};
}

static fl_rays make_rays(maker *m)
{
    fl_array3 o = make3(m), d = make3(m);
    return (fl_rays){.capacity = FL_STREAM_RAYS,
                     .ox = o.x,
                     .oy = o.y,
                     .oz = o.z,
                     .dx = d.x,
                     .dy = d.y,
                     .dz = d.z,
                     .t_max = make_floats(m),
                     .source_object = make_words(m),
                     .source_prim = make_words(m)};
}

static fl_hits make_hits(maker *m)
{
    return (fl_hits){.t = make_floats(m), .object = make_words(m), .prim = make_words(m)};
}

static fl_surface make_surface(maker *m)
{
    fl_array3 p = make3(m), ng = make3(m), ns = make3(m);
    return (fl_surface){.px = p.x,
                        .py = p.y,
                        .pz = p.z,
                        .ngx = ng.x,
                        .ngy = ng.y,
                        .ngz = ng.z,
                        .nsx = ns.x,
                        .nsy = ns.y,
                        .nsz = ns.z,
                        .offset = make_floats(m),
                        .u = make_floats(m),
                        .v = make_floats(m)};
}

static fl_stage make_stage(maker *m)
{
    fl_stage s = {.rays = make_rays(m), .hits = make_hits(m), .surface = make_surface(m)};
    s.pixel = make_words(m);
    s.path = make_words(m);
    s.entry = make_words(m);
    s.shader = make_words(m);
    s.view = make3(m);
    s.normal = make3(m);
    s.diffuse = make3(m);
    s.specular = make3(m);
    s.shininess = make_floats(m);
    s.index = make_floats(m);
    s.radiance = make3(m);
    return s;
}

fl_workspace *fl_workspace_create(void)
{
    fl_workspace *w = calloc(1, sizeof *w);
    if (!w)
        return NULL;
    maker m = {&w->arena, FL_STREAM_RAYS + FL_STREAM_SLACK, false};
    w->stage = make_stage(&m);
    w->shadow = (fl_shadow){make_rays(&m), make_words(&m), make3(&m)};
    w->blocked = make_words(&m);
    w->lit = make3(&m);
    w->glow = make3(&m);
    w->throughput = make3(&m);
    w->slot = make_words(&m);
    m.count = FL_UNIT_PIXELS;
    w->result = (fl_unit_result){make_floats(&m), make_floats(&m), make_floats(&m), make(&m, 1)};
    if (m.has_failed) {
        fl_workspace_destroy(w);
        return NULL;
    }
    return w;
}

bool fl_workspace_reserve_through(fl_workspace *workspace)
{
    if (workspace->end.x)
        return true;
    maker m = {&workspace->arena, FL_STREAM_RAYS + FL_STREAM_SLACK, false};
    workspace->through = (fl_shadow){make_rays(&m), make_words(&m), make3(&m)};
    workspace->through_hits = make_hits(&m);
    workspace->through_surface = make_surface(&m);
    fl_array3 end = make3(&m);
    if (m.has_failed)
        return false;
    workspace->end = end;
    return true;
}

bool fl_workspace_reserve_roots(fl_workspace *workspace)
{
    fl_hits *hits = &workspace->stage.hits;
    if (!hits->root)
        hits->root =
            fl_arena_alloc(&workspace->arena, FL_STREAM_RAYS + FL_STREAM_SLACK, sizeof *hits->root);
    hits->root_at = workspace->stage.entry;
    return hits->root;
}

void fl_workspace_destroy(fl_workspace *workspace)
{
    if (!workspace)
        return;
    fl_branches_deinit(&workspace->current);
    fl_branches_deinit(&workspace->next);
    fl_arena_deinit(&workspace->arena);
    free(workspace);
}

const fl_unit_result *fl_workspace_result(const fl_workspace *workspace)
{
    return &workspace->result;
}

fl_cost_ticks *fl_workspace_ticks(fl_workspace *workspace)
{
    return &workspace->ticks;
}

bool fl_branches_reserve(fl_branches *branches, uint32_t more)
{
    enum { FIELDS = FL_BRANCH_NUMBERS + FL_BRANCH_WORDS, ROUND = 16 };
    if (more <= branches->capacity - branches->count)
        return true;
    size_t capacity = fl_max_u32(branches->count + more, 2 * branches->capacity);
    size_t stride = (capacity + FL_STREAM_SLACK + ROUND - 1) / ROUND * ROUND * sizeof(float);
    char *memory = aligned_alloc(64, FIELDS * stride);
    if (!memory)
        return false;
    fl_branches grown = {.count = branches->count, .memory = memory};
    grown.capacity = (uint32_t)capacity;
    size_t bytes = branches->count * sizeof(float);
    for (int k = 0; k < FL_BRANCH_NUMBERS; k++, memory += stride) {
        grown.number[k] = (float *)(void *)memory;
        if (bytes)
            memcpy(memory, branches->number[k], bytes);
    }
    for (int k = 0; k < FL_BRANCH_WORDS; k++, memory += stride) {
        grown.word[k] = (uint32_t *)(void *)memory;
        if (bytes)
            memcpy(memory, branches->word[k], bytes);
    }
    fl_branches_deinit(branches);
    *branches = grown;
    return true;
}

void fl_branches_deinit(fl_branches *branches)
{
    free(branches->memory);
    *branches = (fl_branches){0};
}

static float weight(const fl_branches *b, uint32_t i)
{
    float red = b->number[6][i], green = b->number[7][i], blue = b->number[8][i];
    float rg = red > green ? red : green;
    return rg > blue ? rg : blue;
}

static void copy_branch(fl_branches *b, uint32_t to, uint32_t from)
{
    for (int k = 0; k < FL_BRANCH_NUMBERS; k++)
        b->number[k][to] = b->number[k][from];
    for (int k = 0; k < FL_BRANCH_WORDS; k++)
        b->word[k][to] = b->word[k][from];
}

/* Sort [begin, end) by path; the few of one slot are nearly always one or two. Stable. The place
 * behind the last branch holds the one that moves. */
static void sort_run(fl_branches *b, uint32_t begin, uint32_t end)
{
    const uint32_t *path = b->word[FL_BRANCH_PATH];
    for (uint32_t i = begin + 1; i < end; i++) {
        if (path[i - 1] <= path[i])
            continue;
        uint32_t j = i;
        copy_branch(b, b->count, i);
        for (; j > begin && path[j - 1] > path[b->count]; j--)
            copy_branch(b, j, j - 1);
        copy_branch(b, j, b->count);
    }
}

/* Drop the lightest, of equals the lowest path, of a sorted run. */
static void drop_one(fl_branches *b, uint32_t begin, uint32_t end)
{
    uint32_t lightest = begin;
    for (uint32_t i = begin + 1; i < end; i++)
        if (weight(b, i) < weight(b, lightest))
            lightest = i;
    for (uint32_t i = lightest; i + 1 < end; i++)
        copy_branch(b, i, i + 1);
}

uint32_t fl_branches_settle(fl_branches *branches)
{
    const uint32_t *slot = branches->word[FL_BRANCH_SLOT];
    uint32_t kept = 0, count = branches->count;
    for (uint32_t begin = 0, end; begin < count; begin = end) {
        end = begin + 1;
        while (end < count && slot[end] == slot[begin])
            end++;
        uint32_t last = end;
        sort_run(branches, begin, end);
        for (; last - begin > FL_PENDING_MAX; last--)
            drop_one(branches, begin, last);
        for (uint32_t i = begin; i < last; i++, kept++)
            if (kept != i)
                copy_branch(branches, kept, i);
    }
    branches->count = kept;
    return count - kept;
}

void fl_rays_pad(fl_rays *rays)
{
    for (uint32_t i = rays->count; i % 8 != 0; i++) {
        rays->ox[i] = rays->ox[i - 1];
        rays->oy[i] = rays->oy[i - 1];
        rays->oz[i] = rays->oz[i - 1];
        rays->dx[i] = rays->dx[i - 1];
        rays->dy[i] = rays->dy[i - 1];
        rays->dz[i] = rays->dz[i - 1];
        rays->t_max[i] = -1.0f;
        rays->source_object[i] = rays->source_prim[i] = FL_NONE;
    }
}

void fl_hits_pad(fl_hits *hits, uint32_t count)
{
    for (uint32_t i = count; i % 8 != 0; i++) {
        hits->t[i] = INFINITY;
        hits->object[i] = hits->prim[i] = FL_NONE;
    }
}
