/* SPDX-License-Identifier: MIT */
#include "core/raytree.h"

#include <math.h>
#include <stdlib.h>

#include "core/pipeline_work.h"
#include "core/trace_piece.h"

const char *const fl_ray_kind_names[FL_RAY_KIND_COUNT] = {"camera", "reflect", "refract"};

/* Room for `more` items; false: out of memory, the old ones are kept. */
static bool reserve(void **items, size_t item_bytes, uint32_t count, uint32_t more,
                    uint32_t *capacity)
{
    if (more <= *capacity - count)
        return true;
    uint32_t wanted = fl_max_u32(count + more, 2 * *capacity);
    void *grown = realloc(*items, wanted * item_bytes);
    if (!grown)
        return false;
    *items = grown;
    *capacity = wanted;
    return true;
}

static void get3(float out[3], fl_array3 a, uint32_t i)
{
    out[0] = a.x[i];
    out[1] = a.y[i];
    out[2] = a.z[i];
}

static fl_vec3 world_of(const fl_frame *frame, float x, float y, float z)
{
    return fl_v3_add(fl_v3((double)x, (double)y, (double)z), frame->scene->geometry.origin);
}

/* The node of the level before whose child that path is. */
static uint32_t parent_of(const fl_raytree *tree, const fl_frame *frame, uint32_t level,
                          uint32_t path, bool is_refracted)
{
    for (uint32_t i = tree->node_count; i-- > 0 && tree->nodes[i].level + 1 >= level;)
        if (tree->nodes[i].level + 1 == level &&
            fl_path_child(frame->params.seed, tree->nodes[i].path, is_refracted) == path)
            return i;
    return FL_NONE;
}

static void see_hits(fl_raytree *tree, const fl_pipe *pipe)
{
    const fl_workspace *work = pipe->work;
    const fl_stage *stage = &work->stage;
    const fl_rays *r = &stage->rays;
    uint32_t level = tree->node_count ? tree->nodes[tree->node_count - 1].level + 1 : 0;
    void *nodes = tree->nodes;
    tree->has_failed |=
        !reserve(&nodes, sizeof *tree->nodes, tree->node_count, r->count, &tree->node_capacity);
    tree->nodes = nodes;
    if (tree->has_failed)
        return;
    uint32_t first = tree->node_count;
    for (uint32_t i = 0; i < r->count; i++) {
        bool is_refracted = level > 0 && work->current.word[FL_BRANCH_REFRACTED][i];
        fl_raytree_node *node = &tree->nodes[first + i];
        *node = (fl_raytree_node){
            .kind = level == 0     ? FL_RAY_CAMERA
                    : is_refracted ? FL_RAY_REFRACT
                                   : FL_RAY_REFLECT,
            .level = level,
            .parent =
                level ? parent_of(tree, pipe->frame, level, stage->path[i], is_refracted) : FL_NONE,
            .path = stage->path[i],
            .origin = world_of(pipe->frame, r->ox[i], r->oy[i], r->oz[i]),
            .direction = {r->dx[i], r->dy[i], r->dz[i]},
            .t = stage->hits.t[i],
            .object = stage->hits.object[i],
            .prim = stage->hits.prim[i]};
        get3(node->weight, work->throughput, i);
    }
    tree->node_count += r->count;
}

/* First node of the stream that is under way. */
static uint32_t level_begin(const fl_raytree *tree)
{
    uint32_t i = tree->node_count, level = tree->nodes[i - 1].level;
    while (i > 0 && tree->nodes[i - 1].level == level)
        i--;
    return i;
}

static void see_surfaces(fl_raytree *tree, const fl_pipe *pipe)
{
    const fl_stage *stage = &pipe->work->stage;
    const fl_surface *s = &stage->surface;
    uint32_t begin = level_begin(tree);
    for (uint32_t i = 0; i < stage->rays.count; i++) {
        fl_raytree_node *node = &tree->nodes[begin + stage->entry[i]];
        node->position = world_of(pipe->frame, s->px[i], s->py[i], s->pz[i]);
        get3(node->ng, (fl_array3){s->ngx, s->ngy, s->ngz}, i);
        get3(node->ns, stage->normal, i);
        get3(node->ambient, stage->radiance, i);
    }
}

static void see_light(fl_raytree *tree, const fl_pipe *pipe, uint32_t light, uint32_t j)
{
    const fl_workspace *work = pipe->work;
    const fl_rays *r = &work->shadow.rays;
    void *lights = tree->lights;
    tree->has_failed |=
        !reserve(&lights, sizeof *tree->lights, tree->light_count, r->count, &tree->light_capacity);
    tree->lights = lights;
    if (tree->has_failed)
        return;
    uint32_t begin = level_begin(tree);
    for (uint32_t i = 0; i < r->count; i++) {
        fl_raytree_light *entry = &tree->lights[tree->light_count++];
        *entry = (fl_raytree_light){.node = begin + work->stage.entry[work->shadow.at[i]],
                                    .light = light,
                                    .sample = j,
                                    .samples = pipe->frame->lights[light].samples,
                                    .blocker = FL_NONE};
        get3(entry->sends, work->shadow.arrives, i);
        if (!pipe->frame->plan.has_shadows)
            continue;
        get3(entry->o, (fl_array3){r->ox, r->oy, r->oz}, i);
        get3(entry->d, (fl_array3){r->dx, r->dy, r->dz}, i);
        entry->t_max = r->t_max[i];
    }
}

