/* SPDX-License-Identifier: MIT
 *
 * The window and the replay of recorded input.
 */
#include <jansson.h>
#include <stdio.h>
#include <unistd.h>

#include "cli/commands.h"
#include "viewer/viewer.h"

/* What opens when no scene is named: beside the program's data, or in a checkout. */
static const char *default_scene(void)
{
    static const char *const places[] = {"scenes/vase.txt", FL_DATA_DIR "/scenes/vase.txt"};
    for (size_t i = 0; i < FL_COUNT_OF(places); i++)
        if (access(places[i], R_OK) == 0)
            return places[i];
    return places[0];
}

static bool load(void *context, const char *path, vw_scene *out, fl_diags *diags)
{
    const cli_options *options = context;
    uint32_t quick_above = cli_has(options, CLI_OPT_QUICK_ABOVE) ? options->quick_above : FL_QUICK_ABOVE;
    cli_scene scene = {.diags = diags, .quick_above = quick_above};
    bool ok = cli_scene_open(options, path, &scene);
    if (ok) {
        *out = (vw_scene){.scene = scene.scene,
                          .compiled = scene.compiled,
                          .params = scene.params,
                          .samples = scene.state.samples};
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
    viewer.has_own_keys = true;
    viewer.scene_path = options->path_count ? options->paths[0] : default_scene();
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

static void print_report(const cli_options *options, const vw_replay_report *report)
{
    if (!cli_has(options, CLI_OPT_JSON)) {
        printf("%zu inputs changed the picture; ms to the first picture p50 %.1f p95 %.1f p99 %.1f, to a full sample "
               "p50 %.1f p95 %.1f p99 %.1f, to cancel p99 %.2f\n",
               report->input_count, report->first.p50, report->first.p95, report->first.p99, report->full.p50,
               report->full.p95, report->full.p99, report->cancel.p99);
        return;
    }
    json_t *snapshots = json_array();
    for (size_t i = 0; i < report->snapshot_count; i++)
        json_array_append_new(snapshots, json_pack("{s:s, s:s, s:i}", "file", report->snapshots[i].file, "film_sha256",
                                                   report->snapshots[i].film_sha256, "samples",
                                                   (int)report->snapshots[i].samples));
    json_t *line = json_pack("{s:{s:o, s:o, s:o}, s:I, s:o}", "latency_ms", "first", latency_json(&report->first), "full",
                             latency_json(&report->full), "cancel", latency_json(&report->cancel), "inputs",
                             (json_int_t)report->input_count, "snapshots", snapshots);
    json_dumpf(line, stdout, JSON_COMPACT | JSON_REAL_PRECISION(6));
    putchar('\n');
    json_decref(line);
}

int cli_command_replay(const cli_options *options)
{
    if (options->path_count != 1)
        return cli_usage_error(CLI_REPLAY, "expected one log, got %u", options->path_count);
    vw_options viewer = viewer_options(options);
    vw_replay_report report = {0};
    fl_diags diags = {0};
    cli_catch_signals();
    if (vw_replay_run(&viewer, options->paths[0], !cli_has(options, CLI_OPT_QUIET), &report, &diags))
        print_report(options, &report);
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    vw_replay_report_deinit(&report);
    fl_diags_deinit(&diags);
    return code;
}
