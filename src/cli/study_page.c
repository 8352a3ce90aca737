/* SPDX-License-Identifier: MIT
 *
 * One page that stands alone: plots and pictures are inside it. What to do first, then what each
 * knob costs and buys, then every figure.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/study_write.h"
#include "io/files.h"

enum { LARGEST_PART = 16 << 20 };

/* Text of the user's as HTML. */
static void print_escaped(FILE *file, const char *text)
{
    for (; *text; text++)
        switch (*text) {
        case '<':
            fputs("&lt;", file);
            break;
        case '&':
            fputs("&amp;", file);
            break;
        default:
            fputc(*text, file);
        }
}

static void print_base64(FILE *file, const uint8_t *bytes, size_t count)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < count; i += 3) {
        size_t have = count - i < 3 ? count - i : 3;
        uint32_t word = (uint32_t)bytes[i] << 16;
        for (size_t k = 1; k < have; k++)
            word |= (uint32_t)bytes[i + k] << (16 - 8 * k);
        for (size_t k = 0; k < 4; k++)
            fputc(k <= have ? digits[word >> (18 - 6 * k) & 63] : '=', file);
    }
}

/* The picture DIR/NAME inside the page; nothing where it is missing. */
static void print_picture(FILE *file, const study_report *report, const char *name,
                          const char *type, const char *alt)
{
    char path[4096 + 64];
    fl_diags ignored = {0};
    size_t bytes = 0;
    snprintf(path, sizeof path, "%s/%s", report->dir, name);
    char *data = fl_file_load(path, "picture", LARGEST_PART, (fl_loc){0}, &ignored, &bytes);
    if (data) {
        fprintf(file, "<img alt='%s' src='data:image/%s;base64,", alt, type);
        print_base64(file, (const uint8_t *)data, bytes);
        fputs("'>", file);
    }
    free(data);
    fl_diags_deinit(&ignored);
}

/* --- Numbers ---------------------------------------------------------------------------------- */

/* With as many digits as its standard error leaves standing. */
static void print_error(FILE *file, const char *tag, double value, double se)
{
    int decimals = se > 0.0 ? (int)fl_clamp(ceil(-log10(se)), 0.0, 12.0) : -1;
    if (decimals < 0)
        fprintf(file, "%s%.3g", tag, value);
    else
        fprintf(file, "%s%.*f<small> ±%.*f</small>", tag, decimals, value, decimals, se);
}

static void print_ratio(FILE *file, const study_ratio *r)
{
    if (!r->is_known)
        fputs("<td class=weak>&ndash;", file);
    else if (!r->has_interval)
        fprintf(file, "<td>%.3g ×", r->value);
    else
        fprintf(file, "<td%s>%.3g ×<small> %.3g to %.3g%s</small>",
                r->is_significant ? "" : " class=weak", r->value, r->low, r->high,
                r->is_significant ? "" : ", n.s.");
}

static void print_number(FILE *file, double value)
{
    if (isnan(value))
        fputs("<td class=weak>&ndash;", file);
    else
        fprintf(file, "<td>%.2g", value);
}

/* --- The top ---------------------------------------------------------------------------------- */

static void print_head(FILE *file, const study_report *report)
{
    const study *s = report->s;
    fputs("<!doctype html><html lang=en><meta charset=utf-8>"
          "<meta name=viewport content='width=device-width'><title>Study of ",
          file);
    print_escaped(file, s->scene->path);
    fputs("</title>\n<style>body{font:16px/1.5 sans-serif;margin:2em auto;max-width:60em;"
          "padding:0 1em;color:#1a1a1a}h2{margin-top:2em}.answer{font-size:1.25em;"
          "border-left:4px solid #d62839;padding-left:.8em}"
          "table{border-collapse:collapse;font-size:14px}td,th{padding:.2em .7em;"
          "text-align:right;border-bottom:1px solid #ddd;white-space:nowrap}"
          "th{vertical-align:bottom;white-space:normal}"
          "td:first-child,th:first-child{text-align:left}tr.base td{font-weight:bold}"
          "tr.first td{border-top:2px solid #888}small{color:#777;font-weight:normal}"
          ".weak,.weak small{color:#aaa}.wide{overflow-x:auto}img{max-width:100%}"
          "figure{display:inline-block;margin:0 .7em .7em 0;vertical-align:top;width:150px}"
          "figure img{width:150px;image-rendering:pixelated;display:block}"
          "figcaption{font-size:12px;line-height:1.3}</style>\n<h1>Study of ",
          file);
    print_escaped(file, s->scene->path);
    fputs("</h1>\n", file);
    char sentence[STUDY_SENTENCE_BYTES];
    study_summary(s, report->table, sentence, sizeof sentence);
    fputs("<p class=answer>", file);
    print_escaped(file, sentence);
    fputs("</p>\n", file);
    if (s->was_interrupted)
        fputs("<p><b>Interrupted: this is what was measured by then.</b></p>\n", file);
    if (s->ran_out_of_budget)
        fputs("<p><b>The budget ran out before all rounds were done.</b></p>\n", file);
}

