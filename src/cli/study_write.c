/* SPDX-License-Identifier: MIT */
#include "cli/study_write.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/json_text.h"
#include "cli/picture.h"
#include "io/files.h"
#include "io/image_file.h"

bool study_save_text(const char *dir, const char *name,
                     void (*fill)(FILE *file, const void *context), const void *context,
                     fl_diags *diags)
{
    char path[4096 + 64];
    if (snprintf(path, sizeof path, "%s/%s", dir, name) >= (int)sizeof path)
        return fl_environment_error(diags, "the path '%s/%s' is too long", dir, name);
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    if (!file)
        return fl_out_of_memory(diags, name);
    fill(file, context);
    bool ok = fclose(file) == 0;
    ok = ok ? fl_file_save(path, text, bytes, diags) : fl_out_of_memory(diags, name);
    free(text);
    return ok;
}

/* --- CSV -------------------------------------------------------------------------------------- */

static void csv_row(FILE *file, const study_config *config, uint32_t round, uint32_t samples,
                    const study_measure *m)
{
    const fl_counts *c = &m->counts;
    fprintf(file, "%s,%s,%u,%u,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu,", config->name,
            study_knob_names[config->knob], round + 1, samples, (unsigned long long)c->camera_rays,
            (unsigned long long)c->shadow_rays, (unsigned long long)c->reflect_rays,
            (unsigned long long)c->refract_rays, (unsigned long long)c->isect.node_visits,
            (unsigned long long)c->isect.primitive_tests, (unsigned long long)c->invalid_samples,
            (unsigned long long)c->dropped_branches);
    if (config->is_biased)
        fputc(',', file);
    else
        fprintf(file, "%.9g,", m->noise.mse);
    fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,", m->error.mse, m->error.relative_mse,
            m->error.bias, m->error.largest, m->error.p999, m->flip);
    if (m->predicted.is_known)
        fprintf(file, "%.9g,%.9g,%.9g,", m->predicted.rmse, m->predicted.low, m->predicted.high);
    else
        fputs(",,,", file);
    fprintf(file, "%.6f,%.6f,", m->cpu_s, m->wall_s);
    if (m->load >= 0.0)
        fprintf(file, "%.2f", m->load);
    fputc('\n', file);
}

/* Times stand last: all else is the same in every run. */
static void fill_csv(FILE *file, const void *context)
{
    const study *s = ((const study_report *)context)->s;
    fputs("config,knob,repeat,samples,camera_rays,shadow_rays,reflect_rays,refract_rays,"
          "node_visits,primitive_tests,invalid_samples,dropped_branches,noise_mse,error_mse,"
          "relative_mse,bias,max_error,p999_error,flip,predicted_rmse,predicted_low,predicted_high,"
          "cpu_s,wall_s,load\n",
          file);
    for (uint32_t round = 0; round < s->settings.repeats; round++)
        for (uint32_t i = 0; i < s->plan.count; i++)
            for (uint32_t level = 0; level < study_levels_of(&s->plan.configs[i]); level++) {
                const study_measure *m = study_at(s, i, round, level);
                if (m->is_there)
                    csv_row(file, &s->plan.configs[i], round, 1u << level, m);
            }
}

/* --- JSON ------------------------------------------------------------------------------------- */

static json_t *real_or_null(bool is_known, double value)
{
    return is_known && fabs(value) <= 1e300 ? json_real(value) : json_null();
}

static json_t *json_ratio(const study_ratio *r)
{
    if (!r->is_known)
        return json_null();
    return json_pack("{s:f, s:o, s:o, s:b}", "value", r->value, "low",
                     real_or_null(r->has_interval, r->low), "high",
                     real_or_null(r->has_interval, r->high), "significant", (int)r->is_significant);
}

static json_t *json_times(const study_spread *t)
{
    return json_pack("{s:f, s:f, s:f, s:f}", "median", t->median, "min", t->lowest, "q1",
                     t->quartile1, "q3", t->quartile3);
}

static json_t *json_counts(const fl_counts *c)
{
    return json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "camera", (json_int_t)c->camera_rays, "shadow",
        (json_int_t)c->shadow_rays, "reflect", (json_int_t)c->reflect_rays, "refract",
        (json_int_t)c->refract_rays, "node_visits", (json_int_t)c->isect.node_visits,
        "primitive_tests", (json_int_t)c->isect.primitive_tests, "invalid_samples",
        (json_int_t)c->invalid_samples, "dropped_branches", (json_int_t)c->dropped_branches);
}

