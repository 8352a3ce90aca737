/* SPDX-License-Identifier: MIT
 *
 * One gnuplot script for all plots: its data once, then a page of settings and curves for each.
 * Names stand at the ends of the curves, not in a key far away; axes end where the data do.
 */
#include <math.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/study_write.h"

/* Columns of the data, from 1. */
typedef enum column { SAMPLES = 1, CPU, RAYS, ERROR, NOISE, PREDICTED } column;

static const char *const axis_names[] = {[SAMPLES] = "samples a pixel",
                                         [CPU] = "CPU time, s",
                                         [RAYS] = "million rays",
                                         [ERROR] = "RMSE against the truth, linear radiance",
                                         [NOISE] = "RMSE against the converged picture",
                                         [PREDICTED] = "predicted over true RMSE"};

static const char *const knob_colors[STUDY_KNOB_COUNT] = {
    [STUDY_BASELINE] = "#1a1a1a", [STUDY_SAMPLER] = "#1f6fb4", [STUDY_LIGHT_SAMPLES] = "#e08a00",
    [STUDY_DEPTH] = "#2a8d4a",    [STUDY_WEIGHT] = "#8a4fd0",  [STUDY_SCALE] = "#d62839",
    [STUDY_ACCEL] = "#8d6e63",    [STUDY_SOLVER] = "#d05fae",  [STUDY_ADAPTIVE] = "#7a7a00",
    [STUDY_PRECISION] = "#00838f"};

static const char *knob_color(study_knob knob)
{
    return knob_colors[knob] ? knob_colors[knob] : "#17a2b8";
}

/* Of the values of one knob, in the order of the plan. */
static const char *const value_colors[] = {"#440154", "#3b528b", "#21918c", "#3fa34d",
                                           "#b59f00", "#d95f02", "#b2182b", "#7f7f7f"};

static double value_of(const study_cell *cell, column c)
{
    switch (c) {
    case SAMPLES:
        return cell->samples;
    case CPU:
        return cell->cpu_s.median;
    case RAYS:
        return (double)study_rays(&cell->counts) * 1e-6;
    case ERROR:
        return cell->error.value;
    case NOISE:
        return cell->noise.value;
    default:
        return cell->predicted_ratio;
    }
}

static bool is_measured(const study_report *report, uint32_t config)
{
    return report->table->columns[config].cells[0].rounds > 0;
}

/* A block of data per configuration. */
static void print_data(FILE *file, const study_report *report)
{
    const study *s = report->s;
    for (uint32_t i = 0; i < s->plan.count; i++) {
        fprintf(file, "$c%u << EOD\n", i);
        for (uint32_t level = 0; level < study_levels_of(&s->plan.configs[i]); level++) {
            const study_cell *cell = &report->table->columns[i].cells[level];
            for (int c = SAMPLES; cell->rounds && c <= PREDICTED; c++)
                if (value_of(cell, (column)c) > 0.0)
                    fprintf(file, "%.6g ", value_of(cell, (column)c));
                else
                    fputs("NaN ", file);
            fputs(cell->rounds ? "\n" : "", file);
        }
        fputs("EOD\n", file);
    }
}

/* --- Axes ------------------------------------------------------------------------------------- */

typedef struct span {
    double lo, hi;
} span;

static void span_add(span *s, double value)
{
    if (!(value > 0.0))
        return;
    s->lo = s->hi > 0.0 ? fl_min(s->lo, value) : value;
    s->hi = fl_max(s->hi, value);
}

/* Share of the way from lo to hi, by logarithms. */
static double place_in(span s, double value)
{
    return log(value / s.lo) / log(s.hi / s.lo);
}

/* Round numbers as they are written: of samples powers of two, else 1, 2, 5 of every decade, of
 * long axes 1 alone. */
