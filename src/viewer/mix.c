/* SPDX-License-Identifier: MIT */
#include "viewer/mix.h"

#include <stdlib.h>

bool vw_mix_is_possible(const fl_compiled *scene)
{
    /* A cube map shines into the second picture too. */
    return !(scene->needs & FL_NEED_CUBE_MAP);
}

static bool begin(fl_render *render, fl_compiled *scene, const fl_params *params,
                  uint64_t *out_generation, fl_diags *diags)
{
    fl_progress progress;
    if (!fl_render_restart(render, scene, params, diags))
        return false;
    fl_render_progress(render, &progress);
    *out_generation = progress.newest_generation;
    return true;
}

bool vw_mix_restart(vw_mix *mix, fl_render *rest, fl_compiled *scene, const fl_params *params,
                    uint32_t light, const fl_render_options *options, fl_diags *diags)
{
    FL_ASSERT(light < params->light_count && params->light_count <= VW_LIGHTS_MAX);
    if (!mix->unit)
        mix->unit = fl_render_create(options, diags);
    if (!mix->unit)
        return false;
    mix->light = light;
    fl_light unit = params->lights[light], others[VW_LIGHTS_MAX];
    fl_params part = *params;
    unit.color = fl_v3(1.0, 1.0, 1.0);
    part.lights = &unit;
    part.light_count = 1;
    part.background = part.ambient = fl_v3(0.0, 0.0, 0.0);
    if (!begin(mix->unit, scene, &part, &mix->generations[1], diags))
        return false;
    part = *params;
    part.lights = others;
    part.light_count = 0;
    for (uint32_t i = 0; i < params->light_count; i++)
        if (i != light)
            others[part.light_count++] = params->lights[i];
    return begin(rest, scene, &part, &mix->generations[0], diags);
}

static bool reserve(vw_mix *mix, size_t pixels)
{
    if (pixels <= mix->pixels)
        return true;
    bool has_all = true;
    float **buffers[] = {&mix->rgb[0], &mix->rgb[1], &mix->samples};
    for (size_t i = 0; i < FL_COUNT_OF(buffers); i++) {
        float *grown = realloc(*buffers[i], pixels * (i < 2 ? 3 : 1) * sizeof *grown);
        has_all &= grown != NULL;
        if (grown)
            *buffers[i] = grown;
    }
    if (has_all)
        mix->pixels = pixels;
    return has_all;
}

/* As in the display of a first sample: the nearest corner that has one (decision 16). */
static void fill_holes(float *rgb, const float *samples, uint32_t width, uint32_t height)
{
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            uint32_t mask = 0;
            while (mask < 7 && !(samples[(size_t)(y & ~mask) * width + (x & ~mask)] > 0.0f))
                mask = 2 * mask + 1;
            const float *from = rgb + 3 * ((size_t)(y & ~mask) * width + (x & ~mask));
            float *to = rgb + 3 * ((size_t)y * width + x);
            for (int c = 0; c < 3 && mask; c++)
                to[c] = from[c];
        }
}

static bool take(vw_mix *mix, fl_render *render, int which, fl_progress *out_progress)
{
    fl_render_mean(render, NULL, 0, out_progress); /* Its size, and what it is of. */
    size_t pixels = (size_t)out_progress->width * out_progress->height;
    if (pixels == 0 || out_progress->generation != mix->generations[which] || !reserve(mix, pixels))
        return false;
    bool has_holes = out_progress->complete_samples == 0;
    /* The samples before the means: what gets a sample in between is filled, never left black. */
    if ((has_holes &&
         !fl_render_copy_map(render, FL_RENDER_SAMPLES, mix->samples, mix->pixels, out_progress)) ||
        !fl_render_mean(render, mix->rgb[which], 3 * mix->pixels, out_progress))
        return false;
    if (has_holes)
        fill_holes(mix->rgb[which], mix->samples, out_progress->width, out_progress->height);
    return true;
}

bool vw_mix_take(vw_mix *mix, fl_render *rest, fl_vec3 color, fl_progress *out_progress)
{
    fl_progress unit;
    if (!take(mix, rest, 0, out_progress) || !take(mix, mix->unit, 1, &unit) ||
        unit.width != out_progress->width || unit.height != out_progress->height)
        return false;
    const float factors[3] = {(float)color.x, (float)color.y, (float)color.z};
    size_t floats = (size_t)3 * unit.width * unit.height;
    for (size_t i = 0; i < floats; i++)
        mix->rgb[0][i] += factors[i % 3] * mix->rgb[1][i];
    if (unit.state == FL_RENDER_RUNNING)
        out_progress->state = unit.state;
    out_progress->complete_samples =
        fl_min_u32(out_progress->complete_samples, unit.complete_samples);
    out_progress->complete_ranks = fl_min_u32(out_progress->complete_ranks, unit.complete_ranks);
    out_progress->mean_samples = fl_min(out_progress->mean_samples, unit.mean_samples);
    return true;
}

void vw_mix_end(vw_mix *mix)
{
    fl_render_destroy(mix->unit);
    free(mix->rgb[0]);
    free(mix->rgb[1]);
    free(mix->samples);
    *mix = (vw_mix){0};
}
