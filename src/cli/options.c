/* SPDX-License-Identifier: MIT */
#include "cli/options.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/tables.h"

static const char *const switch_names[] = {"off", "on", NULL};
static const char *const sampler_names[] = {"sobol", "random", "padded", "stratified", NULL};
static const char *const solver_names[] = {"robust", "newton", NULL};
static const char *const precision_names[] = {"float", "double", NULL};
static const char *const accel_names[] = {"bvh", "octree", "none", NULL};
static const char *const isa_names[] = {"scalar", "sse2", "avx2", "neon", "auto", NULL};
static const char *const dialect_names[] = {"firstlight", "pa1", "m04", "m12", NULL};
static const char *const platform_names[] = {"glfw", "osmesa", "egl", NULL};

#define BIT(command) (1u << (command))
#define RENDERING (BIT(CLI_VIEW) | BIT(CLI_RENDER) | BIT(CLI_STUDY))
#define LOOKING (RENDERING | BIT(CLI_INFO))
#define PICTURE (RENDERING | BIT(CLI_CHECK) | BIT(CLI_REPLAY))
#define LOADING (PICTURE | BIT(CLI_INFO) | BIT(CLI_BENCH))
#define AT(field) offsetof(cli_options, field)

const cli_option cli_option_table[CLI_OPT_COUNT] = {
    [CLI_OPT_SIZE] = {"size", 's', "WxH", CLI_KIND_SIZE, AT(size), 1, FL_SIDE_MAX, NULL, LOOKING | BIT(CLI_BENCH),
                      "picture size in pixels (default: the scene's, else 640x640)"},
    [CLI_OPT_SAMPLES] = {"samples", 'n', "N", CLI_KIND_COUNT, AT(samples), 1, 1e9, NULL, RENDERING,
                         "samples per pixel (default 64; the window stops at 4096; study: the longest curve)"},
    [CLI_OPT_TIME] = {"time", 't', "SECONDS", CLI_KIND_NUMBER, AT(time_s), 1e-3, 1e9, NULL,
                      BIT(CLI_VIEW) | BIT(CLI_RENDER), "stop after this time"},
    [CLI_OPT_NOISE] = {"noise", 0, "RMSE", CLI_KIND_NUMBER, AT(noise), 1e-9, 1e3, NULL, RENDERING,
                       "stop when the predicted error is below this"},
    [CLI_OPT_LIGHT_SAMPLES] = {"light-samples", 0, "N", CLI_KIND_COUNT_OR_AUTO, AT(light_samples), 1,
                               FL_LIGHT_SAMPLES_MAX, NULL, LOOKING,
                               "shadow rays per disk light and hit; auto: the measured optimum"},
    [CLI_OPT_DEPTH] = {"depth", 'd', "N", CLI_KIND_COUNT, AT(depth), 0, FL_DEPTH_MAX, NULL, LOOKING,
                       "bounces of reflected and refracted rays"},
    [CLI_OPT_APERTURE] = {"aperture", 'a', "R", CLI_KIND_NUMBER, AT(aperture), 0, 1e30, NULL, LOOKING,
                          "lens radius in scene units; 0 is a pinhole"},
    [CLI_OPT_FOCUS] = {"focus", 'f', "D", CLI_KIND_NUMBER_OR_INF, AT(focus), 1e-300, 1e300, NULL, LOOKING,
                       "distance of the sharp plane along the view, or inf"},
    [CLI_OPT_CAMERA] = {"camera", 'c', "'EX EY EZ  LX LY LZ  UX UY UZ  FOV'", CLI_KIND_CAMERA, AT(camera), 0, 0,
                        NULL, LOOKING, "eye, look-at point, up, vertical field of view in degrees"},
    [CLI_OPT_SCALE] = {"scale", 0, "S", CLI_KIND_NUMBER, AT(scale), 1e-4, 1e4, NULL, BIT(CLI_VIEW) | BIT(CLI_RENDER),
                       "times the picture's size in pixels: 0.5 renders a quarter of them"},
    [CLI_OPT_CROP] = {"crop", 0, "X,Y,W,H", CLI_KIND_CROP, AT(crop), 0, FL_SIDE_MAX, NULL, BIT(CLI_RENDER),
                      "render this part only; same bytes as in the whole"},
    [CLI_OPT_EXPOSURE] = {"exposure", 'e', "EV", CLI_KIND_NUMBER, AT(exposure_ev), -64, 64, NULL, RENDERING,
                          "brighten 8-bit output by this many stops"},
    [CLI_OPT_WEIGHT_THRESHOLD] = {"weight-threshold", 0, "W", CLI_KIND_NUMBER, AT(weight_threshold), 0, 1, NULL,
                                  LOOKING, "end branches that weigh less (default 1/1024, 0: never)"},
    [CLI_OPT_SEED] = {"seed", 0, "N", CLI_KIND_COUNT, AT(seed), 0, 4294967295.0, NULL, LOOKING,
                      "another set of samples"},
    [CLI_OPT_SAMPLER] = {"sampler", 0, NULL, CLI_KIND_CHOICE, AT(sampler), 0, 0, sampler_names, PICTURE | BIT(CLI_INFO),
                         "where samples lie (default sobol; the others are there to compare with)"},
    [CLI_OPT_REVOLVE_SOLVER] = {"revolve-solver", 0, NULL, CLI_KIND_CHOICE, AT(solver), 0, 0, solver_names,
                                PICTURE | BIT(CLI_INFO), "surfaces of revolution (default robust)"},
    [CLI_OPT_REVOLVE_STARTS] = {"revolve-starts", 0, "N", CLI_KIND_COUNT, AT(revolve_starts), 1,
                                FL_REVOLVE_MAX_STARTS, NULL, PICTURE | BIT(CLI_INFO),
                                "starts a segment of --revolve-solver newton (default 8)"},
    [CLI_OPT_PRECISION] = {"precision", 0, NULL, CLI_KIND_CHOICE, AT(precision), 0, 0, precision_names,
                           PICTURE, "numbers that rays are traced in (default float); double measures its error"},
    [CLI_OPT_ACCEL] = {"accel", 0, NULL, CLI_KIND_CHOICE, AT(accel), 0, 0, accel_names, LOADING,
                       "how triangles are found (default bvh); all give the same picture"},
    [CLI_OPT_OCTREE_HEIGHT] = {"octree-height", 0, "N", CLI_KIND_COUNT, AT(octree_height), 1, 8, NULL, LOADING,
                               "levels of the octree (default 8)"},
    [CLI_OPT_QUICK_ABOVE] = {"quick-above", 0, "N", CLI_KIND_COUNT, AT(quick_above), 0, 4294967295.0, NULL,
                             BIT(CLI_VIEW) | BIT(CLI_RENDER) | BIT(CLI_REPLAY),
                             "meshes of more triangles are built quickly first and refined while the picture grows, which "
                             "stays the same (default 1000000, render: 0, none)"},
    [CLI_OPT_ISA] = {"isa", 0, NULL, CLI_KIND_CHOICE_TEXT, AT(isa), 0, 0, isa_names, LOADING,
                     "instruction set (default auto); all give the same picture"},
    [CLI_OPT_THREADS] = {"threads", 'j', "N", CLI_KIND_COUNT, AT(threads), 1, 1024, NULL, LOADING,
                         "worker threads (default: one per CPU); any number gives the same picture"},
    [CLI_OPT_LEAVE_CORE] = {"leave-core", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, BIT(CLI_VIEW) | BIT(CLI_REPLAY),
                            "one worker thread fewer: a CPU is left to others"},
    [CLI_OPT_DIALECT] = {"dialect", 0, NULL, CLI_KIND_CHOICE, AT(dialect), 0, 0, dialect_names,
                         LOADING | BIT(CLI_CONVERT), "whose rules the text follows (default: recognised)"},
    [CLI_OPT_DIALECT_EXACT] = {"dialect-exact", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, LOADING,
                               "the picture of the course's own program, shortcuts included"},
    [CLI_OPT_LENIENT] = {"lenient", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, LOADING | BIT(CLI_CONVERT),
                         "warn about known slips of course files instead of refusing them"},
    [CLI_OPT_OUTPUT] = {"output", 'o', "FILE", CLI_KIND_OUTPUT, AT(outputs), 0, 0, NULL, BIT(CLI_RENDER),
                        "picture to write: .png .exr .tif .bmp ...; may be repeated"},
    [CLI_OPT_CHECKPOINT] = {"checkpoint", 0, "FILE", CLI_KIND_TEXT, AT(checkpoint), 0, 0, NULL, BIT(CLI_RENDER),
                            "go on from this file if it is there, and keep what is rendered in it: now and then, "
                            "when interrupted and at the end; the bytes are those of a render without a break"},
    [CLI_OPT_AOV] = {"aov", 0, "NAMES", CLI_KIND_TEXT, AT(aov), 0, 0, NULL, BIT(CLI_RENDER),
                     "what stands behind the pixels too: depth,normal,albedo,samples,error,cost as NAME.depth.exr ..."},
    [CLI_OPT_NOISE_SPLIT] = {"noise-split", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, BIT(CLI_RENDER) | BIT(CLI_INFO),
                             "measure where the noise comes from (edges, lens, each light) and which knob helps"},
    [CLI_OPT_ADAPTIVE] = {"adaptive", 0, NULL, CLI_KIND_CHOICE, AT(adaptive), 0, 0, switch_names,
                          BIT(CLI_VIEW) | BIT(CLI_RENDER) | BIT(CLI_REPLAY),
                          "on: more samples where the noise is, the same number in the mean (default off)"},
    [CLI_OPT_UPDATE] = {"update", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, BIT(CLI_CHECK),
                        "write the golden pictures instead of comparing"},
    [CLI_OPT_REPORT] = {"report", 0, "DIR", CLI_KIND_TEXT, AT(report), 0, 0, NULL, BIT(CLI_CHECK),
                        "write a page with golden, new and difference"},
    [CLI_OPT_OUT] = {"out", 0, "DIR", CLI_KIND_TEXT, AT(out_dir), 0, 0, NULL, BIT(CLI_STUDY),
                     "folder for the figures, plots and page"},
    [CLI_OPT_BUDGET] = {"budget", 0, "SECONDS", CLI_KIND_NUMBER, AT(budget_s), 1, 1e9, NULL, BIT(CLI_STUDY),
                        "stop measuring after this time (default: when all is measured)"},
    [CLI_OPT_REPEATS] = {"repeats", 0, "N", CLI_KIND_COUNT, AT(repeats), 1, 64, NULL,
                         BIT(CLI_STUDY) | BIT(CLI_BENCH), "rounds of measurements (default: study 4, bench 5)"},
    [CLI_OPT_SWEEP] = {"sweep", 0, "KNOB,...", CLI_KIND_TEXT, AT(sweep), 0, 0, NULL, BIT(CLI_STUDY),
                       "knobs to move (default: all that mean something in the scene)"},
    [CLI_OPT_EXTREMES] = {"extremes", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, BIT(CLI_STUDY),
                          "no scene: the ends of all ranges against double precision; exit 1 if a row fails"},
    [CLI_OPT_ALL] = {"all", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, BIT(CLI_STUDY),
                     "with --extremes: the slow rows too"},
    [CLI_OPT_AGAINST] = {"against", 0, "NAME", CLI_KIND_TEXT, AT(against), 0, 0, NULL, BIT(CLI_BENCH),
                         "trace the same rays with another tracer: embree, where its module was built"},
    [CLI_OPT_FIRST_PICTURE] = {"first-picture", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, BIT(CLI_BENCH),
                               "of meshes: time from compiling to the first picture, to 1 and 16 samples, with and without "
                               "a quick first build"},
    [CLI_OPT_GROWTH] = {"growth", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, BIT(CLI_BENCH),
                        "cost of a ray for 1 to a million spheres, and more triangles, instances, lights"},
    [CLI_OPT_SOURCE] = {"source-comparison", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, BIT(CLI_BENCH),
                        "a whole picture by hierarchy, octree and brute force, on one thread"},
    [CLI_OPT_RECORD] = {"record", 0, "LOG", CLI_KIND_TEXT, AT(record), 0, 0, NULL, BIT(CLI_VIEW),
                        "write all input to a log that replay understands"},
    [CLI_OPT_KEYS] = {"keys", 0, "FILE", CLI_KIND_TEXT, AT(keys), 0, 0, NULL, BIT(CLI_VIEW) | BIT(CLI_REPLAY),
                      "other keys for commands (default: view $XDG_CONFIG_HOME/firstlight/keys)"},
    [CLI_OPT_PIN] = {"pin", 0, "FILE", CLI_KIND_TEXT, AT(pin), 0, 0, NULL, BIT(CLI_VIEW) | BIT(CLI_REPLAY),
                     "a picture to compare with, as V would keep it: .exr is linear, 8 bits are seen at the scene's exposure"},
    [CLI_OPT_PIXEL] = {"pixel", 0, "X,Y[,SAMPLE]", CLI_KIND_PIXEL, AT(pixel), 0, 4294967295.0, NULL, BIT(CLI_INFO),
                       "print the tree of rays of one sample (default 0) of the pixel, 0,0 at the top left"},
    [CLI_OPT_PLATFORM] = {"platform", 0, NULL, CLI_KIND_CHOICE_TEXT, AT(platform), 0, 0, platform_names,
                          BIT(CLI_VIEW) | BIT(CLI_REPLAY), "window or offscreen context"},
    [CLI_OPT_SHADER_DIR] = {"shader-dir", 0, "DIR", CLI_KIND_TEXT, AT(shader_dir), 0, 0, NULL,
                            BIT(CLI_VIEW) | BIT(CLI_REPLAY), "read shaders from here instead of the built-in ones"},
    [CLI_OPT_JSON] = {"json", 0, NULL, CLI_KIND_FLAG, 0, 0, 0, NULL,
                      BIT(CLI_RENDER) | BIT(CLI_INFO) | BIT(CLI_CHECK) | BIT(CLI_STUDY) | BIT(CLI_REPLAY) |
                          BIT(CLI_BENCH),
                      "one line of JSON at the end"},
    [CLI_OPT_QUIET] = {"quiet", 'q', NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, PICTURE, "no progress, no summary"},
    [CLI_OPT_HELP] = {"help", 'h', NULL, CLI_KIND_FLAG, 0, 0, 0, NULL, ~0u, "show this help"},
};

