/* SPDX-License-Identifier: MIT
 *
 * Small scenes that together use every feature which can reach a pixel, over the files of world.h.
 */
#ifndef TEST_SCENES_H
#define TEST_SCENES_H

#include "core/firstlight.h"

typedef struct test_scene {
    const char *name, *text;
    uint32_t width, height, samples;
    fl_sampler sampler;
    fl_revolve_solver solver;
    bool is_double;       /**< Rays in double. */
    bool is_exact;        /**< With the course's own rules (decision 22). */
    uint32_t crop[4];     /**< x, y, width, height; width 0: none. */
    uint32_t lens_points; /**< Shadow rays per disc light and hit; 0: as the text says. */
} test_scene;

extern const test_scene test_scenes[];
extern const uint32_t test_scene_count;

#endif
