/* SPDX-License-Identifier: MIT
 *
 * The viewer's words: labels of keys, the status line, the window's title, the controls page. Text
 * only.
 */
#ifndef VW_WORDS_H
#define VW_WORDS_H

#include "viewer/command.h"
#include "viewer/platform.h"

enum { VW_KEYS_MAX = 64, VW_STATUS_MAX = 20 };

/** The inputs of a command as people read them ("[ ]  Shift+[ ]", "left drag"). Keys are named as
 * `platform` says the user's keyboard prints them; NULL: as on a US keyboard. */
void vw_words_keys(const vw_command *command, const vw_keymap *keymap, vw_platform *platform,
                   char out[VW_KEYS_MAX]);

/** Where to begin, for who has just opened the window: help, look, fly, focus. */
void vw_words_welcome(const vw_keymap *keymap, char *out, size_t out_bytes);

/** One item of the status line: a dim label (may be empty) and a bright value. */
typedef struct vw_status {
    char label[24], value[112];
    bool is_alarm;
} vw_status;

/** The status line; returns how many items were written. */
uint32_t vw_words_status(const vw_state *state, const fl_progress *progress,
                         vw_status out[VW_STATUS_MAX]);

/** Samples a pixel, the mean where they are uneven: what was asked for and what is saved. */
uint32_t vw_words_samples(const fl_progress *progress);

/** A part of white as people read it: "0.41 %". */
void vw_words_percent(double value, char out[24]);
/** "0.3 s", "14 s", "3 min", "2.1 h". */
void vw_words_duration(double seconds, char out[24]);

/** "11–19 s", "50 s–2 min". */
void vw_words_between(double low_seconds, double high_seconds, char out[64]);

/** Part of the work that is done, 0 to 1. */
double vw_words_done(const vw_state *state, const fl_progress *progress);

/** The window's title. */
void vw_words_title(const vw_state *state, const fl_progress *progress, const char *scene_path,
                    char *out, size_t out_bytes);

#endif