/* Read a number and require that nothing but blanks follows. */
static bool whole_number(const char *text, double *out)
{
    const char *end = text + strlen(text);
    const char *rest = fl_number_parse(text, end, out);
    return rest == end && rest != text;
}

/* Finite numbers separated by blanks, commas or `separator`; true when exactly `count` and nothing else. */
static bool number_list(const char *text, char separator, uint32_t count, double *out)
{
    const char *end = text + strlen(text);
    for (uint32_t i = 0; i < count; i++) {
        while (*text == ' ' || *text == ',' || (i && *text == separator))
            text++;
        text = fl_number_parse(text, end, &out[i]);
        if (!text || !isfinite(out[i]))
            return false;
    }
    while (*text == ' ')
        text++;
    return text == end;
}

static bool list_of_counts(const cli_option *row, const char *text, char separator, uint32_t count, uint32_t *out)
{
    double value[4];
    if (!number_list(text, separator, count, value))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        if (!(value[i] >= row->lowest && value[i] <= row->highest) || value[i] != (double)(uint32_t)value[i])
            return false;
        out[i] = (uint32_t)value[i];
    }
    return true;
}

static bool choose(const cli_option *row, const char *text, uint32_t *out)
{
    for (uint32_t i = 0; row->choices[i]; i++)
        if (strcmp(row->choices[i], text) == 0) {
            *out = i;
            return true;
        }
    return false;
}

