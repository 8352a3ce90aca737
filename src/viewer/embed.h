/* SPDX-License-Identifier: MIT
 *
 * Files that live inside the program: shaders and the overlay's font.
 */
#ifndef VW_EMBED_H
#define VW_EMBED_H

#include <stddef.h>

typedef struct vw_embedded {
    const char *name;
    const unsigned char *begin, *end;
} vw_embedded;

/** A shader by file name ("blit.vert"), or NULL. Not terminated by 0. */
const vw_embedded *vw_embedded_find(const char *name);

/** DejaVu Sans Mono (TrueType). */
extern const vw_embedded vw_embedded_font;

#endif
