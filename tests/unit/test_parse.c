/* SPDX-License-Identifier: MIT
 *
 * What a text means. How wrong texts are reported is in tests/scene.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/grammar.h"
#include "core/parse_tree.h"
#include "support/scene_dump.h"

#define CAMERA_PA1                                                                                 \
    "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 width 20 height 10 }\n"
#define CAMERA_MIT "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }\n"
#define OURS       "firstlight 1\n"

static fake_files fake;

static fl_scene *parse_with(const char *text, bool is_lenient, fl_diags *diags)
{
    fl_parse_options options = {.is_lenient = is_lenient};
    fake_files_init(&fake);
    return fl_scene_parse(text, strlen(text), "a.scene", &options, &fake.files, diags);
}

/* A scene without errors or warnings. */
static fl_scene *parse(const char *text)
{
    fl_diags diags = {0};
    fl_scene *scene = parse_with(text, false, &diags);
    char message[1024];
    for (uint32_t i = 0; i < diags.count; i++) {
        fl_diag_format(&diags.items[i], message, sizeof message);
        print_message("%s\n", message);
    }
    assert_non_null(scene);
    assert_int_equal(diags.count, 0);
    fl_diags_deinit(&diags);
    return scene;
}

static void assert_vec(fl_vec3 v, double x, double y, double z)
{
    assert_true(v.x == x && v.y == y && v.z == z);
}

static void assert_near(fl_vec3 v, double x, double y, double z)
{
    assert_true(fabs(v.x - x) < 1e-12 && fabs(v.y - y) < 1e-12 && fabs(v.z - z) < 1e-12);
}

static void test_dialects(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        fl_dialect dialect;
        const char *reason;
    } cases[] = {
        {"firstlight 1\n" CAMERA_PA1, FL_DIALECT_FIRSTLIGHT, "its first word is 'firstlight'"},
        {"# hello\nfirstlight 1", FL_DIALECT_FIRSTLIGHT, "its first word is 'firstlight'"},
        {CAMERA_PA1, FL_DIALECT_PA1, "'width' in line 1 is a word of that dialect"},
        {"Group { numObjects 1 BezierCurve { controls [0 0 0] } }", FL_DIALECT_PA1,
         "'BezierCurve' in line 1 is a word of that dialect"},
        {CAMERA_MIT "Materials { Material { exponent 3 } }", FL_DIALECT_M04,
         "'exponent' in line 2 is a word of that dialect"},
        {CAMERA_MIT "Materials { Material { shininess 3 } }", FL_DIALECT_M12,
         "'shininess' in line 2 is a word of that dialect"},
        {CAMERA_MIT, FL_DIALECT_M04,
         "its camera has no size, and it has no mesh; the 2012 course fits too"},
        {CAMERA_MIT "Group { TriangleMesh { obj_file a } }", FL_DIALECT_M12,
         "its camera has no size, and it has a mesh; the 2004 course fits too"},
        {CAMERA_MIT "Render { depth 1 }", FL_DIALECT_FIRSTLIGHT,
         "'Render' in line 2 is a word of that dialect"},
        {"Group { }", FL_DIALECT_FIRSTLIGHT, "it has no camera and no word of a course alone"}};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        fl_diags diags = {0};
        fl_scene *scene = parse_with(cases[i].text, true, &diags);
        assert_non_null(scene);
        assert_int_equal(scene->dialect, cases[i].dialect);
        assert_string_equal(scene->dialect_reason, cases[i].reason);
        fl_scene_destroy(scene);
        fl_diags_deinit(&diags);
    }
}

static void test_named_dialect(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_parse_options options = {.has_dialect = true, .dialect = FL_DIALECT_M12};
    fake_files_init(&fake);
    fl_scene *scene =
        fl_scene_parse(CAMERA_MIT, strlen(CAMERA_MIT), "x", &options, &fake.files, &diags);
    assert_non_null(scene);
    assert_int_equal(scene->dialect, FL_DIALECT_M12);
    assert_string_equal(scene->dialect_reason, "it was named");
    fl_scene_destroy(scene);
    assert_null(fl_scene_parse(CAMERA_PA1, strlen(CAMERA_PA1), "x", &options, &fake.files, &diags));
    assert_string_equal(diags.items[0].message,
                        "unknown key 'width' in 'PerspectiveCamera'; "
                        "'firstlight' has it, but this text is read as 'm12'");
    fl_diags_deinit(&diags);
}