/* Store the value of one option; false when `text` is not a value of it. */
static bool store(const cli_option *row, const char *text, cli_options *out)
{
    void *field = (char *)out + row->offset;
    uint32_t choice;
    switch (row->kind) {
    case CLI_KIND_FLAG:
        return true;
    case CLI_KIND_COUNT:
        return list_of_counts(row, text, ' ', 1, field);
    case CLI_KIND_COUNT_OR_AUTO:
        if (strcmp(text, "auto") != 0)
            return list_of_counts(row, text, ' ', 1, field);
        *(uint32_t *)field = CLI_AUTO;
        return true;
    case CLI_KIND_NUMBER:
    case CLI_KIND_NUMBER_OR_INF: {
        double value;
        bool may_be_inf = row->kind == CLI_KIND_NUMBER_OR_INF;
        if (!whole_number(text, &value) || !(value >= row->lowest))
            return false;
        if (value > row->highest && !(may_be_inf && isinf(value)))
            return false;
        *(double *)field = value;
        return true;
    }
    case CLI_KIND_SIZE:
        return list_of_counts(row, text, 'x', 2, field);
    case CLI_KIND_CROP:
        return list_of_counts(row, text, ',', 4, field) && out->crop[2] && out->crop[3];
    case CLI_KIND_PIXEL:
        return list_of_counts(row, text, ',', 3, field) || list_of_counts(row, text, ',', 2, field);
    case CLI_KIND_CAMERA:
        return number_list(text, ' ', 10, field);
    case CLI_KIND_CHOICE:
        return choose(row, text, field);
    case CLI_KIND_CHOICE_TEXT:
        *(const char **)field = text;
        return choose(row, text, &choice);
    case CLI_KIND_TEXT:
        *(const char **)field = text;
        return *text != 0;
    case CLI_KIND_OUTPUT:
        out->outputs[out->output_count++] = text;
        return *text != 0;
    }
    return false;
}

