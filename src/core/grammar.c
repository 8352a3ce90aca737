/* SPDX-License-Identifier: MIT */
#include "core/grammar.h"

#include <math.h>
#include <string.h>

#include "core/number.h"

const char *const fl_dialect_names[FL_DIALECT_COUNT] = {"firstlight", "pa1", "m04", "m12"};

/* Short words for the columns of the tables below. */
enum {
    FL1 = FL_IN_FIRSTLIGHT,
    OURS = FL_IN_OURS,
    M04 = FL_IN_M04,
    M12 = FL_IN_M12,
    MIT = FL_IN_MIT,
    ALL = FL_IN_ALL,
    REQ = FL_KEY_REQUIRED,
    REP = FL_KEY_REPEATS,
    ABOVE = FL_KEY_ABOVE_LO,
    FLT = FL_KEY_FLOAT
};
#define ANY -HUGE_VAL, HUGE_VAL
#define UP  HUGE_VAL

/* Rows: name, meaning, type, count, dialects, flags, range, unit, default, choices, help. */
#define NUM(name, id, count, where, flags, range, unit, standard, help)                            \
    {                                                                                              \
        name, FL_KEY_##id, FL_VALUE_NUMBERS, count, where, flags, range, unit, standard, NULL,     \
            help                                                                                   \
    }
#define TYPED(type, name, id, count, where, flags, range, unit, standard, help)                    \
    {                                                                                              \
        name, FL_KEY_##id, FL_VALUE_##type, count, where, flags, range, unit, standard, NULL, help \
    }
#define CHOICE(name, id, where, standard, choices, help)                                           \
    {                                                                                              \
        name, FL_KEY_##id, FL_VALUE_CHOICE, 1, where, 0, 0, 0, "", standard, choices, help         \
    }
#define FILENAME(name, id, where, flags, help)                                                     \
    {                                                                                              \
        name, FL_KEY_##id, FL_VALUE_PATH, 1, where, flags, 0, 0, "", NULL, NULL, help              \
    }
#define TO(lo, hi) lo, hi

#define PLACE_KEYS                                                                                 \
    NUM("center", CENTER, 3, ALL, REQ | FLT, ANY, "scene units", NULL, "the eye"),                 \
        NUM("direction", DIRECTION, 3, ALL, REQ | FLT, ANY, "", NULL,                              \
            "viewing direction, any length above 0"),                                              \
        NUM("up", UP, 3, ALL, REQ | FLT, ANY, "", NULL,                                            \
            "what is up in the picture; not along direction"),                                     \
        TYPED(INTEGER, "width", WIDTH, 1, OURS, 0, TO(1, FL_SIDE_MAX), "pixels", NULL,             \
              "size of the picture; without it the command line decides, else 640"),               \
        TYPED(INTEGER, "height", HEIGHT, 1, OURS, 0, TO(1, FL_SIDE_MAX), "pixels", NULL,           \
              "likewise"),                                                                         \
        NUM("exposure", EXPOSURE, 1, OURS, 0, TO(-64, 64), "EV", "0",                              \
            "the shown picture is multiplied by 2^exposure")
#define LENS_KEYS                                                                                  \
    NUM("aperture", APERTURE, 1, OURS, FLT, TO(0, UP), "scene units", "0",                         \
        "radius of the lens; 0 is a pinhole"),                                                     \
        NUM("focus", FOCUS, 1, OURS, ABOVE | FL_KEY_TAKES_INF, TO(0, UP), "scene units", "inf",    \
            "distance of the plane in focus, along direction"),                                    \
        TYPED(INTEGER, "blades", BLADES, 1, OURS, 0, TO(0, 9), "", "0",                            \
              "sides of the aperture polygon, 3 to 9; 0 is round"),                                \
        NUM("bladeRotation", BLADE_ROTATION, 1, OURS, 0, TO(-1e6, 1e6), "degrees", "0",            \
            "turn of that polygon")
#define ANGLE_RANGE TO(FL_FOV_MIN_DEG, FL_FOV_MAX_DEG)

static const fl_key perspective_keys[] = {
    PLACE_KEYS,
    NUM("angle", ANGLE, 1, ALL, REQ, ANGLE_RANGE, "degrees", NULL, "full vertical field of view"),
    LENS_KEYS,
};

