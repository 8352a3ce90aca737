/* SPDX-License-Identifier: MIT */
#include "core/pipeline.h"

#include <math.h>
#include <string.h>

#include "core/double_path.h"
#include "core/pipeline_work.h"
#include "core/texture.h"

const char *const fl_cost_names[FL_COST_COUNT] = {"generate", "nearest",    "resolve",
                                                  "material", "light",      "occlude",
                                                  "spawn",    "accumulate", "film"};

static void add_isect(fl_isect_counts *sum, const fl_isect_counts *part)
{
    sum->node_visits += part->node_visits;
    sum->primitive_tests += part->primitive_tests;
}

void fl_counts_add(fl_counts *sum, const fl_counts *part)
{
    sum->samples += part->samples;
    sum->invalid_samples += part->invalid_samples;
    sum->camera_rays += part->camera_rays;
    sum->shadow_rays += part->shadow_rays;
    sum->reflect_rays += part->reflect_rays;
    sum->refract_rays += part->refract_rays;
    sum->dropped_branches += part->dropped_branches;
    sum->stopped_shadow_rays += part->stopped_shadow_rays;
    sum->sample_dimensions += part->sample_dimensions;
    sum->texture_lookups += part->texture_lookups;
    add_isect(&sum->isect, &part->isect);
    add_isect(&sum->occlude, &part->occlude);
}

static void put3(fl_array3 a, uint32_t i, const float v[3])
{
    a.x[i] = v[0];
    a.y[i] = v[1];
    a.z[i] = v[2];
}

static void clear3(fl_array3 a, uint32_t count)
{
    memset(a.x, 0, count * sizeof(float));
    memset(a.y, 0, count * sizeof(float));
    memset(a.z, 0, count * sizeof(float));
}

/* Rays that hit nothing see the background and leave the stream. */
static void take_misses(fl_pipe *pipe)
{
    fl_stage *stage = &pipe->work->stage;
    const fl_frame *frame = pipe->frame;
    const fl_vec3 color = frame->params.background;
    const float background[3] = {(float)color.x, (float)color.y, (float)color.z};
    bool has_cube = frame->scene->cube[0] != NULL;
    for (uint32_t i = 0; i < stage->rays.count; i++) {
        if (stage->hits.object[i] != FL_NONE)
            continue;
        float d[3] = {stage->rays.dx[i], stage->rays.dy[i], stage->rays.dz[i]}, rgb[3];
        if (has_cube)
            fl_cube_eval(frame->scene->cube, d, frame->params.exact.course_cube, rgb);
        put3(pipe->work->glow, i, has_cube ? rgb : background);
    }
    stage->rays.count = pipe->shade->keep_hits(stage);
    fl_rays_pad(&stage->rays);
    fl_hits_pad(&stage->hits, stage->rays.count);
}

static void tell(const fl_pipe *pipe, fl_moment moment, uint32_t light, uint32_t j)
{
    const fl_witness *witness = pipe->work->witness;
    if (witness)
        witness->see(witness->context, pipe, moment, light, j);
}

static void add_arrivals(const fl_shadow *shadow, fl_array3 sum)
{
    for (uint32_t i = 0; i < shadow->rays.count; i++) {
        uint32_t at = shadow->at[i];
        sum.x[at] += shadow->arrives.x[i];
        sum.y[at] += shadow->arrives.y[i];
        sum.z[at] += shadow->arrives.z[i];
    }
}

/* Samples of a light that are summed before they go to the radiance: sums of more lose digits. */
enum { LIGHT_BLOCK = 1024 };

/* Adds `part` divided by `samples` to `sum`, and leaves in it what rounding lost, for the next
 * block. [Kahan 1965] */
static void move_mean(float *sum, float *part, float samples, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        float mean = part[i] / samples, rounded = sum[i] + mean;
        part[i] = (mean - (rounded - sum[i])) * samples;
        sum[i] = rounded;
    }
}

/* Lights in scene order; each sends the mean of its samples. False: cancelled. */
static bool add_lights(fl_pipe *pipe)
{
    fl_workspace *work = pipe->work;
    fl_stage *stage = &work->stage;
    const fl_frame *frame = pipe->frame;
    uint32_t count = stage->rays.count;
    for (uint32_t l = 0; l < frame->light_count; l++) {
        const fl_frame_light *light = &frame->lights[l];
        if (light->is_dark)
            continue;
        fl_array3 sum = light->samples > 1 ? work->lit : stage->radiance;
        if (light->samples > 1)
            clear3(work->lit, count);
        for (uint32_t j = 0; j < light->samples; j++) {
            pipe->shade->light(frame, light, pipe->unit->sample, j, stage, &work->shadow);
            if (fl_is_cancelled(&pipe->context))
                return false;
            pipe->counts.sample_dimensions += light->draws ? 2u * (uint64_t)count : 0;
            tell(pipe, FL_AT_LIGHT, l, j);
            if (frame->plan.has_shadows && work->shadow.rays.count > 0) {
                fl_pipe_lap(pipe, FL_COST_LIGHT);
                pipe->counts.shadow_rays += work->shadow.rays.count;
                if (!fl_pipe_occlude(pipe))
                    return false;
                fl_pipe_lap(pipe, FL_COST_OCCLUDE);
            }
            tell(pipe, FL_AT_SHADOW, l, j);
            add_arrivals(&work->shadow, sum);
            bool ends_block = j + 1 == light->samples || (j + 1) % LIGHT_BLOCK == 0;
            if (light->samples > 1 && ends_block) {
                float samples = (float)light->samples;
                move_mean(stage->radiance.x, work->lit.x, samples, count);
                move_mean(stage->radiance.y, work->lit.y, samples, count);
                move_mean(stage->radiance.z, work->lit.z, samples, count);
            }
        }
    }
    fl_pipe_lap(pipe, FL_COST_LIGHT);
    return true;
}

