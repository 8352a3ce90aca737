/* SPDX-License-Identifier: MIT */
#include "extremes/extreme_kit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bytes/world.h"

static void print_diags(const fl_diags *diags)
{
    for (uint32_t i = 0; i < diags->count; i++)
        fprintf(stderr, "extremes: %s\n", diags->items[i].message);
}

fl_scene *film_parse(const char *text, const char *name)
{
    fl_diags diags = {0};
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), name, &(fl_parse_options){0}, &test_world, &diags);
    if (!scene)
        print_diags(&diags);
    fl_diags_deinit(&diags);
    return scene;
}

fl_params film_params(const test_scene *test, const fl_scene *scene)
{
    fl_params params;
    fl_params_from_scene(&params, scene, test->is_exact);
    params.width = test->width;
    params.height = test->height;
    params.sampler = test->sampler;
    params.solver = test->solver;
    params.precision = test->is_double ? FL_PRECISION_DOUBLE : FL_PRECISION_FLOAT;
    params.light_samples = test->lens_points;
    params.crop_x = test->crop[0];
    params.crop_y = test->crop[1];
    params.crop_w = test->crop[2];
    params.crop_h = test->crop[3];
    return params;
}

static bool read_film(film *out, fl_render *render, const fl_params *params)
{
    fl_progress progress;
    size_t floats = (size_t)params->width * params->height * 3;
    out->rgb = malloc(floats * sizeof *out->rgb);
    if (!out->rgb || !fl_render_mean(render, out->rgb, floats, &progress))
        return false;
    out->width = progress.width;
    out->height = progress.height;
    out->counts = progress.counts;
    return true;
}

bool film_render(film *out, const fl_scene *scene, const fl_params *params, uint32_t samples)
{
    fl_diags diags = {0};
    memset(out, 0, sizeof *out);
    fl_compiled *compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, &diags);
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = 2}, &diags);
    bool ok = compiled && render;
    if (ok) {
        fl_render_set_limits(render, &(fl_render_limits){.samples = samples});
        ok = fl_render_restart(render, compiled, params, &diags) && fl_render_wait(render, -1.0) &&
             read_film(out, render, params);
    }
    fl_render_destroy(render);
    fl_compiled_release(compiled);
    if (!ok) {
        print_diags(&diags);
        film_free(out);
    }
    fl_diags_deinit(&diags);
    return ok;
}

void film_free(film *f)
{
    free(f->rgb);
    memset(f, 0, sizeof *f);
}

uint32_t film_differ(const film *a, const film *b, double tolerance, double *out_largest)
{
    uint32_t count = 0;
    *out_largest = 0.0;
    for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
        double largest = 0.0;
        for (size_t c = 3 * i; c < 3 * i + 3; c++) {
            double x = (double)a->rgb[c], y = (double)b->rgb[c];
            double off = fabs(x - y) / fmax(1.0, fabs(y));
            largest = off <= largest ? largest : off; /* NaN too */
        }
        count += largest <= tolerance ? 0 : 1;
        *out_largest = largest <= *out_largest ? *out_largest : largest;
    }
    return count;
}
