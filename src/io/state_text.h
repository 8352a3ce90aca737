/* SPDX-License-Identifier: MIT
 *
 * Cameras and whole picture states as text: what the clipboard carries, what bookmarks are kept in
 * and what a saved picture says about itself, so that it opens again where it was. No state; any
 * thread.
 */
#ifndef FL_IO_STATE_TEXT_H
#define FL_IO_STATE_TEXT_H

#include "core/firstlight.h"
#include "io/digest.h"
#include "io/image_codec.h"
#include "io/light_text.h"

/** The camera with its lens as a block of scene text, every number read back exactly: `View NAME`,
 * or with view_name NULL a camera block (which in an orthographic one has no room for the lens).
 * Length as snprintf. */
size_t fl_camera_scene_text(const fl_camera *camera, const char *view_name, char *out,
                            size_t out_bytes);

/** The camera as command-line options on one line; perspective only. Length as snprintf. */
size_t fl_camera_options_text(const fl_camera *camera, char *out, size_t out_bytes);

/** Read either form, or text with both (then the block counts). What the text does not say (an
 * option, the picture's size) stays as it is in *camera. False: no camera in it; nothing changed,
 * nothing said. */
bool fl_camera_read_text(const char *text, size_t text_bytes, fl_camera *camera);

enum { FL_STATE_TEXT_MAX = 1024, FL_STATE_TEXTS = 8 };

/** Text keys of one saved picture; room for what fl_image_save takes. */
typedef struct fl_state_texts {
    char view[FL_STATE_TEXT_MAX], options[FL_STATE_TEXT_MAX], settings[FL_STATE_TEXT_MAX];
    char lights[FL_LIGHT_TEXT_MAX];
    char samples[32], error[96], film_sha256[FL_SHA256_HEX + 1];
    fl_image_text items[FL_STATE_TEXTS]; /**< Point into this struct and to the scene's path. */
} fl_state_texts;

/** Say everything that the picture depends on besides the scene's files: firstlight:scene, view,
 * settings, camera (as options), samples, rmse, film_sha256, and lights (empty while they are the
 * scene's). `scene_path` is borrowed; `scene` NULL: of a text of ours, without lights. */
void fl_state_texts_fill(fl_state_texts *out, const char *scene_path, const fl_scene *scene,
                         const fl_params *params, const fl_progress *progress,
                         const float *mean_rgb);

/** What a saved picture says. Zero-initialise; free with fl_saved_state_deinit. */
typedef struct fl_saved_state {
    char *scene_path; /**< As it is found now: as written, else from the picture's folder. Owned. */
    fl_dialect dialect;
    bool is_exact;    /**< With the dialect's own rules. */
    uint32_t samples; /**< Of every pixel. */
    fl_params params; /**< Camera and settings; nothing about lights, background or the layout. */
    char *lights;     /**< fl_lights_text, or empty: the scene's own. Owned. */
} fl_saved_state;

/** Whether the name is that of a picture in which a state could be. Touches no disk. */
bool fl_saved_state_is_for(const char *path);

/** Read a picture's state. False after adding an error: it has none, or its scene is gone. */
bool fl_saved_state_load(const char *path, fl_saved_state *out, fl_diags *diags);
void fl_saved_state_deinit(fl_saved_state *state);

/** Put the state over what the scene says: the same scene then gives the same bytes. Lights that
 * were changed go into the scene's arena; those of a scene with other lights since stay as they
 * are. False: no memory for them. */
bool fl_saved_state_apply(const fl_saved_state *state, fl_scene *scene, fl_params *params);

#endif
