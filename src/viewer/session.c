/* SPDX-License-Identifier: MIT */
#include "viewer/session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t sample_cap(const vw_session *session)
{
    uint32_t samples = session->options->limits.samples;
    if (samples)
        return samples;
    return session->scene.samples ? session->scene.samples : VW_SAMPLES_DEFAULT;
}

/* What was opened, and the scene in it. The path may be session->source_path itself. */
static bool set_paths(vw_session *session, const char *path, const vw_scene *scene, fl_diags *diags)
{
    size_t bytes = strlen(path) + 1;
    if (bytes > sizeof session->source_path)
        return fl_error(diags, (fl_loc){0}, "the scene's path is longer than %d bytes",
                        VW_PATH_MAX - 1);
    memmove(session->source_path, path, bytes);
    snprintf(session->scene_path, sizeof session->scene_path, "%s",
             scene->path[0] ? scene->path : session->source_path);
    return true;
}

/* Once the scene is there: its state, its bookmarks. Errors in bookmarks are no reason to stop. */
static void begin_scene(vw_session *session, fl_diags *diags)
{
    session->state.follows_window = !session->options->is_size_fixed && !session->scene.samples;
    vw_state_init(&session->state, &session->scene.params, session->scene.compiled,
                  sample_cap(session));
    vw_history_begin(&session->history, &session->state, true);
    if (!vw_bookmarks_load(&session->bookmarks, session->scene_path, session->scene.scene, diags)) {
        vw_session_take_error(session, diags);
        diags->error_count = 0;
    }
}

static bool load_keys(vw_session *session, fl_diags *diags)
{
    const vw_options *options = session->options;
    if (!options->keys_path && !options->has_own_keys)
        return true;
    session->keymap = malloc(sizeof *session->keymap);
    if (!session->keymap)
        return fl_out_of_memory(diags, "the keys");
    vw_keymap_init(session->keymap);
    session->state.keymap = session->keymap;
    return vw_keymap_load(session->keymap, options->keys_path, diags);
}

bool vw_session_open(vw_session *session, const vw_options *options, const char *scene_path,
                     uint32_t width, uint32_t height, fl_diags *diags)
{
    *session = (vw_session){.options = options};
    session->state.width = width;
    session->state.height = height;
    if (!load_keys(session, diags))
        return false;
    if (!options->loader.load(options->loader.context, scene_path, &session->scene, diags) ||
        !set_paths(session, scene_path, &session->scene, diags))
        return false;
    begin_scene(session, diags);
    return !options->pin_path || vw_show_load_pin(session, options->pin_path, diags);
}

static fl_render_options render_options(const vw_session *session)
{
    return (fl_render_options){.thread_count = session->options->thread_count,
                               .is_low_priority = session->options->is_low_priority,
                               .smooths_display = true,
                               .notify = session->notify,
                               .notify_context = session->notify_context};
}

/* --- Refining -------------------------------------------------------------------------------- */

static void wake_owner(void *context, fl_compiled *refined)
{
    const vw_session *session = context;
    (void)refined;
    if (session->notify)
        session->notify(session->notify_context);
}

/* What cannot be started is no reason to stop: the quick hierarchies do. */
static void begin_refining(vw_session *session)
{
    if (!session->scene.compiled->is_quick)
        return;
    fl_diags diags = {0};
    session->refine = fl_refine_start(session->scene.compiled, session->options->thread_count,
                                      wake_owner, session, &diags);
    session->state.is_refining = session->refine != NULL;
    fl_diags_deinit(&diags);
}

static void end_refining(vw_session *session)
{
    fl_refine_destroy(session->refine);
    session->refine = NULL;
    session->state.is_refining = false;
}

bool vw_session_take_refined(vw_session *session)
{
    if (!session->refine || fl_refine_is_busy(session->refine))
        return false;
    fl_compiled *refined = fl_refine_take(session->refine);
    end_refining(session);
    if (!refined)
        return true;
    fl_diags diags = {0}; /* Where memory is short a picture goes on as it is; the next will not. */
    fl_render_replace_scene(session->render, refined, &diags);
    if (session->mix.unit)
        fl_render_replace_scene(session->mix.unit, refined, &diags);
    fl_diags_deinit(&diags);
    fl_compiled_release(session->scene.compiled);
    session->scene.compiled = refined;
    return true;
}