static const fl_key orthographic_keys[] = {
    PLACE_KEYS,
    NUM("size", SIZE, 1, ALL, REQ | ABOVE | FLT, TO(0, UP), "scene units", NULL,
        "height of what is seen"),
};

static const fl_key view_keys[] = {
    PLACE_KEYS,
    NUM("angle", ANGLE, 1, ALL, 0, ANGLE_RANGE, "degrees", NULL,
        "full vertical field of view; this or size must be given"),
    NUM("size", SIZE, 1, ALL, ABOVE | FLT, TO(0, UP), "scene units", NULL,
        "height of what is seen, for an orthographic view"),
    LENS_KEYS,
};

static const fl_key background_keys[] = {
    NUM("color", COLOR, 3, ALL, FLT, ANY, "linear RGB", "0.5 0.5 0.5",
        "what a ray that hits nothing sees"),
    NUM("ambientLight", AMBIENT_LIGHT, 3, ALL, FLT, ANY, "linear RGB", "0 0 0",
        "light that comes from everywhere; in the MIT dialects 1 1 1 when there are no lights"),
    FILENAME("cubeMap", CUBE_MAP, OURS | M12, 0,
             "folder with the pictures right left up down front back, seen instead of the color"),
};

#define COUNT_KEY(name, most)                                                                      \
    TYPED(INTEGER, name, COUNT_OF_MEMBERS, 1, ALL, 0, TO(0, most), "", NULL,                       \
          "how many follow; a wrong count is an error")

static const fl_key lights_keys[] = {COUNT_KEY("numLights", FL_LIGHTS_MAX)};
static const fl_key materials_keys[] = {COUNT_KEY("numMaterials", FL_MATERIALS_MAX)};
static const fl_key group_keys[] = {
    COUNT_KEY("numObjects", FL_OBJECTS_MAX),
    TYPED(INTEGER, "MaterialIndex", MATERIAL_INDEX, 1, ALL, REP, TO(0, FL_MATERIALS_MAX), "", NULL,
          "material of every following object, to the end of the text and across groups; from 0"),
};

#define LIGHT_COLOR                                                                                \
    NUM("color", COLOR, 3, ALL, REQ | FLT, ANY, "linear RGB", NULL,                                \
        "what it sends out; may exceed 1")
#define FADE_KEYS                                                                                  \
    NUM("falloff", FALLOFF, 1, OURS, 0, TO(0, UP), "1/unit^2", "0",                                \
        "k of color / (1 + k d^2) at the distance d"),                                             \
        NUM("attenuation", ATTENUATION, 3, OURS | M04, 0, TO(0, UP), "", "1 0 0",                  \
            "c l q of color / (c + l d + q d^2), instead of falloff; not all 0")

static const fl_key directional_keys[] = {
    NUM("direction", DIRECTION, 3, ALL, REQ, ANY, "", NULL, "from the light into the scene"),
    LIGHT_COLOR,
};

static const fl_key point_keys[] = {
    NUM("position", POSITION, 3, ALL, REQ, ANY, "scene units", NULL, "where it is"),
    LIGHT_COLOR,
    FADE_KEYS,
    NUM("falloff", FALLOFF, 1, M12, 0, TO(0, UP), "1/unit^2", "0",
        "k of color / (k d^2); 0: no falloff"),
};

static const fl_key disk_light_keys[] = {
    NUM("position", POSITION, 3, OURS, REQ, ANY, "scene units", NULL, "centre of the disc"),
    NUM("direction", DIRECTION, 3, OURS, REQ, ANY, "", NULL, "the way it faces"),
    NUM("radius", RADIUS, 1, OURS, REQ, TO(0, UP), "scene units", NULL, "0 is a point light"),
    LIGHT_COLOR,
    FADE_KEYS,
    TYPED(INTEGER, "samples", SAMPLES, 1, OURS, 0, TO(1, 1 << 20), "", NULL,
          "shadow rays per hit; else the Render block decides, else 1"),
    CHOICE("twoSided", TWO_SIDED, OURS, "1", "0 1", "whether the back of the disc shines too"),
};

