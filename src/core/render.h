/* SPDX-License-Identifier: MIT
 *
 * Layer 8: the progressive render: workers, film, restart and cancel. The thread that creates a
 * render is its owner; functions are the owner's unless they say "any thread". The owner never
 * waits for a worker, except in fl_render_wait, fl_render_checkpoint and fl_render_destroy.
 */
#ifndef FL_RENDER_H
#define FL_RENDER_H

#include "core/estimate.h"
#include "core/frame.h"
#include "core/tonemap.h"

typedef struct fl_render fl_render;

typedef struct fl_render_options {
    uint32_t thread_count;     /**< 0: one per online CPU. */
    size_t memory_limit_bytes; /**< Films and what grows with them; 0: FL_RENDER_MEMORY_LIMIT. */
    bool is_low_priority;      /**< Workers yield to the desktop (nice + 1; Linux). */
    /** fl_render_display filters pictures of few samples: [1 2 1] along both axes up to 4 with a
     * lens or a light of some size, else half as much of the neighbours for 1. */
    bool smooths_display;
    /** Called by a worker, with no lock held, when there is something new to show or the render is
     * done or has failed; at most once until the next fl_render_display or fl_render_progress, and
     * once more when sample 0 is complete. NULL: none. Must not call the render. */
    void (*notify)(void *context);
    void *notify_context;
} fl_render_options;

#define FL_RENDER_MEMORY_LIMIT ((size_t)8 << 30)

typedef enum fl_render_state {
    FL_RENDER_EMPTY, /**< Nothing to render yet. */
    FL_RENDER_RUNNING,
    FL_RENDER_PAUSED,
    FL_RENDER_DONE,  /**< Reached the sample cap, the noise target or the time limit: workers are
                        parked. */
    FL_RENDER_FAILED /**< A worker ran out of memory; film is as it was. */
} fl_render_state;

/** When to stop, whichever comes first. 0 means: no such limit. Changing limits never restarts. A
 * render always stops with the same number of samples in every pixel, at least 1: the film is then
 * the film of so many samples. Adaptive (fl_params.is_adaptive): `samples` is the mean number, kept
 * within some 2 %, and the film is a function of it; a time limit may stop amid a round, and then
 * the film depends on the moment. */
typedef struct fl_render_limits {
    uint32_t samples;
    double noise_rmse; /**< Tested where it can be known: from 4 samples on, the same for any number
                          of threads. */
    double seconds;    /**< Of rendering since the restart, pauses excluded; begun passes are
                          completed. */
} fl_render_limits;

typedef struct fl_progress {
    fl_render_state state;
    uint64_t generation; /**< Which restart this picture belongs to: they are numbered from 1. 0:
                            none. */
    uint64_t newest_generation; /**< The latest restart, rendering or pending. */
    uint32_t width, height;     /**< Of the rendered part. */
    bool is_adaptive;           /**< Samples are where the noise is; see mean_samples. */
    uint32_t complete_samples; /**< Every pixel has this many (adaptive: at most 16 are counted). */
    double mean_samples;     /**< Finer grained; equal to complete_samples when all pixels have the
                                same. */
    uint32_t begun_samples;  /**< The least limit that cuts nothing off that has begun: the film
                                then ends as one that was asked for so many from the start. */
    uint32_t complete_ranks; /**< Bayer ranks of sample 0 that are complete, 0 to 64. */
    double seconds, cpu_seconds;  /**< Since the restart, pauses excluded; of committed units. */
    double first_picture_seconds; /**< From fl_render_restart to rank 0 complete, wall time; 0 until
                                     then. */
    double first_sample_seconds;  /**< From fl_render_restart to sample 0 complete, wall time; 0
                                     until then. */
    double cancel_seconds; /**< The current generation's beginning until the last stale unit was
                              dropped. */
    double cost_seconds[FL_COST_COUNT]; /**< cpu_seconds by stage. */
    fl_counts counts;        /**< Of committed units: the same for any number of threads. */
    fl_error_estimate error; /**< Of the mean; between passes that of the complete samples. */
} fl_progress;

/** Start the workers, parked. NULL after adding an error. */
fl_render *fl_render_create(const fl_render_options *options, fl_diags *diags);

/** Stop and join the workers; NULL is allowed. */
void fl_render_destroy(fl_render *render);

