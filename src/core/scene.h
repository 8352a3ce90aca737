/* SPDX-License-Identifier: MIT
 *
 * Layer 2: a parsed scene: plain arrays with index handles, a place in the text for everything.
 * Groups and nested transforms are already resolved to one transform per object; nothing is
 * otherwise computed. Units: scene units for lengths, degrees for angles as in the text, linear RGB
 * for colours.
 */
#ifndef FL_SCENE_H
#define FL_SCENE_H

#include "core/arena.h"
#include "core/diag.h"
#include "core/image.h"
#include "core/mesh.h"
#include "core/vec.h"

/** Coordinates beyond this are refused: squares and their products with directions must stay finite
 * floats. */
#define FL_COORDINATE_MAX 1e18

/** Which course's rules a text follows (scene-format: families). */
typedef enum fl_dialect {
    FL_DIALECT_FIRSTLIGHT, /**< Ours, version 1. */
    FL_DIALECT_PA1,        /**< Tsinghua 2020 on, with the curves of PA2. */
    FL_DIALECT_M04,        /**< MIT 6.837, 2004. */
    FL_DIALECT_M12,        /**< MIT 6.837, 2010 to 2016. */
    FL_DIALECT_COUNT
} fl_dialect;

enum { FL_SIDE_MAX = 16384 }; /**< Largest width or height of a picture, pixels. */
/** Least and largest field of view, degrees. */
#define FL_FOV_MIN_DEG 0.01
#define FL_FOV_MAX_DEG 179.0

typedef enum fl_projection { FL_PERSPECTIVE, FL_ORTHOGRAPHIC } fl_projection;

/** Camera with its lens: lens values belong to the camera, so bookmarks and snapshots carry them.
 */
typedef struct fl_camera {
    fl_projection projection;
    fl_vec3 center;
    fl_vec3 direction; /**< Any length above 0. */
    fl_vec3 up;        /**< Re-orthogonalised against `direction`; must not be parallel to it. */
    double fov_deg;    /**< Vertical, full angle, FL_FOV_MIN_DEG to FL_FOV_MAX_DEG. */
    double ortho_size; /**< Orthographic: height of the view, scene units. */
    double aperture;   /**< Lens radius, scene units, >= 0; 0 is a pinhole. */
    double focus;      /**< Distance of the focus plane along `direction`, > 0 or +inf. */
    uint32_t blades;   /**< Aperture polygon, 3 to 9 sides; 0 is round. */
    double blade_rotation_deg;
    double exposure_ev;     /**< Display only: the picture is multiplied by 2^EV. */
    uint32_t width, height; /**< Pixels; 0: the scene has no size. */
} fl_camera;

typedef enum fl_light_kind { FL_LIGHT_DIRECTIONAL, FL_LIGHT_POINT, FL_LIGHT_DISK } fl_light_kind;

typedef struct fl_light {
    fl_light_kind kind;
    fl_vec3 position;      /**< Point, disk. */
    fl_vec3 direction;     /**< Directional: from the light into the scene. Disk: its normal. Unit
                              length. */
    double radius;         /**< Disk; 0 casts one exact ray. */
    fl_vec3 color;         /**< Radiant intensity; may be negative or above 1. */
    double attenuation[3]; /**< Divide the colour by a0 + a1 d + a2 d^2; {1, 0, 0} is none. */
    uint32_t samples;      /**< Disk: shadow rays per hit; 0: not given. */
    bool is_two_sided;     /**< Disk. */
    fl_loc loc;
} fl_light;

typedef enum fl_filter { FL_FILTER_BILINEAR, FL_FILTER_NEAREST } fl_filter;

typedef struct fl_material {
    fl_vec3 diffuse;  /**< Default 1 1 1. */
    fl_vec3 specular; /**< Phong lobe; default 0. */
    double shininess; /**< Phong exponent, >= 0. */
    fl_vec3 ambient;  /**< Multiplies the ambient light; default: diffuse. */
    bool has_ambient; /**< False: `ambient` is unset and diffuse (with texture) stands in. */
    fl_vec3 reflect, refract; /**< Weights of the two branches of the ray tree; 0: none. */
    double refraction_index;  /**< > 0; 1 outside. */
    uint32_t image; /**< Texture that multiplies diffuse: index into images, or FL_NONE. */
    fl_filter filter;
    double texture_scale[2]; /**< Planes: scene units per repeat; elsewhere repeats of u and v.
                                Default 1 1. */
    fl_loc loc;
} fl_material;

