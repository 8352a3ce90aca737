/* SPDX-License-Identifier: MIT
 *
 * Runs the rows of extremes_scenes.c and prints what came out.
 */
#include "cli/study_extremes.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/extremes.h"

enum { WIDTH = 48, HEIGHT = 36, SAMPLES = 4, SIZE_UNITS = 10 };
/* Unless a value says otherwise, one pixel in so many may be off. */
enum { OFF_SHARE_MAX = 100 };

/* A pixel is off when it differs by more than this part of the picture's root mean square. */
static const double off_share = 1.0 / 256.0;
/* Pictures beyond this are refused here, so that a row does not fill a small machine. */
static const size_t memory_limit = (size_t)1 << 30;

typedef struct picture {
    float *rgb;
    size_t floats;
    uint64_t invalid;
} picture;

/* All that is asked of the suite, and how far it is. */
typedef struct suite {
    bool is_thorough, is_json, shows_progress;
    uint32_t threads;
    uint32_t all, passed, done;
    json_t *rows;
    picture last; /* The true picture of the value before, of the same family. */
} suite;

static double field(const extreme_value *v, uint32_t i)
{
    return i < v->count ? extreme_number(v->fields[i]) : 0.0;
}

/* --- Rendering ---------------------------------------------------------------------------------
 */

static bool take_film(fl_render *render, const fl_params *p, picture *out)
{
    fl_progress progress;
    out->floats = (size_t)p->width * p->height * 3;
    out->rgb = malloc(out->floats * sizeof *out->rgb);
    if (!out->rgb || !fl_render_mean(render, out->rgb, out->floats, &progress))
        return false;
    out->invalid = progress.counts.invalid_samples;
    return true;
}

static fl_params params_of(const extreme_family *f, const fl_scene *scene, fl_precision precision,
                           uint32_t *out_samples)
{
    fl_params p;
    fl_params_from_scene(&p, scene, false);
    p.precision = precision;
    if (!scene->camera.width) {
        p.width = WIDTH;
        p.height = HEIGHT;
    }
    *out_samples = f->samples ? f->samples : SAMPLES;
    if (scene->render.has_samples)
        *out_samples = scene->render.samples;
    return p;
}

/* A picture of what the text says at that scale and place; false after adding an error. */
static bool render(const extreme_family *f, const char *text, double scale, fl_vec3 offset,
                   fl_precision precision, uint32_t threads, fl_diags *diags, picture *out)
{
    fl_compile_options options = {.in_double = precision == FL_PRECISION_DOUBLE};
    uint32_t samples;
    bool ok = false, is_mapped = scale != 1.0 || fl_v3_max_abs(offset) > 0.0;
    fl_compiled *compiled = NULL;
    fl_render *run = NULL;
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), f->name, &(fl_parse_options){0}, &extreme_files, diags);
    if (scene && (!is_mapped || fl_scene_map(scene, scale, offset, diags)))
        compiled = fl_compile(scene, &options, NULL, diags);
    if (compiled) {
        fl_params p = params_of(f, scene, precision, &samples);
        run = fl_render_create(
            &(fl_render_options){.thread_count = threads, .memory_limit_bytes = memory_limit},
            diags);
        if (run)
            fl_render_set_limits(run, &(fl_render_limits){.samples = samples});
        ok = run && fl_render_restart(run, compiled, &p, diags) && fl_render_wait(run, -1.0) &&
             take_film(run, &p, out);
    }
    fl_render_destroy(run);
    fl_compiled_release(compiled);
    fl_scene_destroy(scene);
    return ok;
}

/* --- Judging -----------------------------------------------------------------------------------
 */

static double root_mean_square(const picture *p)
{
    double sum = 0.0;
    for (size_t i = 0; i < p->floats; i++)
        sum += (double)p->rgb[i] * (double)p->rgb[i];
    return sqrt(sum / (double)p->floats);
}

