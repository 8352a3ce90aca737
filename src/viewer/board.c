/* SPDX-License-Identifier: MIT */
#include "viewer/board.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { BAR_COLUMNS = 10, PLOT_ROWS = 9, PLOT_COLUMNS = 42 };

static const vw_ink panel_ink = {14, 17, 22, 215};
static const vw_ink title_ink = {255, 176, 64, 255};
static const vw_ink label_ink = {176, 184, 194, 255};
static const vw_ink dim_ink = {120, 130, 142, 255};
static const vw_ink value_ink = {240, 242, 245, 255};
static const vw_ink bar_ink = {128, 206, 255, 255};
static const vw_ink track_ink = {255, 255, 255, 28};
static const vw_ink bracket_ink = {255, 255, 255, 80};

void vw_board_add(vw_board *board, double bar, const char *label, const char *format, ...)
{
    if (board->row_count == VW_BOARD_ROWS)
        return;
    vw_board_row *row = &board->rows[board->row_count++];
    *row = (vw_board_row){.bar = bar};
    snprintf(row->label, sizeof row->label, "%s", label);
    va_list args;
    va_start(args, format);
    vsnprintf(row->value, sizeof row->value, format, args);
    va_end(args);
}

void vw_board_note(vw_board *board, const char *format, ...)
{
    if (board->row_count == VW_BOARD_ROWS)
        return;
    vw_board_row *row = &board->rows[board->row_count++];
    *row = (vw_board_row){.bar = -1.0, .is_dim = true};
    va_list args;
    va_start(args, format);
    vsnprintf(row->label, sizeof row->label, format, args);
    va_end(args);
}

/* Columns of labels, of values, of bars. */
typedef struct columns {
    uint32_t label, value, bar;
} columns;

static columns columns_of(const vw_board *board)
{
    columns c = {0};
    for (uint32_t i = 0; i < board->row_count; i++) {
        const vw_board_row *row = &board->rows[i];
        uint32_t label = vw_text_columns(row->label), value = vw_text_columns(row->value);
        /* A row of one text may use the whole width. */
        if (value > 0 || row->bar >= 0.0)
            c.label = fl_max_u32(c.label, label);
        c.value = fl_max_u32(c.value, value);
        if (row->bar >= 0.0)
            c.bar = BAR_COLUMNS;
    }
    return c;
}

static uint32_t width_columns(const vw_board *board)
{
    columns c = columns_of(board);
    uint32_t all = c.label + (c.value ? 2 + c.value : 0) + (c.bar ? 2 + c.bar : 0);
    all = fl_max_u32(all, vw_text_columns(board->title));
    for (uint32_t i = 0; i < board->row_count; i++)
        if (!board->rows[i].value[0] && board->rows[i].bar < 0.0)
            all = fl_max_u32(all, vw_text_columns(board->rows[i].label));
    return board->has_plot ? fl_max_u32(all, PLOT_COLUMNS) : all;
}

double vw_board_width(const vw_board *board, const vw_overlay *overlay, double scale)
{
    return width_columns(board) * vw_overlay_cell(overlay, VW_FACE_NORMAL).width +
           2.0 * floor(10.0 * scale);
}

/* At most so many characters, whole ones. */
static void cut(const char *text, uint32_t most, char out[VW_BOARD_LABEL])
{
    size_t length = 0;
    uint32_t used = 0;
    for (; text[length] && length + 1 < VW_BOARD_LABEL; length++) {
        used += ((unsigned char)text[length] & 0xC0) != 0x80;
        if (used > most)
            break;
    }
    memcpy(out, text, length);
    out[length] = 0;
}

typedef struct frame {
    vw_overlay *overlay;
    double x, y, width, scale; /* Of what is inside. */
    vw_cell cell;
    columns columns;
} frame;

static void draw_row(const frame *f, const vw_board_row *row, double y)
{
    char text[VW_BOARD_LABEL];
    uint32_t room = (uint32_t)fl_max(f->width / f->cell.width, 0.0);
    bool is_alone = !row->value[0] && row->bar < 0.0;
    uint32_t behind =
        (f->columns.value ? 2 + f->columns.value : 0) + (f->columns.bar ? 2 + f->columns.bar : 0);
    cut(row->label, is_alone || room < behind ? room : room - behind, text);
    vw_overlay_text(f->overlay, VW_FACE_NORMAL, f->x, y, row->is_dim ? dim_ink : label_ink, text);
    if (is_alone || room < behind)
        return;
    double end = f->x + f->width;
    if (f->columns.bar) {
        double full = BAR_COLUMNS * f->cell.width, thick = floor(f->cell.height * 0.4);
        double top = floor(y + f->cell.height * 0.35);
        end -= full;
        if (row->bar >= 0.0) {
            vw_overlay_panel(f->overlay, end, top, full, thick, 2.0 * f->scale, track_ink);
            vw_overlay_panel(f->overlay, end, top, floor(full * fl_clamp(row->bar, 0.0, 1.0) + 0.5),
                             thick, 2.0 * f->scale, bar_ink);
        }
        end -= 2.0 * f->cell.width;
    }
    end -= vw_text_columns(row->value) * f->cell.width;
    vw_overlay_text(f->overlay, VW_FACE_NORMAL, end, y, row->is_dim ? dim_ink : value_ink,
                    row->value);
}

