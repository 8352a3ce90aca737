/* SPDX-License-Identifier: MIT
 *
 * Reads the corpus format of surfaces of revolution: lines
 *     P id segments degree family         then segments * (degree + 1) lines "x y"
 *     R id profile category ox oy oz dx dy dz
 *     # anything
 * with numbers as strtod takes them (the corpora use hexadecimal floats).
 */
#ifndef TESTS_CORPUS_READ_H
#define TESTS_CORPUS_READ_H

#include <stdio.h>

#include "core/revolve.h"

typedef struct corpus_ray {
    long id;
    uint32_t profile; /**< Index into corpus.profiles. */
    char category[32];
    double o[3], d[3];
} corpus_ray;

typedef struct corpus {
    fl_arena arena; /**< Points of the profiles. */
    fl_profile *profiles;
    char (*families)[32];
    uint32_t profile_count;
    corpus_ray *rays;
    size_t ray_count;
} corpus;

/** False, and a message on stderr, when the text is not a corpus or memory is short. */
bool corpus_load(corpus *out, FILE *file);
void corpus_deinit(corpus *c);

#endif
