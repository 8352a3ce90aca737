/* SPDX-License-Identifier: MIT */
#include "io/state_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "io/image_file.h"
#include "io/path.h"

/* Numbers of a camera as text, in the order in which they are written. */
enum { CAMERA_NUMBERS = 13, NUMBER_BYTES = 32 };

static void number(double value, char out[NUMBER_BYTES])
{
    if (isfinite(value))
        fl_number_format(value, out);
    else
        snprintf(out, NUMBER_BYTES, "inf");
}

static size_t length_of(int printed)
{
    return printed > 0 ? (size_t)printed : 0;
}

static void camera_numbers(const fl_camera *camera, fl_vec3 target,
                           char out[CAMERA_NUMBERS][NUMBER_BYTES])
{
    const double values[CAMERA_NUMBERS] = {
        camera->center.x, camera->center.y, camera->center.z,    target.x,     target.y,
        target.z,         camera->up.x,     camera->up.y,        camera->up.z, camera->fov_deg,
        camera->aperture, camera->focus,    camera->exposure_ev,
    };
    for (int i = 0; i < CAMERA_NUMBERS; i++)
        number(values[i], out[i]);
}

size_t fl_camera_scene_text(const fl_camera *camera, const char *view_name, char *out,
                            size_t out_bytes)
{
    bool is_flat = camera->projection == FL_ORTHOGRAPHIC;
    char n[CAMERA_NUMBERS][NUMBER_BYTES], size[NUMBER_BYTES], turn[NUMBER_BYTES], lens[160] = "";
    camera_numbers(camera, camera->direction, n);
    number(camera->ortho_size, size);
    number(camera->blade_rotation_deg, turn);
    if (view_name || !is_flat)
        snprintf(lens, sizeof lens,
                 "    aperture %s\n    focus %s\n    blades %u\n    bladeRotation %s\n", n[10],
                 n[11], camera->blades, turn);
    const char *block = view_name ? "View " : is_flat ? "OrthographicCamera" : "PerspectiveCamera";
    return length_of(snprintf(out, out_bytes,
                              "%s%s {\n    center %s %s %s\n    direction %s %s %s\n    up %s %s "
                              "%s\n    %s %s\n%s    exposure %s\n}\n",
                              block, view_name ? view_name : "", n[0], n[1], n[2], n[3], n[4], n[5],
                              n[6], n[7], n[8], is_flat ? "size" : "angle", is_flat ? size : n[9],
                              lens, n[12]));
}

size_t fl_camera_options_text(const fl_camera *camera, char *out, size_t out_bytes)
{
    char n[CAMERA_NUMBERS][NUMBER_BYTES];
    camera_numbers(camera, fl_v3_add(camera->center, camera->direction), n);
    return length_of(snprintf(
        out, out_bytes,
        "--camera '%s %s %s  %s %s %s  %s %s %s  %s' --aperture %s --focus %s --exposure %s", n[0],
        n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8], n[9], n[10], n[11], n[12]));
}

static const char *skip_blanks(const char *text, const char *end)
{
    while (text < end && (*text == ' ' || *text == '\'' || *text == '"' || *text == '=' ||
                          *text == '\t' || *text == ',' || *text == '\n' || *text == '\r'))
        text++;
    return text;
}

/* `count` numbers behind the word `name`; true: all are there. `inf` is a number. */
static bool numbers_after(const char *text, const char *end, const char *name, int count,
                          double *out)
{
    size_t name_bytes = strlen(name);
    const char *at = text;
    while (at && (size_t)(end - at) > name_bytes &&
           (memcmp(at, name, name_bytes) != 0 || (at[name_bytes] != ' ' && at[name_bytes] != '=')))
        at++;
    if ((size_t)(end - at) <= name_bytes)
        return false;
    at += name_bytes;
    for (int i = 0; i < count; i++) {
        at = skip_blanks(at, end);
        if (end - at >= 3 && memcmp(at, "inf", 3) == 0) {
            out[i] = (double)INFINITY;
            at += 3;
        } else {
            at = fl_number_parse(at, end, &out[i]);
        }
        if (!at)
            return false;
    }
    return true;
}

