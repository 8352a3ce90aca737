/* SPDX-License-Identifier: MIT
 *
 * A scene being looked at: state, render and the picture's bytes, without window or clock. The live
 * window and the replay drive this same thing.
 */
#ifndef VW_SESSION_H
#define VW_SESSION_H

#include "viewer/bookmarks.h"
#include "viewer/board.h"
#include "viewer/history.h"
#include "viewer/input.h"
#include "viewer/keymap.h"
#include "viewer/insight.h"
#include "viewer/loading.h"
#include "viewer/mix.h"
#include "viewer/show.h"
#include "viewer/viewer.h"

/** What picture was asked for last: what happens to change back to it needs no restart. */
typedef struct vw_asked {
    bool is_known; /**< False: none, of another scene, or it could not be had. */
    vw_look look;
    uint32_t width, height;
} vw_asked;

typedef struct vw_session {
    const vw_options *options; /**< Borrowed. */
    /** What was opened: a scene, or a saved picture; and the scene: the same or that picture's. */
    char source_path[VW_PATH_MAX], scene_path[VW_PATH_MAX];
    vw_scene scene;
    vw_state state;
    vw_input input;
    vw_keymap *keymap; /**< Owned; NULL: the table's. */
    fl_render *render;
    fl_refine *refine;    /**< Of a scene that was compiled quickly; else NULL. */
    fl_progress progress; /**< As of the last refresh. */
    uint8_t *rgba;        /**< The picture shown: progress.width x progress.height. Owned. */
    size_t rgba_bytes;
    uint64_t revision;      /**< Of the bytes in rgba; 0: none, or another tone map is wanted. */
    uint32_t exact_samples; /**< Stop at exactly this many for a snapshot, paused or not; 0: not
                               wanted. */
    vw_state ordered;       /**< That snapshot's, of vw_session_order_snapshot. */
    vw_asked asked;
    uint8_t *backdrop; /**< Around a region: the last whole picture, dimmed. Owned. */
    uint32_t backdrop_width, backdrop_height, backdrop_rect[4]; /**< rect: of the region in it. */
    vw_mix mix;                                                 /**< Of state.is_mixing. */
    vw_history history;
    bool was_racking; /**< When the last input had been answered. */
    vw_bookmarks bookmarks;
    bool is_replay; /**< Bookmarks stay in memory. */
    vw_show show;
    vw_insight insight;
    void (*notify)(void *context); /**< As given to vw_session_start. */
    void *notify_context;
    char *error_text; /**< What went wrong last, as users read it, or NULL. Owned. */
} vw_session;

/** Load the scene. `width`, `height`: of the window; 0: as the scene's picture. False after adding
 * an error; close it in any case. */
bool vw_session_open(vw_session *session, const vw_options *options, const char *scene_path,
                     uint32_t width, uint32_t height, fl_diags *diags);
/** Start the workers, parked. `notify` as in fl_render_options. */
bool vw_session_start(vw_session *session, void (*notify)(void *context), void *notify_context,
                      fl_diags *diags);
/** Stops and joins the workers. A zeroed session is fine. */
void vw_session_close(vw_session *session);

/** Begin the picture of the current state again. False: `diags` says why, the old picture stays. */
bool vw_session_restart(vw_session *session, fl_diags *diags);

/** The state's picture is the one that was asked for last, by an answer or a restart, and not in
 * vain: to begin it again would only throw samples away. */
bool vw_session_is_asked(const vw_session *session);

/** Tell the render when to stop and whether to pause. */
void vw_session_set_limits(vw_session *session);

/** Open a scene, keeping the look if it is the one that is open, or a saved picture. False: the
 * last good scene stays, `diags` says why. Needs a restart afterwards. */
bool vw_session_load(vw_session *session, const char *path, fl_diags *diags);
/** Read what is open again, keeping the look. */
bool vw_session_reload(vw_session *session, fl_diags *diags);

/** The second half of either: take over a scene that was read from `path`; in any case what it
 * holds is the session's. `is_again`: it is read again, not opened by hand. */
bool vw_session_adopt(vw_session *session, const char *path, vw_scene *scene, bool is_again,
                      fl_diags *diags);

/** Do what the bits of an input ask of a session (picks, undo, bookmarks, the pin) and note the
 * step for undo. Returns the bits with what that made stale; without CAMERA when the picture is
 * still the one that was asked for last. */
vw_dirty vw_session_answer(vw_session *session, vw_dirty dirty, fl_diags *diags);

/** Answer a pick: focus on what stands at (pick_x, pick_y), the median depth of 5 x 5 pixels,
 * misses left out; or, along mirrors and through glass, on what is seen there. */
vw_dirty vw_session_pick(vw_session *session, fl_diags *diags);
vw_dirty vw_session_pick_through(vw_session *session, fl_diags *diags);

