/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/tables.h"

const cli_command cli_command_table[CLI_COMMAND_COUNT] = {
    [CLI_VIEW] = {"view", "[SCENE]", "open a window and fly through the scene (the default command)",
                  "Without SCENE the vase of the gallery opens. H shows every key with its present value. Without a "
                  "display use 'firstlight render'."},
    [CLI_RENDER] = {"render", "SCENE -o IMAGE", "render without a window",
                    "The same scene, options and version give the same linear picture on every machine, for any "
                    "number of threads; --json prints its sha256. An interrupted render saves what it has."},
    [CLI_CHECK] = {"check", "PATH...", "render scenes and compare with the golden picture beside each",
                   "PATH is a scene or a folder of scenes. NAME.txt is compared with NAME.png and NAME.sha256, rendered at "
                   "160x160 with at most 16 samples. Exit 1 when any differs, 3 when there was nothing to check. --json counts passed, "
                   "failed and errors: scenes that could not be rendered."},
    [CLI_STUDY] = {"study", "SCENE --out DIR", "measure what every knob costs and what it buys",
                   "Renders the scene with one knob at a time moved and compares with a converged reference: error, "
                   "time, rays; writes study.csv, study.json, plots (with gnuplot) and index.html. --noise RMSE asks for "
                   "the cheapest setting with that error. Without --size the scene is shrunk to 128 pixels. "
                   "Knobs: sampler, light-samples, depth, weight-threshold, scale, accel, revolve-solver, adaptive, precision."},
    [CLI_BENCH] = {"bench", "[MESH|SCENE...]", "measure rays per second by kind, building, first pictures",
                   "MESH is a mesh file or sphere:N, a bumpy sphere of about N triangles: CPU time of one thread, every "
                   "number the median of --repeats interleaved runs. SCENE is rendered to 16 samples. Without words: the "
                   "bunnies, a sphere of a million triangles, and two scenes, as far as they are found. --size WxH sets the "
                   "number of camera rays (W x W, default 512)."},
    [CLI_INFO] = {"info", "SCENE", "what the scene contains and requires", "Reads and compiles, renders nothing."},
    [CLI_CONVERT] = {"convert", "IN OUT", "write a scene of any dialect in ours, formatted, comments kept",
                     "OUT may be - for standard output. In another folder, relative names of files are written anew so that they lead to the "
                     "same files."},
    [CLI_REPLAY] = {"replay", "LOG", "drive the viewer offscreen from a recorded log",
                    "The clock is the log's: snapshots are the same bytes on every machine. Latencies are real time."},
    [CLI_HELP] = {"help", "[COMMAND]", "show help; 'help scene' explains the scene format, 'help keys' the controls",
                  "'help man' prints the manual page."},
};

cli_command_id cli_command_find(const char *name)
{
    for (int i = 0; i < CLI_COMMAND_COUNT; i++)
        if (strcmp(cli_command_table[i].name, name) == 0)
            return (cli_command_id)i;
    return CLI_COMMAND_COUNT;
}

const char *cli_command_nearest(const char *name)
{
    const char *names[CLI_COMMAND_COUNT];
    for (int i = 0; i < CLI_COMMAND_COUNT; i++)
        names[i] = cli_command_table[i].name;
    return fl_nearest_name(name, strlen(name), names, CLI_COMMAND_COUNT);
}

/* "--name ARG" or "--name a|b|c". */
static void option_synopsis(const cli_option *row, char *out, size_t bytes)
{
    int used = snprintf(out, bytes, "--%s", row->name);
    if (row->argument)
        snprintf(out + used, bytes - (size_t)used, " %s", row->argument);
    for (uint32_t i = 0; row->choices && row->choices[i]; i++)
        used += snprintf(out + used, bytes - (size_t)used, "%c%s", i ? '|' : ' ', row->choices[i]);
}

static void print_options(cli_command_id command)
{
    puts("\noptions:");
    for (int i = 0; i < CLI_OPT_COUNT; i++) {
        const cli_option *row = &cli_option_table[i];
        if (!(row->commands >> command & 1u))
            continue;
        char synopsis[128];
        option_synopsis(row, synopsis, sizeof synopsis);
        printf("  %c%c%c %-34s%s%s\n", row->letter ? '-' : ' ', row->letter ? row->letter : ' ',
               row->letter ? ',' : ' ', synopsis, strlen(synopsis) > 33 ? "\n                                         " : " ",
               row->help);
    }
}

void cli_print_help(cli_command_id command)
{
    if (command != CLI_COMMAND_COUNT) {
        const cli_command *row = &cli_command_table[command];
        printf("usage: firstlight %s %s\n\n%s.\n%s\n", row->name, row->arguments, row->help, row->details);
        print_options(command);
        return;
    }
    puts("firstlight: an interactive progressive ray-tracing previewer\n\n"
         "usage: firstlight [SCENE]          open a window\n"
         "       firstlight COMMAND ...      one of these\n");
    for (int i = 0; i < CLI_COMMAND_COUNT; i++)
        printf("  %-8s %-15s %s\n", cli_command_table[i].name, cli_command_table[i].arguments,
               cli_command_table[i].help);
    puts("\n'firstlight help COMMAND' lists its options. Exit codes: 0 done, 1 check failed, 2 wrong usage,\n"
         "3 wrong input, 4 environment (no display, out of memory, disk full), 130 interrupted.");
}

