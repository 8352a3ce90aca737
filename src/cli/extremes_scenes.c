/* SPDX-License-Identifier: MIT
 *
 * The rows of `study --extremes`. Bounds are not wishes: each is a few times what was measured when
 * it was set, at least 1e-6 and two pixels, and stands at the value that needs it where it is far
 * from rounding.
 */
#include "cli/extremes.h"

#define VALUES(...)                                                                                \
    (const char *const[])                                                                          \
    {                                                                                              \
        __VA_ARGS__, NULL                                                                          \
    }
#define HEAD   "firstlight 1\n"
#define SKY    "Background { color 0.2 0.3 0.5 ambientLight 0.1 0.1 0.12 }\n"
#define CAMERA "PerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 1 0 angle 40 }\n"
#define SUN    "Lights { DirectionalLight { direction -1 -2 -1.5 color 0.8 0.8 0.7 } }\n"
#define FLOOR  "Plane { normal 0 1 0 offset -1 }\n"
#define BALLS  "Sphere { center -1.2 0 0 radius 1 } Sphere { center 1.3 -0.3 0.8 radius 0.7 }\n"

#define LIGHTS                                                                                     \
    "Lights { PointLight { position 3 5 4 color 0.6 0.6 0.6 }\n"                                   \
    "DiskLight { position -3 4 2 direction 1 -1.3 -0.7 radius 0.5 color 0.6 0.6 0.5 attenuation "  \
    "0.6 0.05 0.01 } }\n"

#define MATERIALS                                                                                  \
    "Materials { Material { texture checker.png textureScale 2 2 }\n"                              \
    "Material { diffuseColor 0.7 0.3 0.2 specularColor 0.6 0.6 0.6 shininess 40 }\n"               \
    "Material { diffuseColor 0.05 0.05 0.05 reflect 0.9 }\n"                                       \
    "Material { diffuseColor 0 0 0 reflect 0.1 refract 0.85 refractionIndex 1.5 } }\n"

/* Every kind of object, of material and of light, a lens, textures: some ten units wide; and more.
 */
#define WORLD(more)                                                                                \
    HEAD "PerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 1 0 angle 40 "        \
         "aperture 0.02 focus 7 }\n" SKY LIGHTS MATERIALS                                          \
         "Group { MaterialIndex 0 Plane { normal 0 1 0 offset -1 }\n"                              \
         "MaterialIndex 1 Sphere { center -1.6 -0.2 0 radius 0.8 }\n"                              \
         "MaterialIndex 2 Sphere { center 0.2 -0.1 -1.5 radius 0.9 }\n"                            \
         "MaterialIndex 3 Sphere { center 0.9 -0.4 1.5 radius 0.6 }\n"                             \
         "MaterialIndex 1 Square { corner -4 -1 -4 u 8 0 0 v 0 3 0 }\n"                            \
         "Disk { center -2.6 0.6 -1 normal 1 0.2 1 radius 0.6 }\n"                                 \
         "Triangle { vertex0 2.2 -1 -1 vertex1 3.2 -1 -1 vertex2 2.7 0.8 -1.2 }\n"                 \
         "MaterialIndex 0 Transform { Translate 1.9 -0.4 0 TriangleMesh { file ball.obj } }\n"     \
         "MaterialIndex 1 Transform { Translate -0.5 -1 1.2 UniformScale 0.5 RevSurface { "        \
         "profile "                                                                                \
         "BezierCurve { controls [0.1 0 0][1.2 0.3 0][0 1.2 0][0.8 1.6 0] } } } " more "}\n"

/* Two balls on a floor; the middle says what is between. */
#define STAGE(camera, lights, material)                                                            \
    HEAD camera SKY lights "Materials { Material { diffuseColor 0.7 0.7 0.7 } " material           \
                           " }\nGroup { MaterialIndex 0 " FLOOR "MaterialIndex 1 " BALLS "}\n"
