/* SPDX-License-Identifier: MIT */
#include "cli/noise.h"

#include <stdio.h>
#include <unistd.h>

#include "cli/load.h"

/* One line, rewritten in place. */
static void show_progress(const char *name, const fl_noise *noise, double seconds)
{
    double share =
        (double)fl_noise_steps(noise) / ((double)fl_noise_round_steps(noise) * FL_NOISE_ROUNDS);
    fprintf(stderr, "\r%s: noise split %3.0f %%, %.0f s left   ", name, 100.0 * share,
            seconds / share - seconds);
    fflush(stderr);
}

/* All rounds, or those until an interrupt once one is complete. */
static bool run_rounds(fl_noise *noise, const char *progress_name)
{
    bool shows = progress_name && isatty(STDERR_FILENO), has_shown = false, ok = true;
    double begun = cli_wall_seconds(), shown = begun;
    while (ok && fl_noise_rounds(noise) < FL_NOISE_ROUNDS &&
           !(cli_was_interrupted() && fl_noise_rounds(noise) > 0)) {
        ok = fl_noise_step(noise);
        double now = cli_wall_seconds();
        if (!shows || now - begun < 1.0 || now - shown < 0.1)
            continue;
        show_progress(progress_name, noise, now - begun);
        has_shown = true;
        shown = now;
    }
    if (has_shown)
        fputc('\n', stderr);
    return ok;
}

bool cli_noise_measure(fl_compiled *scene, const fl_params *params, const char *progress_name,
                       fl_noise_split *out, fl_diags *diags)
{
    *out = (fl_noise_split){0};
    fl_noise *noise = fl_noise_create(scene, params, FL_NOISE_SAMPLES, diags);
    if (!noise)
        return false;
    bool ok = run_rounds(noise, progress_name);
    if (!ok)
        fl_out_of_memory(diags, "the noise measurement");
    fl_noise_read(noise, out);
    fl_noise_destroy(noise);
    return ok;
}

bool cli_noise_choose_light_samples(fl_compiled *scene, fl_params *params, fl_diags *diags)
{
    fl_noise_split split;
    if (!cli_noise_measure(scene, params, NULL, &split, diags))
        return false;
    if (split.light_samples > 0.0)
        params->light_samples = (uint32_t)split.light_samples_best;
    return true;
}

json_t *cli_noise_json(const fl_noise_split *split)
{
    static const char *const kinds[] = {[FL_NOISE_PIXEL] = "pixel",
                                        [FL_NOISE_LENS] = "lens",
                                        [FL_NOISE_DEEPER] = "deeper",
                                        [FL_NOISE_LIGHT] = "light"};
    json_t *sources = json_array();
    for (uint32_t i = 0; i < split->source_count; i++) {
        const fl_noise_source *s = &split->sources[i];
        json_t *source =
            json_pack("{s:s, s:f, s:f, s:f, s:f}", "source", kinds[s->kind], "share", s->share,
                      "share_error", s->share_error, "alone", s->alone, "held", s->held);
        if (s->kind == FL_NOISE_LIGHT)
            json_object_set_new(source, "light", json_integer(s->light));
        json_array_append_new(sources, source);
    }
    char advice[FL_NOISE_ADVICE_BYTES];
    fl_noise_advice(split, advice);
    return json_pack("{s:i, s:I, s:f, s:f, s:o, s:f, s:f, s:f, s:f, s:f, s:f, s:s}", "samples",
                     (int)split->samples, "pixels", (json_int_t)split->pixels, "variance",
                     split->variance, "joint", split->joint, "sources", sources, "path_seconds",
                     split->path_seconds, "shadow_seconds", split->shadow_seconds,
                     "shadows_per_path", split->shadows_per_path, "light_samples",
                     split->light_samples, "light_samples_best", split->light_samples_best,
                     "light_samples_gain", split->light_samples_gain, "advice", advice);
}

void cli_noise_print(const fl_noise_split *split, const char *indent)
{
    char advice[FL_NOISE_ADVICE_BYTES];
    fl_noise_advice(split, advice);
    printf("%snoise     %s\n", indent, advice);
    for (uint32_t i = 0; i < split->source_count; i++) {
        const fl_noise_source *s = &split->sources[i];
        char name[FL_NOISE_NAME_BYTES];
        fl_noise_source_name(s, name);
        printf("%s          %-22s %5.1f %% +- %.1f; alone %.1f %%, without it %.1f %%\n", indent,
               name, 100.0 * s->share, 100.0 * s->share_error, 100.0 * s->alone, 100.0 * s->held);
    }
    printf("%s          joint %.1f %%; error at %u samples about %.5f; a path costs %.0f ns",
           indent, 100.0 * split->joint, split->samples, fl_noise_rmse(split),
           1e9 * split->path_seconds);
    if (split->light_samples > 0.0)
        printf(", a shadow ray %.0f ns; best light samples %.0f (now %.3g)",
               1e9 * split->shadow_seconds, split->light_samples_best, split->light_samples);
    putchar('\n');
}
