/* SPDX-License-Identifier: MIT
 *
 * A frame of a session: what the window and a replay both put on the screen.
 */
#ifndef VW_PRESENT_H
#define VW_PRESENT_H

#include "viewer/session.h"
#include "viewer/view.h"

/** Draw and swap; `is_newer`: the session's picture changed since it was presented last. False
 * after adding an error. */
bool vw_present(vw_view *view, vw_platform *platform, vw_session *session, bool is_newer,
                fl_diags *diags);

#endif
