/* SPDX-License-Identifier: MIT
 *
 * Scenes for viewer tests: read, parse and compile a file, or what a saved picture names, as the
 * program does, without options. The loader's context, if there is one, is a uint32_t: how many
 * triangles of a mesh are not many yet (fl_compile_options.quick_above).
 */
#ifndef VIEWER_LOADER_H
#define VIEWER_LOADER_H

#include <stdio.h>
#include <stdlib.h>

#include "io/files.h"
#include "io/state_text.h"
#include "viewer/viewer.h"

static inline bool viewer_test_load(void *context, const char *path, vw_scene *out, fl_diags *diags)
{
    size_t bytes;
    fl_saved_state state = {0};
    fl_file_list_add(&out->files, path);
    if (fl_saved_state_is_for(path) && !fl_saved_state_load(path, &state, diags))
        return false;
    if (state.scene_path)
        snprintf(out->path, sizeof out->path, "%s", path = state.scene_path);
    if (state.scene_path)
        fl_file_list_add(&out->files, path);
    fl_files files = fl_files_listed(&out->files);
    char *text =
        fl_file_load(path, "scene", FL_SCENE_FILE_MAX_BYTES, (fl_loc){.file = path}, diags, &bytes);
    fl_parse_options parse = {0};
    fl_compile_options compile = {.quick_above = context ? *(const uint32_t *)context : 0};
    if (text)
        out->scene = fl_scene_parse(text, bytes, path, &parse, &files, diags);
    free(text);
    out->compiled = out->scene ? fl_compile(out->scene, &compile, NULL, diags) : NULL;
    if (out->compiled) {
        fl_params_from_scene(&out->params, out->scene, state.is_exact);
        if (state.scene_path)
            fl_saved_state_apply(&state, out->scene, &out->params);
        out->samples = state.samples;
    } else {
        fl_scene_destroy(out->scene);
        *out = (vw_scene){.files = out->files};
    }
    fl_saved_state_deinit(&state);
    return out->compiled != NULL;
}

#define VIEWER_TEST_SCENE FL_SOURCE_DIR "/tests/viewer/three.txt"

static inline vw_options viewer_test_options(void)
{
    return (vw_options){.loader = {.load = viewer_test_load}, .thread_count = 2, .is_quiet = true};
}

#endif