static bool read_options(const char *text, size_t text_bytes, fl_camera *camera)
{
    const char *end = text + text_bytes;
    double v[10], x;
    if (!numbers_after(text, end, "--camera", 10, v))
        return false;
    fl_camera read = *camera;
    read.projection = FL_PERSPECTIVE;
    read.center = fl_v3(v[0], v[1], v[2]);
    read.direction = fl_v3_sub(fl_v3(v[3], v[4], v[5]), read.center);
    read.up = fl_v3(v[6], v[7], v[8]);
    read.fov_deg = v[9];
    if (numbers_after(text, end, "--aperture", 1, &x))
        read.aperture = x;
    if (numbers_after(text, end, "--focus", 1, &x))
        read.focus = x;
    if (numbers_after(text, end, "--exposure", 1, &x))
        read.exposure_ev = x;
    *camera = read;
    return true;
}

/* Scene text that says something about a camera; a missing first line is forgiven. The flag is set
 * when there was no memory to find out. */
static bool read_block(const char *text, size_t text_bytes, fl_camera *camera,
                       bool *is_short_of_memory)
{
    static const char first[] = "firstlight 1\n";
    size_t prefix = sizeof first - 1;
    char *whole = malloc(prefix + text_bytes + 1);
    *is_short_of_memory = !whole;
    if (!whole)
        return false;
    bool has_first = text_bytes >= 10 && memcmp(text, "firstlight", 10) == 0;
    if (has_first)
        prefix = 0;
    memcpy(whole, first, prefix);
    memcpy(whole + prefix, text, text_bytes);
    fl_diags diags = {0};
    fl_scene *scene = fl_scene_parse(whole, prefix + text_bytes, "camera", &(fl_parse_options){0},
                                     NULL, &diags); /* a camera is no reason to open files */
    free(whole);
    for (uint32_t i = 0; i < diags.count; i++)
        *is_short_of_memory |= diags.items[i].cause == FL_CAUSE_ENVIRONMENT;
    *is_short_of_memory |= diags.count == 0 && diags.error_count > 0; /* not even for that */
    fl_diags_deinit(&diags);
    bool is_found = scene && (scene->has_camera || scene->view_count > 0);
    if (is_found) {
        uint32_t width = camera->width, height = camera->height;
        *camera = scene->has_camera ? scene->camera : scene->views[0].camera;
        camera->width = width;
        camera->height = height;
    }
    fl_scene_destroy(scene);
    return is_found;
}

static bool read_camera(const char *text, size_t text_bytes, fl_camera *camera,
                        bool *is_short_of_memory)
{
    fl_camera read = *camera;
    if (!read_block(text, text_bytes, &read, is_short_of_memory) &&
        !read_options(text, text_bytes, &read))
        return false;
    if (!fl_v3_is_finite(read.center) || !fl_v3_is_finite(read.direction) ||
        !fl_v3_is_finite(read.up))
        return false;
    *camera = read;
    return true;
}

bool fl_camera_read_text(const char *text, size_t text_bytes, fl_camera *camera)
{
    bool is_short_of_memory = false;
    return read_camera(text, text_bytes, camera, &is_short_of_memory);
}

/* ---- The state of a picture ---- */

/* Whole numbers of the settings, in the order of the text. */
typedef struct settings {
    double size[2], crop[4], depth, light_samples, light_default, weight, transparent, sampler,
        seed, solver, exact, dialect, adaptive, precision;
} settings;

static const struct {
    const char *name;
    int count;
} rows[] = {
    {"size", 2},
    {"crop", 4},
    {"depth", 1},
    {"lightSamples", 1},
    {"lightDefault", 1},
    {"threshold", 1},
    {"transparentShadows", 1},
    {"sampler", 1},
    {"seed", 1},
    {"solver", 1},
    {"exact", 1},
    {"dialect", 1},
    {"adaptive", 1}, /* From here on: may be missing, then 0. */
    {"precision", 1},
};

enum { ROWS_ALWAYS = 12 };

static settings settings_of(const fl_params *p, fl_dialect dialect)
{
    static const fl_exact_rules none;
    bool is_exact = memcmp(&p->exact, &none, sizeof none) != 0;
    return (settings){.size = {p->width, p->height},
                      .crop = {p->crop_x, p->crop_y, p->crop_w, p->crop_h},
                      .depth = p->depth_limit,
                      .light_samples = p->light_samples,
                      .light_default = p->light_samples_default,
                      .weight = p->weight_threshold,
                      .transparent = p->transparent_shadows,
                      .sampler = p->sampler,
                      .seed = p->seed,
                      .solver = p->solver,
                      .exact = is_exact,
                      .dialect = dialect,
                      .adaptive = p->is_adaptive,
                      .precision = p->precision};
}

