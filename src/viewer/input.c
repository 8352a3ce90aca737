/* SPDX-License-Identifier: MIT */
#include "viewer/input.h"

#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#define FAST_FACTOR 4.0
#define SLOW_FACTOR 0.25

static vw_dirty run(vw_input *input, vw_state *state, const vw_command *command,
                    vw_binding_kind kind, vw_amount amount)
{
    input->last = command;
    input->last_kind = kind;
    vw_dirty dirty = vw_command_run(command, state, amount);
    input->is_racking = state->rack_left > 0;
    return dirty;
}

/* One step of one held key. */
static vw_dirty move(vw_input *input, vw_state *state, int key)
{
    double factor;
    const vw_command *command = vw_command_find(state->keymap, VW_BIND_HOLD, key, 0, &factor);
    FL_ASSERT(command);
    if (input->held_mods & GLFW_MOD_SHIFT)
        factor *= FAST_FACTOR;
    if (input->held_mods & GLFW_MOD_ALT)
        factor *= SLOW_FACTOR;
    return run(input, state, command, VW_BIND_HOLD, (vw_amount){factor / VW_TICKS_PER_SECOND, 0.0});
}

const vw_pad_binding vw_pad_bindings[] = {
    {true, GLFW_GAMEPAD_AXIS_LEFT_X, "strafe", 1.0, 0.0},
    {true, GLFW_GAMEPAD_AXIS_LEFT_Y, "forward", -1.0, 0.0},
    {true, GLFW_GAMEPAD_AXIS_RIGHT_X, "look", 1.0, 0.0},
    {true, GLFW_GAMEPAD_AXIS_RIGHT_Y, "look", 0.0, 1.0},
    {true, GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER, "rise", 1.0, 0.0},
    {true, GLFW_GAMEPAD_AXIS_LEFT_TRIGGER, "rise", -1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_A, "focus-at", 0.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_B, "undo", 1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_X, "lens", 1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_Y, "assist", 1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_LEFT_BUMPER, "aperture", -1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER, "aperture", 1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_DPAD_LEFT, "focus", -1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_DPAD_RIGHT, "focus", 1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_DPAD_UP, "exposure", 1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_DPAD_DOWN, "exposure", -1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_START, "pause", 1.0, 0.0},
    {false, GLFW_GAMEPAD_BUTTON_BACK, "reset", 1.0, 0.0},
    {false, 0, NULL, 0.0, 0.0},
};

/* One step of the sticks: gently near the middle, by the square. */
static vw_dirty move_sticks(vw_input *input, vw_state *state)
{
    unsigned dirty = VW_DIRTY_NONE;
    double speed = (input->is_pad_fast ? FAST_FACTOR : 1.0) *
                   (input->is_pad_slow ? SLOW_FACTOR : 1.0) / VW_TICKS_PER_SECOND;
    for (const vw_pad_binding *b = vw_pad_bindings; b->command; b++) {
        double value = b->is_axis ? input->axes[b->code] : 0.0;
        if (value == 0.0)
            continue;
        const vw_command *command = vw_command_named(b->command);
        bool is_look = command->bindings[0].kind == VW_BIND_DRAG;
        double step = value * fabs(value) * speed * (is_look ? (double)state->picture_height : 1.0);
        dirty |= run(input, state, command, VW_BIND_HOLD, (vw_amount){b->x * step, b->y * step});
    }
    return (vw_dirty)dirty;
}

static vw_dirty axis_event(vw_input *input, const vw_event *event)
{
    if (event->code < 0 || event->code >= VW_AXIS_COUNT)
        return VW_DIRTY_NONE;
    input->axis_count -= input->axes[event->code] != 0.0;
    input->axes[event->code] = fl_clamp(event->x, -1.0, 1.0);
    input->axis_count += input->axes[event->code] != 0.0;
    return VW_DIRTY_NONE;
}

static vw_dirty pad_event(vw_input *input, vw_state *state, const vw_event *event)
{
    bool is_down = event->action == GLFW_PRESS;
    if (event->code == GLFW_GAMEPAD_BUTTON_LEFT_THUMB)
        input->is_pad_fast = is_down;
    if (event->code == GLFW_GAMEPAD_BUTTON_RIGHT_THUMB)
        input->is_pad_slow = is_down;
    for (const vw_pad_binding *b = vw_pad_bindings; b->command && is_down; b++) {
        if (b->is_axis || b->code != event->code)
            continue;
        const vw_command *command = vw_command_named(b->command);
        /* What a mouse points at, a gamepad has in the middle. */
        vw_amount amount = {b->x, b->y};
        if (command->bindings[0].kind == VW_BIND_CLICK)
            amount = (vw_amount){(double)state->picture_width / 2.0,
                                 (double)state->picture_height / 2.0};
        return run(input, state, command, VW_BIND_PRESS, amount);
    }
    return VW_DIRTY_NONE;
}

