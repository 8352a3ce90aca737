/* SPDX-License-Identifier: MIT
 *
 * What tests of sessions share: a folder of their own, a session on a scene, keys and clicks.
 */
#ifndef VIEWER_KIT_H
#define VIEWER_KIT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/session.h"
#include "viewer_loader.h"

static char folder[] = "firstlight-viewer-XXXXXX";

static inline int make_folder(void **unused)
{
    (void)unused;
    return mkdtemp(folder) ? 0 : -1;
}

static inline void path_in_folder(const char *name, char out[256])
{
    snprintf(out, 256, "%s/%s", folder, name);
}

static inline void write_file(const char *name, const char *text, char out_path[256])
{
    path_in_folder(name, out_path);
    FILE *file = fopen(out_path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* Only what a test names: a file that it does not know of is a finding. */
static inline int remove_files(const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        char path[256];
        path_in_folder(names[i], path);
        unlink(path);
    }
    return rmdir(folder);
}

static inline void open_session(vw_session *session, const vw_options *options, const char *path)
{
    fl_diags diags = {0};
    if (!vw_session_open(session, options, path, 0, 0, &diags))
        fail_msg("%s", diags.items[0].message);
    assert_true(vw_session_start(session, NULL, NULL, &diags));
    assert_int_equal(diags.error_count, 0);
}

/* Handled as the window does. */
static inline vw_dirty send(vw_session *session, const vw_event *event, uint64_t ms)
{
    fl_diags diags = {0};
    vw_dirty dirty = vw_input_event(&session->input, &session->state, event, ms);
    dirty = vw_session_answer(session, dirty, &diags);
    assert_int_equal(diags.error_count, 0);
    return dirty;
}

/* Press and release. */
static inline vw_dirty tap(vw_session *session, int key, int mods, uint64_t ms)
{
    unsigned all = 0;
    for (int action = GLFW_PRESS; action >= GLFW_RELEASE; action--) {
        vw_event event = {.kind = VW_EVENT_KEY, .code = key, .action = action, .mods = mods};
        all |= send(session, &event, ms);
    }
    return (vw_dirty)all;
}

#endif
