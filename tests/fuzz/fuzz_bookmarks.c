/* SPDX-License-Identifier: MIT
 *
 * The bookmarks beside a scene: cameras and lights that are read are the same when the file is
 * written anew. Reading them opens no other file.
 */
#include <string.h>

#include "fuzz/fuzz.h"
#include "io/digest.h"
#include "io/files.h"
#include "io/image_file.h"
#include "viewer/bookmarks.h"

static const uint8_t *input;
static size_t input_bytes, written_bytes;
static char *written;

char *fl_file_load(const char *path, const char *what, size_t max_bytes, fl_loc loc,
                   fl_diags *diags, size_t *out_bytes)
{
    (void)path, (void)what, (void)max_bytes, (void)loc, (void)diags;
    char *text = malloc(input_bytes + 1);
    MUST(text);
    memcpy(text, input, input_bytes);
    text[input_bytes] = '\0';
    *out_bytes = input_bytes;
    return text;
}

bool fl_file_save(const char *path, const void *data, size_t bytes, fl_diags *diags)
{
    (void)path, (void)diags;
    free(written);
    written = malloc(bytes + 1);
    MUST(written);
    memcpy(written, data, bytes);
    written_bytes = bytes;
    return true;
}

bool fl_image_load_text(const char *path, const char *key, fl_loc loc, fl_diags *diags,
                        char **out_text)
{
    (void)path, (void)key, (void)loc, (void)diags, (void)out_text;
    abort();
}

void fl_digest_sha256(const void *data, size_t bytes, char out_hex[FL_SHA256_HEX + 1])
{
    (void)data, (void)bytes, (void)out_hex;
    abort();
}

const fl_files fl_files_on_disk = {0};

/* The name of a scene that has a file of bookmarks. */
static const char *scene_path(void)
{
    static char folder[] = "/tmp/fuzz-bookmarks-XXXXXX", path[64], views[80];
    if (!path[0]) {
        MUST(mkdtemp(folder));
        snprintf(path, sizeof path, "%s/scene", folder);
        snprintf(views, sizeof views, "%s.views", path);
        FILE *file = fopen(views, "w");
        MUST(file && fclose(file) == 0);
    }
    return path;
}

static void check_same(const fl_camera *a, const fl_camera *b)
{
    const fl_vec3 *vectors[][2] = {
        {&a->center, &b->center}, {&a->direction, &b->direction}, {&a->up, &b->up}};
    MUST(memcmp(vectors[0][0], vectors[0][1], sizeof(fl_vec3)) == 0);
    for (int i = 1; i < 3; i++) /* of unit length again */
        MUST(fl_v3_length(fl_v3_sub(*vectors[i][0], *vectors[i][1])) <=
             1e-12 * fl_v3_length(*vectors[i][0]));
    MUST(a->aperture == b->aperture && a->focus == b->focus && a->fov_deg == b->fov_deg);
    MUST(a->exposure_ev == b->exposure_ev && a->blades == b->blades);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    static vw_bookmarks read, again;
    fl_diags diags = {0};
    input = data;
    input_bytes = bytes;
    bool ok = vw_bookmarks_load(&read, scene_path(), NULL, &diags);
    MUST(ok == (diags.error_count == 0));
    for (uint32_t slot = 1; slot <= VW_SLOT_COUNT && ok; slot++) {
        const fl_camera *camera = vw_bookmarks_find(&read, slot);
        char lights[FL_LIGHT_TEXT_MAX];
        memcpy(lights, vw_bookmarks_lights(&read, slot), sizeof lights);
        if (!camera)
            continue;
        const fl_camera copy = *camera;
        MUST(fl_v3_is_finite(copy.center) && fl_v3_is_finite(copy.direction) &&
             fl_v3_is_finite(copy.up));
        MUST(vw_bookmarks_store(&read, slot, &copy, lights, scene_path(), &diags));
        input = (const uint8_t *)written;
        input_bytes = written_bytes;
        MUST(vw_bookmarks_load(&again, scene_path(), NULL, &diags));
        for (uint32_t k = 0; k < VW_SLOT_COUNT; k++) {
            MUST(read.is_set[k] == again.is_set[k]);
            if (!read.is_set[k])
                continue;
            check_same(&read.cameras[k], &again.cameras[k]);
            MUST(strcmp(read.lights[k], again.lights[k]) == 0);
        }
    }
    fl_diags_deinit(&diags);
    return 0;
}