bool vw_session_start(vw_session *session, void (*notify)(void *context), void *notify_context,
                      fl_diags *diags)
{
    session->notify = notify;
    session->notify_context = notify_context;
    fl_render_options render = render_options(session);
    session->render = fl_render_create(&render, diags);
    if (!session->render)
        return false;
    vw_session_set_limits(session);
    begin_refining(session);
    return true;
}

void vw_session_close(vw_session *session)
{
    end_refining(session);
    fl_render_destroy(session->render);
    vw_mix_end(&session->mix);
    vw_show_deinit(&session->show);
    vw_insight_deinit(&session->insight);
    vw_scene_deinit(&session->scene);
    free(session->rgba);
    free(session->backdrop);
    free(session->keymap);
    free(session->error_text);
    *session = (vw_session){0};
}

fl_tonemap vw_session_tonemap(const vw_session *session, const vw_state *state)
{
    return (fl_tonemap){.exposure_ev = state->look.camera.exposure_ev,
                        .truncates = session->scene.params.exact.truncate_bytes};
}

/* The mix stays on the screen until there is something of the whole: what the render shows till
 * then lacks a light. It is taken as seen. */
static void forget_parts(vw_session *session)
{
    fl_progress progress;
    vw_mix_end(&session->mix);
    fl_tonemap tonemap = vw_session_tonemap(session, &session->state);
    uint8_t *unseen = malloc(session->rgba_bytes);
    uint64_t revision = 0;
    if (unseen &&
        fl_render_display(session->render, &revision, &tonemap, unseen, session->rgba_bytes,
                          &progress) &&
        progress.generation < progress.newest_generation)
        session->revision = revision;
    free(unseen);
}

/* A third of the light in a rectangle (x, y, width, height). */
static void dim(uint8_t *rgba, uint32_t row_pixels, const uint32_t rect[4])
{
    for (uint32_t y = rect[1]; y < rect[1] + rect[3]; y++)
        for (size_t i = 4 * ((size_t)y * row_pixels + rect[0]), end = i + (size_t)4 * rect[2];
             i < end; i++)
            rgba[i] = i % 4 == 3 ? 255 : rgba[i] / 3;
}

/* A region begins: keep what is around it, dimmed. Memory is no reason to fail: it is only shown.
 */
static void keep_backdrop(vw_session *session)
{
    const vw_state *state = &session->state;
    uint32_t rect[4], width = state->picture_width, height = state->picture_height;
    if (!vw_state_region(state, rect)) {
        free(session->backdrop);
        session->backdrop = NULL;
        return;
    }
    uint32_t *last = session->backdrop_rect;
    bool is_kept =
        session->backdrop && session->backdrop_width == width && session->backdrop_height == height;
    /* Another region: the last one's picture becomes part of what is around it. */
    if (is_kept && memcmp(last, rect, sizeof rect) != 0)
        dim(session->backdrop, width, last);
    memcpy(last, rect, sizeof rect);
    if (is_kept)
        return;
    free(session->backdrop);
    session->backdrop = calloc((size_t)width * height, 4);
    session->backdrop_width = width;
    session->backdrop_height = height;
    bool has_whole = session->progress.width == width && session->progress.height == height &&
                     session->revision != 0;
    if (!session->backdrop)
        return;
    if (has_whole)
        memcpy(session->backdrop, session->rgba, (size_t)width * height * 4);
    dim(session->backdrop, width, (const uint32_t[4]){0, 0, width, height});
}