static void compare(const picture *got, const picture *want, extreme_result *out)
{
    double scale = root_mean_square(want), sum = 0.0;
    scale = scale > 0.0 ? scale : 1.0;
    out->off = 0;
    for (size_t i = 0; i < want->floats; i += 3) {
        double squares = 0.0, largest = 0.0;
        for (size_t c = i; c < i + 3; c++) {
            double d = ((double)got->rgb[c] - (double)want->rgb[c]) / scale;
            squares += d * d;
            largest = fabs(d) <= largest ? largest : fabs(d); /* NaN too */
        }
        bool is_off = !(largest <= off_share);
        out->off += is_off ? 1 : 0;
        sum += is_off ? 0.0 : squares;
    }
    out->pixels = (uint32_t)(want->floats / 3);
    out->error = sqrt(sum / (double)want->floats);
    out->invalid = got->invalid + want->invalid;
}

/* Relative difference of the sums over all pixels. */
static double error_of_mean(const picture *got, const picture *want)
{
    double difference = 0.0, sum = 0.0;
    for (size_t i = 0; i < want->floats; i++) {
        difference += (double)got->rgb[i] - (double)want->rgb[i];
        sum += fabs((double)want->rgb[i]);
    }
    return fabs(difference) / (sum > 0.0 ? sum : 1.0);
}

static void set_limits(const extreme_value *v, extreme_result *out)
{
    uint32_t most = out->pixels / OFF_SHARE_MAX;
    out->bound = v->bound;
    out->off_max = v->has_limits || v->off_max < most ? v->off_max : most;
}

static bool is_within(const extreme_result *r)
{
    return r->off <= r->off_max && r->error <= r->bound;
}

/* What a value changes is known: all of the picture, or nothing. Leaves `want` as the last one. */
static bool follows_the_last(picture *last, const extreme_value *v, picture *want,
                             extreme_result *out)
{
    bool is_true = true;
    if (last->rgb && last->floats == want->floats) {
        extreme_result change = *out;
        compare(want, last, &change);
        is_true = is_within(&change) == v->is_same;
        if (!is_true)
            snprintf(out->note, sizeof out->note, "%s that of the value before: %.1e, %u off",
                     v->is_same ? "not the picture as" : "the same picture as", change.error,
                     change.off);
    }
    free(last->rgb);
    *last = *want;
    want->rgb = NULL;
    return is_true;
}

static void take_note(const fl_diags *diags, extreme_result *out)
{
    if (diags->count > 0)
        snprintf(out->note, sizeof out->note, "%s", diags->items[0].message);
}

/* How far the scene is moved: across all axes, and not by equal parts. */
static fl_vec3 place_of(const extreme_family *f, const extreme_value *v)
{
    bool is_moved = f->judge == EXTREME_MOVED || f->judge == EXTREME_WARNED;
    double far = is_moved ? SIZE_UNITS * field(v, 0) : 0.0;
    return fl_v3(far, -0.5 * far, 0.25 * far);
}

static void judge_picture(suite *s, const extreme_family *f, const extreme_value *v,
                          const char *text, extreme_result *out)
{
    fl_diags diags = {0};
    picture got = {0}, want = {0};
    bool has_change = f->judge == EXTREME_DOUBLE || f->judge == EXTREME_MEAN;
    double scale = f->judge == EXTREME_SCALED ? field(v, 0) : 1.0;
    bool ok =
        render(f, text, 1.0, fl_v3(0, 0, 0), FL_PRECISION_DOUBLE, s->threads, &diags, &want) &&
        render(f, text, scale, place_of(f, v), FL_PRECISION_FLOAT, s->threads, &diags, &got);
    if (ok) {
        compare(&got, &want, out);
        set_limits(v, out);
        if (f->judge == EXTREME_MEAN)
            out->error = error_of_mean(&got, &want);
        out->passed = out->invalid == 0 && is_within(out) && diags.count == 0 &&
                      (!has_change || follows_the_last(&s->last, v, &want, out));
    }
    take_note(&diags, out);
    free(got.rgb);
    free(want.rgb);
    fl_diags_deinit(&diags);
}

