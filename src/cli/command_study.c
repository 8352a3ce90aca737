/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/places.h"
#include "cli/study_extremes.h"
#include "cli/study_write.h"

enum { SIDE_DEFAULT = 128, SAMPLES_DEFAULT = 64, REPEATS_DEFAULT = 4 };

/* A study renders every setting many times: unless a size is asked for, the scene's is shrunk. */
static void shrink(fl_params *params)
{
    uint32_t longer = fl_max_u32(params->width, params->height);
    if (longer <= SIDE_DEFAULT)
        return;
    params->width = fl_max_u32(1, params->width * SIDE_DEFAULT / longer);
    params->height = fl_max_u32(1, params->height * SIDE_DEFAULT / longer);
    cli_drop_crop(params);
}

static uint32_t power_of_two_below(uint32_t x)
{
    uint32_t power = 1;
    while (power <= x / 2)
        power *= 2;
    return power;
}

/* The words that repeat this study, for the files: what was not asked for, too, where it has a
 * default of its own. */
static void write_command(const cli_options *o, uint32_t samples, uint32_t repeats, FILE *file)
{
    cli_options all = *o;
    all.samples = samples;
    all.repeats = repeats;
    all.given |= (uint64_t)1 << CLI_OPT_SAMPLES | (uint64_t)1 << CLI_OPT_REPEATS;
    fputs("firstlight study ", file);
    cli_word_print(o->paths[0], file);
    cli_options_print(&all, file);
}

static void print_summary(const study_report *report)
{
    const study *s = report->s;
    double targets[8];
    uint32_t count = study_targets(report->table, report->wanted_rmse, targets);
    char sentence[STUDY_SENTENCE_BYTES];
    study_summary(s, report->table, sentence, sizeof sentence);
    puts(sentence);
    for (uint32_t i = 0; i < count; i++) {
        study_sentence(s, report->table, targets[i], sentence, sizeof sentence);
        puts(sentence);
    }
    const study_reference *truth = study_truth(s);
    printf("%u settings, %u complete rounds, %.0f s; reference RMSE %.2g%s; written to %s\n",
           s->plan.count, s->rounds, s->seconds, truth->rmse,
           truth->rmse <= 0.1 * truth->best ? "" : " (not down to a tenth of the best measured)",
           report->dir);
}

static bool report(const cli_options *o, cli_scene *scene, const study *s, const study_table *table,
                   const char *command)
{
    study_report out = {
        .s = s, .table = table, .dir = o->out_dir, .command = command, .wanted_rmse = o->noise};
    if (!study_write(&out, scene->diags))
        return false;
    json_t *json = cli_has(o, CLI_OPT_JSON) ? study_json(&out) : NULL;
    if (json) {
        json_dumpf(json, stdout, JSON_COMPACT | JSON_REAL_PRECISION(9));
        putchar('\n');
    } else if (!cli_has(o, CLI_OPT_QUIET)) {
        print_summary(&out);
    }
    json_decref(json);
    return true;
}

static bool run(const cli_options *o, cli_scene *scene, uint32_t knobs, study *s)
{
    uint32_t samples = cli_has(o, CLI_OPT_SAMPLES) ? o->samples : SAMPLES_DEFAULT;
    study_settings settings = {
        .samples_max = power_of_two_below(fl_min_u32(samples, 1u << (STUDY_LEVELS_MAX - 1))),
        .repeats = cli_has(o, CLI_OPT_REPEATS) ? o->repeats : REPEATS_DEFAULT,
        .threads = o->threads,
        .budget_s = o->budget_s,
        .shows_progress = !cli_has(o, CLI_OPT_QUIET),
        .should_stop = cli_was_interrupted};
    if (!study_run(scene, &settings, knobs, s))
        return false;
    char *command = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&command, &bytes);
    study_table *table = study_table_create(s);
    bool ok = file != NULL;
    if (file) {
        write_command(o, settings.samples_max, settings.repeats, file);
        ok = fclose(file) == 0;
    }
    ok = ok && table ? report(o, scene, s, table, command)
                     : fl_out_of_memory(scene->diags, "the table");
    free(command);
    free(table);
    return ok;
}

static int unknown_knob(const char *word)
{
    char names[STUDY_KNOB_COUNT * STUDY_NAME_BYTES] = "";
    for (uint32_t i = STUDY_BASELINE + 1; i < STUDY_KNOB_COUNT; i++) {
        strcat(names, i > STUDY_BASELINE + 1 ? ", " : "");
        strcat(names, study_knob_names[i]);
    }
    return cli_usage_error(CLI_STUDY, "unknown knob '%s' in --sweep; there are %s", word, names);
}

int cli_command_study(const cli_options *options)
{
    if (cli_has(options, CLI_OPT_EXTREMES) && options->path_count)
        return cli_usage_error(CLI_STUDY,
                               "--extremes makes its own scenes: '%s' means nothing to it",
                               options->paths[0]);
    if (cli_has(options, CLI_OPT_EXTREMES))
        return study_extremes(options);
    if (options->path_count != 1)
        return cli_usage_error(CLI_STUDY, "expected one scene, got %u", options->path_count);
    if (!options->out_dir)
        return cli_usage_error(CLI_STUDY, "nowhere to write: give --out DIR");
    uint32_t knobs = ~0u;
    char word[STUDY_NAME_BYTES];
    if (options->sweep && !study_knobs_parse(options->sweep, &knobs, word))
        return unknown_knob(word);
    cli_catch_signals();
    fl_diags diags = {0};
    cli_scene scene = {.diags = &diags};
    study s = {0};
    if (cli_scene_open(options, options->paths[0], &scene) &&
        cli_folder_open(options->out_dir, &diags)) {
        if (!cli_has(options, CLI_OPT_SIZE))
            shrink(&scene.params);
        run(options, &scene, knobs, &s);
    }
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    if (code == CLI_DONE && s.was_interrupted)
        code = CLI_INTERRUPTED;
    study_close(&s);
    cli_scene_close(&scene);
    fl_diags_deinit(&diags);
    return code;
}
