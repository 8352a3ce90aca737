/* SPDX-License-Identifier: MIT
 *
 * Layer 3: the geometry that kernels walk: structure-of-arrays floats per kind of primitive for the tests,
 * doubles for the one solution of the winner. Built by compile, immutable afterwards.
 *
 * Space. All world coordinates here are relative to `origin`, a point near the middle of the scene (0 for scenes
 * around the world's origin), subtracted in double before anything is rounded to float: a scene far from its
 * origin keeps its accuracy. Objects without a transform are stored in this space ("baked"); others in their
 * own object space and reached through an instance.
 *
 * Identity of a hit is (object, prim): object = index of the scene's object, prim = face index in file order for
 * meshes, 0 otherwise. Nearest = least (t as float, object, prim) (decision 3).
 */
#ifndef FL_GEOMETRY_H
#define FL_GEOMETRY_H

#include "core/arena.h"
#include "core/bvh.h"
#include "core/mesh.h"
#include "core/revolve.h"
#include "core/scene.h"

/** Half the spacing of floats at 1: the relative error of one rounding. */
#define FL_EPSILON 0x1p-24

/* Boxes are widened by FL_BOX_PAD * (largest coordinate of the boxes) and, as a ray walks, by FL_ORIGIN_PAD *
 * (largest coordinate of its origin). A point that the triangle test accepts is off its triangle by at most 7
 * roundings of that size (subtraction and shear), the slab test and the stored planes add 5, t, its weights and
 * products 11: 23 in all, below these 32. So a cull skips only what the triangle test rejects (decision 3). */
#define FL_BOX_PAD    0x1p-19f
#define FL_ORIGIN_PAD 0x1p-19f

/** Which structure finds candidates. All give the same hits. */
typedef enum fl_accel { FL_ACCEL_BVH, FL_ACCEL_OCTREE, FL_ACCEL_NONE } fl_accel;

/* Arrays of `count` primitives, padded with never-hit entries to a multiple of 8, 64-byte aligned; `object` names
 * the scene's object of each. Entries [0, baked_count) are in world space, the rest in the space of the instance
 * that refers to them. */
typedef struct fl_spheres {
    uint32_t count, baked_count;
    float *cx, *cy, *cz, *r; /**< Candidate test. */
    fl_vec3 *center;         /**< Winner, with radius. */
    double *radius;
    uint32_t *object;
} fl_spheres;

/** Planes n . p = d with unit n. */
typedef struct fl_planes {
    uint32_t count, baked_count;
    float *nx, *ny, *nz, *d;
    fl_vec3 *normal;
    double *offset;
    uint32_t *object;
} fl_planes;

/** Parallelograms corner + a u + b v with 0 <= a, b <= 1, and disks (is_disk: a^2 + b^2 <= 1 around the corner).
 *  a = (p - corner) . ua, with ua and vb the dual basis of u and v in their plane. */
typedef struct fl_patches {
    uint32_t count, baked_count;
    float *cx, *cy, *cz;
    float *nx, *ny, *nz; /**< Unit normal. */
    float *ax, *ay, *az; /**< ua */
    float *bx, *by, *bz; /**< vb */
    fl_vec3 *corner, *normal, *dual_u, *dual_v;
    uint8_t *is_disk;
    uint32_t *object;
} fl_patches;

/** Surfaces of revolution; tested in double by the solver itself. */
typedef struct fl_revolutions {
    uint32_t count, baked_count;
    fl_revolve **profile; /**< Shared between objects of one profile. */
    fl_vec3 shift;        /**< Baked ones: add to coordinates of this space to reach the profile's. */
    fl_bvh_box *bounds;   /**< Baked ones: in this space, others in the profile's; widened by FL_BOX_PAD. */
    uint32_t *object;
} fl_revolutions;

/** Eight triangles for the watertight test, by corner, axis, place; unused places are NaN, which no ray hits. */
typedef struct fl_tri_pack {
    float corner[3][3][8];
    uint32_t face[8]; /**< FL_NONE: unused. */
} fl_tri_pack;

typedef struct fl_octree fl_octree; /* core/octree.h */

/** One mesh, stored once however many objects use it. Vertices are the file's minus `origin`, rounded to float;
 *  the winner's solution uses these same floats, exactly. Loose triangles of the scene are gathered into one mesh
 *  of their own, whose faces are objects. */
