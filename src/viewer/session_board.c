/* SPDX-License-Identifier: MIT
 *
 * What the board at the right says.
 */
#include <stdio.h>
#include <string.h>

#include "viewer/session.h"
#include "viewer/words.h"

enum { USES_COLUMNS = 44, TEXT_COLUMNS = 56 };

/* How the error of random samples falls: what is assumed before it is known. */
#define RATE_SLOW 0.5
/* How far the plot looks ahead. */
#define AHEAD 16.0
/* Closer than this part of time and error to the present a mark would only hide it. */
#define NEAR_HERE 0.08

static void rays_board(const vw_session *session, vw_board *board)
{
    const char *text = session->insight.rays_lines;
    snprintf(board->title, sizeof board->title, "rays");
    for (uint32_t i = 0; text && *text; i++) {
        size_t length = strcspn(text, "\n");
        if (i == 0)
            snprintf(board->title, sizeof board->title, "%.*s", (int)length, text);
        else if (board->row_count + 1 < VW_BOARD_ROWS || !text[length] || !text[length + 1])
            vw_board_add(board, -1.0, "", "%s", "");
        else
            break;
        if (i > 0)
            snprintf(board->rows[board->row_count - 1].label, VW_BOARD_LABEL, "%.*s", (int)length,
                     text);
        text += length + (text[length] != 0);
    }
    if (text && *text)
        vw_board_note(board, "... the rest is on standard output");
}

/* Words in rows of at most USES_COLUMNS. */
static void put_words(vw_board *board, const char *const *words, uint32_t count)
{
    char line[VW_BOARD_LABEL] = "uses";
    for (uint32_t i = 0; i < count; i++) {
        if (strlen(line) + 1 + strlen(words[i]) > USES_COLUMNS) {
            vw_board_add(board, -1.0, line, "%s", "");
            snprintf(line, sizeof line, "    ");
        }
        size_t length = strlen(line);
        snprintf(line + length, sizeof line - length, " %s%s", words[i], i + 1 < count ? "," : "");
    }
    vw_board_add(board, -1.0, line, "%s", "");
}

static void put_plan(const vw_session *session, const fl_frame *frame, vw_board *board)
{
    const char *words[FL_NEED_COUNT + 8];
    char lights[48];
    uint32_t count = 0, soft = 0, samples = 0;
    const fl_compiled *scene = session->scene.compiled;
    for (uint32_t i = 0; i < FL_NEED_COUNT; i++)
        if (scene->needs >> i & 1u)
            words[count++] = fl_need_names[i];
    for (uint32_t i = 0; i < frame->light_count; i++) {
        soft += frame->lights[i].draws;
        samples += frame->lights[i].samples;
    }
    words[count++] = frame->plan.samples_lens ? "a lens" : "a pinhole";
    snprintf(lights, sizeof lights, "%u light%s (%u soft)", frame->light_count,
             frame->light_count == 1 ? "" : "s", soft);
    words[count++] = lights;
    put_words(board, words, count);
    const fl_counts *counts = &session->progress.counts;
    double dimensions =
        counts->samples ? (double)counts->sample_dimensions / (double)counts->samples : 0.0;
    static const char *const accels[] = {"bvh", "octree", "no tree"};
    vw_board_note(board, "%.3g dimensions a sample; %u shadow ray%s a hit", dimensions, samples,
                  samples == 1 ? "" : "s");
    vw_board_note(board, "kernels %s, %s", fl_isa_name(scene->isa), accels[scene->geometry.accel]);
}

static void put_stages(const vw_session *session, vw_board *board)
{
    const double *seconds = session->progress.cost_seconds;
    double sum = 0.0;
    for (int i = 0; i < FL_COST_COUNT; i++)
        sum += seconds[i];
    if (!(sum > 0.0))
        return;
    vw_board_note(board, "time by stage");
    for (int i = 0; i < FL_COST_COUNT; i++)
        if (seconds[i] >= 0.005 * sum)
            vw_board_add(board, seconds[i] / sum, fl_cost_names[i], "%.0f %%",
                         100.0 * seconds[i] / sum);
}

static void put_wait(const vw_session *session, vw_board *board, vw_lab_kind kind)
{
    const vw_lab_answer *answer = &session->insight.answer;
    if (vw_insight_has(&session->insight, kind) && answer->error[0])
        vw_board_note(board, "not measured: %s", answer->error);
    else
        vw_board_note(board, "being measured ...");
}