static void test_camera_and_defaults(void **state)
{
    (void)state;
    fl_scene *scene = parse(OURS CAMERA_PA1);
    assert_true(scene->has_camera);
    assert_vec(scene->camera.center, 0, 0, 10);
    assert_vec(scene->camera.direction, 0, 0, -1);
    assert_true(scene->camera.fov_deg == 30 && scene->camera.width == 20 &&
                scene->camera.height == 10);
    assert_true(scene->camera.aperture == 0 && isinf(scene->camera.focus));
    assert_int_equal(scene->camera.blades, 0);
    assert_vec(scene->background.color, 0.5, 0.5, 0.5);
    assert_vec(scene->background.ambient, 0, 0, 0);
    assert_int_equal(scene->background.cube_image[0], FL_NONE);
    assert_false(scene->render.has_samples || scene->render.has_transparent_shadows);
    assert_string_equal(scene->path, "a.scene");
    fl_scene_destroy(scene);
    scene =
        parse(OURS "View b { angle 20 center 1 2 3 direction 0 1 0 up 0 0 1 aperture .5 focus 3 }");
    assert_false(scene->has_camera);
    assert_int_equal(scene->view_count, 1);
    assert_string_equal(scene->views[0].name, "b");
    assert_true(scene->views[0].camera.aperture == 0.5 && scene->views[0].camera.focus == 3);
    assert_int_equal(scene->views[0].loc.line, 2);
    assert_string_equal(scene->views[0].loc.file, "a.scene");
    fl_scene_destroy(scene);
}

static void test_no_lights_means_ambient_in_mit(void **state)
{
    (void)state;
    fl_scene *scene = parse(CAMERA_MIT "Background { color 0 0 0 ambientLight .1 .1 .1 }");
    assert_vec(scene->background.ambient, 1, 1, 1);
    fl_scene_destroy(scene);
    scene = parse(CAMERA_PA1 "Lights { numLights 0 }");
    assert_vec(scene->background.ambient, 0, 0, 0);
    fl_scene_destroy(scene);
}

static void test_light_fading(void **state)
{
    (void)state;
    static const char light[] =
        "Lights { numLights 1 PointLight { position 1 2 3 color 1 1 1 %s } }";
    static const struct {
        const char *camera, *keys;
        double attenuation[3];
    } cases[] = {{OURS, "", {1, 0, 0}},
                 {OURS, "falloff 0.5", {1, 0, 0.5}},
                 {OURS, "attenuation 1 2 3", {1, 2, 3}},
                 {CAMERA_PA1, "falloff 0.5", {1, 0, 0.5}},
                 {CAMERA_MIT, "falloff 0.5", {0, 0, 0.5}},
                 {CAMERA_MIT, "falloff 0", {1, 0, 0}},
                 {CAMERA_MIT, "attenuation 0 1 0", {0, 1, 0}}};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        char text[512], block[256];
        snprintf(block, sizeof block, light, cases[i].keys);
        snprintf(text, sizeof text, "%s%s", cases[i].camera, block);
        fl_scene *scene = parse(text);
        assert_int_equal(scene->light_count, 1);
        for (int k = 0; k < 3; k++)
            assert_true(scene->lights[0].attenuation[k] == cases[i].attenuation[k]);
        fl_scene_destroy(scene);
    }
}

static void test_lights(void **state)
{
    (void)state;
    fl_scene *scene =
        parse(OURS "Lights { DirectionalLight { direction 0 -2 0 color 1 2 3 } "
                   "DiskLight { position 1 1 1 direction 0 0 5 radius 2 color 1 1 1 } "
                   "DiskLight { position 1 1 1 direction 0 0 5 radius 0 color -1 1 1 "
                   "samples 16 twoSided 0 } }");
    assert_int_equal(scene->light_count, 3);
    assert_int_equal(scene->lights[0].kind, FL_LIGHT_DIRECTIONAL);
    assert_vec(scene->lights[0].direction, 0, -1, 0);
    assert_vec(scene->lights[0].color, 1, 2, 3);
    assert_true(scene->lights[1].is_two_sided && scene->lights[1].radius == 2);
    assert_int_equal(scene->lights[1].samples, 0);
    assert_vec(scene->lights[1].direction, 0, 0, 1);
    assert_false(scene->lights[2].is_two_sided);
    assert_int_equal(scene->lights[2].samples, 16);
    fl_scene_destroy(scene);
}

