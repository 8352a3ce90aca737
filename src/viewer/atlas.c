/* SPDX-License-Identifier: MIT */
#include "viewer/atlas.h"

#include <stdlib.h>
#include <string.h>

#include <ft2build.h>
#include FT_FREETYPE_H

#include "viewer/embed.h"

enum { FIRST = 32, CORNER_PX = 16, HEIGHT_MAX = 4096 };

/* Signs outside Latin-1 that take the unused places 128 to 159. */
static const uint32_t extra[] = {
    0x25A1, 0x2190, 0x2191, 0x2192, 0x2193, 0x2026, 0x2013, 0x2014, 0x221E, 0x2248, 0x2264,
    0x2265, 0x2022, 0x2018, 0x2019, 0x201C, 0x201D, 0x25CF, 0x25B6, 0x2016, 0x21B5, 0x21E7,
};
enum { EXTRA_FIRST = 128 };

struct vw_font {
    FT_Library library;
    FT_Face face;
};

uint32_t vw_glyph_index(uint32_t codepoint)
{
    if ((codepoint >= FIRST && codepoint < 127) ||
        (codepoint >= 160 && codepoint < VW_ATLAS_GLYPHS))
        return codepoint;
    for (uint32_t i = 0; i < FL_COUNT_OF(extra); i++)
        if (extra[i] == codepoint)
            return EXTRA_FIRST + i;
    return EXTRA_FIRST;
}

static uint32_t codepoint_of(uint32_t index)
{
    if (index >= EXTRA_FIRST && index < EXTRA_FIRST + FL_COUNT_OF(extra))
        return extra[index - EXTRA_FIRST];
    return index == 127 || (index > EXTRA_FIRST && index < 160) ? 0 : index;
}

uint32_t vw_utf8_next(const char **text)
{
    const unsigned char *s = (const unsigned char *)*text;
    if (s[0] == 0)
        return 0;
    int more = s[0] < 0x80 ? 0 : s[0] >= 0xF0 ? 3 : s[0] >= 0xE0 ? 2 : s[0] >= 0xC2 ? 1 : -1;
    uint32_t c = more <= 0 ? s[0] : s[0] & (0x3Fu >> more);
    for (int i = 1; i <= more; i++) {
        if ((s[i] & 0xC0) != 0x80) {
            more = -1;
            break;
        }
        c = c << 6 | (s[i] & 0x3Fu);
    }
    *text += more < 0 ? 1 : 1 + more;
    return more < 0 ? 0xFFFD : c;
}

vw_font *vw_font_create(fl_diags *diags)
{
    vw_font *font = calloc(1, sizeof *font);
    if (!font) {
        fl_out_of_memory(diags, "the font");
        return NULL;
    }
    const vw_embedded *file = &vw_embedded_font;
    if (FT_Init_FreeType(&font->library) != 0 ||
        FT_New_Memory_Face(font->library, file->begin, (FT_Long)(file->end - file->begin), 0,
                           &font->face) != 0) {
        fl_environment_error(diags, "the built-in font %s cannot be opened", file->name);
        vw_font_destroy(font);
        return NULL;
    }
    return font;
}

void vw_font_destroy(vw_font *font)
{
    if (!font)
        return;
    if (font->face)
        FT_Done_Face(font->face);
    if (font->library)
        FT_Done_FreeType(font->library);
    free(font);
}

vw_cell vw_font_cell(vw_font *font, uint32_t size_px)
{
    FT_Set_Pixel_Sizes(font->face, 0, size_px);
    const FT_Size_Metrics *m = &font->face->size->metrics;
    /* 26.6 fixed point; whole pixels keep columns of text aligned. */
    double width = (double)((m->max_advance + 32) >> 6), ascent = (double)((m->ascender + 32) >> 6);
    return (vw_cell){
        .width = width, .height = floor((double)size_px * 1.36 + 0.5), .ascent = ascent};
}

/* Rows of glyphs, left to right. */
typedef struct shelf {
    uint8_t *pixels;
    uint32_t x, y, row_height, height;
} shelf;

