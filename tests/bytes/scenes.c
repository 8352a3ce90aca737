/* SPDX-License-Identifier: MIT */
#include "bytes/scenes.h"

#define CAMERA(rest)                                                                               \
    "firstlight 1\nPerspectiveCamera { center 0.3 1.1 6 direction -0.02 -0.12 -1 up 0.1 1 0 "      \
    "angle 38 " rest "}\n"
#define SKY "Background { color 0.2 0.3 0.5 ambientLight 0.2 0.21 0.19 }\n"
#define TWO_LIGHTS                                                                                 \
    "Lights { numLights 2 DirectionalLight { direction -1 -2 -1.5 color 0.6 0.55 0.5 }\n"          \
    "PointLight { position 2 3 4 color 0.9 0.8 1.1 falloff 0.02 } }\n"
#define DISC_LIGHTS                                                                                \
    "Lights { DiskLight { position 2 4 3 direction -1 -2 -1 radius 0.9 color 1 0.9 0.8 samples 3 " \
    "falloff 0.01 }\n"                                                                             \
    "DiskLight { position -3 2 3 direction 1 -1 -1 radius 0.5 color 0.3 0.4 0.6 twoSided 0 "       \
    "attenuation 0.5 0.1 0.02 }\n"                                                                 \
    "DiskLight { position 0 5 0 direction 0 -1 0 radius 0 color 0.2 0.2 0.2 } }\n"
#define FLOOR "Square { corner -4 -1 4 u 8 0 0 v 0 0 -8 }\n"

static const char spheres[] = CAMERA("") SKY TWO_LIGHTS
    "Materials { Material { diffuseColor 0.8 0.4 0.3 specularColor 0.7 0.7 0.6 shininess 33.5 }\n"
    "Material { diffuseColor 0.2 0.5 0.9 specularColor 1 1 1 shininess 0 ambient 0.3 0.1 0.2 }\n"
    "Material { diffuseColor 1 1 1 texture checker.png textureScale 3 2 }\n"
    "Material { diffuseColor 1 0.9 -0.2 texture glow.png filter nearest } }\n"
    "Group { MaterialIndex 0 Sphere { center -1.2 0 0 radius 1 } Sphere { center 0 -101 0 radius "
    "100 }\n"
    "MaterialIndex 1 Sphere { center 0.1 -0.3 1 radius 0.7 } Sphere { center 0.2 0.6 -2 radius "
    "0.001 }\n"
    "MaterialIndex 2 Sphere { center 1.4 0.2 -0.5 radius 0.9 }\n"
    "MaterialIndex 3 Sphere { center 0.4 1.7 -0.5 radius 0.6 } Sphere { center 1.4 0.2 -0.5 radius "
    "0.9 } }\n";

static const char patches[] =
    "firstlight 1\nOrthographicCamera { center 3 4 5 direction -3 -3.5 -5 up 0 1 0 size 5 }\n" SKY
        TWO_LIGHTS "Materials { Material { texture checker.png textureScale 0.7 1.3 }\n"
    "Material { texture ramp.png filter nearest textureScale 2 -2 specularColor 1 1 1 shininess 9 "
    "}\n"
    "Material { diffuseColor 0.9 0.5 0.1 } }\n"
    "Group { MaterialIndex 0 Plane { normal 0 2 0 offset -1 } Plane { normal 1 0 2 offset -6 }\n"
    "MaterialIndex 1 Square { corner -1 -0.4 1 u 2 0 0.2 v 0.3 1.5 -0.1 } Disk { center 1.3 0.6 0 "
    "normal 1 2 3 radius 0.8 }\n"
    "MaterialIndex 2 Triangle { vertex0 -2 -0.5 0 vertex1 -1 -0.5 1 vertex2 -1.5 1.2 0.3 }\n"
    "Disk { center -0.2 1 1.2 normal 0 1 0 radius 0.4 } Square { corner 0 -0.5 0 u 0 1 0 v 0 0 1 } "
    "}\n";

