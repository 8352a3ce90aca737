/* SPDX-License-Identifier: MIT */
#include "viewer/help.h"

#include <stdio.h>
#include <string.h>

enum {
    SIZE_MAX_PX = 14,
    SIZE_MIN_PX = 6,
    VALUE_COLUMNS = 9,
    KEYS_GAP = 2,
    HELP_GAP = 2,
    COLUMN_GAP = 4
};

static const vw_ink panel_ink = {14, 17, 22, 225};
static const vw_ink title_ink = {255, 176, 64, 255};
static const vw_ink keys_ink = {240, 242, 245, 255};
static const vw_ink help_ink = {176, 184, 194, 255};
static const vw_ink value_ink = {128, 206, 255, 255};

/* Two groups a page, one below or beside the other. */
static bool is_on_page(vw_group group, uint32_t page)
{
    return (uint32_t)group / 2 + 1 == page;
}

static uint32_t column_of(vw_group group, uint32_t columns)
{
    return columns > 1 ? (uint32_t)group % 2 : 0;
}

/* Text rows of the longest column: a title per group, a blank row between groups. */
static uint32_t row_count(uint32_t columns, uint32_t page)
{
    uint32_t rows[VW_HELP_COLUMNS] = {0};
    for (int group = 0; group < VW_GROUP_COUNT; group++) {
        if (!is_on_page((vw_group)group, page))
            continue;
        uint32_t *row = &rows[column_of((vw_group)group, columns)];
        *row += *row > 0 ? 2 : 1;
        for (size_t i = 0; i < vw_command_count; i++)
            *row += vw_commands[i].group == (vw_group)group;
    }
    return fl_max_u32(rows[0], rows[1]);
}

/* Size and place with that text; true: it fits. */
static bool try_size(vw_help *help, vw_cell cell, uint32_t columns, uint32_t keys, uint32_t text,
                     const vw_state *state)
{
    double margin = cell.height / 2.0;
    help->columns = columns;
    help->pad = cell.height;
    help->keys_width = (keys + KEYS_GAP) * cell.width;
    help->help_width = (text + HELP_GAP) * cell.width;
    help->column_width = help->keys_width + help->help_width + VALUE_COLUMNS * cell.width;
    help->width =
        columns * help->column_width + (columns - 1) * COLUMN_GAP * cell.width + 2.0 * help->pad;
    help->height = row_count(columns, state->help_page) * cell.height + 1.5 * help->pad;
    help->x = fl_max(0.0, floor(((double)state->width - help->width) / 2.0));
    help->y = fl_max(0.0, floor(((double)state->height - help->height) / 2.0));
    return help->width + 2.0 * margin <= (double)state->width &&
           help->height + 2.0 * margin <= (double)state->height;
}

/* The larger part of the window that it takes, up or across. */
static double part_of_window(const vw_help *help, const vw_state *state)
{
    return fl_max(help->width / (double)state->width, help->height / (double)state->height);
}

void vw_help_layout(vw_help *help, const vw_overlay *overlay, vw_platform *platform,
                    const vw_state *state, double scale)
{
    uint32_t keys = 0, text = 0;
    FL_ASSERT(vw_command_count <= VW_HELP_ROWS_MAX);
    for (size_t i = 0; i < vw_command_count; i++) {
        vw_words_keys(&vw_commands[i], state->keymap, platform, help->keys[i]);
        if (strcmp(vw_commands[i].name, "help") == 0)
            help->own_keys = help->keys[i];
        if (!is_on_page(vw_commands[i].group, state->help_page))
            continue;
        keys = fl_max_u32(keys, vw_text_columns(help->keys[i]));
        text = fl_max_u32(text, vw_text_columns(vw_commands[i].help));
    }
    uint32_t most = (uint32_t)(SIZE_MAX_PX * scale + 0.5),
             least = (uint32_t)(SIZE_MIN_PX * scale + 0.5);
    for (uint32_t size = most; size >= least; size--) {
        vw_cell cell = vw_overlay_cell_of(overlay, size);
        help->size_px = size;
        if (try_size(help, cell, 1, keys, text, state) ||
            try_size(help, cell, 2, keys, text, state))
            return;
    }
    /* Too small for all of it: as much as can be. */
    vw_cell cell = vw_overlay_cell_of(overlay, help->size_px);
    double part = part_of_window(help, state);
    try_size(help, cell, 1, keys, text, state);
    if (part_of_window(help, state) > part)
        try_size(help, cell, 2, keys, text, state);
}

static void draw_row(const vw_help *help, vw_overlay *overlay, const vw_state *state, size_t i,
                     double x, double y)
{
    vw_overlay_text(overlay, VW_FACE_HELP, x, y, keys_ink, help->keys[i]);
    vw_overlay_text(overlay, VW_FACE_HELP, x + help->keys_width, y, help_ink, vw_commands[i].help);
    if (vw_commands[i].value) {
        char value[VW_VALUE_MAX];
        vw_commands[i].value(state, value);
        vw_overlay_text(overlay, VW_FACE_HELP, x + help->keys_width + help->help_width, y,
                        value_ink, value);
    }
}

void vw_help_draw(const vw_help *help, vw_overlay *overlay, const vw_state *state)
{
    vw_cell cell = vw_overlay_cell(overlay, VW_FACE_HELP);
    double top = help->y + help->pad * 0.75;
    double y[VW_HELP_COLUMNS] = {top, top};
    vw_overlay_panel(overlay, help->x, help->y, help->width, help->height, help->pad * 0.6,
                     panel_ink);
    char page[VW_KEYS_MAX + 32];
    bool is_last = state->help_page == VW_HELP_PAGES;
    snprintf(page, sizeof page, "%u of %d   %s: %s", state->help_page, VW_HELP_PAGES,
             help->own_keys, is_last ? "close" : "next");
    vw_overlay_text(overlay, VW_FACE_HELP,
                    help->x + help->width - help->pad - vw_text_columns(page) * cell.width, top,
                    help_ink, page);
    for (int group = 0; group < VW_GROUP_COUNT; group++) {
        if (!is_on_page((vw_group)group, state->help_page))
            continue;
        uint32_t column = column_of((vw_group)group, help->columns);
        double x = help->x + help->pad + column * (help->column_width + COLUMN_GAP * cell.width);
        if (y[column] > top)
            y[column] += cell.height;
        vw_overlay_text(overlay, VW_FACE_HELP, x, y[column], title_ink, vw_group_titles[group]);
        y[column] += cell.height;
        for (size_t i = 0; i < vw_command_count; i++) {
            if (vw_commands[i].group == (vw_group)group) {
                draw_row(help, overlay, state, i, x, y[column]);
                y[column] += cell.height;
            }
        }
    }
}
