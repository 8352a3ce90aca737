/* SPDX-License-Identifier: MIT */
#include "viewer/history.h"

#include <string.h>

static vw_moment moment_of(const vw_state *state)
{
    return (vw_moment){.look = state->look,
                       .mode = state->mode,
                       .pivot = state->pivot,
                       .saved_aperture = state->saved_aperture,
                       .speed = {state->speed, state->speed}};
}

static bool is_same_moment(const vw_moment *a, const vw_moment *b)
{
    return vw_look_is_same(&a->look, &b->look) && a->mode == b->mode && a->pivot.x == b->pivot.x &&
           a->pivot.y == b->pivot.y && a->pivot.z == b->pivot.z;
}

static void push(vw_moment *list, uint32_t *count, const vw_moment *moment)
{
    if (*count == VW_HISTORY_MAX)
        memmove(list, list + 1, --*count * sizeof *list);
    list[(*count)++] = *moment;
}

void vw_history_begin(vw_history *history, const vw_state *state, bool forgets)
{
    if (forgets)
        history->past_count = history->future_count = 0;
    history->now = moment_of(state);
    history->speed = state->speed;
    history->cause = NULL;
}

static void rebase(vw_moment *moments, uint32_t count, const vw_look *before, const vw_look *start)
{
    for (uint32_t i = 0; i < count; i++)
        if (vw_look_rebase(&moments[i].look, before, start))
            moments[i].mode = VW_MODE_FLY;
}

void vw_history_rebase(vw_history *history, const vw_state *state, const vw_look *before)
{
    rebase(history->past, history->past_count, before, &state->start);
    rebase(history->future, history->future_count, before, &state->start);
    vw_history_begin(history, state, false);
}

void vw_history_note(vw_history *history, const vw_state *state, const vw_command *cause,
                     bool is_gesture)
{
    vw_moment now = moment_of(state);
    now.speed[0] = history->speed;
    history->speed = state->speed;
    if (is_same_moment(&now, &history->now))
        return;
    bool goes_on = is_gesture && cause && cause == history->cause &&
                   state->now_ms < history->changed_ms + VW_HISTORY_QUIET_MS;
    if (goes_on)
        now.speed[0] = history->now.speed[0];
    else
        push(history->past, &history->past_count, &history->now);
    history->future_count = 0;
    history->now = now;
    history->cause = cause;
    history->changed_ms = state->now_ms;
}

static vw_dirty go(vw_history *history, vw_state *state, bool is_undo)
{
    vw_moment *from = is_undo ? history->past : history->future;
    uint32_t *from_count = is_undo ? &history->past_count : &history->future_count;
    const char *what = is_undo ? "undo" : "redo";
    while (*from_count > 0 && is_same_moment(&from[*from_count - 1], &history->now))
        --*from_count; /* A scene that was read again made it the same. */
    if (*from_count == 0) {
        vw_state_say(state, "nothing to %s", what);
        return VW_DIRTY_WINDOW;
    }
    if (is_undo)
        push(history->future, &history->future_count, &history->now);
    else
        push(history->past, &history->past_count, &history->now);
    const double *speed = is_undo ? history->now.speed : from[*from_count - 1].speed;
    if (state->speed == speed[is_undo])
        state->speed = speed[!is_undo];
    history->speed = state->speed;
    history->now = from[--*from_count];
    history->cause = NULL;
    state->look = history->now.look;
    state->mode = history->now.mode;
    state->pivot = history->now.pivot;
    state->saved_aperture = history->now.saved_aperture;
    state->rack_left = 0;
    vw_state_say(state, "%s", what);
    return (vw_dirty)(VW_DIRTY_CAMERA | VW_DIRTY_TONEMAP | VW_DIRTY_LIMITS);
}

vw_dirty vw_history_undo(vw_history *history, vw_state *state)
{
    return go(history, state, true);
}

vw_dirty vw_history_redo(vw_history *history, vw_state *state)
{
    return go(history, state, false);
}
