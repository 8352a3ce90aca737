/* SPDX-License-Identifier: MIT
 *
 * What a saved picture says about itself: the texts of its keys, with '|' between them. A state
 * that is read and passes the check of parameters lies in every range, and written out it reads
 * the same. The picture file itself is not there: its reader is replaced here.
 */
#include <string.h>

#include "fuzz/fuzz.h"
#include "io/digest.h"
#include "io/image_file.h"
#include "io/state_text.h"

static const uint8_t *input;
static size_t input_bytes;

bool fl_image_load_text(const char *path, const char *key, fl_loc loc, fl_diags *diags,
                        char **out_text)
{
    static const char *const keys[] = {"firstlight:view", "firstlight:settings",
                                       "firstlight:samples"};
    (void)path;
    (void)loc;
    (void)diags;
    const uint8_t *at = input, *end = input + input_bytes;
    *out_text = NULL;
    if (strcmp(key, "firstlight:scene") == 0) {
        *out_text = calloc(1, 8);
        MUST(*out_text);
        memcpy(*out_text, "/", 2); /* there is one everywhere */
        return true;
    }
    for (size_t i = 0; i < FL_COUNT_OF(keys); i++) {
        const uint8_t *bar = end > at ? memchr(at, '|', (size_t)(end - at)) : NULL;
        size_t bytes = (size_t)((bar ? bar : end) - at);
        if (strcmp(key, keys[i]) == 0) {
            *out_text = calloc(1, bytes + 1);
            MUST(*out_text);
            memcpy(*out_text, at, bytes);
            return true;
        }
        if (!bar)
            return true;
        at = bar + 1;
    }
    return true;
}

void fl_digest_sha256(const void *data, size_t bytes, char out_hex[FL_SHA256_HEX + 1])
{
    (void)data;
    (void)bytes;
    memset(out_hex, '0', FL_SHA256_HEX);
    out_hex[FL_SHA256_HEX] = '\0';
}

/* Nothing in a state is a reason to open files. */
const fl_files fl_files_on_disk = {0};

static void check_written(const fl_params *params)
{
    char text[4096];
    fl_camera again = params->camera;
    size_t bytes = fl_camera_scene_text(&params->camera, "v", text, sizeof text);
    MUST(bytes < sizeof text && strlen(text) == bytes);
    MUST(fl_camera_read_text(text, bytes, &again));
    MUST(memcmp(&again.center, &params->camera.center, sizeof again.center) == 0);
    MUST(again.aperture == params->camera.aperture);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    static const char base[] =
        "firstlight 1\nPerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n";
    fl_diags diags = {0};
    fl_saved_state state;
    fl_params params;
    input = data;
    input_bytes = bytes;
    bool ok = fl_saved_state_load("picture.png", &state, &diags);
    MUST(ok == (diags.error_count == 0));
    fl_scene *scene =
        fl_scene_parse(base, sizeof base - 1, "base", &(fl_parse_options){0}, NULL, &diags);
    MUST(scene);
    fl_params_from_scene(&params, scene, false);
    if (ok) {
        fl_saved_state_apply(&state, scene, &params);
        if (fl_params_check(&params, &diags)) {
            MUST(params.sampler <= FL_SAMPLER_PADDED);
            MUST(params.solver <= FL_REVOLVE_MAX_STARTS);
            MUST(params.width >= 1 && params.width <= FL_SIDE_MAX);
            check_written(&params);
        }
    }
    fl_scene_destroy(scene);
    fl_saved_state_deinit(&state);
    fl_diags_deinit(&diags);
    return 0;
}