static void settings_text(const settings *s, char *out, size_t out_bytes)
{
    const double *value = s->size;
    size_t length = 0;
    out[0] = 0;
    for (size_t i = 0; i < FL_COUNT_OF(rows) && length < out_bytes; i++) {
        length += length_of(
            snprintf(out + length, out_bytes - length, "%s%s", length ? " " : "", rows[i].name));
        for (int k = 0; k < rows[i].count && length < out_bytes; k++) {
            char text[NUMBER_BYTES];
            number(*value++, text);
            length += length_of(snprintf(out + length, out_bytes - length, " %s", text));
        }
    }
}

static bool settings_read(const char *text, settings *out)
{
    double *value = out->size;
    for (size_t i = 0; i < FL_COUNT_OF(rows); value += rows[i].count, i++)
        if (!numbers_after(text, text + strlen(text), rows[i].name, rows[i].count, value)) {
            if (i < ROWS_ALWAYS)
                return false;
            memset(value, 0, (size_t)rows[i].count * sizeof *value);
        }
    double *first = out->size;
    for (double *v = first; v < value; v++)
        if (v != &out->weight && !(*v >= 0.0 && *v <= 4294967295.0))
            return false;
    return true;
}

/* Empty: they are the scene's. */
static void lights_text(const fl_params *params, const fl_scene *scene, char out[FL_LIGHT_TEXT_MAX])
{
    char own[FL_LIGHT_TEXT_MAX];
    out[0] = 0;
    if (!scene || params->light_count != scene->light_count || params->lights == scene->lights)
        return;
    fl_lights_text(params->lights, params->light_count, out);
    fl_lights_text(scene->lights, scene->light_count, own);
    if (strcmp(out, own) == 0)
        out[0] = 0;
}

void fl_state_texts_fill(fl_state_texts *out, const char *scene_path, const fl_scene *scene,
                         const fl_params *params, const fl_progress *progress,
                         const float *mean_rgb)
{
    fl_camera_scene_text(&params->camera, "snapshot", out->view, sizeof out->view);
    fl_camera_options_text(&params->camera, out->options, sizeof out->options);
    settings s = settings_of(params, scene ? scene->dialect : FL_DIALECT_FIRSTLIGHT);
    lights_text(params, scene, out->lights);
    settings_text(&s, out->settings, sizeof out->settings);
    uint32_t samples = progress->is_adaptive ? (uint32_t)(progress->mean_samples + 0.5)
                                             : progress->complete_samples;
    snprintf(out->samples, sizeof out->samples, "%u", samples);
    const fl_error_estimate *error = &progress->error;
    if (error->is_known)
        snprintf(out->error, sizeof out->error, "%.6g (%.6g to %.6g)", error->rmse, error->low,
                 error->high);
    else
        snprintf(out->error, sizeof out->error, "n/a");
    fl_digest_sha256(mean_rgb, (size_t)progress->width * progress->height * 3 * sizeof *mean_rgb,
                     out->film_sha256);
    const fl_image_text items[FL_STATE_TEXTS] = {
        {"firstlight:scene", scene_path},
        {"firstlight:view", out->view},
        {"firstlight:settings", out->settings},
        {"firstlight:camera", out->options},
        {"firstlight:samples", out->samples},
        {"firstlight:rmse", out->error},
        {"firstlight:film_sha256", out->film_sha256},
        {"firstlight:lights", out->lights},
    };
    memcpy(out->items, items, sizeof items);
}

bool fl_saved_state_is_for(const char *path)
{
    static const char *const endings[] = {".png", ".exr", ".tif", ".tiff"};
    for (size_t i = 0; i < FL_COUNT_OF(endings); i++)
        if (strcasecmp(fl_path_ending(path), endings[i]) == 0)
            return true;
    return false;
}

/* The scene as written, else from the picture's folder, from malloc. NULL after adding an error. */
static char *find_scene(const char *image_path, const char *scene, fl_diags *diags)
{
    size_t folder = scene[0] == '/' ? 0 : (size_t)fl_path_folder_bytes(image_path);
    size_t bytes = strlen(scene) + 1;
    char *path = malloc(folder + bytes);
    if (!path) {
        fl_out_of_memory(diags, image_path);
        return NULL;
    }
    memcpy(path, image_path, folder);
    memcpy(path + folder, scene, bytes);
    if (access(scene, R_OK) == 0)
        memcpy(path, scene, bytes);
    else if (access(path, R_OK) != 0) {
        fl_error(diags, (fl_loc){.file = image_path}, "the scene of this picture is not here: '%s'",
                 scene);
        free(path);
        return NULL;
    }
    return path;
}