static const fl_key material_keys[] = {
    NUM("diffuseColor", DIFFUSE, 3, ALL, FLT, ANY, "", "1 1 1", "weight of light scattered evenly"),
    NUM("specularColor", SPECULAR, 3, ALL, FLT, ANY, "", "0 0 0",
        "weight of the highlight; in m12 of reflected rays too"),
    NUM("shininess", SHININESS, 1, OURS | M12, FLT, TO(0, UP), "", "0",
        "exponent of the highlight"),
    TYPED(COLOR, "ambient", AMBIENT, 3, OURS, FLT, ANY, "", NULL,
          "weight of the ambient light; without it the diffuse colour, texture included"),
    TYPED(COLOR, "reflect", REFLECT, 3, OURS, FLT, ANY, "", "0 0 0", "weight of the reflected ray"),
    TYPED(COLOR, "refract", REFRACT, 3, OURS, FLT, ANY, "", "0 0 0", "weight of the refracted ray"),
    NUM("refractionIndex", REFRACTION_INDEX, 1, OURS, FLT | ABOVE, TO(0, UP), "", "1",
        "index of refraction inside; outside is 1"),
    FILENAME("texture", TEXTURE, OURS | M12, 0, "picture that multiplies the diffuse colour"),
    NUM("textureScale", TEXTURE_SCALE, 2, OURS, FLT, ANY, "", "1 1",
        "planes: scene units per repeat; elsewhere repeats along u and v; not 0"),
    CHOICE("filter", FILTER, OURS, "bilinear", "bilinear nearest", "how texels are joined"),
    NUM("refractionIndex", REFRACTION_INDEX, 1, M12, FLT, TO(0, UP), "", "0", "0 is opaque"),
    FILENAME("bump", BUMP, M12, FL_KEY_IGNORED, "read and ignored, as the course does"),
    NUM("exponent", SHININESS, 1, M04, FLT, TO(0, UP), "", "1", "exponent of the highlight"),
    NUM("reflectiveColor", REFLECT, 3, M04, FLT, ANY, "", "0 0 0", "weight of the reflected ray"),
    NUM("transparentColor", REFRACT, 3, M04, FLT, ANY, "", "0 0 0", "weight of the refracted ray"),
    NUM("indexOfRefraction", REFRACTION_INDEX, 1, M04, FLT | ABOVE, TO(0, UP), "", "1",
        "index of refraction inside"),
};

static const fl_key transform_keys[] = {
    NUM("Translate", TRANSLATE, 3, ALL, REP, ANY, "scene units", NULL, "move"),
    NUM("Scale", SCALE, 3, ALL, REP, ANY, "", NULL, "scale along the axes; not 0"),
    NUM("UniformScale", UNIFORM_SCALE, 1, ALL, REP, ANY, "", NULL, "scale evenly; not 0"),
    NUM("XRotate", X_ROTATE, 1, ALL, REP, TO(-1e9, 1e9), "degrees", NULL, "turn about the x axis"),
    NUM("YRotate", Y_ROTATE, 1, ALL, REP, TO(-1e9, 1e9), "degrees", NULL, "turn about the y axis"),
    NUM("ZRotate", Z_ROTATE, 1, ALL, REP, TO(-1e9, 1e9), "degrees", NULL, "turn about the z axis"),
    TYPED(BRACED, "Rotate", ROTATE, 4, ALL, REP, ANY, "", NULL, "axis and degrees"),
    TYPED(BRACED, "Matrix4f", MATRIX, 16, ALL, REP, ANY, "", NULL,
          "column after column; multiplied from the left, unlike the others; last row 0 0 0 1"),
    TYPED(BRACED, "Matrix", MATRIX, 16, MIT, REP, ANY, "", NULL, "the same"),
};

static const fl_key sphere_keys[] = {
    NUM("center", CENTER, 3, ALL, REQ, ANY, "scene units", NULL, "its middle"),
    NUM("radius", RADIUS, 1, ALL, REQ | ABOVE, TO(0, UP), "scene units", NULL, "its radius"),
};

static const fl_key plane_keys[] = {
    NUM("normal", NORMAL, 3, ALL, REQ, ANY, "", NULL, "any length above 0"),
    NUM("offset", OFFSET, 1, ALL, REQ, ANY, "", NULL, "the plane is normal . p = offset"),
};

static const fl_key square_keys[] = {
    NUM("corner", CORNER, 3, OURS, REQ, ANY, "scene units", NULL, "one corner"),
    NUM("u", U, 3, OURS, REQ, ANY, "scene units", NULL, "edge from there, along the texture's u"),
    NUM("v", V, 3, OURS, REQ, ANY, "scene units", NULL, "other edge, along the texture's v"),
};