static void test_materials_by_dialect(void **state)
{
    (void)state;
    fl_scene *scene = parse(OURS "Materials { Material { } Material { diffuseColor 0 0 1 "
                                 "specularColor 1 1 1 shininess 5 ambient 0.5 reflect 0.25 "
                                 "refract 1 2 3 refractionIndex 2 texture t textureScale 2 3 "
                                 "filter nearest } }");
    const fl_material *m = scene->materials;
    assert_vec(m->diffuse, 1, 1, 1);
    assert_true(m->shininess == 0 && !m->has_ambient && m->refraction_index == 1);
    assert_true(m->image == FL_NONE && m->filter == FL_FILTER_BILINEAR && m->texture_scale[1] == 1);
    m++;
    assert_true(m->has_ambient && m->shininess == 5 && m->refraction_index == 2 && m->image == 0);
    assert_vec(m->ambient, 0.5, 0.5, 0.5);
    assert_vec(m->reflect, 0.25, 0.25, 0.25);
    assert_vec(m->refract, 1, 2, 3);
    assert_true(m->filter == FL_FILTER_NEAREST && m->texture_scale[0] == 2 &&
                m->texture_scale[1] == 3);
    fl_scene_destroy(scene);

    scene = parse(CAMERA_MIT
                  "Materials { numMaterials 2 Material { } PhongMaterial { exponent 7 "
                  "reflectiveColor .1 .2 .3 transparentColor 1 1 1 indexOfRefraction 1.5 } }");
    assert_true(scene->materials[0].shininess == 1);
    assert_true(scene->materials[1].shininess == 7 && scene->materials[1].refraction_index == 1.5);
    assert_vec(scene->materials[1].reflect, .1, .2, .3);
    assert_vec(scene->materials[1].refract, 1, 1, 1);
    fl_scene_destroy(scene);

    scene = parse(CAMERA_MIT
                  "Materials { numMaterials 2 Material { specularColor .5 .5 .5 shininess 3 } "
                  "Material { specularColor 1 1 1 refractionIndex 3 } }");
    assert_vec(scene->materials[0].reflect, .5, .5, .5);
    assert_vec(scene->materials[0].refract, 0, 0, 0);
    assert_vec(scene->materials[1].reflect, .25, .25, .25);
    assert_vec(scene->materials[1].refract, .75, .75, .75);
    assert_true(scene->materials[0].refraction_index == 1 &&
                scene->materials[1].refraction_index == 3);
    fl_scene_destroy(scene);
}

static void test_material_index_persists(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_scene *scene = parse_with(
        OURS
        "Materials { Material { } Material { } } Group { Sphere { center 0 0 0 radius 1 } Group { "
        "MaterialIndex 1 } Transform { Scale 2 2 2 Group { Sphere { center 0 0 0 radius 1 } "
        "MaterialIndex 0 } } Sphere { center 0 0 0 radius 1 } }",
        false, &diags);
    assert_non_null(scene);
    assert_int_equal(diags.warning_count, 1); /* no MaterialIndex before the first object */
    assert_int_equal(scene->material_count, 3);
    assert_int_equal(scene->objects[0].material, 2);
    assert_int_equal(scene->objects[1].material, 1);
    assert_int_equal(scene->objects[2].material, 0);
    assert_vec(scene->materials[2].diffuse, 1, 1, 1);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
}

static fl_affine transform_of(const char *keys)
{
    char text[512];
    snprintf(text, sizeof text, OURS "Group { Transform { %s Sphere { center 0 0 0 radius 1 } } }",
             keys);
    fl_scene *scene = parse(text);
    fl_affine map = fl_affine_identity();
    if (scene->objects[0].transform != FL_NONE)
        map = scene->transforms[scene->objects[0].transform];
    fl_scene_destroy(scene);
    return map;
}

static void test_transforms(void **state)
{
    (void)state;
    fl_vec3 x = fl_v3(1, 0, 0), y = fl_v3(0, 1, 0), p = fl_v3(1, 2, 3);
    fl_affine m = transform_of("Translate 1 0 0 Scale 2 3 4"); /* the last one is applied first */
    assert_vec(fl_affine_point(&m, p), 3, 6, 12);
    m = transform_of("Scale 2 3 4 Translate 1 0 0");
    assert_vec(fl_affine_point(&m, p), 4, 6, 12);
    m = transform_of("XRotate 90");
    assert_vec(fl_affine_point(&m, y), 0, 0, 1);
    m = transform_of("YRotate 90");
    assert_vec(fl_affine_point(&m, x), 0, 0, -1);
    m = transform_of("ZRotate 90");
    assert_vec(fl_affine_point(&m, x), 0, 1, 0);
    m = transform_of("ZRotate -270 UniformScale 2");
    assert_vec(fl_affine_point(&m, x), 0, 2, 0);
    m = transform_of("Rotate { 2 2 2 120 }");
    assert_near(fl_affine_point(&m, x), 0, 1, 0);
    m = transform_of("Scale 2 2 2 Matrix4f { 1 2 3 0 0 1 0 0 0 0 1 0 10 20 30 1 }");
    assert_vec(fl_affine_point(&m, x), 12, 24, 36); /* multiplied from the left of all before */
    m = transform_of("");
    assert_true(fl_affine_is_identity(&m));
}

