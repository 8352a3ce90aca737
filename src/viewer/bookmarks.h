/* SPDX-License-Identifier: MIT
 *
 * Nine cameras with their lenses beside a scene: SCENE.views, scene text of `View 1` to `View 9`
 * blocks that anyone may edit or paste into the scene itself, also while it is shown: only the
 * blocks that are stored are replaced. Lights that were changed stand in a comment, `# lights 3
 * ...`. Views of the scene that are called by a digit, and then the others in turn, stand in slots
 * that the file leaves empty.
 */
#ifndef VW_BOOKMARKS_H
#define VW_BOOKMARKS_H

#include "io/light_text.h"
#include "viewer/state.h"

/** Zero-initialise. */
typedef struct vw_bookmarks {
    bool is_set[VW_SLOT_COUNT];   /**< In the file, or stored since. */
    bool is_scene[VW_SLOT_COUNT]; /**< From the scene's own views: not written. */
    fl_camera cameras[VW_SLOT_COUNT];
    char lights[VW_SLOT_COUNT][FL_LIGHT_TEXT_MAX]; /**< fl_lights_text; empty: the scene's. */
    bool is_unsaved[VW_SLOT_COUNT];                /**< Stored, and not in the file yet. */
} vw_bookmarks;

/** Read what belongs to a scene; no file is no error. `scene` may be NULL. False: the file is
 * broken, after adding its errors. */
bool vw_bookmarks_load(vw_bookmarks *bookmarks, const char *scene_path, const fl_scene *scene,
                       fl_diags *diags);

/** The scene was read again: its views, or no longer (NULL), stand in slots that are left. */
void vw_bookmarks_take_scene(vw_bookmarks *bookmarks, const fl_scene *scene);

/** Put a camera and lights (fl_lights_text, or empty) into slot 1 to VW_SLOT_COUNT, and, unless
 * scene_path is NULL, into the file, which is read again for that and replaced at once. False after
 * adding an error, of a file with errors too: the camera is then in the slot, and comes into the
 * file with the next that does. */
bool vw_bookmarks_store(vw_bookmarks *bookmarks, uint32_t slot, const fl_camera *camera,
                        const char *lights, const char *scene_path, fl_diags *diags);

/** The camera of a slot; NULL: empty. */
const fl_camera *vw_bookmarks_find(const vw_bookmarks *bookmarks, uint32_t slot);

/** The lights of a slot as fl_lights_text; empty: the scene's. */
const char *vw_bookmarks_lights(const vw_bookmarks *bookmarks, uint32_t slot);

#endif
