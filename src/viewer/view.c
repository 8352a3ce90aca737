/* SPDX-License-Identifier: MIT */
#include "viewer/view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "viewer/blit.h"
#include "viewer/help.h"
#include "viewer/overlay.h"
#include "viewer/words.h"

enum { TEXT_PX = 13 };

static const vw_ink panel_ink = {14, 17, 22, 205};
static const vw_ink message_ink = {14, 17, 22, 245};
static const vw_ink alarm_panel_ink = {58, 14, 16, 235};
static const vw_ink bright_ink = {240, 242, 245, 255};
static const vw_ink dim_ink = {150, 160, 172, 255};
static const vw_ink alarm_ink = {255, 120, 105, 255};
static const vw_ink bar_ink = {255, 176, 64, 255};
static const vw_ink region_ink = {255, 176, 64, 70};
static const vw_ink track_ink = {255, 255, 255, 28};

struct vw_view {
    vw_platform *platform;
    vw_gl gl;
    vw_blit *blit;
    vw_overlay *overlay;
    vw_help help;
    bool is_help_drawn;
};

vw_view *vw_view_create(vw_platform *platform, const char *shader_dir, fl_diags *diags)
{
    vw_view *view = calloc(1, sizeof *view);
    if (!view) {
        fl_out_of_memory(diags, "the window");
        return NULL;
    }
    view->platform = platform;
    if (!vw_gl_load(&view->gl, platform->ops->get_proc, platform, diags)) {
        free(view);
        return NULL;
    }
    view->blit = vw_blit_create(&view->gl, shader_dir, diags);
    view->overlay = view->blit ? vw_overlay_create(&view->gl, shader_dir, diags) : NULL;
    if (!view->overlay) {
        vw_view_destroy(view);
        return NULL;
    }
    return view;
}

void vw_view_destroy(vw_view *view)
{
    if (!view)
        return;
    vw_overlay_destroy(view->overlay);
    vw_blit_destroy(view->blit);
    free(view);
}

void vw_view_upload(vw_view *view, const uint8_t *rgba, uint32_t width, uint32_t height)
{
    vw_blit_upload(view->blit, rgba, width, height);
}

/* The status line at the bottom, wrapped into as many rows as it needs; returns its upper edge. */
static double draw_status(vw_view *view, const vw_state *state, const fl_progress *progress,
                          double scale)
{
    vw_status items[VW_STATUS_MAX];
    uint32_t row_of[VW_STATUS_MAX], count = vw_words_status(state, progress, items);
    vw_cell cell = vw_overlay_cell(view->overlay, VW_FACE_NORMAL);
    double margin = floor(8.0 * scale), pad = floor(10.0 * scale);
    double room = (double)state->width - 2.0 * (margin + pad), gap = 2.0 * cell.width;
    uint32_t rows = 1;
    double x = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        double label = (double)vw_text_columns(items[i].label) * cell.width;
        double width = label + (label > 0.0 ? cell.width : 0.0) +
                       (double)vw_text_columns(items[i].value) * cell.width;
        if (x > 0.0 && x + width > room) {
            rows++;
            x = 0.0;
        }
        row_of[i] = rows - 1;
        x += width + gap;
    }
    double height = rows * cell.height + 2.0 * floor(6.0 * scale) + floor(3.0 * scale);
    double top = (double)state->height - margin - height, left = margin;
    double width = (double)state->width - 2.0 * margin;
    vw_overlay_panel(view->overlay, left, top, width, height, 6.0 * scale, panel_ink);
    double bar = fl_max(floor(2.0 * scale), 1.0), bar_y = top + floor(5.0 * scale);
    double done = floor((width - 2.0 * pad) * vw_words_done(state, progress));
    vw_overlay_panel(view->overlay, left + pad, bar_y, width - 2.0 * pad, bar, 0.0, track_ink);
    vw_overlay_panel(view->overlay, left + pad, bar_y, done, bar, 0.0, bar_ink);
    double first = top + height - floor(5.0 * scale) - rows * cell.height;
    x = left + pad;
    for (uint32_t i = 0; i < count; i++) {
        if (i > 0 && row_of[i] != row_of[i - 1])
            x = left + pad;
        double y = first + row_of[i] * cell.height;
        if (items[i].label[0])
            x = vw_overlay_text(view->overlay, VW_FACE_NORMAL, x, y, dim_ink, items[i].label) +
                cell.width;
        x = vw_overlay_text(view->overlay, VW_FACE_NORMAL, x, y,
                            items[i].is_alarm ? alarm_ink : bright_ink, items[i].value);
        x += gap;
    }
    return top;
}