typedef enum fl_object_kind {
    FL_OBJECT_SPHERE,
    FL_OBJECT_PLANE,
    FL_OBJECT_SQUARE,
    FL_OBJECT_DISK,
    FL_OBJECT_TRIANGLE,
    FL_OBJECT_MESH,
    FL_OBJECT_REVOLUTION,
    FL_OBJECT_KIND_COUNT
} fl_object_kind;

typedef struct fl_object {
    fl_object_kind kind;
    uint32_t material;  /**< Index into materials. */
    uint32_t transform; /**< Index into transforms: object to world; FL_NONE is the identity. */
    union {
        struct {
            fl_vec3 center;
            double radius; /**< > 0 */
        } sphere;
        struct {
            fl_vec3 normal; /**< As given, not unit: the plane is normal . p = offset. Not zero. */
            double offset;
        } plane;
        struct {
            fl_vec3 corner, u, v; /**< Parallelogram corner + a u + b v, a and b in [0, 1]. */
        } square;
        struct {
            fl_vec3 center, normal; /**< normal: any length above 0. */
            double radius;
        } disk;
        struct {
            fl_vec3 vertex[3]; /**< Counter-clockwise seen from the front. */
        } triangle;
        struct {
            uint32_t mesh; /**< Index into meshes. */
            fl_normals normals;
        } mesh;
        struct {
            uint32_t profile; /**< Index into profiles. */
            uint32_t image;   /**< Overrides the material's texture, or FL_NONE. */
        } revolution;
    } as;
    fl_loc loc;
} fl_object;

/** A planar curve in the half plane of a surface of revolution about the y axis, as `segment_count`
 *  Bezier segments of equal degree in order: segment i has points[i*(degree+1)] to
 * points[i*(degree+1)+degree]. B-splines are converted when parsed. Only x and y of the points
 * count (z is 0). */
typedef struct fl_profile {
    fl_vec3 *points; /**< segment_count * (degree + 1); in the scene's arena. */
    uint32_t segment_count, degree;
    fl_loc loc;
} fl_profile;

typedef struct fl_scene_mesh {
    const char *path; /**< As resolved, for reports and reloading. */
    fl_mesh *mesh;    /**< A reference, or NULL if it could not be read (an error was reported). */
    fl_loc loc;
} fl_scene_mesh;

typedef struct fl_scene_image {
    const char *path;
    fl_image *image; /**< A reference, or NULL as above. */
    fl_loc loc;
} fl_scene_image;

/** Values of a `Render` block; a flag says which were given. */
typedef struct fl_render_block {
    uint32_t samples, depth, light_samples;
    double weight_threshold;
    bool has_samples, has_depth, has_light_samples, has_weight_threshold;
    bool has_transparent_shadows, transparent_shadows;
    fl_loc loc;
} fl_render_block;

typedef struct fl_view {
    const char *name;
    fl_camera camera;
    fl_loc loc;
} fl_view;

/** Order of cube-map faces. */
enum {
    FL_CUBE_RIGHT,
    FL_CUBE_LEFT,
    FL_CUBE_UP,
    FL_CUBE_DOWN,
    FL_CUBE_FRONT,
    FL_CUBE_BACK,
    FL_CUBE_FACES
};

typedef struct fl_background {
    fl_vec3 color; /**< What a ray that hits nothing returns. Default 0.5 in the course dialects. */
    fl_vec3 ambient;                    /**< Ambient light; default 0. */
    uint32_t cube_image[FL_CUBE_FACES]; /**< Indices into images; all FL_NONE without a cube map. */
    fl_loc loc;
} fl_background;

/** Everything a text says. Immutable after parsing; one owner; arrays live in `arena`. */
typedef struct fl_scene {
    fl_arena arena;
    const char *path; /**< Name given to the parser; also what every fl_loc.file here points to. */
    fl_dialect dialect;
    const char
        *dialect_reason; /**< Why the text was taken for that dialect; a sentence for `info`. */
    fl_camera camera;
    bool has_camera;
    fl_background background;
    fl_render_block render;
    fl_light *lights;
    fl_material *materials;
    fl_object *objects;
    fl_affine *transforms;
    fl_profile *profiles;
    fl_scene_mesh *meshes;
    fl_scene_image *images;
    fl_view *views;
    uint32_t light_count, material_count, object_count, transform_count;
    uint32_t profile_count, mesh_count, image_count, view_count;
} fl_scene;

/** Free the scene, its arena and its references; NULL is allowed. */
void fl_scene_destroy(fl_scene *scene);

#endif
