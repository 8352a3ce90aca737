/* SPDX-License-Identifier: MIT */
#include <jansson.h>
#include <stdio.h>

#include "cli/commands.h"
#include "cli/aov.h"
#include "cli/noise.h"
#include "io/image_file.h"

static json_t *forecast_json(const fl_progress *progress, double target)
{
    cli_forecast f;
    if (!cli_forecast_read(progress, target, &f))
        return json_pack("{s:f, s:n, s:n, s:n}", "rmse", target, "seconds", "low", "high");
    return json_pack("{s:f, s:f, s:f, s:f}", "rmse", target, "seconds", f.seconds, "low", f.low, "high", f.high);
}

/* One line for programs: the keys are binding (docs/cli.md). */
static void print_json(const cli_scene *scene, const cli_picture *picture, double target, const fl_noise_split *noise)
{
    const fl_progress *p = &picture->progress;
    const fl_counts *c = &p->counts;
    json_t *needs = json_array();
    for (uint32_t i = 0; i < FL_NEED_COUNT; i++)
        if (scene->compiled->needs >> i & 1u)
            json_array_append_new(needs, json_string(fl_need_names[i]));
    json_t *rmse = p->error.is_known ? json_pack("{s:f, s:f, s:f}", "estimate", p->error.rmse, "low", p->error.low,
                                                 "high", p->error.high)
                                     : json_pack("{s:n, s:n, s:n}", "estimate", "low", "high");
    json_t *costs = json_object();
    for (uint32_t i = 0; i < FL_COST_COUNT; i++)
        json_object_set_new(costs, fl_cost_names[i], json_real(p->cost_seconds[i]));
    json_t *line = json_pack(
        "{s:s, s:i, s:i, s:i, s:i, s:f, s:f, s:f, s:f, s:o, s:{s:I, s:I, s:I, s:I}, s:o, s:I, s:I, s:o, s:s, s:s, s:b, s:s, s:f}", "scene",
        scene->path, "width", (int)picture->width, "height", (int)picture->height, "samples", (int)cli_picture_samples(picture),
        "light_samples", (int)scene->params.light_samples,
        "seconds", p->seconds, "cpu_seconds", p->cpu_seconds, "first_picture_seconds", p->first_picture_seconds,
        "first_sample_seconds", p->first_sample_seconds, "stage_seconds", costs, "rays", "camera", (json_int_t)c->camera_rays, "shadow",
        (json_int_t)c->shadow_rays, "reflect", (json_int_t)c->reflect_rays, "refract", (json_int_t)c->refract_rays,
        "rmse", rmse, "invalid_samples", (json_int_t)c->invalid_samples, "dropped_branches",
        (json_int_t)c->dropped_branches, "needs", needs, "isa", fl_isa_name(scene->compiled->isa), "precision",
        scene->params.precision == FL_PRECISION_DOUBLE ? "double" : "float", "interrupted",
        (int)picture->was_interrupted, "film_sha256", picture->film_sha256,
        "load_seconds", scene->load_seconds);
    if (line)
        json_object_set_new(line, "forecast", forecast_json(p, target));
    if (line && picture->refined_seconds > 0.0)
        json_object_set_new(line, "refined_seconds", json_real(picture->refined_seconds));
    if (line && p->is_adaptive)
        json_object_update_new(line, json_pack("{s:b, s:f}", "adaptive", 1, "mean_samples", p->mean_samples));
    if (line && noise)
        json_object_set_new(line, "noise", cli_noise_json(noise));
    if (line) {
        json_dumpf(line, stdout, JSON_COMPACT | JSON_REAL_PRECISION(9));
        putchar('\n');
    }
    json_decref(line);
}

