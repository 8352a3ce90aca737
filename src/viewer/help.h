/* SPDX-License-Identifier: MIT
 *
 * The help panel: every command with its keys and its live value, in pages of the largest text that
 * fits the window.
 */
#ifndef VW_HELP_H
#define VW_HELP_H

#include "viewer/overlay.h"
#include "viewer/words.h"

enum { VW_HELP_ROWS_MAX = 64, VW_HELP_COLUMNS = 2 };

typedef struct vw_help {
    uint32_t size_px;
    double x, y, width, height, pad; /**< Of the panel, framebuffer pixels. */
    uint32_t columns;                /**< 1, or 2: the page's groups side by side. */
    double column_width, keys_width, help_width;
    char keys[VW_HELP_ROWS_MAX][VW_KEYS_MAX];
    const char *own_keys; /**< Of those, the help's. */
} vw_help;

/** Decide size and place, for the window in `state`. Reads key labels from `platform`. */
void vw_help_layout(vw_help *help, const vw_overlay *overlay, vw_platform *platform,
                    const vw_state *state, double scale);

/** Draw; the overlay's help face must have size_px. */
void vw_help_draw(const vw_help *help, vw_overlay *overlay, const vw_state *state);

#endif