static void print_axis(FILE *file, char axis, span s, column c)
{
    static const double steps[3] = {2.0, 2.5, 2.0};
    bool is_long = s.hi > 2000.0 * s.lo, is_first = true;
    fprintf(file, "set %crange [%.6g:%.6g]\nset %clabel '%s'\nset %ctics (", axis, s.lo, s.hi, axis,
            axis_names[c], axis);
    double value = c == SAMPLES ? 1.0 : pow(10.0, floor(log10(s.lo)));
    for (int step = 0; value <= s.hi; step++) {
        if (value >= s.lo) {
            fprintf(file, "%s'%.6g' %.6g", is_first ? "" : ", ", value, value);
            is_first = false;
        }
        value *= c == SAMPLES ? 2.0 : is_long ? 10.0 : steps[step % 3];
    }
    if (is_first) /* A short axis between two of them. */
        fprintf(file, "'%.2g' %.6g", sqrt(s.lo * s.hi), sqrt(s.lo * s.hi));
    fputs(")\n", file);
}

/* --- Curves ----------------------------------------------------------------------------------- */

typedef struct plot {
    const char *file;
    uint32_t knobs; /* A bit each. */
    column x, y;
    bool is_linear; /* y, with a range of its own. */
} plot;

typedef struct curve {
    uint32_t config;
    const char *color;
    double end; /* y at its end; place of its name, from 0 to 1. */
} curve;

static int by_end(const void *a, const void *b)
{
    double x = ((const curve *)a)->end, y = ((const curve *)b)->end;
    return (x < y) - (x > y);
}

static uint32_t find_curves(const study_report *report, const plot *p, curve *out, span *x, span *y)
{
    uint32_t count = 0, value = 0;
    for (uint32_t i = 0; i < report->s->plan.count; i++) {
        const study_config *config = &report->s->plan.configs[i];
        if (!(p->knobs >> config->knob & 1u) || !is_measured(report, i))
            continue;
        curve c = {.config = i,
                   .color = i ? value_colors[value++ % FL_COUNT_OF(value_colors)]
                              : knob_colors[STUDY_BASELINE]};
        for (uint32_t level = 0; level < study_levels_of(config); level++) {
            const study_cell *cell = &report->table->columns[i].cells[level];
            if (!cell->rounds || !(value_of(cell, p->y) > 0.0))
                continue;
            span_add(x, value_of(cell, p->x));
            span_add(y, value_of(cell, p->y));
            c.end = value_of(cell, p->y);
        }
        if (c.end > 0.0)
            out[count++] = c;
    }
    x->lo /= 1.1;
    x->hi *= 1.1;
    y->lo /= 1.15;
    y->hi *= 1.15;
    return count;
}

/* Names beside the ends, pushed apart where they would lie on each other. */
static void place_names(const plot *p, span y, curve *curves, uint32_t count)
{
    const double gap = 0.047;
    for (uint32_t i = 0; i < count; i++)
        curves[i].end =
            p->is_linear ? (curves[i].end - y.lo) / (y.hi - y.lo) : place_in(y, curves[i].end);
    qsort(curves, count, sizeof *curves, by_end);
    for (uint32_t i = 1; i < count; i++)
        curves[i].end = fl_min(curves[i].end, curves[i - 1].end - gap);
    double floor = 0.0;
    for (uint32_t i = count; i-- > 0; floor += gap)
        curves[i].end = fl_max(curves[i].end, floor);
}

static void print_name(FILE *file, const study_report *report, const plot *p, const curve *c)
{
    double slope = report->table->columns[c->config].slope;
    fprintf(file, "set label \"%s", report->s->plan.configs[c->config].name);
    if (p->x == SAMPLES && p->y == NOISE && slope < 0.0)
        fprintf(file, " (slope %.2f)", slope);
    fprintf(file, "\" at graph 1.02, graph %.4f tc rgb '%s'\n", c->end, c->color);
}

