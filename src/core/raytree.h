/* SPDX-License-Identifier: MIT
 *
 * Layer 8: one sample's tree of rays: what the tile pipeline did for it, written down while it ran.
 * Nothing is computed a second time, so the numbers are those of the picture, to the bit.
 */
#ifndef FL_RAYTREE_H
#define FL_RAYTREE_H

#include "core/pipeline.h"

typedef enum fl_ray_kind {
    FL_RAY_CAMERA,
    FL_RAY_REFLECT,
    FL_RAY_REFRACT,
    FL_RAY_KIND_COUNT
} fl_ray_kind;
extern const char *const fl_ray_kind_names[FL_RAY_KIND_COUNT];

/** A ray of the sample and what it met. World space; directions as traced (the camera's have
 * d . w = 1). */
typedef struct fl_raytree_node {
    fl_ray_kind kind;
    uint32_t level;  /**< 0: the camera ray. */
    uint32_t parent; /**< FL_NONE: the camera ray. */
    uint32_t path;   /**< Its number (sampler.h). */
    fl_vec3 origin;
    float direction[3], t; /**< t: in lengths of the direction; infinite: it left the scene. */
    uint32_t object, prim; /**< FL_NONE: nothing. */
    float weight[3];
    fl_vec3 position;
    float ng[3], ns[3]; /**< ns: on the viewer's side, as it is shaded. */
    float ambient[3];   /**< Where nothing was hit: the background. */
    float radiance[3];  /**< Ambient and lights; weight times this is added to the sample. */
    uint32_t first_light, light_count; /**< Of its shadow rays in fl_raytree.lights. */
} fl_raytree_node;

/** A sample of a light that would send something to a node: others are not listed. */
typedef struct fl_raytree_light {
    uint32_t node, light; /**< light: in the scene's order. */
    uint32_t sample;      /**< 0 to the light's samples - 1; their mean counts. */
    uint32_t samples;
    float sends[3];   /**< Unless it is blocked. */
    float arrives[3]; /**< 0: blocked; less than `sends`: through glass. */
    float o[3], d[3],
        t_max;        /**< The shadow ray, in the space of the geometry; unset without shadows. */
    uint32_t blocker; /**< First object on the way; FL_NONE: none, or not looked for. */
    double blocker_t;
} fl_raytree_light;

/** Zero-initialise; reusable; free with fl_raytree_deinit. Nodes stand in the order in which they
 * are summed: by level, then path. */
typedef struct fl_raytree {
    fl_raytree_node *nodes;
    fl_raytree_light *lights; /**< By node, light, sample. */
    uint32_t node_count, node_capacity, light_count, light_capacity;
    uint32_t x, y, sample;
    float rgb[3]; /**< The sample's value, as the film gets it. */
    bool is_valid;
    fl_counts counts;
    bool has_failed;         /**< Private. */
    fl_workspace *workspace; /**< Private. */
} fl_raytree;

/** Run sample `sample` of the pixel (absolute coordinates) and write its rays down. False: out of
 * memory. Any thread. */
bool fl_raytree_trace(const fl_frame *frame, uint32_t x, uint32_t y, uint32_t sample,
                      fl_raytree *tree);
/** Find out what stands in the way of shadow rays that lost something. False: out of memory. */
bool fl_raytree_find_blockers(const fl_frame *frame, fl_raytree *tree);
void fl_raytree_deinit(fl_raytree *tree);

/** What adds most to the sample: the node whose weighted radiance has the largest sum of channels'
 * sizes; FL_NONE: all are 0. */
uint32_t fl_raytree_heaviest(const fl_raytree *tree);

/** The tree as text, deepest branches indented most. `is_short`: a line a ray, about 70 columns,
 * for the screen; else everything, with digits enough to tell floats apart. Length as snprintf. */
size_t fl_raytree_text(const fl_frame *frame, const fl_raytree *tree, bool is_short, char *out,
                       size_t out_bytes);

/** "sphere 3, vase.txt:17": an object as users know it. */
void fl_object_text(const fl_compiled *scene, uint32_t object, char *out, size_t out_bytes);
extern const char *const fl_object_kind_names[FL_OBJECT_KIND_COUNT];

#endif
