/* SPDX-License-Identifier: MIT
 *
 * A board of figures at the right edge of the window: rows of text with bars, and a plot. What it
 * says is a plain value that tests read; drawing it is here too.
 */
#ifndef VW_BOARD_H
#define VW_BOARD_H

#include "viewer/overlay.h"

enum { VW_BOARD_ROWS = 24, VW_BOARD_LABEL = 128, VW_BOARD_VALUE = 144, VW_PLOT_POINTS = 32 };

typedef struct vw_board_row {
    char label[VW_BOARD_LABEL], value[VW_BOARD_VALUE];
    double bar; /**< 0 to 1; < 0: none. */
    bool is_dim;
} vw_board_row;

/** Something at a place of the plot, with its sign. */
typedef struct vw_mark {
    double x, y;
    char sign[8];
} vw_mark;

/** Both axes logarithmic. Points that are not above 0 and finite are left out. */
typedef struct vw_plot {
    double x[VW_PLOT_POINTS], y[VW_PLOT_POINTS]; /**< Measured, in order of x. */
    uint32_t count;
    /** From the last point on: y falls like x^-rate, between x^-slow and x^-fast, up to end_x. */
    bool has_forecast;
    double rate, slow, fast, end_x;
    vw_mark marks[8];
    uint32_t mark_count;
    char x_unit[16], y_unit[16]; /**< "s", "rmse". */
} vw_plot;

/** Zero-initialise. */
typedef struct vw_board {
    char title[VW_BOARD_LABEL];
    vw_board_row rows[VW_BOARD_ROWS];
    uint32_t row_count;
    bool has_plot;
    vw_plot plot;
} vw_board;

/** Add a row with a value behind it; a bar < 0: none. Beyond VW_BOARD_ROWS it is dropped. */
void vw_board_add(vw_board *board, double bar, const char *label, const char *format, ...)
    FL_PRINTF(4, 5);
/** Add a dim row of text alone. */
void vw_board_note(vw_board *board, const char *format, ...) FL_PRINTF(2, 3);

/** The place of a line of text. */
typedef struct vw_label {
    double x, y, width;
} vw_label;

/** Move the last of `count` labels, all `height` high, down until it is clear of the others. */
void vw_board_clear_label(vw_label *labels, uint32_t count, double height);

/** Draw with the right upper corner at (right, top), at most `width` wide, not below `bottom`: rows
 * that find no room are left out, and long ones cut. */
void vw_board_draw(const vw_board *board, vw_overlay *overlay, double right, double top,
                   double width, double bottom, double scale);

/** The width it would like, pixels. */
double vw_board_width(const vw_board *board, const vw_overlay *overlay, double scale);

#endif
