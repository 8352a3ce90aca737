/* SPDX-License-Identifier: MIT
 *
 * The picture on the screen: one texture, one quad. At scale 1 every byte arrives as it is.
 */
#ifndef VW_BLIT_H
#define VW_BLIT_H

#include "viewer/gl.h"

typedef struct vw_blit vw_blit;

/** Needs a current context, as everything here. NULL after adding an error. */
vw_blit *vw_blit_create(const vw_gl *gl, const char *shader_dir, fl_diags *diags);
void vw_blit_destroy(vw_blit *blit);

/** Take new bytes: RGBA, top row first. The texture is re-made only when the size changes. */
void vw_blit_upload(vw_blit *blit, const uint8_t *rgba, uint32_t width, uint32_t height);

/** Draw what was uploaded last into the rectangle at (x, y), framebuffer pixels from the top left;
 * nothing before the first upload. Whole-number scales keep hard pixels, others are filtered. */
void vw_blit_draw(vw_blit *blit, uint32_t window_width, uint32_t window_height, double x, double y,
                  double width, double height);

#endif