/* Radiance of the whole stream, weighted, to the unit's samples, in order of the stream. */
static void accumulate(fl_pipe *pipe, uint32_t count)
{
    fl_workspace *work = pipe->work;
    fl_stage *stage = &work->stage;
    fl_unit_result *result = &work->result;
    for (uint32_t i = 0; i < stage->rays.count; i++) {
        const float rgb[3] = {stage->radiance.x[i], stage->radiance.y[i], stage->radiance.z[i]};
        put3(work->glow, stage->entry[i], rgb);
    }
    tell(pipe, FL_AT_RADIANCE, 0, 0);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t slot = work->slot[i];
        result->r[slot] += work->throughput.x[i] * work->glow.x[i];
        result->g[slot] += work->throughput.y[i] * work->glow.y[i];
        result->b[slot] += work->throughput.z[i] * work->glow.z[i];
    }
}

/* Everything for the rays now in the stage. False: cancelled. */
static bool run_stream(fl_pipe *pipe, bool may_spawn)
{
    fl_workspace *work = pipe->work;
    fl_stage *stage = &work->stage;
    const fl_compiled *scene = pipe->frame->scene;
    uint32_t count = stage->rays.count;
    fl_rays_pad(&stage->rays);
    fl_pipe_lap(pipe, FL_COST_GENERATE);
    pipe->isect->nearest(&scene->geometry, &stage->rays, &stage->hits, &pipe->context);
    fl_pipe_lap(pipe, FL_COST_NEAREST);
    if (fl_is_cancelled(&pipe->context))
        return false;
    tell(pipe, FL_AT_HITS, 0, 0);
    take_misses(pipe);
    fl_pipe_lap(pipe, FL_COST_MATERIAL);
    if (stage->rays.count > 0) {
        const uint8_t *needs_uv = pipe->frame->plan.has_textures ? scene->object_needs_uv : NULL;
        pipe->isect->resolve(&scene->geometry, &stage->rays, &stage->hits, needs_uv,
                             &stage->surface, &pipe->context);
        fl_pipe_lap(pipe, FL_COST_RESOLVE);
        if (fl_is_cancelled(&pipe->context))
            return false;
        bool has_branches =
            pipe->shade->material(pipe->frame, stage, &pipe->counts.texture_lookups);
        pipe->shade->orient(pipe->frame, stage);
        fl_pipe_lap(pipe, FL_COST_MATERIAL);
        tell(pipe, FL_AT_SURFACES, 0, 0);
        if (fl_is_cancelled(&pipe->context) || !add_lights(pipe))
            return false;
        if (has_branches && may_spawn)
            pipe->shade->spawn(pipe->frame, stage, work->throughput, work->slot, &work->next);
        fl_pipe_lap(pipe, FL_COST_SPAWN);
    }
    accumulate(pipe, count);
    fl_pipe_lap(pipe, FL_COST_ACCUMULATE);
    return !fl_is_cancelled(&pipe->context);
}

static void load_branches(fl_pipe *pipe, uint32_t begin, uint32_t count)
{
    fl_workspace *work = pipe->work;
    const fl_branches *from = &work->current;
    fl_stage *stage = &work->stage;
    fl_rays *rays = &stage->rays;
    float *const numbers[FL_BRANCH_NUMBERS] = {
        rays->ox, rays->oy,           rays->oz,           rays->dx,          rays->dy,
        rays->dz, work->throughput.x, work->throughput.y, work->throughput.z};
    uint32_t *const words[FL_BRANCH_REFRACTED] = {rays->source_object, rays->source_prim,
                                                  stage->path, work->slot, stage->pixel};
    for (int k = 0; k < FL_BRANCH_NUMBERS; k++)
        memcpy(numbers[k], from->number[k] + begin, count * sizeof(float));
    for (int k = 0; k < FL_BRANCH_REFRACTED; k++)
        memcpy(words[k], from->word[k] + begin, count * sizeof(uint32_t));
    uint32_t refracted = 0;
    for (uint32_t i = 0; i < count; i++) {
        rays->t_max[i] = INFINITY;
        refracted += from->word[FL_BRANCH_REFRACTED][begin + i];
    }
    pipe->counts.refract_rays += refracted;
    pipe->counts.reflect_rays += count - refracted;
    rays->count = count;
    stage->is_camera = false;
}

