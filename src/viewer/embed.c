/* SPDX-License-Identifier: MIT
 *
 * The assembler copies the files into the read-only section. VW_SHADER_DIR and VW_FONT_FILE come
 * from the build.
 */
#include "viewer/embed.h"

#include <string.h>

#define EMBED(symbol, path)                                                                        \
    extern const unsigned char symbol##_begin[], symbol##_end[];                                   \
    __asm__(".section .rodata\n"                                                                   \
            ".balign 16\n"                                                                         \
            ".globl " #symbol "_begin\n.hidden " #symbol "_begin\n" #symbol "_begin:\n"            \
            ".incbin \"" path "\"\n"                                                               \
            ".globl " #symbol "_end\n.hidden " #symbol "_end\n" #symbol "_end:\n"                  \
            ".byte 0\n"                                                                            \
            ".text\n")

EMBED(vw_blit_vert, VW_SHADER_DIR "/blit.vert");
EMBED(vw_blit_frag, VW_SHADER_DIR "/blit.frag");
EMBED(vw_overlay_vert, VW_SHADER_DIR "/overlay.vert");
EMBED(vw_overlay_frag, VW_SHADER_DIR "/overlay.frag");
EMBED(vw_font, VW_FONT_FILE);

static const vw_embedded shaders[] = {
    {"blit.vert", vw_blit_vert_begin, vw_blit_vert_end},
    {"blit.frag", vw_blit_frag_begin, vw_blit_frag_end},
    {"overlay.vert", vw_overlay_vert_begin, vw_overlay_vert_end},
    {"overlay.frag", vw_overlay_frag_begin, vw_overlay_frag_end},
};

const vw_embedded vw_embedded_font = {"DejaVuSansMono.ttf", vw_font_begin, vw_font_end};

const vw_embedded *vw_embedded_find(const char *name)
{
    for (size_t i = 0; i < sizeof shaders / sizeof shaders[0]; i++)
        if (strcmp(shaders[i].name, name) == 0)
            return &shaders[i];
    return NULL;
}
