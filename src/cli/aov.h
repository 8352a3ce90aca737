/* SPDX-License-Identifier: MIT
 *
 * Pictures of what stands behind the pixels: --aov.
 */
#ifndef CLI_AOV_H
#define CLI_AOV_H

#include "cli/picture.h"

/** What a list of names asks for. */
typedef struct cli_aovs {
    uint32_t kinds; /**< Bit per fl_aov. */
    uint32_t maps;  /**< Bit per fl_render_map. */
} cli_aovs;

/** Read a comma-separated list; NULL asks for nothing. False after writing a line about the wrong word. */
bool cli_aov_parse(const char *names, cli_aovs *out, char message[CLI_MESSAGE_BYTES]);

/** Name of the i-th of them in the order of writing; NULL: there are no more. */
const char *cli_aov_name(const cli_aovs *aovs, uint32_t i);

/** STEM.NAME.exr beside the picture at `path`, from malloc; NULL: out of memory. */
char *cli_aov_path(const char *path, const char *name);

/** Write STEM.NAME.exr beside the picture at `path` for everything asked for; the picture must have kept the maps. False after
 *  adding an error. */
bool cli_aov_save(const cli_scene *scene, const cli_picture *picture, const cli_aovs *aovs, const char *path,
                  fl_diags *diags);

#endif
