/* SPDX-License-Identifier: MIT
 *
 * What a user of the viewer can change, as one plain value: copied, compared, tested without a
 * window. Commands are its only writers besides vw_state_init, the clock and a finished pick.
 */
#ifndef VW_STATE_H
#define VW_STATE_H

#include "core/firstlight.h"

/** Bounds at which the viewer stops and says so (decision 10 and the ranges of cli). */
enum {
    VW_LIGHT_SAMPLES_MAX = 256,
    VW_SAMPLE_CAP_MAX = 1 << 20,
    VW_MESSAGE_MAX = 128,
    VW_MESSAGE_MS = 2500, /**< How long a message stays. */
    VW_QUIT_MS = 3000,    /**< Within which the second Esc quits. */
    VW_SLOT_COUNT = 9,    /**< Bookmarks. */
    VW_LIGHTS_MAX = 16,   /**< In scenes with more they cannot be edited. */
    VW_MIX_MS = 700,      /**< A light that rests so long is edited no longer. */
    VW_HELP_PAGES = 3
};
#define VW_FOV_MIN_DEG     FL_FOV_MIN_DEG
#define VW_FOV_MAX_DEG     FL_FOV_MAX_DEG
#define VW_EXPOSURE_MAX_EV 20.0
#define VW_SPEED_MAX       1024.0
#define VW_FOCUS_RANGE                                                                             \
    1e3 /**< Stepping reaches from scene scale / 1e6 to scene scale * this, then infinity. */
#define VW_APERTURE_RANGE 1e3 /**< Largest lens by stepping, in scene scales. */

typedef enum vw_mode { VW_MODE_FLY, VW_MODE_ORBIT } vw_mode;

/** What is shown of the scene: the picture, or what stands behind its pixels. */
typedef enum vw_layer {
    VW_LAYER_BEAUTY,
    VW_LAYER_DEPTH,
    VW_LAYER_NORMAL,
    VW_LAYER_ALBEDO,
    VW_LAYER_SAMPLES,
    VW_LAYER_ERROR,
    VW_LAYER_COST,
    VW_LAYER_BLUR, /**< Circle of confusion. */
    VW_LAYER_OBJECTS,
    VW_LAYER_BRANCH, /**< Which kind of ray adds most. */
    VW_LAYER_COUNT
} vw_layer;
extern const char *const vw_layer_names[VW_LAYER_COUNT];

/** Help for the eye with focusing. */
typedef enum vw_assist {
    VW_ASSIST_OFF,
    VW_ASSIST_BAND,        /**< Tint what is blurred by less than a pixel. */
    VW_ASSIST_RANGEFINDER, /**< Pinhole views from the lens's left edge in red, right in cyan. */
    VW_ASSIST_COUNT
} vw_assist;

/** The board of figures at the right. */
typedef enum vw_panel {
    VW_PANEL_NONE,
    VW_PANEL_RAYS,  /**< The tree of rays of one sample. */
    VW_PANEL_NOISE, /**< Where the noise comes from, and what helps. */
    VW_PANEL_NEEDS, /**< What the scene uses, and what that costs. */
    VW_PANEL_TRADE, /**< Error against time, and what other settings would buy. */
    VW_PANEL_COUNT
} vw_panel;

/** Numbers at their ends: the picture is held against one that should be, or should not be, the
 * same. */
typedef enum vw_stress {
    VW_STRESS_OFF,
    VW_STRESS_DOUBLE,  /**< Traced in double. */
    VW_STRESS_SMALL,   /**< The whole scene a thousandth of its size. */
    VW_STRESS_LARGE,   /**< A million times its size. */
    VW_STRESS_PINHOLE, /**< Aperture 0. */
    VW_STRESS_WIDE,    /**< Aperture as large as the scene. */
    VW_STRESS_NEAR,    /**< Focus at a millionth of the scene's size. */
    VW_STRESS_FAR,     /**< Focus at 10^9 times. */
    VW_STRESS_COUNT
} vw_stress;
extern const char *const vw_stress_names[VW_STRESS_COUNT];

/** How the pinned picture is set against the present one. */
typedef enum vw_compare {
    VW_COMPARE_OFF,
    VW_COMPARE_WIPE,       /**< Pinned left of the cursor. */
    VW_COMPARE_DIFFERENCE, /**< Present minus pinned about middle grey. */
    VW_COMPARE_COUNT
} vw_compare;