static const char transforms[] = CAMERA("") SKY TWO_LIGHTS
    "Materials { Material { diffuseColor 0.7 0.7 0.3 texture checker.png } Material { diffuseColor "
    "0.3 0.8 0.9 "
    "specularColor 0.5 0.5 0.5 shininess 12 reflect 0.3 } }\n"
    "Group { MaterialIndex 0 Transform { Translate -1.3 0.2 0 ZRotate 33 Scale 1 0.5 0.7 Sphere { "
    "center 0 0 0 radius 1 } }\n"
    "Transform { Rotate { 1 2 3 77 } UniformScale -0.8 Transform { XRotate -20 YRotate 500 Square "
    "{ corner -1 -1 0 u 2 0 0 v 0 2 0 } } }\n"
    "MaterialIndex 1 Transform { Matrix4f { 1 0.2 0 0 -0.3 1 0.1 0 0 0.4 -1 0 1.5 0.1 -0.4 1 } "
    "Sphere { center 0 0 0 radius 0.8 } }\n"
    "Transform { Translate 0 -1 0 YRotate 10 Plane { normal 0.05 1 0 offset 0 } }\n"
    "Transform { Scale 1000 1000 1000 Translate 0 0.001 0.001 Disk { center 0 0 0 normal 0 1 1 "
    "radius 0.0006 } } }\n";

static const char revolutions[] = CAMERA("") SKY TWO_LIGHTS
    "Materials { Material { diffuseColor 0.9 0.8 0.7 texture checker.png specularColor 0.4 0.4 0.4 "
    "shininess 20 }\n"
    "Material { diffuseColor 0 0 0 reflect 0.1 refract 0.9 refractionIndex 1.4 } Material { "
    "diffuseColor 0.4 0.6 0.3 } }\n"
    "Group { MaterialIndex 0 Transform { Translate -1.1 -1 0 RevSurface { profile BezierCurve { "
    "piecewise 1 controls\n"
    "[0 0 0][0.4 0 0][0.9 0.3 0][0.9 0.9 0][0.9 1.5 0][0.1 1.4 0][0.3 2.2 0] } } }\n"
    "MaterialIndex 1 Transform { Translate 0.6 -0.9 1 ZRotate -12 RevSurface { texture ramp.png "
    "profile BsplineCurve { controls\n"
    "[0.1 -0.3 0][0.5 0 0][0.6 0.5 0][0.2 0.9 0][0.5 1.3 0][0.4 1.7 0] } } }\n"
    "MaterialIndex 2 Transform { Translate 1.7 0 -1 Rotate { 1 0 1 60 } Scale 1 1.2 0.8 RevSurface "
    "{ profile BezierCurve { controls\n"
    "[0.9 -0.7 0][1.3 0 0][0.2 0.4 0][0.8 0.9 0][0 1 0] } } }\n"
    "RevSurface { profile BezierCurve { controls [2 -1 0][2.5 -1 0][3 -1 0][3 -0.4 0] } } }\n";

static const char meshes[] =
    CAMERA("") SKY TWO_LIGHTS "Materials { Material { diffuseColor 0.8 0.6 0.4 texture checker.png "
                              "specularColor 0.6 0.6 0.6 shininess 40 }\n"
                              "Material { diffuseColor 0.4 0.7 0.5 texture glow.png filter nearest "
                              "} Material { diffuseColor 0.6 0.6 0.7 reflect 0.2 } }\n"
                              "Group { MaterialIndex 0 Transform { Translate -1.2 0.3 0 XRotate 60 "
                              "TriangleMesh { obj_file ring.obj normals smooth } }\n"
                              "Transform { Translate 1.2 1.3 -1 XRotate 20 Scale 0.7 -1 0.7 "
                              "TriangleMesh { obj_file ring.obj normals flat } }\n"
                              "MaterialIndex 1 Transform { Translate 1 -0.5 0.5 XRotate 25 "
                              "TriangleMesh { file bumps.obj } }\n"
                              "Transform { Translate 1.2 0.9 1 XRotate 70 UniformScale 0.6 "
                              "TriangleMesh { file bumps.obj normals angle } }\n"
                              "MaterialIndex 2 Transform { Translate -0.2 -0.8 1.5 UniformScale "
                              "0.5 TriangleMesh { file slivers.obj } }\n"
                              "TriangleMesh { file slivers.obj normals smooth } Triangle { vertex0 "
                              "-3 -1 -2 vertex1 3 -1 -2 vertex2 0 -1 3 }\n"
                              "Sphere { center 0 2 -3 radius 1 } }\n";

