/* SPDX-License-Identifier: MIT
 *
 * A checkpoint that passed its digest and yet is not what was written: the input changes bytes of a
 * true one (two bytes of place, one of value, again and again; a last odd byte cuts that many off
 * the end). Refused, or a render goes on from it; never anything else.
 */
#include <stdlib.h>
#include <string.h>

#include "core/firstlight.h"
#include "fuzz/fuzz.h"

enum { SIDE = 16, SAMPLES = 3 };

static fl_compiled *compiled;
static fl_params params;
static uint8_t *good;
static size_t good_bytes;
static fl_scene *scene; /* Its parameters borrow its lights. */

static void prepare(void)
{
    static const char text[] =
        "firstlight 1\nPerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n"
        "Lights { numLights 1 PointLight { position 2 3 4 color 1 1 1 } }\n"
        "Materials { numMaterials 1 Material { diffuseColor 0.8 0.5 0.2 } }\n"
        "Group { numObjects 1 MaterialIndex 0 Sphere { center 0 0 0 radius 1 } }\n";
    fl_diags diags = {0};
    void *data = NULL;
    scene = fl_scene_parse(text, sizeof text - 1, "base", &(fl_parse_options){0}, NULL, &diags);
    MUST(scene);
    compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, &diags);
    MUST(compiled);
    fl_params_from_scene(&params, scene, false);
    params.width = params.height = SIDE;
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = 1}, &diags);
    fl_render_set_limits(render, &(fl_render_limits){.samples = SAMPLES});
    MUST(fl_render_restart(render, compiled, &params, &diags));
    MUST(fl_render_wait(render, -1.0));
    MUST(fl_render_checkpoint(render, &data, &good_bytes, &diags) && data);
    good = data;
    fl_render_destroy(render);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    if (!good)
        prepare();
    uint8_t *blob = malloc(good_bytes);
    MUST(blob);
    memcpy(blob, good, good_bytes);
    size_t at = 0, blob_bytes = good_bytes;
    for (; at + 3 <= bytes; at += 3)
        blob[(data[at] | (size_t)data[at + 1] << 8) % good_bytes] = data[at + 2];
    if (at < bytes)
        blob_bytes -= data[at];
    fl_diags diags = {0};
    fl_progress progress;
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = 1}, &diags);
    MUST(render);
    fl_render_set_paused(render, true);
    fl_render_set_limits(render, &(fl_render_limits){.samples = 1});
    bool ok = fl_render_resume(render, compiled, &params, blob, blob_bytes, &diags);
    MUST(ok == (diags.error_count == 0));
    if (!ok) {
        MUST(fl_render_wait(render, -1.0)); /* From nothing. */
        fl_render_progress(render, &progress);
        MUST(progress.complete_samples == 1);
    }
    fl_render_destroy(render);
    fl_diags_deinit(&diags);
    free(blob);
    return 0;
}
