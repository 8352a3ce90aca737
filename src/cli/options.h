/* SPDX-License-Identifier: MIT
 *
 * The command line: one table of commands and one of options, from which parsing, --help and the man page come.
 */
#ifndef CLI_OPTIONS_H
#define CLI_OPTIONS_H

#include <stdio.h>

#include "core/firstlight.h"

/** Exit codes of the program. */
enum {
    CLI_DONE = 0,
    CLI_CHECK_FAILED = 1,
    CLI_WRONG_USAGE = 2,
    CLI_WRONG_INPUT = 3,
    CLI_ENVIRONMENT = 4,
    CLI_INTERRUPTED = 130
};

enum { CLI_OUTPUTS_MAX = 16, CLI_MESSAGE_BYTES = 512 };

/** A count that the program is to choose itself. */
enum { CLI_AUTO = 0 };

/** Every option's identity: its row in the table and its bit in cli_options.given. */
typedef enum cli_option_id {
    CLI_OPT_SIZE,
    CLI_OPT_SAMPLES,
    CLI_OPT_TIME,
    CLI_OPT_NOISE,
    CLI_OPT_LIGHT_SAMPLES,
    CLI_OPT_DEPTH,
    CLI_OPT_APERTURE,
    CLI_OPT_FOCUS,
    CLI_OPT_CAMERA,
    CLI_OPT_SCALE,
    CLI_OPT_CROP,
    CLI_OPT_EXPOSURE,
    CLI_OPT_WEIGHT_THRESHOLD,
    CLI_OPT_SEED,
    CLI_OPT_SAMPLER,
    CLI_OPT_REVOLVE_SOLVER,
    CLI_OPT_REVOLVE_STARTS,
    CLI_OPT_PRECISION,
    CLI_OPT_ACCEL,
    CLI_OPT_OCTREE_HEIGHT,
    CLI_OPT_QUICK_ABOVE,
    CLI_OPT_ISA,
    CLI_OPT_THREADS,
    CLI_OPT_LEAVE_CORE,
    CLI_OPT_DIALECT,
    CLI_OPT_DIALECT_EXACT,
    CLI_OPT_LENIENT,
    CLI_OPT_OUTPUT,
    CLI_OPT_CHECKPOINT,
    CLI_OPT_AOV,
    CLI_OPT_NOISE_SPLIT,
    CLI_OPT_ADAPTIVE,
    CLI_OPT_UPDATE,
    CLI_OPT_REPORT,
    CLI_OPT_OUT,
    CLI_OPT_BUDGET,
    CLI_OPT_REPEATS,
    CLI_OPT_SWEEP,
    CLI_OPT_EXTREMES,
    CLI_OPT_ALL,
    CLI_OPT_AGAINST,
    CLI_OPT_FIRST_PICTURE,
    CLI_OPT_GROWTH,
    CLI_OPT_SOURCE,
    CLI_OPT_RECORD,
    CLI_OPT_KEYS,
    CLI_OPT_PIN,
    CLI_OPT_PIXEL,
    CLI_OPT_PLATFORM,
    CLI_OPT_SHADER_DIR,
    CLI_OPT_JSON,
    CLI_OPT_QUIET,
    CLI_OPT_HELP,
    CLI_OPT_COUNT
} cli_option_id;

typedef enum cli_command_id {
    CLI_VIEW,
    CLI_RENDER,
    CLI_CHECK,
    CLI_STUDY,
    CLI_BENCH,
    CLI_INFO,
    CLI_CONVERT,
    CLI_REPLAY,
    CLI_HELP,
    CLI_COMMAND_COUNT
} cli_command_id;

/** What the user asked for. Strings are borrowed from argv. A value counts only when its bit is given. */
typedef struct cli_options {
    uint64_t given; /**< Bit per cli_option_id. */
    uint32_t size[2];  /**< Width, height; pixels. */
    uint32_t crop[4];  /**< x, y from the upper left corner, width, height; pixels. */
    uint32_t pixel[3]; /**< x, y, number of the sample. */
    uint32_t samples;  /**< A pixel. */
    uint32_t light_samples; /**< A hit and light; CLI_AUTO: chosen by where the noise comes from. */
    uint32_t depth;         /**< Bounces. */
    uint32_t seed, threads;
    uint32_t octree_height;  /**< Levels. */
    uint32_t quick_above;    /**< Triangles of a mesh, fl_compile_options. */
    uint32_t repeats;        /**< Of a timing, or of a study's renders. */
    uint32_t revolve_starts; /**< Of Newton's method, a segment of the curve. */
    double time_s, budget_s; /**< Seconds on the wall: of a render, of a whole study. */
    double noise;            /**< Root mean square error to stop at, linear radiance. */
    double scale;            /**< Of width and height. */
    double aperture, focus;  /**< Radius of the lens, distance of the focus plane; scene units. */
    double exposure_ev;      /**< Stops. */
    double weight_threshold; /**< Least weight of a ray that is followed. */
    double camera[10]; /**< eye, look-at point, up, vertical field of view in degrees */
    uint32_t adaptive, sampler, solver, precision, accel, dialect; /**< Values of the core's enums. */
    const char *outputs[CLI_OUTPUTS_MAX]; /**< Pictures to write. */
    uint32_t output_count;
    /** Names of files and folders, and words, as they were written. */
    const char *checkpoint, *aov, *report, *out_dir, *sweep, *record, *keys, *pin, *platform, *shader_dir, *isa, *against;
    const char **paths; /**< Arguments that are no options; points into argv. */
    uint32_t path_count;
} cli_options;

/** Whether an option was given. */
static inline bool cli_has(const cli_options *options, cli_option_id id)
{
    return options->given >> id & 1u;
}

/** Parse the words after the command's name. Permutes argv. False after writing one line about the first wrong
 *  word, with the nearest right one, into `message`. */
bool cli_options_parse(cli_command_id command, int argc, char **argv, cli_options *out, char *message,
                       size_t message_bytes);

/** Print all options that were given, each behind a blank, as words that a shell reads back. */
void cli_options_print(const cli_options *options, FILE *file);
/** Print a word, in quotes where a shell would not take it as it is. */
void cli_word_print(const char *word, FILE *file);

/** The command called `name`; CLI_COMMAND_COUNT: none. */
cli_command_id cli_command_find(const char *name);
/** Nearest command's name, or NULL. */
const char *cli_command_nearest(const char *name);

/** Print the help of one command (CLI_COMMAND_COUNT: the overview) on standard output. */
void cli_print_help(cli_command_id command);
/** Print the man page, in man(7) macros, on standard output. */
void cli_print_man(void);

#endif