const uint8_t *vw_session_window(vw_session *session, uint32_t *out_width, uint32_t *out_height)
{
    const uint8_t *shown = vw_session_shown(session);
    uint32_t rect[4];
    *out_width = session->progress.width;
    *out_height = session->progress.height;
    if (!session->backdrop || !vw_state_region(&session->state, rect) || rect[2] != *out_width ||
        rect[3] != *out_height || session->backdrop_width < rect[0] + rect[2] ||
        session->backdrop_height < rect[1] + rect[3])
        return shown;
    *out_width = session->backdrop_width;
    *out_height = session->backdrop_height;
    for (uint32_t y = 0; y < rect[3]; y++)
        memcpy(session->backdrop + 4 * ((size_t)(rect[1] + y) * *out_width + rect[0]),
               shown + (size_t)4 * y * rect[2], (size_t)4 * rect[2]);
    return session->backdrop;
}

void vw_session_note_asked(vw_session *session)
{
    const vw_state *state = &session->state;
    session->asked = (vw_asked){.is_known = !state->is_mixing,
                                .look = state->look,
                                .width = state->picture_width,
                                .height = state->picture_height};
}

bool vw_session_is_asked(const vw_session *session)
{
    const vw_state *state = &session->state;
    const vw_asked *asked = &session->asked;
    vw_look look = asked->look;
    look.sample_cap = state->look.sample_cap;
    look.camera.exposure_ev = state->look.camera.exposure_ev;
    if (look.camera.aperture == 0.0) /* Then the focus changes no pixel. */
        look.camera.focus = state->look.camera.focus;
    return asked->is_known && !state->is_mixing && session->progress.state != FL_RENDER_FAILED &&
           vw_look_is_same(&look, &state->look) && asked->width == state->picture_width &&
           asked->height == state->picture_height;
}

bool vw_session_restart(vw_session *session, fl_diags *diags)
{
    keep_backdrop(session);
    session->asked.is_known = false;
    fl_params params;
    vw_state_params(&session->state, &session->scene.params, &params);
    session->show.is_asked = false;
    if (session->state.is_mixing) {
        fl_render_options options = render_options(session);
        bool is_begun = vw_mix_restart(&session->mix, session->render, session->scene.compiled,
                                       &params, session->state.light, &options, diags);
        vw_session_set_limits(session);
        return is_begun;
    }
    if (!fl_render_restart(session->render, session->scene.compiled, &params, diags))
        return false;
    vw_session_note_asked(session);
    if (session->mix.unit)
        forget_parts(session);
    return true;
}

bool vw_session_end_mix(vw_session *session)
{
    bool was_mixing = session->state.is_mixing;
    session->state.is_mixing = false;
    return was_mixing;
}

void vw_session_set_limits(vw_session *session)
{
    fl_render_limits limits = session->options->limits;
    limits.samples = session->state.look.sample_cap;
    if (session->exact_samples)
        limits = (fl_render_limits){.samples = session->exact_samples};
    bool rests = session->state.is_paused || session->state.is_hidden;
    fl_render *const renders[] = {session->render, session->mix.unit};
    for (size_t i = 0; i < FL_COUNT_OF(renders) && renders[i]; i++) {
        fl_render_set_limits(renders[i], &limits);
        fl_render_set_paused(renders[i], rests && !session->exact_samples);
    }
}

static bool load(vw_session *session, const char *path, bool is_again, fl_diags *diags)
{
    vw_scene scene = {0};
    if (!session->options->loader.load(session->options->loader.context, path, &scene, diags)) {
        vw_scene_deinit(&scene);
        return false;
    }
    return vw_session_adopt(session, path, &scene, is_again, diags);
}

bool vw_session_load(vw_session *session, const char *path, fl_diags *diags)
{
    return load(session, path, false, diags);
}

bool vw_session_reload(vw_session *session, fl_diags *diags)
{
    return load(session, session->source_path, true, diags);
}

bool vw_session_adopt(vw_session *session, const char *path, vw_scene *scene, bool is_again,
                      fl_diags *diags)
{
    /* A picture that is opened by hand is where it was taken, be it open already. */
    bool is_same = strcmp(path, session->source_path) == 0 && (is_again || !scene->path[0]);
    if (!set_paths(session, path, scene, diags)) {
        vw_scene_deinit(scene);
        return false;
    }
    end_refining(session);
    vw_scene_deinit(&session->scene);
    session->scene = *scene;
    session->state.is_mixing = false;
    session->show.is_asked = false;
    session->asked.is_known = false;
    if (is_same) {
        vw_look before = session->state.start;
        vw_state_rebase(&session->state, &scene->params, scene->compiled, sample_cap(session));
        vw_history_rebase(&session->history, &session->state, &before);
        vw_bookmarks_take_scene(&session->bookmarks, scene->scene);
    } else {
        begin_scene(session, diags);
    }
    if (session->render)
        begin_refining(session);
    return true;
}