/* Floats must be warned of, in the text's own terms, and double must be what the warning says. */
static void judge_warned(const suite *s, const extreme_family *f, const extreme_value *v,
                         const char *text, extreme_result *out)
{
    fl_diags diags = {0};
    picture rough = {0}, got = {0}, want = {0};
    fl_vec3 place = place_of(f, v);
    bool ok = render(f, text, 1.0, place, FL_PRECISION_FLOAT, s->threads, &diags, &rough);
    bool is_warned = diags.warning_count == 1 && diags.items[0].loc.line > 0 &&
                     strstr(diags.items[0].message, "--precision double") != NULL;
    ok = ok && render(f, text, 1.0, place, FL_PRECISION_DOUBLE, s->threads, &diags, &got) &&
         render(f, text, 1.0, fl_v3(0, 0, 0), FL_PRECISION_DOUBLE, s->threads, &diags, &want);
    if (ok) {
        extreme_result floats = {0};
        compare(&rough, &want, &floats);
        compare(&got, &want, out);
        set_limits(v, out);
        out->invalid += rough.invalid;
        out->passed = is_warned && out->invalid == 0 && is_within(out) && diags.count == 1;
        snprintf(out->note, sizeof out->note, "floats: %u off, %s", floats.off,
                 is_warned ? "warned of" : "no warning");
    } else {
        take_note(&diags, out);
    }
    free(rough.rgb);
    free(got.rgb);
    free(want.rgb);
    fl_diags_deinit(&diags);
}

static void judge_counted(const suite *s, const extreme_family *f, const char *text,
                          extreme_result *out)
{
    fl_diags diags = {0};
    picture got = {0};
    bool ok = render(f, text, 1.0, fl_v3(0, 0, 0), FL_PRECISION_FLOAT, s->threads, &diags, &got);
    out->pixels = (uint32_t)(got.floats / 3);
    out->invalid = got.invalid;
    for (size_t i = 0; ok && i < got.floats; i++)
        out->off += isfinite(got.rgb[i]) ? 0 : 1;
    out->passed = ok && diags.count == 0 && out->off == 0 && out->invalid > 0;
    take_note(&diags, out);
    free(got.rgb);
    fl_diags_deinit(&diags);
}

/* Refused means: an error that names what is wrong; where the text is to blame, its place too. */
static void judge_refusal(const extreme_family *f, const extreme_value *v, const char *text,
                          uint32_t threads, extreme_result *out)
{
    fl_diags diags = {0};
    picture got = {0};
    bool rendered = render(f, text, 1.0, fl_v3(0, 0, 0), FL_PRECISION_FLOAT, threads, &diags, &got);
    const char *want = v->fields[v->count - 1];
    const char *message = diags.count ? diags.items[0].message : "";
    out->passed = !rendered && diags.error_count > 0 && strstr(message, want) != NULL;
    snprintf(out->note, sizeof out->note, "%s", rendered ? "rendered" : message);
    free(got.rgb);
    fl_diags_deinit(&diags);
}

static void judge_rays(const extreme_family *f, const extreme_value *v, extreme_result *out)
{
    extreme_aim aim = {.objects = f->text,
                       .scale = field(v, 0),
                       .count = (uint64_t)field(v, 1),
                       .distance = field(v, 2),
                       .moved = field(v, 3)};
    if (!extreme_rays(&aim, out))
        snprintf(out->note, sizeof out->note, "no memory");
}

static extreme_result judge(suite *s, const extreme_family *f, const extreme_value *v)
{
    char text[EXTREME_TEXT_MAX];
    extreme_result r = {0};
    if (f->judge == EXTREME_RAYS) {
        judge_rays(f, v, &r);
        return r;
    }
    extreme_text(f, v, text);
    if (f->judge == EXTREME_REFUSED)
        judge_refusal(f, v, text, s->threads, &r);
    else if (f->judge == EXTREME_COUNTED)
        judge_counted(s, f, text, &r);
    else if (f->judge == EXTREME_WARNED)
        judge_warned(s, f, v, text, &r);
    else
        judge_picture(s, f, v, text, &r);
    return r;
}

/* --- The table ---------------------------------------------------------------------------------
 */

static void name_value(const extreme_family *f, const extreme_value *v, char *out, size_t bytes)
{
    if (f->judge == EXTREME_RAYS) {
        snprintf(out, bytes, "scale %s, %s%s%s%s, %s rays", v->fields[0],
                 field(v, 2) > 0.0 ? "from " : "inside", field(v, 2) > 0.0 ? v->fields[2] : "",
                 v->count > 3 ? ", moved " : "", v->count > 3 ? v->fields[3] : "", v->fields[1]);
        return;
    }
    size_t length = 0;
    for (uint32_t i = 0; i < v->count && (i == 0 || i < f->shown) && length < bytes; i++)
        length +=
            (size_t)snprintf(out + length, bytes - length, "%s%s", i ? ", " : "", v->fields[i]);
}

