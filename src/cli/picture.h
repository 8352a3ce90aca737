/* SPDX-License-Identifier: MIT
 *
 * Rendering to the end without a window: the part that render and check share.
 */
#ifndef CLI_PICTURE_H
#define CLI_PICTURE_H

#include "cli/load.h"
#include "io/digest.h"

/** Golden pictures: small enough to check in a second, large enough to show every feature. */
enum { CLI_GOLDEN_SIDE = 160, CLI_GOLDEN_SAMPLES = 16 };

/** Samples of a scene's golden picture: a scene that asks for fewer gets no more. */
static inline uint32_t cli_golden_samples(const fl_render_block *render)
{
    return render->has_samples ? fl_min_u32(CLI_GOLDEN_SAMPLES, render->samples) : CLI_GOLDEN_SAMPLES;
}

enum { CLI_MAP_COUNT = FL_RENDER_ERROR + 1 }; /**< Of fl_render_map. */

/** A finished (or interrupted) picture. */
typedef struct cli_picture {
    uint32_t width, height;
    float *rgb; /**< Linear means, 3 * width * height, top row first; owned. */
    float *maps[CLI_MAP_COUNT]; /**< By fl_render_map: width * height floats, or NULL where not asked for; owned. */
    char film_sha256[FL_SHA256_HEX + 1];
    fl_progress progress;
    bool was_interrupted;
    double refined_seconds; /**< When the good hierarchies took over, in seconds of rendering; 0: from the start, or never. */
} cli_picture;

/** How a picture is rendered besides its limits; zero is the plain way. */
typedef struct cli_picture_plan {
    uint32_t threads;
    const char *progress_name; /**< Show progress under this name when standard error is a terminal; NULL: never. */
    uint32_t maps;             /**< Bit per fl_render_map to keep. */
    const char *checkpoint;    /**< File to go on from and to keep the render in; NULL: none. */
} cli_picture_plan;

/** Render with the scene's parameters until `limits` are met or a signal comes: then all pixels get the same number of
 *  samples, if that takes no more than a second. False after adding an error, or a note when it was interrupted before there
 *  was a picture. */
bool cli_picture_render(cli_scene *scene, const fl_render_limits *limits, const cli_picture_plan *plan,
                        cli_picture *out);

/** When the error will be `rmse`, in seconds of rendering since the restart. */
typedef struct cli_forecast {
    double rmse, seconds, low, high;
} cli_forecast;

/** The target that is spoken of when none was given: half a per cent of full scale. */
#define CLI_FORECAST_RMSE 0.005

/** At the pace so far. False: not known yet, below 4 samples. Reached already: the present time. */
bool cli_forecast_read(const fl_progress *progress, double target_rmse, cli_forecast *out);

/** Samples of every pixel; in an adaptive picture the mean, rounded. */
uint32_t cli_picture_samples(const cli_picture *picture);

void cli_picture_close(cli_picture *picture);

/** The picture as 8-bit RGB, 3 * width * height bytes from malloc; NULL after adding an error. */
uint8_t *cli_picture_bytes(const cli_picture *picture, const fl_params *params, fl_diags *diags);

/** Write the picture to `path`; its extension chooses the format. State is stored as text keys where the format has
 *  room for it. False after adding an error. */
bool cli_picture_save(const cli_picture *picture, const cli_scene *scene, const char *path, fl_diags *diags);

#endif