static bool reserve_bytes(vw_session *session, size_t bytes, fl_diags *diags)
{
    if (bytes <= session->rgba_bytes)
        return true;
    uint8_t *rgba = realloc(session->rgba, bytes);
    if (!rgba)
        return fl_out_of_memory(diags, "the picture");
    session->rgba = rgba;
    session->rgba_bytes = bytes;
    return true;
}

static bool refresh_mix(vw_session *session, fl_diags *diags)
{
    fl_progress progress;
    vw_mix *mix = &session->mix;
    fl_vec3 color = session->state.look.lights[mix->light].color;
    if (!vw_mix_take(mix, session->render, color, &progress))
        return false;
    size_t pixels = (size_t)progress.width * progress.height;
    if (!reserve_bytes(session, 4 * pixels, diags))
        return false;
    fl_tonemap tonemap = vw_session_tonemap(session, &session->state);
    fl_tonemap_rgba8(&tonemap, mix->rgb[0], pixels, session->rgba);
    session->progress = progress;
    session->revision = 1; /* Not 0: there is a picture. */
    return true;
}

static bool is_newer(vw_session *session)
{
    fl_tonemap tonemap = vw_session_tonemap(session, &session->state);
    return fl_render_display(session->render, &session->revision, &tonemap, session->rgba,
                             session->rgba_bytes, &session->progress);
}

/* Newer bytes of the picture, with room made for them. */
static bool refresh_picture(vw_session *session, fl_diags *diags)
{
    if (session->mix.unit)
        return refresh_mix(session, diags);
    if (is_newer(session))
        return true;
    size_t needed = (size_t)session->progress.width * session->progress.height * 4;
    return needed > session->rgba_bytes && reserve_bytes(session, needed, diags) &&
           is_newer(session);
}

bool vw_session_refresh(vw_session *session, fl_diags *diags)
{
    bool is_changed = vw_session_take_refined(session);
    is_changed |= refresh_picture(session, diags);
    if (!session->show.is_asked)
        vw_show_ask(session, diags);
    is_changed |= vw_show_take(session);
    is_changed |= vw_insight_follow(session, false, diags);
    is_changed |= session->show.is_stale;
    session->show.is_stale = false;
    /* Before the first picture there is nothing to compose. */
    return is_changed && session->revision != 0 && vw_show_compose(session, diags);
}

bool vw_session_is_full_sample_new(const vw_session *session)
{
    return session->progress.complete_samples == 0 &&
           fl_render_has_sample(session->render, session->progress.generation) &&
           (!session->mix.unit ||
            fl_render_has_sample(session->mix.unit, session->mix.generations[1]));
}

void vw_session_clear_error(vw_session *session)
{
    free(session->error_text);
    session->error_text = NULL;
    session->state.has_error = false;
}

void vw_session_take_error(vw_session *session, fl_diags *diags)
{
    enum { LINES_BYTES = 4096 };
    vw_session_clear_error(session);
    char *text = malloc(LINES_BYTES);
    size_t length = 0;
    for (uint32_t i = 0; text && i < diags->count; i++) {
        if (diags->items[i].severity == FL_WARNING || length + 2 >= LINES_BYTES)
            continue;
        if (length > 0)
            text[length++] = '\n';
        text[length] = 0;
        length += fl_diag_format(&diags->items[i], text + length, LINES_BYTES - length);
        if (length >= LINES_BYTES)
            length = LINES_BYTES - 1;
    }
    if (length == 0) {
        free(text);
        text = NULL;
    }
    session->error_text = text;
    session->state.has_error = text != NULL;
    fl_diags_deinit(diags);
}
