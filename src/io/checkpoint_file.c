/* SPDX-License-Identifier: MIT */
#include "io/checkpoint_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/digest.h"
#include "io/files.h"
#include "io/state_text.h"

#define FIRST_LINE "firstlight checkpoint " FL_VERSION "\n"

/* Digest of a file's bytes behind those before: a chain, so that order counts. */
static bool add_file(const char *path, const char *what, char digest[FL_SHA256_HEX + 1],
                     fl_diags *diags)
{
    size_t bytes;
    char *text =
        fl_file_load(path, what, FL_CHECKPOINT_MAX_BYTES, (fl_loc){.file = path}, diags, &bytes);
    if (!text)
        return false;
    char both[2 * FL_SHA256_HEX + 1];
    memcpy(both, digest, FL_SHA256_HEX);
    fl_digest_sha256(text, bytes, both + FL_SHA256_HEX);
    fl_digest_sha256(both, 2 * FL_SHA256_HEX, digest);
    free(text);
    return true;
}

static bool scene_digest(const fl_scene *scene, char digest[FL_SHA256_HEX + 1], fl_diags *diags)
{
    memset(digest, '0', FL_SHA256_HEX);
    digest[FL_SHA256_HEX] = 0;
    bool is_read = add_file(scene->path, "scene", digest, diags);
    for (uint32_t i = 0; is_read && i < scene->mesh_count; i++)
        is_read = add_file(scene->meshes[i].path, "mesh", digest, diags);
    for (uint32_t i = 0; is_read && i < scene->image_count; i++)
        is_read = add_file(scene->images[i].path, "image", digest, diags);
    return is_read;
}

bool fl_checkpoint_key(const fl_scene *scene, const fl_params *params,
                       char out[FL_CHECKPOINT_KEY_BYTES], fl_diags *diags)
{
    char files[FL_SHA256_HEX + 1], camera[FL_SHA256_HEX + 1], settings[FL_SHA256_HEX + 1];
    if (!scene_digest(scene, files, diags))
        return false;
    fl_params p = *params;
    p.camera.exposure_ev = 0.0; /* Decides no sample. */
    static const float none[3];
    fl_state_texts texts;
    fl_state_texts_fill(&texts, scene->path, scene, &p, &(fl_progress){0}, none);
    fl_digest_sha256(texts.view, strlen(texts.view), camera);
    char both[sizeof texts.settings + sizeof texts.lights];
    int both_bytes = snprintf(both, sizeof both, "%s%s", texts.settings, texts.lights);
    fl_digest_sha256(both, (size_t)both_bytes, settings);
    int length = snprintf(out, FL_CHECKPOINT_KEY_BYTES, "scene %s\ncamera %s\nsettings %s\n", files,
                          camera, settings);
    FL_ASSERT(length > 0 && length < FL_CHECKPOINT_KEY_BYTES);
    return true;
}

bool fl_checkpoint_save(const char *path, const char *key, const void *data, size_t bytes,
                        fl_diags *diags)
{
    char head[FL_CHECKPOINT_KEY_BYTES + 256], digest[FL_SHA256_HEX + 1];
    fl_digest_sha256(data, bytes, digest);
    int length = snprintf(head, sizeof head, FIRST_LINE "%sdata %s\n", key, digest);
    FL_ASSERT(length > 0 && (size_t)length < sizeof head);
    char *file = malloc((size_t)length + bytes);
    if (!file)
        return fl_out_of_memory(diags, path);
    memcpy(file, head, (size_t)length);
    memcpy(file + length, data, bytes);
    bool is_saved = fl_file_save(path, file, (size_t)length + bytes, diags);
    free(file);
    return is_saved;
}

/* What differs between the file's key and the wanted one: its line's first word. */
static const char *difference(const char *text, const char *key)
{
    static const char *const names[] = {"scene", "camera", "settings"};
    static const char *const words[] = {"another scene, or one that has been changed",
                                        "another camera", "other settings"};
    for (size_t i = 0; i < FL_COUNT_OF(names); i++) {
        size_t line = strlen(names[i]) + 1 + FL_SHA256_HEX + 1;
        if (strncmp(text, key, line) != 0)
            return words[i];
        text += line;
        key += line;
    }
    return NULL;
}

bool fl_checkpoint_load(const char *path, const char *key, char **out_file, const void **out_data,
                        size_t *out_bytes, fl_diags *diags)
{
    *out_file = NULL;
    *out_data = NULL;
    if (access(path, F_OK) != 0)
        return true;
    fl_loc loc = {.file = path};
    size_t bytes, first = strlen(FIRST_LINE), head = first + strlen(key) + 5 + FL_SHA256_HEX + 1;
    char *text = fl_file_load(path, "checkpoint", FL_CHECKPOINT_MAX_BYTES, loc, diags, &bytes);
    if (!text)
        return false;
    const char *differs = NULL;
    char digest[FL_SHA256_HEX + 1];
    bool is_ours = bytes > 22 && memcmp(text, FIRST_LINE, 22) == 0;
    if (!is_ours)
        fl_error(diags, loc, "this is no checkpoint of firstlight; it is left as it is");
    else if (bytes < head || memcmp(text, FIRST_LINE, first) != 0)
        fl_error(diags, loc, "this checkpoint is of another version of firstlight, or cut off");
    else if ((differs = difference(text + first, key)) != NULL)
        fl_error(diags, loc, "this checkpoint was made of %s; remove it to begin anew", differs);
    else {
        fl_digest_sha256(text + head, bytes - head, digest);
        if (memcmp(text + head - FL_SHA256_HEX - 1, digest, FL_SHA256_HEX) == 0) {
            *out_file = text;
            *out_data = text + head;
            *out_bytes = bytes - head;
            return true;
        }
        fl_error(diags, loc,
                 "this checkpoint is damaged: its bytes are not those that were written");
    }
    free(text);
    return false;
}