static bool place(shelf *at, uint32_t width, uint32_t height, vw_glyph *out)
{
    if (at->x + width + 1 > VW_ATLAS_WIDTH) {
        at->x = 1;
        at->y += at->row_height + 1;
        at->row_height = 0;
    }
    if (at->y + height + 1 > at->height)
        return false;
    *out = (vw_glyph){.x = (uint16_t)at->x,
                      .y = (uint16_t)at->y,
                      .width = (uint16_t)width,
                      .height = (uint16_t)height};
    at->x += width + 1;
    at->row_height = fl_max_u32(at->row_height, height);
    return true;
}

static bool draw_face(vw_font *font, uint32_t size_px, shelf *at, vw_glyph *glyphs)
{
    FT_Set_Pixel_Sizes(font->face, 0, size_px);
    for (uint32_t i = FIRST; i < VW_ATLAS_GLYPHS; i++) {
        uint32_t codepoint = codepoint_of(i);
        if (codepoint == 0 ||
            FT_Load_Char(font->face, codepoint, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) != 0)
            continue;
        const FT_GlyphSlot slot = font->face->glyph;
        const FT_Bitmap *map = &slot->bitmap;
        if (!place(at, map->width, map->rows, &glyphs[i]))
            return false;
        glyphs[i].left = (int16_t)slot->bitmap_left;
        glyphs[i].top = (int16_t)slot->bitmap_top;
        for (uint32_t y = 0; y < map->rows; y++)
            memcpy(at->pixels + (size_t)(glyphs[i].y + y) * VW_ATLAS_WIDTH + glyphs[i].x,
                   map->buffer + (ptrdiff_t)y * map->pitch, map->width);
    }
    return true;
}

/* Coverage of a pixel by the quarter disc: 4 x 4 points. */
static uint8_t corner_coverage(uint32_t x, uint32_t y)
{
    int inside = 0;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            double dx = CORNER_PX - (x + (i + 0.5) / 4.0), dy = CORNER_PX - (y + (j + 0.5) / 4.0);
            inside += dx * dx + dy * dy <= (double)(CORNER_PX * CORNER_PX);
        }
    }
    return (uint8_t)(inside * 255 / 16);
}

static bool draw_shapes(shelf *at, vw_atlas *atlas)
{
    if (!place(at, CORNER_PX, CORNER_PX, &atlas->corner) || !place(at, 4, 4, &atlas->solid))
        return false;
    for (uint32_t y = 0; y < CORNER_PX; y++)
        for (uint32_t x = 0; x < CORNER_PX; x++)
            at->pixels[(atlas->corner.y + y) * VW_ATLAS_WIDTH + atlas->corner.x + x] =
                corner_coverage(x, y);
    for (uint32_t y = 0; y < 4; y++)
        memset(at->pixels + (atlas->solid.y + y) * VW_ATLAS_WIDTH + atlas->solid.x, 255, 4);
    return true;
}

bool vw_atlas_build(vw_font *font, const uint32_t size_px[VW_FACE_COUNT], vw_atlas *out_atlas,
                    fl_diags *diags)
{
    for (uint32_t height = 128; height <= HEIGHT_MAX; height *= 2) {
        vw_atlas atlas = {.height = height};
        shelf at = {.x = 1, .y = 1, .height = height};
        at.pixels = atlas.coverage = calloc(VW_ATLAS_WIDTH, height);
        if (!atlas.coverage)
            return fl_out_of_memory(diags, "the glyphs");
        bool is_full = !draw_shapes(&at, &atlas);
        for (int face = 0; face < VW_FACE_COUNT && !is_full; face++) {
            atlas.cells[face] = vw_font_cell(font, size_px[face]);
            is_full = !draw_face(font, size_px[face], &at, atlas.glyphs[face]);
        }
        if (!is_full) {
            *out_atlas = atlas;
            return true;
        }
        free(atlas.coverage);
    }
    return fl_environment_error(diags, "text of %u pixels is too large", size_px[VW_FACE_NORMAL]);
}

void vw_atlas_deinit(vw_atlas *atlas)
{
    free(atlas->coverage);
    *atlas = (vw_atlas){0};
}