/* Where values stand: both axes in octaves. */
typedef struct scales {
    double x0, x1, y0, y1;
    double left, top, width, height;
} scales;

static bool is_plottable(double x, double y)
{
    return x > 0.0 && y > 0.0 && isfinite(x) && isfinite(y);
}

static void include(scales *s, double x, double y)
{
    if (!is_plottable(x, y))
        return;
    double u = fl_d_log2(x), v = fl_d_log2(y);
    s->x0 = fl_min(u, s->x0);
    s->x1 = fl_max(u, s->x1);
    s->y0 = fl_min(v, s->y0);
    s->y1 = fl_max(v, s->y1);
}

static void place(const scales *s, double x, double y, double *out_x, double *out_y)
{
    *out_x = s->left + (fl_d_log2(x) - s->x0) / (s->x1 - s->x0) * s->width;
    *out_y = s->top + (s->y1 - fl_d_log2(y)) / (s->y1 - s->y0) * s->height;
}

/* y after falling like x^-rate from (x0, y0). */
static double fallen(double x0, double y0, double x, double rate)
{
    return y0 * fl_d_exp2(-rate * (fl_d_log2(x) - fl_d_log2(x0)));
}

static bool find_scales(const vw_plot *plot, scales *s)
{
    s->x0 = s->y0 = (double)INFINITY;
    s->x1 = s->y1 = -(double)INFINITY;
    for (uint32_t i = 0; i < plot->count; i++)
        include(s, plot->x[i], plot->y[i]);
    for (uint32_t i = 0; i < plot->mark_count; i++)
        include(s, plot->marks[i].x, plot->marks[i].y);
    if (!(s->x0 <= s->x1))
        return false;
    if (plot->has_forecast && plot->count > 0) {
        uint32_t last = plot->count - 1;
        double x = plot->x[last], y = plot->y[last];
        if (is_plottable(x, y) && plot->end_x > x)
            include(s, plot->end_x, fallen(x, y, plot->end_x, plot->fast));
    }
    /* Air, and never a plot of one point. */
    s->x0 -= 0.3;
    s->x1 += 0.5;
    s->y0 -= 0.4;
    s->y1 += 0.4;
    return true;
}

static void draw_line(vw_overlay *overlay, const scales *s, const double a[2], const double b[2],
                      double thick, vw_ink ink)
{
    double x0, y0, x1, y1;
    if (!is_plottable(a[0], a[1]) || !is_plottable(b[0], b[1]))
        return;
    place(s, a[0], a[1], &x0, &y0);
    place(s, b[0], b[1], &x1, &y1);
    vw_overlay_line(overlay, x0, y0, x1, y1, thick, ink);
}

static void draw_forecast(const frame *f, const scales *s, const vw_plot *plot)
{
    uint32_t last = plot->count - 1;
    double x = plot->x[last], y = plot->y[last];
    const double rates[3] = {plot->slow, plot->fast, plot->rate};
    for (int i = 0; i < 3; i++) {
        double from[2] = {x, y}, to[2] = {plot->end_x, fallen(x, y, plot->end_x, rates[i])};
        draw_line(f->overlay, s, from, to, f->scale, i == 2 ? title_ink : bracket_ink);
    }
}

static void number(double value, char out[24])
{
    snprintf(out, 24, value >= 100.0 ? "%.0f" : "%.2g", value);
}

/* Ends of the axes as numbers, outside the plot. */
static void draw_axes(const frame *f, const scales *s, const vw_plot *plot)
{
    char text[48], value[24];
    vw_overlay_panel(f->overlay, s->left, s->top, s->width, s->height, 0.0, track_ink);
    number(fl_d_exp2(s->y1), value);
    double x = s->left - (vw_text_columns(value) + 1) * f->cell.width;
    vw_overlay_text(f->overlay, VW_FACE_NORMAL, x, s->top, dim_ink, value);
    number(fl_d_exp2(s->y0), value);
    x = s->left - (vw_text_columns(value) + 1) * f->cell.width;
    vw_overlay_text(f->overlay, VW_FACE_NORMAL, x, s->top + s->height - f->cell.height, dim_ink,
                    value);
    vw_overlay_text(f->overlay, VW_FACE_NORMAL,
                    s->left - (vw_text_columns(plot->y_unit) + 1) * f->cell.width,
                    s->top + (s->height - f->cell.height) / 2.0, dim_ink, plot->y_unit);
    number(fl_d_exp2(s->x1), value);
    snprintf(text, sizeof text, "%s %s", value, plot->x_unit);
    double right = s->left + s->width - vw_text_columns(text) * f->cell.width;
    vw_overlay_text(f->overlay, VW_FACE_NORMAL, right, s->top + s->height, dim_ink, text);
    number(fl_d_exp2(s->x0), value);
    snprintf(text, sizeof text, "%s %s", value, plot->x_unit);
    if (s->left + (vw_text_columns(text) + 1) * f->cell.width <= right)
        vw_overlay_text(f->overlay, VW_FACE_NORMAL, s->left, s->top + s->height, dim_ink, text);
}