vw_dirty vw_input_advance(vw_input *input, vw_state *state, uint64_t ms)
{
    uint64_t until = ms * VW_TICKS_PER_SECOND / 1000;
    unsigned dirty = VW_DIRTY_NONE;
    for (; input->tick < until; input->tick++) {
        if (!vw_input_is_moving(input)) {
            input->tick = until;
            break;
        }
        if (state->rack_left > 0)
            dirty |= vw_state_rack_step(state);
        input->is_racking = state->rack_left > 0;
        if (input->axis_count > 0)
            dirty |= move_sticks(input, state);
        for (int key = 0; key < VW_KEY_COUNT; key++) {
            if (input->is_held[key]) {
                dirty |= move(input, state, key);
                input->has_moved[key] = true;
            }
        }
    }
    state->now_ms = ms > state->now_ms ? ms : state->now_ms;
    return (vw_dirty)dirty;
}

static vw_dirty end_while(vw_input *input, vw_state *state)
{
    const vw_command *command = input->while_on;
    input->while_on = NULL;
    if (state->is_region_armed)
        input->drag = NULL; /* It drew the region; it is not to turn the camera from here. */
    return command ? run(input, state, command, VW_BIND_WHILE, (vw_amount){0.0, 0.0})
                   : VW_DIRTY_NONE;
}

static vw_dirty release(vw_input *input, vw_state *state, int key)
{
    if (input->while_on && input->while_key == key)
        return end_while(input, state);
    if (!input->is_held[key])
        return VW_DIRTY_NONE;
    vw_dirty dirty = input->has_moved[key] ? VW_DIRTY_NONE : move(input, state, key);
    input->is_held[key] = false;
    input->held_count--;
    return dirty;
}

static vw_dirty press(vw_input *input, vw_state *state, int key, int mods, bool is_repeat)
{
    double factor;
    const vw_command *command = vw_command_find(state->keymap, VW_BIND_HOLD, key, mods, &factor);
    if (command) {
        if (!input->is_held[key] && !is_repeat) {
            input->is_held[key] = true;
            input->has_moved[key] = false;
            input->held_count++;
        }
        return VW_DIRTY_NONE;
    }
    command = vw_command_find(state->keymap, VW_BIND_WHILE, key, mods, &factor);
    if (command && !is_repeat && !input->while_on) {
        input->while_on = command;
        input->while_key = key;
        return run(input, state, command, VW_BIND_WHILE, (vw_amount){factor, 0.0});
    }
    command = vw_command_find(state->keymap, VW_BIND_PRESS, key, mods, &factor);
    if (!command || (is_repeat && !command->repeats))
        return VW_DIRTY_NONE;
    return run(input, state, command, VW_BIND_PRESS, (vw_amount){factor, 0.0});
}

static vw_dirty key_event(vw_input *input, vw_state *state, const vw_event *event)
{
    if (event->code < 0 || event->code >= VW_KEY_COUNT)
        return VW_DIRTY_NONE;
    int mod = vw_key_modifier(event->code);
    if (mod) {
        input->held_mods =
            event->action == GLFW_RELEASE ? input->held_mods & ~mod : input->held_mods | mod;
        return VW_DIRTY_NONE;
    }
    if (event->action == GLFW_RELEASE)
        return release(input, state, event->code);
    return press(input, state, event->code, event->mods | input->held_mods,
                 event->action == GLFW_REPEAT);
}

/* While the camera flies, Shift and Alt are its speed, also for the other hand. */
static int chord_mods(const vw_input *input, const vw_event *event)
{
    int mods = event->mods | input->held_mods;
    return input->held_count > 0 ? mods & ~(GLFW_MOD_SHIFT | GLFW_MOD_ALT) : mods;
}

static vw_amount picture_position(const vw_input *input, const vw_state *state)
{
    return (vw_amount){(input->cursor_x - state->picture_x) / state->picture_scale,
                       (input->cursor_y - state->picture_y) / state->picture_scale};
}