static const char glass[] =
    CAMERA("") "Render { depth 9 weightThreshold 0.0001 transparentShadows 1 }\n" SKY TWO_LIGHTS
               "Materials { Material { texture checker.png textureScale 1 1 reflect 0.1 } Material "
               "{ diffuseColor 0 0 0 reflect 0.9 0.85 0.8 }\n"
               "Material { diffuseColor 0 0 0 specularColor 1 1 1 shininess 300 reflect 0.1 "
               "refract 0.8 0.9 0.85 refractionIndex 1.52 }\n"
               "Material { diffuseColor 0.02 0.02 0.02 refract 0.95 refractionIndex 0.7 } Material "
               "{ diffuseColor 0 0 0 refract 1 } }\n"
               "Group { MaterialIndex 0 " FLOOR "MaterialIndex 1 Sphere { center -1.5 0 -1 radius "
                                                "1 } Square { corner -3 -1 -2 u 6 0 0 v 0 3 0.3 }\n"
               "MaterialIndex 2 Sphere { center 0.5 -0.2 1 radius 0.8 } Transform { Translate -0.8 "
               "-0.4 2 XRotate 30 UniformScale 0.5 "
               "TriangleMesh { file ring.obj normals smooth } }\n"
               "MaterialIndex 3 Sphere { center 1.7 0.3 -0.3 radius 0.7 } Sphere { center 0.5 -0.2 "
               "1 radius 0.3 }\n"
               "MaterialIndex 4 Transform { Translate 0 1.4 0 Scale 1 0.4 1 Sphere { center 0 0 0 "
               "radius 0.6 } } }\n";

#define LENS_OBJECTS                                                                               \
    "Materials { Material { texture checker.png textureScale 1 1 } Material { diffuseColor 0.7 "   \
    "0.2 0.2 "                                                                                     \
    "specularColor 0.5 0.5 0.5 shininess 50 reflect 0.1 } Material { diffuseColor 0 0 0 refract "  \
    "0.9 "                                                                                         \
    "refractionIndex 1.5 reflect 0.1 } }\n"                                                        \
    "Group { MaterialIndex 0 " FLOOR "MaterialIndex 1 Sphere { center -1 -0.2 -2 radius 0.8 } "    \
    "Sphere { center 0.2 -0.5 2 radius 0.5 } MaterialIndex 2 Sphere { center 1.2 -0.3 0.5 radius " \
    "0.7 } }\n"

static const char lens[] =
    CAMERA("aperture 0.2 focus 6 blades 6 bladeRotation 17 ") SKY DISC_LIGHTS LENS_OBJECTS;
static const char round_lens[] =
    CAMERA("aperture 0.11 focus inf exposure -1.5 ") SKY DISC_LIGHTS LENS_OBJECTS;

static const char cube[] =
    CAMERA("") "Background { color 0 0 0 ambientLight 0.3 0.3 0.3 cubeMap sky }\n" TWO_LIGHTS
               "Materials { Material { diffuseColor 0.1 0.1 0.1 reflect 0.8 } Material { "
               "diffuseColor 0 0 0 refract 0.9 refractionIndex 1.3 } }\n"
               "Group { MaterialIndex 0 Sphere { center -1 0 0 radius 1 } MaterialIndex 1 Sphere { "
               "center 1.2 0.3 0 radius 0.9 } }\n";

static const char pa1[] =
    "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 width 40 height 40 }\n"
    "Lights { numLights 2 PointLight { position 0 0 10 color 1 1 1 } DirectionalLight { direction "
    "0 -1 -1 color 0.5 0.5 0.7 } }\n"
    "Background { color 0.2 0 0.6 }\n"
    "Materials { numMaterials 2 Material { diffuseColor 0.79 0.66 0.44 specularColor 1 1 1 "
    "shininess 20 }\n"
    "Material { diffuseColor 0.1 0.5 0.9 } }\n"
    "Group { numObjects 3 MaterialIndex 0 Transform { Scale 1.5 1 1 YRotate 30 TriangleMesh { "
    "obj_file ring.obj } }\n"
    "MaterialIndex 1 Plane { normal 0 1 0.1 offset -1.2 } RevSurface { profile BsplineCurve { "
    "controls\n"
    "[ 0.2 -1 0 ] [ 0.4 -0.6 0 ] [ 0.5 0 0 ] [ 0.3 0.5 0 ] [ 0.4 1 0 ] } } }\n";

