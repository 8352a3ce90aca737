/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/study_write.h"

/* A block of data per configuration: samples, CPU seconds, rays, error, noise, predicted/true. */
static void print_data(FILE *file, const study_report *report)
{
    const study *s = report->s;
    for (uint32_t i = 0; i < s->plan.count; i++) {
        fprintf(file, "$c%u << EOD\n", i);
        for (uint32_t level = 0; level < study_levels_of(&s->plan.configs[i]); level++) {
            const study_cell *cell = &report->table->columns[i].cells[level];
            if (!cell->rounds)
                continue;
            fprintf(file, "%u %.6g %.6g", cell->samples, cell->cpu_s.median,
                    (double)study_rays(&cell->counts));
            const double values[] = {cell->error.value, cell->noise.value, cell->predicted_ratio};
            for (size_t k = 0; k < FL_COUNT_OF(values); k++)
                if (values[k] > 0.0)
                    fprintf(file, " %.6g", values[k]);
                else
                    fputs(" NaN", file);
            fputc('\n', file);
        }
        fputs("EOD\n", file);
    }
    fputs("$front << EOD\n", file);
    for (uint32_t i = 0; i < report->table->front_count; i++) {
        const study_cell *cell = study_cell_at(report->table, report->table->front[i]);
        fprintf(file, "%.6g %.6g\n", cell->cpu_s.median, cell->error.value);
    }
    fputs("EOD\n", file);
}

static bool is_measured(const study_report *report, uint32_t config)
{
    return report->table->columns[config].cells[0].rounds > 0;
}

/* All configurations of the knobs in `knobs`, x and y by column of the data. */
static void print_plot(FILE *file, const study_report *report, uint32_t knobs, int x, int y,
                       const char *extra)
{
    const study *s = report->s;
    fputs("plot ", file);
    bool is_first = true;
    for (uint32_t i = 0; i < s->plan.count; i++) {
        const study_config *config = &s->plan.configs[i];
        if (!(knobs >> config->knob & 1u) || !is_measured(report, i))
            continue;
        double slope = report->table->columns[i].slope;
        fprintf(file, "%s$c%u using %d:%d with linespoints lw %s ps 0.5 title \"%s",
                is_first ? "" : ", \\\n  ", i, x, y, i ? "1" : "2.5", config->name);
        if (y == 5 && slope < 0.0)
            fprintf(file, " (slope %.2f)", slope);
        fputc('"', file);
        is_first = false;
    }
    fprintf(file, "%s\n", extra);
}

enum {
    SAMPLING = 1u << STUDY_BASELINE | 1u << STUDY_SAMPLER | 1u << STUDY_LIGHT_SAMPLES,
    BIASED = 1u << STUDY_BASELINE | 1u << STUDY_DEPTH | 1u << STUDY_WEIGHT | 1u << STUDY_SCALE |
             1u << STUDY_SOLVER,
    ALL = (1u << STUDY_KNOB_COUNT) - 1
};

static void fill_script(FILE *file, const void *context)
{
    const study_report *report = context;
    print_data(file, report);
    fputs("set terminal svg size 860,560 font 'sans-serif,12' background '#ffffff'\n"
          "set logscale xy\nset grid\nset key outside right top\nset format y '%.0e'\n"
          "set ylabel 'RMSE, linear radiance'\n",
          file);
    fputs("set output 'error-cpu.svg'\nset xlabel 'CPU time, s'\n", file);
    print_plot(file, report, ALL, 2, 4,
               ", \\\n  $front using 1:2 with steps lw 3 lc rgb '#80000000' title 'Pareto front'");
    fputs("set output 'error-rays.svg'\nset xlabel 'rays'\nset format x '%.0e'\n", file);
    print_plot(file, report, ALL, 3, 4, "");
    fputs("set format x '%g'\nset output 'noise-samples.svg'\nset xlabel 'samples a pixel'\n",
          file);
    print_plot(file, report, SAMPLING, 1, 5, "");
    fputs("set output 'floors.svg'\n", file);
    print_plot(file, report, BIASED, 1, 4, "");
    fputs("set output 'predicted.svg'\nunset logscale y\nset yrange [0.4:1.8]\nset format y '%g'\n"
          "set ylabel 'predicted / true RMSE'\n",
          file);
    print_plot(file, report, SAMPLING, 1, 6,
               ", \\\n  0.75 with lines dt 2 lc 'black' title 'band', "
               "1.4 with lines dt 2 lc 'black' notitle");
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
