/* SPDX-License-Identifier: MIT
 *
 * `study --extremes`: rows of scenes and rays at the ends of the ranges, each judged by the same in
 * double. Families of rows are data (extremes_scenes.c); files that they name are made in memory.
 */
#ifndef CLI_EXTREMES_H
#define CLI_EXTREMES_H

#include "core/firstlight.h"

/** How the picture of a row is judged. No row may warn of anything but WARNED ones, nor have
 * invalid samples but COUNTED ones. */
typedef enum extreme_judge {
    EXTREME_DOUBLE, /**< Against the same scene in double. */
    EXTREME_MEAN,   /**< Likewise, by the mean of all its pixels: where each is noise. */
    EXTREME_SCALED, /**< Scaled by the value; against the plain scene in double. */
    EXTREME_MOVED,  /**< Moved by the value times 10 units, the scene's size; likewise. */
    EXTREME_WARNED, /**< Moved likewise, in double: right, as a warning said that floats are not. */
    EXTREME_COUNTED, /**< Overflows floats: samples must be dropped, counted, and the film finite.
                      */
    EXTREME_REFUSED, /**< Must not render: the message must hold the value's last field. */
    EXTREME_RAYS     /**< No picture: rays aimed at the corners and edges of a closed mesh. */
} extreme_judge;

/** Rows with one text and several values. */
typedef struct extreme_family {
    const char *name;
    const char *text; /**< @0, @1 ... stand for the fields of a value. Rays: the objects that hold
                           ball.obj; NULL: its triangles one by one. */
    /** NULL at the end; fields separated by '|'. In front '!': slow; '=': the picture of the value
     * before it; without that it must be another (DOUBLE and MEAN). At the end "#OFF BOUND":
     * instead of the family's. */
    const char *const *values;
    extreme_judge judge;
    uint32_t shown;   /**< Fields that name a row; 0: 1. Rays: all. */
    double bound;     /**< Largest relative rmse of the pixels that agree; 0: 1e-6. */
    uint32_t off_max; /**< Pixels that may be off, on edges; of small pictures never above 1 %. */
    uint32_t samples; /**< 0: 4. */
} extreme_family;

extern const extreme_family extreme_families[];
extern const uint32_t extreme_family_count;

enum { EXTREME_FIELDS_MAX = 10, EXTREME_TEXT_MAX = 8192 };

/** A value of a family, cut into its fields. */
typedef struct extreme_value {
    char text[256];
    const char *fields[EXTREME_FIELDS_MAX]; /**< Into `text`: it must not move. */
    uint32_t count;
    bool is_slow, is_same;
    bool has_limits; /**< Of its own. */
    uint32_t off_max;
    double bound;
} extreme_value;

void extreme_value_read(const extreme_family *family, const char *text, extreme_value *out_value);
/** The family's text with the fields put in. */
void extreme_text(const extreme_family *family, const extreme_value *value,
                  char out_text[EXTREME_TEXT_MAX]);
double extreme_number(const char *text);

/** What came out. */
typedef struct extreme_result {
    double error;         /**< Rmse of the pixels that agree, relative to that of the picture. */
    uint32_t off, pixels; /**< Off by more than 1/256 of the picture's rms; or rays lost, of all. */
    double bound;         /**< What was allowed. */
    uint32_t off_max;
    uint64_t invalid; /**< Samples, of both. */
    bool passed;
    char note[160]; /**< Why not, or what the refusal said. */
} extreme_result;

/** The files of the families: ball.obj, with texture coordinates x and y; needle.obj; sheetN.obj,
 * where these go from N to N + 1; 1x1.png, 2x1.png, wide.png (16384x1), tall.png (1x16384),
 * checker.png, large.png (16384x512). */
extern const fl_files extreme_files;

/** Where a ball of triangles of radius 1 lies, and from where rays are aimed at its corners, edges
 * and faces. */
typedef struct extreme_aim {
    const char
        *objects; /**< In the text of a scene: one, that holds ball.obj; NULL: `Triangle`s. */
    double scale, moved; /**< The scene's, and by how many radii. */
    double distance;     /**< From the ball, in radii; 0: from inside. */
    uint64_t count;
} extreme_aim;

/** How many rays leak: from inside, all that meet nothing; from outside, where they end inside, all
 * that got through the near wall. False: out of memory. */
bool extreme_rays(const extreme_aim *aim, extreme_result *out);

/** A closed ball of 8 * 4^level triangles; NULL: out of memory. */
fl_mesh *extreme_ball(uint32_t level, double radius);

#endif