/* What the values of an option are, for people. */
static void describe_values(const cli_option *row, char *out, size_t bytes)
{
    int used = 0;
    switch (row->kind) {
    case CLI_KIND_CHOICE:
    case CLI_KIND_CHOICE_TEXT:
        for (uint32_t i = 0; row->choices[i] && used >= 0 && (size_t)used < bytes; i++)
            used += snprintf(out + used, bytes - (size_t)used, "%s%s", i ? ", " : "", row->choices[i]);
        break;
    case CLI_KIND_COUNT:
    case CLI_KIND_COUNT_OR_AUTO:
        snprintf(out, bytes, "a whole number from %.10g to %.10g%s", row->lowest, row->highest,
                 row->kind == CLI_KIND_COUNT ? "" : ", or auto");
        break;
    case CLI_KIND_NUMBER:
    case CLI_KIND_NUMBER_OR_INF:
        snprintf(out, bytes, "a number from %g to %g%s", row->lowest, row->highest,
                 row->kind == CLI_KIND_NUMBER ? "" : ", or inf");
        break;
    case CLI_KIND_SIZE:
    case CLI_KIND_PIXEL:
        snprintf(out, bytes, "%s with whole numbers from %.10g to %.10g", row->argument, row->lowest, row->highest);
        break;
    case CLI_KIND_CROP:
        snprintf(out, bytes, "%s with whole numbers up to %.10g, W and H from 1", row->argument, row->highest);
        break;
    case CLI_KIND_CAMERA:
        snprintf(out, bytes, "ten finite numbers: %s", row->argument);
        break;
    default:
        snprintf(out, bytes, "%s", row->argument ? row->argument : "no value");
    }
}

