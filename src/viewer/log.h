/* SPDX-License-Identifier: MIT
 *
 * Recorded input, one line per event (decision 20):
 *
 *     firstlight-log 1 640x480 scenes/vase.scene
 *     120 key W press
 *     620 key W release
 *     700 button LEFT press SHIFT
 *     716 cursor 320.5 200
 *     900 scroll 0 -1
 *     1000 resize 800 600
 *     1100 scale 2
 *     1200 drop other.scene
 *     1250 reload
 *     1300 paste --camera '0 1 5  0 0 0  0 1 0  40'
 *     1350 axis LEFT_Y -0.5
 *     1360 pad A press
 *     1400 iconify
 *     1450 restore
 *     1500 snapshot out.png 16
 *     1600 window shown.png 16
 *     2000 quit
 *
 * Times are whole milliseconds, never falling. Names are GLFW's (its prefixes may be written or
 * not); modifiers SHIFT CONTROL ALT SUPER may follow an event and are otherwise known from their
 * own keys. Blank lines and lines that begin with # say nothing.
 */
#ifndef VW_LOG_H
#define VW_LOG_H

#include <stdio.h>

#include "viewer/event.h"

typedef enum vw_log_kind {
    VW_LOG_EVENT,
    VW_LOG_SNAPSHOT,
    VW_LOG_WINDOW, /**< What the window shows, overlays and all, goes to a file. */
    VW_LOG_QUIT
} vw_log_kind;

typedef struct vw_log_entry {
    vw_log_kind kind;
    uint64_t ms;
    uint32_t line;
    vw_event event;
    char file[VW_PATH_MAX]; /**< Snapshot, window: where to. */
    uint32_t samples;       /**< Snapshot: exactly so many. */
} vw_log_entry;

typedef struct vw_log {
    uint32_t width, height; /**< Of the framebuffer at the start. */
    char scene[VW_PATH_MAX];
    vw_log_entry *entries;
    size_t entry_count;
} vw_log;

enum { VW_LOG_MAX_BYTES = 64 << 20, VW_LOG_SAMPLES_MAX = 1 << 20 };

/** Parse. `name` labels messages. False after adding at least one located error; *out is then
 * empty. */
bool vw_log_parse(const char *text, size_t text_bytes, const char *name, vw_log *out,
                  fl_diags *diags);
void vw_log_deinit(vw_log *log);

/** Write the first line, an event, a snapshot or the end, as vw_log_parse reads them. */
void vw_log_write_header(FILE *file, uint32_t width, uint32_t height, const char *scene);
void vw_log_write_event(FILE *file, uint64_t ms, const vw_event *event);
void vw_log_write_snapshot(FILE *file, uint64_t ms, const char *path, uint32_t samples);
void vw_log_write_quit(FILE *file, uint64_t ms);

#endif