static void print_targets(FILE *file, const study_report *report)
{
    double targets[8];
    uint32_t count = study_targets(report->table, report->wanted_rmse, targets);
    if (!count)
        return;
    fputs("<table><tr><th>for an RMSE of at most<th>the cheapest setting is<th>RMSE<th>mean FLIP"
          "<th>CPU s<th>million rays\n",
          file);
    for (uint32_t i = 0; i < count; i++) {
        study_place place;
        char name[96];
        if (!study_cheapest(report->table, targets[i], &place))
            continue;
        const study_cell *cell = study_cell_at(report->table, place);
        study_place_name(report->s, place, name, sizeof name);
        fprintf(file, "<tr><td>%g<td style='text-align:left'>%s", targets[i], name);
        print_error(file, "<td>", cell->error.value, cell->error.standard_error);
        fprintf(file, "<td>%.2g<td>%.2g<td>%.3g\n", cell->flip.mean, cell->cpu_s.median,
                (double)study_rays(&cell->counts) * 1e-6);
    }
    fputs("</table>\n", file);
}

/* A plot under its heading, if it was made: one without curves is not. */
static void print_plot(FILE *file, const study_report *report, const char *heading,
                       const char *name, const char *alt)
{
    char svg[STUDY_NAME_BYTES + 16], path[4096 + 64];
    snprintf(svg, sizeof svg, "%s.svg", name);
    snprintf(path, sizeof path, "%s/%s", report->dir, svg);
    if (!report->has_plots || access(path, R_OK) != 0)
        return;
    if (heading)
        fprintf(file, "<h2>%s</h2>\n", heading);
    fputs("<p>", file);
    print_picture(file, report, svg, "svg+xml", alt);
    fputs("</p>\n", file);
}

/* --- Knobs ------------------------------------------------------------------------------------ */

static const char *const knob_words[STUDY_KNOB_COUNT] = {
    [STUDY_SAMPLER] = "Where samples lie. Judge by RMSE and by MSE × CPU.",
    [STUDY_LIGHT_SAMPLES] = "Shadow rays a disk light and hit.",
    [STUDY_DEPTH] = "Bounces. What is cut off is missing for good: the floor.",
    [STUDY_WEIGHT] = "Branches that weigh less end. What they would have brought is the floor.",
    [STUDY_SCALE] = "A smaller picture, enlarged to compare. What it cannot show is the floor.",
    [STUDY_ACCEL] = "How triangles are found: the same picture, only the price differs.",
    [STUDY_SOLVER] = "How rays meet surfaces of revolution. Hits that Newton misses are the floor.",
    [STUDY_ADAPTIVE] = "Samples where the noise is; the number is the mean of all pixels.",
    [STUDY_PRECISION] = "Numbers that rays are traced in. The error of floats is the floor."};

/* The last cell of a column that was measured; NULL: none. */
static const study_cell *last_cell(const study_report *report, uint32_t index)
{
    const study_column *column = &report->table->columns[index];
    uint32_t level = study_levels_of(&report->s->plan.configs[index]) - 1;
    while (level && !column->cells[level].rounds)
        level--;
    return column->cells[level].rounds ? &column->cells[level] : NULL;
}