static void draw_message(vw_view *view, const vw_state *state, const char *message, double bottom,
                         double scale)
{
    vw_cell cell = vw_overlay_cell(view->overlay, VW_FACE_NORMAL);
    double width = (double)vw_text_columns(message) * cell.width + floor(24.0 * scale);
    double height = cell.height + floor(10.0 * scale);
    /* Of what is too wide the beginning is seen. */
    double x = fl_max(floor(((double)state->width - width) / 2.0), 0.0),
           y = bottom - height - floor(10.0 * scale);
    vw_overlay_panel(view->overlay, x, y, width, height, height / 2.0, message_ink);
    vw_overlay_text(view->overlay, VW_FACE_NORMAL, x + floor(12.0 * scale), y + floor(5.0 * scale),
                    bright_ink, message);
}

/* Where the row that begins at `from` ends, at most `columns` characters on. Messages go on in the
 * next row, between words if there is a blank in the second half; lines that begin with a blank
 * quote a file above a mark: both are cut. *out_next: where the next row begins; NULL: there is
 * none. */
static const char *row_end(const char *from, uint32_t columns, bool is_quote, const char **out_next)
{
    const char *end = from, *blank = NULL;
    for (uint32_t used = 0; *end && *end != '\n' && used < columns; used++) {
        if (*end == ' ' && 2 * used >= columns)
            blank = end;
        do
            end++;
        while (((unsigned char)*end & 0xC0) == 0x80);
    }
    const char *line_end = strchr(end, '\n');
    if (!*end || *end == '\n' || is_quote) {
        *out_next = line_end ? line_end + 1 : NULL;
        return end;
    }
    end = *end != ' ' && blank ? blank : end;
    *out_next = *end == ' ' ? end + 1 : end;
    return end;
}

/* Lines of text in a panel at the top; wide: across the window, else as wide as the text. Sets
 * where the panel ends. */
static void draw_lines(vw_view *view, const vw_state *state, const char *text, bool is_wide,
                       vw_ink ink, double scale, double out_end[2])
{
    enum { ROWS_MAX = 64, ROW_BYTES = 512 };
    struct {
        const char *begin, *end;
    } rows[ROWS_MAX];
    vw_cell cell = vw_overlay_cell(view->overlay, VW_FACE_NORMAL);
    double margin = floor(8.0 * scale), pad = floor(10.0 * scale);
    uint32_t columns = (uint32_t)fl_clamp(
        ((double)state->width - 2.0 * (margin + pad)) / cell.width, 1.0, ROW_BYTES / 4 - 1);
    uint32_t count = 0, widest = 0;
    bool is_quote = false;
    for (const char *at = text; at && count < ROWS_MAX; count++) {
        if (at == text || at[-1] == '\n')
            is_quote = *at == ' ';
        rows[count].begin = at;
        rows[count].end = row_end(at, columns, is_quote, &at);
        uint32_t used = vw_text_columns(rows[count].begin) - vw_text_columns(rows[count].end);
        widest = fl_max_u32(widest, used);
    }
    double height = count * cell.height + 2.0 * floor(7.0 * scale);
    double width =
        is_wide ? (double)state->width - 2.0 * margin : (double)widest * cell.width + 2.0 * pad;
    vw_overlay_panel(view->overlay, margin, margin, width, height, 6.0 * scale, ink);
    out_end[0] = margin + width;
    out_end[1] = margin + height;
    double y = margin + floor(7.0 * scale);
    for (uint32_t i = 0; i < count; i++, y += cell.height) {
        char row[ROW_BYTES];
        snprintf(row, sizeof row, "%.*s", (int)(rows[i].end - rows[i].begin), rows[i].begin);
        vw_overlay_text(view->overlay, VW_FACE_NORMAL, margin + pad, y, bright_ink, row);
    }
}

