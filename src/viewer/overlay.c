/* SPDX-License-Identifier: MIT */
#include "viewer/overlay.h"

#include <stdlib.h>
#include <string.h>

#include "viewer/atlas.h"

enum { QUADS_MAX = 8192 };

typedef struct vertex {
    float x, y, u, v;
    uint8_t ink[4]; /* premultiplied */
} vertex;

struct vw_overlay {
    const vw_gl *gl;
    vw_font *font;
    vw_atlas atlas;
    uint32_t size_px[VW_FACE_COUNT];
    GLuint program, texture, vertices, array;
    GLint window, atlas_size;
    vertex *quads;
    uint32_t vertex_count;
};

vw_overlay *vw_overlay_create(const vw_gl *gl, const char *shader_dir, fl_diags *diags)
{
    static const char *const attributes[] = {"position", "texel", "tint"};
    vw_overlay *overlay = calloc(1, sizeof *overlay);
    if (overlay)
        overlay->quads = malloc(sizeof(vertex) * 6 * QUADS_MAX);
    if (!overlay || !overlay->quads) {
        fl_out_of_memory(diags, "the overlay");
        free(overlay);
        return NULL;
    }
    overlay->gl = gl;
    overlay->font = vw_font_create(diags);
    overlay->program =
        overlay->font ? vw_gl_program(gl, shader_dir, "overlay", attributes, 3, diags) : 0;
    if (!overlay->program) {
        vw_font_destroy(overlay->font);
        free(overlay->quads);
        free(overlay);
        return NULL;
    }
    overlay->window = gl->GetUniformLocation(overlay->program, "window");
    overlay->atlas_size = gl->GetUniformLocation(overlay->program, "atlas_size");
    gl->GenVertexArrays(1, &overlay->array);
    gl->BindVertexArray(overlay->array);
    gl->GenBuffers(1, &overlay->vertices);
    gl->BindBuffer(GL_ARRAY_BUFFER, overlay->vertices);
    for (GLuint i = 0; i < 3; i++)
        gl->EnableVertexAttribArray(i);
    gl->VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(vertex),
                            (const void *)offsetof(vertex, x));
    gl->VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(vertex),
                            (const void *)offsetof(vertex, u));
    gl->VertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(vertex),
                            (const void *)offsetof(vertex, ink));
    gl->GenTextures(1, &overlay->texture);
    return overlay;
}

void vw_overlay_destroy(vw_overlay *overlay)
{
    if (!overlay)
        return;
    const vw_gl *gl = overlay->gl;
    gl->DeleteTextures(1, &overlay->texture);
    gl->DeleteBuffers(1, &overlay->vertices);
    gl->DeleteVertexArrays(1, &overlay->array);
    gl->DeleteProgram(overlay->program);
    vw_atlas_deinit(&overlay->atlas);
    vw_font_destroy(overlay->font);
    free(overlay->quads);
    free(overlay);
}

bool vw_overlay_set_sizes(vw_overlay *overlay, const uint32_t size_px[VW_FACE_COUNT],
                          fl_diags *diags)
{
    if (memcmp(size_px, overlay->size_px, sizeof overlay->size_px) == 0)
        return true;
    vw_atlas atlas;
    if (!vw_atlas_build(overlay->font, size_px, &atlas, diags))
        return false;
    vw_atlas_deinit(&overlay->atlas);
    overlay->atlas = atlas;
    memcpy(overlay->size_px, size_px, sizeof overlay->size_px);
    const vw_gl *gl = overlay->gl;
    gl->BindTexture(GL_TEXTURE_2D, overlay->texture);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_R8, VW_ATLAS_WIDTH, (GLsizei)atlas.height, 0, GL_RED,
                   GL_UNSIGNED_BYTE, atlas.coverage);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return true;
}

vw_cell vw_overlay_cell(const vw_overlay *overlay, vw_face face)
{
    return overlay->atlas.cells[face];
}

vw_cell vw_overlay_cell_of(const vw_overlay *overlay, uint32_t size_px)
{
    return vw_font_cell(overlay->font, size_px);
}

uint32_t vw_text_columns(const char *text)
{
    uint32_t columns = 0;
    while (vw_utf8_next(&text))
        columns++;
    return columns;
}

void vw_overlay_begin(vw_overlay *overlay)
{
    overlay->vertex_count = 0;
}

/* Corners left upper, right upper, left lower, right lower with the texels (u0, v0) to (u1, v1);
 * u0 > u1 mirrors. Beyond QUADS_MAX nothing is added. */