static void print_knob_row(FILE *file, const study_report *report, study_knob knob, uint32_t index)
{
    const study_config *config = &report->s->plan.configs[index];
    const study_column *column = &report->table->columns[index];
    const study_cell *cell = last_cell(report, index);
    if (!cell)
        return;
    char own[STUDY_NAME_BYTES + 16];
    study_own_name(&report->s->plan, knob, own, sizeof own);
    fprintf(file, "<tr%s><td>%s<td>%u", index ? "" : " class=base", index ? config->name : own,
            cell->samples);
    print_error(file, "<td>", cell->error.value, cell->error.standard_error);
    fprintf(file, "<td>%.2g<td>%.2g", cell->flip.mean, cell->cpu_s.median);
    print_ratio(file, &cell->cpu_ratio);
    print_ratio(file, &cell->rmse_ratio);
    print_ratio(file, &cell->work_ratio);
    if (config->is_biased)
        print_number(file, column->floor);
    else
        fputs("<td class=weak>&ndash;", file);
    fputc('\n', file);
}

static void print_knob(FILE *file, const study_report *report, study_knob knob)
{
    const study *s = report->s;
    uint32_t first = 1;
    while (first < s->plan.count &&
           (s->plan.configs[first].knob != knob || !last_cell(report, first)))
        first++;
    if (first == s->plan.count)
        return;
    char plot[STUDY_NAME_BYTES + 8];
    snprintf(plot, sizeof plot, "knob-%s", study_knob_names[knob]);
    fprintf(file, "<h3>%s</h3>\n<p>%s</p>\n", study_knob_names[knob],
            knob_words[knob] ? knob_words[knob] : "");
    fputs("<div class=wide><table><tr><th>setting<th>samples<th>RMSE<th>mean FLIP<th>CPU s"
          "<th>CPU time, ratio<th>RMSE, ratio<th>MSE × CPU, ratio<th>floor\n",
          file);
    print_knob_row(file, report, knob, 0);
    for (uint32_t i = first; i < s->plan.count; i++)
        if (s->plan.configs[i].knob == knob)
            print_knob_row(file, report, knob, i);
    fputs("</table></div>\n", file);
    print_plot(file, report, NULL, plot, study_knob_names[knob]);
}

/* --- All figures ------------------------------------------------------------------------------ */

static void print_row(FILE *file, const study_report *report, uint32_t index)
{
    const study_config *config = &report->s->plan.configs[index];
    const study_column *column = &report->table->columns[index];
    const study_cell *cell = last_cell(report, index);
    if (!cell)
        return;
    const fl_counts *n = &cell->counts;
    fprintf(file, "<tr><td>%s<td>%u", config->name, cell->samples);
    if (config->is_biased)
        fputs("<td class=weak>&ndash;", file);
    else
        print_error(file, "<td>", cell->noise.value, cell->noise.standard_error);
    print_error(file, "<td>", cell->bias.mean, cell->bias_se);
    fprintf(file, "<td>%.3g<td>%.3g<td>%.3g", cell->relative.value, cell->p999.median,
            cell->largest.median);
    if (cell->predicted_ratio > 0.0)
        fprintf(file, "<td>%.2f", cell->predicted_ratio);
    else
        fputs("<td class=weak>&ndash;", file);
    fprintf(file, "<td>%.3g", cell->wall_s.median);
    const uint64_t counts[] = {n->camera_rays,  n->shadow_rays,       n->reflect_rays,
                               n->refract_rays, n->isect.node_visits, n->isect.primitive_tests};
    for (size_t i = 0; i < FL_COUNT_OF(counts); i++)
        fprintf(file, "<td>%.3g", (double)counts[i] * 1e-6);
    fprintf(file, "<td>%llu", (unsigned long long)n->invalid_samples);
    print_number(file, config->is_biased && column->fit.is_known ? column->fit.floor : (double)NAN);
    print_number(file, column->fit.is_known ? column->fit.rate : (double)NAN);
    fputc('\n', file);
}

static void print_table(FILE *file, const study_report *report)
{
    fputs("<h2>Every figure</h2>\n<div class=wide><table><tr><th>setting<th>samples<th>noise"
          "<th>bias<th>relative RMSE<th>99.9 % below<th>largest error<th>predicted / true"
          "<th>wall s<th>camera rays, M<th>shadow<th>reflected<th>refracted<th>node visits, M"
          "<th>tests, M<th>invalid samples<th>floor by fit<th>rate\n",
          file);
    for (uint32_t i = 0; i < report->s->plan.count; i++)
        print_row(file, report, i);
    fputs("</table></div>\n"
          "<p>Noise: RMSE against what the same setting converges to. Bias: mean of the signed "
          "error. Relative: over reference² + 0.01. Floor by fit: RMSE² = floor² + "
          "(c n<sup>&minus;rate</sup>)², with the rate of the scene as asked for.</p>\n",
          file);
}