/** Begin again with new parameters; returns at once. Workers drop stale units within 64 rays.
 * Retains `scene`, copies `params`. The newest call wins, but while rank 0 of a generation is not
 * complete a further restart is kept pending until it is, so that a fast mouse cannot starve the
 * screen (however long rank 0 takes; not while paused). The film so far stays readable until rank 0
 * of the new one is complete. False after adding an error (parameters, memory or the memory limit):
 * the old render goes on untouched. */
bool fl_render_restart(fl_render *render, fl_compiled *scene, const fl_params *params,
                       fl_diags *diags);

/** Go on with another form of the scene: `scene` and that of a picture are of one base (compile.h).
 * Samples and generation stay, and what is under way ends as it began: since hits are the same, the
 * film's bytes are those of either form. Counts of node visits and tests are then of both. Pictures
 * of other scenes are left alone. Any thread. False after adding an error: all is as it was. */
bool fl_render_replace_scene(fl_render *render, fl_compiled *scene, fl_diags *diags);

/** All that is needed to go on later, as bytes from malloc for fl_render_resume; NULL and 0 when
 * sample 0 is not complete. Waits for the units that are out and holds the render meanwhile, about
 * as long as copying the film takes. Not for adaptive sampling. False after adding an error: out of
 * memory. */
bool fl_render_checkpoint(fl_render *render, void **out_data, size_t *out_bytes, fl_diags *diags);

/** As fl_render_restart, but with the samples that a checkpoint holds; the film then goes on to the
 * same bytes as without the break. Scene, parameters and program must be those of the checkpoint:
 * the caller sees to that, only the size is checked. For a render that has nothing yet. False after
 * adding an error; the render then begins from nothing. */
bool fl_render_resume(fl_render *render, fl_compiled *scene, const fl_params *params,
                      const void *data, size_t bytes, fl_diags *diags);

void fl_render_set_limits(fl_render *render, const fl_render_limits *limits);

/** Units that are out when a pause begins are completed; the film's bytes do not depend on pauses.
 */
void fl_render_set_paused(fl_render *render, bool is_paused);

/** What has been done so far for the generation being rendered. Any thread. */
void fl_render_progress(fl_render *render, fl_progress *out_progress);

/** Whether the picture to show, of `generation` or a later one, has a sample in every pixel: for
 * those who were woken and want to know whether it is worth a look. Any thread. */
bool fl_render_has_sample(fl_render *render, uint64_t generation);

/** Block until done, failed, or `seconds` have passed (< 0: forever); returns at once when paused
 * or empty. True: done. */
bool fl_render_wait(fl_render *render, double seconds);

/** Tone-map the mean of the picture to show to RGBA bytes, top row first, width * height * 4, if
 * there is anything newer than *revision (0: whatever there is, for a change of tone map); then
 * updates it. *out_progress is that of the picture to show, which may be the previous generation's.
 * False: nothing new, or `capacity_bytes` too small; out_progress then tells the size (0 x 0: no
 * picture yet). Unfinished first samples are hole-filled. Locks the film for a few rows at a time.
 */
bool fl_render_display(fl_render *render, uint64_t *revision, const fl_tonemap *tonemap,
                       uint8_t *out_rgba, size_t capacity_bytes, fl_progress *out_progress);

/** Copy the mean of the picture to show, linear RGB floats as fl_film_mean: what is saved and
 * hashed. `capacity_floats` must be at least 3 * width * height. False: no picture yet, or too
 * small. Any thread. */
bool fl_render_mean(fl_render *render, float *out_rgb, size_t capacity_floats,
                    fl_progress *out_progress);

/** What is known about each pixel's value. */
typedef enum fl_render_map {
    FL_RENDER_SAMPLES, /**< Samples so far. */
    FL_RENDER_ERROR    /**< Estimated rmse of the 16 x 16 square around; 0 below 4 samples. */
} fl_render_map;

/** Copy a map of the picture to show, one float a pixel, top row first; `capacity_floats` must be
 * at least width * height. False: no picture yet, or too small. Any thread. */
bool fl_render_copy_map(fl_render *render, fl_render_map map, float *out_values,
                        size_t capacity_floats, fl_progress *out_progress);

/** Mean of one pixel of the picture to show, counted in the rendered part, and the error as in
 * FL_RENDER_ERROR. False: none there. Any thread. */
bool fl_render_pixel(fl_render *render, uint32_t x, uint32_t y, float out_rgb[3],
                     uint32_t *out_samples, double *out_rmse);

#endif