static void test_nested_transforms(void **state)
{
    (void)state;
    fl_scene *scene =
        parse(OURS "Group { Transform { Translate 1 0 0 Group { Sphere { center 0 0 0 radius 1 } "
                   "Transform { UniformScale 2 Sphere { center 0 0 0 radius 1 } } "
                   "Transform { Translate -1 0 0 Plane { normal 0 1 0 offset 0 } } "
                   "Triangle { vertex0 0 0 0 vertex1 1 0 0 vertex2 0 1 0 } } } }");
    assert_int_equal(scene->object_count, 4);
    assert_int_equal(scene->transform_count, 2);
    assert_int_equal(scene->objects[0].transform, scene->objects[3].transform);
    assert_int_equal(scene->objects[2].transform, FL_NONE); /* they cancel */
    const fl_affine *m = &scene->transforms[scene->objects[1].transform];
    assert_vec(fl_affine_point(m, fl_v3(1, 1, 1)), 3, 2, 2);
    fl_scene_destroy(scene);
}

static void test_files_are_read_once(void **state)
{
    (void)state;
    fl_scene *scene =
        parse(OURS "Background { cubeMap sky } Materials { Material { texture a } Material "
                   "{ texture a } Material { texture sky/up.png } } Group { MaterialIndex 0 "
                   "TriangleMesh { obj_file m } TriangleMesh { file m normals file } "
                   "TriangleMesh { file n } }");
    assert_int_equal(fake.mesh_count, 2);
    assert_int_equal(fake.image_count, 7);
    assert_int_equal(scene->mesh_count, 2);
    assert_int_equal(scene->image_count, 7);
    assert_int_equal(scene->objects[0].as.mesh.mesh, scene->objects[1].as.mesh.mesh);
    assert_int_equal(scene->objects[0].as.mesh.normals, FL_NORMALS_AUTO);
    assert_int_equal(scene->objects[1].as.mesh.normals, FL_NORMALS_FILE);
    assert_string_equal(scene->meshes[1].path, "found/n");
    assert_int_equal(scene->meshes[0].mesh->face_count, 1);
    assert_int_equal(scene->materials[0].image, scene->materials[1].image);
    assert_int_equal(scene->materials[2].image, scene->background.cube_image[FL_CUBE_UP]);
    assert_string_equal(scene->images[scene->background.cube_image[FL_CUBE_BACK]].path,
                        "found/sky/back.png");
    fl_scene_destroy(scene);
}

static void test_mesh_normals_by_dialect(void **state)
{
    (void)state;
    static const struct {
        const char *head, *keys;
        fl_normals normals;
    } cases[] = {
        {OURS, "", FL_NORMALS_AUTO},
        {OURS, "normals smooth", FL_NORMALS_SMOOTH},
        {CAMERA_PA1, "", FL_NORMALS_FLAT},
        {CAMERA_PA1, "normals angle", FL_NORMALS_ANGLE},
        {CAMERA_MIT "Materials { numMaterials 1 Material { exponent 1 } }\n", "", FL_NORMALS_FLAT},
        {CAMERA_MIT, "", FL_NORMALS_AUTO}};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        char text[512];
        snprintf(text, sizeof text, "%sGroup { numObjects 1 TriangleMesh { obj_file m %s } }",
                 cases[i].head, cases[i].keys);
        fl_diags diags = {0};
        fl_scene *scene = parse_with(text, false, &diags);
        assert_non_null(scene);
        assert_int_equal(scene->objects[0].as.mesh.normals, cases[i].normals);
        fl_scene_destroy(scene);
        fl_diags_deinit(&diags);
    }
}

/* The uniform cubic B-spline by its basis functions. */
static double basis_spline(const double p[4], double t)
{
    double s = 1 - t;
    return (s * s * s * p[0] + (3 * t * t * t - 6 * t * t + 4) * p[1] +
            (3 * s * s * s - 6 * s * s + 4) * p[2] + t * t * t * p[3]) /
           6;
}

