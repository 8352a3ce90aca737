/* SPDX-License-Identifier: MIT
 *
 * Pictures to files. A snapshot is ordered, and made when the samples that had begun are whole
 * (decision 068).
 */
#include <stdlib.h>
#include <string.h>

#include "io/image_file.h"
#include "io/state_text.h"
#include "viewer/session.h"

float *vw_session_mean(vw_session *session, fl_progress *out_progress, fl_diags *diags)
{
    float *rgb = NULL;
    size_t floats = 0;
    /* Asked first for its size: the picture to show may not be the one being rendered. */
    while (!fl_render_mean(session->render, rgb, floats, out_progress)) {
        floats = (size_t)out_progress->width * out_progress->height * 3;
        free(rgb);
        rgb = floats ? malloc(floats * sizeof *rgb) : NULL;
        if (rgb)
            continue;
        if (floats)
            fl_out_of_memory(diags, "the snapshot");
        else
            fl_environment_error(diags, "there is no picture yet");
        return NULL;
    }
    bool is_exact = session->exact_samples > 0 && out_progress->state == FL_RENDER_DONE;
    if (is_exact && out_progress->is_adaptive)
        out_progress->mean_samples = session->exact_samples;
    return rgb;
}

static uint8_t *tonemapped(const vw_session *session, const vw_state *state, const float *rgb,
                           size_t pixels)
{
    uint8_t *bytes = malloc(pixels * 4);
    if (!bytes)
        return NULL;
    fl_tonemap tonemap = vw_session_tonemap(session, state);
    fl_tonemap_rgba8(&tonemap, rgb, pixels, bytes);
    for (size_t i = 0; i < pixels; i++)
        memmove(bytes + 3 * i, bytes + 4 * i, 3);
    return bytes;
}

/* `state`: that of the picture, which may be past. */
static bool save(const vw_session *session, const vw_state *state, const char *path,
                 const float *rgb, const fl_progress *progress, fl_diags *diags)
{
    fl_pixel_format format;
    if (!fl_image_format_for(path, diags, &format))
        return false;
    size_t pixels = (size_t)progress->width * progress->height;
    fl_params params;
    vw_state_params(state, &session->scene.params, &params);
    const fl_scene *scene = session->scene.scene;
    fl_state_texts texts;
    fl_state_texts_fill(&texts, session->scene_path, scene, &params, progress, rgb);
    fl_image image = {.width = progress->width, .height = progress->height, .format = format};
    uint8_t *bytes = NULL;
    if (format == FL_PIXEL_FLOAT) {
        image.pixels = (void *)(uintptr_t)rgb;
    } else {
        image.pixels = bytes = tonemapped(session, state, rgb, pixels);
        if (!bytes)
            return fl_out_of_memory(diags, "the snapshot");
    }
    bool is_saved = fl_image_save(path, &image, texts.items, FL_COUNT_OF(texts.items), diags);
    free(bytes);
    return is_saved;
}

bool vw_session_save(const vw_session *session, const char *path, const float *rgb,
                     const fl_progress *progress, fl_diags *diags)
{
    return save(session, &session->state, path, rgb, progress, diags);
}

/* How many samples the picture of the latest restart ends with if nothing more begins. */
static uint32_t begun_samples(fl_render *render)
{
    fl_progress progress;
    fl_render_progress(render, &progress);
    bool is_latest = progress.generation == progress.newest_generation;
    return is_latest ? fl_max_u32(progress.begun_samples, 1) : 1;
}

void vw_session_order_snapshot(vw_session *session)
{
    session->ordered = session->state;
    session->exact_samples = 0;
    /* Until the limit holds, more may begin. */
    for (uint32_t begun; (begun = begun_samples(session->render)) > session->exact_samples;) {
        session->exact_samples = begun;
        vw_session_set_limits(session);
    }
}

void vw_session_hurry_order(vw_session *session)
{
    fl_progress progress;
    fl_render_progress(session->render, &progress);
    if (!progress.is_adaptive)
        return;
    uint32_t soon = fl_max_u32((uint32_t)ceil(progress.mean_samples), 1);
    session->exact_samples = fl_min_u32(session->exact_samples, soon);
    vw_session_set_limits(session);
}

bool vw_session_has_ordered(const vw_session *session)
{
    const fl_progress *progress = &session->progress;
    return session->exact_samples > 0 && progress->state == FL_RENDER_DONE &&
           progress->generation == progress->newest_generation;
}

void vw_session_end_order(vw_session *session)
{
    session->exact_samples = 0;
    vw_session_set_limits(session);
    fl_render_progress(session->render, &session->progress); /* It may go on now. */
}

bool vw_session_save_ordered(vw_session *session, const char *path, fl_progress *out_progress,
                             fl_diags *diags)
{
    float *rgb = vw_session_mean(session, out_progress, diags);
    bool is_saved = rgb && save(session, &session->ordered, path, rgb, out_progress, diags);
    free(rgb);
    vw_session_end_order(session);
    return is_saved;
}
