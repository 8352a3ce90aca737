/* SPDX-License-Identifier: MIT
 *
 * The live window: one loop that sleeps until there is input, something to show, or time to move.
 * It never waits for a worker.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "io/path.h"
#include "io/state_text.h"
#include "viewer/log.h"
#include "viewer/pace.h"
#include "viewer/present.h"
#include "viewer/watch.h"
#include "viewer/words.h"

enum {
    RESIZE_QUIET_MS = 100,
    PAD_POLL_MS = 16,
    RELOAD_QUIET_MS = 100, /* Several files saved together are read once. */
    SNAPSHOT_NUMBER_MAX = 999999,
    WELCOME_MS = 8000
};

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

typedef struct app {
    const vw_options *options;
    vw_platform *platform;
    vw_view *view;
    vw_session session;
    vw_watch *watch;
    vw_loading *loading;
    FILE *record;
    struct timespec begin;
    uint64_t now_ms;
    vw_pace pace;
    uint64_t restart_ms;       /**< When to restart; UINT64_MAX: nothing to restart. */
    uint64_t reload_ms;        /**< When to read the changed files; UINT64_MAX: they did not. */
    char dropped[VW_PATH_MAX]; /**< On the window, and not read yet; empty: nothing. */
    char snapshot[64];         /**< Where the one that is ordered goes. */
    uint64_t done_generation;  /**< Last picture announced as done. */
    uint32_t done_samples;
    char watched_path[VW_PATH_MAX]; /**< The scene whose files are watched. */
    bool wants_refresh;             /**< Ask the render without waiting for the next due time. */
    bool needs_draw, has_quit;
    bool has_newer; /**< Of the picture, and it was not drawn yet. */
    char title[160];
    fl_diags diags; /**< Of the current step; shown, then emptied. */
} app;

static uint64_t earlier(uint64_t a_ms, uint64_t b_ms)
{
    return a_ms < b_ms ? a_ms : b_ms;
}

static uint64_t clock_ms(const app *a)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    int64_t ms =
        (int64_t)(now.tv_sec - a->begin.tv_sec) * 1000 + (now.tv_nsec - a->begin.tv_nsec) / 1000000;
    return ms > 0 ? (uint64_t)ms : 0;
}

static void wake(void *context)
{
    vw_platform *platform = context;
    platform->ops->wake(platform);
}

static void show_error(app *a)
{
    vw_session_take_error(&a->session, &a->diags);
    a->needs_draw = true;
}

static void print_camera(app *a)
{
    char text[2 * FL_STATE_TEXT_MAX + FL_LIGHT_TEXT_MAX];
    vw_session_copy(&a->session, text, sizeof text);
    a->platform->ops->set_clipboard(a->platform, text);
    if (!a->options->is_quiet) {
        fl_camera_options_text(&a->session.state.look.camera, text, sizeof text);
        puts(text);
        fflush(stdout);
    }
}

/* What the clipboard holds becomes an event on one line, so that a record has it; comments go. */
static void ask_paste(app *a)
{
    vw_event event = {.kind = VW_EVENT_PASTE};
    const char *text = a->platform->ops->clipboard(a->platform);
    size_t length = 0;
    bool is_comment = false, is_start = true;
    for (; text && *text && length + 1 < sizeof event.path; text++) {
        bool is_end = *text == '\n' || *text == '\r';
        is_comment = !is_end && (is_comment || (is_start && *text == '#'));
        is_start = is_end;
        if (!is_comment && (length > 0 || (unsigned char)*text > ' '))
            event.path[length++] = (unsigned char)*text < ' ' ? ' ' : *text;
    }
    if (length == 0)
        snprintf(event.path, sizeof event.path, "nothing");
    vw_event_push(&a->platform->events, &event);
}

/* The files of the scene that was read last, well or not: a mistake ends where it was made. */
static void watch_files(app *a, const char *path, const fl_file_list *files)
{
    snprintf(a->watched_path, sizeof a->watched_path, "%s", path);
    vw_watch_set(a->watch, files);
}

/* When the changed files may be read; UINT64_MAX: they did not change, or are of a scene that may
 * soon be another. */
static uint64_t reload_from_ms(const app *a)
{
    return a->dropped[0] ? UINT64_MAX : a->reload_ms;
}