static double bezier(const double p[4], double t)
{
    double s = 1 - t;
    return s * s * s * p[0] + 3 * s * s * t * p[1] + 3 * s * t * t * p[2] + t * t * t * p[3];
}

static void test_curves(void **state)
{
    (void)state;
    fl_scene *scene = parse(
        OURS "Group { RevSurface { profile BsplineCurve { controls [1 0 0] [3 1 0] [2 4 0] [5 5 0] "
             "[1 9 0] } texture v } RevSurface { profile BezierCurve { controls [1 0 0][2 1 0][0 2 "
             "0] } } "
             "RevSurface { profile BezierCurve { piecewise 1 controls [1 0 0][2 1 0][3 2 0][4 3 0]"
             "[5 4 0][6 5 0][7 6 0] } } }");
    static const double x[5] = {1, 3, 2, 5, 1}, y[5] = {0, 1, 4, 5, 9};
    assert_int_equal(scene->profile_count, 3);
    const fl_profile *spline = &scene->profiles[0];
    assert_int_equal(spline->segment_count, 2);
    assert_int_equal(spline->degree, 3);
    for (int j = 0; j < 2; j++) {
        double bx[4], by[4];
        for (int k = 0; k < 4; k++) {
            bx[k] = spline->points[4 * j + k].x;
            by[k] = spline->points[4 * j + k].y;
        }
        for (double t = 0; t <= 1; t += 0.125) {
            assert_true(fabs(bezier(bx, t) - basis_spline(x + j, t)) < 1e-14);
            assert_true(fabs(bezier(by, t) - basis_spline(y + j, t)) < 1e-14);
        }
    }
    assert_memory_equal(&spline->points[3], &spline->points[4], sizeof(fl_vec3));
    assert_int_equal(scene->objects[0].as.revolution.image, 0);
    assert_int_equal(scene->objects[1].as.revolution.image, FL_NONE);
    assert_int_equal(scene->profiles[1].degree, 2);
    assert_vec(scene->profiles[1].points[2], 0, 2, 0);
    assert_int_equal(scene->profiles[2].segment_count, 2);
    assert_vec(scene->profiles[2].points[3], 4, 3, 0);
    assert_vec(scene->profiles[2].points[4], 4, 3, 0);
    assert_vec(scene->profiles[2].points[7], 7, 6, 0);
    fl_scene_destroy(scene);
    /* PA2: seven points are one curve; curves by themselves are dropped. */
    scene = parse(CAMERA_PA1
                  "Group { numObjects 2 BezierCurve { controls [0 0 0] } RevSurface { profile "
                  "BezierCurve { controls [1 0 0][2 1 0][3 2 0][4 3 0][5 4 0][6 5 0][7 6 0] } "
                  "} }");
    assert_int_equal(scene->object_count, 1);
    assert_int_equal(scene->profiles[0].segment_count, 1);
    assert_int_equal(scene->profiles[0].degree, 6);
    fl_scene_destroy(scene);
}

static void test_lenient_materials_keep_their_numbers(void **state)
{
    (void)state;
    fl_diags diags = {0};
    fl_scene *scene = parse_with(
        CAMERA_PA1
        "Materials { numMaterials 3 Glow { power 3 color 0 1 0 } Material { diffuseColor 1 0 0 } "
        "Unknown { } } Group { numObjects 2 MaterialIndex 1 Sphere { center 0 0 0 radius 1 } "
        "MaterialIndex 2 Torus { a 1 } }",
        true, &diags);
    assert_non_null(scene);
    assert_int_equal(scene->material_count, 3);
    assert_vec(scene->materials[0].diffuse, 0, 1, 0);
    assert_vec(scene->materials[scene->objects[0].material].diffuse, 1, 0, 0);
    assert_vec(scene->materials[2].diffuse, 1, 1, 1);
    assert_int_equal(scene->object_count, 1);
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    scene = parse_with(
        "OrthographicCamera { center 0 0 1 direction 0 0 -1 up 0 1 0 size 1 } Materials { "
        "Material { diffuseColor 1 0 0 } Material { diffuseColor 0 0 1 } Wood { "
        "materialIndex 1 materialIndex 0 octaves 2 frequency 1 amplitude 1 } "
        "Marble { materialIndex 7 } }",
        true, &diags);
    assert_non_null(scene);
    assert_vec(scene->materials[2].diffuse, 0, 0, 1);
    assert_vec(scene->materials[3].diffuse, 1, 1, 1); /* refers to nothing before it */
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
}

