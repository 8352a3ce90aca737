/* SPDX-License-Identifier: MIT */
#include "viewer/pace.h"

enum { FEW_RANKS = 8, FEW_SAMPLES = 4, RETRY_MS = 1, LOOK_SHARE = 6 };

void vw_pace_restart(vw_pace *pace, uint64_t newest, uint64_t now_ms)
{
    if (!pace->is_waiting)
        pace->since_ms = now_ms;
    pace->is_waiting = true;
    pace->generation = newest;
}

void vw_pace_shown(vw_pace *pace, const fl_progress *shown, uint64_t now_ms)
{
    pace->shown_ms = now_ms;
    pace->is_waiting = pace->is_waiting && shown->generation < pace->generation;
}

void vw_pace_took(vw_pace *pace, uint64_t ms)
{
    pace->took_ms = ms;
}

static uint64_t interval_ms(const fl_progress *shown)
{
    if (shown->complete_ranks < FEW_RANKS)
        return 33;
    if (shown->complete_samples <= FEW_SAMPLES)
        return 16;
    return shown->seconds < 1.0 ? 100 : 500;
}

uint64_t vw_pace_due_ms(const vw_pace *pace, const fl_progress *shown)
{
    if (!pace->is_waiting) {
        uint64_t least_ms = interval_ms(shown), rare_ms = (LOOK_SHARE + 1) * pace->took_ms;
        return pace->shown_ms + (least_ms > rare_ms ? least_ms : rare_ms);
    }
    uint64_t first_ms = pace->since_ms + VW_PACE_FIRST_MS;
    /* Rank 0 was not complete in time: soon again. */
    return pace->shown_ms < first_ms ? first_ms : pace->shown_ms + RETRY_MS;
}

uint64_t vw_pace_draw_from_ms(const vw_pace *pace)
{
    return pace->is_waiting ? pace->since_ms + VW_PACE_FIRST_MS : 0;
}

uint64_t vw_pace_held_until_ms(const vw_pace *pace)
{
    return pace->is_waiting ? pace->since_ms + VW_PACE_HOLD_MS : 0;
}
