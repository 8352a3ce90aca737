/* SPDX-License-Identifier: MIT
 *
 * The same bytes everywhere: renders the scenes of scenes.c and compares hashes of the film, the
 * displayed picture and the layers (depth, normal, albedo, object, shape) with a committed list.
 * Needs the core alone, so that it also runs on machines where nothing else is installed.
 *
 * usage: bytes [--isa NAME] [--threads N] [--accel bvh|octree|none] [--scene NAME] [HASHES]
 *        bytes --all HASHES    every instruction set, structure and number of threads here
 *        bytes                 print the list
 *        bytes --texts FOLDER  write the scenes' texts there: seeds for the fuzzer
 *        bytes [--isa NAME] [--threads N] [--accel ...] --gallery FLAT FILMS
 *                              render the scenes FLAT/NAME.flat (flat.h) to FILMS/NAME.film, whose
 *                              SHA-256 is that of the golden picture: floats, little endian
 * Exit: 0 all equal, 1 some differ or have invalid samples, 2 usage or a scene that does not
 * render, 77 no such instruction set here.
 */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bytes/flat.h"
#include "bytes/scenes.h"
#include "bytes/world.h"

enum { SCENES_MAX = 64, NAME_BYTES = 256, PATH_BYTES = 4096 };

typedef struct config {
    fl_isa isa;
    fl_accel accel;
    uint32_t threads;
} config;

typedef struct digest {
    uint64_t film, shown, layers;
} digest;

/* What a render gave. */
typedef struct outcome {
    digest hashes;
    float *film; /* owned by the caller */
    size_t film_bytes;
    uint64_t invalid_samples;
} outcome;

static const char *const accel_names[] = {"bvh", "octree", "none"};

/* FNV-1a of little-endian bytes. */
static uint64_t hash_bytes(const void *data, size_t bytes)
{
    const uint8_t *at = data;
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; i < bytes; i++)
        h = (h ^ at[i]) * 0x100000001b3u;
    return h;
}

static void print_diags(const char *scene, const fl_diags *diags)
{
    for (uint32_t i = 0; i < diags->count; i++) {
        char text[1024];
        fl_diag_format(&diags->items[i], text, sizeof text);
        fprintf(stderr, "bytes: %s: %s\n", scene, text);
    }
}

static void set_params(const test_scene *test, const fl_scene *scene, fl_params *params)
{
    fl_params_from_scene(params, scene, test->is_exact);
    params->width = test->width;
    params->height = test->height;
    params->sampler = test->sampler;
    params->solver = test->solver;
    params->precision = test->is_double ? FL_PRECISION_DOUBLE : FL_PRECISION_FLOAT;
    params->light_samples = test->lens_points;
    params->crop_x = test->crop[0];
    params->crop_y = test->crop[1];
    params->crop_w = test->crop[2];
    params->crop_h = test->crop[3];
}

static bool take_render(fl_render *render, const fl_params *params, outcome *out)
{
    size_t pixels = (size_t)params->width * params->height;
    uint8_t *shown = malloc(pixels * 4);
    fl_progress progress;
    uint64_t revision = 0;
    fl_tonemap tonemap = {.exposure_ev = params->camera.exposure_ev,
                          .truncates = params->exact.truncate_bytes};
    out->film = malloc(pixels * 3 * sizeof *out->film);
    bool ok = out->film && shown && fl_render_mean(render, out->film, pixels * 3, &progress) &&
              fl_render_display(render, &revision, &tonemap, shown, pixels * 4, &progress);
    if (ok) {
        pixels = (size_t)progress.width * progress.height;
        out->film_bytes = pixels * 3 * sizeof *out->film;
        out->invalid_samples = progress.counts.invalid_samples;
        out->hashes.film = hash_bytes(out->film, out->film_bytes);
        out->hashes.shown = hash_bytes(shown, pixels * 4);
    }
    free(shown);
    return ok;
}

/* Depth, normal, albedo, object and shape of every second pixel, one hash after the other. */
static bool hash_layers(fl_compiled *compiled, const fl_params *params, fl_diags *diags,
                        digest *out)
{
    fl_frame *frame = fl_frame_create(compiled, params, diags);
    if (!frame)
        return false;
    fl_aov_grid grid = {
        .step = 2, .width = (frame->width + 1) / 2, .height = (frame->height + 1) / 2};
    size_t floats = (size_t)grid.width * grid.height * 3;
    float *values = malloc(floats * sizeof *values);
    bool ok = values != NULL;
    out->layers = 0;
    for (int kind = 0; kind < FL_AOV_COST && ok; kind++) {
        ok = fl_aov_eval(frame, (fl_aov)kind, NULL, &grid, values);
        out->layers = out->layers * 3 + (ok ? hash_bytes(values, floats * sizeof *values) : 0);
    }
    free(values);
    fl_frame_release(frame);
    return ok;
}

