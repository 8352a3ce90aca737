/* SPDX-License-Identifier: MIT
 *
 * One frame of the window: the picture, the status line, messages, the help, an error.
 */
#ifndef VW_VIEW_H
#define VW_VIEW_H

#include "viewer/board.h"
#include "viewer/platform.h"
#include "viewer/state.h"

typedef struct vw_view vw_view;

/** Uses the platform's current context; `platform` is borrowed. NULL after adding an error. */
vw_view *vw_view_create(vw_platform *platform, const char *shader_dir, fl_diags *diags);
void vw_view_destroy(vw_view *view);

/** Bytes to show from now on: RGBA, top row first. */
void vw_view_upload(vw_view *view, const uint8_t *rgba, uint32_t width, uint32_t height);

/** Text of several lines, or NULL. */
typedef struct vw_texts {
    const char *notes;     /**< In the upper left corner. */
    const char *error;     /**< Above all else. */
    const vw_board *board; /**< At the right, or NULL. */
} vw_texts;

/** Draw into the back buffer, without swapping. */
bool vw_view_draw(vw_view *view, const vw_state *state, const fl_progress *progress,
                  const vw_texts *texts, fl_diags *diags);

/** Wait until all that was drawn stands in the framebuffer: for measuring. */
void vw_view_finish(vw_view *view);

/** What vw_view_draw drew, read back: RGBA, top row first, 4 * width * height of the framebuffer.
 * False: out of memory. */
bool vw_view_read(vw_view *view, uint8_t *out_rgba);

/** Where the help panel stands in the last frame; false: not shown. */
bool vw_view_help_box(const vw_view *view, double *out_x, double *out_y, double *out_width,
                      double *out_height);

#endif