static void load_camera(fl_pipe *pipe, uint32_t begin, uint32_t count)
{
    static const float one[3] = {1.0f, 1.0f, 1.0f};
    fl_workspace *work = pipe->work;
    pipe->shade->generate(pipe->frame, pipe->unit, begin, count, &work->stage);
    for (uint32_t i = 0; i < count; i++) {
        put3(work->throughput, i, one);
        work->slot[i] = begin + i;
    }
    pipe->counts.camera_rays += count;
    pipe->counts.sample_dimensions += (uint64_t)count * pipe->frame->plan.dimensions;
}

/* All rays of one level, in pieces. False: cancelled or out of memory. */
static bool run_level(fl_pipe *pipe, uint32_t level, bool *out_of_memory)
{
    fl_workspace *work = pipe->work;
    const fl_frame_plan *plan = &pipe->frame->plan;
    uint32_t count = level == 0 ? pipe->unit->count : work->current.count;
    bool may_spawn =
        (plan->has_reflection || plan->has_refraction) && level < pipe->frame->params.depth_limit;
    for (uint32_t begin = 0; begin < count; begin += FL_STREAM_RAYS) {
        uint32_t part = fl_min_u32(count - begin, FL_STREAM_RAYS);
        if (may_spawn && !fl_branches_reserve(&work->next, 2 * part)) {
            *out_of_memory = true;
            return false;
        }
        if (level == 0)
            load_camera(pipe, begin, part);
        else
            load_branches(pipe, begin, part);
        if (!run_stream(pipe, may_spawn))
            return false;
    }
    return true;
}

/* NaN and infinities stay out of the film (design rule 6). */
static void check_samples(fl_pipe *pipe)
{
    fl_unit_result *result = &pipe->work->result;
    for (uint32_t i = 0; i < pipe->unit->count; i++) {
        bool is_valid = isfinite(result->r[i]) && isfinite(result->g[i]) && isfinite(result->b[i]);
        result->is_valid[i] = is_valid;
        if (!is_valid) {
            result->r[i] = result->g[i] = result->b[i] = 0.0f;
            pipe->counts.invalid_samples++;
        }
    }
    pipe->counts.samples += pipe->unit->count;
}

static const fl_shade_kernels *shade_kernels(fl_isa isa)
{
    static const fl_shade_kernels *const table[FL_ISA_COUNT] = FL_ISA_TABLE(fl_shade_kernels);
    FL_ASSERT(table[isa]);
    return table[isa];
}

bool fl_pipeline_run(const fl_frame *frame, const fl_unit *unit, fl_workspace *workspace,
                     const atomic_uint_least64_t *generation, uint64_t wanted, fl_counts *counts,
                     bool *out_of_memory)
{
    FL_ASSERT(unit->count <= FL_UNIT_PIXELS);
    *out_of_memory = false;
    if (frame->params.precision == FL_PRECISION_DOUBLE)
        return fl_double_run(frame, unit, &workspace->result, generation, wanted, counts);
    fl_pipe pipe = {
        .frame = frame,
        .unit = unit,
        .work = workspace,
        .isect = fl_isect_kernels_of(frame->scene->isa),
        .shade = shade_kernels(frame->scene->isa),
        .context = {.solver = frame->params.solver, .generation = generation, .wanted = wanted},
        .lap = fl_ticks(),
    };
    fl_unit_result *result = &workspace->result;
    *out_of_memory =
        (frame->params.transparent_shadows && !fl_workspace_reserve_through(workspace)) ||
        (frame->scene->needs & FL_NEED_REVOLUTIONS && !fl_workspace_reserve_roots(workspace));
    if (*out_of_memory || fl_is_cancelled(&pipe.context))
        return false;
    clear3((fl_array3){result->r, result->g, result->b}, unit->count);
    workspace->next.count = 0;
    for (uint32_t level = 0; level == 0 || workspace->current.count > 0; level++) {
        if (!run_level(&pipe, level, out_of_memory))
            return false;
        pipe.counts.dropped_branches += fl_branches_settle(&workspace->next);
        fl_branches swapped = workspace->current;
        workspace->current = workspace->next;
        workspace->next = swapped;
        workspace->next.count = 0;
        fl_pipe_lap(&pipe, FL_COST_SPAWN);
    }
    check_samples(&pipe);
    fl_pipe_lap(&pipe, FL_COST_ACCUMULATE);
    pipe.counts.isect = pipe.context.counts;
    fl_counts_add(counts, &pipe.counts);
    return true;
}
