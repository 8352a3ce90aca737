/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/params.h"

static fl_params defaults(void)
{
    fl_scene scene;
    fl_params params;
    memset(&scene, 0, sizeof scene);
    fl_params_from_scene(&params, &scene, false);
    return params;
}

/* The first message for these parameters, or "" if they pass. */
static const char *message_of(const fl_params *params)
{
    static char message[512];
    fl_diags diags = {0};
    bool is_fine = fl_params_check(params, &diags);
    assert_int_equal(is_fine, diags.error_count == 0);
    snprintf(message, sizeof message, "%s", diags.count ? diags.items[0].message : "");
    fl_diags_deinit(&diags);
    return message;
}

static void an_empty_scene_has_usable_defaults(void **state)
{
    (void)state;
    fl_params p = defaults();
    assert_string_equal(message_of(&p), "");
    assert_int_equal(p.width, 640);
    assert_int_equal(p.height, 640);
    assert_int_equal(p.depth_limit, FL_DEPTH_DEFAULT);
    assert_true(p.weight_threshold == 1.0 / 1024.0);
    assert_true(p.camera.aperture == 0.0 && isinf(p.camera.focus));
    assert_int_equal(p.light_samples, 0);
    assert_int_equal(p.light_samples_default, 1);
    assert_int_equal(p.exact.pixel, FL_PIXEL_AREA);
    assert_false(p.transparent_shadows);
}

/* Tables are indexed by these; a saved picture may say anything. */
static void unknown_kinds_are_refused(void **state)
{
    (void)state;
    fl_params p = defaults();
    p.sampler = (fl_sampler)4294967295u;
    assert_non_null(strstr(message_of(&p), "sampler number"));
    p = defaults();
    p.precision = (fl_precision)7;
    assert_non_null(strstr(message_of(&p), "precision number"));
}

static void the_scene_overrides(void **state)
{
    (void)state;
    fl_scene scene;
    fl_params p;
    memset(&scene, 0, sizeof scene);
    scene.has_camera = true;
    scene.camera = (fl_camera){.direction = {0, 0, -2},
                               .up = {0, 1, 0},
                               .fov_deg = 50,
                               .focus = 4,
                               .aperture = 0.5,
                               .width = 200,
                               .height = 100};
    scene.render = (fl_render_block){.has_depth = true,
                                     .depth = 0,
                                     .has_light_samples = true,
                                     .light_samples = 9,
                                     .has_weight_threshold = true,
                                     .has_transparent_shadows = true,
                                     .transparent_shadows = true};
    scene.background.color = fl_v3(1, 2, 3);
    scene.background.ambient = fl_v3(4, 5, 6);
    fl_params_from_scene(&p, &scene, false);
    assert_string_equal(message_of(&p), "");
    assert_true(p.width == 200 && p.height == 100 && p.depth_limit == 0);
    assert_true(p.light_samples == 0 && p.light_samples_default == 9);
    assert_true(p.weight_threshold == 0.0 && p.transparent_shadows);
    assert_true(p.background.z == 3.0 && p.ambient.x == 4.0 && p.camera.aperture == 0.5);
}

static void dialects_have_their_rules(void **state)
{
    (void)state;
    static const fl_camera_model models[] = {FL_CAMERA_VERTICAL_FOV, FL_CAMERA_VERTICAL_FOV,
                                             FL_CAMERA_UNIT_SQUARE, FL_CAMERA_RAW_UP};
    static const fl_pixel_rule rules[] = {FL_PIXEL_AREA, FL_PIXEL_CORNER, FL_PIXEL_CENTER,
                                          FL_PIXEL_GRID_ENDS};
    for (int dialect = 0; dialect < FL_DIALECT_COUNT; dialect++) {
        fl_scene scene;
        fl_params p;
        memset(&scene, 0, sizeof scene);
        scene.dialect = (fl_dialect)dialect;
        fl_params_from_scene(&p, &scene, false);
        assert_int_equal(p.camera_model, models[dialect]);
        assert_true(p.exact.pixel == FL_PIXEL_AREA && !p.exact.no_shadows &&
                    !p.exact.truncate_bytes);
        fl_params_from_scene(&p, &scene, true);
        bool is_course = dialect != FL_DIALECT_FIRSTLIGHT;
        assert_int_equal(p.exact.pixel, rules[dialect]);
        assert_true(p.exact.no_shadows == is_course && p.exact.no_recursion == is_course);
        assert_true(p.exact.ungated_specular == is_course && p.exact.no_normal_flip == is_course);
        assert_true(p.exact.truncate_bytes == is_course);
    }
}

