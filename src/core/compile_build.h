/* SPDX-License-Identifier: MIT
 *
 * Layer 5, private to compile: what its parts share while a scene is compiled.
 */
#ifndef FL_COMPILE_BUILD_H
#define FL_COMPILE_BUILD_H

#include "core/compile.h"
#include "core/octree.h"

/** A limit as its definition is written, for messages. */
#define FL_TEXT_OF(limit)  FL_TEXT_OF_(limit)
#define FL_TEXT_OF_(limit) #limit

typedef struct fl_compiler {
    const fl_scene *scene;
    const fl_compile_options *options;
    fl_pool *pool;
    fl_diags *diags;
    fl_compiled *out;
    fl_geometry *geometry; /**< &out->geometry */
    bool is_quick;         /**< Hierarchies of meshes are to be built quickly. */
} fl_compiler;

/** Object to world; the identity without a transform. */
fl_affine fl_compile_transform(const fl_compiler *c, const fl_object *object);

/** World bounds of an object, not yet relative to the origin; empty for planes and empty meshes. */
fl_box fl_compile_object_bounds(const fl_compiler *c, const fl_object *object);

/** Set geometry.origin and extent from all bounded objects. False after a located error: a
 * coordinate too large. Adds a located warning when objects are so small, or so far from the origin,
 * that floats cannot place them well, unless options->in_double. */
bool fl_compile_origin(fl_compiler *c);

/** A multiple of a power of two near the middle of `box`; 0 when 0 is near enough. */
fl_vec3 fl_compile_box_origin(fl_box box);

/** Where vertices without a transform count from: geometry.origin, where rays meet them as they are;
 * a point near `box` when floats could not tell them apart there. */
fl_vec3 fl_compile_vertex_origin(const fl_compiler *c, fl_box box);

/** Spheres, planes, patches, revolutions. */
bool fl_compile_shapes(fl_compiler *c);

/** Meshes and loose triangles, with their instances. Call before shapes add theirs. */
bool fl_compile_meshes(fl_compiler *c);

/** Add an instance of entry `index` of `kind`, whose space is the object's moved by -local_origin;
 * `object` lends its transform and its place in the text. `box`: of the entry in that space, empty
 * for planes. `size`: of what its neighbours are made of, for offsets. */
bool fl_compile_instance(fl_compiler *c, const fl_object *object, uint32_t object_index,
                         fl_object_kind kind, uint32_t index, fl_vec3 local_origin, fl_box box,
                         double size);

/** The list of entries, and the hierarchy over them if there are many. */
bool fl_compile_entries(fl_compiler *c);

/** Packs and the chosen structure of one mesh. */
bool fl_compile_accel(fl_compiler *c, fl_tri_mesh *mesh);

/** Whether that is to wait until all else is compiled, for a quick hierarchy. */
static inline bool fl_compile_is_large(const fl_compiler *c, const fl_tri_mesh *mesh)
{
    return c->options->quick_above > 0 && mesh->face_count > c->options->quick_above &&
           c->options->accel == FL_ACCEL_BVH;
}

/** Shaders, textures, cube map, needs, places. */
bool fl_compile_shading(fl_compiler *c);

/** Box in floats, widened by FL_BOX_PAD times its largest coordinate. */
fl_bvh_box fl_compile_padded(fl_box box);

/** False after an error at `loc` when a coordinate of `box` is not finite or beyond
 * FL_COORDINATE_MAX. */
bool fl_compile_check_box(fl_compiler *c, fl_box box, fl_loc loc);

#endif
