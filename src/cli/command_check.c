/* SPDX-License-Identifier: MIT */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/commands.h"
#include "cli/outputs.h"
#include "cli/report.h"
#include "io/files.h"
#include "io/image_file.h"
#include "io/path.h"

enum { PATH_BYTES = 4096 };

typedef struct checker {
    const cli_options *options;
    cli_report *report; /* NULL: none asked for */
    uint32_t passed_count, failed_count, error_count; /* each scene is in one of them, but for an interrupted one */
    int code; /* worst exit code of a scene that could not be rendered */
} checker;

/* "dir/name.txt" to "dir/name" + suffix. */
static void beside(const char *scene, const char *suffix, char out[PATH_BYTES])
{
    snprintf(out, PATH_BYTES, "%.*s%s", (int)(fl_path_ending(scene) - scene), scene, suffix);
}

static bool write_golden(const char *path, const cli_scene *scene, const cli_picture *picture, fl_diags *diags)
{
    char name[PATH_BYTES], line[FL_SHA256_HEX + 2];
    beside(path, ".png", name);
    if (cli_outputs_over_input(&(cli_outputs){.paths = {name}, .count = 1}, scene))
        return fl_error(diags, (fl_loc){.file = path}, "the golden picture '%s' would replace one that the scene reads",
                        name);
    if (!cli_picture_save(picture, scene, name, diags))
        return false;
    beside(path, ".sha256", name);
    int bytes = snprintf(line, sizeof line, "%s\n", picture->film_sha256);
    return fl_file_save(name, line, (size_t)bytes, diags);
}

/* The stored hash, or "" where there is none. */
static void read_golden_hash(const char *path, char out[FL_SHA256_HEX + 1])
{
    char name[PATH_BYTES];
    beside(path, ".sha256", name);
    fl_diags quiet = {0};
    size_t bytes;
    char *text = fl_file_load(name, "golden hash", 4096, (fl_loc){.file = name}, &quiet, &bytes);
    snprintf(out, FL_SHA256_HEX + 1, "%.*s", FL_SHA256_HEX, text ? text : "");
    free(text);
    fl_diags_deinit(&quiet);
}

/* Fill the numbers of `result` by comparing with the golden picture; returns it or NULL. */
static fl_image *compare_picture(const char *path, const cli_picture *picture, const uint8_t *fresh,
                                 cli_check_result *result)
{
    char name[PATH_BYTES];
    beside(path, ".png", name);
    fl_diags quiet = {0};
    fl_image *golden = fl_image_load(name, (fl_loc){.file = name}, &quiet);
    fl_diags_deinit(&quiet);
    if (!golden || golden->format == FL_PIXEL_FLOAT || golden->width != picture->width ||
        golden->height != picture->height) {
        fl_image_release(golden);
        return NULL;
    }
    const uint8_t *old = golden->pixels;
    size_t pixels = (size_t)picture->width * picture->height, differing = 0;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t largest = 0;
        for (size_t c = 3 * i; c < 3 * i + 3; c++)
            largest = fl_max_u32(largest, (uint32_t)abs(old[c] - fresh[c]));
        differing += largest > 0;
        result->largest_difference = fl_max_u32(result->largest_difference, largest);
    }
    result->differing_share = (double)differing / (double)pixels;
    return golden;
}

static void compare(checker *check, const char *path, cli_scene *scene, const cli_picture *picture)
{
    cli_check_result result = {.path = path, .passed = true, .why = "same bytes"};
    read_golden_hash(path, result.sha256_golden);
    snprintf(result.sha256_new, sizeof result.sha256_new, "%s", picture->film_sha256);
    if (picture->progress.counts.invalid_samples) {
        result.passed = false;
        result.why = "invalid samples";
    } else if (!result.sha256_golden[0]) {
        result.passed = false;
        result.why = "no golden hash (firstlight check --update writes one)";
    } else if (strcmp(result.sha256_golden, result.sha256_new) != 0) {
        result.passed = false;
        result.why = "film differs from the golden one";
    }
    uint8_t *fresh = cli_picture_bytes(picture, &scene->params, scene->diags);
    if (fresh && (!result.passed || check->report)) {
        fl_image *golden = compare_picture(path, picture, fresh, &result);
        result.has_golden = golden != NULL;
        if (check->report)
            cli_report_add(check->report, &result, picture->width, picture->height, golden ? golden->pixels : NULL,
                           fresh, scene->diags);
        fl_image_release(golden);
    }
    free(fresh);
    check->passed_count += result.passed;
    check->failed_count += !result.passed;
    if (!result.passed && result.has_golden)
        printf("FAIL %s: %s (largest difference %u/255, %.3f %% of pixels)\n", path, result.why,
               result.largest_difference, 100.0 * result.differing_share);
    else if (!result.passed)
        printf("FAIL %s: %s\n", path, result.why);
    else if (!cli_has(check->options, CLI_OPT_QUIET))
        printf("ok   %s\n", path);
}