static const fl_key disk_keys[] = {
    NUM("center", CENTER, 3, OURS, REQ, ANY, "scene units", NULL, "its middle"),
    NUM("normal", NORMAL, 3, OURS, REQ, ANY, "", NULL, "any length above 0"),
    NUM("radius", RADIUS, 1, OURS, REQ | ABOVE, TO(0, UP), "scene units", NULL, "its radius"),
};

static const fl_key triangle_keys[] = {
    NUM("vertex0", VERTEX0, 3, ALL, REQ, ANY, "scene units", NULL, "first corner"),
    NUM("vertex1", VERTEX1, 3, ALL, REQ, ANY, "scene units", NULL, "second corner"),
    NUM("vertex2", VERTEX2, 3, ALL, REQ, ANY, "scene units", NULL,
        "third corner; counter-clockwise is the front"),
};

static const fl_key mesh_keys[] = {
    FILENAME("obj_file", FILE, ALL, REQ, "OBJ, PLY, STL or glTF"),
    FILENAME("file", FILE, OURS, REQ, "the same by another name"),
    CHOICE("normals", NORMALS, OURS, "auto", "auto flat smooth angle file",
           "vertex normals: the file's if it has them, else smooth; one a face; mean of the "
           "faces'; mean "
           "weighted by angle; the file's. In pa1 and m04 the default is flat"),
};

static const fl_key revolution_keys[] = {
    TYPED(NOTHING, "profile", PROFILE, 0, OURS, REQ, ANY, "", NULL,
          "a curve with z = 0 follows; it is turned about the y axis"),
    FILENAME("texture", TEXTURE, OURS, 0, "picture in place of the material's"),
};

static const fl_key bezier_keys[] = {
    TYPED(POINTS, "controls", CONTROLS, 3, OURS, REQ, ANY, "scene units", NULL,
          "2 to 16 points of one curve; in pa1 3k+1 points, at least 4"),
    CHOICE("piecewise", PIECEWISE, FL1, "0", "0 1",
           "1: 3k+1 points are k cubic curves end to end, in any number"),
};

static const fl_key bspline_keys[] = {
    TYPED(POINTS, "controls", CONTROLS, 3, OURS, REQ, ANY, "scene units", NULL,
          "at least 4 points; uniform and cubic, does not reach its end points"),
};

static const fl_key render_keys[] = {
    TYPED(INTEGER, "samples", SAMPLES, 1, OURS, 0, TO(1, 1 << 24), "per pixel", NULL,
          "when to stop; else 64 without a window"),
    TYPED(INTEGER, "depth", DEPTH, 1, OURS, 0, TO(0, 64), "bounces", NULL,
          "reflections and refractions in a row; else 5"),
    NUM("weightThreshold", WEIGHT_THRESHOLD, 1, OURS, 0, TO(0, 1), "", NULL,
        "a branch of lower weight ends; 0: never; else 1/1024"),
    TYPED(INTEGER, "lightSamples", LIGHT_SAMPLES, 1, OURS, 0, TO(1, 1 << 20), "", NULL,
          "shadow rays per hit for disc lights that do not say; else 1"),
    CHOICE("transparentShadows", TRANSPARENT_SHADOWS, OURS, "0", "0 1",
           "whether refracting surfaces let light through, unbent, times refract"),
    CHOICE("filter", FILTER, OURS, "box", "box", "reconstruction filter of the picture"),
};

#define IN(block)   (1u << FL_BLOCK_##block)
#define TABLE(keys) keys, FL_COUNT_OF(keys)
#define NO_KEYS     NULL, 0
enum {
    OBJECT_PARENTS = IN(GROUP) | IN(TRANSFORM),
    ONCE_CAMERA = 1,
    ONCE_BACKGROUND,
    ONCE_LIGHTS,
    ONCE_MATERIALS,
    ONCE_GROUP,
    ONCE_RENDER
};
#define OBJECT(name, id, where, keys, help)                                                        \
    {                                                                                              \
        name, FL_BLOCK_##id, where, 0, false, OBJECT_PARENTS, keys, help                           \
    }
#define PROCEDURAL(name)                                                                           \
    {                                                                                              \
        name, FL_BLOCK_PROCEDURAL, M04, 0, false, IN(MATERIALS), NO_KEYS,                          \
            "not supported; --lenient takes the first material it refers to"                       \
    }