static void print_plot(FILE *file, const study_report *report, const plot *p)
{
    curve curves[STUDY_CONFIGS_MAX];
    span x = {0}, y = {0};
    uint32_t count = find_curves(report, p, curves, &x, &y);
    if (count < (p->x == SAMPLES ? 1u : 2u)) /* A knob's curve wants one to compare with. */
        return;
    if (p->is_linear)
        y = (span){0.4, 1.8};
    fprintf(file, "reset\nset grid lc rgb '#e4e4e4' lt 1\nset border 3 lc rgb '#555555'\n"
                  "set tics nomirror tc rgb '#333333'\nunset key\nset rmargin 26\nset lmargin 10\n"
                  "set logscale x\n");
    print_axis(file, 'x', x, p->x);
    if (p->is_linear)
        fprintf(file, "set yrange [%g:%g]\nset ylabel '%s'\n", y.lo, y.hi, axis_names[p->y]);
    else
        fputs("set logscale y\n", file);
    if (!p->is_linear)
        print_axis(file, 'y', y, p->y);
    place_names(p, y, curves, count);
    for (uint32_t i = 0; i < count; i++)
        print_name(file, report, p, &curves[i]);
    fprintf(file, "set output '%s.svg'\nplot ", p->file);
    if (p->y == PREDICTED)
        fputs("0.75 with lines dt 2 lc rgb '#888888', 1.4 with lines dt 2 lc rgb '#888888', \\\n  ",
              file);
    for (uint32_t i = 0; i < count; i++)
        fprintf(file, "%s$c%u using %d:%d with linespoints pt 7 ps %s lw %s lc rgb '%s'",
                i ? ", \\\n  " : "", curves[i].config, p->x, p->y,
                curves[i].config ? "0.35" : "0.5", curves[i].config ? "1.4" : "2.6",
                curves[i].color);
    if (p->y == ERROR)
        fprintf(file, ", \\\n  $now using %d:%d with points pt 6 ps 1.6 lw 2.5 lc rgb '#d62839'",
                p->x, p->y);
    fputc('\n', file);
}

/* --- The front -------------------------------------------------------------------------------- */

/* The row of the scene as asked for. */
static void print_now(FILE *file, const study_report *report)
{
    const study_cell *now = study_now(report->s, report->table);
    fprintf(file, "$now << EOD\n%u %.6g %.6g %.6g\nEOD\n$front << EOD\n", now->samples,
            now->cpu_s.median, value_of(now, RAYS), now->error.value);
    for (uint32_t i = 0; i < report->table->front_count; i++) {
        const study_cell *cell = study_cell_at(report->table, report->table->front[i]);
        fprintf(file, "%u %.6g %.6g %.6g\n", cell->samples, cell->cpu_s.median,
                value_of(cell, RAYS), cell->error.value);
    }
    fputs("EOD\n", file);
}

/* Left of and below the front there is nothing: room for its names. */
static void print_front_names(FILE *file, const study_report *report, span x, span y, column c)
{
    double above = 2.0;
    for (uint32_t i = 0; i < report->table->front_count; i++) {
        const study_cell *cell = study_cell_at(report->table, report->table->front[i]);
        double at = cell->error.value > 0.0 ? place_in(y, cell->error.value) : 2.0;
        if (at > above - 0.035) /* No error has no place; others lie too close. */
            continue;
        above = at;
        char name[96];
        study_place_name(report->s, report->table->front[i], name, sizeof name);
        fprintf(file, "set label \"%s\" right at graph %.4f, graph %.4f font ',11'\n", name,
                place_in(x, value_of(cell, c)) - 0.012, at - 0.012);
    }
}

