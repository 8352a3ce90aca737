/* SPDX-License-Identifier: MIT
 *
 * Layer 2: the meanings of blocks and keys, so that code can speak of them without their spelling.
 */
#ifndef FL_GRAMMAR_IDS_H
#define FL_GRAMMAR_IDS_H

/** What a block is, so that code can speak of it; FL_BLOCK_TOP is the text itself. */
typedef enum fl_block_id {
    FL_BLOCK_TOP,
    FL_BLOCK_PERSPECTIVE,
    FL_BLOCK_ORTHOGRAPHIC,
    FL_BLOCK_BACKGROUND,
    FL_BLOCK_LIGHTS,
    FL_BLOCK_DIRECTIONAL,
    FL_BLOCK_POINT,
    FL_BLOCK_DISK_LIGHT,
    FL_BLOCK_MATERIALS,
    FL_BLOCK_MATERIAL,
    FL_BLOCK_PROCEDURAL, /**< Checkerboard, Noise, Marble, Wood: known by name, not supported. */
    FL_BLOCK_GROUP,
    FL_BLOCK_TRANSFORM,
    FL_BLOCK_SPHERE,
    FL_BLOCK_PLANE,
    FL_BLOCK_SQUARE,
    FL_BLOCK_DISK,
    FL_BLOCK_TRIANGLE,
    FL_BLOCK_MESH,
    FL_BLOCK_REVOLUTION,
    FL_BLOCK_BEZIER,
    FL_BLOCK_BSPLINE,
    FL_BLOCK_RENDER,
    FL_BLOCK_VIEW,
    FL_BLOCK_COUNT
} fl_block_id;

/** What a key means; keys of several blocks may share a meaning, and two names may (obj_file and
 * file). */
typedef enum fl_key_id {
    FL_KEY_NONE,
    FL_KEY_CENTER,
    FL_KEY_DIRECTION,
    FL_KEY_UP,
    FL_KEY_ANGLE,
    FL_KEY_SIZE,
    FL_KEY_WIDTH,
    FL_KEY_HEIGHT,
    FL_KEY_APERTURE,
    FL_KEY_FOCUS,
    FL_KEY_BLADES,
    FL_KEY_BLADE_ROTATION,
    FL_KEY_EXPOSURE,
    FL_KEY_COLOR,
    FL_KEY_AMBIENT_LIGHT,
    FL_KEY_CUBE_MAP,
    FL_KEY_COUNT_OF_MEMBERS, /**< numLights, numMaterials, numObjects. */
    FL_KEY_POSITION,
    FL_KEY_FALLOFF,
    FL_KEY_ATTENUATION,
    FL_KEY_RADIUS,
    FL_KEY_SAMPLES,
    FL_KEY_TWO_SIDED,
    FL_KEY_DIFFUSE,
    FL_KEY_SPECULAR,
    FL_KEY_SHININESS,
    FL_KEY_AMBIENT,
    FL_KEY_REFLECT,
    FL_KEY_REFRACT,
    FL_KEY_REFRACTION_INDEX,
    FL_KEY_TEXTURE,
    FL_KEY_TEXTURE_SCALE,
    FL_KEY_FILTER,
    FL_KEY_BUMP,
    FL_KEY_MATERIAL_INDEX,
    FL_KEY_NORMAL,
    FL_KEY_OFFSET,
    FL_KEY_CORNER,
    FL_KEY_U,
    FL_KEY_V,
    FL_KEY_VERTEX0,
    FL_KEY_VERTEX1,
    FL_KEY_VERTEX2,
    FL_KEY_FILE,
    FL_KEY_NORMALS,
    FL_KEY_PROFILE,
    FL_KEY_CONTROLS,
    FL_KEY_PIECEWISE,
    FL_KEY_SCALE,
    FL_KEY_UNIFORM_SCALE,
    FL_KEY_TRANSLATE,
    FL_KEY_X_ROTATE,
    FL_KEY_Y_ROTATE,
    FL_KEY_Z_ROTATE,
    FL_KEY_ROTATE,
    FL_KEY_MATRIX,
    FL_KEY_DEPTH,
    FL_KEY_WEIGHT_THRESHOLD,
    FL_KEY_LIGHT_SAMPLES,
    FL_KEY_TRANSPARENT_SHADOWS,
    FL_KEY_ID_COUNT
} fl_key_id;

#endif
