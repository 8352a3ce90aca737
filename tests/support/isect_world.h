/* SPDX-License-Identifier: MIT
 *
 * Scenes made in memory, rays and streams, for the tests of intersection. Everything is seeded.
 */
#ifndef FL_TESTS_ISECT_WORLD_H
#define FL_TESTS_ISECT_WORLD_H

#include "core/compile.h"
#include "core/stream.h"

/** splitmix64 [Steele, Lea, Flood 2014]. */
typedef struct world_random {
    uint64_t state;
} world_random;

uint64_t world_bits(world_random *random);
/** In [0, 1). */
double world_unit(world_random *random);
/** In [lo, hi). */
double world_between(world_random *random, double lo, double hi);
/** Uniform on the unit sphere. */
fl_vec3 world_direction(world_random *random);
/** Uniform in [-1, 1)^3. */
fl_vec3 world_point(world_random *random);
/** In any direction from `center`, lo to hi away. */
fl_vec3 world_around(world_random *random, fl_vec3 center, double lo, double hi);

/** A scene under construction: fixed room, one material. */
enum { WORLD_OBJECTS_MAX = 512, WORLD_MESHES_MAX = 8 };

typedef struct world {
    fl_scene scene;
    fl_object objects[WORLD_OBJECTS_MAX];
    fl_affine transforms[WORLD_OBJECTS_MAX];
    fl_material material;
    fl_scene_mesh meshes[WORLD_MESHES_MAX];
    fl_profile profiles[1];
    fl_vec3 profile_points[4];
} world;

void world_init(world *w);
/** Releases the meshes. */
void world_deinit(world *w);

/** Index of the new transform. */
uint32_t world_transform(world *w, fl_affine m);
/** Any rotation, scaled by `scale` along its axes, then moved. */
fl_affine world_affine(world_random *random, fl_vec3 scale, fl_vec3 move);

/* Each returns the object, to be given a transform or kept as it is. */
fl_object *world_sphere(world *w, fl_vec3 center, double radius);
fl_object *world_plane(world *w, fl_vec3 normal, double offset);
fl_object *world_square(world *w, fl_vec3 corner, fl_vec3 u, fl_vec3 v);
fl_object *world_disk(world *w, fl_vec3 center, fl_vec3 normal, double radius);
fl_object *world_triangle(world *w, fl_vec3 a, fl_vec3 b, fl_vec3 c);
/** A vase-like profile about the y axis, radius up to 1, height 2. */
fl_object *world_revolution(world *w);
/** Takes over the reference. Index of the mesh. */
uint32_t world_add_mesh(world *w, fl_mesh *mesh);
fl_object *world_mesh(world *w, uint32_t mesh);

/** Sphere of 20 * 4^level triangles, counter-clockwise seen from outside, corners moved outward or
 * inward by up to `roughness` of the radius, then p * scale + move. Closed: neighbours share their
 * corners by index. */
fl_mesh *world_icosphere(uint32_t level, double roughness, double scale, fl_vec3 move);
/** `count` triangles without order: corners in [-1, 1]^3 * scale + move, sides about `side`, some
 * of them needles or points. */
fl_mesh *world_soup(world_random *random, uint32_t count, double side, double scale, fl_vec3 move);

/** Compile or fail the test. */
fl_compiled *world_compile(const world *w, fl_accel accel, fl_pool *pool);

/** Rays with answers of both kinds, in one allocation each. */
typedef struct world_rays {
    fl_rays rays;
    fl_hits hits;
    uint32_t *blocked;
    fl_surface surface;
    void *memory;
} world_rays;

void world_rays_init(world_rays *r, uint32_t capacity);
void world_rays_deinit(world_rays *r);
/** Append; room is asserted. t_max is infinite, the source nothing. */
void world_ray(world_rays *r, fl_vec3 o, fl_vec3 d);
/** Fill up to the next multiple of 8 with rays that hit nothing. */
void world_rays_finish(world_rays *r);

/** Kernels of an instruction set, NULL if this build or machine has none. */
const fl_isect_kernels *world_kernels(fl_isa isa);

#endif
