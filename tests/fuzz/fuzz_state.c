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
                                       "firstlight:samples", "firstlight:lights"};
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

static const char base[] =
    "firstlight 1\nPerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n";
static const char base_lights[] =
    "Lights { DirectionalLight { direction 0 0 -1 color 1 1 1 }\n"
    "PointLight { position 1 2 3 color 1 1 1 attenuation 1 0 0.1 }\n"
    "DiskLight { position 0 5 0 direction 0 -1 0 radius 1 color 1 1 1 samples 4 twoSided 0 } }\n";

static void check_same_light(const fl_light *a, const fl_light *b)
{
    MUST(a->kind == b->kind && a->samples == b->samples && a->is_two_sided == b->is_two_sided);
    MUST(memcmp(&a->color, &b->color, sizeof a->color) == 0);
    MUST(memcmp(a->attenuation, b->attenuation, sizeof a->attenuation) == 0);
    MUST(a->kind == FL_LIGHT_DIRECTIONAL ||
         memcmp(&a->position, &b->position, sizeof a->position) == 0);
    MUST(a->kind == FL_LIGHT_POINT || fl_v3_length(fl_v3_sub(a->direction, b->direction)) <= 1e-5);
    MUST(a->kind != FL_LIGHT_DISK || a->radius == b->radius);
}

/* Lights that a picture brings stay within what any scene may say: as scene text they are read, and
 * the same; as the text of a picture they come back in every bit. */
static void check_lights(const fl_params *params, const fl_scene *before)
{
    static char text[1 << 16], line[FL_LIGHT_TEXT_MAX], again[FL_LIGHT_TEXT_MAX];
    fl_light copy[3];
    fl_diags diags = {0};
    MUST(params->light_count == FL_COUNT_OF(copy));
    for (size_t i = 0; i < FL_COUNT_OF(copy); i++) {
        const fl_light *light = &params->lights[i], *own = &before->lights[i];
        MUST(light->kind == own->kind && light->samples == own->samples);
        MUST(fl_v3_is_finite(light->position) && fl_v3_is_finite(light->direction));
        MUST(fl_v3_is_finite(light->color) && light->radius >= 0.0 && isfinite(light->radius));
    }
    memcpy(copy, before->lights, sizeof copy);
    fl_lights_text(params->lights, params->light_count, line);
    MUST(line[0] && fl_lights_read(line, copy, FL_COUNT_OF(copy)));
    fl_lights_text(copy, FL_COUNT_OF(copy), again);
    MUST(strcmp(line, again) == 0);
    memcpy(text, base, sizeof base - 1);
    size_t bytes = sizeof base - 1 +
                   fl_lights_scene_text(params->lights, params->light_count, text + sizeof base - 1,
                                        sizeof text - sizeof base);
    MUST(bytes < sizeof text);
    fl_scene *scene = fl_scene_parse(text, bytes, "lights", &(fl_parse_options){0}, NULL, &diags);
    MUST(scene && diags.error_count == 0 && scene->light_count == FL_COUNT_OF(copy));
    for (size_t i = 0; i < FL_COUNT_OF(copy); i++)
        check_same_light(&params->lights[i], &scene->lights[i]);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    fl_diags diags = {0};
    fl_saved_state state;
    fl_params params;
    char text[sizeof base + sizeof base_lights];
    snprintf(text, sizeof text, "%s%s", base, base_lights);
    input = data;
    input_bytes = bytes;
    bool ok = fl_saved_state_load("picture.png", &state, &diags);
    MUST(ok == (diags.error_count == 0));
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), "base", &(fl_parse_options){0}, NULL, &diags);
    MUST(scene);
    fl_params_from_scene(&params, scene, false);
    if (ok) {
        fl_saved_state_apply(&state, scene, &params);
        check_lights(&params, scene);
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