/* Text in dim rows, broken between words. */
static void put_text(vw_board *board, const char *text)
{
    while (*text) {
        size_t length = strlen(text), at = length;
        if (length > TEXT_COLUMNS) {
            at = TEXT_COLUMNS;
            while (at > 0 && text[at] != ' ')
                at--;
            at = at ? at : TEXT_COLUMNS;
        }
        vw_board_note(board, "%.*s", (int)at, text);
        text += at + (text[at] == ' ');
    }
}

static void noise_board(const vw_session *session, vw_board *board)
{
    const vw_lab_answer *answer = &session->insight.answer;
    const fl_noise_split *noise = &answer->noise;
    snprintf(board->title, sizeof board->title, "where the noise comes from");
    if (!vw_insight_has(&session->insight, VW_LAB_NOISE) || answer->error[0]) {
        put_wait(session, board, VW_LAB_NOISE);
        return;
    }
    char name[FL_NOISE_NAME_BYTES], advice[FL_NOISE_ADVICE_BYTES];
    for (uint32_t i = 0; i < noise->source_count; i++) {
        const fl_noise_source *source = &noise->sources[i];
        fl_noise_source_name(source, name);
        vw_board_add(board, source->share, name, "%.0f %% \302\261 %.0f", 100.0 * source->share,
                     100.0 * source->share_error);
    }
    fl_noise_advice(noise, advice);
    /* The shares stand above. */
    const char *knob = strchr(advice, ':');
    put_text(board, knob && noise->source_count ? knob + 2 : advice);
    if (noise->light_samples > 0.0)
        vw_board_note(board, "light samples %.3g; best %.2g, error \303\227%.2f in the same time",
                      noise->light_samples, noise->light_samples_best,
                      1.0 / noise->light_samples_gain);
    vw_board_note(board, "noise of %u samples; round %u of %d", noise->samples, noise->rounds,
                  FL_NOISE_ROUNDS);
}

static void needs_board(const vw_session *session, const fl_frame *frame, vw_board *board)
{
    const vw_lab_answer *answer = &session->insight.answer;
    snprintf(board->title, sizeof board->title, "what the scene needs");
    put_plan(session, frame, board);
    put_stages(session, board);
    if (!vw_insight_has(&session->insight, VW_LAB_TRIALS) || answer->error[0]) {
        put_wait(session, board, VW_LAB_TRIALS);
        return;
    }
    vw_board_note(board, "time saved, and rays, without");
    const vw_trial *now = &answer->trials[0];
    for (uint32_t i = 1; i < answer->trial_count; i++) {
        const vw_trial *trial = &answer->trials[i];
        double saved = 1.0 - trial->cpu_seconds / now->cpu_seconds;
        vw_board_add(board, fl_max(saved, 0.0), trial->name, "%.0f %%, %.0f %%",
                     100.0 * fl_max(saved, 0.0),
                     100.0 * fl_max(1.0 - trial->rays / now->rays, 0.0));
    }
}

static void put_forecast(const vw_session *session, vw_board *board)
{
    const fl_progress *progress = &session->progress;
    fl_error_forecast forecast;
    char error[24], target[24], t0[24], between[64];
    if (!progress->error.is_known) {
        vw_board_note(board, "error known from 4 samples on");
        return;
    }
    vw_words_percent(progress->error.rmse, error);
    vw_words_duration(progress->seconds, t0);
    vw_board_add(board, -1.0, "now", "%s after %s", error, t0);
    double goal = progress->error.rmse / 2.0;
    if (!fl_error_predict(&progress->error, goal, &forecast) || !(progress->mean_samples > 0.0))
        return;
    double second = progress->seconds / progress->mean_samples;
    vw_words_percent(goal, target);
    vw_words_duration(forecast.samples * second, t0);
    vw_words_between(forecast.low * second, forecast.high * second, between);
    vw_board_add(board, -1.0, "half that", "%s after %s (%s)", target, t0, between);
}

/* Cost, error and time to the same error against the present setting; a change of depth is one of
 * the picture, not of its noise. Rays are exact, time is measured. */
