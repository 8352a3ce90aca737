/* SPDX-License-Identifier: MIT */
#include "cli/study_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SLOPE_FROM = 4 }; /* 16 samples. */

/* One number of every round in which configuration and level were measured. */
typedef double (*pick)(const study_measure *m);

static double cpu_of(const study_measure *m)
{
    return m->cpu_s;
}
static double wall_of(const study_measure *m)
{
    return m->wall_s;
}
static double noise_of(const study_measure *m)
{
    return m->noise.mse;
}
static double error_of(const study_measure *m)
{
    return m->error.mse;
}
static double relative_of(const study_measure *m)
{
    return m->error.relative_mse;
}
static double bias_of(const study_measure *m)
{
    return m->error.bias;
}
static double largest_of(const study_measure *m)
{
    return m->error.largest;
}
static double p999_of(const study_measure *m)
{
    return m->error.p999;
}
static double flip_of(const study_measure *m)
{
    return m->flip;
}
static double predicted_of(const study_measure *m)
{
    return m->predicted.rmse;
}
static double work_of(const study_measure *m)
{
    return m->noise.mse * m->cpu_s;
}
static double work_error_of(const study_measure *m)
{
    return m->error.mse * m->cpu_s;
}

static uint32_t gather(const study *s, uint32_t config, uint32_t level, pick value,
                       double out[STUDY_REPEATS_MAX])
{
    uint32_t count = 0;
    for (uint32_t round = 0; round < s->settings.repeats; round++) {
        const study_measure *m = study_at(s, config, round, level);
        if (m->is_there)
            out[count++] = value(m);
    }
    return count;
}

static study_spread spread(const study *s, uint32_t config, uint32_t level, pick value)
{
    double values[STUDY_REPEATS_MAX];
    uint32_t count = gather(s, config, level, value, values);
    return study_spread_of(values, count);
}

/* Paired by rounds: where the configuration was measured, so was the baseline, which goes first. */
static study_ratio ratio(const study *s, uint32_t config, uint32_t level, pick value)
{
    double values[STUDY_REPEATS_MAX], base[STUDY_REPEATS_MAX];
    uint32_t count = gather(s, config, level, value, values);
    gather(s, 0, level, value, base);
    return study_ratio_of(values, base, count);
}

/* Of mean squares to roots. */
static study_ratio root_ratio(study_ratio r)
{
    r.value = sqrt(r.value);
    r.low = sqrt(r.low);
    r.high = sqrt(r.high);
    return r;
}

static double mean_of(const float *rgb, size_t floats)
{
    double sum = 0.0;
    for (size_t i = 0; i < floats; i++)
        sum += (double)rgb[i];
    return sum / (double)floats;
}

static void fill_cell(const study *s, uint32_t config, uint32_t level, double reference_se,
                      study_cell *cell)
{
    study_spread noise = spread(s, config, level, noise_of);
    if (!noise.count)
        return;
    bool is_biased = s->plan.configs[config].is_biased;
    cell->rounds = noise.count;
    cell->samples = 1u << level;
    for (uint32_t round = 0; round < s->settings.repeats && !cell->counts.samples; round++)
        cell->counts = study_at(s, config, round, level)->counts;
    study_spread error = spread(s, config, level, error_of);
    study_spread relative = spread(s, config, level, relative_of);
    study_spread predicted = spread(s, config, level, predicted_of);
    cell->cpu_s = spread(s, config, level, cpu_of);
    cell->wall_s = spread(s, config, level, wall_of);
    cell->bias = spread(s, config, level, bias_of);
    cell->bias_se =
        sqrt(cell->bias.standard_error * cell->bias.standard_error + reference_se * reference_se);
    cell->largest = spread(s, config, level, largest_of);
    cell->p999 = spread(s, config, level, p999_of);
    cell->flip = spread(s, config, level, flip_of);
    cell->noise = study_root_of(&noise);
    cell->error = study_root_of(&error);
    cell->relative = study_root_of(&relative);
    cell->predicted = predicted.mean;
    if (!is_biased && cell->noise.value > 0.0)
        cell->predicted_ratio = cell->predicted / cell->noise.value;
    if (config == 0)
        return;
    cell->cpu_ratio = ratio(s, config, level, cpu_of);
    cell->rmse_ratio = root_ratio(ratio(s, config, level, is_biased ? error_of : noise_of));
    cell->work_ratio = ratio(s, config, level, is_biased ? work_error_of : work_of);
}