static void corners(vw_overlay *overlay, const double at[4][2], const double uv[4], vw_ink ink)
{
    if (overlay->vertex_count + 6 > 6 * QUADS_MAX)
        return;
    static const int order[6] = {0, 1, 2, 2, 1, 3};
    for (int i = 0; i < 6; i++) {
        int right = order[i] & 1, low = order[i] >> 1;
        vertex *out = &overlay->quads[overlay->vertex_count++];
        out->x = (float)at[order[i]][0];
        out->y = (float)at[order[i]][1];
        out->u = (float)uv[right ? 2 : 0];
        out->v = (float)uv[low ? 3 : 1];
        out->ink[0] = (uint8_t)(ink.r * ink.a / 255);
        out->ink[1] = (uint8_t)(ink.g * ink.a / 255);
        out->ink[2] = (uint8_t)(ink.b * ink.a / 255);
        out->ink[3] = ink.a;
    }
}

static void quad(vw_overlay *overlay, double x, double y, double width, double height,
                 const double uv[4], vw_ink ink)
{
    const double at[4][2] = {{x, y}, {x + width, y}, {x, y + height}, {x + width, y + height}};
    corners(overlay, at, uv, ink);
}

void vw_overlay_line(vw_overlay *overlay, double x0, double y0, double x1, double y1, double thick,
                     vw_ink ink)
{
    const vw_glyph *s = &overlay->atlas.solid;
    const double solid[4] = {s->x + 2.0, s->y + 2.0, s->x + 2.0, s->y + 2.0};
    double dx = x1 - x0, dy = y1 - y0, length = sqrt(dx * dx + dy * dy);
    if (!(length > 0.0))
        return;
    double u = -dy / length * thick / 2.0, v = dx / length * thick / 2.0;
    const double at[4][2] = {
        {x0 + u, y0 + v}, {x1 + u, y1 + v}, {x0 - u, y0 - v}, {x1 - u, y1 - v}};
    corners(overlay, at, solid, ink);
}

void vw_overlay_panel(vw_overlay *overlay, double x, double y, double width, double height,
                      double radius, vw_ink ink)
{
    const vw_glyph *s = &overlay->atlas.solid, *c = &overlay->atlas.corner;
    const double solid[4] = {s->x + 2.0, s->y + 2.0, s->x + 2.0, s->y + 2.0};
    double r = floor(fl_min(radius, fl_min(width, height) / 2.0));
    quad(overlay, x + r, y, width - 2.0 * r, height, solid, ink);
    if (r < 1.0)
        return;
    quad(overlay, x, y + r, r, height - 2.0 * r, solid, ink);
    quad(overlay, x + width - r, y + r, r, height - 2.0 * r, solid, ink);
    double u0 = c->x, v0 = c->y, u1 = c->x + c->width, v1 = c->y + c->height;
    quad(overlay, x, y, r, r, (const double[4]){u0, v0, u1, v1}, ink);
    quad(overlay, x + width - r, y, r, r, (const double[4]){u1, v0, u0, v1}, ink);
    quad(overlay, x, y + height - r, r, r, (const double[4]){u0, v1, u1, v0}, ink);
    quad(overlay, x + width - r, y + height - r, r, r, (const double[4]){u1, v1, u0, v0}, ink);
}

double vw_overlay_text(vw_overlay *overlay, vw_face face, double x, double y, vw_ink ink,
                       const char *text)
{
    const vw_cell *cell = &overlay->atlas.cells[face];
    /* Whole pixels: glyphs are hinted for them. */
    x = floor(x + 0.5);
    double base = floor(y + (cell->height - cell->ascent) * 0.4 + cell->ascent + 0.5);
    uint32_t codepoint;
    while ((codepoint = vw_utf8_next(&text)) != 0) {
        const vw_glyph *g = &overlay->atlas.glyphs[face][vw_glyph_index(codepoint)];
        const double uv[4] = {g->x, g->y, g->x + g->width, g->y + g->height};
        if (g->width > 0)
            quad(overlay, x + g->left, base - g->top, g->width, g->height, uv, ink);
        x += cell->width;
    }
    return x;
}

void vw_overlay_flush(vw_overlay *overlay, uint32_t window_width, uint32_t window_height)
{
    if (overlay->vertex_count == 0)
        return;
    const vw_gl *gl = overlay->gl;
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl->UseProgram(overlay->program);
    gl->Uniform2f(overlay->window, (float)window_width, (float)window_height);
    gl->Uniform2f(overlay->atlas_size, VW_ATLAS_WIDTH, (float)overlay->atlas.height);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_2D, overlay->texture);
    gl->BindVertexArray(overlay->array);
    gl->BindBuffer(GL_ARRAY_BUFFER, overlay->vertices);
    gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(overlay->vertex_count * sizeof(vertex)),
                   overlay->quads, GL_STREAM_DRAW);
    gl->DrawArrays(GL_TRIANGLES, 0, (GLsizei)overlay->vertex_count);
    overlay->vertex_count = 0;
}
