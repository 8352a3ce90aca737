/* SPDX-License-Identifier: MIT
 *
 * The public face of the viewer: the interactive window and the replay of recorded input. Both
 * drive the same session, commands and drawing; they differ in where events come from and in what
 * the time is.
 */
#ifndef VW_VIEWER_H
#define VW_VIEWER_H

#include "core/firstlight.h"
#include "io/digest.h"
#include "io/file_list.h"
#include "viewer/event.h"

/** A scene ready to render. Zero-initialise. `params.lights` may be borrowed from `scene`. */
typedef struct vw_scene {
    fl_scene *scene;       /**< Owned; NULL is allowed. */
    fl_compiled *compiled; /**< One reference. */
    fl_params params;      /**< Of the scene, with the command line over it (decision 19). */
    /** When a saved picture was named in place of a scene: the scene's path, and the samples it was
     * saved with. Else empty and 0. */
    char path[VW_PATH_MAX];
    uint32_t samples;
    fl_file_list files; /**< What it was made from, and what it names and is missing. */
} vw_scene;

/** Where scenes come from: the program reads, parses and compiles with its options. */
typedef struct vw_loader {
    void *context;
    /** Load `path`, which may go afterwards, into a zeroed *out. False after adding an error; of
     * *out there are then at most the files, to be watched for the mistake's end. Called on the
     * thread of vw_run or vw_replay_run at the start, by a thread of the window on reload and when
     * a file is dropped on it, and by the one that measures: two may call at a time. */
    bool (*load)(void *context, const char *path, vw_scene *out, fl_diags *diags);
} vw_loader;

typedef struct vw_options {
    const char *scene_path;
    vw_loader loader;
    const char *platform; /**< "glfw", "osmesa", "egl"; NULL: glfw for vw_run; osmesa, then egl for
                             a replay. */
    const char
        *shader_dir; /**< Read shaders from here instead of the built-in ones; NULL: built-in. */
    const char *record_path; /**< Write all input to this log; NULL: no record. */
    const char *keys_path;   /**< Other chords for commands (keymap.h); NULL: see has_own_keys. */
    const char *pin_path;    /**< A picture pinned from the start; NULL: none. */
    bool has_own_keys;       /**< Read the user's own file of keys, if there is one. */
    uint32_t thread_count;   /**< As fl_render_options. */
    bool is_low_priority;    /**< As fl_render_options. */
    bool is_size_fixed; /**< The user fixed the size: resizing the window only scales the picture.
                           Otherwise the picture takes the window's size, pixel for pixel. */
    bool is_quiet;      /**< No lines on standard output. */
    fl_render_limits limits; /**< samples 0: VW_SAMPLES_DEFAULT. */
    bool (*was_interrupted)(
        void); /**< Asked at least once a second; NULL: never. True ends the viewer or replay. */
} vw_options;

enum { VW_SAMPLES_DEFAULT = 4096 };

/** Open the window and stay until the user quits. Standard output gets these lines and no other,
 * each flushed: done SAMPLES samples SECONDS s     the picture reached its limit (again after each
 * change) saved FILE SAMPLES samples         a snapshot was written
 *      --camera '...' ...                 the camera as options, on C
 *  True: the user quit. False after adding an error: no window, no scene. The thread must be the
 * process's first. */
bool vw_run(const vw_options *options, fl_diags *diags);

/** Percentiles over all inputs that changed the picture; milliseconds of real time. */
typedef struct vw_latency {
    double p50, p95, p99;
} vw_latency;

typedef struct vw_snapshot {
    char *file;
    char film_sha256[FL_SHA256_HEX + 1];
    uint32_t samples;
} vw_snapshot;

/** What a replay did. Zero-initialise; free with vw_replay_report_deinit. */
typedef struct vw_replay_report {
    vw_snapshot *snapshots;
    size_t snapshot_count;
    size_t input_count; /**< Inputs that changed the picture. */
    vw_latency first;   /**< Input to the first picture of the new parameters drawn. */
    vw_latency full;    /**< Input to one sample in every pixel. */
    vw_latency cancel;  /**< Restart to the last stale unit dropped. */
} vw_replay_report;

/** Replay the log at `log_path` offscreen (decision 20): motion by the log's clock, snapshots of
 * exactly the samples asked for, relative paths from the working directory. `options->scene_path`
 * replaces the log's scene when not NULL; scene, size and platform otherwise come from the log.
 * is_measuring: show every input as the window would and take the times; without it only snapshots
 * render. False after adding an error, located in the log where it is the log's, or when
 * interrupted; the report then holds what was done. */
bool vw_replay_run(const vw_options *options, const char *log_path, bool is_measuring,
                   vw_replay_report *out_report, fl_diags *diags);
void vw_replay_report_deinit(vw_replay_report *report);

/** The controls as a Markdown page (docs/controls.md), from the command table. Returns its length;
 * writes at most out_bytes with the final 0. */
size_t vw_controls_markdown(char *out, size_t out_bytes);

#endif