/* Noise that the baseline has too is taken out, what it lacks itself is put in. */
static double pair_floor(const study *s, uint32_t config)
{
    const study_sum *d = &s->differences[config];
    if (config == 0)
        return s->has_deep ? s->truncation_rmse : 0.0;
    if (d->count < 2)
        return (double)NAN;
    return sqrt(fl_max(0.0, study_floor_mse(d->rgb, d->count, d->mse, s->shift[0], s->shift[1],
                                            (size_t)s->width * s->height)));
}

/* Differences d of two rounds have in common what the limits differ by: mean of d d' over pairs. */
static double pair_distance(const study *s, uint32_t config)
{
    const study_sum *d = &s->differences[config];
    size_t floats = (size_t)3 * s->width * s->height;
    double square = 0.0;
    if (d->count < 2)
        return (double)NAN;
    for (size_t i = 0; i < floats; i++)
        square += (double)d->rgb[i] * (double)d->rgb[i];
    double pairs = (double)d->count * (d->count - 1);
    return sqrt(fl_max(0.0, (square / (double)floats - d->square) / pairs));
}

/* The baseline first: its rate is that of all fits with a floor. */
static void fill_column(const study *s, uint32_t config, double base_rate, study_column *column)
{
    double samples[STUDY_LEVELS_MAX], mse[STUDY_LEVELS_MAX], rmse[STUDY_LEVELS_MAX];
    uint32_t count = 0, first = 0, levels = study_levels_of(&s->plan.configs[config]);
    bool is_biased = s->plan.configs[config].is_biased;
    for (uint32_t level = 0; level < levels; level++) {
        const study_cell *cell = &column->cells[level];
        double root = is_biased ? cell->error.value : cell->noise.value;
        if (!cell->rounds || !(root > 0.0))
            continue;
        if (level < SLOPE_FROM && levels >= SLOPE_FROM + 2)
            first = count + 1;
        samples[count] = cell->samples;
        rmse[count] = root;
        mse[count++] = root * root;
    }
    column->fit = is_biased ? study_fit_floor(samples, mse, count, base_rate)
                            : study_fit_rate(samples, mse, count);
    column->slope = study_slope_of(samples + first, rmse + first, count - first);
    column->floor = pair_floor(s, config);
    column->apart = pair_distance(s, config);
}

static bool dominates(const study_cell *a, const study_cell *b)
{
    return a->cpu_s.median <= b->cpu_s.median && a->error.value <= b->error.value &&
           (a->cpu_s.median < b->cpu_s.median || a->error.value < b->error.value);
}

static bool is_on_front(const study *s, const study_table *table, const study_cell *cell)
{
    for (uint32_t i = 0; i < s->plan.count; i++)
        for (uint32_t level = 0; level < s->levels; level++) {
            const study_cell *other = &table->columns[i].cells[level];
            if (other->rounds && dominates(other, cell))
                return false;
        }
    return true;
}

static void find_front(const study *s, study_table *table)
{
    for (uint32_t i = 0; i < s->plan.count; i++)
        for (uint32_t level = 0; level < s->levels; level++) {
            const study_cell *cell = &table->columns[i].cells[level];
            if (!cell->rounds || !is_on_front(s, table, cell))
                continue;
            uint32_t at = table->front_count++;
            while (at &&
                   study_cell_at(table, table->front[at - 1])->cpu_s.median > cell->cpu_s.median) {
                table->front[at] = table->front[at - 1];
                at--;
            }
            table->front[at] = (study_place){i, level};
        }
}