#define SHEET                                                                                      \
    HEAD "PerspectiveCamera { center 0.2 0.1 4 direction 0 0 -1 up 0 1 0 angle 40 }\n" SKY SUN     \
         "Materials { Material { texture checker.png filter @1 ambient 0.5 0.5 0.5 } }\n"          \
         "Group { MaterialIndex 0 TriangleMesh { file sheet@0.obj } }\n"
#define RED "Material { diffuseColor 0.7 0.3 0.2 specularColor 0.5 0.5 0.5 shininess 30 }"

const extreme_family extreme_families[] = {
    /* --- Whole scenes --- */
    {.name = "scene scaled",
     .text = WORLD(""),
     .values = VALUES("1e-6", "1e-4", "1e-2", "1e2", "1e4", "1e6"),
     .judge = EXTREME_SCALED,
     .bound = 0.0002,
     .off_max = 6},
    {.name = "scene moved, x size",
     .text = WORLD(""),
     .values = VALUES("1e3", "1e5", "1e7"),
     .judge = EXTREME_MOVED,
     .bound = 0.0002,
     .off_max = 6},
    /* A ball below the floor keeps the origin of floats away from what is seen. */
    {.name = "far from something else, x size",
     .text = WORLD("Sphere { center @1 @1 @1 radius @2 }"),
     .values = VALUES("10|-200|1#12 2e-4", "100|-2000|10#72 6e-4"),
     .judge = EXTREME_MOVED,
     .bound = 0.0002,
     .off_max = 6},
    {.name = "the same, floats warned, in double",
     .text = WORLD("Sphere { center @1 @1 @1 radius @2 }"),
     .values = VALUES("1e3|-2e4|1e2", "1e4|-2e5|1e3", "1e5|-2e6|1e4", "1e6|-2e7|1e5"),
     .judge = EXTREME_WARNED,
     .off_max = 2},
    /* --- Spheres --- */
    {.name = "sphere radius",
     .text = HEAD "PerspectiveCamera { center 0 @1 @2 direction 0 -0.35 -1 up 0 1 0 angle 40 "
                  "}\n" SKY SUN "Materials { " RED " }\nGroup { MaterialIndex 0 Sphere { center 0 "
                  "0 0 radius @0 } }\n",
     .values = VALUES("1e-6|1.5e-6|4e-6", "=1e-3|1.5e-3|4e-3", "=1|1.5|4", "=1e3|1.5e3|4e3",
                      "=1e6|1.5e6|4e6", "=1e8|1.5e8|4e8"),
     .off_max = 2},
    {.name = "sphere seen from, radii",
     .text = HEAD "PerspectiveCamera { center 0 0 @0 direction 0 0 -1 up 0 1 0 angle @1 }\n" SKY SUN
                  "Materials { " RED " }\nGroup { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } "
                  "}\n",
     .values = VALUES("1e2|1.5", "1e3|0.15", "1e4|0.015"),
     .off_max = 2},
    {.name = "5 above a sphere of radius",
     .text =
         HEAD "PerspectiveCamera { center 0 5 12 direction 0 -0.4 -1 up 0 1 0 angle 40 }\n" SKY SUN
              "Materials { Material { diffuseColor 0.7 0.7 0.7 } " RED " }\nGroup { "
              "MaterialIndex 0 Sphere { center 0 -@0 0 radius @0 } MaterialIndex 1 Sphere { "
              "center 0 1 0 radius 1 } }\n",
     .values = VALUES("1e2", "1e3", "1e4", "1e5", "1e6"),
     .off_max = 2},
    {.name = "mirror ball on a ball of radius",
     .text =
         HEAD "PerspectiveCamera { center 0 5 12 direction 0 -0.4 -1 up 0 1 0 angle 40 }\n" SKY SUN
              "Materials { Material { diffuseColor 0.5 0.5 0.5 reflect 0.4 } Material { "
              "diffuseColor 0 0 0 reflect 0.9 } }\nGroup { "
              "MaterialIndex 0 Sphere { center 0 -@0 0 radius @0 } MaterialIndex 1 Sphere { "
              "center 0 1 0 radius 1 } }\n",
     .values = VALUES("1e2", "1e4", "1e6"),
     .bound = 0.0003,
     .off_max = 2},
    /* --- Triangles --- */
    {.name = "needles 1:1e6, seen at height",
     .text =
         HEAD "OrthographicCamera { center 0 1e-6 3 direction 0 0 -1 up 0 1 0 size @0 }\n" SKY SUN
              "Materials { " RED " }\nGroup { MaterialIndex 0 TriangleMesh { file "
              "needle.obj normals flat } }\n",
     .values = VALUES("4", "1e-2", "1e-5"),
     .off_max = 2},
    {.name = "triangle of 1 by",
     .text = HEAD "OrthographicCamera { center 0 0 3 direction 0 0 -1 up 0 1 0 size @1 }\n" SKY SUN
                  "Materials { " RED " }\nGroup { MaterialIndex 0 Triangle { vertex0 -1 0 0 "
                  "vertex1 1 0 0 vertex2 0 @0 0 } Triangle { vertex0 -1 0 0 vertex1 0 -@0 0 "
                  "vertex2 1 0 0 } }\n",
     .values = VALUES("1e-2|0.03", "1e-4|3e-4", "=1e-6|3e-6"),
     .off_max = 2},
    /* scale | rays | from so many radii, 0: from inside | moved by so many */
    {.name = "aimed at the edges of a ball",
     .text = "TriangleMesh { file ball.obj normals flat }",
     .values =
         VALUES("1|200000", "1e-6|200000", "1e6|200000", "1|200000|0|1e3", "1|200000|10",
                "1|200000|1e3", "1|200000|1e4", "1e-6|200000|1e2|1e5", "!1|100000000",
                "!1e-6|100000000", "!1e6|100000000", "!1|100000000|1e2", "!1|100000000|1e2|1e3"),
     .judge = EXTREME_RAYS},
    {.name = "the same, turned and squashed",
     .text =
         "Transform { Rotate { 1 2 3 77 } Scale 1 0.05 0.7 TriangleMesh { file ball.obj normals "
         "flat } }",
     .values = VALUES("1|200000", "1e-6|200000|10", "1e6|200000|1e2|1e3", "!1|100000000",
                      "!1|100000000|1e2"),
     .judge = EXTREME_RAYS},
    {.name = "the same, triangles one by one",
     .values = VALUES("1|200000", "1e-6|200000|10", "1e6|200000|1e2|1e3", "!1|100000000",
                      "!1|100000000|1e2"),
     .judge = EXTREME_RAYS},
    /* --- Directions --- */
    {.name = "looking along",
     .text =
         HEAD "OrthographicCamera { center @0 direction @1 up @2 size 6 }\n" SKY LIGHTS MATERIALS
              "Group { MaterialIndex 1 Sphere { center 0 0 0 radius 1 } Transform { Translate "
              "1.5 -1 1.5 RevSurface { profile BezierCurve { controls [0.6 0 0][1.2 0.6 0][0.2 "
              "1.2 0][0.5 1.8 0] } } } MaterialIndex 0 Square { corner -2 -1 -2 u 4 0 0 v 0 0 "
              "4 } Disk { center -1.5 0 1.5 normal 0 1 0 radius 0.8 } Transform { Translate "
              "-1.4 0.3 -1.5 UniformScale 0.7 TriangleMesh { file ball.obj normals flat } } "
              "}\n",
     .values = VALUES("0 0.2 8|0 0 -1|0 1 0", "=0 0.2 8|-0 -0 -1|0 1 0", "8 0.2 0|-1 0 0|0 1 0",
                      "0 8 0.1|0 -1 0|0 0 -1", "=0 8 0.1|0 -1 -0|0 0 -1",
                      "0 0.2 8|1e-310 1e-310 -1|0 1 0",
                      "=0 0.2 8|1e-40 1e-42 -1|0 1 0", /* floats keep these as denormals */
                      "=0 0.2 8|1e-30 -1e-30 -1|0 1 0", "=0 0.2 8|1e-8 1e-12 -1|0 1 0"),
     .shown = 2,
     .off_max = 2},
    {.name = "camera above a plane by",
     .text = HEAD
     "PerspectiveCamera { center 0 @0 5 direction 0 0 -1 up 0 1 0 angle 40 }\n" SKY SUN MATERIALS
     "Group { MaterialIndex 1 Plane { normal 0 1 0 offset 0 } Sphere { "
     "center 0 1 -3 radius 1 } }\n",
     .values = VALUES("1", "1e-3", "1e-6", "=1e-9", "0"),
     .off_max = 2},
    {.name = "grazing a square at slope",
     .text =
         HEAD "OrthographicCamera { center 0 0 5 direction 0 -@0 -1 up 0 1 0 size @1 }\n" SKY SUN
              "Materials { " RED " }\nGroup { MaterialIndex 0 Square { corner -2 -@0 -2 u 4 0 "
              "0 v 0 0 4 } }\n",
     .values = VALUES("1e-2|0.3", "=1e-4|3e-3", "=1e-6|3e-5"),
     .off_max = 2},
    {.name = "tangent to a ball, view of",
     .text = HEAD "OrthographicCamera { center 1 0 4 direction 0 0 -1 up 0 1 0 size @0 }\n" SKY SUN
                  "Materials { " RED " }\nGroup { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } "
                  "}\n",
     .values = VALUES("1e-1", "1e-3", "1e-5#60 2e-5"), /* A float step is a third of a pixel. */
     .off_max = 2},
    /* --- Lens --- */
    {.name = "focus",
     .text =
         STAGE("PerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 1 0 angle 40 "
               "aperture @1 focus @0 }\n",
               SUN, RED),
     .values =
         VALUES("1e-6|1e-7", "1e-6|0.1", "1e-3|1e-4", "7|0.1", "1e6|0.1", "=1e20|0.1", "=inf|0.1"),
     .shown = 2,
     .off_max = 2},
    {.name = "aperture",
     .text =
         STAGE("PerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 1 0 angle 40 "
               "aperture @0 focus 7 }\n",
               SUN, RED),
     .values = VALUES("0", "=1e-9", "1e-3", "1", "1e3#2 2e-5"),
     .off_max = 2},
    {.name = "aperture of the size of a city",
     .text =
         STAGE("PerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 1 0 angle 40 "
               "aperture @0 focus 7 }\n",
               SUN, RED),
     .values = VALUES("1e4", "=1e6#500 2e-3"), /* At 1e6 a float step of the lens is 0.06. */
     .judge = EXTREME_MEAN,
     .off_max = 2},
    {.name = "field of view, degrees",
     .text = STAGE("PerspectiveCamera { center 0.3 1.4 7 direction -0.2143 -0.2 -1 up 0 1 0 angle "
                   "@0 }\n",
                   SUN, RED),
     .values = VALUES("0.01", "0.1", "1", "90", "170", "179"),
     .off_max = 2},
    /* --- Glass --- */
    {.name = "refraction index",
     .text = STAGE(CAMERA, SUN,
                   "Material { diffuseColor 0 0 0 reflect 0.1 refract 0.9 refractionIndex @0 }"),
     .values = VALUES("1", "=1.000001", "=0.999999", "1e-3", "0.5", "1.5", "1e3"),
     .off_max = 2},
    {.name = "critical angle, rad",
     .text = HEAD "PerspectiveCamera { center 0 -1 0 direction @1 up 0 0 1 angle 0.01 }\n" SKY SUN
                  "Materials { Material { diffuseColor 0 0 0 refract 1 refractionIndex 1.5 } "
                  "Material { diffuseColor 1 0.5 0.2 ambient 3 2 1 } }\nGroup { MaterialIndex 0 "
                  "Plane { normal 0 1 0 offset 0 } MaterialIndex 1 Plane { normal 0 1 0 offset -9 "
                  "} }\n",
     .values = VALUES("-1e-3|0.66592097746508716 0.74602228637752033 0",
                      "-1e-6|0.66666592131034075 0.74535665916622396 0",
                      "0|0.66666666666666663 0.7453559924999299 0",
                      "1e-6|0.66666741202232582 0.74535532583289055 0",
                      "1e-3|0.66741168920163507 0.74468895326640916 0"),
     .off_max = 2},
    {.name = "the same entering an index of 2/3",
     .text =
         HEAD "PerspectiveCamera { center 0 1 0 direction @1 up 0 0 1 angle 0.01 }\n" SKY SUN
              "Materials { Material { diffuseColor 0 0 0 refract 1 refractionIndex "
              "0.66666666666666663 } Material { diffuseColor 1 0.5 0.2 ambient 3 2 1 } }\nGroup "
              "{ MaterialIndex 0 Plane { normal 0 1 0 offset 0 } MaterialIndex 1 Plane { normal "
              "0 1 0 offset -9 } }\n",
     .values = VALUES("-1e-3|0.66592097746508716 -0.74602228637752033 0",
                      "-1e-6|0.66666592131034075 -0.74535665916622396 0",
                      "0|0.66666666666666663 -0.7453559924999299 0",
                      "1e-6|0.66666741202232582 -0.74535532583289055 0",
                      "1e-3|0.66741168920163507 -0.74468895326640916 0"),
     .off_max = 2},
    /* --- Shading --- */
    {.name = "shininess",
     .text = STAGE(CAMERA, SUN,
                   "Material { diffuseColor 0.2 0.1 0.1 specularColor 1 1 1 shininess "
                   "@0 }"),
     .values = VALUES("0", "1e-6", "1", "1e3", "1e6"),
     .off_max = 2},
    {.name = "bounces between mirrors",
     .text = HEAD "PerspectiveCamera { center 0 0 0.9 direction 0.3 0.1 -1 up 0 1 0 angle 70 }\n"
                  "Render { depth @0 weightThreshold 0 }\n" SKY SUN
                  "Materials { Material { diffuseColor 0.05 0.06 0.05 reflect 0.9 0.95 0.9 } " RED
                  " }\nGroup { MaterialIndex 0 Square { corner -3 -3 -1 u 6 0 0 v 0 6 0 } Square { "
                  "corner -3 -3 1 u 0 6 0 v 6 0 0 } MaterialIndex 1 Sphere { center 0.3 0.1 -0.3 "
                  "radius 0.3 } }\n",
     .values = VALUES("0", "1", "5", "16", "64"),
     .off_max = 2},
    {.name = "colour",
     .text = STAGE(CAMERA,
                   "Lights { PointLight { position 3 5 4 color @1 @1 @1 } DirectionalLight { "
                   "direction 0 -1 -1 color 0.3 0.3 0.3 } }\n",
                   "Material { diffuseColor @0 @0 @0 specularColor @0 0 0 shininess 20 }"),
     .values = VALUES("-1|1", "1|-1", "5|5", "1e10|1e10", "1e18|1e18", "1e-20|1", "=1e-320|1"),
     .shown = 2,
     .off_max = 2},
    {.name = "background and ambient",
     .text = HEAD CAMERA "Background { color @0 ambientLight @1 }\n" SUN
                         "Materials { Material { diffuseColor 0.7 0.7 0.7 } " RED
                         " }\nGroup { MaterialIndex 0 " FLOOR "MaterialIndex 1 " BALLS "}\n",
     .values = VALUES("0 0 0|0 0 0", "-1 0 2|-0.5 1 3", "1e18 1 0|1 0 1e18", "1e37 0 -1e37|1 1 1",
                      "0 1 0|1e37 -1e37 0"),
     .shown = 2,
     .off_max = 2},
    {.name = "reflect and refract",
     .text =
         STAGE(CAMERA, SUN,
               "Material { diffuseColor 0.1 0.2 0.1 reflect @0 refract @1 refractionIndex 1.5 }"),
     .values = VALUES("1|0", "2|0", "0|3", "-1|0.5", "10|10", "1e3|-1e3"),
     .shown = 2,
     .off_max = 2},
    {.name = "attenuation",
     .text = STAGE(CAMERA, "Lights { PointLight { position @1 color 1 0.9 0.8 attenuation @0 } }\n",
                   RED),
     .values =
         VALUES("0 0 1|0 3 2", "0 0 1e-12|0 3 2", "1e12 0 0|0 3 2", "0 0 1|0 -0.999999 1#2 4e-5",
                "0 0 1e-6|0 -0.999999 1#2 4e-5", "1e-37 0 0|0 3 2"),
     .shown = 2,
     .off_max = 2},
    /* Each factor fits in a float, the product does not. */
    {.name = "factors beyond floats",
     .text = HEAD CAMERA "Background { color 0.2 0.3 0.5 ambientLight @2 }\n"
                         "Lights { PointLight { position @3 color @1 attenuation @4 } }\n"
                         "Materials { Material { diffuseColor 0.7 0.7 0.7 } Material { @0 } }\n"
                         "Group { MaterialIndex 0 " FLOOR "MaterialIndex 1 " BALLS "}\n",
     .values = VALUES("diffuseColor 1e20 1e20 1e20|1e20 1e20 1e20|0 0 0|3 5 4|1 0 0",
                      "diffuseColor 3e38 3e38 3e38|1 1 1|1 1 1|3 5 4|1 0 0",
                      "diffuseColor 3 3 3|1 1 1|3e38 3e38 3e38|3 5 4|1 0 0",
                      "diffuseColor 1 1 1 reflect 1e38|1 1 1|0 0 0|3 5 4|1 0 0",
                      "diffuseColor 1 1 1|1 1 1|0 0 0|0 -1 1|0 0 1e-38"),
     .judge = EXTREME_COUNTED},
    /* --- Lights --- */
    {.name = "light radius",
     .text = STAGE(CAMERA,
                   "Lights { DiskLight { position 3 5 4 direction -3 -5 -4 radius @0 color 0.8 0.8 "
                   "0.8 samples 4 } }\n",
                   RED),
     .values = VALUES("0", "=1e-9", "1", "1e3", "1e6"),
     .off_max = 2},
    {.name = "light at",
     .text = STAGE(CAMERA,
                   "Lights { PointLight { position @0 color 0.8 0.8 0.8 } DiskLight { "
                   "position @0 direction 0 -1 0 radius 0.4 color 0.4 0.4 0.4 } }\n",
                   RED),
     .values = VALUES("0 -1 1", "0 -0.999999 1", "-1.2 1 0#2 1e-4", "=-1.2 1.000001 0#2 1e-4",
                      "0 1e6 0", "0 1e12 0"),
     .off_max = 2},
    {.name = "light inside a glass ball of index",
     .text = HEAD CAMERA "Render { transparentShadows 1 }\n" SKY
                         "Lights { PointLight { position 0 0.2 0 color 0.9 0.9 0.8 } DiskLight { "
                         "position 0 0.1 0 direction 0 -1 0 radius 0.1 color 0.5 0.5 0.5 } }\n"
                         "Materials { Material { diffuseColor 0.7 0.7 0.7 } Material { "
                         "diffuseColor 0 0 0 reflect 0.1 refract 0.9 refractionIndex @0 } }\n"
                         "Group { MaterialIndex 0 " FLOOR "MaterialIndex 1 Sphere { center 0 0 0 "
                         "radius 0.8 } }\n",
     .values = VALUES("1", "1.5", "0.7"),
     .off_max = 2},
    {.name = "light samples",
     .text =
         STAGE("PerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 1 0 angle 40 "
               "width @1 height @2 }\n",
               "Lights { DiskLight { position 3 5 4 direction -3 -5 -4 radius 1 color 0.8 0.8 "
               "0.8 samples @0 } }\n",
               RED),
     .values = VALUES("1|48|36", "16|48|36", "1000|12|9", "!1000000|4|3"),
     .samples = 1,
     .off_max = 2},
    /* --- Pictures and samples --- */
    {.name = "samples in one pixel",
     .text =
         STAGE("PerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 1 0 angle 40 "
               "width 1 height 1 }\nRender { samples @0 }\n",
               SUN, RED),
     .values = VALUES("1", "1000", "100000", "!10000000"),
     .bound = 3e-05,
     .off_max = 0},
    {.name = "picture of",
     .text =
         STAGE("PerspectiveCamera { center 0.3 1.4 7 direction -0.03 -0.15 -1 up 0 1 0 angle 40 "
               "width @0 height @1 }\n",
               SUN, RED),
     .values = VALUES("1|1", "1|64", "64|1", "16384|1", "1|16384", "!16384|64"),
     .shown = 2,
     .samples = 1,
     .off_max = 40}, /* of a million in the largest */
    /* --- Textures --- */
    {.name = "texture",
     .text = HEAD CAMERA SKY SUN
     "Materials { Material { texture @0 filter @1 } Material { texture @0 filter @1 } }\nGroup { "
     "MaterialIndex 0 " FLOOR "MaterialIndex 1 " BALLS
     "Square { corner -1 0.8 0 u 2 0 0 v 0 1 0 } }\n",
     .values = VALUES("1x1.png|nearest", "=1x1.png|bilinear", "2x1.png|nearest", "2x1.png|bilinear",
                      "wide.png|bilinear#4 1e-4", "tall.png|bilinear#8 1e-4",
                      "!large.png|bilinear#8 2e-4"), /* 16,384 texels are finer than a pixel. */
     .shown = 2,
     .off_max = 2},
    {.name = "uv of a mesh from",
     .text = SHEET,
     .values =
         VALUES("0|nearest", "=-3|nearest", "0|bilinear", "=-3|bilinear", "=1e2|bilinear#2 3e-5"),
     .shown = 2,
     .off_max = 2},
    {.name = "uv of a mesh from, by the mean", /* u and v are floats where they are read */
     .text = SHEET,
     .values = VALUES("1e4|bilinear#350 1e-3", "=1e6|bilinear#900 1e-3"),
     .judge = EXTREME_MEAN},
    {.name = "repeats of a texture",
     .text = HEAD CAMERA SKY SUN
     "Materials { Material { texture checker.png textureScale @0 @0 } Material { texture "
     "checker.png textureScale @1 @1 } }\nGroup { MaterialIndex 0 " FLOOR "MaterialIndex 1 "
     "Square { corner -1 0.4 0 u 2 0 0 v 0 1 0 } Sphere { center 1.3 -0.3 0.8 radius 0.7 } }\n",
     .values = VALUES("1e6|1e-6", "1|-1#4 1e-4", "0.1|10#12 4e-4", "0.01|1000#150 1e-3"),
     .off_max = 2},
    {.name = "poles and seams, looking",
     .text = HEAD "OrthographicCamera { center @0 direction @1 up @2 size 0.02 }\n" SKY SUN
                  "Materials { Material { texture checker.png } }\nGroup { MaterialIndex 0 Sphere "
                  "{ center 0 0 0 radius 1 } Transform { Translate 0 0.5 2.5 RevSurface { profile "
                  "BezierCurve { controls [0 0 0][1 0 0][1 1 0][0 1 0] } } } }\n",
     .values = VALUES("0 0 1.5|0 0 -1|0 1 0", "0 0 -1.5|0 0 1|0 1 0", "1.5 0 0|-1 0 0|0 0 1",
                      "0 3 2.5|0 -1 0|0 0 1", "2 1 2.5|-1 0 0|0 1 0"),
     .bound = 5e-05, /* At a pole u turns through all its values within a step of the point. */
     .off_max = 2},
    /* --- What cannot be rendered says so --- */
    {.name = "refused: focus",
     .text = STAGE("PerspectiveCamera { center 0 0 7 direction 0 0 -1 up 0 1 0 angle 40 aperture "
                   "0.1 focus @0 }\n",
                   SUN, RED),
     .values = VALUES("0|focus", "-1|focus", "1e-12|aperture"),
     .judge = EXTREME_REFUSED},
    {.name = "refused: aperture",
     .text = STAGE("PerspectiveCamera { center 0 0 7 direction 0 0 -1 up 0 1 0 angle 40 aperture "
                   "@0 focus 7 }\n",
                   SUN, RED),
     .values = VALUES("-1|aperture", "1e39|aperture", "inf|aperture"),
     .judge = EXTREME_REFUSED},
    {.name = "refused: field of view",
     .text =
         STAGE("PerspectiveCamera { center 0 0 7 direction 0 0 -1 up 0 1 0 angle @0 }\n", SUN, RED),
     .values = VALUES("0|angle", "0.001|angle", "180|angle", "-40|angle"),
     .judge = EXTREME_REFUSED},
    {.name = "refused: material",
     .text = STAGE(CAMERA, SUN, "Material { @0 }"),
     .values =
         VALUES("diffuseColor 1e39 0 0|diffuseColor", "diffuseColor 0 -1e300 0|diffuseColor",
                "specularColor 0 0 1e39|specularColor", "reflect 1e39|reflect",
                "refract 1e39|refract", "ambient 1e39|ambient", "shininess 1e39|shininess",
                "shininess -1|shininess", "refractionIndex 0|refractionIndex",
                "refractionIndex 1e39|refractionIndex", "refractionIndex 1e-40|refractionIndex",
                "texture checker.png textureScale 1e39 1|textureScale",
                "texture checker.png textureScale 0 1|textureScale",
                "texture checker.png textureScale 1e-39 1|textureScale"),
     .judge = EXTREME_REFUSED},
    {.name = "refused: light",
     .text = STAGE(CAMERA, "Lights { DiskLight { @0 } }\n", RED),
     .values = VALUES(
         "position 0 5 0 direction 0 -1 0 radius 1 color 1e39 0 0|color",
         "position 0 5 0 direction 0 -1 0 radius 1e39 color 1 1 1|radius",
         "position 0 5 0 direction 0 -1 0 radius -1 color 1 1 1|radius",
         "position 0 1e300 0 direction 0 -1 0 radius 1 color 1 1 1|position",
         "position 0 5 0 direction 0 0 0 radius 1 color 1 1 1|direction",
         "position 0 5 0 direction 0 -1 0 radius 1 color 1 1 1 attenuation 1 1e39 0|attenuation"),
     .judge = EXTREME_REFUSED},
    {.name = "refused: object",
     .text = HEAD CAMERA SKY SUN "Materials { " RED " }\nGroup { MaterialIndex 0 @0 }\n",
     .values = VALUES(
         "Sphere { center 0 0 0 radius 0 }|radius", "Sphere { center 0 0 0 radius 1e-30 }|radius",
         "Sphere { center 1e20 0 0 radius 1 }|1e18", "Plane { normal 0 0 0 offset 1 }|normal",
         "Transform { Scale 1 0 1 Sphere { center 0 0 0 radius 1 } }|Scale",
         "Square { corner 0 0 0 u 1 0 0 v 2 0 0 }|parallel"),
     .judge = EXTREME_REFUSED},
    {.name = "refused: picture of",
     .text = STAGE("PerspectiveCamera { center 0 0 7 direction 0 0 -1 up 0 1 0 angle 40 width @0 "
                   "height @1 }\n",
                   SUN, RED),
     .values = VALUES("16385|64|16384", "16384|16384|bytes"),
     .shown = 2,
     .judge = EXTREME_REFUSED},
};
const uint32_t extreme_family_count = FL_COUNT_OF(extreme_families);