/* Changed files are read again by an event, which a record keeps; a dropped scene that could not be
 * read as if it were dropped again. */
static void reload_if_changed(app *a)
{
    if (vw_watch_take(a->watch))
        a->reload_ms = a->now_ms + RELOAD_QUIET_MS;
    if (a->now_ms < reload_from_ms(a))
        return;
    a->reload_ms = UINT64_MAX;
    vw_event event = {.kind = VW_EVENT_RELOAD};
    if (strcmp(a->watched_path, a->session.source_path) != 0) {
        event.kind = VW_EVENT_DROP;
        memcpy(event.path, a->watched_path, sizeof event.path);
    }
    vw_event_push(&a->platform->events, &event);
}

/* Read by its own thread; the old picture stays and can be used until then. */
static void load_scene(app *a, const char *path)
{
    vw_state_say(&a->session.state, "reading %s", fl_path_name(path));
    a->session.state.message_until_ms = UINT64_MAX; /* Until it is read. */
    vw_loading_ask(a->loading, path);
}

/* Another scene is there from now on: a record says so now, not when it was asked for. */
static void record_drop(app *a, const char *path)
{
    vw_event event = {.kind = VW_EVENT_DROP};
    snprintf(event.path, sizeof event.path, "%s", path);
    if (a->record)
        vw_log_write_event(a->record, a->now_ms, &event);
}

static void take_loaded(app *a)
{
    char path[VW_PATH_MAX];
    vw_scene scene;
    /* A snapshot that waits is of this scene. */
    if (a->session.exact_samples || !vw_loading_take(a->loading, &scene, path, &a->diags))
        return;
    bool is_dropped = strcmp(path, a->dropped) == 0;
    bool is_other = is_dropped || strcmp(path, a->session.source_path) != 0;
    bool is_read = scene.compiled != NULL;
    if (is_dropped)
        a->dropped[0] = 0;
    if (is_read) {
        vw_session_clear_error(&a->session); /* Before its bookmarks, which may have errors too. */
        is_read = vw_session_adopt(&a->session, path, &scene, !is_dropped, &a->diags);
    } else {
        watch_files(a, path, &scene.files);
        vw_scene_deinit(&scene);
    }
    if (!is_read) {
        a->session.state.message_until_ms = 0; /* "reading" */
        show_error(a);
        return;
    }
    if (is_other) {
        record_drop(a, path);
        a->reload_ms = UINT64_MAX;
    }
    fl_diags_deinit(&a->diags);
    watch_files(a, a->session.source_path, &a->session.scene.files);
    vw_state_say(&a->session.state, "loaded");
    vw_session_set_limits(&a->session);
    a->restart_ms = a->now_ms;
    a->session.revision = 0;
}

static bool begin_again(app *a)
{
    a->restart_ms = UINT64_MAX;
    if (!vw_session_restart(&a->session, &a->diags)) {
        show_error(a);
        a->wants_refresh = true;
        return false;
    }
    fl_progress progress;
    fl_render_progress(a->session.render, &progress);
    vw_pace_restart(&a->pace, progress.newest_generation, a->now_ms);
    a->session.progress.state = progress.state;
    return true;
}

/* --- Snapshots -------------------------------------------------------------------------------- */

/* The first free name of firstlight-001.png and so on; false: none. */
static bool free_name(char *out, size_t out_bytes)
{
    for (int number = 1; number <= SNAPSHOT_NUMBER_MAX; number++) {
        snprintf(out, out_bytes, "firstlight-%03d.png", number);
        if (access(out, F_OK) != 0 && errno == ENOENT)
            return true;
    }
    return false;
}

/* What is saved is the picture of the state as it is now: neither the preview of a light, nor what
 * a restart that waits would replace. */
static void order_snapshot(app *a)
{
    vw_session *session = &a->session;
    if (session->exact_samples) {
        vw_session_hurry_order(session);
        vw_state_say(&session->state, "%s is not whole yet", a->snapshot);
        return;
    }
    if (!free_name(a->snapshot, sizeof a->snapshot)) {
        fl_environment_error(&a->diags, "no free name for a snapshot is left here");
        show_error(a);
        return;
    }
    vw_session_end_mix(session);
    bool is_stale = a->restart_ms != UINT64_MAX || !vw_session_is_asked(session);
    if (is_stale && !begin_again(a))
        return;
    vw_session_order_snapshot(session);
    if (a->record)
        vw_log_write_snapshot(a->record, a->now_ms, a->snapshot, session->exact_samples);
    vw_state_say(&session->state, "%s at sample %u", a->snapshot, session->exact_samples);
    a->wants_refresh = true;
}