/* `count` times a piece of text, between a head and a tail. */
static char *repeat(const char *head, const char *piece, uint32_t count, const char *tail)
{
    size_t bytes = strlen(piece);
    char *text = malloc(strlen(head) + bytes * count + strlen(tail) + 1), *at = text;
    at += strlen(strcpy(at, head));
    for (uint32_t i = 0; i < count; i++, at += bytes)
        memcpy(at, piece, bytes);
    strcpy(at, tail);
    return text;
}

static void test_limits(void **state)
{
    (void)state;
    static const struct {
        const char *head, *piece, *tail;
        uint32_t most;
        const char *message;
    } cases[] = {
        {"firstlight 1 Group {", "Plane{normal 0 0 1 offset 0}", "}", FL_OBJECTS_MAX - 1,
         "a scene text holds at most 262144 objects, groups and transforms, this one 262145"},
        {"firstlight 1 Lights {", "PointLight{position 0 0 0 color 1 1 1}", "}", FL_LIGHTS_MAX,
         "a scene text holds at most 4096 lights, this one 4097"},
        {"firstlight 1 Materials {", "Material{}", "}", FL_MATERIALS_MAX,
         "a scene text holds at most 16384 materials, this one 16385"},
        {"firstlight 1 Group { BsplineCurve { controls ", "[0 0 0]", "} }", FL_CONTROLS_MAX,
         "'controls' holds more than 4096 points"}};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        for (uint32_t over = 0; over < 2; over++) {
            fl_diags diags = {0};
            char *text = repeat(cases[i].head, cases[i].piece, cases[i].most + over, cases[i].tail);
            fl_scene *scene = parse_with(text, false, &diags);
            assert_int_equal(scene != NULL, over == 0);
            if (over)
                assert_string_equal(diags.items[0].message, cases[i].message);
            fl_scene_destroy(scene);
            fl_diags_deinit(&diags);
            free(text);
        }
    }
}

/* A text full of errors ends early and says that there are more. */
static void test_many_errors(void **state)
{
    (void)state;
    fl_diags diags = {0};
    char *text = repeat("firstlight 1 ", "Glorp { } ", 100000, "");
    assert_null(parse_with(text, false, &diags));
    assert_int_equal(diags.count, FL_DIAGS_MAX);
    assert_true(diags.dropped_count > 100 && diags.dropped_count < 1000);
    fl_diags_deinit(&diags);
    free(text);
}

/* Memory is a small multiple of the text, for the densest texts too. */
static void test_memory_bound(void **state)
{
    (void)state;
    static const char *const pieces[] = {"Group{}", "Sphere{center 0 0 0 radius 1}\n",
                                         "Transform{Scale 1 2 3 Group{}}", "MaterialIndex 0 ",
                                         "#\n"};
    for (size_t i = 0; i < FL_COUNT_OF(pieces); i++) {
        char *text = repeat("firstlight 1 Materials { Material { } } Group { MaterialIndex 0 ",
                            pieces[i], 20000, "}");
        size_t bytes = strlen(text);
        fl_scene *scene = parse(text);
        assert_true(scene->arena.used_bytes < 16 * bytes + 65536);
        fl_scene_destroy(scene);
        fl_arena arena = {0};
        fl_diags diags = {0};
        fl_tree tree;
        assert_true(
            fl_tree_parse(&tree, text, bytes, "x", FL_DIALECT_FIRSTLIGHT, false, &arena, &diags));
        assert_true(arena.used_bytes < 100 * bytes);
        fl_arena_deinit(&arena);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_dialects),
                                       cmocka_unit_test(test_named_dialect),
                                       cmocka_unit_test(test_camera_and_defaults),
                                       cmocka_unit_test(test_no_lights_means_ambient_in_mit),
                                       cmocka_unit_test(test_light_fading),
                                       cmocka_unit_test(test_lights),
                                       cmocka_unit_test(test_materials_by_dialect),
                                       cmocka_unit_test(test_material_index_persists),
                                       cmocka_unit_test(test_transforms),
                                       cmocka_unit_test(test_nested_transforms),
                                       cmocka_unit_test(test_files_are_read_once),
                                       cmocka_unit_test(test_mesh_normals_by_dialect),
                                       cmocka_unit_test(test_curves),
                                       cmocka_unit_test(test_lenient_materials_keep_their_numbers),
                                       cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_many_errors),
                                       cmocka_unit_test(test_memory_bound)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
