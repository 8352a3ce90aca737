/* SPDX-License-Identifier: MIT */
#include "cli/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/places.h"
#include "io/files.h"
#include "io/image_file.h"

struct cli_report {
    char dir[4096];
    char *html;
    size_t bytes;
    uint32_t count; /* of scenes so far: two of the same name are in different files */
    FILE *text; /* memory stream behind html */
};

cli_report *cli_report_open(const char *dir, fl_diags *diags)
{
    if (!cli_folder_open(dir, diags))
        return NULL;
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

/* Text of a page: names may hold anything. */
static void put_text(FILE *file, const char *text)
{
    for (; *text; text++) {
        if (strchr("&<>\"'", *text))
            fprintf(file, "&#%d;", *text);
        else
            fputc(*text, file);
    }
}

/* Named after the number of the scene: its own name may stand in several folders, and hold what a link may not. */
static bool add_picture(cli_report *report, const char *kind, uint32_t width, uint32_t height, const uint8_t *rgb,
                        fl_diags *diags)
{
    char path[4096 + 64];
    snprintf(path, sizeof path, "%s/scene-%u.%s.png", report->dir, report->count, kind);
    fl_image image = {.width = width, .height = height, .format = FL_PIXEL_SRGB8, .pixels = (void *)(uintptr_t)rgb};
    fprintf(report->text, "<figure><img src='scene-%u.%s.png'><figcaption>%s</figcaption></figure>\n", report->count, kind,
            kind);
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
    report->count++;
    fprintf(report->text, "<h2 class=%s>", result->passed ? "pass" : "fail");
    put_text(report->text, result->path);
    fprintf(report->text, ": %s</h2>\n<p>golden <code>%s</code><br>new <code>%s</code>", result->why,
            result->sha256_golden[0] ? result->sha256_golden : "none", result->sha256_new);
    if (golden)
        fprintf(report->text, "<br>largest difference %u/255, %.4f %% of pixels differ", result->largest_difference,
                100.0 * result->differing_share);
    else
        fputs("<br>no golden picture of this size to compare with", report->text);
    fputs("</p>\n", report->text);
    bool ok = add_picture(report, "new", width, height, fresh, diags);
    if (golden) {
        uint8_t *change = difference(golden, fresh, (size_t)width * height * 3);
        ok = add_picture(report, "golden", width, height, golden, diags) && ok;
        if (change)
            ok = add_picture(report, "difference-x16", width, height, change, diags) && ok;
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
