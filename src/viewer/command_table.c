/* SPDX-License-Identifier: MIT */
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/command_run.h"

const char *const vw_group_titles[VW_GROUP_COUNT] = {"Move", "Lens", "Picture", "Understand",
                                                     "Program"};

/* clang-format off */
#define CTRL GLFW_MOD_CONTROL
#define SHIFT GLFW_MOD_SHIFT
#define KEY(mods, key, factor) {VW_BIND_PRESS, GLFW_KEY_##key, mods, factor}
#define HOLD(key, factor)      {VW_BIND_HOLD, GLFW_KEY_##key, 0, factor}
#define WHILE(key)             {VW_BIND_WHILE, GLFW_KEY_##key, 0, 1}
#define DRAG(button)           {VW_BIND_DRAG, GLFW_MOUSE_BUTTON_##button, 0, 1}
#define CLICK(mods, button)    {VW_BIND_CLICK, GLFW_MOUSE_BUTTON_##button, mods, 1}
#define DIGITS(mods) \
    {KEY(mods, 1, 1), KEY(mods, 2, 2), KEY(mods, 3, 3), KEY(mods, 4, 4), KEY(mods, 5, 5), \
     KEY(mods, 6, 6), KEY(mods, 7, 7), KEY(mods, 8, 8), KEY(mods, 9, 9)}
#define WHEEL(mods, factor)    {VW_BIND_WHEEL, 0, mods, factor}

enum {
    WINDOW = VW_DIRTY_WINDOW,
    TONEMAP = VW_DIRTY_TONEMAP,
    LIMITS = VW_DIRTY_LIMITS,
    CAMERA = VW_DIRTY_CAMERA,
    LIGHT = VW_DIRTY_LIGHT,
    COMPARE = VW_DIRTY_SHOW | VW_DIRTY_COMPARE
};