static void print_front(FILE *file, const study_report *report, const char *name, column c)
{
    const study *s = report->s;
    curve curves[STUDY_CONFIGS_MAX];
    span x = {0}, y = {0};
    plot p = {.knobs = ~0u, .x = c, .y = ERROR};
    uint32_t count = find_curves(report, &p, curves, &x, &y), seen = 0;
    if (!count)
        return;
    x.lo /= pow(x.hi / x.lo, 0.35);
    fputs("reset\nset grid lc rgb '#e4e4e4' lt 1\nset border 3 lc rgb '#555555'\n"
          "set tics nomirror tc rgb '#333333'\nset key outside right top reverse Left samplen 1\n"
          "set lmargin 10\nset logscale xy\n",
          file);
    print_axis(file, 'x', x, c);
    print_axis(file, 'y', y, ERROR);
    print_front_names(file, report, x, y, c);
    fprintf(file, "set output '%s.svg'\nplot ", name);
    for (uint32_t i = 0; i < count; i++) {
        study_knob knob = s->plan.configs[curves[i].config].knob;
        fprintf(file, "$c%u using %d:%d with linespoints pt 7 ps 0.3 lw %s lc rgb '%s' ",
                curves[i].config, c, ERROR, knob == STUDY_BASELINE ? "2.6" : "0.8",
                knob_color(knob));
        if (seen >> knob & 1u)
            fputs("notitle, \\\n  ", file);
        else
            fprintf(file, "title '%s', \\\n  ", study_knob_names[knob]);
        seen |= 1u << knob;
    }
    if (c == CPU)
        fprintf(file,
                "$front using %d:%d with steps lw 2 lc rgb '#1a1a1a' dt 3 title 'cheapest', "
                "\\\n  $front using %d:%d with points pt 7 ps 0.6 lc rgb '#1a1a1a' notitle, "
                "\\\n  ",
                c, ERROR, c, ERROR);
    fprintf(file,
            "$now using %d:%d with points pt 6 ps 1.8 lw 2.5 lc rgb '#d62839' title "
            "'as asked for'\n",
            c, ERROR);
}

static void fill_script(FILE *file, const void *context)
{
    const study_report *report = context;
    enum {
        BASE = 1u << STUDY_BASELINE,
        SAMPLING = BASE | 1u << STUDY_SAMPLER | 1u << STUDY_LIGHT_SAMPLES
    };
    print_data(file, report);
    print_now(file, report);
    fputs("set terminal svg size 820,470 font 'sans-serif,13' background '#ffffff'\n", file);
    print_front(file, report, "error-cpu", CPU);
    print_front(file, report, "error-rays", RAYS);
    for (uint32_t knob = STUDY_BASELINE + 1; knob < STUDY_KNOB_COUNT; knob++) {
        char name[STUDY_NAME_BYTES + 8];
        snprintf(name, sizeof name, "knob-%s", study_knob_names[knob]);
        print_plot(file, report,
                   &(plot){.file = name, .knobs = BASE | 1u << knob, .x = CPU, .y = ERROR});
    }
    print_plot(file, report,
               &(plot){.file = "noise-samples", .knobs = SAMPLING, .x = SAMPLES, .y = NOISE});
    print_plot(file, report,
               &(plot){.file = "predicted",
                       .knobs = SAMPLING,
                       .x = SAMPLES,
                       .y = PREDICTED,
                       .is_linear = true});
}

/* True: gnuplot is there and made the pictures. */
static bool run_gnuplot(const char *dir)
{
    fflush(NULL);
    pid_t child = fork();
    if (child < 0)
        return false;
    if (child == 0) {
        if (chdir(dir) == 0)
            execlp("gnuplot", "gnuplot", "study.gp", (char *)NULL);
        _exit(127);
    }
    int status;
    return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool study_write_plots(study_report *report, fl_diags *diags)
{
    report->has_plots = false;
    if (!is_measured(report, 0))
        return true;
    if (!study_save_text(report->dir, "study.gp", fill_script, report, diags))
        return false;
    report->has_plots = run_gnuplot(report->dir);
    if (!report->has_plots)
        fl_warning(diags, (fl_loc){0},
                   "no plots: gnuplot is missing or failed (run 'gnuplot study.gp' in '%s')",
                   report->dir);
    return true;
}
