/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "cli/commands.h"
#include "cli/json_text.h"
#include "cli/noise.h"
#include "cli/outputs.h"
#include "io/image_file.h"

static json_t *forecast_json(const fl_progress *progress, double target)
{
    cli_forecast f;
    if (!cli_forecast_read(progress, target, &f))
        return json_pack("{s:f, s:n, s:n, s:n}", "rmse", target, "seconds", "low", "high");
    return json_pack("{s:f, s:f, s:f, s:f}", "rmse", target, "seconds", f.seconds, "low", f.low, "high", f.high);
}

/* One line for programs, which rely on its keys. False: for want of memory. */
static bool print_json(const cli_scene *scene, const cli_picture *picture, double target, const fl_noise_split *noise)
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
        "{s:o, s:i, s:i, s:i, s:i, s:f, s:f, s:f, s:f, s:o, s:{s:I, s:I, s:I, s:I}, s:o, s:I, s:I, s:I, s:o, s:s, s:s, s:b, s:s, s:f}", "scene",
        cli_json_text(scene->path), "width", (int)picture->width, "height", (int)picture->height, "samples", (int)cli_picture_samples(picture),
        "light_samples", (int)scene->params.light_samples,
        "seconds", p->seconds, "cpu_seconds", p->cpu_seconds, "first_picture_seconds", p->first_picture_seconds,
        "first_sample_seconds", p->first_sample_seconds, "stage_seconds", costs, "rays", "camera", (json_int_t)c->camera_rays, "shadow",
        (json_int_t)c->shadow_rays, "reflect", (json_int_t)c->reflect_rays, "refract", (json_int_t)c->refract_rays,
        "rmse", rmse, "invalid_samples", (json_int_t)c->invalid_samples, "dropped_branches",
        (json_int_t)c->dropped_branches, "stopped_shadow_rays", (json_int_t)c->stopped_shadow_rays, "needs", needs, "isa", fl_isa_name(scene->compiled->isa), "precision",
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
    return cli_json_print(line, 9);
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
    if (c->stopped_shadow_rays)
        printf(", %llu shadow rays stopped after %d surfaces", (unsigned long long)c->stopped_shadow_rays,
               FL_SHADOW_SURFACES_MAX);
    putchar('\n');
}

/* A render on its way. Zero-initialise. */
typedef struct job {
    const cli_options *options;
    cli_aovs aovs;
    cli_outputs outputs;
    cli_scene scene;
    cli_picture picture;
    fl_diags diags;
} job;

static bool save_pictures(job *j)
{
    bool ok = true;
    for (uint32_t i = 0; i < j->options->output_count; i++)
        ok = cli_picture_save(&j->picture, &j->scene, j->options->outputs[i], &j->diags) && ok;
    if (j->options->aov)
        ok = cli_aov_save(&j->scene, &j->picture, &j->aovs, j->options->outputs[0], &j->diags) && ok;
    return ok;
}

/* The scene is open. False after adding an error, or having said what went wrong. */
static bool run(job *j)
{
    const cli_options *options = j->options;
    bool is_quiet = cli_has(options, CLI_OPT_QUIET), is_json = cli_has(options, CLI_OPT_JSON);
    fl_render_limits limits = {.samples = cli_sample_limit(options, &j->scene),
                               .noise_rmse = options->noise,
                               .seconds = options->time_s};
    cli_picture_plan plan = {.threads = options->threads,
                             .progress_name = is_quiet ? NULL : j->scene.path,
                             .maps = j->aovs.maps,
                             .checkpoint = options->checkpoint};
    if (!cli_picture_render(&j->scene, &limits, &plan, &j->picture))
        return j->picture.was_interrupted;
    save_pictures(j);
    double target = options->noise > 0.0 ? options->noise : CLI_FORECAST_RMSE;
    fl_noise_split split, *noise = NULL;
    if (cli_has(options, CLI_OPT_NOISE_SPLIT) && !j->picture.was_interrupted &&
        cli_noise_measure(j->scene.compiled, &j->scene.params, plan.progress_name, &split, &j->diags))
        noise = &split;
    if (is_json)
        return print_json(&j->scene, &j->picture, target, noise);
    if (!is_quiet)
        print_summary(&j->picture, target);
    if (noise && !is_quiet)
        cli_noise_print(noise, "");
    return true;
}

/* Refuse names that no format has. */
static bool has_formats(const cli_options *options, fl_diags *diags)
{
    fl_pixel_format format;
    for (uint32_t i = 0; i < options->output_count; i++)
        if (!fl_image_format_for(options->outputs[i], diags, &format))
            return false;
    return true;
}

/* Everything that needs no scene, then those outputs that the scene itself reads. CLI_DONE: go on, if no error was added. */
static int prepare(job *j)
{
    const cli_options *options = j->options;
    if (!has_formats(options, &j->diags))
        return CLI_WRONG_USAGE;
    if (!cli_outputs_list(options, &j->aovs, &j->outputs, &j->diags))
        return CLI_DONE;
    const char *twice = cli_outputs_twice(&j->outputs);
    if (twice)
        return cli_usage_error(CLI_RENDER, "'%s' would be written twice", twice);
    if (!cli_outputs_check(&j->outputs, &j->diags) || !cli_scene_open(options, options->paths[0], &j->scene))
        return CLI_DONE;
    const char *input = cli_outputs_over_input(&j->outputs, &j->scene);
    return input ? cli_usage_error(CLI_RENDER, "'%s' would be written over, and the scene reads it", input) : CLI_DONE;
}

int cli_command_render(const cli_options *options)
{
    if (options->path_count != 1)
        return cli_usage_error(CLI_RENDER, "expected one scene, got %u", options->path_count);
    if (!options->output_count && !cli_has(options, CLI_OPT_JSON))
        return cli_usage_error(CLI_RENDER, "nowhere to write: give -o IMAGE or --json");
    cli_catch_signals();
    job j = {.options = options};
    j.scene = (cli_scene){.diags = &j.diags, .quick_above = options->quick_above};
    char message[CLI_MESSAGE_BYTES];
    if (!cli_aov_parse(options->aov, &j.aovs, message))
        return cli_usage_error(CLI_RENDER, "%s", message);
    int code = prepare(&j);
    bool ok = true;
    if (code == CLI_DONE && !j.diags.error_count)
        ok = run(&j);
    cli_print_diags(&j.diags);
    if (code == CLI_DONE)
        code = ok || j.diags.error_count ? cli_exit_code(&j.diags) : CLI_ENVIRONMENT;
    if (code == CLI_DONE && cli_was_interrupted())
        code = CLI_INTERRUPTED;
    cli_picture_close(&j.picture);
    cli_scene_close(&j.scene);
    cli_outputs_deinit(&j.outputs);
    fl_diags_deinit(&j.diags);
    return code;
}
