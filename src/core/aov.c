/* SPDX-License-Identifier: MIT */
#include "core/aov.h"

#include <math.h>

#include "core/raytree.h"
#include "core/texture.h"
#include "core/trace_piece.h"

enum { PIECE_RAYS = 1024 };

const char *const fl_aov_names[FL_AOV_COUNT] = {"depth", "normal", "albedo", "object",
                                                "shape", "cost",   "branch"};

/* Absolute coordinates of the pixel that value i of the grid stands for. */
static void pixel_of(const fl_frame *frame, const fl_aov_grid *grid, size_t i, uint32_t *out_x,
                     uint32_t *out_y)
{
    uint32_t x = grid->x0 + (uint32_t)(i % grid->width) * grid->step + grid->step / 2;
    uint32_t y = grid->y0 + (uint32_t)(i / grid->width) * grid->step + grid->step / 2;
    *out_x = frame->x0 + fl_min_u32(x, frame->width - 1);
    *out_y = frame->y0 + fl_min_u32(y, frame->height - 1);
}

static void albedo_of(const fl_compiled *scene, const fl_piece *p, uint32_t i, float out_rgb[3])
{
    const fl_shader *shader = &scene->shaders[scene->object_shader[p->hits.object[i]]];
    float texel[3] = {1.0f, 1.0f, 1.0f};
    if (shader->texture != FL_NONE)
        fl_texture_eval(&scene->textures[shader->texture], p->surface.u[i], p->surface.v[i], texel);
    for (int c = 0; c < 3; c++)
        out_rgb[c] = shader->diffuse[c] * texel[c];
}

/* The shading normal on the viewer's side; returns how squarely the surface is seen, 0 to 1. */
static float facing_normal(const fl_piece *p, uint32_t i, float out_normal[3])
{
    const fl_surface *s = &p->surface;
    const fl_rays *r = &p->rays;
    float side = s->ngx[i] * r->dx[i] + s->ngy[i] * r->dy[i] + s->ngz[i] * r->dz[i];
    float sign = side > 0.0f ? -1.0f : 1.0f;
    out_normal[0] = sign * s->nsx[i];
    out_normal[1] = sign * s->nsy[i];
    out_normal[2] = sign * s->nsz[i];
    float length = sqrtf(r->dx[i] * r->dx[i] + r->dy[i] * r->dy[i] + r->dz[i] * r->dz[i]);
    float cosine =
        -(out_normal[0] * r->dx[i] + out_normal[1] * r->dy[i] + out_normal[2] * r->dz[i]) / length;
    return cosine < 0.0f ? 0.0f : cosine > 1.0f ? 1.0f : cosine;
}

static void write_value(const fl_frame *frame, fl_aov kind, const fl_piece *p, uint32_t i,
                        float out[3])
{
    bool is_hit = p->hits.object[i] != FL_NONE;
    out[0] = out[1] = out[2] = kind == FL_AOV_DEPTH && !is_hit ? INFINITY : 0.0f;
    if (!is_hit)
        return;
    float normal[3], facing;
    switch (kind) {
    case FL_AOV_DEPTH: /* d . w = 1 */
        out[0] = out[1] = out[2] = p->hits.t[i];
        break;
    case FL_AOV_NORMAL:
        facing_normal(p, i, out);
        break;
    case FL_AOV_ALBEDO:
        albedo_of(frame->scene, p, i, out);
        break;
    case FL_AOV_OBJECT:
        out[0] = (float)(p->hits.object[i] + 1);
        out[1] = (float)p->hits.prim[i];
        break;
    case FL_AOV_SHAPE:
        albedo_of(frame->scene, p, i, out);
        facing = facing_normal(p, i, normal);
        for (int c = 0; c < 3; c++)
            out[c] = (0.1f + 0.9f * facing) * (0.15f + 0.85f * out[c]);
        break;
    case FL_AOV_COST:
    case FL_AOV_BRANCH:
    case FL_AOV_COUNT:
        break;
    }
}

