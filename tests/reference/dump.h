/* SPDX-License-Identifier: MIT
 *
 * What the reference tracer knows of a scene: a flat copy of the parsed (not compiled) scene and of
 * the parameters, in types of its own. Nothing here includes the core, so the tracer cannot lean on
 * it (decision 28). Lengths in scene units, angles in radians, colours linear RGB, everything in
 * double.
 */
#ifndef REFERENCE_DUMP_H
#define REFERENCE_DUMP_H

#include <stdbool.h>
#include <stdint.h>

struct fl_scene;
struct fl_params;

/** A point, direction or colour. */
typedef struct ref_vec {
    double x, y, z;
} ref_vec;

/** A picture decoded to linear RGB, top row first. */
typedef struct ref_image {
    uint32_t width, height;
    ref_vec *texels;
} ref_image;

typedef struct ref_material {
    ref_vec diffuse, specular, ambient, reflect, refract;
    double shininess, refraction_index;
    bool has_ambient;       /**< False: the textured diffuse colour stands in. */
    const ref_image *image; /**< NULL: no texture. */
    bool is_nearest;
    double texture_scale[2]; /**< Planes: units per repeat; elsewhere repeats of u and v. */
} ref_material;

typedef enum ref_kind {
    REF_SPHERE,    /**< a: centre, radius. */
    REF_PLANE,     /**< a: normal as given, radius: offset; a . p = offset. */
    REF_SQUARE,    /**< a: corner, b and c: edges. */
    REF_DISK,      /**< a: centre, b: normal, radius. */
    REF_MESH,      /**< Also a single triangle. */
    REF_REVOLUTION /**< About the y axis. */
} ref_kind;

typedef enum ref_normals {
    REF_NORMALS_AUTO,
    REF_NORMALS_FLAT,
    REF_NORMALS_SMOOTH,
    REF_NORMALS_ANGLE,
    REF_NORMALS_FILE
} ref_normals;

typedef struct ref_triangle {
    uint32_t index[3]; /**< Positions shared between triangles have the same index. */
    ref_vec corner[3];
    bool has_file_normals, has_uv;
    ref_vec normal[3]; /**< The file's as read; the tracer replaces them by those it shades with. */
    bool is_flat;      /**< Decided by the tracer. */
    double u[3], v[3];
} ref_triangle;

enum { REF_DEGREE_MAX = 15 };

/** One Bezier segment of a profile. */
typedef struct ref_segment {
    uint32_t degree;
    double x[REF_DEGREE_MAX + 1], y[REF_DEGREE_MAX + 1];
} ref_segment;

typedef struct ref_shape {
    ref_kind kind;
    ref_material material;
    double to_world[3][4], to_object[3][4]; /**< The inverse is filled in by the tracer. */
    ref_vec a, b, c;
    double radius;
    ref_normals normals;
    ref_triangle *triangles;
    uint32_t triangle_count, position_count;
    ref_segment *segments;
    uint32_t segment_count;
    double y_min, y_max; /**< Of the profile; filled in by the tracer. */
    bool is_clockwise;   /**< Which way the profile runs round the body; likewise. */
} ref_shape;

typedef struct ref_light {
    enum { REF_DIRECTIONAL, REF_POINT, REF_DISKLIGHT } kind;
    ref_vec position, direction, color;
    double radius, attenuation[3];
    uint32_t samples; /**< At least 1; already by precedence. */
    bool is_two_sided;
} ref_light;

typedef enum ref_pixel {
    REF_PIXEL_AREA,
    REF_PIXEL_CORNER,
    REF_PIXEL_CENTER,
    REF_PIXEL_ENDS
} ref_pixel;

typedef struct ref_dump {
    uint32_t width, height;
    ref_vec eye, direction, up;
    double fov, ortho_size, aperture, focus, blade_rotation;
    uint32_t blades;
    bool is_orthographic, spans_square, has_raw_up;
    ref_pixel pixel;
    bool no_shadows, no_recursion, ungated_specular, no_normal_flip, course_cube, black_back_faces;
    bool transparent_shadows, is_random;
    uint32_t seed, depth_limit;
    double weight_threshold;
    ref_vec background, ambient;
    const ref_image *cube[6]; /**< right left up down front back; NULL without a cube map. */
    ref_image *images;
    ref_shape *shapes;
    ref_light *lights;
    uint32_t image_count, shape_count, light_count;
} ref_dump;

/** Copy `scene` and `params`. Returns NULL when memory runs out. Free with ref_dump_destroy. */
ref_dump *ref_dump_create(const struct fl_scene *scene, const struct fl_params *params);
void ref_dump_destroy(ref_dump *dump);

#endif