static void print_summary(const cli_picture *picture, double target)
{
    const fl_progress *p = &picture->progress;
    const fl_counts *c = &p->counts;
    double rays = (double)(c->camera_rays + c->shadow_rays + c->reflect_rays + c->refract_rays);
    printf("%ux%u, %u samples in %.2f s (first picture %.3f s, first full sample %.3f s), %.1f Mray/s", picture->width,
           picture->height, cli_picture_samples(picture), p->seconds, p->first_picture_seconds, p->first_sample_seconds,
           p->seconds > 0.0 ? rays / p->seconds * 1e-6 : 0.0);
    if (p->error.is_known)
        printf(", error about %.4f (%.4f to %.4f)", p->error.rmse, p->error.low, p->error.high);
    cli_forecast forecast;
    if (cli_forecast_read(p, target, &forecast) && forecast.rmse < p->error.rmse)
        printf("; %.3g %% would take about %.3g s (%.3g to %.3g)", 100.0 * target, forecast.seconds, forecast.low,
               forecast.high);
    if (c->invalid_samples)
        printf(", %llu INVALID samples dropped", (unsigned long long)c->invalid_samples);
    if (c->dropped_branches)
        printf(", %llu branches dropped", (unsigned long long)c->dropped_branches);
    putchar('\n');
}

/* Refuse names that no format has before an hour of rendering, not after. */
static bool outputs_are_writable(const cli_options *options, fl_diags *diags)
{
    fl_pixel_format format;
    for (uint32_t i = 0; i < options->output_count; i++)
        if (!fl_image_format_for(options->outputs[i], diags, &format))
            return false;
    return true;
}

int cli_command_render(const cli_options *options)
{
    if (options->path_count != 1)
        return cli_usage_error(CLI_RENDER, "expected one scene, got %u", options->path_count);
    if (!options->output_count && !cli_has(options, CLI_OPT_JSON))
        return cli_usage_error(CLI_RENDER, "nowhere to write: give -o IMAGE or --json");
    cli_catch_signals();
    fl_diags diags = {0};
    cli_scene scene = {.diags = &diags, .quick_above = options->quick_above};
    cli_picture picture = {0};
    cli_aovs aovs;
    if (outputs_are_writable(options, &diags) && cli_aov_parse(options->aov, &aovs, &diags) &&
        cli_scene_open(options, options->paths[0], &scene)) {
        fl_render_limits limits = {.samples = cli_sample_limit(options, &scene),
                                   .noise_rmse = options->noise,
                                   .seconds = options->time_s};
        bool is_quiet = cli_has(options, CLI_OPT_QUIET);
        cli_picture_plan plan = {.threads = options->threads,
                                 .progress_name = is_quiet ? NULL : scene.path,
                                 .maps = aovs.maps,
                                 .checkpoint = options->checkpoint};
        if (cli_picture_render(&scene, &limits, &plan, &picture)) {
            bool ok = true;
            for (uint32_t i = 0; i < options->output_count; i++)
                ok = cli_picture_save(&picture, &scene, options->outputs[i], &diags) && ok;
            if (options->aov && options->output_count)
                ok = cli_aov_save(&scene, &picture, &aovs, options->outputs[0], &diags) && ok;
            double target = options->noise > 0.0 ? options->noise : CLI_FORECAST_RMSE;
            fl_noise_split split, *noise = NULL;
            if (cli_has(options, CLI_OPT_NOISE_SPLIT) && !picture.was_interrupted &&
                cli_noise_measure(scene.compiled, &scene.params, is_quiet ? NULL : scene.path, &split, &diags))
                noise = &split;
            if (cli_has(options, CLI_OPT_JSON))
                print_json(&scene, &picture, target, noise);
            else if (!is_quiet)
                print_summary(&picture, target);
            if (noise && !is_quiet && !cli_has(options, CLI_OPT_JSON))
                cli_noise_print(noise, "");
        }
    }
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    if (code == CLI_DONE && picture.was_interrupted)
        code = CLI_INTERRUPTED;
    cli_picture_close(&picture);
    cli_scene_close(&scene);
    fl_diags_deinit(&diags);
    return code;
}