study_table *study_table_create(const study *s)
{
    study_table *table = calloc(1, sizeof *table);
    if (!table)
        return NULL;
    const study_reference *truth = study_truth(s);
    size_t floats = (size_t)3 * s->width * s->height;
    double reference_se = 0.0;
    if (truth->samples)
        reference_se = fabs(mean_of(truth->rgb[0], floats) - mean_of(truth->rgb[1], floats)) / 2.0;
    for (uint32_t i = 0; i < s->plan.count; i++) {
        for (uint32_t level = 0; level < study_levels_of(&s->plan.configs[i]); level++)
            fill_cell(s, i, level, reference_se, &table->columns[i].cells[level]);
        fill_column(s, i, table->columns[0].fit.rate, &table->columns[i]);
    }
    find_front(s, table);
    return table;
}

static bool is_within(const study_cell *cell, double rmse)
{
    return cell->rounds && cell->error.value + 2.0 * cell->error.standard_error <= rmse;
}

/* What is cheaper by chance is no reason to leave the defaults. */
bool study_cheapest(const study_table *table, double rmse, study_place *out_place)
{
    uint32_t i = 0;
    while (i < table->front_count && !is_within(study_cell_at(table, table->front[i]), rmse))
        i++;
    if (i == table->front_count)
        return false;
    *out_place = table->front[i];
    const study_ratio *ratio = &study_cell_at(table, *out_place)->cpu_ratio;
    if (out_place->config && !(ratio->is_significant && ratio->value < 1.0) &&
        is_within(&table->columns[0].cells[out_place->level], rmse))
        out_place->config = 0;
    return true;
}

const study_cell *study_now(const study *s, const study_table *table)
{
    uint32_t level = s->levels - 1;
    while (level && !table->columns[0].cells[level].rounds)
        level--;
    return &table->columns[0].cells[level];
}

void study_place_name(const study *s, study_place place, char *out, size_t bytes)
{
    uint32_t samples = 1u << place.level;
    snprintf(out, bytes, "%s, %u sample%s", s->plan.configs[place.config].name, samples,
             samples == 1 ? "" : "s");
}

void study_sentence(const study *s, const study_table *table, double rmse, char *out, size_t bytes)
{
    study_place place;
    if (!study_cheapest(table, rmse, &place)) {
        snprintf(out, bytes, "No measured setting has an RMSE of at most %g.", rmse);
        return;
    }
    char name[96];
    const study_cell *cell = study_cell_at(table, place);
    study_place_name(s, place, name, sizeof name);
    snprintf(out, bytes,
             "The cheapest setting with RMSE <= %g is %s: RMSE %.3g +- %.1g in %.3g s of CPU time, "
             "%.3g million rays.",
             rmse, name, cell->error.value, cell->error.standard_error, cell->cpu_s.median,
             (double)study_rays(&cell->counts) * 1e-6);
}

void study_summary(const study *s, const study_table *table, char *out, size_t bytes)
{
    const study_cell *now = study_now(s, table);
    study_place place;
    if (!now->rounds) {
        snprintf(out, bytes, "Nothing was measured.");
        return;
    }
    int used =
        snprintf(out, bytes,
                 "As asked for, with %u samples: RMSE %.2g, mean FLIP %.2g, %.2g s of CPU time. ",
                 now->samples, now->error.value, now->flip.mean, now->cpu_s.median);
    double as_good = now->error.value + 2.0 * now->error.standard_error;
    if (used < 0 || (size_t)used >= bytes)
        return;
    if (!study_cheapest(table, as_good, &place) || place.config == 0) {
        snprintf(out + used, bytes - (size_t)used,
                 "No measured setting is as good and surely cheaper.");
        return;
    }
    char name[96];
    const study_cell *cell = study_cell_at(table, place);
    study_place_name(s, place, name, sizeof name);
    snprintf(out + used, bytes - (size_t)used, "As good for %.0f %% of that time: %s (RMSE %.2g).",
             100.0 * cell->cpu_s.median / now->cpu_s.median, name, cell->error.value);
}

uint32_t study_targets(const study_table *table, double wanted, double out_targets[8])
{
    static const double round_numbers[] = {0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005};
    if (wanted > 0.0) {
        out_targets[0] = wanted;
        return 1;
    }
    uint32_t count = 0;
    study_place place;
    for (uint32_t i = 0; i < FL_COUNT_OF(round_numbers); i++)
        if (study_cheapest(table, round_numbers[i], &place))
            out_targets[count++] = round_numbers[i];
    return count;
}
