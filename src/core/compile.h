/* SPDX-License-Identifier: MIT
 *
 * Layer 5: a parsed scene becomes the immutable, reference-counted thing that renders walk.
 */
#ifndef FL_COMPILE_H
#define FL_COMPILE_H

#include "core/cpu.h"
#include "core/geometry.h"
#include "core/params.h"
#include "core/pool.h"

/** What the scene requires; a feature whose bit is off has no stage, no sample dimension, no array. */
enum {
    FL_NEED_SPHERES = 1u << 0,
    FL_NEED_PLANES = 1u << 1,
    FL_NEED_PATCHES = 1u << 2, /**< squares and disks */
    FL_NEED_TRIANGLES = 1u << 3,
    FL_NEED_REVOLUTIONS = 1u << 4,
    FL_NEED_TRANSFORMS = 1u << 5,
    FL_NEED_TEXTURES = 1u << 6,
    FL_NEED_SPECULAR = 1u << 7,
    FL_NEED_REFLECTION = 1u << 8,
    FL_NEED_REFRACTION = 1u << 9,
    FL_NEED_SHADING_NORMALS = 1u << 10,
    FL_NEED_CUBE_MAP = 1u << 11,
    FL_NEED_COUNT = 12
};
/** Short names in bit order: "spheres", "planes", ... */
extern const char *const fl_need_names[FL_NEED_COUNT];

/** Material in the form the shading stage gathers from. */
typedef struct fl_shader {
    float diffuse[3], specular[3], ambient[3], reflect[3], refract[3];
    float shininess, refraction_index;
    double index_exact; /**< refraction_index unrounded, for rays in double: glass magnifies it. */
    uint32_t texture; /**< Index into textures or FL_NONE. Multiplies diffuse (and ambient when it defaults). */
    bool ambient_is_diffuse;
} fl_shader;

/** A texture as used by objects: picture plus how it is read. */
typedef struct fl_texture {
    fl_image *image; /**< A reference. */
    fl_filter filter;
    float scale[2];
    bool clamps_v; /**< Spheres and revolutions clamp v; others repeat both. */
} fl_texture;

typedef struct fl_compiled fl_compiled;

struct fl_compiled {
    fl_ref ref;
    fl_arena arena;
    /** A reference to what holds everything but the hierarchies of large meshes, which are the only difference between
     *  a quickly compiled scene and the refined one. NULL: nothing is shared. */
    fl_compiled *base;
    bool is_quick; /**< Large meshes have quick hierarchies; fl_compile_refine makes better ones. */
    fl_geometry geometry;
    fl_shader *shaders;        /**< One per (material, texture) pair in use. */
    uint32_t *object_shader;   /**< Per object. */
    uint8_t *object_needs_uv;  /**< Per object. */
    fl_loc *object_loc;        /**< Per object: place in the scene text; file name in the arena. */
    fl_texture *textures;
    fl_image *cube[FL_CUBE_FACES]; /**< References; all NULL without a cube map. */
    uint32_t shader_count, texture_count;
    uint32_t needs;            /**< FL_NEED_ bits. */
    fl_isa isa;                /**< Whose kernels are used. */
    uint64_t triangle_count, instanced_triangle_count, revolution_piece_count;
    size_t geometry_bytes, accel_bytes, texture_bytes;
    double build_seconds;      /**< Of compiling, which is mostly the acceleration structures; wall time. */
};

typedef struct fl_compile_options {
    fl_accel accel;
    bool has_isa; /**< False: the best this machine has. */
    fl_isa isa;
    uint32_t octree_height; /**< 0: default (8). */
    /** With FL_ACCEL_BVH, meshes of more triangles than this get a quick hierarchy first, for the caller to refine while
     *  the scene is rendered; 0: none. */
    uint32_t quick_above;
    bool in_double; /**< The scene will be rendered in double: no warning of what floats cannot place. */
} fl_compile_options;

/** Where building quickly first begins to pay (docs/performance.md). */
enum { FL_QUICK_ABOVE = 1000000 };

/** Compile. `scene` may go afterwards (pictures and meshes are retained or copied). `pool` speeds up building; NULL: this
 *  thread alone, same result. NULL after adding an error. O(n log n) in primitives. */
fl_compiled *fl_compile(const fl_scene *scene, const fl_compile_options *options, fl_pool *pool,
                        fl_diags *diags);

/** Another form of a scene that is_quick, whose hierarchies are as good as they get: hits are the same to the bit, found
 *  faster. Retains what both share. NULL after adding an error, or when the pool was cancelled. O(n log n). Any thread. */
fl_compiled *fl_compile_refine(const fl_compiled *quick, fl_pool *pool, fl_diags *diags);

fl_compiled *fl_compiled_retain(fl_compiled *compiled);
/** Drop a reference; NULL is allowed. */
void fl_compiled_release(fl_compiled *compiled);

#endif
