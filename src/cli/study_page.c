/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "cli/study_write.h"

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

static void print_head(FILE *file, const study_report *report)
{
    const study *s = report->s;
    fputs("<!doctype html><html lang=en><meta charset=utf-8><title>firstlight study</title>\n"
          "<style>body{font:15px/1.5 sans-serif;margin:2em;max-width:75em}"
          "table{border-collapse:collapse;font-size:13px}td,th{padding:.15em .6em;"
          "text-align:right;border-bottom:1px solid #ddd}td:first-child,th:first-child{text-align:"
          "left}.weak{color:#999}figure{display:inline-block;margin:0 .5em .5em 0}"
          "figure img{width:160px;image-rendering:pixelated;display:block}"
          "figcaption{font-size:12px}</style>\n<h1>Study of ",
          file);
    print_escaped(file, s->scene->path);
    fputs("</h1>\n<p><code>", file);
    print_escaped(file, report->command);
    fprintf(file, "</code></p>\n<p>%ux%u pixels, %u complete rounds after a warm-up, %.0f s.",
            s->width, s->height, s->rounds, s->seconds);
    if (s->was_interrupted)
        fputs(" <b>Interrupted: this is what was measured by then.</b>", file);
    if (s->ran_out_of_budget)
        fputs(" <b>The budget ran out before all rounds were done.</b>", file);
    fputs("</p>\n", file);
}

static void print_reference(FILE *file, const char *name, const study_reference *r)
{
    bool is_good = r->rmse <= 0.1 * r->best;
    fprintf(file, "<li>%s: two independent pictures of %u samples, RMSE of their mean %.3g", name,
            r->samples, r->rmse);
    if (!isinf(r->best))
        fprintf(file, ", %.2f of the best measured%s", r->rmse / r->best,
                is_good ? "" : " (the aim of 0.1 was not reached: limit or budget)");
    fputs(".</li>\n", file);
}

static void print_references(FILE *file, const study *s)
{
    fputs("<ul>\n", file);
    print_reference(file, "Reference with the baseline's settings", &s->own);
    if (s->has_deep) {
        print_reference(file, "Deep reference (more bounces, lower threshold)", &s->deep);
        fprintf(file,
                "<li>Between the two: RMSE %.3g. That is what the baseline's bounces and "
                "threshold leave out.</li>\n",
                s->truncation_rmse);
    }
    fputs("</ul>\n", file);
}

static void print_sentences(FILE *file, const study_report *report)
{
    double targets[8];
    uint32_t count = study_targets(report->table, report->wanted_rmse, targets);
    for (uint32_t i = 0; i < count; i++) {
        char sentence[320];
        study_sentence(report->s, report->table, targets[i], sentence, sizeof sentence);
        fputs("<p>", file);
        print_escaped(file, sentence);
        fputs("</p>\n", file);
    }
}

static void print_ratio(FILE *file, const study_ratio *r)
{
    if (!r->is_known)
        fputs("<td class=weak>n/a", file);
    else if (!r->has_interval)
        fprintf(file, "<td class=weak>%.3g", r->value);
    else
        fprintf(file, "<td%s>%.3g [%.3g, %.3g]%s", r->is_significant ? "" : " class=weak", r->value,
                r->low, r->high, r->is_significant ? "" : " not significant");
}

static void print_number(FILE *file, double value)
{
    if (isnan(value))
        fputs("<td class=weak>n/a", file);
    else
        fprintf(file, "<td>%.2g", value);
}

static void print_row(FILE *file, const study_report *report, uint32_t index)
{
    const study_config *config = &report->s->plan.configs[index];
    const study_column *column = &report->table->columns[index];
    uint32_t level = study_levels_of(config) - 1;
    while (level && !column->cells[level].rounds)
        level--;
    const study_cell *cell = &column->cells[level];
    if (!cell->rounds)
        return;
    fprintf(file, "<tr><td>%s<td>%u<td>%.4g ± %.1g", config->name, cell->samples, cell->error.value,
            cell->error.standard_error);
    if (config->is_biased)
        fputs("<td class=weak>n/a", file);
    else
        fprintf(file, "<td>%.4g ± %.1g", cell->noise.value, cell->noise.standard_error);
    fprintf(file, "<td>%.2g ± %.1g<td>%.3g<td>%.3g<td>%.3g", cell->bias.mean, cell->bias_se,
            cell->relative.value, cell->p999.median, cell->largest.median);
    if (cell->predicted_ratio > 0.0)
        fprintf(file, "<td>%.2f", cell->predicted_ratio);
    else
        fputs("<td class=weak>n/a", file);
    fprintf(file, "<td>%.3g<td>%.3g<td>%.4g<td>%.4g<td>%.4g<td>%llu", cell->cpu_s.median,
            cell->wall_s.median, (double)study_rays(&cell->counts) * 1e-6,
            (double)cell->counts.isect.node_visits * 1e-6,
            (double)cell->counts.isect.primitive_tests * 1e-6,
            (unsigned long long)cell->counts.invalid_samples);
    print_ratio(file, &cell->cpu_ratio);
    print_ratio(file, &cell->rmse_ratio);
    print_ratio(file, &cell->work_ratio);
    print_number(file, column->floor);
    print_number(file, config->is_biased && column->fit.is_known ? column->fit.floor : (double)NAN);
    print_number(file, column->fit.is_known ? column->fit.rate : (double)NAN);
    fputc('\n', file);
}

