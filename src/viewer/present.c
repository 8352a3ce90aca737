/* SPDX-License-Identifier: MIT */
#include "viewer/present.h"

enum { NOTES_BYTES = 1024 };

bool vw_present(vw_view *view, vw_platform *platform, vw_session *session, bool is_newer,
                fl_diags *diags)
{
    if (is_newer) {
        uint32_t width, height;
        const uint8_t *bytes = vw_session_window(session, &width, &height);
        vw_view_upload(view, bytes, width, height);
    }
    char notes[NOTES_BYTES];
    vw_session_notes(session, notes, sizeof notes);
    vw_board board;
    bool has_board = vw_session_board(session, &board);
    vw_texts texts = {
        .notes = notes, .error = session->error_text, .board = has_board ? &board : NULL};
    if (!vw_view_draw(view, &session->state, &session->progress, &texts, diags))
        return false;
    platform->ops->swap(platform);
    return true;
}
