/* SPDX-License-Identifier: MIT
 *
 * Layer 9: the public face of the core. Everything outside src/core includes this header and no other of the core.
 *
 * The way through: fl_scene_parse (text to scene) - fl_compile (scene to compiled scene) - fl_render_restart (compiled
 * scene and parameters to a progressive film) - fl_render_display or fl_render_mean (film to bytes).
 */
#ifndef FL_FIRSTLIGHT_H
#define FL_FIRSTLIGHT_H

#include "core/aov.h"
#include "core/arena.h"
#include "core/compile.h"
#include "core/cpu.h"
#include "core/diag.h"
#include "core/film.h"
#include "core/format.h"
#include "core/frame.h"
#include "core/grammar.h"
#include "core/image.h"
#include "core/math64.h"
#include "core/mesh.h"
#include "core/noise.h"
#include "core/number.h"
#include "core/params.h"
#include "core/parse.h"
#include "core/pool.h"
#include "core/raytree.h"
#include "core/refine.h"
#include "core/render.h"
#include "core/scene.h"
#include "core/scene_map.h"
#include "core/tonemap.h"
#include "core/trace.h"

#endif
