/* SPDX-License-Identifier: MIT
 *
 * A formatted scene says the same as the original, and formatting it again changes nothing.
 */
#include <string.h>

#include "fuzz/fuzz.h"
#include "core/firstlight.h"
#include "support/scene_dump.h"

/* A weight of -0, as -1 times 0 gives it in course texts, is written as 0: the same picture. */
static char *dump(const fl_scene *scene)
{
    char *text = scene_dump(scene);
    MUST(text);
    for (char *at = text; (at = strstr(at, " -0x0p+0"));)
        memmove(at + 1, at + 2, strlen(at + 2) + 1);
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    const char *text = (const char *)data;
    fl_diags diags = {0}, second = {0};
    fake_files files;
    fake_files_init(&files);
    fl_parse_options options = {.is_lenient = bytes & 1}, strict = {0};
    size_t formatted_bytes, again_bytes;
    char *formatted =
        fl_scene_format(text, bytes, "fuzz.scene", &options, &formatted_bytes, &diags);
    MUST(!formatted == (diags.error_count > 0));
    if (formatted) {
        char *again = fl_scene_format(formatted, formatted_bytes, "formatted", &strict,
                                      &again_bytes, &second);
        MUST(again && again_bytes == formatted_bytes);
        MUST(memcmp(formatted, again, again_bytes) == 0);
        free(again);
        fl_scene *scene = fl_scene_parse(text, bytes, "fuzz.scene", &options, &files.files, &diags);
        if (scene) {
            fl_scene *same = fl_scene_parse(formatted, formatted_bytes, "formatted", &strict,
                                            &files.files, &second);
            MUST(same);
            char *a = dump(scene), *b = dump(same);
            MUST(strcmp(a, b) == 0);
            free(a);
            free(b);
            fl_scene_destroy(same);
        }
        fl_scene_destroy(scene);
    }
    free(formatted);
    fl_diags_deinit(&diags);
    fl_diags_deinit(&second);
    return 0;
}
