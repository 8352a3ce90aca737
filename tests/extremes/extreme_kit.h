/* SPDX-License-Identifier: MIT
 *
 * Films of scene texts, for the tests of extremes.
 */
#ifndef EXTREME_KIT_H
#define EXTREME_KIT_H

#include "bytes/scenes.h"

/** A linear film and what its render counted; free with film_free. */
typedef struct film {
    float *rgb; /**< width * height * 3. */
    uint32_t width, height;
    fl_counts counts;
} film;

/** Compile and render `samples` samples with the parameters, whose lights and camera should be
 * those of the scene. False: something failed, the reason is printed. */
bool film_render(film *out, const fl_scene *scene, const fl_params *params, uint32_t samples);
void film_free(film *f);

/** The parameters of a scene of tests/bytes. */
fl_params film_params(const test_scene *test, const fl_scene *scene);

/** Parse a text over the files of tests/bytes; NULL: the reason is printed. */
fl_scene *film_parse(const char *text, const char *name);

/** Pixels of which some channel is off by more than `tolerance` times max(1, |b|), or is not
 * finite; and the largest such difference. */
uint32_t film_differ(const film *a, const film *b, double tolerance, double *out_largest);

#endif