static void explain_value(const cli_option *row, const char *text, char *message, size_t bytes)
{
    char values[256];
    describe_values(row, values, sizeof values);
    snprintf(message, bytes, "'%s' is not a value of --%s; expected %s", text, row->name, values);
}

/* Options of the command that begin with `bare`, as one list; returns how many. */
static size_t list_candidates(cli_command_id command, const char *bare, char *out, size_t bytes)
{
    size_t count = 0, length = strcspn(bare, "="), used = 0;
    for (int i = 0; i < CLI_OPT_COUNT; i++) {
        const cli_option *row = &cli_option_table[i];
        if (!(row->commands & BIT(command)) || strncmp(row->name, bare, length) != 0 || used >= bytes)
            continue;
        int printed = snprintf(out + used, bytes - used, "%s--%s", count++ ? ", " : "", row->name);
        used += printed > 0 ? (size_t)printed : 0;
    }
    return count;
}

/* A letter, alone or among others behind one '-'. */
static void explain_letter(cli_command_id command, int letter, char *message, size_t bytes)
{
    for (int i = 0; i < CLI_OPT_COUNT; i++)
        if (cli_option_table[i].letter == (char)letter) {
            snprintf(message, bytes, "'%s' takes no option -%c", cli_command_table[command].name, letter);
            return;
        }
    snprintf(message, bytes, "unknown option '-%c'", letter);
}