#define REJECTS(change, word)                                                                      \
    do {                                                                                           \
        fl_params p = defaults();                                                                  \
        change;                                                                                    \
        if (!strstr(message_of(&p), word))                                                         \
            fail_msg("'%s' gave '%s'", #change, message_of(&p));                                   \
    } while (0)

#define ACCEPTS(change)                                                                            \
    do {                                                                                           \
        fl_params p = defaults();                                                                  \
        change;                                                                                    \
        assert_string_equal(message_of(&p), "");                                                   \
    } while (0)

static void bounds_are_enforced(void **state)
{
    (void)state;
    const double inf = HUGE_VAL, nan = inf - inf;
    REJECTS(p.width = 0, "size");
    REJECTS(p.height = FL_SIDE_MAX + 1, "size");
    ACCEPTS(p.width = FL_SIDE_MAX);
    REJECTS((p.crop_w = 10, p.crop_h = 0), "crop");
    REJECTS((p.crop_w = 10, p.crop_h = 10, p.crop_x = 631), "crop");
    REJECTS((p.crop_w = UINT32_MAX, p.crop_h = 10, p.crop_x = 1), "crop");
    ACCEPTS((p.crop_w = 10, p.crop_h = 10, p.crop_x = 630, p.crop_y = 630));
    REJECTS(p.depth_limit = FL_DEPTH_MAX + 1, "depth");
    ACCEPTS(p.depth_limit = FL_DEPTH_MAX);
    REJECTS(p.solver = FL_REVOLVE_MAX_STARTS + 1, "Newton");
    ACCEPTS(p.solver = FL_REVOLVE_MAX_STARTS);
    REJECTS(p.weight_threshold = -1, "threshold");
    REJECTS(p.weight_threshold = nan, "threshold");
    REJECTS(p.light_samples = FL_LIGHT_SAMPLES_MAX + 1, "light samples");
    REJECTS((p.sampler = FL_SAMPLER_STRATIFIED, p.strata = FL_STRATA_MAX + 1),
            "at most 16777216 with 1 light samples");
    ACCEPTS((p.sampler = FL_SAMPLER_STRATIFIED, p.strata = FL_STRATA_MAX));
    REJECTS(
        (p.sampler = FL_SAMPLER_STRATIFIED, p.light_samples = FL_LIGHT_SAMPLES_MAX, p.strata = 17),
        "at most 16 with 1048576 light samples");
    ACCEPTS(
        (p.sampler = FL_SAMPLER_STRATIFIED, p.light_samples = FL_LIGHT_SAMPLES_MAX, p.strata = 16));
    REJECTS(p.camera.fov_deg = nextafter(FL_FOV_MIN_DEG, 0.0), "from 0.01 to 179 degrees");
    REJECTS(p.camera.fov_deg = nextafter(FL_FOV_MAX_DEG, 180.0), "from 0.01 to 179 degrees");
    ACCEPTS(p.camera.fov_deg = FL_FOV_MIN_DEG);
    ACCEPTS(p.camera.fov_deg = FL_FOV_MAX_DEG);
    REJECTS(p.background.x = inf, "background");
    REJECTS(p.ambient.y = 1e300, "ambient");
    REJECTS(p.camera.fov_deg = nan, "field of view");
    REJECTS(p.camera.aperture = -1e-9, "'aperture'");
    REJECTS(p.camera.aperture = inf, "'aperture'");
    REJECTS(p.camera.focus = 0, "'focus'");
    REJECTS(p.camera.focus = nan, "'focus'");
    REJECTS((p.camera.focus = 1e-6, p.camera.aperture = 1e6), "'aperture'");
    ACCEPTS((p.camera.focus = 1e-6, p.camera.aperture = 1));
    ACCEPTS((p.camera.focus = inf, p.camera.aperture = 1));
    REJECTS(p.camera.blades = 2, "'blades'");
    REJECTS(p.camera.blades = 10, "'blades'");
    ACCEPTS(p.camera.blades = 9);
    REJECTS(p.camera.blade_rotation_deg = nan, "'bladeRotation'");
    REJECTS(p.camera.exposure_ev = inf, "'exposure'");
    REJECTS(p.camera.direction = fl_v3(0, 0, 0), "'direction'");
    REJECTS(p.camera.up = fl_v3(0, 0, 0), "'up'");
    REJECTS(p.camera.up = fl_v3(0, 0, 7), "parallel");
    ACCEPTS(p.camera.up = fl_v3(0, 1e-30, 0));
    REJECTS(p.camera.center.x = nan, "'center'");
    REJECTS((p.camera.projection = FL_ORTHOGRAPHIC, p.camera.ortho_size = 0), "'size'");
}

static void lights_are_checked_where_they_stand(void **state)
{
    (void)state;
    fl_light light = {.kind = FL_LIGHT_DISK,
                      .direction = {0, -1, 0},
                      .color = {1, 1, 1},
                      .attenuation = {1, 0, 0},
                      .radius = -1,
                      .loc = {"scene.txt", 7, 3, 4}};
    fl_params p = defaults();
    p.lights = &light;
    p.light_count = 1;
    fl_diags diags = {0};
    assert_false(fl_params_check(&p, &diags));
    assert_non_null(strstr(diags.items[0].message, "'radius'"));
    assert_int_equal(diags.items[0].loc.line, 7);
    fl_diags_deinit(&diags);
    light.radius = 0;
    light.color.x = -5; /* negative colours are legal */
    assert_string_equal(message_of(&p), "");
    light.direction.y = 0;
    assert_non_null(strstr(message_of(&p), "'direction'"));
    light.direction.y = -1;
    light.radius = light.position.z = FL_COORDINATE_MAX;
    assert_string_equal(message_of(&p), "");
    light.position.z *= 1.01; /* The square of the way to it would soon be no float. */
    assert_non_null(strstr(message_of(&p), "'position'"));
    light.position.z = 0;
    light.radius *= 1.01;
    assert_non_null(strstr(message_of(&p), "'radius'"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_scene_has_usable_defaults),
        cmocka_unit_test(unknown_kinds_are_refused),
        cmocka_unit_test(the_scene_overrides),
        cmocka_unit_test(dialects_have_their_rules),
        cmocka_unit_test(bounds_are_enforced),
        cmocka_unit_test(lights_are_checked_where_they_stand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