static void put_trial(const vw_trial *now, const vw_trial *trial, double rate, vw_board *board)
{
    double rays = trial->rays / now->rays, time = trial->cpu_seconds / now->cpu_seconds;
    double error = trial->rmse / now->rmse;
    char change[24];
    if (trial->change == 0.0) {
        vw_board_add(board, -1.0, trial->name, "changes nothing");
    } else if (strncmp(trial->name, "depth", 5) == 0) {
        vw_words_percent(trial->change, change);
        vw_board_add(board, -1.0, trial->name, "rays \303\227%.2f  time \303\227%.2f  off by %s",
                     rays, time, change);
    } else {
        double same = time * fl_d_exp2(fl_d_log2(error) / rate);
        vw_board_add(board, -1.0, trial->name,
                     "rays \303\227%.2f  time \303\227%.2f  error \303\227%.2f  \342\206\222 "
                     "\303\227%.2f",
                     rays, time, error, same);
    }
}

static void mark_trial(const vw_milestone *here, const vw_trial *now, const vw_trial *trial,
                       vw_plot *plot)
{
    double time = trial->cpu_seconds / now->cpu_seconds, error = trial->rmse / now->rmse;
    bool is_here =
        trial->change == 0.0 || (fabs(time - 1.0) < NEAR_HERE && fabs(error - 1.0) < NEAR_HERE);
    if (is_here || plot->mark_count == FL_COUNT_OF(plot->marks))
        return;
    vw_mark *mark = &plot->marks[plot->mark_count++];
    mark->x = here->seconds * time;
    mark->y = here->rmse * error;
    const char *number = strrchr(trial->name, ' ');
    snprintf(mark->sign, sizeof mark->sign, "%c%s", trial->name[0], number ? number + 1 : "");
}

static void trade_board(const vw_session *session, vw_board *board)
{
    const vw_insight *insight = &session->insight;
    const vw_lab_answer *answer = &insight->answer;
    const fl_error_estimate *error = &session->progress.error;
    vw_plot *plot = &board->plot;
    snprintf(board->title, sizeof board->title, "trade: error against time");
    snprintf(plot->x_unit, sizeof plot->x_unit, "s");
    snprintf(plot->y_unit, sizeof plot->y_unit, "error %%");
    for (uint32_t i = 0; i < insight->way_count && plot->count < VW_PLOT_POINTS; i++) {
        plot->x[plot->count] = insight->way[i].seconds;
        plot->y[plot->count++] = 100.0 * insight->way[i].rmse;
    }
    vw_milestone here = {session->progress.seconds, 100.0 * error->rmse,
                         session->progress.complete_samples};
    uint32_t last = insight->way_count ? insight->way[insight->way_count - 1].samples : 0;
    if (error->is_known && here.samples > last && plot->count < VW_PLOT_POINTS) {
        plot->x[plot->count] = here.seconds;
        plot->y[plot->count++] = here.rmse;
    }
    board->has_plot = plot->count > 0;
    plot->has_forecast = error->is_known;
    plot->rate = error->exponent;
    fl_error_bracket(error->exponent, &plot->slow, &plot->fast);
    plot->end_x = AHEAD * here.seconds;
    put_forecast(session, board);
    if (!vw_insight_has(insight, VW_LAB_TRIALS) || answer->error[0]) {
        put_wait(session, board, VW_LAB_TRIALS);
        return;
    }
    if (answer->trial_count < 2) {
        vw_board_note(board, "no knob but samples changes this scene");
        return;
    }
    vw_board_note(board, "one step of a knob (\342\206\222: time to the same error)");
    for (uint32_t i = 1; i < answer->trial_count; i++) {
        put_trial(&answer->trials[0], &answer->trials[i],
                  error->is_known ? error->exponent : RATE_SLOW, board);
        if (error->is_known && answer->trials[0].rmse > 0.0)
            mark_trial(&here, &answer->trials[0], &answer->trials[i], plot);
    }
}

bool vw_session_board(vw_session *session, vw_board *out)
{
    *out = (vw_board){0};
    fl_params params;
    fl_diags diags = {0};
    fl_frame *frame;
    switch (session->state.panel) {
    case VW_PANEL_RAYS:
        rays_board(session, out);
        return true;
    case VW_PANEL_NOISE:
        noise_board(session, out);
        return true;
    case VW_PANEL_NEEDS:
        vw_state_params(&session->state, &session->scene.params, &params);
        frame = fl_frame_create(session->scene.compiled, &params, &diags);
        if (frame)
            needs_board(session, frame, out);
        fl_frame_release(frame);
        fl_diags_deinit(&diags);
        return frame != NULL;
    case VW_PANEL_TRADE:
        trade_board(session, out);
        return true;
    case VW_PANEL_NONE:
    case VW_PANEL_COUNT:
        break;
    }
    return false;
}
