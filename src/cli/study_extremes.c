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

enum { WIDTH = 48, HEIGHT = 36, SAMPLES = 4, FIELDS_MAX = 10, TEXT_MAX = 8192, SIZE_UNITS = 10 };

static const double bound_default = 1e-6;
/* A pixel is off when it differs by more than this part of the picture's root mean square. */
static const double off_share = 1.0 / 256.0;
/* Pictures beyond this are refused here, so that a row does not fill a small machine. */
static const size_t memory_limit = (size_t)1 << 30;

/* A value of a family, cut into its fields. */
typedef struct value {
    char text[256];
    const char *fields[FIELDS_MAX];
    uint32_t count;
    bool is_slow;
} value;

typedef struct picture {
    float *rgb;
    size_t floats;
    uint64_t invalid;
} picture;

/* The fields point into *out, which must not move. */
static void value_read(const char *text, value *out)
{
    *out = (value){.is_slow = text[0] == '!'};
    snprintf(out->text, sizeof out->text, "%s", text + (out->is_slow ? 1 : 0));
    for (char *at = out->text; at && out->count < FIELDS_MAX;) {
        out->fields[out->count++] = at;
        at = strchr(at, '|');
        if (at)
            *at++ = 0;
    }
}

static double number(const char *text)
{
    double x = 0.0;
    fl_number_parse(text, text + strlen(text), &x);
    return x;
}