const fl_block fl_grammar_blocks[] = {
    {"scene", FL_BLOCK_TOP, ALL, 0, false, 0, NO_KEYS, "the text as a whole"},
    {"PerspectiveCamera", FL_BLOCK_PERSPECTIVE, ALL, ONCE_CAMERA, false, IN(TOP),
     TABLE(perspective_keys), "pinhole or thin-lens camera"},
    {"OrthographicCamera", FL_BLOCK_ORTHOGRAPHIC, ALL, ONCE_CAMERA, false, IN(TOP),
     TABLE(orthographic_keys), "camera with parallel rays"},
    {"View", FL_BLOCK_VIEW, OURS, 0, true, IN(TOP), TABLE(view_keys), "a named camera: a bookmark"},
    {"Render", FL_BLOCK_RENDER, OURS, ONCE_RENDER, false, IN(TOP), TABLE(render_keys),
     "how to render, where the command line says nothing"},
    {"Background", FL_BLOCK_BACKGROUND, ALL, ONCE_BACKGROUND, false, IN(TOP),
     TABLE(background_keys), "what surrounds the scene"},
    {"Lights", FL_BLOCK_LIGHTS, ALL, ONCE_LIGHTS, false, IN(TOP), TABLE(lights_keys), "all lights"},
    {"DirectionalLight", FL_BLOCK_DIRECTIONAL, ALL, 0, false, IN(LIGHTS), TABLE(directional_keys),
     "light from one direction, as from the sun"},
    {"PointLight", FL_BLOCK_POINT, ALL, 0, false, IN(LIGHTS), TABLE(point_keys),
     "light from a point"},
    {"DiskLight", FL_BLOCK_DISK_LIGHT, OURS, 0, false, IN(LIGHTS), TABLE(disk_light_keys),
     "light from a disc, which itself is not seen: soft shadows"},
    {"Materials", FL_BLOCK_MATERIALS, ALL, ONCE_MATERIALS, false, IN(TOP), TABLE(materials_keys),
     "all materials; they are numbered from 0"},
    {"Material", FL_BLOCK_MATERIAL, ALL, 0, false, IN(MATERIALS), TABLE(material_keys),
     "a material"},
    {"PhongMaterial", FL_BLOCK_MATERIAL, ALL, 0, false, IN(MATERIALS), TABLE(material_keys),
     "the same by another name"},
    PROCEDURAL("Checkerboard"),
    PROCEDURAL("Marble"),
    PROCEDURAL("Wood"),
    PROCEDURAL("Noise"),
    {"Noise", FL_BLOCK_PROCEDURAL, M12, 0, false, IN(MATERIAL), NO_KEYS,
     "not supported; --lenient takes its first colour"},
    {"Group", FL_BLOCK_GROUP, ALL, ONCE_GROUP, false, IN(TOP) | OBJECT_PARENTS, TABLE(group_keys),
     "objects, and the material they take"},
    OBJECT("Transform", TRANSFORM, ALL, TABLE(transform_keys),
           "one object, moved: the transform written last is applied first"),
    OBJECT("Sphere", SPHERE, ALL, TABLE(sphere_keys), "a sphere"),
    OBJECT("Plane", PLANE, ALL, TABLE(plane_keys), "an infinite plane"),
    OBJECT("Square", SQUARE, OURS, TABLE(square_keys), "a parallelogram"),
    OBJECT("Disk", DISK, OURS, TABLE(disk_keys), "a disc"),
    OBJECT("Triangle", TRIANGLE, ALL, TABLE(triangle_keys), "a triangle"),
    OBJECT("TriangleMesh", MESH, ALL, TABLE(mesh_keys), "triangles from a file"),
    OBJECT("RevSurface", REVOLUTION, OURS, TABLE(revolution_keys), "a surface of revolution"),
    {"BezierCurve", FL_BLOCK_BEZIER, OURS, 0, false, IN(REVOLUTION) | OBJECT_PARENTS,
     TABLE(bezier_keys), "a curve; as an object of its own it is never seen"},
    {"BsplineCurve", FL_BLOCK_BSPLINE, OURS, 0, false, IN(REVOLUTION) | OBJECT_PARENTS,
     TABLE(bspline_keys), "likewise"},
};
const uint32_t fl_grammar_block_count = FL_COUNT_OF(fl_grammar_blocks);