/* An unknown word that begins with '--': say so and name the nearest. */
static void explain_unknown(cli_command_id command, const char *word, char *message, size_t bytes)
{
    const char *names[CLI_OPT_COUNT];
    size_t count = 0;
    const char *bare = word + strspn(word, "-");
    for (int i = 0; i < CLI_OPT_COUNT; i++) {
        const cli_option *row = &cli_option_table[i];
        bool is_named = strlen(row->name) == strcspn(bare, "=") && strncmp(row->name, bare, strlen(row->name)) == 0;
        if (is_named) {
            snprintf(message, bytes, row->commands & BIT(command) ? "'%s': --%s takes no value" : "'%s' takes no option --%s",
                     row->commands & BIT(command) ? word : cli_command_table[command].name, row->name);
            return;
        }
        if (row->commands & BIT(command))
            names[count++] = row->name;
    }
    char candidates[256];
    const char *nearest = fl_nearest_name(bare, strcspn(bare, "="), names, count);
    if (list_candidates(command, bare, candidates, sizeof candidates) > 1)
        snprintf(message, bytes, "'%s' may be any of %s", word, candidates);
    else if (nearest)
        snprintf(message, bytes, "unknown option '%s'; did you mean '--%s'?", word, nearest);
    else
        snprintf(message, bytes, "unknown option '%s'", word);
}

/* What getopt_long gave up at: `got` is its '?' or ':'. */
static void explain_failure(cli_command_id command, int got, const char *word, char *message, size_t bytes)
{
    bool is_letter = optopt > 0 && optopt < 256;
    if (got == ':' && is_letter)
        snprintf(message, bytes, "option '-%c' needs a value", optopt);
    else if (got == ':')
        snprintf(message, bytes, "option '%s' needs a value", word);
    else if (is_letter)
        explain_letter(command, optopt, message, bytes);
    else
        explain_unknown(command, word, message, bytes);
}

/* ---- Options that mean nothing without another one, or beside it ---- */

enum { ANY_VALUE = -1 };

_Static_assert(CLI_OPT_COUNT < 64, "cli_options.given has a bit for each, and one that is never set");

static const struct {
    cli_option_id option;
    bool needs; /* False: `other` is excluded. */
    cli_option_id other;
    int value; /* Of `other`, a choice: only this one counts. */
    cli_option_id unless; /* This one is given. */
} rules[] = {
    {CLI_OPT_AOV, true, CLI_OPT_OUTPUT, ANY_VALUE, CLI_OPT_COUNT},
    {CLI_OPT_ALL, true, CLI_OPT_EXTREMES, ANY_VALUE, CLI_OPT_COUNT},
    {CLI_OPT_OCTREE_HEIGHT, true, CLI_OPT_ACCEL, FL_ACCEL_OCTREE, CLI_OPT_SOURCE},
    {CLI_OPT_CHECKPOINT, false, CLI_OPT_ADAPTIVE, 1, CLI_OPT_COUNT},
    {CLI_OPT_UPDATE, false, CLI_OPT_REPORT, ANY_VALUE, CLI_OPT_COUNT},
    {CLI_OPT_EXTREMES, false, CLI_OPT_OUT, ANY_VALUE, CLI_OPT_COUNT},
    {CLI_OPT_EXTREMES, false, CLI_OPT_SWEEP, ANY_VALUE, CLI_OPT_COUNT},
    {CLI_OPT_GROWTH, false, CLI_OPT_SOURCE, ANY_VALUE, CLI_OPT_COUNT},
    {CLI_OPT_GROWTH, false, CLI_OPT_FIRST_PICTURE, ANY_VALUE, CLI_OPT_COUNT},
    {CLI_OPT_SOURCE, false, CLI_OPT_FIRST_PICTURE, ANY_VALUE, CLI_OPT_COUNT},
};