/* At the right; below what stands at the left when there is no room beside it. */
static void draw_board(vw_view *view, const vw_state *state, const vw_board *board,
                       const double notes_end[2], double bottom, double scale)
{
    double margin = floor(8.0 * scale), right = (double)state->width - margin, top = margin;
    double width = fl_min(vw_board_width(board, view->overlay, scale), right - margin);
    if (right - width < notes_end[0] + margin && notes_end[1] > 0.0)
        top = notes_end[1] + margin;
    vw_board_draw(board, view->overlay, right, top, width, bottom - margin, scale);
}

/* The rectangle that is being dragged. */
static void draw_region(vw_view *view, const vw_state *state)
{
    const double *a = state->region_from, *b = state->region_to;
    double scale = state->picture_scale;
    vw_overlay_panel(view->overlay, state->picture_x + scale * fl_min(a[0], b[0]),
                     state->picture_y + scale * fl_min(a[1], b[1]), scale * fabs(a[0] - b[0]),
                     scale * fabs(a[1] - b[1]), 0.0, region_ink);
}

bool vw_view_draw(vw_view *view, const vw_state *state, const fl_progress *progress,
                  const vw_texts *texts, fl_diags *diags)
{
    const vw_gl *gl = &view->gl;
    double scale = state->text_scale > 0.0 ? state->text_scale : 1.0;
    gl->Viewport(0, 0, (GLsizei)state->width, (GLsizei)state->height);
    gl->ClearColor(0.075f, 0.08f, 0.09f, 1.0f);
    gl->Clear(GL_COLOR_BUFFER_BIT);
    vw_blit_draw(view->blit, state->width, state->height, state->picture_x, state->picture_y,
                 floor((double)state->picture_width * state->picture_scale + 0.5),
                 floor((double)state->picture_height * state->picture_scale + 0.5));
    view->is_help_drawn = state->help_page > 0;
    uint32_t size = (uint32_t)(TEXT_PX * scale + 0.5);
    if (view->is_help_drawn)
        vw_help_layout(&view->help, view->overlay, view->platform, state, scale);
    uint32_t sizes[VW_FACE_COUNT] = {[VW_FACE_NORMAL] = size, [VW_FACE_HELP] = size};
    if (view->help.size_px > 0)
        sizes[VW_FACE_HELP] = view->help.size_px;
    if (!vw_overlay_set_sizes(view->overlay, sizes, diags))
        return false;
    vw_overlay_begin(view->overlay);
    if (state->is_region_dragged)
        draw_region(view, state);
    double bottom = (double)state->height, notes_end[2] = {0.0, 0.0};
    /* The help shows the same values, and would lie over the line. */
    if (state->is_hud_shown && state->help_page == 0)
        bottom = draw_status(view, state, progress, scale);
    if (state->help_page > 0)
        vw_help_draw(&view->help, view->overlay, state);
    if (texts->notes && texts->notes[0] && !texts->error && state->help_page == 0)
        draw_lines(view, state, texts->notes, false, panel_ink, scale, notes_end);
    if (texts->board && !texts->error && state->help_page == 0)
        draw_board(view, state, texts->board, notes_end, bottom, scale);
    if (texts->error)
        draw_lines(view, state, texts->error, true, alarm_panel_ink, scale, notes_end);
    const char *message = vw_state_message(state);
    if (message)
        draw_message(view, state, message, bottom, scale);
    vw_overlay_flush(view->overlay, state->width, state->height);
    return true;
}

void vw_view_finish(vw_view *view)
{
    view->gl.Finish();
}

bool vw_view_read(vw_view *view, uint8_t *out_rgba)
{
    uint32_t width, height;
    view->platform->ops->framebuffer_size(view->platform, &width, &height);
    size_t row = (size_t)width * 4;
    uint8_t *swap = malloc(row);
    if (!swap)
        return false;
    view->gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    view->gl.ReadPixels(0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA, GL_UNSIGNED_BYTE, out_rgba);
    for (uint32_t y = 0; y < height / 2; y++) {
        uint8_t *top = out_rgba + y * row, *low = out_rgba + (height - 1 - y) * row;
        memcpy(swap, top, row);
        memcpy(top, low, row);
        memcpy(low, swap, row);
    }
    free(swap);
    return true;
}

bool vw_view_help_box(const vw_view *view, double *out_x, double *out_y, double *out_width,
                      double *out_height)
{
    *out_x = view->help.x;
    *out_y = view->help.y;
    *out_width = view->help.width;
    *out_height = view->help.height;
    return view->is_help_drawn;
}