static void print_table(FILE *file, const study_report *report)
{
    fputs(
        "<h2>Every knob at its longest curve</h2>\n"
        "<p>Error: against the deep truth. Noise: against the baseline converged. Ratios are to "
        "the baseline at the same number of samples, with 95 % intervals over the rounds; "
        "M: MSE times CPU time, below 1 is better. Floor: what more samples "
        "do not remove, by pairs of rounds and by the fit RMSE² = floor² + (c n<sup>-rate</sup>)² "
        "with the baseline's rate.</p>\n"
        "<table><tr><th>setting<th>samples<th>error<th>noise<th>bias<th>relative<th>p99.9"
        "<th>max<th>predicted/true<th>CPU s<th>wall s<th>Mrays<th>M nodes<th>M tests<th>invalid"
        "<th>CPU ratio<th>RMSE ratio<th>M ratio<th>floor<th>floor (fit)<th>rate\n",
        file);
    for (uint32_t i = 0; i < report->s->plan.count; i++)
        print_row(file, report, i);
    fputs("</table>\n<h2>Pareto front</h2>\n"
          "<table><tr><th>setting<th>CPU s<th>error\n",
          file);
    for (uint32_t i = 0; i < report->table->front_count; i++) {
        char name[96];
        const study_cell *cell = study_cell_at(report->table, report->table->front[i]);
        study_place_name(report->s, report->table->front[i], name, sizeof name);
        fprintf(file, "<tr><td>%s<td>%.4g<td>%.4g ± %.1g\n", name, cell->cpu_s.median,
                cell->error.value, cell->error.standard_error);
    }
    fputs("</table>\n", file);
}

static void print_plots(FILE *file, const study_report *report)
{
    static const char *const plots[][2] = {
        {"error-cpu.svg", "Error against CPU time, and the Pareto front"},
        {"error-rays.svg", "Error against rays"},
        {"noise-samples.svg", "Noise against samples: knobs that change how samples lie"},
        {"floors.svg", "Knobs that bias: where the error stops falling"},
        {"predicted.svg", "Predicted over true error"}};
    for (size_t i = 0; report->has_plots && i < FL_COUNT_OF(plots); i++)
        fprintf(file, "<h2>%s</h2>\n<img src='%s' alt='%s'>\n", plots[i][1], plots[i][0],
                plots[i][1]);
}

static void print_thumbnails(FILE *file, const study *s)
{
    fputs("<h2>Pictures</h2>\n", file);
    if (study_truth(s)->samples)
        fputs("<figure><img src=reference.png alt=reference><figcaption>reference</figcaption>"
              "</figure>\n",
              file);
    for (uint32_t i = 0; i < s->plan.count; i++)
        if (s->pictures[i].rgb)
            fprintf(
                file,
                "<figure><img src=config-%u.png alt='%s'><figcaption>%s, mean of %u x %u samples"
                "</figcaption></figure>\n",
                i, s->plan.configs[i].name, s->plan.configs[i].name, s->pictures[i].count,
                s->plan.configs[i].samples_max);
}

static void fill_page(FILE *file, const void *context)
{
    const study_report *report = context;
    print_head(file, report);
    print_references(file, report->s);
    print_sentences(file, report);
    print_plots(file, report);
    print_table(file, report);
    print_thumbnails(file, report->s);
    fputs("<p>All pictures one by one: <a href=study.csv>study.csv</a>; this table: "
          "<a href=study.json>study.json</a>; the plots' source: <a href=study.gp>study.gp</a>."
          "</p>\n</html>\n",
          file);
}

bool study_write_page(const study_report *report, fl_diags *diags)
{
    return study_save_text(report->dir, "index.html", fill_page, report, diags);
}