static bool is_given(const cli_options *options, cli_option_id id, int value)
{
    if (!cli_has(options, id))
        return false;
    return value == ANY_VALUE ||
           *(const uint32_t *)(const void *)((const char *)options + cli_option_table[id].offset) == (uint32_t)value;
}

static bool follow_rules(const cli_options *options, char *message, size_t bytes)
{
    for (size_t i = 0; i < FL_COUNT_OF(rules); i++) {
        const cli_option *row = &cli_option_table[rules[i].option], *other = &cli_option_table[rules[i].other];
        if (!cli_has(options, rules[i].option) || cli_has(options, rules[i].unless) ||
            is_given(options, rules[i].other, rules[i].value) == rules[i].needs)
            continue;
        bool has_value = rules[i].value != ANY_VALUE;
        snprintf(message, bytes, rules[i].needs ? "--%s means nothing without --%s%s%s" : "--%s does not go with --%s%s%s",
                 row->name, other->name, has_value ? " " : "", has_value ? other->choices[rules[i].value] : "");
        return false;
    }
    return true;
}

bool cli_options_parse(cli_command_id command, int argc, char **argv, cli_options *out, char *message,
                       size_t message_bytes)
{
    *out = (cli_options){0};
    struct option long_options[CLI_OPT_COUNT + 1] = {{0}};
    char short_options[2 * CLI_OPT_COUNT + 2] = ":";
    size_t shorts = 1, longs = 0;
    for (int i = 0; i < CLI_OPT_COUNT; i++) {
        const cli_option *row = &cli_option_table[i];
        if (!(row->commands & BIT(command)))
            continue;
        bool takes_value = row->kind != CLI_KIND_FLAG;
        long_options[longs++] =
            (struct option){row->name, takes_value ? required_argument : no_argument, NULL, 256 + i};
        if (row->letter) {
            short_options[shorts++] = row->letter;
            if (takes_value)
                short_options[shorts++] = ':';
        }
    }
    optind = 0; /* not 1: forget a cluster of letters that an earlier call gave up in */
    opterr = 0;
    for (int got; (got = getopt_long(argc, argv, short_options, long_options, NULL)) != -1;) {
        int id = got - 256;
        for (int i = 0; got < 256 && i < CLI_OPT_COUNT; i++)
            if (cli_option_table[i].letter == (char)got && (cli_option_table[i].commands & BIT(command)))
                id = i;
        if (got == ':' || got == '?' || id < 0) {
            explain_failure(command, got, argv[optind - 1], message, message_bytes);
            return false;
        }
        if (id == CLI_OPT_OUTPUT && out->output_count == CLI_OUTPUTS_MAX) {
            snprintf(message, message_bytes, "at most %d pictures are written at once", CLI_OUTPUTS_MAX);
            return false;
        }
        if (!store(&cli_option_table[id], optarg, out)) {
            explain_value(&cli_option_table[id], optarg ? optarg : "", message, message_bytes);
            return false;
        }
        out->given |= (uint64_t)1 << id;
    }
    out->paths = (const char **)argv + optind;
    out->path_count = (uint32_t)(argc - optind);
    return cli_has(out, CLI_OPT_HELP) || follow_rules(out, message, message_bytes);
}