/** Take the camera that the text holds, as scene text or options, from the clipboard. */
vw_dirty vw_session_paste(vw_session *session, const char *text);

/** The camera as text for the clipboard: options in a comment, then scene text. Length as snprintf.
 */
size_t vw_session_copy(const vw_session *session, char *out, size_t out_bytes);

/** Render with the better hierarchies of a scene that was compiled quickly, once they are there;
 * true: that has just ended, well or for want of memory. vw_session_refresh does it too. */
bool vw_session_take_refined(vw_session *session);

/** Get newer bytes and progress; true: what is shown changed. Never waits for a worker. */
bool vw_session_refresh(vw_session *session, fl_diags *diags);

/** The first whole sample has come since the last refresh, and is worth one at once. */
bool vw_session_is_full_sample_new(const vw_session *session);

/** The bytes to show: progress.width x progress.height, RGBA. Valid until the next refresh. */
const uint8_t *vw_session_shown(vw_session *session);

/** What the window shows: these bytes, or with a region its picture within all of it; of that
 * size. Valid until the next refresh. */
const uint8_t *vw_session_window(vw_session *session, uint32_t *out_width, uint32_t *out_height);

/** Wait until what stands behind the pixels is there, for pictures of the window. */
void vw_session_settle(vw_session *session, fl_diags *diags);

/** Lines for the upper left corner: the layer's range, limits of sharpness, comparison, the pixel
 * under the cursor. Empty: none. */
void vw_session_notes(vw_session *session, char *out, size_t out_bytes);

/** What the board at the right says. False: there is none. */
bool vw_session_board(vw_session *session, vw_board *out);

/** Write the picture of `rgb` (linear, progress.width x progress.height) to `path`; 8-bit files are
 * tone-mapped. */
bool vw_session_save(const vw_session *session, const char *path, const float *rgb,
                     const fl_progress *progress, fl_diags *diags);

/** Linear means as they are now, from malloc; NULL after adding an error. Of uneven samples the
 * mean number is then the limit that makes the same film again, which it is near to. */
float *vw_session_mean(vw_session *session, fl_progress *out_progress, fl_diags *diags);

/** Order a snapshot of the state as it is, which must be that of the latest restart: what has begun
 * of its samples is completed, exact_samples in all, so that the same bytes can be made again.
 * Until it has been saved the caller neither restarts nor adopts. */
void vw_session_order_snapshot(vw_session *session);
/** Something else waits for it. Uneven samples then end amid their round, which may be long, and
 * the bytes depend on the moment; even ones end soon anyway. */
void vw_session_hurry_order(vw_session *session);
/** As of the last refresh: it is there. */
bool vw_session_has_ordered(const vw_session *session);
/** Save it, whatever the state is by now, and go on rendering. False after adding an error. */
bool vw_session_save_ordered(vw_session *session, const char *path, fl_progress *out_progress,
                             fl_diags *diags);
/** Forget it and go on. */
void vw_session_end_order(vw_session *session);

/** Keep the newest errors of `diags` as error_text and empty the list. */
void vw_session_take_error(vw_session *session, fl_diags *diags);
void vw_session_clear_error(vw_session *session);

/** A snapshot is to be made: the colour of a light is edited no longer. True: a restart is needed.
 */
bool vw_session_end_mix(vw_session *session);

/** Private to session*.c. */
fl_tonemap vw_session_tonemap(const vw_session *session, const vw_state *state);
/** The state's picture is asked for. */
void vw_session_note_asked(vw_session *session);
void vw_show_deinit(vw_show *show);
vw_dirty vw_show_toggle_pin(vw_session *session, fl_diags *diags);
/** Say why the pinned picture, which was asked for, is not seen, if so. */
void vw_show_explain_pin(vw_session *session);
/** Pin the picture of a file. False after adding an error. */
bool vw_show_load_pin(vw_session *session, const char *path, fl_diags *diags);
/** The state's picture changed, or what is to be shown of it. */
void vw_show_ask(vw_session *session, fl_diags *diags);
/** Take what the guide has; true: it is to be composed. */
bool vw_show_take(vw_session *session);
bool vw_show_compose(vw_session *session, fl_diags *diags);
void vw_insight_deinit(vw_insight *insight);
/** Note the error that the picture has come to, at powers of two. */
void vw_insight_note(vw_session *session);
/** Ask for measurements that are due, urgent ones at once, and take what came; true: something did.
 */
bool vw_insight_follow(vw_session *session, bool is_urgent, fl_diags *diags);
/** The answer to the present question of that kind is there. */
bool vw_insight_has(const vw_insight *insight, vw_lab_kind kind);
/** Trace the tree of rays that the state names. */
vw_dirty vw_insight_rays(vw_session *session, fl_diags *diags);

#endif
