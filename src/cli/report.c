/* SPDX-License-Identifier: MIT */
#include "cli/report.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "io/files.h"
#include "io/image_file.h"

struct cli_report {
    char dir[4096];
    char *html;
    size_t bytes;
    FILE *text; /* memory stream behind html */
};

cli_report *cli_report_open(const char *dir, fl_diags *diags)
{
    if (mkdir(dir, 0777) != 0 && errno != EEXIST) {
        fl_environment_error(diags, "cannot make folder '%s': %s", dir, strerror(errno));
        return NULL;
    }
    cli_report *report = calloc(1, sizeof *report);
    if (report)
        report->text = open_memstream(&report->html, &report->bytes);
    if (!report || !report->text) {
        free(report);
        fl_out_of_memory(diags, "the report");
        return NULL;
    }
    snprintf(report->dir, sizeof report->dir, "%s", dir);
    fputs("<!doctype html><html lang=en><meta charset=utf-8><title>firstlight check</title>\n"
          "<style>body{font:15px/1.5 sans-serif;margin:2em;background:#181a1f;color:#dde}"
          "figure{display:inline-block;margin:0 1em 1em 0}img{width:320px;image-rendering:pixelated;display:block}"
          ".pass{color:#7c7}.fail{color:#f77}code{color:#9bd}</style>\n<h1>firstlight check</h1>\n",
          report->text);
    return report;
}

static bool add_picture(cli_report *report, const char *name, const char *kind, uint32_t width, uint32_t height,
                        const uint8_t *rgb, fl_diags *diags)
{
    char path[4096 + 512];
    snprintf(path, sizeof path, "%s/%s.%s.png", report->dir, name, kind);
    fl_image image = {.width = width, .height = height, .format = FL_PIXEL_SRGB8, .pixels = (void *)(uintptr_t)rgb};
    fprintf(report->text, "<figure><img src='%s.%s.png'><figcaption>%s</figcaption></figure>\n", name, kind, kind);
    return fl_image_save(path, &image, NULL, 0, diags);
}

/* Absolute difference, brightened so that one step of 255 is visible. */
static uint8_t *difference(const uint8_t *a, const uint8_t *b, size_t count)
{
    uint8_t *out = malloc(count);
    for (size_t i = 0; out && i < count; i++) {
        int d = abs(a[i] - b[i]) * 16;
        out[i] = (uint8_t)(d > 255 ? 255 : d);
    }
    return out;
}

bool cli_report_add(cli_report *report, const cli_check_result *result, uint32_t width, uint32_t height,
                    const uint8_t *golden, const uint8_t *fresh, fl_diags *diags)
{
    fprintf(report->text, "<h2 class=%s>%s: %s</h2>\n<p>golden <code>%s</code><br>new <code>%s</code><br>", result->passed ? "pass" : "fail",
            result->name, result->why, result->sha256_golden, result->sha256_new);
    fprintf(report->text, "largest difference %u/255, %.4f %% of pixels differ</p>\n", result->largest_difference,
            100.0 * result->differing_share);
    bool ok = add_picture(report, result->name, "new", width, height, fresh, diags);
    if (golden) {
        uint8_t *change = difference(golden, fresh, (size_t)width * height * 3);
        ok = add_picture(report, result->name, "golden", width, height, golden, diags) && ok;
        if (change)
            ok = add_picture(report, result->name, "difference-x16", width, height, change, diags) && ok;
        free(change);
    }
    return ok;
}

bool cli_report_close(cli_report *report, fl_diags *diags)
{
    if (!report)
        return true;
    char path[4096 + 16];
    snprintf(path, sizeof path, "%s/index.html", report->dir);
    bool ok = fclose(report->text) == 0 && fl_file_save(path, report->html, report->bytes, diags);
    free(report->html);
    free(report);
    return ok;
}