static void print_row(const extreme_family *f, const char *name, const extreme_result *r)
{
    const char *colon = r->note[0] ? ": " : "";
    printf("%-4s  %-38s %-28s ", r->passed ? "pass" : "FAIL", f->name, name);
    if (f->judge == EXTREME_REFUSED)
        printf("%s\n", r->note);
    else if (f->judge == EXTREME_RAYS)
        printf("%u lost of %u (bound 0)%s%s\n", r->off, r->pixels, colon, r->note);
    else if (f->judge == EXTREME_COUNTED)
        printf("dropped and counted %llu%s%s\n", (unsigned long long)r->invalid, colon, r->note);
    else
        printf("error %8.2e (%.0e)  off %u of %u (%u)  invalid %llu%s%s\n", r->error, r->bound,
               r->off, r->pixels, r->off_max, (unsigned long long)r->invalid, colon, r->note);
}

static json_t *row_json(const extreme_family *f, const char *name, const extreme_result *r)
{
    static const char *const judges[] = {"double", "mean",    "scaled",  "moved",
                                         "warned", "counted", "refused", "rays"};
    return json_pack("{s:s, s:s, s:s, s:b, s:f, s:f, s:I, s:I, s:I, s:I, s:s}", "family", f->name,
                     "value", name, "judge", judges[f->judge], "passed", (int)r->passed, "error",
                     r->error, "bound", r->bound, "off", (json_int_t)r->off, "off_max",
                     (json_int_t)r->off_max, "pixels", (json_int_t)r->pixels, "invalid",
                     (json_int_t)r->invalid, "note", r->note);
}

static void print_json(json_t *rows, uint32_t passed, uint32_t all)
{
    json_t *line =
        json_pack("{s:o, s:i, s:i}", "rows", rows, "passed", (int)passed, "all", (int)all);
    if (line) {
        json_dumpf(line, stdout, JSON_COMPACT | JSON_REAL_PRECISION(6));
        putchar('\n');
    }
    json_decref(line);
}

static uint32_t count_rows(bool is_thorough)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < extreme_family_count; i++)
        for (const char *const *v = extreme_families[i].values; *v; v++)
            count += is_thorough || !strchr(*v, '!') ? 1 : 0;
    return count;
}

static void run_family(suite *s, const extreme_family *f)
{
    for (const char *const *text = f->values; *text && !cli_was_interrupted(); text++) {
        extreme_value v;
        char name[96];
        extreme_value_read(f, *text, &v);
        if (v.is_slow && !s->is_thorough)
            continue;
        name_value(f, &v, name, sizeof name);
        if (s->shows_progress)
            fprintf(stderr, "\r%u of %u: %s, %s\033[K\r", s->done, s->all, f->name, name);
        extreme_result r = judge(s, f, &v);
        s->passed += r.passed ? 1 : 0;
        s->done++;
        if (s->is_json)
            json_array_append_new(s->rows, row_json(f, name, &r));
        else
            print_row(f, name, &r);
        fflush(stdout);
    }
    free(s->last.rgb);
    s->last = (picture){0};
}

int study_extremes(const cli_options *options)
{
    suite s = {.is_thorough = cli_has(options, CLI_OPT_ALL),
               .is_json = cli_has(options, CLI_OPT_JSON),
               .shows_progress = !cli_has(options, CLI_OPT_QUIET) && isatty(STDERR_FILENO),
               .threads = options->threads,
               .rows = json_array()};
    s.all = count_rows(s.is_thorough);
    cli_catch_signals();
    for (uint32_t i = 0; i < extreme_family_count && !cli_was_interrupted(); i++)
        run_family(&s, &extreme_families[i]);
    if (s.is_json)
        print_json(json_incref(s.rows), s.passed, s.done);
    else
        printf("%u of %u rows passed\n", s.passed, s.done);
    json_decref(s.rows);
    return cli_was_interrupted() ? CLI_INTERRUPTED
           : s.passed == s.done  ? CLI_DONE
                                 : CLI_CHECK_FAILED;
}