static void print_thumbnails(FILE *file, const study_report *report)
{
    const study *s = report->s;
    fprintf(file,
            "<h2>Pictures</h2>\n<p>Means of %u rounds: little noise is left in them, and what the "
            "settings leave out shows. RMSE and FLIP are of one round.</p>\n",
            fl_max_u32(1, s->rounds));
    if (study_truth(s)->samples) {
        fputs("<figure>", file);
        print_picture(file, report, "reference.png", "png", "reference");
        fputs("<figcaption>the truth</figcaption></figure>\n", file);
    }
    for (uint32_t i = 0; i < s->plan.count; i++) {
        char name[32];
        const study_cell *cell = last_cell(report, i);
        if (!s->pictures[i].rgb || !cell)
            continue;
        snprintf(name, sizeof name, "config-%u.png", i);
        fputs("<figure>", file);
        print_picture(file, report, name, "png", s->plan.configs[i].name);
        fprintf(file, "<figcaption>%s, %u samples<br>RMSE %.2g, FLIP %.2g</figcaption></figure>\n",
                s->plan.configs[i].name, cell->samples, cell->error.value, cell->flip.mean);
    }
}

/* --- How -------------------------------------------------------------------------------------- */

static void print_reference(FILE *file, const char *name, const study_reference *r)
{
    fprintf(file,
            "<li>%s: two independent pictures of %u samples by different samplers; RMSE of "
            "their mean %.2g",
            name, r->samples, r->rmse);
    if (!isinf(r->best) && r->best > 0.0)
        fprintf(file, ", %.2f of the best measured%s", r->rmse / r->best,
                study_reference_is_good(r) ? "" : " (above the aim of 0.1: limit or budget)");
    fputs(".</li>\n", file);
}

static void print_method(FILE *file, const study_report *report)
{
    const study *s = report->s;
    fputs("<h2>How this was measured</h2>\n<p><code>", file);
    print_escaped(file, report->command);
    fprintf(file,
            "</code></p>\n<p>%ux%u pixels, %u complete rounds after a warm-up, %.0f s in all. "
            "All settings take turns within a round and share its seed; rounds have "
            "different ones. Ratios are to the scene as asked for at the same number of "
            "samples, with 95 %% intervals over the rounds; n.s.: not significant, the "
            "interval contains 1. Errors are products against two references, whose own "
            "noise cancels. CPU times are medians.</p>\n<ul>\n",
            s->width, s->height, s->rounds, s->seconds);
    print_reference(file, "Reference of the scene as asked for", &s->own);
    if (s->has_deep) {
        print_reference(file, "The truth, with more bounces and a lower threshold", &s->deep);
        fprintf(file,
                "<li>Between the two, RMSE %.2g: what the scene's bounces and threshold leave "
                "out.</li>\n",
                s->truncation_rmse);
    }
    fputs("</ul>\n<p>Every picture's figures: study.csv; these tables and the machine: study.json; "
          "the plots' source: study.gp.</p>\n</html>\n",
          file);
}

static void fill_page(FILE *file, const void *context)
{
    const study_report *report = context;
    print_head(file, report);
    print_targets(file, report);
    print_plot(file, report, NULL, "error-cpu", "error against CPU time");
    fputs("<h2>What each knob costs and buys</h2>\n", file);
    for (study_knob knob = STUDY_BASELINE + 1; knob < STUDY_KNOB_COUNT; knob++)
        print_knob(file, report, knob);
    print_plot(file, report, "Noise against samples", "noise-samples", "noise against samples");
    print_plot(file, report, "How far predictions are to be trusted", "predicted",
               "predicted over true error");
    print_thumbnails(file, report);
    print_table(file, report);
    print_method(file, report);
}

bool study_write_page(const study_report *report, fl_diags *diags)
{
    return study_save_text(report->dir, "index.html", fill_page, report, diags);
}