static bool save_snapshot(app *a, fl_diags *diags)
{
    fl_progress progress;
    if (!vw_session_save_ordered(&a->session, a->snapshot, &progress, diags))
        return false;
    uint32_t samples = vw_words_samples(&progress);
    vw_state_say(&a->session.state, "saved %s, %u samples", a->snapshot, samples);
    if (!a->options->is_quiet) {
        printf("saved %s %u samples\n", a->snapshot, samples);
        fflush(stdout);
    }
    return true;
}

/* An ordered snapshot is there, or will never be. */
static void save_if_whole(app *a)
{
    if (vw_session_has_ordered(&a->session)) {
        if (!save_snapshot(a, &a->diags))
            show_error(a);
        a->needs_draw = true;
    } else if (a->session.exact_samples && a->session.progress.state == FL_RENDER_FAILED) {
        vw_session_end_order(&a->session);
        vw_state_say(&a->session.state, "%s was not saved: out of memory", a->snapshot);
    }
}

/* Who orders a snapshot and leaves has it still, also when a signal says so. */
static bool save_at_the_end(app *a, fl_diags *diags)
{
    vw_session *session = &a->session;
    if (!session->exact_samples)
        return true;
    vw_session_hurry_order(session);
    if (!fl_render_wait(session->render, -1.0))
        return fl_out_of_memory(diags, "the snapshot");
    return save_snapshot(a, diags);
}

/* Do what a command asked for. `is_resize`: restart only when the hand rests. */
static void apply(app *a, vw_dirty dirty, bool is_resize)
{
    dirty = vw_session_answer(&a->session, dirty, &a->diags);
    if (a->diags.error_count)
        show_error(a);
    if ((dirty & VW_DIRTY_SCENE) && !a->dropped[0])
        load_scene(a, a->session.source_path);
    if (dirty & VW_DIRTY_CAMERA)
        a->restart_ms = is_resize ? a->now_ms + RESIZE_QUIET_MS : earlier(a->restart_ms, a->now_ms);
    if (dirty & VW_DIRTY_LIMITS)
        vw_session_set_limits(&a->session);
    if (dirty & VW_DIRTY_TONEMAP)
        a->session.revision = 0;
    a->wants_refresh |= (dirty & (VW_DIRTY_LIMITS | VW_DIRTY_TONEMAP | VW_DIRTY_SHOW)) != 0;
    if (dirty & VW_DIRTY_SNAPSHOT)
        order_snapshot(a);
    if (dirty & VW_DIRTY_PRINT)
        print_camera(a);
    if (dirty & VW_DIRTY_PASTE)
        ask_paste(a);
    if ((dirty & VW_DIRTY_RAYS) && a->session.insight.rays_text && !a->options->is_quiet) {
        fputs(a->session.insight.rays_text, stdout);
        fflush(stdout);
    }
    if (dirty & VW_DIRTY_QUIT)
        a->has_quit = true;
    a->needs_draw |= dirty != VW_DIRTY_NONE;
}

static void take_events(app *a)
{
    vw_event event;
    while (!a->has_quit && vw_event_pop(&a->platform->events, &event)) {
        if (a->record && event.kind != VW_EVENT_DROP)
            vw_log_write_event(a->record, a->now_ms, &event);
        vw_dirty dirty = vw_input_event(&a->session.input, &a->session.state, &event, a->now_ms);
        if (event.kind == VW_EVENT_KEY && event.action != 0 && a->session.error_text &&
            (dirty & VW_DIRTY_WINDOW))
            vw_session_clear_error(&a->session);
        apply(a, dirty, event.kind == VW_EVENT_RESIZE);
        if (event.kind == VW_EVENT_DROP) {
            memcpy(a->dropped, event.path, sizeof a->dropped);
            load_scene(a, event.path);
        }
        if (event.kind == VW_EVENT_PASTE)
            apply(a, vw_session_paste(&a->session, event.path), false);
    }
    apply(a, vw_input_advance(&a->session.input, &a->session.state, a->now_ms), false);
}