void cli_word_print(const char *word, FILE *file)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=,./:@%";
    if (*word && !word[strspn(word, plain)]) {
        fputs(word, file);
        return;
    }
    fputc('\'', file);
    for (; *word; word++)
        if (*word == '\'')
            fputs("'\\''", file);
        else
            fputc(*word, file);
    fputc('\'', file);
}

static void print_numbers(const double *numbers, int count, FILE *file)
{
    char text[32];
    if (count > 1)
        fputc('\'', file);
    for (int i = 0; i < count; i++) {
        size_t bytes = isinf(numbers[i]) ? (size_t)snprintf(text, sizeof text, "inf") : fl_number_format(numbers[i], text);
        fprintf(file, "%s%.*s", i ? " " : "", (int)bytes, text);
    }
    if (count > 1)
        fputc('\'', file);
}

static void print_counts(const uint32_t *counts, int count, char separator, FILE *file)
{
    for (int i = 0; i < count; i++) {
        if (i)
            fputc(separator, file);
        fprintf(file, "%u", counts[i]);
    }
}

static void print_value(const cli_option *row, const cli_options *options, FILE *file)
{
    const void *field = (const char *)options + row->offset;
    switch (row->kind) {
    case CLI_KIND_COUNT_OR_AUTO:
        if (*(const uint32_t *)field == CLI_AUTO)
            fputs("auto", file);
        else
            print_counts(field, 1, ' ', file);
        break;
    case CLI_KIND_COUNT:
        print_counts(field, 1, ' ', file);
        break;
    case CLI_KIND_SIZE:
        print_counts(field, 2, 'x', file);
        break;
    case CLI_KIND_CROP:
        print_counts(field, 4, ',', file);
        break;
    case CLI_KIND_PIXEL:
        print_counts(field, 3, ',', file);
        break;
    case CLI_KIND_NUMBER:
    case CLI_KIND_NUMBER_OR_INF:
        print_numbers(field, 1, file);
        break;
    case CLI_KIND_CAMERA:
        print_numbers(field, 10, file);
        break;
    case CLI_KIND_CHOICE:
        fputs(row->choices[*(const uint32_t *)field], file);
        break;
    case CLI_KIND_CHOICE_TEXT:
    case CLI_KIND_TEXT:
        cli_word_print(*(const char *const *)field, file);
        break;
    case CLI_KIND_FLAG:
    case CLI_KIND_OUTPUT:
        break;
    }
}

void cli_options_print(const cli_options *options, FILE *file)
{
    for (int i = 0; i < CLI_OPT_COUNT; i++) {
        const cli_option *row = &cli_option_table[i];
        if (!cli_has(options, (cli_option_id)i) || row->kind == CLI_KIND_OUTPUT)
            continue;
        fprintf(file, row->kind == CLI_KIND_FLAG ? " --%s" : " --%s ", row->name);
        print_value(row, options, file);
    }
    for (uint32_t i = 0; i < options->output_count; i++) {
        fputs(" --output ", file);
        cli_word_print(options->outputs[i], file);
    }
}

/* Text with the characters that man(7) takes as its own made plain. */
static void print_man_text(const char *text)
{
    if (*text == '.' || *text == '\'')
        fputs("\\&", stdout);
    for (; *text; text++) {
        if (*text == '-' || *text == '\\')
            putchar('\\');
        putchar(*text == '\\' ? 'e' : *text);
    }
}

void cli_print_man(void)
{
    puts(".\\\" Generated by: firstlight help man\n.TH FIRSTLIGHT 1\n.SH NAME\n"
         "firstlight \\- interactive progressive ray\\-tracing previewer\n.SH SYNOPSIS\n.B firstlight\n"
         ".RI [ SCENE ]\n.br\n.B firstlight\n.I COMMAND\n.RI [ OPTION ]... \n.SH COMMANDS");
    for (int i = 0; i < CLI_COMMAND_COUNT; i++) {
        const cli_command *row = &cli_command_table[i];
        printf(".TP\n.B %s\n.I ", row->name);
        print_man_text(row->arguments);
        printf("\n");
        print_man_text(row->help);
        printf(".\n");
        print_man_text(row->details);
        printf("\n");
    }
    puts(".SH OPTIONS");
    for (int i = 0; i < CLI_OPT_COUNT; i++) {
        const cli_option *row = &cli_option_table[i];
        char synopsis[128];
        option_synopsis(row, synopsis, sizeof synopsis);
        printf(".TP\n.B ");
        if (row->letter)
            printf("\\-%c, ", row->letter);
        print_man_text(synopsis);
        printf("\n");
        print_man_text(row->help);
        printf("\n");
        if (row->commands == ~0u)
            continue;
        printf("(for");
        for (int c = 0, first = 1; c < CLI_COMMAND_COUNT; c++)
            if (row->commands >> c & 1u) {
                printf("%s %s", first ? "" : ",", cli_command_table[c].name);
                first = 0;
            }
        puts(")");
    }
    puts(".SH EXIT STATUS\n0 done; 1 check failed; 2 wrong usage; 3 wrong input; 4 environment; 130 interrupted, what\n"
         "was rendered is saved.");
}