static bool read_state(const char *path, char *const texts[5], fl_saved_state *out, fl_diags *diags)
{
    fl_loc loc = {.file = path};
    settings s;
    double samples;
    if (!texts[0] || !texts[1] || !texts[2] || !texts[3])
        return fl_error(diags, loc,
                        "this picture does not say how it was made: no firstlight keys");
    const char *end = texts[3] + strlen(texts[3]);
    bool is_short_of_memory = false;
    bool has_camera =
        read_camera(texts[1], strlen(texts[1]), &out->params.camera, &is_short_of_memory);
    if (!has_camera && is_short_of_memory)
        return fl_out_of_memory(diags, path);
    if (!has_camera || !settings_read(texts[2], &s) || !fl_number_parse(texts[3], end, &samples) ||
        !(samples >= 0.0 && samples < 1e9) || s.dialect >= FL_DIALECT_COUNT ||
        s.precision > FL_PRECISION_DOUBLE || s.sampler > FL_SAMPLER_STRATIFIED)
        return fl_error(diags, loc, "the firstlight keys of this picture are damaged");
    fl_params *p = &out->params;
    p->width = (uint32_t)s.size[0];
    p->height = (uint32_t)s.size[1];
    p->crop_x = (uint32_t)s.crop[0];
    p->crop_y = (uint32_t)s.crop[1];
    p->crop_w = (uint32_t)s.crop[2];
    p->crop_h = (uint32_t)s.crop[3];
    p->depth_limit = (uint32_t)s.depth;
    p->light_samples = (uint32_t)s.light_samples;
    p->light_samples_default = (uint32_t)s.light_default;
    p->weight_threshold = s.weight;
    p->transparent_shadows = s.transparent != 0.0;
    p->sampler = (fl_sampler)s.sampler;
    p->seed = (uint32_t)s.seed;
    p->solver = (fl_revolve_solver)s.solver;
    p->is_adaptive = s.adaptive != 0.0;
    p->precision = (fl_precision)s.precision;
    out->is_exact = s.exact != 0.0;
    out->dialect = (fl_dialect)s.dialect;
    out->samples = (uint32_t)samples;
    out->scene_path = find_scene(path, texts[0], diags);
    return out->scene_path != NULL;
}

bool fl_saved_state_load(const char *path, fl_saved_state *out, fl_diags *diags)
{
    static const char *const keys[] = {"firstlight:scene", "firstlight:view", "firstlight:settings",
                                       "firstlight:samples", "firstlight:lights"};
    char *texts[FL_COUNT_OF(keys)] = {0};
    bool is_fine = true;
    *out = (fl_saved_state){0};
    for (size_t i = 0; i < FL_COUNT_OF(keys) && is_fine; i++)
        is_fine = fl_image_load_text(path, keys[i], (fl_loc){.file = path}, diags, &texts[i]);
    is_fine = is_fine && read_state(path, texts, out, diags);
    if (is_fine) {
        out->lights = texts[4];
        texts[4] = NULL;
    }
    for (size_t i = 0; i < FL_COUNT_OF(keys); i++)
        free(texts[i]);
    return is_fine;
}

void fl_saved_state_deinit(fl_saved_state *state)
{
    free(state->scene_path);
    free(state->lights);
    *state = (fl_saved_state){0};
}

static bool apply_lights(const char *text, fl_scene *scene, fl_params *params)
{
    uint32_t count = params->light_count;
    if (count == 0)
        return true;
    fl_light *lights = fl_arena_alloc(&scene->arena, count, sizeof *lights);
    if (!lights)
        return false;
    memcpy(lights, params->lights, count * sizeof *lights);
    if (fl_lights_read(text, lights, count))
        params->lights = lights;
    return true;
}

bool fl_saved_state_apply(const fl_saved_state *state, fl_scene *scene, fl_params *params)
{
    const fl_params *from = &state->params;
    params->camera = from->camera;
    params->width = from->width;
    params->height = from->height;
    params->crop_x = from->crop_x;
    params->crop_y = from->crop_y;
    params->crop_w = from->crop_w;
    params->crop_h = from->crop_h;
    params->depth_limit = from->depth_limit;
    params->light_samples = from->light_samples;
    params->light_samples_default = from->light_samples_default;
    params->weight_threshold = from->weight_threshold;
    params->transparent_shadows = from->transparent_shadows;
    params->sampler = from->sampler;
    params->seed = from->seed;
    params->solver = from->solver;
    params->is_adaptive = from->is_adaptive;
    params->precision = from->precision;
    return !state->lights || !state->lights[0] || apply_lights(state->lights, scene, params);
}
