/* SPDX-License-Identifier: MIT */
#include "cli/picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/checkpoint_file.h"
#include "io/image_file.h"

bool cli_forecast_read(const fl_progress *progress, double target_rmse, cli_forecast *out)
{
    fl_error_forecast samples;
    if (progress->mean_samples <= 0.0 || !fl_error_predict(&progress->error, target_rmse, &samples))
        return false;
    double pace = progress->seconds / progress->mean_samples;
    *out = (cli_forecast){target_rmse, pace * samples.samples, pace * samples.low, pace * samples.high};
    return true;
}

/* One line, rewritten in place, on a terminal only. */
static void show_progress(const char *name, const fl_progress *progress, const fl_render_limits *limits, bool is_refining)
{
    double share = 0.0;
    if (limits->samples)
        share = progress->mean_samples / limits->samples;
    if (limits->seconds > 0.0)
        share = fl_max(share, progress->seconds / limits->seconds);
    cli_forecast forecast;
    double target = limits->noise_rmse > 0.0 ? limits->noise_rmse : CLI_FORECAST_RMSE;
    bool is_forecast = cli_forecast_read(progress, target, &forecast);
    if (is_forecast && limits->noise_rmse > 0.0)
        share = fl_max(share, progress->seconds / forecast.seconds);
    double left = share > 0.0 ? progress->seconds * (1.0 - share) / share : 0.0;
    fprintf(stderr, "\r%s: %5.1f samples, %3.0f %%, %.0f s left", name, progress->mean_samples, 100.0 * share, left);
    if (progress->error.is_known)
        fprintf(stderr, ", error %.4f", progress->error.rmse);
    if (is_forecast && forecast.seconds > progress->seconds)
        fprintf(stderr, "; %.3g %% after about %.3g s (%.3g to %.3g)", 100.0 * target, forecast.seconds, forecast.low,
                forecast.high);
    fputs(is_refining ? "; refining the hierarchy" : "\033[K", stderr);
    fflush(stderr);
}

/* Where a render is kept meanwhile; path NULL: nowhere. */
typedef struct checkpoint {
    const char *path;
    char key[FL_CHECKPOINT_KEY_BYTES];
    double next_s; /* When to keep it again, in seconds of rendering. */
} checkpoint;

/* Seconds of rendering between two checkpoints: what a power cut may cost. */
static const double keep_every_s = 60.0;

/* Seconds that an interrupted render may take to bring all pixels to the same number of samples: the picture is then
 * the one of so many, to the bit. */
static const double even_out_s = 1.0;

static bool keep(fl_render *render, checkpoint *kept, fl_diags *diags)
{
    void *data;
    size_t bytes;
    if (!kept->path)
        return true;
    bool is_kept = fl_render_checkpoint(render, &data, &bytes, diags) &&
                   (!data || fl_checkpoint_save(kept->path, kept->key, data, bytes, diags));
    free(data);
    return is_kept;
}

/* Begin, or go on where the checkpoint ends. */
static bool begin(fl_render *render, cli_scene *scene, checkpoint *kept)
{
    char *file = NULL;
    const void *data = NULL;
    size_t bytes = 0;
    if (kept->path && scene->params.is_adaptive)
        return fl_error(scene->diags, (fl_loc){0}, "a checkpoint cannot keep adaptive sampling: leave out one of the two");
    if (kept->path && (!fl_checkpoint_key(scene->scene, &scene->params, kept->key, scene->diags) ||
                         !fl_checkpoint_load(kept->path, kept->key, &file, &data, &bytes, scene->diags)))
        return false;
    bool has_begun = data ? fl_render_resume(render, scene->compiled, &scene->params, data, bytes, scene->diags)
                          : fl_render_restart(render, scene->compiled, &scene->params, scene->diags);
    free(file);
    return has_begun;
}

/* Called by the thread that refines. Without memory for it the render goes on as it is. */
static void go_on_with(void *render, fl_compiled *refined)
{
    fl_diags diags = {0};
    if (refined)
        fl_render_replace_scene(render, refined, &diags);
    fl_diags_deinit(&diags);
}

/* Let go of the quick hierarchies once there are better ones. */
static void take_refined(fl_refine *refine, cli_scene *scene, cli_picture *out)
{
    fl_compiled *refined = refine ? fl_refine_take(refine) : NULL;
    if (!refined)
        return;
    fl_compiled_release(scene->compiled);
    scene->compiled = refined;
    out->refined_seconds = out->progress.seconds;
}

/* False: out of memory, or after adding an error. */
static bool render_until_done(fl_render *render, const fl_render_limits *limits, const char *progress_name,
                              checkpoint *kept, fl_refine *refine, cli_scene *scene, cli_picture *out)
{
    fl_diags *diags = scene->diags;
    bool shows = progress_name && isatty(STDERR_FILENO), has_shown = false, is_kept = true;
    while (is_kept && !fl_render_wait(render, 0.1)) {
        fl_render_progress(render, &out->progress);
        take_refined(refine, scene, out);
        if (out->progress.state == FL_RENDER_FAILED)
            break;
        if (cli_was_interrupted()) {
            out->was_interrupted = true;
            fl_render_set_limits(render, &(fl_render_limits){.samples = fl_max_u32(out->progress.begun_samples, 1)});
            fl_render_wait(render, even_out_s);
            fl_render_set_paused(render, true);
            break;
        }
        if (shows && out->progress.seconds > 1.0) {
            show_progress(progress_name, &out->progress, limits, fl_refine_is_busy(refine));
            has_shown = true;
        }
        if (kept->path && out->progress.seconds >= kept->next_s) {
            kept->next_s = out->progress.seconds + keep_every_s;
            is_kept = keep(render, kept, diags);
        }
    }
    if (has_shown)
        fputc('\n', stderr);
    fl_render_progress(render, &out->progress);
    if (out->progress.state == FL_RENDER_FAILED)
        return fl_out_of_memory(diags, "rendering");
    if (is_kept)
        keep(render, kept, diags); /* If it cannot be kept, the picture is still saved. */
    return true;
}

