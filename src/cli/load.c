/* SPDX-License-Identifier: MIT */
#include "cli/load.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cli/noise.h"
#include "io/files.h"

static volatile sig_atomic_t interrupted;

/* The place of what the options ask for and the scene cannot give. */
static const fl_loc on_command_line = {.file = "(command line)"};

static void on_signal(int number)
{
    interrupted = 1;
    signal(number, SIG_DFL);
}

void cli_catch_signals(void)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < FL_COUNT_OF(numbers); i++) {
        struct sigaction action = {.sa_handler = on_signal}, before;
        sigemptyset(&action.sa_mask);
        /* Under nohup it is to go on. SIGINT is caught even so: scripts ignore it for what they start in the background,
         * and who sends it there all the same means it. */
        if (numbers[i] == SIGHUP && sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler == SIG_IGN)
            continue;
        sigaction(numbers[i], &action, NULL);
    }
}

bool cli_was_interrupted(void)
{
    return interrupted != 0;
}

void cli_print_diags(const fl_diags *diags)
{
    for (uint32_t i = 0; i < diags->count; i++) {
        size_t bytes = fl_diag_format(&diags->items[i], NULL, 0) + 1;
        char *text = malloc(bytes);
        if (!text)
            continue;
        fl_diag_format(&diags->items[i], text, bytes);
        fprintf(stderr, "%s\n", text);
        free(text);
    }
    if (diags->dropped_count)
        fprintf(stderr, "firstlight: %u more not shown\n", diags->dropped_count);
}

int cli_exit_code(const fl_diags *diags)
{
    int code = diags->error_count ? CLI_WRONG_INPUT : CLI_DONE;
    for (uint32_t i = 0; i < diags->count; i++) {
        const fl_diag *d = &diags->items[i];
        if (d->severity != FL_ERROR)
            continue;
        if (d->cause == FL_CAUSE_ENVIRONMENT)
            return CLI_ENVIRONMENT;
        if (d->loc.file && strcmp(d->loc.file, on_command_line.file) == 0)
            code = CLI_WRONG_USAGE;
    }
    return code;
}

static bool is_same_place(const fl_loc *a, const fl_loc *b)
{
    return a->file && b->file && a->line == b->line && a->column == b->column && strcmp(a->file, b->file) == 0;
}

void cli_note_slips(const char *text, size_t bytes, const char *path, const fl_parse_options *parse, fl_diags *diags)
{
    if (parse->is_lenient)
        return;
    fl_diags forgiven = {0};
    fl_parse_options lenient = *parse;
    lenient.is_lenient = true;
    fl_scene_destroy(fl_scene_parse(text, bytes, path, &lenient, NULL, &forgiven));
    uint32_t slips = 0;
    for (uint32_t i = 0; i < diags->count; i++) {
        bool is_slip = false;
        for (uint32_t k = 0; k < forgiven.count && !is_slip; k++)
            is_slip = diags->items[i].severity == FL_ERROR && forgiven.items[k].severity == FL_WARNING &&
                      is_same_place(&diags->items[i].loc, &forgiven.items[k].loc);
        slips += is_slip;
    }
    fl_diags_deinit(&forgiven);
    if (slips)
        fl_note(diags, (fl_loc){.file = path}, "%u of these errors %s of course files: --lenient warns instead", slips,
                slips == 1 ? "is a known slip" : "are known slips");
}

bool cli_scene_parse(const cli_options *options, const char *path, cli_scene *out)
{
    fl_file_list_add(out->files, path);
    if (fl_saved_state_is_for(path)) {
        if (!fl_saved_state_load(path, &out->state, out->diags))
            return false;
        path = out->state.scene_path;
    }
    bool is_reopened = out->state.scene_path != NULL;
    if (is_reopened)
        fl_file_list_add(out->files, path);
    out->path = path;
    size_t bytes;
    char *text = fl_file_load(path, "scene", FL_SCENE_FILE_MAX_BYTES, (fl_loc){.file = path}, out->diags, &bytes);
    if (!text)
        return false;
    fl_parse_options parse = {.has_dialect = is_reopened || cli_has(options, CLI_OPT_DIALECT),
                              .dialect = is_reopened ? out->state.dialect : (fl_dialect)options->dialect,
                              .is_lenient = cli_has(options, CLI_OPT_LENIENT)};
    fl_files files = fl_files_listed(out->files);
    out->scene = fl_scene_parse(text, bytes, path, &parse, &files, out->diags);
    if (!out->scene)
        cli_note_slips(text, bytes, path, &parse, out->diags);
    free(text);
    return out->scene != NULL;
}

static void apply_camera(const double value[10], fl_camera *camera)
{
    fl_vec3 eye = fl_v3(value[0], value[1], value[2]);
    camera->projection = FL_PERSPECTIVE;
    camera->center = eye;
    camera->direction = fl_v3_sub(fl_v3(value[3], value[4], value[5]), eye);
    camera->up = fl_v3(value[6], value[7], value[8]);
    camera->fov_deg = value[9];
}

void cli_drop_crop(fl_params *params)
{
    params->crop_x = params->crop_y = params->crop_w = params->crop_h = 0;
}

