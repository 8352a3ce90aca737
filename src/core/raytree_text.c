/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/raytree.h"

const char *const fl_object_kind_names[FL_OBJECT_KIND_COUNT] = {
    "sphere", "plane", "square", "disk", "triangle", "mesh", "revolution"};

typedef struct writer {
    const fl_frame *frame;
    const fl_raytree *tree;
    char *out;
    size_t bytes, length; /* length: as if there were room for all */
    bool is_short;
} writer;

static void put(writer *w, const char *format, ...) FL_PRINTF(2, 3);

static void put(writer *w, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    bool has_room = w->length < w->bytes;
    int length = vsnprintf(has_room ? w->out + w->length : NULL,
                           has_room ? w->bytes - w->length : 0, format, args);
    va_end(args);
    w->length += length > 0 ? (size_t)length : 0;
}

static void put_triple(writer *w, const float v[3])
{
    int digits = w->is_short ? 3 : 9;
    if (v[0] == v[1] && v[1] == v[2] && w->is_short)
        put(w, " %.*g", digits, (double)v[0]);
    else
        put(w, " %.*g %.*g %.*g", digits, (double)v[0], digits, (double)v[1], digits, (double)v[2]);
}

static void put_vec(writer *w, fl_vec3 v)
{
    put(w, " %.9g %.9g %.9g", v.x, v.y, v.z);
}

void fl_object_text(const fl_compiled *scene, uint32_t object, char *out, size_t out_bytes)
{
    const fl_loc *loc = &scene->object_loc[object];
    const char *slash = loc->file ? strrchr(loc->file, '/') : NULL;
    const char *file = slash ? slash + 1 : loc->file ? loc->file : "";
    snprintf(out, out_bytes, "%s %u, %s:%u",
             fl_object_kind_names[scene->geometry.object_kind[object]], object + 1, file,
             loc->line);
}

