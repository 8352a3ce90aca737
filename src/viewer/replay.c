/* SPDX-License-Identifier: MIT
 *
 * A log instead of a hand, its clock instead of the real one. The picture of a snapshot depends on
 * the log alone: it is rendered to exactly the samples asked for, from the start if the film
 * already has more.
 */
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "io/files.h"
#include "io/image_file.h"
#include "io/path.h"
#include "viewer/log.h"
#include "viewer/pace.h"
#include "viewer/present.h"
#include "viewer/words.h"

/* Times of one kind, milliseconds. */
typedef struct times {
    double *ms;
    size_t count, capacity;
} times;

typedef struct replay {
    const vw_options *options;
    vw_log log;
    vw_platform *platform;
    vw_view *view;
    vw_session session;
    bool is_measuring;
    bool is_stale;         /**< The film is not of the current state. */
    uint32_t film_samples; /**< What the film was last brought to exactly; 0: unknown. */
    times first, full, cancel;
    vw_replay_report *report;
    fl_diags *diags;
} replay;

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static bool add_time(times *list, double ms, fl_diags *diags)
{
    if (list->count == list->capacity) {
        size_t capacity = list->capacity ? 2 * list->capacity : 256;
        double *grown = realloc(list->ms, capacity * sizeof *grown);
        if (!grown)
            return fl_out_of_memory(diags, "the times");
        list->ms = grown;
        list->capacity = capacity;
    }
    list->ms[list->count++] = ms;
    return true;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Nearest rank: the smallest time that at least that share of inputs did not exceed. */
static vw_latency percentiles(times *list)
{
    if (list->count == 0)
        return (vw_latency){0};
    qsort(list->ms, list->count, sizeof list->ms[0], compare_doubles);
    size_t last = list->count - 1;
    size_t p50 = (last + 1) * 50 / 100, p95 = (last + 1) * 95 / 100, p99 = (last + 1) * 99 / 100;
    return (vw_latency){list->ms[p50 < last ? p50 : last], list->ms[p95 < last ? p95 : last],
                        list->ms[p99 < last ? p99 : last]};
}

static bool is_interrupted(const replay *r)
{
    return r->options->was_interrupted && r->options->was_interrupted();
}

static void wake(void *context)
{
    vw_platform *platform = context;
    platform->ops->wake(platform);
}

/* Tone-map, upload, draw: what the window does with a newer picture. */
static bool show(replay *r, bool *out_is_new)
{
    vw_session *session = &r->session;
    *out_is_new = vw_session_refresh(session, r->diags);
    if (r->diags->error_count)
        return false;
    if (!vw_present(r->view, r->platform, session, *out_is_new, r->diags))
        return false;
    vw_view_finish(r->view);
    return true;
}

static bool has_failed(replay *r)
{
    return r->session.progress.state == FL_RENDER_FAILED &&
           !fl_out_of_memory(r->diags, "rendering");
}

/* Show pictures at the window's pace until `samples` are complete; notes when the first picture of
 * the new parameters was drawn. */
static bool watch(replay *r, double begin_s, uint32_t samples)
{
    vw_session *session = &r->session;
    bool has_first = false;
    vw_pace pace = {0};
    fl_render_progress(session->render, &session->progress);
    vw_pace_restart(&pace, session->progress.newest_generation, (uint64_t)(begin_s * 1e3));
    while (session->progress.state != FL_RENDER_DONE || !has_first) {
        bool is_new;
        double sleep_s = (double)vw_pace_due_ms(&pace, &session->progress) * 1e-3 - seconds_now();
        if (sleep_s > 0.0 && !vw_session_is_full_sample_new(session)) {
            r->platform->ops->pump(r->platform, sleep_s);
            continue;
        }
        double look_s = seconds_now();
        if (!show(r, &is_new) || has_failed(r) || is_interrupted(r))
            return false;
        vw_pace_shown(&pace, &session->progress, (uint64_t)(look_s * 1e3));
        if (is_new)
            vw_pace_took(&pace, (uint64_t)((seconds_now() - look_s) * 1e3 + 0.5));
        const fl_progress *p = &session->progress;
        if (is_new && !has_first && p->complete_ranks > 0) {
            has_first = true;
            if (!add_time(&r->first, (seconds_now() - begin_s) * 1e3, r->diags))
                return false;
        }
        if (has_first && p->complete_samples >= samples)
            break;
    }
    return add_time(&r->full, (seconds_now() - begin_s) * 1e3, r->diags) &&
           add_time(&r->cancel, session->progress.cancel_seconds * 1e3, r->diags);
}

static bool restart(replay *r, uint32_t samples)
{
    r->session.exact_samples = samples;
    vw_session_set_limits(&r->session);
    r->film_samples = 0;
    r->is_stale = false;
    return vw_session_restart(&r->session, r->diags);
}

/* The picture changed through input. Measuring, it is shown as in the window; else it waits for a
 * snapshot. */
static bool picture_changed(replay *r, double begin_s)
{
    r->report->input_count++;
    r->is_stale = true;
    if (!r->is_measuring)
        return true;
    return restart(r, VW_LOG_SAMPLES_MAX) && watch(r, begin_s, 1);
}

static bool apply(replay *r, vw_dirty dirty, double begin_s)
{
    dirty = vw_session_answer(&r->session, dirty, r->diags);
    bool needs_restart = (dirty & (VW_DIRTY_CAMERA | VW_DIRTY_SCENE)) != 0;
    /* A file that is not a scene shows an error in the window; in a log it is a mistake. */
    if ((dirty & VW_DIRTY_SCENE) && !vw_session_reload(&r->session, r->diags))
        return false;
    if (dirty & VW_DIRTY_TONEMAP)
        r->session.revision = 0;
    if (r->diags->error_count)
        return false;
    /* Snapshots, printing and pausing are the log's own lines, or have no effect without a hand. */
    return !needs_restart || picture_changed(r, begin_s);
}

/* Let time pass, a frame of the window after the other. */
static bool advance(replay *r, uint64_t ms)
{
    vw_session *session = &r->session;
    while (vw_input_is_moving(&session->input) && vw_input_next_tick_ms(&session->input) <= ms) {
        double begin_s = seconds_now();
        uint64_t tick_ms = vw_input_next_tick_ms(&session->input);
        if (!apply(r, vw_input_advance(&session->input, &session->state, tick_ms), begin_s))
            return false;
        if (is_interrupted(r))
            return false;
    }
    return apply(r, vw_input_advance(&session->input, &session->state, ms), seconds_now());
}

static bool resize(replay *r, const vw_event *event)
{
    return event->kind != VW_EVENT_RESIZE ||
           r->platform->ops->resize(r->platform, event->width, event->height, r->diags);
}

static bool run_event(replay *r, const vw_log_entry *entry)
{
    double begin_s = seconds_now();
    const vw_event *event = &entry->event;
    if (!resize(r, event))
        return false;
    vw_dirty dirty = vw_input_event(&r->session.input, &r->session.state, event, entry->ms);
    if (event->kind == VW_EVENT_DROP) {
        if (!vw_session_load(&r->session, event->path, r->diags))
            return false;
        dirty = (vw_dirty)(dirty | VW_DIRTY_CAMERA);
    }
    if (event->kind == VW_EVENT_PASTE)
        dirty = vw_session_paste(&r->session, event->path);
    return apply(r, dirty, begin_s);
}

static bool add_snapshot(replay *r, const char *file, const float *rgb, const fl_progress *progress)
{
    vw_replay_report *report = r->report;
    vw_snapshot *grown = realloc(report->snapshots, (report->snapshot_count + 1) * sizeof *grown);
    if (!grown)
        return fl_out_of_memory(r->diags, "the report");
    report->snapshots = grown;
    vw_snapshot *snapshot = &grown[report->snapshot_count];
    size_t bytes = strlen(file) + 1;
    *snapshot = (vw_snapshot){.file = malloc(bytes), .samples = vw_words_samples(progress)};
    if (!snapshot->file)
        return fl_out_of_memory(r->diags, "the report");
    memcpy(snapshot->file, file, bytes);
    fl_digest_sha256(rgb, (size_t)progress->width * progress->height * 3 * sizeof *rgb,
                     snapshot->film_sha256);
    report->snapshot_count++;
    return true;
}

/* Bring the film to exactly so many samples. */
static bool render_exactly(replay *r, uint32_t samples)
{
    vw_session *session = &r->session;
    /* Adaptively, where samples go depends on the goals on the way. */
    bool may_go_on =
        r->film_samples > 0 && r->film_samples <= samples && !session->scene.params.is_adaptive;
    if (!r->is_stale && may_go_on) {
        session->exact_samples = samples;
        vw_session_set_limits(session);
    } else if (!restart(r, samples)) {
        return false;
    }
    while (!fl_render_wait(session->render, 0.25)) {
        fl_render_progress(session->render, &session->progress);
        vw_insight_note(session);
        if (has_failed(r) || is_interrupted(r))
            return false;
    }
    r->film_samples = samples;
    return true;
}

static bool run_snapshot(replay *r, const vw_log_entry *entry)
{
    vw_session *session = &r->session;
    r->is_stale |= vw_session_end_mix(session); /* A preview is never saved. */
    if (!render_exactly(r, entry->samples))
        return false;
    fl_progress progress;
    float *rgb = vw_session_mean(session, &progress, r->diags);
    if (!rgb)
        return false;
    bool is_new, is_fine = vw_session_save(session, entry->file, rgb, &progress, r->diags) &&
                           add_snapshot(r, entry->file, rgb, &progress) && show(r, &is_new);
    free(rgb);
    return is_fine;
}

/* RGBA bytes to a file without alpha. */
static bool save_bytes(uint8_t *rgba, uint32_t width, uint32_t height, const char *path,
                       fl_diags *diags)
{
    for (size_t i = 0; i < (size_t)width * height; i++)
        memmove(rgba + 3 * i, rgba + 4 * i, 3);
    fl_image image = {.width = width, .height = height, .format = FL_PIXEL_SRGB8, .pixels = rgba};
    return fl_image_save(path, &image, NULL, 0, diags);
}

/* What the window shows after so many samples, overlays and all. */
static bool run_window(replay *r, const vw_log_entry *entry)
{
    bool is_new;
    uint32_t width, height;
    if (!render_exactly(r, entry->samples))
        return false;
    vw_session_settle(&r->session, r->diags);
    if (!show(r, &is_new))
        return false;
    r->platform->ops->framebuffer_size(r->platform, &width, &height);
    uint8_t *rgba = malloc((size_t)width * height * 4);
    bool is_fine = rgba && vw_view_read(r->view, rgba);
    if (!is_fine)
        fl_out_of_memory(r->diags, "the window's picture");
    is_fine = is_fine && save_bytes(rgba, width, height, entry->file, r->diags);
    free(rgba);
    return is_fine;
}

static bool run_entry(replay *r, const vw_log_entry *entry)
{
    switch (entry->kind) {
    case VW_LOG_SNAPSHOT:
        return run_snapshot(r, entry);
    case VW_LOG_WINDOW:
        return run_window(r, entry);
    case VW_LOG_EVENT:
    case VW_LOG_QUIT:
        break;
    }
    return run_event(r, entry);
}

static bool run_log(replay *r)
{
    for (size_t i = 0; i < r->log.entry_count; i++) {
        const vw_log_entry *entry = &r->log.entries[i];
        if (!advance(r, entry->ms))
            return false;
        if (entry->kind == VW_LOG_QUIT)
            break;
        if (!run_entry(r, entry) || is_interrupted(r))
            return false;
    }
    return true;
}

/* The scene as the log names it: from the working directory, else from the log's folder. */
static void find_scene(const char *log_path, const char *scene, char out[2 * VW_PATH_MAX])
{
    size_t folder = (size_t)fl_path_folder_bytes(log_path);
    size_t bytes = strlen(scene) + 1;
    if (access(scene, F_OK) == 0 || scene[0] == '/' || folder == 0 ||
        folder + bytes > 2 * VW_PATH_MAX)
        folder = 0;
    memcpy(out, log_path, folder);
    memcpy(out + folder, scene, bytes);
    if (folder > 0 && access(out, F_OK) != 0)
        memcpy(out, scene, bytes);
}

static bool open_replay(replay *r, const char *log_path)
{
    size_t bytes;
    char *text = fl_file_load(log_path, "log", VW_LOG_MAX_BYTES, (fl_loc){.file = log_path},
                              r->diags, &bytes);
    if (!text)
        return false;
    bool is_parsed = vw_log_parse(text, bytes, log_path, &r->log, r->diags);
    free(text);
    if (!is_parsed)
        return false;
    char scene[2 * VW_PATH_MAX];
    find_scene(log_path, r->options->scene_path ? r->options->scene_path : r->log.scene, scene);
    vw_window_desc desc = {
        .title = "firstlight replay", .width = r->log.width, .height = r->log.height};
    if (!vw_session_open(&r->session, r->options, scene, desc.width, desc.height, r->diags))
        return false;
    r->session.is_replay = true;
    r->platform = vw_platform_create(r->options->platform, false, &desc, r->diags);
    if (!r->platform)
        return false;
    if (!r->platform->ops->resize)
        return fl_environment_error(r->diags, "a replay runs offscreen: --platform osmesa or egl");
    r->view = vw_view_create(r->platform, r->options->shader_dir, r->diags);
    return r->view && vw_session_start(&r->session, wake, r->platform, r->diags);
}

bool vw_replay_run(const vw_options *options, const char *log_path, bool is_measuring,
                   vw_replay_report *out_report, fl_diags *diags)
{
    *out_report = (vw_replay_report){0};
    replay r = {.options = options,
                .is_measuring = is_measuring,
                .is_stale = true,
                .report = out_report,
                .diags = diags};
    bool is_fine = open_replay(&r, log_path) && run_log(&r);
    out_report->first = percentiles(&r.first);
    out_report->full = percentiles(&r.full);
    out_report->cancel = percentiles(&r.cancel);
    free(r.first.ms);
    free(r.full.ms);
    free(r.cancel.ms);
    vw_session_close(&r.session);
    vw_view_destroy(r.view);
    if (r.platform)
        r.platform->ops->destroy(r.platform);
    vw_log_deinit(&r.log);
    return is_fine;
}

void vw_replay_report_deinit(vw_replay_report *report)
{
    for (size_t i = 0; i < report->snapshot_count; i++)
        free(report->snapshots[i].file);
    free(report->snapshots);
    *report = (vw_replay_report){0};
}