static bool is_running(const vw_session *session)
{
    return !session->state.is_paused && !session->state.is_hidden;
}

/* When the restart that is due may begin; UINT64_MAX: none is due, or a snapshot must be whole
 * first.
 */
static uint64_t restart_from_ms(const app *a)
{
    if (a->restart_ms == UINT64_MAX || a->session.exact_samples)
        return UINT64_MAX;
    uint64_t held_ms = is_running(&a->session) ? vw_pace_held_until_ms(&a->pace) : 0;
    return a->restart_ms > held_ms ? a->restart_ms : held_ms;
}

static void restart_if_due(app *a)
{
    bool is_awaited = a->now_ms >= a->restart_ms || vw_loading_is_busy(a->loading);
    if (a->session.exact_samples && is_awaited)
        vw_session_hurry_order(&a->session);
    if (a->now_ms >= restart_from_ms(a))
        begin_again(a);
}

static void announce(app *a)
{
    const fl_progress *progress = &a->session.progress;
    if (progress->state != FL_RENDER_DONE || a->session.exact_samples ||
        a->restart_ms != UINT64_MAX ||
        (progress->generation == a->done_generation &&
         progress->complete_samples == a->done_samples))
        return;
    a->done_generation = progress->generation;
    a->done_samples = progress->complete_samples;
    if (!a->options->is_quiet) {
        printf("done %u samples %.3f s\n", vw_words_samples(progress), progress->seconds);
        fflush(stdout);
    }
}

static void refresh_if_due(app *a)
{
    vw_session *session = &a->session;
    if (!a->wants_refresh && a->now_ms < vw_pace_due_ms(&a->pace, &session->progress) &&
        !vw_session_is_full_sample_new(session))
        return;
    fl_render_state before = session->progress.state;
    uint32_t samples_before = session->progress.complete_samples;
    a->wants_refresh = false;
    bool is_newer = vw_session_refresh(session, &a->diags);
    vw_pace_shown(&a->pace, &session->progress, a->now_ms);
    a->has_newer |= is_newer;
    a->needs_draw |= is_newer || session->progress.state != before ||
                     session->progress.complete_samples != samples_before;
    if (a->diags.error_count)
        show_error(a);
    save_if_whole(a);
    announce(a);
}

static bool draw(app *a, fl_diags *diags)
{
    vw_session *session = &a->session;
    char title[sizeof a->title];
    vw_words_title(&session->state, &session->progress, session->scene_path, title, sizeof title);
    if (strcmp(title, a->title) != 0) {
        memcpy(a->title, title, sizeof title);
        a->platform->ops->set_title(a->platform, title);
    }
    a->needs_draw = false;
    if (!vw_present(a->view, a->platform, session, a->has_newer, diags))
        return false;
    if (a->has_newer)
        vw_pace_took(&a->pace, clock_ms(a) - a->now_ms);
    a->has_newer = false;
    return true;
}

static bool may_draw(const app *a)
{
    return !a->session.state.is_hidden && a->now_ms >= vw_pace_draw_from_ms(&a->pace);
}

/* Seconds until something is due without input; < 0: nothing is. */
static double time_to_sleep(const app *a)
{
    const vw_session *session = &a->session;
    if (a->platform->events.count > 0)
        return 0.0;
    uint64_t until = earlier(restart_from_ms(a), reload_from_ms(a));
    if (a->needs_draw && !session->state.is_hidden)
        until = earlier(until, vw_pace_draw_from_ms(&a->pace));
    if (vw_input_is_moving(&session->input))
        until = earlier(until, vw_input_next_tick_ms(&session->input));
    const vw_platform_ops *ops = a->platform->ops;
    if (ops->has_pad && !session->state.is_hidden && ops->has_pad(a->platform))
        until = earlier(until, a->now_ms + PAD_POLL_MS);
    if (session->state.is_mixing)
        until = earlier(until, session->state.mix_until_ms);
    if (vw_state_message(&session->state))
        until = earlier(until, session->state.message_until_ms);
    if (session->progress.state == FL_RENDER_RUNNING || session->exact_samples)
        until = earlier(until, vw_pace_due_ms(&a->pace, &session->progress));
    if (until == UINT64_MAX)
        return a->options->was_interrupted ? 1.0 : -1.0;
    return until > a->now_ms ? (double)(until - a->now_ms) / 1000.0 : 0.0;
}