/* The family's text with the fields put in. */
static void fill(const char *text, const value *v, char out[TEXT_MAX])
{
    size_t length = 0;
    for (; *text && length + 1 < TEXT_MAX; text++) {
        uint32_t field = (uint32_t)(text[1] - '0');
        if (*text != '@' || field >= v->count) {
            out[length++] = *text;
            continue;
        }
        int written = snprintf(out + length, TEXT_MAX - length, "%s", v->fields[field]);
        length += (size_t)written;
        text++;
    }
    out[length < TEXT_MAX ? length : TEXT_MAX - 1] = 0;
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

/* False after adding an error; a picture of what the text says at that scale and place. */
static bool render(const extreme_family *f, const char *text, double scale, fl_vec3 offset,
                   fl_precision precision, uint32_t threads, fl_diags *diags, picture *out)
{
    uint32_t samples;
    bool ok = false, is_mapped = scale != 1.0 || fl_v3_max_abs(offset) > 0.0;
    fl_compiled *compiled = NULL;
    fl_render *run = NULL;
    fl_scene *scene =
        fl_scene_parse(text, strlen(text), f->name, &(fl_parse_options){0}, &extreme_files, diags);
    if (scene && (!is_mapped || fl_scene_map(scene, scale, offset, diags)))
        compiled = fl_compile(scene, &(fl_compile_options){0}, NULL, diags);
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

static void judge_picture(const extreme_family *f, const value *v, const char *text,
                          uint32_t threads, extreme_result *out)
{
    fl_diags diags = {0};
    picture got = {0}, want = {0};
    double scale = f->judge == EXTREME_SCALED ? number(v->fields[0]) : 1.0;
    double far = f->judge == EXTREME_MOVED ? SIZE_UNITS * number(v->fields[0]) : 0.0;
    bool ok = render(f, text, 1.0, fl_v3(0, 0, 0), FL_PRECISION_DOUBLE, threads, &diags, &want) &&
              render(f, text, scale, fl_v3(far, -0.5 * far, 0.25 * far), FL_PRECISION_FLOAT,
                     threads, &diags, &got);
    if (ok) {
        compare(&got, &want, out);
        out->passed = out->invalid == 0 && out->off <= f->off_max &&
                      out->error <= (f->bound > 0.0 ? f->bound : bound_default);
    }
    snprintf(out->note, sizeof out->note, "%s", diags.count ? diags.items[0].message : "");
    free(got.rgb);
    free(want.rgb);
    fl_diags_deinit(&diags);
}

/* Refused means: an error that names what is wrong; where the text is to blame, its place too. */
static void judge_refusal(const extreme_family *f, const value *v, const char *text,
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

static void judge_rays(const value *v, extreme_result *out)
{
    double distance = v->count > 2 ? number(v->fields[2]) : 0.0;
    if (!extreme_rays(number(v->fields[0]), distance, (uint64_t)number(v->fields[1]), out))
        snprintf(out->note, sizeof out->note, "no memory");
}

static extreme_result judge(const extreme_family *f, const value *v, uint32_t threads)
{
    char text[TEXT_MAX];
    extreme_result r = {0};
    if (f->judge == EXTREME_RAYS) {
        judge_rays(v, &r);
        return r;
    }
    fill(f->text, v, text);
    if (f->judge == EXTREME_REFUSED)
        judge_refusal(f, v, text, threads, &r);
    else
        judge_picture(f, v, text, threads, &r);
    return r;
}

/* --- The table ---------------------------------------------------------------------------------
 */

static void name_value(const extreme_family *f, const value *v, char *out, size_t bytes)
{
    /* Rays: scale, or distance from outside. */
    const char *name = f->judge == EXTREME_RAYS && v->count > 2 ? v->fields[2] : v->fields[0];
    bool is_pair = strstr(f->name, "picture of") || strcmp(f->name, "texture") == 0 ||
                   strcmp(f->name, "colour") == 0 || strcmp(f->name, "focus") == 0 ||
                   strcmp(f->name, "looking along") == 0;
    if (f->judge == EXTREME_RAYS)
        snprintf(out, bytes, "%s, %s rays", name, v->fields[1]);
    else if (is_pair)
        snprintf(out, bytes, "%s, %s", v->fields[0], v->fields[1]);
    else
        snprintf(out, bytes, "%s", name);
}

static void print_row(const extreme_family *f, const char *name, const extreme_result *r)
{
    printf("%-4s  %-38s %-28s ", r->passed ? "pass" : "FAIL", f->name, name);
    if (f->judge == EXTREME_REFUSED)
        printf("%s\n", r->note);
    else if (f->judge == EXTREME_RAYS)
        printf("%u lost of %u (bound 0)%s%s\n", r->off, r->pixels, r->note[0] ? ": " : "", r->note);
    else
        printf("error %8.2e (%.0e)  off %u of %u (%u)  invalid %llu%s%s\n", r->error,
               f->bound > 0.0 ? f->bound : bound_default, r->off, r->pixels, f->off_max,
               (unsigned long long)r->invalid, r->note[0] ? ": " : "", r->note);
}

static json_t *row_json(const extreme_family *f, const char *name, const extreme_result *r)
{
    static const char *const judges[] = {"double", "scaled", "moved", "refused", "rays"};
    return json_pack("{s:s, s:s, s:s, s:b, s:f, s:f, s:I, s:I, s:I, s:I, s:s}", "family", f->name,
                     "value", name, "judge", judges[f->judge], "passed", (int)r->passed, "error",
                     r->error, "bound", f->bound > 0.0 ? f->bound : bound_default, "off",
                     (json_int_t)r->off, "off_max", (json_int_t)f->off_max, "pixels",
                     (json_int_t)r->pixels, "invalid", (json_int_t)r->invalid, "note", r->note);
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
            count += is_thorough || (*v)[0] != '!' ? 1 : 0;
    return count;
}

int study_extremes(const cli_options *options)
{
    bool is_thorough = cli_has(options, CLI_OPT_ALL), is_json = cli_has(options, CLI_OPT_JSON);
    bool shows_progress = !cli_has(options, CLI_OPT_QUIET) && isatty(STDERR_FILENO);
    uint32_t all = count_rows(is_thorough), passed = 0, done = 0;
    json_t *rows = json_array();
    cli_catch_signals();
    for (uint32_t i = 0; i < extreme_family_count; i++) {
        const extreme_family *f = &extreme_families[i];
        for (const char *const *text = f->values; *text && !cli_was_interrupted(); text++) {
            value v;
            value_read(*text, &v);
            if (v.is_slow && !is_thorough)
                continue;
            char name[96];
            name_value(f, &v, name, sizeof name);
            if (shows_progress)
                fprintf(stderr, "\r%u of %u: %s, %s\033[K\r", done, all, f->name, name);
            extreme_result r = judge(f, &v, options->threads);
            passed += r.passed ? 1 : 0;
            done++;
            if (is_json)
                json_array_append_new(rows, row_json(f, name, &r));
            else
                print_row(f, name, &r);
            fflush(stdout);
        }
    }
    if (is_json)
        print_json(json_incref(rows), passed, done);
    else
        printf("%u of %u rows passed\n", passed, done);
    json_decref(rows);
    return cli_was_interrupted() ? CLI_INTERRUPTED : passed == done ? CLI_DONE : CLI_CHECK_FAILED;
}