static vw_dirty button_event(vw_input *input, vw_state *state, const vw_event *event)
{
    if (event->code < 0 || event->code >= VW_BUTTON_COUNT)
        return VW_DIRTY_NONE;
    if (event->action == GLFW_RELEASE) {
        if (input->drag && input->drag_button == event->code)
            input->drag = NULL;
        return VW_DIRTY_NONE;
    }
    double factor;
    int mods = chord_mods(input, event);
    const vw_command *click =
        vw_command_find(state->keymap, VW_BIND_CLICK, event->code, mods, &factor);
    if (click)
        return run(input, state, click, VW_BIND_CLICK, picture_position(input, state));
    if (!input->drag) {
        input->drag = vw_command_find(state->keymap, VW_BIND_DRAG, event->code, mods, &factor);
        input->drag_button = event->code;
    }
    return VW_DIRTY_NONE;
}

static vw_dirty cursor_event(vw_input *input, vw_state *state, const vw_event *event)
{
    vw_amount moved = {(event->x - input->cursor_x) / state->picture_scale,
                       (event->y - input->cursor_y) / state->picture_scale};
    input->cursor_x = event->x;
    input->cursor_y = event->y;
    vw_amount position = picture_position(input, state);
    state->cursor_x = position.x;
    state->cursor_y = position.y;
    unsigned dirty = state->is_inspecting ? VW_DIRTY_WINDOW : VW_DIRTY_NONE;
    if (state->compare == VW_COMPARE_WIPE)
        dirty |= VW_DIRTY_SHOW;
    if (input->drag && (moved.x != 0.0 || moved.y != 0.0))
        dirty |= run(input, state, input->drag, VW_BIND_DRAG, moved);
    return (vw_dirty)dirty;
}

static vw_dirty scroll_event(vw_input *input, vw_state *state, const vw_event *event)
{
    double factor;
    const vw_command *command =
        vw_command_find(state->keymap, VW_BIND_WHEEL, 0, chord_mods(input, event), &factor);
    if (!command || event->y == 0.0)
        return VW_DIRTY_NONE;
    return run(input, state, command, VW_BIND_WHEEL, (vw_amount){factor * event->y, 0.0});
}

static vw_dirty release_all(vw_input *input, vw_state *state)
{
    memset(input->is_held, 0, sizeof input->is_held);
    input->held_count = 0;
    input->held_mods = 0;
    input->drag = NULL;
    memset(input->axes, 0, sizeof input->axes);
    input->axis_count = 0;
    input->is_pad_fast = input->is_pad_slow = false;
    return end_while(input, state);
}

vw_dirty vw_input_event(vw_input *input, vw_state *state, const vw_event *event, uint64_t ms)
{
    unsigned dirty = vw_input_advance(input, state, ms);
    switch (event->kind) {
    case VW_EVENT_KEY:
        dirty |= key_event(input, state, event);
        break;
    case VW_EVENT_BUTTON:
        dirty |= button_event(input, state, event);
        break;
    case VW_EVENT_CURSOR:
        dirty |= cursor_event(input, state, event);
        break;
    case VW_EVENT_SCROLL:
        dirty |= scroll_event(input, state, event);
        break;
    case VW_EVENT_FOCUS:
        dirty |= release_all(input, state);
        break;
    case VW_EVENT_RESIZE:
        dirty |= vw_state_resize(state, event->width, event->height);
        break;
    case VW_EVENT_AXIS:
        dirty |= axis_event(input, event);
        break;
    case VW_EVENT_PAD:
        dirty |= pad_event(input, state, event);
        break;
    case VW_EVENT_SCALE:
        state->text_scale = event->x;
        dirty |= VW_DIRTY_WINDOW;
        break;
    case VW_EVENT_ICONIFY:
        state->is_hidden = event->action == GLFW_PRESS;
        dirty |= VW_DIRTY_LIMITS;
        break;
    case VW_EVENT_RELOAD:
        dirty |= VW_DIRTY_SCENE;
        break;
    case VW_EVENT_CLOSE:
        dirty |= VW_DIRTY_QUIT;
        break;
    case VW_EVENT_DROP:
    case VW_EVENT_PASTE:
        break;
    }
    return (vw_dirty)dirty;
}

bool vw_input_is_moving(const vw_input *input)
{
    return input->held_count > 0 || input->axis_count > 0 || input->is_racking;
}

uint64_t vw_input_next_tick_ms(const vw_input *input)
{
    return ((input->tick + 1) * 1000 + VW_TICKS_PER_SECOND - 1) / VW_TICKS_PER_SECOND;
}