/** What part of the picture or program a command made stale: the application acts on these bits. */
typedef enum vw_dirty {
    VW_DIRTY_NONE = 0,
    VW_DIRTY_WINDOW = 1 << 0,  /**< Overlays: draw again. */
    VW_DIRTY_TONEMAP = 1 << 1, /**< Same samples, other bytes. */
    VW_DIRTY_LIMITS = 1 << 2,  /**< When to stop, or pause: no restart. */
    VW_DIRTY_CAMERA = 1 << 3,  /**< Camera or any other parameter: restart. */
    VW_DIRTY_SCENE = 1 << 4,   /**< Read the scene file again. */
    VW_DIRTY_PICK = 1 << 5,    /**< Focus at (pick_x, pick_y), answer with vw_state_focus_at. */
    VW_DIRTY_SNAPSHOT = 1 << 6,
    VW_DIRTY_PRINT = 1 << 7, /**< Camera to standard output and clipboard. */
    VW_DIRTY_QUIT = 1 << 8,
    VW_DIRTY_SHOW = 1 << 9,          /**< The same samples are to be shown otherwise. */
    VW_DIRTY_PICK_THROUGH = 1 << 10, /**< As PICK, along mirrors and through glass. */
    VW_DIRTY_UNDO = 1 << 11,
    VW_DIRTY_REDO = 1 << 12,
    VW_DIRTY_RECALL = 1 << 13, /**< The camera of bookmark `slot`. */
    VW_DIRTY_STORE = 1 << 14,
    VW_DIRTY_PASTE = 1 << 15,    /**< The camera that the clipboard holds. */
    VW_DIRTY_PIN = 1 << 16,      /**< Keep or drop the picture as it is now. */
    VW_DIRTY_ORBIT_AT = 1 << 18, /**< Orbit what stands at the cursor. */
    VW_DIRTY_COMPARE = 1 << 19,  /**< The pinned picture is to be seen: say so if it cannot. */
    VW_DIRTY_RAYS = 1 << 17, /**< The tree of rays of sample `rays_sample` at (rays_x, rays_y). */
    /** The colour of the selected light; vw_session_answer turns it into TONEMAP or CAMERA. */
    VW_DIRTY_LIGHT = 1 << 24
} vw_dirty;

/** What decides the picture: everything that R puts back. */
typedef struct vw_look {
    fl_camera camera;
    uint32_t depth_limit;
    uint32_t light_samples; /**< 0: each light's own. */
    uint32_t sample_cap;
    uint32_t region[4];   /**< x, y, width, height: only that part of the picture; width 0: all. */
    uint32_t light_count; /**< 0: none that can be edited; the scene's own then. */
    fl_light lights[VW_LIGHTS_MAX];
    fl_vec3 lit_colors[VW_LIGHTS_MAX]; /**< What a light that is off (black) comes back to. */
} vw_look;

