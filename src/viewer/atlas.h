/* SPDX-License-Identifier: MIT
 *
 * Glyphs of the embedded font drawn into one 8-bit picture. No GL here.
 */
#ifndef VW_ATLAS_H
#define VW_ATLAS_H

#include "viewer/overlay.h"

enum { VW_ATLAS_GLYPHS = 256, VW_ATLAS_WIDTH = 1024 };

/** A glyph's place in the atlas and against its cell's pen position on the base line. */
typedef struct vw_glyph {
    uint16_t x, y, width, height;
    int16_t left, top;
} vw_glyph;

typedef struct vw_atlas {
    uint8_t *coverage; /**< VW_ATLAS_WIDTH * height; owned. */
    uint32_t height;
    vw_glyph glyphs[VW_FACE_COUNT][VW_ATLAS_GLYPHS];
    vw_cell cells[VW_FACE_COUNT];
    vw_glyph solid;  /**< A fully covered spot. */
    vw_glyph corner; /**< A quarter disc, its centre at the lower right: the upper left corner of a
                        panel. */
} vw_atlas;

typedef struct vw_font vw_font;
/** Open the embedded font; NULL after adding an error. */
vw_font *vw_font_create(fl_diags *diags);
void vw_font_destroy(vw_font *font);
/** Metrics at a size. */
vw_cell vw_font_cell(vw_font *font, uint32_t size_px);

/** Draw both faces. False after adding an error; *out_atlas is then untouched. Free with
 * vw_atlas_deinit. */
bool vw_atlas_build(vw_font *font, const uint32_t size_px[VW_FACE_COUNT], vw_atlas *out_atlas,
                    fl_diags *diags);
void vw_atlas_deinit(vw_atlas *atlas);

/** Index of a character in `glyphs`; characters outside the set give a box. */
uint32_t vw_glyph_index(uint32_t codepoint);

/** Read one UTF-8 character and move on; a wrong byte reads as U+FFFD. 0 at the end. */
uint32_t vw_utf8_next(const char **text);

#endif
