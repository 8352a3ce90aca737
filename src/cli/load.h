/* SPDX-License-Identifier: MIT
 *
 * From options to something that can be rendered; shared by the commands.
 */
#ifndef CLI_LOAD_H
#define CLI_LOAD_H

#include "cli/options.h"
#include "io/file_list.h"
#include "io/state_text.h"

/** A scene on its way to a picture. Zero-initialise but for `diags`, `files` and quick_above; cli_scene_close frees whatever is there. */
typedef struct cli_scene {
    const char *path; /**< Of the scene's text: borrowed from the options, or the state's. */
    fl_saved_state state; /**< Of the picture that was named in place of a scene; has a path only then. */
    fl_scene *scene;
    fl_compiled *compiled;
    fl_params params; /**< Borrows lights from `scene`. */
    fl_diags *diags;  /**< Borrowed: where everything wrong is said. */
    fl_file_list *files; /**< Borrowed: gets what it is made from, and what is missing; NULL: not wanted. */
    uint32_t quick_above;  /**< As fl_compile_options, for callers who refine what is compiled quickly. */
    double load_seconds;   /**< What cli_scene_open took, wall time. */
} cli_scene;

/** Read and parse; true: out->scene is set. */
bool cli_scene_parse(const cli_options *options, const char *path, cli_scene *out);

/** After a text was refused: note how many of the errors --lenient would turn into warnings, if any. Opens no files. */
void cli_note_slips(const char *text, size_t bytes, const char *path, const fl_parse_options *parse, fl_diags *diags);

/** Read, parse, compile with all threads asked for, and set the parameters: scene, then the state of the picture that
 *  `path` may name instead of a scene, then options (decision 19). */
bool cli_scene_open(const cli_options *options, const char *path, cli_scene *out);

void cli_scene_close(cli_scene *scene);

/** Render all of the picture: a crop belongs to the size that it was cut from, which changes. */
void cli_drop_crop(fl_params *params);

/** Seconds on a clock that only goes forward. */
double cli_wall_seconds(void);

/** Print all diagnostics on standard error, most recent last, with a count of those dropped. */
void cli_print_diags(const fl_diags *diags);

/** Exit code for what the diagnostics say: 0 without errors, 4 if any error is the environment's, 2 if the options asked for
 *  what the scene cannot give, else 3. */
int cli_exit_code(const fl_diags *diags);

/** Samples to stop at: option, else the picture's, else Render block, else default (0 when only time or noise is to stop
 *  it). */
uint32_t cli_sample_limit(const cli_options *options, const cli_scene *scene);

/** Set by SIGINT, SIGTERM and SIGHUP once cli_catch_signals was called; a second signal ends the program. */
bool cli_was_interrupted(void);
void cli_catch_signals(void);

#endif