static bool run_compiled(const test_scene *test, const config *how, const fl_scene *scene,
                         fl_compiled *compiled, fl_diags *diags, outcome *out)
{
    fl_params params;
    set_params(test, scene, &params);
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = how->threads}, diags);
    if (!render)
        return false;
    fl_render_set_limits(render, &(fl_render_limits){.samples = test->samples});
    bool ok = fl_params_check(&params, diags) &&
              fl_render_restart(render, compiled, &params, diags) && fl_render_wait(render, -1.0) &&
              take_render(render, &params, out) &&
              hash_layers(compiled, &params, diags, &out->hashes);
    fl_render_destroy(render);
    return ok;
}

/* False after saying why; there is no film to free then. */
static bool run_scene(const test_scene *test, const fl_files *files, const config *how,
                      outcome *out)
{
    *out = (outcome){0};
    fl_diags diags = {0};
    fl_compiled *compiled = NULL;
    fl_scene *scene = fl_scene_parse(test->text, strlen(test->text), test->name,
                                     &(fl_parse_options){0}, files, &diags);
    fl_pool *pool = scene ? fl_pool_create(how->threads, &diags) : NULL;
    if (pool)
        compiled = fl_compile(
            scene, &(fl_compile_options){.accel = how->accel, .has_isa = true, .isa = how->isa},
            pool, &diags);
    fl_pool_destroy(pool);
    bool ok = compiled && run_compiled(test, how, scene, compiled, &diags, out);
    if (!ok) {
        print_diags(test->name, &diags);
        free(out->film);
    } else if (out->invalid_samples) {
        printf("%s: %llu invalid samples\n", test->name, (unsigned long long)out->invalid_samples);
    }
    fl_compiled_release(compiled);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    return ok;
}

/* The list's hashes by scene; a scene that it does not name keeps zeros, which no hash equals. */
static bool read_list(const char *path, digest out[SCENES_MAX])
{
    FILE *file = fopen(path, "r");
    if (!file) {
        fprintf(stderr, "bytes: cannot read %s\n", path);
        return false;
    }
    char name[64];
    unsigned long long film, shown, layers;
    while (fscanf(file, "%63s %llx %llx %llx", name, &film, &shown, &layers) == 4)
        for (uint32_t i = 0; i < test_scene_count; i++)
            if (strcmp(name, test_scenes[i].name) == 0)
                out[i] = (digest){film, shown, layers};
    fclose(file);
    return true;
}

/* Run all scenes in one configuration; without a list print one. Adds to the counts. */
static bool run_config(const config *how, const char *only, const digest *list, uint32_t *equal,
                       uint32_t *all)
{
    for (uint32_t i = 0; i < test_scene_count; i++) {
        const test_scene *test = &test_scenes[i];
        outcome out;
        if (only && strcmp(only, test->name) != 0)
            continue;
        if (!run_scene(test, &test_world, how, &out))
            return false;
        free(out.film);
        digest got = out.hashes;
        *all += out.invalid_samples > 0; /* and none equal */
        if (!list) {
            printf("%-12s %016llx %016llx %016llx\n", test->name, (unsigned long long)got.film,
                   (unsigned long long)got.shown, (unsigned long long)got.layers);
            continue;
        }
        bool film = got.film == list[i].film, shown = got.shown == list[i].shown;
        bool layers = got.layers == list[i].layers;
        *all += 3;
        *equal += (uint32_t)film + (uint32_t)shown + (uint32_t)layers;
        if (!film || !shown || !layers)
            printf("%s differs in the%s%s%s: isa %s, %s, %u threads\n", test->name,
                   film ? "" : " film", shown ? "" : " display", layers ? "" : " layers",
                   fl_isa_name(how->isa), accel_names[how->accel], how->threads);
    }
    return true;
}

static bool run_all(const digest *list, uint32_t *equal, uint32_t *all)
{
    static const uint32_t threads[] = {1, 2, 3, 7, 16};
    for (int isa = 0; isa < FL_ISA_COUNT; isa++) {
        if (!fl_cpu_has((fl_isa)isa))
            continue;
        for (size_t t = 0; t < FL_COUNT_OF(threads); t++)
            if (!run_config(&(config){(fl_isa)isa, FL_ACCEL_BVH, threads[t]}, NULL, list, equal,
                            all))
                return false;
        if (!run_config(&(config){(fl_isa)isa, FL_ACCEL_OCTREE, 2}, NULL, list, equal, all) ||
            !run_config(&(config){(fl_isa)isa, FL_ACCEL_NONE, 2}, NULL, list, equal, all))
            return false;
    }
    return true;
}