static bool eval_hits(const fl_frame *frame, fl_aov kind, const double lens[2],
                      const fl_aov_grid *grid, float *out_values)
{
    const fl_compiled *scene = frame->scene;
    const fl_isect_kernels *kernels = fl_isect_kernels_of(scene->isa);
    fl_isect_context context = {.solver = frame->params.solver};
    bool wants_surface = kind != FL_AOV_DEPTH && kind != FL_AOV_OBJECT;
    size_t count = (size_t)grid->width * grid->height;
    fl_piece p = {0};
    if (!fl_piece_init(&p, PIECE_RAYS))
        return false;
    for (size_t begin = 0; begin < count; begin += PIECE_RAYS) {
        uint32_t n = count - begin < PIECE_RAYS ? (uint32_t)(count - begin) : PIECE_RAYS;
        for (uint32_t i = 0; i < n; i++) {
            uint32_t x, y;
            fl_vec3 origin, direction;
            pixel_of(frame, grid, begin + i, &x, &y);
            fl_frame_ray(frame, x + 0.5, y + 0.5, lens ? lens[0] : 0.0, lens ? lens[1] : 0.0,
                         &origin, &direction);
            fl_rays_set(&p.rays, i, origin, direction, INFINITY);
        }
        fl_piece_set_count(&p.rays, n);
        kernels->nearest(&scene->geometry, &p.rays, &p.hits, &context);
        for (uint32_t i = n; i % 8 != 0; i++)
            p.hits.object[i] = FL_NONE;
        if (wants_surface)
            kernels->resolve(&scene->geometry, &p.rays, &p.hits, scene->object_needs_uv, &p.surface,
                             &context);
        for (uint32_t i = 0; i < n; i++)
            write_value(frame, kind, &p, i, out_values + 3 * (begin + i));
    }
    fl_piece_deinit(&p);
    return true;
}

/* The renderer itself, a pixel at a time, with its own counters. */
static bool eval_cost(const fl_frame *frame, const fl_aov_grid *grid, float *out_values)
{
    fl_workspace *workspace = fl_workspace_create();
    size_t count = (size_t)grid->width * grid->height;
    bool is_fine = workspace != NULL;
    for (size_t i = 0; i < count && is_fine; i++) {
        uint32_t x, y;
        pixel_of(frame, grid, i, &x, &y);
        uint16_t px = (uint16_t)x, py = (uint16_t)y;
        fl_unit unit = {.x = &px, .y = &py, .count = 1};
        fl_counts counts = {0};
        bool out_of_memory = false;
        is_fine = fl_pipeline_run(frame, &unit, workspace, NULL, 0, &counts, &out_of_memory);
        float *out = out_values + 3 * i;
        out[0] = (float)(counts.camera_rays + counts.shadow_rays + counts.reflect_rays +
                         counts.refract_rays);
        out[1] = (float)counts.isect.node_visits;
        out[2] = (float)counts.isect.primitive_tests;
    }
    fl_workspace_destroy(workspace);
    return is_fine;
}

/* Likewise, watched. */
static bool eval_branch(const fl_frame *frame, const fl_aov_grid *grid, float *out_values)
{
    fl_raytree tree = {0};
    size_t count = (size_t)grid->width * grid->height;
    bool is_fine = true;
    for (size_t i = 0; i < count && is_fine; i++) {
        uint32_t x, y;
        pixel_of(frame, grid, i, &x, &y);
        is_fine = fl_raytree_trace(frame, x, y, 0, &tree);
        if (!is_fine)
            break;
        uint32_t heaviest = fl_raytree_heaviest(&tree);
        float *out = out_values + 3 * i;
        out[0] = heaviest == FL_NONE ? 0.0f : (float)tree.nodes[heaviest].kind + 1.0f;
        out[1] = heaviest == FL_NONE ? 0.0f : (float)tree.nodes[heaviest].level;
        out[2] = tree.node_count ? (float)tree.nodes[tree.node_count - 1].level : 0.0f;
    }
    fl_raytree_deinit(&tree);
    return is_fine;
}

bool fl_aov_eval(const fl_frame *frame, fl_aov kind, const double lens[2], const fl_aov_grid *grid,
                 float *out_values)
{
    FL_ASSERT(grid->step > 0 && kind < FL_AOV_COUNT);
    if (kind == FL_AOV_COST)
        return eval_cost(frame, grid, out_values);
    if (kind == FL_AOV_BRANCH)
        return eval_branch(frame, grid, out_values);
    return eval_hits(frame, kind, lens, grid, out_values);
}