typedef struct fl_tri_mesh {
    fl_vec3 origin;        /**< Object space. */
    float *position;       /**< 3 * position_count: xyz. */
    uint32_t *index;       /**< 3 * face_count. */
    float *normal;         /**< xyz per corner normal, unit length or zero (then flat); NULL: all flat. */
    uint32_t *normal_index; /**< 3 * face_count into normal; NULL with it. */
    float *uv;             /**< u v per entry, or NULL. */
    uint32_t *uv_index;    /**< 3 * face_count, FL_NONE: none. */
    uint32_t *face_object; /**< Loose triangles: object of each face, prim is then 0. NULL for real meshes. */
    uint32_t position_count, face_count;
    float box_lo[3], box_hi[3]; /**< Relative to origin. */
    fl_tri_pack *packs; /**< BVH: one a leaf. Octree: those of each leaf in turn. None: all faces in order. */
    uint32_t pack_count;
    fl_bvh *bvh;       /**< With FL_ACCEL_BVH, else NULL. Leaves are packs; `items` is NULL. */
    fl_octree *octree; /**< With FL_ACCEL_OCTREE, else NULL. */
} fl_tri_mesh;

typedef struct fl_instance {
    fl_object_kind kind;
    uint32_t index;      /**< Into the array of its kind, or of meshes. */
    uint32_t object;     /**< FL_NONE for the mesh of loose triangles. */
    bool is_identity;    /**< Only meshes: traced in world space without a transform. */
    float to_object[12]; /**< World (relative to geometry origin) to the space of the entry; row-major 3x4. */
    fl_affine to_object_exact, to_world_exact;
    fl_bvh_box box; /**< In the space of the entry, widened by FL_BOX_PAD; unspecified for planes. */
    /** Rounding of a ray on its way into the space of the entry moves a point at p by at most
     *  FL_EPSILON * (error_gain * |p| + error_base), world units: 1 and the object's own size without a transform. */
    double error_gain, error_base;
} fl_instance;

/** Something that the hierarchy of objects, or the plain loop over objects, finds. */
typedef struct fl_entry {
    bool is_instance;
    fl_object_kind kind; /**< Of a baked entry: sphere, square (any patch) or revolution. */
    uint32_t index;      /**< Into instances, or into the array of its kind. */
} fl_entry;

/** Boxes of 8 entries, for one test by what a whole chunk of rays may reach. */
typedef struct fl_entry_boxes {
    float lo[3][8], hi[3][8];
} fl_entry_boxes;

/** With more entries than FL_OBJECT_BVH_MIN there is a hierarchy; with more than
 * FL_ENTRY_BOXES_MIN, boxes; with fewer nothing but the loop, for which a test would cost more than
 * it spares. */
enum { FL_ENTRY_BOXES_MIN = 3, FL_OBJECT_BVH_MIN = 64 };

typedef struct fl_geometry {
    fl_vec3 origin; /**< World position of this space's zero. */
    double extent;  /**< Largest absolute coordinate of bounded objects relative to origin; 1 if there are none. */
    fl_spheres spheres;
    fl_planes planes;
    fl_patches patches;
    fl_revolutions revolutions;
    fl_tri_mesh *meshes;
    fl_instance *instances; /**< Uses of meshes, then transformed objects. */
    uint32_t mesh_count, instance_count;
    uint32_t *object_entry; /**< Per scene object: index into the array of its kind (meshes: of meshes; loose
                                 triangles: face of their mesh). */
    uint32_t *object_instance; /**< Per scene object: index into instances, or FL_NONE when baked. Never FL_NONE for
                                    meshes and triangles. */
    fl_object_kind *object_kind;
    uint32_t object_count;
    fl_accel accel;
    fl_entry *entries;         /**< Bounded ones first, then transformed planes. Baked planes are not among them. */
    uint32_t entry_count, bounded_entry_count;
    fl_bvh *object_bvh;       /**< With FL_ACCEL_BVH, over the bounded entries when there are more than
                                   FL_OBJECT_BVH_MIN; items are entries. Else NULL. */
    fl_entry_boxes *entry_boxes; /**< With FL_ACCEL_BVH, of the bounded entries when there are not so many but more
                                      than FL_ENTRY_BOXES_MIN. Else NULL. */
    float entry_origin_pad;      /**< Origins are widened by this times their largest coordinate, for either. */
} fl_geometry;

#endif