/* The options' values over the scene's. */
static void apply_options(const cli_options *o, fl_params *params)
{
    if (cli_has(o, CLI_OPT_SIZE)) {
        params->width = o->size[0];
        params->height = o->size[1];
    }
    if (cli_has(o, CLI_OPT_SCALE)) { /* Beyond the largest side: params_check says so. */
        params->width = (uint32_t)fl_clamp(floor(params->width * o->scale + 0.5), 1.0, 1e9);
        params->height = (uint32_t)fl_clamp(floor(params->height * o->scale + 0.5), 1.0, 1e9);
    }
    if (cli_has(o, CLI_OPT_SIZE) || cli_has(o, CLI_OPT_SCALE))
        cli_drop_crop(params);
    if (cli_has(o, CLI_OPT_CROP)) {
        params->crop_x = o->crop[0];
        params->crop_y = o->crop[1];
        params->crop_w = o->crop[2];
        params->crop_h = o->crop[3];
    }
    if (cli_has(o, CLI_OPT_CAMERA))
        apply_camera(o->camera, &params->camera);
    if (cli_has(o, CLI_OPT_APERTURE))
        params->camera.aperture = o->aperture;
    if (cli_has(o, CLI_OPT_FOCUS))
        params->camera.focus = o->focus;
    if (cli_has(o, CLI_OPT_EXPOSURE))
        params->camera.exposure_ev = o->exposure_ev;
    if (cli_has(o, CLI_OPT_LIGHT_SAMPLES) && o->light_samples != CLI_AUTO)
        params->light_samples = o->light_samples;
    if (cli_has(o, CLI_OPT_DEPTH))
        params->depth_limit = o->depth;
    if (cli_has(o, CLI_OPT_WEIGHT_THRESHOLD))
        params->weight_threshold = o->weight_threshold;
    if (cli_has(o, CLI_OPT_SEED))
        params->seed = o->seed;
    if (cli_has(o, CLI_OPT_ADAPTIVE))
        params->is_adaptive = o->adaptive != 0;
    if (cli_has(o, CLI_OPT_SAMPLER))
        params->sampler = (fl_sampler)o->sampler;
    if (cli_has(o, CLI_OPT_REVOLVE_SOLVER))
        params->solver = o->solver ? FL_REVOLVE_NEWTON : FL_REVOLVE_ROBUST;
    if (params->solver != FL_REVOLVE_ROBUST && cli_has(o, CLI_OPT_REVOLVE_STARTS))
        params->solver = o->revolve_starts;
    if (cli_has(o, CLI_OPT_PRECISION))
        params->precision = (fl_precision)o->precision;
}

double cli_wall_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Once more, to say where: the scene's own values were wrong, or the options made them so. */
static bool explain_params(const fl_params *own, const cli_scene *scene, fl_diags *found)
{
    fl_diags of_scene = {0};
    fl_loc loc = fl_params_check(own, &of_scene) ? on_command_line : (fl_loc){.file = scene->path};
    for (uint32_t i = 0; i < found->count; i++)
        fl_error(scene->diags, found->items[i].loc.file ? found->items[i].loc : loc, "%s", found->items[i].message);
    fl_diags_deinit(&of_scene);
    return false;
}

/* Parameters: the scene's, then the picture's, then the options'. */
static bool set_params(const cli_options *options, cli_scene *out)
{
    fl_params own;
    fl_params_from_scene(&own, out->scene, out->state.is_exact || cli_has(options, CLI_OPT_DIALECT_EXACT));
    if (out->state.scene_path && !fl_saved_state_apply(&out->state, out->scene, &own))
        return fl_out_of_memory(out->diags, "the lights of the saved picture");
    own.strata = cli_sample_limit(&(cli_options){0}, out);
    out->params = own;
    apply_options(options, &out->params);
    out->params.strata = cli_sample_limit(options, out);
    if (out->params.solver == FL_REVOLVE_ROBUST && cli_has(options, CLI_OPT_REVOLVE_STARTS))
        return fl_error(out->diags, on_command_line,
                        "--revolve-starts means nothing without --revolve-solver newton");
    fl_diags found = {0};
    bool is_fine = fl_params_check(&out->params, &found) || explain_params(&own, out, &found);
    fl_diags_deinit(&found);
    return is_fine;
}

bool cli_scene_open(const cli_options *options, const char *path, cli_scene *out)
{
    double begin = cli_wall_seconds();
    if (!cli_scene_parse(options, path, out) || !set_params(options, out))
        return false;
    fl_pool *pool = fl_pool_create(options->threads, out->diags);
    if (!pool)
        return false;
    fl_isa isa = FL_ISA_SCALAR;
    bool names_isa = options->isa && fl_isa_find(options->isa, &isa);
    fl_compile_options compile = {.accel = (fl_accel)options->accel,
                                  .has_isa = names_isa,
                                  .isa = isa,
                                  .octree_height = options->octree_height,
                                  .quick_above = out->quick_above,
                                  .in_double = out->params.precision == FL_PRECISION_DOUBLE};
    out->compiled = fl_compile(out->scene, &compile, pool, out->diags);
    fl_pool_destroy(pool);
    if (!out->compiled)
        return false;
    bool is_auto = cli_has(options, CLI_OPT_LIGHT_SAMPLES) && options->light_samples == CLI_AUTO;
    if (is_auto && !cli_noise_choose_light_samples(out->compiled, &out->params, out->diags))
        return false;
    out->load_seconds = cli_wall_seconds() - begin;
    return true;
}

void cli_scene_close(cli_scene *scene)
{
    fl_compiled_release(scene->compiled);
    fl_scene_destroy(scene->scene);
    fl_saved_state_deinit(&scene->state);
    *scene = (cli_scene){.diags = scene->diags};
}

uint32_t cli_sample_limit(const cli_options *options, const cli_scene *scene)
{
    if (cli_has(options, CLI_OPT_SAMPLES))
        return options->samples;
    if (cli_has(options, CLI_OPT_TIME) || cli_has(options, CLI_OPT_NOISE))
        return 0;
    if (scene->state.samples)
        return scene->state.samples;
    return scene->scene->render.has_samples ? scene->scene->render.samples : FL_SAMPLES_DEFAULT;
}