static const char m04[] =
    "OrthographicCamera { center 1 2 10 direction -0.1 -0.2 -1 up 0 1 0 size 5 }\n"
    "Lights { numLights 1 PointLight { position 0 3 2 color 1 1 1 attenuation 1 0 0.05 } }\n"
    "Background { color 0.2 0 0.6 ambientLight 0.1 0.1 0.1 }\n"
    "Materials { numMaterials 2 PhongMaterial { diffuseColor 1 0.5 0.5 specularColor 1 1 1 "
    "exponent 15\n"
    "reflectiveColor 0.2 0.2 0.2 transparentColor 0.6 0.7 0.6 indexOfRefraction 1.5 } "
    "PhongMaterial { diffuseColor 0.3 0.8 0.3 } }\n"
    "Group { numObjects 3 MaterialIndex 0 Sphere { center 0 0 0 radius 1.3 }\n"
    "Transform { Matrix { 0.7 0.7 0 0 -0.7 0.7 0 0 0 0 1 0 1.5 0.4 0.5 1 } TriangleMesh { obj_file "
    "ring.obj } }\n"
    "MaterialIndex 1 Plane { normal 0 1 0 offset -1.4 } }\n";

static const char m12[] =
    "PerspectiveCamera { center 0 0.4 7 direction 0 -0.05 -1 up 0 1 0 angle 30 }\n"
    "Lights { numLights 1 PointLight { falloff 0.05 position 1 2 4 color 1 1 1 } }\n"
    "Background { color 0 0 0 ambientLight 0.2 0.2 0.2 cubeMap sky }\n"
    "Materials { numMaterials 3 Material { diffuseColor 0.2 0.2 0.2 specularColor 0.8 0.8 0.8 "
    "shininess 30 }\n"
    "Material { diffuseColor 0 0 0 specularColor 1 1 1 shininess 90 refractionIndex 1.5 } Material "
    "{ texture checker.png } }\n"
    "Group { numObjects 3 MaterialIndex 0 Sphere { center -0.9 0.2 0 radius 0.8 }\n"
    "MaterialIndex 1 Sphere { center 0.9 0 0.5 radius 0.7 } MaterialIndex 2 Plane { normal 0 1 0 "
    "offset -0.9 } }\n";

static const char far_away[] =
    "firstlight 1\nPerspectiveCamera { center 1000000 1000000 1000006 direction 0.001 -0.15 -1 up "
    "0 1 0 angle 25 }\n" SKY "Lights { DirectionalLight { direction -1 -2 -1.5 color 1 1 1 } "
                             "PointLight { position 1000002 1000003 1000004 color 1 0.5 0.2 } }\n"
    "Materials { Material { diffuseColor 0.7 0.7 0.7 specularColor 1 1 1 shininess 1000000 } "
    "Material { diffuseColor 0.4 0.2 0.1 reflect 0.5 } }\n"
    "Group { MaterialIndex 0 Sphere { center 1000000 1000000 1000000 radius 1 } Sphere { center "
    "1000001.5 1000000 1000000 radius 0.5 }\n"
    "MaterialIndex 1 Sphere { center 1000000 0 1000000 radius 999999 } Plane { normal 0 1 0 offset "
    "999998.5 } }\n";

