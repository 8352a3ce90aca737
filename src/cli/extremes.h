/* SPDX-License-Identifier: MIT
 *
 * `study --extremes`: rows of scenes and rays at the ends of the ranges, each judged by the same in
 * double. Families of rows are data (extremes_scenes.c); files that they name are made in memory.
 */
#ifndef CLI_EXTREMES_H
#define CLI_EXTREMES_H

#include "core/firstlight.h"

/** How the picture of a row is judged. */
typedef enum extreme_judge {
    EXTREME_DOUBLE,  /**< Against the same scene in double. */
    EXTREME_SCALED,  /**< Scaled by the value; against the plain scene in double. */
    EXTREME_MOVED,   /**< Moved by the value times 10 units, the scene's size; likewise. */
    EXTREME_REFUSED, /**< Must not render: the message must hold the value's last field. */
    EXTREME_RAYS     /**< No picture: rays aimed at the corners and edges of a closed mesh. */
} extreme_judge;

/** Rows with one text and several values. */
typedef struct extreme_family {
    const char *name, *text; /**< In the text @0, @1 ... stand for the fields of a value. */
    const char *const
        *values; /**< NULL at the end; fields separated by '|'; a leading '!': slow. */
    extreme_judge judge;
    double bound;     /**< Largest relative rmse of the pixels that agree; 0: 1e-6. */
    uint32_t off_max; /**< Pixels that may be off, on edges; of the picture's 1,728. */
    uint32_t samples; /**< 0: 4. */
} extreme_family;

extern const extreme_family extreme_families[];
extern const uint32_t extreme_family_count;

/** What came out. */
typedef struct extreme_result {
    double error;         /**< Rmse of the pixels that agree, relative to that of the picture. */
    uint32_t off, pixels; /**< Off by more than 1/256 of the picture's rms; or rays lost, of all. */
    uint64_t invalid;     /**< Samples, of both. */
    bool passed;
    char note[160]; /**< Why not, or what the refusal said. */
} extreme_result;

/** The files of the families: ball.obj, needle.obj; 1x1.png, 2x1.png, wide.png (16384x1), tall.png
 * (1x16384), checker.png. */
extern const fl_files extreme_files;

/** `count` rays from inside a ball of triangles at its corners, edges and faces: how many get out.
 * `scale` and `distance` (from the ray's origin to the ball, in radii, when above 1 from outside)
 * give the place. False: out of memory. */
bool extreme_rays(double scale, double distance, uint64_t count, extreme_result *out);

/** A closed ball of 20 * 4^level triangles; NULL: out of memory. */
fl_mesh *extreme_ball(uint32_t level, double radius);

#endif