static json_t *json_cell(const study_cell *cell, bool is_biased, bool is_base)
{
    json_t *row = json_pack(
        "{s:i, s:i, s:o, s:{s:f, s:f}, s:f, s:f, s:f, s:f, s:f, s:{s:f, s:f}, s:o, s:o, s:o, s:o}",
        "samples", (int)cell->samples, "rounds", (int)cell->rounds, "counts",
        json_counts(&cell->counts), "error", "rmse", cell->error.value, "se",
        cell->error.standard_error, "relative_rmse", cell->relative.value, "bias", cell->bias.mean,
        "bias_se", cell->bias_se, "max", cell->largest.median, "p999", cell->p999.median, "flip",
        "mean", cell->flip.mean, "se", cell->flip.standard_error, "predicted",
        real_or_null(cell->predicted > 0.0, cell->predicted), "predicted_ratio",
        real_or_null(cell->predicted_ratio > 0.0, cell->predicted_ratio), "cpu_s",
        json_times(&cell->cpu_s), "wall_s", json_times(&cell->wall_s));
    json_object_set_new(row, "noise",
                        is_biased ? json_null()
                                  : json_pack("{s:f, s:f}", "rmse", cell->noise.value, "se",
                                              cell->noise.standard_error));
    if (!is_base)
        json_object_set_new(row, "to_baseline",
                            json_pack("{s:o, s:o, s:o}", "cpu", json_ratio(&cell->cpu_ratio),
                                      "rmse", json_ratio(&cell->rmse_ratio), "mse_times_cpu",
                                      json_ratio(&cell->work_ratio)));
    return row;
}

static json_t *json_config(const study *s, const study_table *table, uint32_t index)
{
    const study_config *config = &s->plan.configs[index];
    const study_column *column = &table->columns[index];
    json_t *cells = json_array();
    for (uint32_t level = 0; level < study_levels_of(config); level++)
        if (column->cells[level].rounds)
            json_array_append_new(cells,
                                  json_cell(&column->cells[level], config->is_biased, index == 0));
    return json_pack("{s:s, s:s, s:b, s:f, s:{s:o, s:o}, s:o, s:o, s:o, s:o}", "name", config->name,
                     "knob", study_knob_names[config->knob], "biased", (int)config->is_biased,
                     "build_s", config->compiled->build_seconds, "fit", "floor",
                     real_or_null(column->fit.is_known && config->is_biased, column->fit.floor),
                     "rate", real_or_null(column->fit.is_known, column->fit.rate), "floor",
                     real_or_null(!isnan(column->floor), column->floor), "apart",
                     real_or_null(!isnan(column->apart), column->apart), "slope",
                     real_or_null(!isnan(column->slope), column->slope), "points", cells);
}

static json_t *json_reference(const study_reference *r)
{
    return json_pack("{s:i, s:f, s:o, s:I}", "samples", (int)r->samples, "rmse", r->rmse,
                     "share_of_best",
                     real_or_null(r->best > 0.0 && !isinf(r->best), r->rmse / r->best),
                     "dropped_branches", (json_int_t)r->dropped_branches);
}

/* "model name : ...": what a processor calls itself; "": not said. */
static void processor_name(char *out, size_t bytes)
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    out[0] = 0;
    while (file && !out[0] && fgets(line, sizeof line, file))
        if (strncmp(line, "model name", 10) == 0 && strchr(line, ':'))
            snprintf(out, bytes, "%.*s", (int)strcspn(strchr(line, ':') + 2, "\n"),
                     strchr(line, ':') + 2);
    if (file)
        fclose(file);
}

/* Where the times come from. */
static json_t *json_machine(const study *s)
{
    char processor[128];
    double load = study_load_average();
    processor_name(processor, sizeof processor);
    return json_pack(
        "{s:o, s:i, s:i, s:s, s:s, s:s, s:s, s:o, s:o}", "processor", cli_json_text(processor),
        "processors", (int)sysconf(_SC_NPROCESSORS_ONLN), "threads", (int)s->settings.threads,
        "isa", fl_isa_name(s->scene->compiled->isa), "compiler", __VERSION__, "flags",
        FL_BUILD_FLAGS, "commit", cli_commit, "load_begin", real_or_null(s->load >= 0.0, s->load),
        "load_end", real_or_null(load >= 0.0, load));
}