static const char mirrors[] =
    "firstlight 1\nPerspectiveCamera { center 0 0 0.9 direction 0.3 0.1 -1 up 0 1 0 angle 70 }\n"
    "Render { depth 20 weightThreshold 0 }\n" SKY TWO_LIGHTS
    "Materials { Material { diffuseColor 0.05 0.06 0.05 reflect 0.9 0.95 0.9 refract 0.3 "
    "refractionIndex 1.1 } Material { diffuseColor 1 0.2 0.1 } }\n"
    "Group { MaterialIndex 0 Square { corner -1 -1 -1 u 2 0 0 v 0 2 0 } Square { corner -1 -1 1 u "
    "0 2 0 v 2 0 0 } "
    "Sphere { center -0.3 -0.2 -0.3 radius 0.3 }\n"
    "MaterialIndex 1 Sphere { center 0.4 0.3 0 radius 0.2 } Plane { normal 0 1 0 offset -1 } }\n";

const test_scene test_scenes[] = {
    {.name = "spheres", .text = spheres, .width = 48, .height = 40, .samples = 4},
    {.name = "patches", .text = patches, .width = 48, .height = 36, .samples = 4},
    {.name = "transforms", .text = transforms, .width = 40, .height = 40, .samples = 4},
    {.name = "revolutions", .text = revolutions, .width = 40, .height = 32, .samples = 2},
    {.name = "newton",
     .text = revolutions,
     .width = 24,
     .height = 24,
     .samples = 1,
     .solver = FL_REVOLVE_NEWTON},
    {.name = "meshes", .text = meshes, .width = 48, .height = 40, .samples = 3},
    {.name = "glass", .text = glass, .width = 40, .height = 32, .samples = 3},
    {.name = "lens", .text = lens, .width = 40, .height = 32, .samples = 5},
    {.name = "round",
     .text = round_lens,
     .width = 40,
     .height = 32,
     .samples = 3,
     .lens_points = 2},
    {.name = "random",
     .text = lens,
     .width = 32,
     .height = 24,
     .samples = 4,
     .sampler = FL_SAMPLER_RANDOM},
    {.name = "padded",
     .text = lens,
     .width = 32,
     .height = 24,
     .samples = 4,
     .sampler = FL_SAMPLER_PADDED},
    {.name = "crop",
     .text = lens,
     .width = 300,
     .height = 200,
     .samples = 3,
     .crop = {130, 90, 37, 29}},
    {.name = "blocks", .text = lens, .width = 17, .height = 11, .samples = 35},
    {.name = "cube", .text = cube, .width = 48, .height = 32, .samples = 3},
    {.name = "pa1", .text = pa1, .width = 40, .height = 40, .samples = 2},
    {.name = "pa1_exact", .text = pa1, .width = 40, .height = 40, .samples = 1, .is_exact = true},
    {.name = "m04", .text = m04, .width = 40, .height = 40, .samples = 2},
    {.name = "m04_exact", .text = m04, .width = 40, .height = 40, .samples = 1, .is_exact = true},
    {.name = "m12", .text = m12, .width = 40, .height = 40, .samples = 2},
    {.name = "m12_exact", .text = m12, .width = 40, .height = 40, .samples = 1, .is_exact = true},
    {.name = "far_away", .text = far_away, .width = 40, .height = 32, .samples = 3},
    {.name = "mirrors", .text = mirrors, .width = 32, .height = 24, .samples = 2},
    {.name = "double_spheres",
     .text = spheres,
     .width = 32,
     .height = 24,
     .samples = 2,
     .is_double = true},
    {.name = "double_patches",
     .text = patches,
     .width = 32,
     .height = 24,
     .samples = 2,
     .is_double = true},
    {.name = "double_transforms",
     .text = transforms,
     .width = 32,
     .height = 24,
     .samples = 2,
     .is_double = true},
    {.name = "double_revolutions",
     .text = revolutions,
     .width = 24,
     .height = 20,
     .samples = 1,
     .is_double = true},
    {.name = "double_meshes",
     .text = meshes,
     .width = 32,
     .height = 24,
     .samples = 2,
     .is_double = true},
    {.name = "double_glass",
     .text = glass,
     .width = 32,
     .height = 24,
     .samples = 2,
     .is_double = true},
    {.name = "double_lens",
     .text = lens,
     .width = 32,
     .height = 24,
     .samples = 3,
     .is_double = true},
    {.name = "double_cube",
     .text = cube,
     .width = 32,
     .height = 24,
     .samples = 2,
     .is_double = true},
};
const uint32_t test_scene_count = FL_COUNT_OF(test_scenes);
