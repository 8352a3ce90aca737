/* SPDX-License-Identifier: MIT */
#include "fuzz/render_small.h"

#include <math.h>
#include <string.h>

#include "fuzz/fuzz.h"

enum { SIDE = 4, DEPTH_MAX = 3, FLOATS = SIDE * SIDE * 3 };

/* False after located errors: a scene may be refused, but not silently. */
static bool render(const fl_scene *scene, fl_isa isa, float out_film[FLOATS], fl_diags *diags)
{
    fl_params params;
    fl_progress progress;
    fl_params_from_scene(&params, scene, false);
    params.width = params.height = SIDE;
    params.depth_limit = fl_min_u32(params.depth_limit, DEPTH_MAX);
    params.light_samples = 1;
    fl_compile_options options = {.has_isa = true, .isa = isa};
    fl_compiled *compiled = fl_compile(scene, &options, NULL, diags);
    MUST(!compiled == (diags->error_count > 0));
    bool ok = compiled && fl_params_check(&params, diags);
    if (ok) {
        fl_render *render = fl_render_create(&(fl_render_options){.thread_count = 1}, diags);
        MUST(render);
        fl_render_set_limits(render, &(fl_render_limits){.samples = 1});
        ok = fl_render_restart(render, compiled, &params, diags);
        if (ok) {
            MUST(fl_render_wait(render, -1.0));
            MUST(fl_render_mean(render, out_film, FLOATS, &progress));
            MUST(progress.complete_samples == 1);
        }
        fl_render_destroy(render);
    }
    MUST(ok == (diags->error_count == 0));
    fl_compiled_release(compiled);
    return ok;
}

static void check_diags(const fl_diags *diags)
{
    char text[256];
    for (uint32_t i = 0; i < diags->count; i++) {
        MUST(diags->items[i].message && diags->items[i].message[0]);
        fl_diag_format(&diags->items[i], text, sizeof text);
    }
}

void fuzz_render_small(const char *text, size_t bytes, bool is_lenient, const fl_files *files)
{
    fl_diags diags = {0};
    fl_parse_options options = {.is_lenient = is_lenient};
    fl_scene *scene = fl_scene_parse(text, bytes, "fuzz.scene", &options, files, &diags);
    MUST(!scene == (diags.error_count > 0));
    float film[2][FLOATS];
    if (scene && render(scene, FL_ISA_SCALAR, film[0], &diags)) {
        for (int i = 0; i < FLOATS; i++)
            MUST(isfinite(film[0][i]));
        MUST(render(scene, fl_cpu_best_isa(), film[1], &diags));
        MUST(memcmp(film[0], film[1], sizeof film[0]) == 0);
    }
    check_diags(&diags);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
}