json_t *study_json(const study_report *report)
{
    const study *s = report->s;
    json_t *configs = json_array(), *front = json_array(), *sentences = json_array();
    for (uint32_t i = 0; i < s->plan.count; i++)
        json_array_append_new(configs, json_config(s, report->table, i));
    for (uint32_t i = 0; i < report->table->front_count; i++) {
        study_place place = report->table->front[i];
        const study_cell *cell = study_cell_at(report->table, place);
        json_array_append_new(front, json_pack("{s:s, s:i, s:f, s:f}", "config",
                                               s->plan.configs[place.config].name, "samples",
                                               (int)(1u << place.level), "cpu_s",
                                               cell->cpu_s.median, "rmse", cell->error.value));
    }
    double targets[8];
    char summary[STUDY_SENTENCE_BYTES];
    study_summary(s, report->table, summary, sizeof summary);
    uint32_t count = study_targets(report->table, report->wanted_rmse, targets);
    for (uint32_t i = 0; i < count; i++) {
        char sentence[STUDY_SENTENCE_BYTES];
        study_sentence(s, report->table, targets[i], sentence, sizeof sentence);
        json_array_append_new(sentences, json_string(sentence));
    }
    return json_pack("{s:o, s:o, s:i, s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:f, s:b, s:b, s:f, s:o, "
                     "s:o, s:s, s:o}",
                     "command", cli_json_text(report->command), "scene",
                     cli_json_text(s->scene->path), "width", (int)s->width, "height",
                     (int)s->height, "samples_max", (int)s->settings.samples_max, "rounds",
                     (int)s->rounds, "repeats", (int)s->settings.repeats, "machine",
                     json_machine(s), "reference", json_reference(&s->own), "deep_reference",
                     s->has_deep ? json_reference(&s->deep) : json_null(), "truncation_rmse",
                     s->truncation_rmse, "interrupted", (int)s->was_interrupted, "out_of_budget",
                     (int)s->ran_out_of_budget, "seconds", s->seconds, "configs", configs,
                     "pareto_front", front, "summary", summary, "sentences", sentences);
}

static void fill_json(FILE *file, const void *context)
{
    json_dumpf(context, file, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    fputc('\n', file);
}

/* --- Pictures --------------------------------------------------------------------------------- */

static bool save_thumbnail(const study_report *report, const char *name, float *rgb,
                           fl_diags *diags)
{
    const study *s = report->s;
    cli_picture picture = {.width = s->width, .height = s->height, .rgb = rgb};
    uint8_t *bytes = cli_picture_bytes(&picture, &s->scene->params, diags);
    char path[4096 + 64];
    snprintf(path, sizeof path, "%s/%s.png", report->dir, name);
    fl_image image = {
        .width = s->width, .height = s->height, .format = FL_PIXEL_SRGB8, .pixels = bytes};
    bool ok = bytes && fl_image_save(path, &image, NULL, 0, diags);
    free(bytes);
    return ok;
}

static bool write_thumbnails(const study_report *report, fl_diags *diags)
{
    const study *s = report->s;
    const study_reference *truth = study_truth(s);
    bool ok = !truth->samples || save_thumbnail(report, "reference", truth->rgb[0], diags);
    for (uint32_t i = 0; ok && i < s->plan.count; i++) {
        char name[32];
        snprintf(name, sizeof name, "config-%u", i);
        for (size_t k = 0; s->pictures[i].rgb && k < (size_t)3 * s->width * s->height; k++)
            s->scratch[0][k] = s->pictures[i].rgb[k] / (float)s->pictures[i].count;
        if (s->pictures[i].rgb)
            ok = save_thumbnail(report, name, s->scratch[0], diags);
    }
    return ok;
}

bool study_write(study_report *report, fl_diags *diags)
{
    json_t *json = study_json(report);
    bool ok = study_save_text(report->dir, "study.csv", fill_csv, report, diags);
    ok = (json ? study_save_text(report->dir, "study.json", fill_json, json, diags)
               : fl_out_of_memory(diags, "study.json")) &&
         ok;
    json_decref(json);
    ok = write_thumbnails(report, diags) && ok;
    ok = study_write_plots(report, diags) && ok;
    return study_write_page(report, diags) && ok;
}