/* The maps asked for, one float a pixel. */
static bool take_maps(fl_render *render, uint32_t maps, cli_picture *out, fl_diags *diags)
{
    size_t pixels = (size_t)out->width * out->height;
    for (uint32_t map = 0; map < CLI_MAP_COUNT; map++) {
        if (!(maps >> map & 1u))
            continue;
        out->maps[map] = malloc(pixels * sizeof(float));
        if (!out->maps[map] || !fl_render_copy_map(render, (fl_render_map)map, out->maps[map], pixels, &out->progress))
            return fl_out_of_memory(diags, "the maps of the picture");
    }
    return true;
}

static bool take_picture(fl_render *render, cli_picture *out, fl_diags *diags)
{
    out->width = out->progress.width;
    out->height = out->progress.height;
    size_t floats;
    if (!fl_size_mul((size_t)out->width * 3, out->height, &floats) ||
        !(out->rgb = malloc(floats * sizeof *out->rgb)))
        return fl_out_of_memory(diags, "the picture");
    if (!fl_render_mean(render, out->rgb, floats, &out->progress)) {
        if (out->was_interrupted) {
            fl_note(diags, (fl_loc){0}, "interrupted before the first sample: there is nothing to save");
            return false;
        }
        return fl_environment_error(diags, "nothing was rendered");
    }
    fl_digest_sha256(out->rgb, floats * sizeof *out->rgb, out->film_sha256);
    return true;
}

bool cli_picture_render(cli_scene *scene, const fl_render_limits *limits, const cli_picture_plan *plan,
                        cli_picture *out)
{
    *out = (cli_picture){0};
    fl_render_options options = {.thread_count = plan->threads};
    fl_render *render = fl_render_create(&options, scene->diags);
    if (!render)
        return false;
    fl_render_set_limits(render, limits);
    checkpoint kept = {.path = plan->checkpoint, .next_s = keep_every_s};
    fl_refine *refine = NULL;
    bool ok = begin(render, scene, &kept);
    if (ok && scene->compiled->is_quick)
        ok = (refine = fl_refine_start(scene->compiled, plan->threads, go_on_with, render, scene->diags)) != NULL;
    ok = ok && render_until_done(render, limits, plan->progress_name, &kept, refine, scene, out);
    fl_refine_destroy(refine);
    if (ok)
        ok = take_picture(render, out, scene->diags) && take_maps(render, plan->maps, out, scene->diags);
    fl_render_destroy(render);
    if (!ok)
        cli_picture_close(out);
    return ok;
}

uint32_t cli_picture_samples(const cli_picture *picture)
{
    const fl_progress *p = &picture->progress;
    return p->is_adaptive ? (uint32_t)(p->mean_samples + 0.5) : p->complete_samples;
}

void cli_picture_close(cli_picture *picture)
{
    free(picture->rgb);
    picture->rgb = NULL;
    for (uint32_t map = 0; map < CLI_MAP_COUNT; map++) {
        free(picture->maps[map]);
        picture->maps[map] = NULL;
    }
}

uint8_t *cli_picture_bytes(const cli_picture *picture, const fl_params *params, fl_diags *diags)
{
    size_t pixels = (size_t)picture->width * picture->height;
    uint8_t *rgba = malloc(pixels * 4);
    if (!rgba) {
        fl_out_of_memory(diags, "the picture");
        return NULL;
    }
    fl_tonemap tonemap = {.exposure_ev = params->camera.exposure_ev, .truncates = params->exact.truncate_bytes};
    fl_tonemap_rgba8(&tonemap, picture->rgb, pixels, rgba);
    for (size_t i = 0; i < pixels; i++) { /* drop alpha in place */
        rgba[3 * i] = rgba[4 * i];
        rgba[3 * i + 1] = rgba[4 * i + 1];
        rgba[3 * i + 2] = rgba[4 * i + 2];
    }
    return rgba;
}

bool cli_picture_save(const cli_picture *picture, const cli_scene *scene, const char *path, fl_diags *diags)
{
    fl_pixel_format format;
    if (!fl_image_format_for(path, diags, &format))
        return false;
    fl_state_texts texts;
    fl_state_texts_fill(&texts, scene->path, scene->scene, &scene->params, &picture->progress, picture->rgb);
    fl_image image = {.width = picture->width, .height = picture->height, .format = format};
    uint8_t *bytes = NULL;
    if (format == FL_PIXEL_FLOAT) {
        image.pixels = picture->rgb;
    } else {
        bytes = cli_picture_bytes(picture, &scene->params, diags);
        if (!bytes)
            return false;
        image.pixels = bytes;
    }
    bool ok = fl_image_save(path, &image, texts.items, FL_COUNT_OF(texts.items), diags);
    free(bytes);
    return ok;
}