/* Render at the golden size and compare, or write the golden picture. */
static void check_picture(checker *check, const char *path, cli_scene *scene)
{
    fl_render_limits limits = {.samples = cli_golden_samples(&scene->scene->render)};
    cli_picture_plan plan = {.threads = check->options->threads};
    cli_picture picture = {0};
    scene->params.width = scene->params.height = CLI_GOLDEN_SIDE;
    cli_drop_crop(&scene->params);
    if (cli_picture_render(scene, &limits, &plan, &picture) && !picture.was_interrupted) {
        if (!cli_has(check->options, CLI_OPT_UPDATE)) {
            compare(check, path, scene, &picture);
        } else if (write_golden(path, scene, &picture, scene->diags)) {
            check->passed_count++;
            if (!cli_has(check->options, CLI_OPT_QUIET))
                printf("wrote golden of %s\n", path);
        }
    }
    cli_picture_close(&picture);
}

static void check_scene(checker *check, const char *path)
{
    fl_diags diags = {0};
    cli_scene scene = {.diags = &diags};
    if (cli_scene_open(check->options, path, &scene))
        check_picture(check, path, &scene);
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    check->error_count += code != CLI_DONE;
    check->code = code > check->code ? code : check->code;
    cli_scene_close(&scene);
    fl_diags_deinit(&diags);
}

static int is_scene_name(const struct dirent *entry)
{
    const char *dot = strrchr(entry->d_name, '.');
    return dot && strcmp(dot, ".txt") == 0;
}

/* Every .txt of a folder, by name. False after adding an error: there is none. */
static bool check_folder(checker *check, const char *path, fl_diags *diags)
{
    struct dirent **entries;
    int count = scandir(path, &entries, is_scene_name, alphasort);
    if (count < 0)
        return fl_environment_error(diags, "cannot read folder '%s': %s", path, strerror(errno));
    if (count == 0)
        fl_error(diags, (fl_loc){0}, "there are no scenes (*.txt) in folder '%s'", path);
    for (int i = 0; i < count; i++) {
        char name[PATH_BYTES];
        snprintf(name, sizeof name, "%s/%s", path, entries[i]->d_name);
        if (!cli_was_interrupted())
            check_scene(check, name);
        free(entries[i]);
    }
    free(entries);
    return count > 0;
}

static void print_totals(const checker *check)
{
    if (cli_has(check->options, CLI_OPT_JSON)) {
        printf("{\"passed\":%u,\"failed\":%u,\"errors\":%u}\n", check->passed_count, check->failed_count,
               check->error_count);
    } else if (!cli_has(check->options, CLI_OPT_QUIET)) {
        printf("%u passed, %u failed", check->passed_count, check->failed_count);
        if (check->error_count)
            printf(", %u could not be checked", check->error_count);
        putchar('\n');
    }
}

int cli_command_check(const cli_options *options)
{
    if (!options->path_count)
        return cli_usage_error(CLI_CHECK, "expected scenes or folders of scenes");
    for (uint32_t i = 0; cli_has(options, CLI_OPT_UPDATE) && i < options->path_count; i++)
        if (fl_saved_state_is_for(options->paths[i]))
            return cli_usage_error(CLI_CHECK, "--update would replace the picture '%s': name its scene",
                                   options->paths[i]);
    fl_diags diags = {0};
    checker check = {.options = options};
    bool can_begin = !options->report || (check.report = cli_report_open(options->report, &diags)) != NULL;
    cli_catch_signals();
    for (uint32_t i = 0; can_begin && i < options->path_count && !cli_was_interrupted(); i++) {
        struct stat info;
        if (stat(options->paths[i], &info) == 0 && S_ISDIR(info.st_mode))
            check_folder(&check, options->paths[i], &diags);
        else
            check_scene(&check, options->paths[i]);
    }
    cli_report_close(check.report, &diags);
    cli_print_diags(&diags);
    int code = cli_exit_code(&diags);
    check.code = code > check.code ? code : check.code;
    print_totals(&check);
    fl_diags_deinit(&diags);
    if (cli_was_interrupted())
        return CLI_INTERRUPTED;
    if (check.code != CLI_DONE)
        return check.code;
    return check.failed_count ? CLI_CHECK_FAILED : CLI_DONE;
}
