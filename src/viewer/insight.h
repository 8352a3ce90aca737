/* SPDX-License-Identifier: MIT
 *
 * What a session keeps of explanations: measurements, the picture's way so far, a tree of rays.
 */
#ifndef VW_INSIGHT_H
#define VW_INSIGHT_H

#include "viewer/lab.h"

/** Error of the picture when all pixels had so many samples. */
typedef struct vw_milestone {
    double seconds, rmse;
    uint32_t samples;
} vw_milestone;

enum { VW_WAY_MAX = 32 };

/** Zero-initialise. */
typedef struct vw_insight {
    vw_lab *lab; /**< NULL until first needed. */
    vw_lab_answer answer;
    uint64_t since; /**< First question whose answer fits the present one; 0: nothing was asked. */
    vw_lab_kind asked_kind;
    vw_stress asked_stress;
    vw_panel asked_panel;
    uint64_t asked_generation;
    uint32_t asked_samples;
    vw_milestone way[VW_WAY_MAX]; /**< At powers of two from 4 samples on, of this generation. */
    uint32_t way_count;
    uint64_t way_generation;
    char *rays_text, *rays_lines; /**< The tree of rays in full, and a line a ray. Owned. */
    uint32_t changed; /**< Stress: pixels that differ by more than half an 8-bit step. */
    uint32_t touched; /**< That differ at all. */
    double largest;
} vw_insight;

#endif