typedef struct vw_state {
    vw_look look, start;
    const struct vw_keymap *keymap; /**< Borrowed; NULL: the command table's own. */
    /* About the scene, set at load. */
    double scene_scale; /**< What motion and lens are scaled by: its radius or its focus, the
                           smaller. */
    fl_vec3 scene_center;
    uint32_t scene_light_samples; /**< What light_samples 0 amounts to: the lights' largest. */
    /* Moving. */
    vw_mode mode;
    fl_vec3 pivot;         /**< Orbit: what the camera turns about. */
    double speed;          /**< Factor on the flying speed. */
    double saved_aperture; /**< What O brings back. */
    double rack_focus[2];  /**< The two latest foci that were picked; 0: none yet. */
    double rack_from, rack_to;
    double rack_seconds;            /**< How long racking takes. */
    uint32_t rack_left, rack_ticks; /**< Steps of the clock to go; 0: not racking; of all. */
    bool is_region_armed, is_region_dragged; /**< While Z is down; a rectangle was begun. */
    double region_from[2], region_to[2];     /**< Its corners, picture pixels. */
    uint32_t light;                          /**< The one that is edited. */
    bool is_mixing;        /**< Its colour is: two pictures are mixed for the display. */
    uint64_t mix_until_ms; /**< When that ends if nothing else comes; log time. */
    uint32_t slot;         /**< Bookmark that a command means, 1 to VW_SLOT_COUNT. */
    /* What is shown. */
    vw_layer layer;
    vw_assist assist;
    vw_compare compare;
    bool is_flipped; /**< The pinned picture alone, while Space is down. */
    bool is_inspecting;
    vw_panel panel;
    vw_stress stress;
    uint32_t light_samples_best;          /**< As measured for this scene; 0: not measured. */
    uint32_t rays_x, rays_y, rays_sample; /**< Picture pixels. */
    double cursor_x, cursor_y;            /**< Picture pixels. */
    /* Window. */
    bool has_error;     /**< An error is shown; cleared, it goes with the next answer. */
    uint32_t help_page; /**< 1 to VW_HELP_PAGES; 0: no help. */
    bool is_hud_shown, is_paused;
    bool is_refining;       /**< Better hierarchies are on their way. */
    double text_scale;      /**< Pixels of text per point; 0: as 1. */
    bool is_hidden;         /**< The window is iconified: nothing is rendered or drawn. */
    uint32_t width, height; /**< Framebuffer, pixels. */
    bool follows_window;    /**< The picture takes the window's size; else it keeps its own and is
                               fitted in. */
    double picture_x, picture_y,
        picture_scale; /**< Where the picture stands in it; framebuffer pixels per pixel. */
    uint32_t picture_width, picture_height; /**< Of the render. */
    double pick_x, pick_y;                  /**< Picture pixels. */
    /* Clock and message; log time. */
    uint64_t now_ms, quit_armed_ms,
        message_until_ms; /**< quit_armed_ms: until when Esc quits; 0: not armed. */
    char message[VW_MESSAGE_MAX];
} vw_state;

/** Begin with a scene's parameters. Keeps nothing of *state but the clock, the window's size (0:
 * the picture's) and follows_window, which becomes false for pictures that cannot: crops, and
 * cameras whose field of view spans both axes. */
void vw_state_init(vw_state *state, const fl_params *params, const fl_compiled *compiled,
                   uint32_t sample_cap);

/** A scene that was read again: it becomes the new start, and what the user changed of the look
 * stays. */
void vw_state_rebase(vw_state *state, const fl_params *params, const fl_compiled *compiled,
                     uint32_t sample_cap);

/** The parameters of the picture to render now: `base` (the scene's) with the look over it. */
void vw_state_params(const vw_state *state, const fl_params *base, fl_params *out_params);

/** The region as it lies in the present picture; false: the whole picture is rendered. */
bool vw_state_region(const vw_state *state, uint32_t out_rect[4]);

/** The pixel of the whole picture that (0, 0) of the window's picture is, for `params` of
 * vw_state_params: not 0 in scenes that are crops. */
void vw_state_origin(const vw_state *state, const fl_params *params, double *out_x, double *out_y);

/** Say something on screen. */
void vw_state_say(vw_state *state, const char *format, ...) FL_PRINTF(2, 3);
/** The message to show now, or NULL. */
const char *vw_state_message(const vw_state *state);

/** Focus on a point at that distance along the viewing axis; not finite or <= 0: says that nothing
 * was hit. */
vw_dirty vw_state_focus_at(vw_state *state, double depth);

/** Whether both have the same lights; of other scenes: no. */
bool vw_lights_are_same(const vw_look *a, const vw_look *b);

/** Lights of another look of the same scene; and: a light that is on comes back to its colour. */
void vw_look_take_lights(vw_look *look, const vw_look *from);
void vw_look_take_lit_colors(vw_look *look);

/** `before` was the scene's start and `start` is now: what the look had of the one becomes that of
 * the other, what was changed stays, of the camera part by part; lights only while they are as
 * many. True: the camera stands elsewhere. */
bool vw_look_rebase(vw_look *look, const vw_look *before, const vw_look *start);

/** Whether both ask for the same picture, exposure and limits included. */
bool vw_look_is_same(const vw_look *a, const vw_look *b);

/** One step of 1/60 s of a focus on its way. */
vw_dirty vw_state_rack_step(vw_state *state);

/** The framebuffer's size changed, or was only uncovered (the same size): dirty accordingly. */
vw_dirty vw_state_resize(vw_state *state, uint32_t width, uint32_t height);

#endif