/* name, group, bindings, repeats, dirty, help, run, value */
const vw_command vw_commands[] = {
    {"forward", VW_GROUP_MOVE, {HOLD(W, 1), HOLD(S, -1)}, false, CAMERA,
     "fly forward, back (Shift fast, Alt slow)", vw_run_forward, NULL},
    {"strafe", VW_GROUP_MOVE, {HOLD(A, -1), HOLD(D, 1)}, false, CAMERA,
     "fly left, right", vw_run_strafe, NULL},
    {"rise", VW_GROUP_MOVE, {HOLD(E, 1), HOLD(Q, -1)}, false, CAMERA,
     "fly up, down", vw_run_rise, NULL},
    {"speed", VW_GROUP_MOVE,
     {KEY(0, EQUAL, 1), KEY(0, MINUS, -1), KEY(0, PAGE_UP, 1), KEY(0, PAGE_DOWN, -1)}, false,
     WINDOW,
     "flying speed \303\2272, \303\2672", vw_run_speed, vw_value_speed},
    {"look", VW_GROUP_MOVE, {DRAG(LEFT)}, false, CAMERA | WINDOW,
     "look around; orbit", vw_run_look, NULL},
    {"pan", VW_GROUP_MOVE, {DRAG(MIDDLE)}, false, CAMERA,
     "pan", vw_run_pan, NULL},
    {"dolly", VW_GROUP_MOVE, {DRAG(RIGHT)}, false, CAMERA,
     "move closer, away", vw_run_dolly, NULL},
    {"orbit", VW_GROUP_MOVE, {KEY(0, TAB, 1)}, false, CAMERA,
     "fly or orbit", vw_run_orbit, vw_value_mode},
    {"orbit-at", VW_GROUP_MOVE, {KEY(0, ENTER, 1)}, false, VW_DIRTY_ORBIT_AT,
     "turn to what is under the cursor, orbit it", vw_run_orbit_at, NULL},
    {"reset", VW_GROUP_MOVE, {KEY(0, R, 1)}, false, CAMERA | TONEMAP | LIMITS,
     "back to the scene's camera and settings", vw_run_reset, NULL},
    {"print", VW_GROUP_MOVE, {KEY(0, C, 1)}, false, VW_DIRTY_PRINT,
     "copy the camera, print it as options", vw_run_print, NULL},
    {"paste", VW_GROUP_MOVE, {KEY(CTRL, V, 1)}, false, VW_DIRTY_PASTE,
     "camera from the clipboard", vw_run_paste, NULL},
    {"undo", VW_GROUP_MOVE, {KEY(CTRL, Z, 1)}, true, VW_DIRTY_UNDO,
     "undo camera, lens, settings", vw_run_undo, NULL},
    {"redo", VW_GROUP_MOVE, {KEY(CTRL, Y, 1), KEY(CTRL | SHIFT, Z, 1)}, true, VW_DIRTY_REDO,
     "redo", vw_run_redo, NULL},
    {"recall", VW_GROUP_MOVE, DIGITS(0), false, VW_DIRTY_RECALL,
     "go to a bookmark", vw_run_recall, NULL},
    {"store", VW_GROUP_MOVE, DIGITS(CTRL), false, VW_DIRTY_STORE,
     "keep camera, lens, lights as a bookmark", vw_run_store, NULL},

    {"focus", VW_GROUP_LENS,
     {WHEEL(0, 2.5), KEY(0, COMMA, -1), KEY(0, PERIOD, 1), KEY(SHIFT, COMMA, -10),
      KEY(SHIFT, PERIOD, 10)}, true, CAMERA | WINDOW,
     "focus by 2 %, wheel 5 %, with Shift 22 %", vw_run_focus, vw_value_focus},
    {"focus-at", VW_GROUP_LENS, {CLICK(SHIFT, LEFT)}, false, VW_DIRTY_PICK,
     "focus at the point", vw_run_focus_at, NULL},
    {"focus-through", VW_GROUP_LENS, {CLICK(CTRL | SHIFT, LEFT)}, false, VW_DIRTY_PICK_THROUGH,
     "focus in the mirror, through glass", vw_run_focus_through, NULL},
    {"assist", VW_GROUP_LENS, {KEY(0, F, 1)}, false, VW_DIRTY_SHOW,
     "show the sharp band; rangefinder", vw_run_assist, vw_value_assist},
    {"rack", VW_GROUP_LENS, {KEY(0, G, 1)}, false, WINDOW,
     "pull focus between the two last picks", vw_run_rack, NULL},
    {"rack-time", VW_GROUP_LENS, {KEY(SHIFT, G, 1)}, false, WINDOW,
     "how long that takes", vw_run_rack_time, vw_value_rack},
    {"aperture", VW_GROUP_LENS,
     {KEY(0, LEFT_BRACKET, -1), KEY(0, RIGHT_BRACKET, 1), KEY(SHIFT, LEFT_BRACKET, -3),
      KEY(SHIFT, RIGHT_BRACKET, 3)}, true, CAMERA | WINDOW,
     "aperture by a third of a stop, a whole one", vw_run_aperture, vw_value_aperture},
    {"lens", VW_GROUP_LENS, {KEY(0, O, 1)}, false, CAMERA,
     "pinhole or lens", vw_run_lens, NULL},
    {"fov", VW_GROUP_LENS, {WHEEL(CTRL, 1)}, false, CAMERA | WINDOW,
     "field of view", vw_run_fov, vw_value_fov},

    {"region", VW_GROUP_PICTURE, {WHILE(Z)}, false, CAMERA | WINDOW,
     "hold and drag: only that part; tap: all", vw_run_region, NULL},
    {"light", VW_GROUP_PICTURE, {KEY(0, Y, 1), KEY(SHIFT, Y, -1)}, false, WINDOW,
     "pick a light to edit", vw_run_light_select, vw_value_light},
    {"light-switch", VW_GROUP_PICTURE, {KEY(0, U, 1)}, false, LIGHT | WINDOW,
     "that light off, on", vw_run_light_switch, NULL},
    {"light-intensity", VW_GROUP_PICTURE, {KEY(0, UP, 1), KEY(0, DOWN, -1)}, true, LIGHT | WINDOW,
     "that light brighter, darker", vw_run_light_intensity, NULL},
    {"light-warmth", VW_GROUP_PICTURE, {KEY(0, RIGHT, 1), KEY(0, LEFT, -1)}, true, LIGHT | WINDOW,
     "that light warmer, cooler", vw_run_light_warmth, NULL},
    {"light-radius", VW_GROUP_PICTURE, {KEY(CTRL, UP, 1), KEY(CTRL, DOWN, -1)}, true,
     CAMERA | WINDOW, "that light larger, smaller", vw_run_light_radius, NULL},
    {"light-side", VW_GROUP_PICTURE, {KEY(SHIFT, RIGHT, 1), KEY(SHIFT, LEFT, -1)}, true,
     CAMERA | WINDOW, "that light right, left", vw_run_light_side, NULL},
    {"light-rise", VW_GROUP_PICTURE, {KEY(SHIFT, UP, 1), KEY(SHIFT, DOWN, -1)}, true,
     CAMERA | WINDOW, "that light up, down", vw_run_light_rise, NULL},
    {"light-push", VW_GROUP_PICTURE, {KEY(CTRL | SHIFT, UP, 1), KEY(CTRL | SHIFT, DOWN, -1)}, true,
     CAMERA | WINDOW, "that light away, closer", vw_run_light_push, NULL},
    {"light-samples", VW_GROUP_PICTURE, {KEY(0, L, 1), KEY(SHIFT, L, -1)}, false, CAMERA | WINDOW,
     "samples of each light \303\2272, \303\2672", vw_run_light_samples, vw_value_light_samples},
    {"sample-cap", VW_GROUP_PICTURE, {KEY(0, X, 1), KEY(SHIFT, X, -1)}, false, LIMITS | WINDOW,
     "samples to stop at \303\2272, \303\2672", vw_run_sample_cap, vw_value_sample_cap},
    {"depth", VW_GROUP_PICTURE, {KEY(0, K, 1), KEY(SHIFT, K, -1)}, false, CAMERA | WINDOW,
     "bounces of light, one more, less", vw_run_depth, vw_value_depth},
    {"exposure", VW_GROUP_PICTURE, {KEY(0, B, 1), KEY(SHIFT, B, -1)}, true, TONEMAP | WINDOW,
     "brighter, darker by a quarter stop", vw_run_exposure, vw_value_exposure},
    {"pause", VW_GROUP_PICTURE, {KEY(0, P, 1)}, false, LIMITS,
     "pause, resume", vw_run_pause, vw_value_pause},
    {"pin", VW_GROUP_PICTURE, {KEY(0, V, 1)}, false, VW_DIRTY_PIN,
     "pin the picture to compare with", vw_run_pin, NULL},
    {"compare", VW_GROUP_PICTURE, {KEY(SHIFT, V, 1)}, false, COMPARE,
     "wipe at the cursor; difference", vw_run_compare, vw_value_compare},
    {"flip", VW_GROUP_PICTURE, {WHILE(SPACE)}, false, COMPARE,
     "while held: the pinned picture", vw_run_flip, NULL},

    {"layer", VW_GROUP_UNDERSTAND,
     {KEY(0, F2, 0), KEY(0, F3, 1), KEY(0, F4, 2), KEY(0, F5, 3), KEY(0, F6, 4), KEY(0, F7, 5),
      KEY(0, F8, 6), KEY(0, F9, 7), KEY(0, F10, 8),
      KEY(SHIFT, F8, 9)}, false, VW_DIRTY_SHOW,
     "the picture, or what is behind it", vw_run_layer, vw_value_layer},
    {"inspect", VW_GROUP_UNDERSTAND, {KEY(0, I, 1)}, false, WINDOW,
     "what is under the cursor", vw_run_inspect, vw_value_inspect},
    {"rays", VW_GROUP_UNDERSTAND, {CLICK(CTRL, LEFT)}, false, VW_DIRTY_RAYS | WINDOW,
     "print the rays of a sample there; again: the next", vw_run_rays, NULL},
    {"noise", VW_GROUP_UNDERSTAND, {KEY(0, N, 1)}, false, VW_DIRTY_SHOW,
     "noise: where it comes from, what helps", vw_run_noise, vw_value_noise},
    {"light-auto", VW_GROUP_UNDERSTAND, {KEY(SHIFT, N, 1)}, false, CAMERA | WINDOW,
     "take the light samples that N found best", vw_run_light_auto, vw_value_light_auto},
    {"needs", VW_GROUP_UNDERSTAND, {KEY(0, M, 1)}, false, VW_DIRTY_SHOW,
     "meter: what the scene needs, what that costs", vw_run_needs, vw_value_needs},
    {"trade", VW_GROUP_UNDERSTAND, {KEY(0, T, 1)}, false, VW_DIRTY_SHOW,
     "trade: error against time, other settings", vw_run_trade, vw_value_trade},
    {"stress", VW_GROUP_UNDERSTAND, {KEY(0, J, 1), KEY(SHIFT, J, -1)}, false, VW_DIRTY_SHOW,
     "stress lens: what changes at extremes", vw_run_stress, vw_value_stress},

    {"help", VW_GROUP_PROGRAM, {KEY(0, F1, 1), KEY(0, H, 1)}, false, WINDOW,
     "this help, next page", vw_run_help, NULL},
    {"hud", VW_GROUP_PROGRAM, {KEY(0, F11, 1)}, false, WINDOW,
     "status line", vw_run_hud, vw_value_hud},
    {"snapshot", VW_GROUP_PROGRAM, {KEY(0, F12, 1), KEY(CTRL, S, 1)}, false, VW_DIRTY_SNAPSHOT,
     "save the picture", vw_run_snapshot, NULL},
    {"reload", VW_GROUP_PROGRAM, {KEY(CTRL, R, 1)}, false, VW_DIRTY_SCENE,
     "read the scene again (done when it is saved)", vw_run_reload, NULL},
    {"escape", VW_GROUP_PROGRAM, {KEY(0, ESCAPE, 1)}, false,
     WINDOW | VW_DIRTY_QUIT | VW_DIRTY_SHOW,
     "close error, help, board; twice: quit", vw_run_escape, NULL},
    {"quit", VW_GROUP_PROGRAM, {KEY(CTRL, Q, 1)}, false, VW_DIRTY_QUIT,
     "quit", vw_run_quit, NULL},
};
/* clang-format on */

const size_t vw_command_count = FL_COUNT_OF(vw_commands);
