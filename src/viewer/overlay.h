/* SPDX-License-Identifier: MIT
 *
 * Text and panels over the picture: glyphs from one atlas, everything in one draw call,
 * premultiplied alpha. Positions are framebuffer pixels from the top left; text is UTF-8 of a
 * fixed-width font (Latin-1 and a few signs; others show as a box).
 */
#ifndef VW_OVERLAY_H
#define VW_OVERLAY_H

#include "viewer/gl.h"

typedef struct vw_overlay vw_overlay;

/** Straight-alpha sRGB colour. */
typedef struct vw_ink {
    uint8_t r, g, b, a;
} vw_ink;

/** Size of a fixed-width cell, pixels. */
typedef struct vw_cell {
    double width, height, ascent;
} vw_cell;

/** Two sizes of text share the atlas. */
typedef enum vw_face { VW_FACE_NORMAL, VW_FACE_HELP, VW_FACE_COUNT } vw_face;

/** NULL after adding an error. */
vw_overlay *vw_overlay_create(const vw_gl *gl, const char *shader_dir, fl_diags *diags);
void vw_overlay_destroy(vw_overlay *overlay);

/** Choose text sizes (pixels of the em square); draws the glyphs anew only if one changed. False
 * after adding an error: nothing changed. */
bool vw_overlay_set_sizes(vw_overlay *overlay, const uint32_t size_px[VW_FACE_COUNT],
                          fl_diags *diags);
vw_cell vw_overlay_cell(const vw_overlay *overlay, vw_face face);
/** The cell that a size would give, without changing anything. */
vw_cell vw_overlay_cell_of(const vw_overlay *overlay, uint32_t size_px);

/** Characters (not bytes) of a text. */
uint32_t vw_text_columns(const char *text);

/** Begin a frame: nothing is drawn until vw_overlay_flush. */
void vw_overlay_begin(vw_overlay *overlay);
/** A rectangle with rounded corners. */
void vw_overlay_panel(vw_overlay *overlay, double x, double y, double width, double height,
                      double radius, vw_ink ink);
/** A straight line from (x0, y0) to (x1, y1), `thick` pixels wide. */
void vw_overlay_line(vw_overlay *overlay, double x0, double y0, double x1, double y1, double thick,
                     vw_ink ink);
/** One line of text whose cell begins at (x, y); returns the x behind it. */
double vw_overlay_text(vw_overlay *overlay, vw_face face, double x, double y, vw_ink ink,
                       const char *text);
/** Draw everything since begin. */
void vw_overlay_flush(vw_overlay *overlay, uint32_t window_width, uint32_t window_height);

#endif
