/* SPDX-License-Identifier: MIT
 *
 * The window and the replay of recorded input.
 */
#include <jansson.h>
#include <stdio.h>

#include "cli/commands.h"
#include "cli/json_text.h"
#include "cli/places.h"
#include "viewer/viewer.h"

static bool load(void *context, const char *path, vw_scene *out, fl_diags *diags)
{
    const cli_options *options = context;
    uint32_t quick_above = cli_has(options, CLI_OPT_QUICK_ABOVE) ? options->quick_above : FL_QUICK_ABOVE;
    cli_scene scene = {.diags = diags, .quick_above = quick_above, .files = &out->files};
    bool ok = cli_scene_open(options, path, &scene);
    if (ok) {
        out->scene = scene.scene;
        out->compiled = scene.compiled;
        out->params = scene.params;
        out->samples = scene.state.samples;
        if (scene.state.scene_path)
            snprintf(out->path, sizeof out->path, "%s", scene.path);
        scene.scene = NULL;
        scene.compiled = NULL;
    }
    cli_scene_close(&scene);
    return ok;
}

static uint32_t thread_count(const cli_options *options)
{
    uint32_t count = fl_thread_count(options->threads);
    return cli_has(options, CLI_OPT_LEAVE_CORE) && count > 1 ? count - 1 : count;
}

static vw_options viewer_options(const cli_options *options)
{
    return (vw_options){.loader = {.context = (void *)(uintptr_t)options, .load = load},
                        .platform = options->platform,
                        .shader_dir = options->shader_dir,
                        .record_path = options->record,
                        .keys_path = options->keys,
                        .pin_path = options->pin,
                        .thread_count = thread_count(options),
                        .is_low_priority = true,
                        .is_size_fixed = cli_has(options, CLI_OPT_SIZE),
                        .is_quiet = cli_has(options, CLI_OPT_QUIET),
                        .limits = {.samples = options->samples, .noise_rmse = options->noise, .seconds = options->time_s},
                        .was_interrupted = cli_was_interrupted};
}

int cli_command_view(const cli_options *options)
{
    if (options->path_count > 1)
        return cli_usage_error(CLI_VIEW, "expected one scene, got %u", options->path_count);
    vw_options viewer = viewer_options(options);
    char default_scene[PATH_MAX];
    cli_data_find("scenes/vase.txt", default_scene);
    viewer.has_own_keys = true;
    viewer.scene_path = options->path_count ? options->paths[0] : default_scene;
    fl_diags diags = {0};
    cli_catch_signals();
    vw_run(&viewer, &diags);
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    if (code == CLI_DONE && cli_was_interrupted())
        code = CLI_INTERRUPTED;
    fl_diags_deinit(&diags);
    return code;
}

static json_t *latency_json(const vw_latency *latency)
{
    return json_pack("{s:f, s:f, s:f}", "p50", latency->p50, "p95", latency->p95, "p99", latency->p99);
}

/* False: the line of JSON could not be made. */
static bool print_report(const cli_options *options, const vw_replay_report *report)
{
    if (!cli_has(options, CLI_OPT_JSON)) {
        if (cli_has(options, CLI_OPT_QUIET))
            return true;
        printf("%zu inputs changed the picture; ms to the first picture p50 %.1f p95 %.1f p99 %.1f, to a full sample "
               "p50 %.1f p95 %.1f p99 %.1f, to cancel p99 %.2f\n",
               report->input_count, report->first.p50, report->first.p95, report->first.p99, report->full.p50,
               report->full.p95, report->full.p99, report->cancel.p99);
        return true;
    }
    json_t *snapshots = json_array();
    for (size_t i = 0; i < report->snapshot_count; i++)
        json_array_append_new(snapshots, json_pack("{s:o, s:s, s:i}", "file", cli_json_text(report->snapshots[i].file), "film_sha256",
                                                   report->snapshots[i].film_sha256, "samples",
                                                   (int)report->snapshots[i].samples));
    json_t *line = json_pack("{s:{s:o, s:o, s:o}, s:I, s:o, s:b}", "latency_ms", "first", latency_json(&report->first), "full",
                             latency_json(&report->full), "cancel", latency_json(&report->cancel), "inputs",
                             (json_int_t)report->input_count, "snapshots", snapshots, "interrupted",
                             (int)cli_was_interrupted());
    return cli_json_print(line, 6);
}

int cli_command_replay(const cli_options *options)
{
    if (options->path_count != 1)
        return cli_usage_error(CLI_REPLAY, "expected one log, got %u", options->path_count);
    vw_options viewer = viewer_options(options);
    vw_replay_report report = {0};
    fl_diags diags = {0};
    cli_catch_signals();
    bool is_done = vw_replay_run(&viewer, options->paths[0], !cli_has(options, CLI_OPT_QUIET), &report, &diags);
    bool is_printed = true;
    if (is_done || (cli_was_interrupted() && !diags.error_count)) /* then as far as it came */
        is_printed = print_report(options, &report);
    cli_print_diags(&diags);
    int code = is_printed ? cli_exit_code(&diags) : CLI_ENVIRONMENT;
    if (code == CLI_DONE && cli_was_interrupted())
        code = CLI_INTERRUPTED;
    vw_replay_report_deinit(&report);
    fl_diags_deinit(&diags);
    return code;
}