static bool loop(app *a, fl_diags *diags)
{
    while (!a->has_quit) {
        a->now_ms = clock_ms(a);
        bool had_message = vw_state_message(&a->session.state) != NULL;
        reload_if_changed(a);
        take_events(a);
        a->needs_draw |= vw_session_take_refined(&a->session);
        a->needs_draw |= had_message != (vw_state_message(&a->session.state) != NULL);
        restart_if_due(a);
        refresh_if_due(a);
        take_loaded(a); /* After the look, which may have saved what it waited for. */
        /* After the look, which may have shown what a restart waited for. */
        restart_if_due(a);
        if (a->needs_draw && may_draw(a) && !draw(a, diags))
            return false;
        if (a->options->was_interrupted && a->options->was_interrupted())
            break;
        if (!a->has_quit)
            a->platform->ops->pump(a->platform, time_to_sleep(a));
    }
    return true;
}

static bool open_record(app *a, fl_diags *diags)
{
    if (!a->options->record_path)
        return true;
    a->record = fopen(a->options->record_path, "w");
    if (!a->record)
        return fl_environment_error(diags, "cannot write the log '%s': %s", a->options->record_path,
                                    strerror(errno));
    /* By line: the log of a session that crashes is the one that is needed. */
    setvbuf(a->record, NULL, _IOLBF, 0);
    vw_log_write_header(a->record, a->session.state.width, a->session.state.height,
                        a->session.source_path);
    return true;
}

static bool close_record(app *a, fl_diags *diags)
{
    if (!a->record)
        return true;
    vw_log_write_quit(a->record, clock_ms(a));
    bool has_failed = ferror(a->record) != 0;
    has_failed |= fclose(a->record) != 0;
    return !has_failed || fl_environment_error(diags, "the log '%s' could not be written whole",
                                               a->options->record_path);
}

static bool open_window(app *a, fl_diags *diags)
{
    vw_state *state = &a->session.state;
    vw_window_desc desc = {
        .title = "firstlight", .width = state->picture_width, .height = state->picture_height};
    a->platform = vw_platform_create(a->options->platform, true, &desc, diags);
    if (!a->platform)
        return false;
    uint32_t width, height;
    a->platform->ops->framebuffer_size(a->platform, &width, &height);
    vw_state_resize(state, width, height);
    if (a->platform->ops->content_scale) {
        vw_event event = {.kind = VW_EVENT_SCALE,
                          .x = a->platform->ops->content_scale(a->platform)};
        vw_event_push(&a->platform->events, &event);
    }
    a->view = vw_view_create(a->platform, a->options->shader_dir, diags);
    return a->view != NULL;
}

bool vw_run(const vw_options *options, fl_diags *diags)
{
    app a = {.options = options, .needs_draw = true, .reload_ms = UINT64_MAX};
    clock_gettime(CLOCK_MONOTONIC, &a.begin);
    bool is_fine = vw_session_open(&a.session, options, options->scene_path, 0, 0, diags) &&
                   open_window(&a, diags) &&
                   vw_session_start(&a.session, wake, a.platform, diags) && open_record(&a, diags);
    if (is_fine) {
        clock_gettime(CLOCK_MONOTONIC, &a.begin);
        a.watch = vw_watch_create(wake, a.platform);
        watch_files(&a, a.session.source_path, &a.session.scene.files);
        char welcome[VW_MESSAGE_MAX];
        vw_words_welcome(a.session.keymap, welcome, sizeof welcome);
        vw_state_say(&a.session.state, "%s", welcome);
        a.session.state.message_until_ms = WELCOME_MS;
        a.loading = vw_loading_create(&options->loader, wake, a.platform, diags);
        is_fine = a.loading && loop(&a, diags) && save_at_the_end(&a, diags);
        is_fine &= close_record(&a, diags);
    }
    /* The threads go first: they wake the platform. */
    vw_watch_destroy(a.watch);
    vw_loading_destroy(a.loading);
    vw_session_close(&a.session);
    vw_view_destroy(a.view);
    if (a.platform)
        a.platform->ops->destroy(a.platform);
    fl_diags_deinit(&a.diags);
    return is_fine;
}