static void see_shadow(fl_raytree *tree, const fl_pipe *pipe)
{
    uint32_t count = pipe->work->shadow.rays.count, first = tree->light_count - count;
    for (uint32_t i = 0; i < count; i++)
        get3(tree->lights[first + i].arrives, pipe->work->shadow.arrives, i);
}

static void see_radiance(fl_raytree *tree, const fl_pipe *pipe)
{
    uint32_t begin = level_begin(tree);
    for (uint32_t i = begin; i < tree->node_count; i++) {
        fl_raytree_node *node = &tree->nodes[i];
        get3(node->radiance, pipe->work->glow, i - begin);
        if (node->object == FL_NONE)
            get3(node->ambient, pipe->work->glow, i - begin);
    }
}

static void see(void *context, const fl_pipe *pipe, fl_moment moment, uint32_t light, uint32_t j)
{
    fl_raytree *tree = context;
    if (moment == FL_AT_HITS && !tree->has_failed)
        see_hits(tree, pipe);
    if (tree->has_failed)
        return;
    switch (moment) {
    case FL_AT_HITS:
        break;
    case FL_AT_SURFACES:
        see_surfaces(tree, pipe);
        break;
    case FL_AT_LIGHT:
        see_light(tree, pipe, light, j);
        break;
    case FL_AT_SHADOW:
        see_shadow(tree, pipe);
        break;
    case FL_AT_RADIANCE:
        see_radiance(tree, pipe);
        break;
    }
}

static int compare_lights(const void *a, const void *b)
{
    const fl_raytree_light *p = a, *q = b;
    const uint32_t x[3] = {p->node, p->light, p->sample}, y[3] = {q->node, q->light, q->sample};
    for (int i = 0; i < 3; i++)
        if (x[i] != y[i])
            return x[i] < y[i] ? -1 : 1;
    return 0;
}

static void sort_lights(fl_raytree *tree)
{
    if (tree->light_count == 0)
        return;
    qsort(tree->lights, tree->light_count, sizeof *tree->lights, compare_lights);
    for (uint32_t i = tree->light_count; i-- > 0;) {
        fl_raytree_node *node = &tree->nodes[tree->lights[i].node];
        node->first_light = i;
        node->light_count++;
    }
}

bool fl_raytree_trace(const fl_frame *frame, uint32_t x, uint32_t y, uint32_t sample,
                      fl_raytree *tree)
{
    if (!tree->workspace)
        tree->workspace = fl_workspace_create();
    if (!tree->workspace)
        return false;
    uint16_t px = (uint16_t)x, py = (uint16_t)y;
    fl_unit unit = {.x = &px, .y = &py, .count = 1, .sample = sample};
    fl_witness witness = {see, tree};
    tree->x = x;
    tree->y = y;
    tree->sample = sample;
    tree->node_count = tree->light_count = 0;
    tree->counts = (fl_counts){0};
    tree->has_failed = false;
    tree->workspace->witness = &witness;
    bool out_of_memory = false;
    bool is_done =
        fl_pipeline_run(frame, &unit, tree->workspace, NULL, 0, &tree->counts, &out_of_memory);
    tree->workspace->witness = NULL;
    const fl_unit_result *result = fl_workspace_result(tree->workspace);
    const float rgb[3] = {result->r[0], result->g[0], result->b[0]};
    for (int c = 0; c < 3; c++)
        tree->rgb[c] = rgb[c];
    tree->is_valid = result->is_valid[0];
    sort_lights(tree);
    return is_done && !tree->has_failed;
}

bool fl_raytree_find_blockers(const fl_frame *frame, fl_raytree *tree)
{
    const fl_compiled *scene = frame->scene;
    fl_isect_context context = {.solver = frame->params.solver};
    fl_piece p = {0};
    if (!frame->plan.has_shadows)
        return true;
    if (!fl_piece_init(&p, 16))
        return false;
    for (uint32_t i = 0; i < tree->light_count; i++) {
        fl_raytree_light *l = &tree->lights[i];
        if (l->arrives[0] == l->sends[0] && l->arrives[1] == l->sends[1] &&
            l->arrives[2] == l->sends[2])
            continue;
        fl_rays_set(&p.rays, 0, fl_v3((double)l->o[0], (double)l->o[1], (double)l->o[2]),
                    fl_v3((double)l->d[0], (double)l->d[1], (double)l->d[2]), l->t_max);
        p.rays.source_object[0] = tree->nodes[l->node].object;
        p.rays.source_prim[0] = tree->nodes[l->node].prim;
        fl_piece_set_count(&p.rays, 1);
        fl_isect_kernels_of(scene->isa)->nearest(&scene->geometry, &p.rays, &p.hits, &context);
        l->blocker = p.hits.object[0];
        l->blocker_t = (double)p.hits.t[0];
    }
    fl_piece_deinit(&p);
    return true;
}

void fl_raytree_deinit(fl_raytree *tree)
{
    fl_workspace_destroy(tree->workspace);
    free(tree->nodes);
    free(tree->lights);
    *tree = (fl_raytree){0};
}

uint32_t fl_raytree_heaviest(const fl_raytree *tree)
{
    uint32_t best = FL_NONE;
    double most = 0.0;
    for (uint32_t i = 0; i < tree->node_count; i++) {
        const fl_raytree_node *node = &tree->nodes[i];
        double sum = 0.0;
        for (int c = 0; c < 3; c++)
            sum += fabs((double)node->weight[c] * (double)node->radiance[c]);
        if (sum > most) {
            most = sum;
            best = i;
        }
    }
    return best;
}