static bool is_same(const float a[3], const float b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void put_light(writer *w, const fl_raytree_light *l, int indent)
{
    char name[160];
    put(w, "%*slight %u", indent, "", l->light + 1);
    if (l->samples > 1)
        put(w, " sample %u of %u", l->sample + 1, l->samples);
    put(w, ":");
    put_triple(w, l->sends);
    if (!is_same(l->sends, l->arrives)) {
        bool is_dark = l->arrives[0] == 0.0f && l->arrives[1] == 0.0f && l->arrives[2] == 0.0f;
        put(w, is_dark ? ", blocked" : ", arrives");
        if (!is_dark)
            put_triple(w, l->arrives);
        if (l->blocker != FL_NONE) {
            fl_object_text(w->frame->scene, l->blocker, name, sizeof name);
            put(w, is_dark ? " by %s at %.4g of the way" : " through %s at %.4g of the way", name,
                l->blocker_t);
        }
    }
    put(w, "\n");
}

/* Why a surface that could send rays on sent none. */
static void put_end(writer *w, const fl_raytree_node *node, bool has_children, int indent)
{
    const fl_compiled *scene = w->frame->scene;
    const fl_shader *s = &scene->shaders[scene->object_shader[node->object]];
    static const float black[3] = {0.0f, 0.0f, 0.0f};
    if (has_children || (is_same(s->reflect, black) && is_same(s->refract, black)))
        return;
    if (node->level >= w->frame->params.depth_limit)
        put(w, "%*send: depth limit %u\n", indent, "", w->frame->params.depth_limit);
    else
        put(w, "%*send: weight below %.4g\n", indent, "", w->frame->params.weight_threshold);
}

static void put_surface(writer *w, const fl_raytree_node *node, bool has_children, int indent)
{
    char name[160];
    fl_object_text(w->frame->scene, node->object, name, sizeof name);
    put(w, "%*shits %s, primitive %u, t %.9g, at", indent, "", name, node->prim, (double)node->t);
    put_vec(w, node->position);
    put(w, "\n%*sNg", indent, "");
    put_triple(w, node->ng);
    put(w, "  Ns");
    put_triple(w, node->ns);
    put(w, "\n%*sambient", indent, "");
    put_triple(w, node->ambient);
    put(w, "\n");
    for (uint32_t i = 0; i < node->light_count; i++)
        put_light(w, &w->tree->lights[node->first_light + i], indent);
    put_end(w, node, has_children, indent);
}

static void put_sum(writer *w, const fl_raytree_node *node)
{
    float sum[3];
    for (int c = 0; c < 3; c++)
        sum[c] = node->weight[c] * node->radiance[c];
    put_triple(w, sum);
}

static void put_node(writer *w, uint32_t index, bool has_children)
{
    const fl_raytree_node *node = &w->tree->nodes[index];
    int indent = 2 * (int)node->level + 2;
    put(w, "%*s%s", indent - 2, "", fl_ray_kind_names[node->kind]);
    if (index > 0) {
        put(w, " weight");
        put_triple(w, node->weight);
    }
    put(w, " from");
    put_vec(w, node->origin);
    put(w, " along");
    put_triple(w, node->direction);
    put(w, "\n");
    if (node->object != FL_NONE)
        put_surface(w, node, has_children, indent);
    else
        put(w, "%*sleaves the scene: background\n", indent, "");
    put(w, "%*sradiance", indent, "");
    put_triple(w, node->radiance);
    put(w, ", adds");
    put_sum(w, node);
    put(w, "\n");
}

static void put_node_short(writer *w, uint32_t index)
{
    const fl_raytree_node *node = &w->tree->nodes[index];
    uint32_t lit = 0;
    for (uint32_t i = 0; i < node->light_count; i++) {
        const float *a = w->tree->lights[node->first_light + i].arrives;
        lit += a[0] != 0.0f || a[1] != 0.0f || a[2] != 0.0f;
    }
    char name[160] = "background";
    if (node->object != FL_NONE)
        fl_object_text(w->frame->scene, node->object, name, sizeof name);
    put(w, "%*s%s: %s +", (int)node->level, "", fl_ray_kind_names[node->kind], name);
    put_sum(w, node);
    if (node->light_count)
        put(w, " lights %u/%u", lit, node->light_count);
    put(w, "\n");
}

/* A node and what it spawned, depth first. The tree is at most FL_DEPTH_MAX high. */
static void put_branch(writer *w, uint32_t index)
{
    const fl_raytree *tree = w->tree;
    bool has_children = false;
    for (uint32_t i = index + 1; i < tree->node_count && !has_children; i++)
        has_children = tree->nodes[i].parent == index;
    if (w->is_short)
        put_node_short(w, index);
    else
        put_node(w, index, has_children);
    for (uint32_t i = index + 1; has_children && i < tree->node_count; i++)
        if (tree->nodes[i].parent == index)
            put_branch(w, i);
}

size_t fl_raytree_text(const fl_frame *frame, const fl_raytree *tree, bool is_short, char *out,
                       size_t out_bytes)
{
    writer w = {.frame = frame, .tree = tree, .out = out, .bytes = out_bytes, .is_short = is_short};
    if (out_bytes > 0)
        out[0] = 0;
    put(&w, "pixel %u %u, sample %u:", tree->x, tree->y, tree->sample);
    put_triple(&w, tree->rgb);
    if (!tree->is_valid)
        put(&w, ", not a number: left out");
    if (tree->counts.dropped_branches > 0)
        put(&w, ", %llu branches dropped", (unsigned long long)tree->counts.dropped_branches);
    if (tree->node_count == 0) {
        put(&w, ", traced without streams: its rays are not written down\n");
        return w.length;
    }
    put(&w, is_short ? ", %u rays\n" : ", the sum of %u rays in order of level and path\n",
        tree->node_count);
    put_branch(&w, 0);
    return w.length;
}