static bool save_film(const outcome *out, const char *folder, const char *name)
{
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%s/%s.film", folder, name);
    FILE *file = fopen(path, "wb");
    bool ok = file && fwrite(out->film, out->film_bytes, 1, file) == 1;
    if (!file || fclose(file) != 0 || !ok) {
        fprintf(stderr, "bytes: cannot write %s\n", path);
        return false;
    }
    return true;
}

/* Render a scene of the gallery; its exit code. */
static int run_flat(const config *how, const char *folder, const char *name, const char *films)
{
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%s/%s.flat", folder, name);
    flat_scene flat;
    if (!flat_read(&flat, path)) {
        fprintf(stderr, "bytes: cannot read %s\n", path);
        return 2;
    }
    test_scene test = {.name = name,
                       .text = flat.text,
                       .width = flat.width,
                       .height = flat.height,
                       .samples = flat.samples};
    fl_files files = flat_files(&flat);
    outcome out;
    int code = 2;
    if (run_scene(&test, &files, how, &out)) {
        if (save_film(&out, films, name))
            code = out.invalid_samples > 0;
        free(out.film);
    }
    flat_close(&flat);
    return code;
}

static int is_flat(const struct dirent *entry)
{
    const char *dot = strchr(entry->d_name, '.');
    return dot && strcmp(dot, ".flat") == 0;
}

static int run_gallery(const config *how, const char *only, const char *folder, const char *films)
{
    struct dirent **entries;
    int count = scandir(folder, &entries, is_flat, alphasort), worst = count > 0 ? 0 : 2;
    for (int i = 0; i < count; i++) {
        char name[NAME_BYTES];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(entries[i]->d_name, "."),
                 entries[i]->d_name);
        free(entries[i]);
        if (only && strcmp(only, name) != 0)
            continue;
        int code = run_flat(how, folder, name, films);
        worst = code > worst ? code : worst;
    }
    if (count >= 0)
        free(entries);
    return worst;
}

static int write_texts(const char *folder)
{
    for (uint32_t i = 0; i < test_scene_count; i++) {
        char path[PATH_BYTES];
        snprintf(path, sizeof path, "%s/%s.scene", folder, test_scenes[i].name);
        FILE *file = fopen(path, "w");
        bool ok = file && fputs(test_scenes[i].text, file) >= 0;
        if (!file || fclose(file) != 0 || !ok) {
            fprintf(stderr, "bytes: cannot write %s\n", path);
            return 2;
        }
    }
    return 0;
}

static int usage(void)
{
    fputs(
        "usage: bytes [--all] [--isa NAME] [--threads N] [--accel bvh|octree|none] [--scene NAME] "
        "[--gallery FLAT FILMS | HASHES]\n",
        stderr);
    return 2;
}

int main(int argc, char **argv)
{
    config how = {fl_cpu_best_isa(), FL_ACCEL_BVH, 2};
    const char *path = NULL, *only = NULL, *flat = NULL, *films = NULL;
    bool is_all = false;
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(word, "--all") == 0)
            is_all = true;
        else if (word[0] != '-')
            path = word;
        else if (strcmp(word, "--texts") == 0)
            return write_texts(value);
        else if (strcmp(word, "--gallery") == 0 && i + 2 < argc) {
            flat = argv[++i];
            films = argv[++i];
        } else if (strcmp(word, "--isa") == 0 && fl_isa_find(value, &how.isa))
            i++;
        else if (strcmp(word, "--threads") == 0 && (how.threads = (uint32_t)atoi(value)) > 0)
            i++;
        else if (strcmp(word, "--scene") == 0 && (only = value)[0])
            i++;
        else if (strcmp(word, "--accel") == 0 && strchr("bon", value[0]) && value[0])
            how.accel = (fl_accel)(strchr("bon", argv[++i][0]) - "bon");
        else
            return usage();
    }
    if (!fl_cpu_has(how.isa))
        return 77;
    if (flat)
        return run_gallery(&how, only, flat, films);
    digest list[SCENES_MAX] = {{0}};
    uint32_t equal = 0, all = 0;
    if ((is_all && !path) || (path && !read_list(path, list)))
        return usage();
    if (is_all ? !run_all(list, &equal, &all)
               : !run_config(&how, only, path ? list : NULL, &equal, &all))
        return 2;
    if (path)
        printf("%u hashes equal / %u\n", equal, all);
    return equal == all ? 0 : 1;
}