static void draw_dot(const frame *f, double x, double y, double size, vw_ink ink)
{
    vw_overlay_panel(f->overlay, floor(x - size / 2.0), floor(y - size / 2.0), size, size,
                     size / 2.0, ink);
}

void vw_board_clear_label(vw_label *labels, uint32_t count, double height)
{
    vw_label *last = &labels[count - 1];
    for (uint32_t i = 0; i + 1 < count;) {
        const vw_label *other = &labels[i++];
        if (last->x < other->x + other->width && other->x < last->x + last->width &&
            last->y < other->y + height && other->y < last->y + height) {
            last->y = other->y + height;
            i = 0; /* Another may stand there. */
        }
    }
}

/* What other settings would buy, each with its sign beside it. */
static void draw_marks(const frame *f, const scales *s, const vw_plot *plot)
{
    vw_label labels[FL_COUNT_OF(plot->marks)];
    uint32_t count = 0;
    for (uint32_t i = 0; i < plot->mark_count; i++) {
        double x, y;
        const vw_mark *mark = &plot->marks[i];
        if (!is_plottable(mark->x, mark->y))
            continue;
        place(s, mark->x, mark->y, &x, &y);
        draw_dot(f, x, y, 5.0 * f->scale, value_ink);
        vw_label *label = &labels[count++];
        label->width = vw_text_columns(mark->sign) * f->cell.width;
        label->x = fl_min(x + 4.0 * f->scale, s->left + s->width - label->width);
        label->y = y - f->cell.height * 0.9;
        vw_board_clear_label(labels, count, f->cell.height);
        vw_overlay_text(f->overlay, VW_FACE_NORMAL, label->x, label->y, value_ink, mark->sign);
    }
}

static void draw_plot(const frame *f, const vw_plot *plot, double top)
{
    double gutter = 9.0 * f->cell.width;
    scales s = {.left = f->x + gutter,
                .top = top,
                .width = f->width - gutter,
                .height = (PLOT_ROWS - 1) * f->cell.height};
    if (s.width < 4.0 * f->cell.width || !find_scales(plot, &s))
        return;
    draw_axes(f, &s, plot);
    if (plot->has_forecast && plot->count > 0)
        draw_forecast(f, &s, plot);
    for (uint32_t i = 0; i < plot->count; i++) {
        const double b[2] = {plot->x[i], plot->y[i]};
        if (i > 0) {
            const double a[2] = {plot->x[i - 1], plot->y[i - 1]};
            draw_line(f->overlay, &s, a, b, 1.5 * f->scale, bar_ink);
        }
        double x, y;
        if (!is_plottable(b[0], b[1]))
            continue;
        place(&s, b[0], b[1], &x, &y);
        draw_dot(f, x, y, (i + 1 == plot->count ? 9.0 : 4.0) * f->scale, bar_ink);
    }
    draw_marks(f, &s, plot);
}

void vw_board_draw(const vw_board *board, vw_overlay *overlay, double right, double top,
                   double width, double bottom, double scale)
{
    double pad = floor(10.0 * scale), pad_y = floor(7.0 * scale);
    vw_cell cell = vw_overlay_cell(overlay, VW_FACE_NORMAL);
    double wanted = fl_min(vw_board_width(board, overlay, scale), width);
    double plot = board->has_plot ? (PLOT_ROWS + 0.5) * cell.height : 0.0;
    double room = bottom - top - 2.0 * pad_y - cell.height - plot;
    if (room < 0.0 || wanted < 2.0 * pad)
        return;
    uint32_t rows = fl_min_u32(board->row_count, (uint32_t)(room / cell.height));
    double height = 2.0 * pad_y + (rows + 1) * cell.height + plot;
    frame f = {.overlay = overlay,
               .x = right - wanted + pad,
               .y = top + pad_y,
               .width = wanted - 2.0 * pad,
               .scale = scale,
               .cell = cell,
               .columns = columns_of(board)};
    char title[VW_BOARD_LABEL];
    cut(board->title, (uint32_t)(f.width / cell.width), title);
    vw_overlay_panel(overlay, right - wanted, top, wanted, height, 6.0 * scale, panel_ink);
    vw_overlay_text(overlay, VW_FACE_NORMAL, f.x, f.y, title_ink, title);
    double y = f.y + cell.height;
    if (board->has_plot)
        draw_plot(&f, &board->plot, y + 0.25 * cell.height);
    y += plot;
    for (uint32_t i = 0; i < rows; i++, y += cell.height)
        draw_row(&f, &board->rows[i], y);
}
