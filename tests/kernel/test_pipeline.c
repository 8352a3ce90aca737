/* SPDX-License-Identifier: MIT
 *
 * The tile pipeline: same bytes whatever the grouping, the instruction set and the stages that are
 * switched on; what is not needed costs nothing; radiance in closed form where there is one.
 */
#include "pipeline_world.h"

static picture first, second;

/* A picture that lives as long as the program. */
static fl_image *colors(void)
{
    static uint8_t texels[2 * 2 * 3] = {255, 30, 20, 40, 200, 90, 10, 60, 250, 230, 220, 128};
    static fl_image image = {.width = 2, .height = 2, .format = FL_PIXEL_SRGB8, .pixels = texels};
    fl_ref_init(&image.ref);
    return &image;
}

/* Every feature at once: mirror, glass, textured plane, lens, soft light, hard lights. */
static void make_rich(world *w)
{
    world_init(w);
    w->images[w->scene.image_count++].image = colors();
    w->params.width = 32; /* 640 pixels: more than one stream */
    w->params.height = 20;
    w->params.camera.aperture = 0.2;
    w->params.camera.focus = 9;
    w->params.background = fl_v3(0.2, 0.3, 0.5);
    w->params.ambient = gray(0.1);
    w->params.depth_limit = 6;
    fl_material *floor = add_material(w);
    floor->diffuse = fl_v3(0.8, 0.7, 0.3);
    floor->image = 0;
    floor->texture_scale[0] = 3;
    add_plane(w, fl_v3(0, 1, 0), -1.5);
    fl_material *mirror = add_material(w);
    mirror->diffuse = gray(0.2);
    mirror->specular = gray(0.6);
    mirror->shininess = 40;
    mirror->reflect = fl_v3(0.7, 0.6, 0.5);
    add_sphere(w, fl_v3(-1.5, 0, 0), 1.4);
    fl_material *glass = add_material(w);
    glass->diffuse = gray(0.05);
    glass->reflect = gray(0.2);
    glass->refract = fl_v3(0.7, 0.8, 0.7);
    glass->refraction_index = 1.5;
    add_sphere(w, fl_v3(1.5, 0, 1), 1.3);
    add_square(w, fl_v3(-3, -1, -4), fl_v3(6, 0, 0), fl_v3(0, 3, 1));
    fl_light *soft = add_light(w, FL_LIGHT_DISK, fl_v3(2, 6, 5), gray(0.8));
    soft->radius = 1;
    soft->samples = 3;
    fl_light *near = add_light(w, FL_LIGHT_POINT, fl_v3(-4, 3, 4), fl_v3(4, 3, 2));
    near->attenuation[1] = 0.5;
    near->attenuation[2] = 0.1;
    add_light(w, FL_LIGHT_DIRECTIONAL, fl_v3(1, -2, -1), gray(0.2));
}

/* One matte sphere, one hard light. */
static void make_plain(world *w)
{
    world_init(w);
    add_material(w)->diffuse = fl_v3(0.5, 0.6, 0.7);
    add_sphere(w, fl_v3(0, 0, 0), 2);
    add_light(w, FL_LIGHT_POINT, fl_v3(5, 5, 8), gray(1));
}

static void grouping_does_not_matter(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 7, 64, 255, 512, 513};
    world w;
    make_rich(&w);
    fl_frame *frame = world_frame(&w, fl_cpu_best_isa());
    for (uint32_t sample = 0; sample < 3; sample++) {
        picture_render(&first, frame, sample, FL_UNIT_PIXELS, false);
        assert_int_equal(first.counts.invalid_samples, 0);
        assert_true(first.counts.reflect_rays > 50 && first.counts.refract_rays > 50);
        assert_true(first.counts.texture_lookups > 50);
        for (size_t i = 0; i < FL_COUNT_OF(sizes); i++) {
            picture_render(&second, frame, sample, sizes[i], i % 2 == 1);
            assert_same_picture(&first, &second);
            assert_int_equal(first.counts.shadow_rays, second.counts.shadow_rays);
            assert_int_equal(first.counts.sample_dimensions, second.counts.sample_dimensions);
        }
    }
    fl_frame_release(frame);
}

static void instruction_sets_agree(void **state)
{
    (void)state;
    world w;
    make_rich(&w);
    for (uint32_t blades = 0; blades < 7; blades += 6) {
        for (int sampler = FL_SAMPLER_SOBOL; sampler <= FL_SAMPLER_PADDED; sampler++) {
            w.params.sampler = (fl_sampler)sampler;
            w.params.camera.blades = blades;
            world_render(&w, FL_ISA_SCALAR, 5, &first);
            for (int isa = FL_ISA_SCALAR + 1; isa < FL_ISA_COUNT; isa++) {
                if (!fl_cpu_has((fl_isa)isa))
                    continue;
                world_render(&w, (fl_isa)isa, 5, &second);
                assert_same_picture(&first, &second);
            }
        }
    }
}

static void general_pipeline_agrees(void **state)
{
    (void)state;
    void (*const makers[])(world *) = {make_plain, make_rich};
    for (size_t i = 0; i < FL_COUNT_OF(makers); i++) {
        world w;
        makers[i](&w);
        w.params.camera.aperture = 0;
        w.lights[0].kind = FL_LIGHT_DISK;
        w.lights[0].radius = 0;
        fl_frame *frame = world_frame(&w, fl_cpu_best_isa());
        picture_render(&first, frame, 3, 256, false);
        fl_frame_generalize(frame);
        picture_render(&second, frame, 3, 256, false);
        assert_same_picture(&first, &second);
        assert_true(second.counts.sample_dimensions > first.counts.sample_dimensions);
        fl_frame_release(frame);
    }
}

static void unused_features_cost_nothing(void **state)
{
    (void)state;
    world w;
    make_plain(&w);
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    assert_int_equal(first.counts.camera_rays, 256);
    assert_int_equal(first.counts.sample_dimensions, 2 * 256);
    assert_int_equal(first.counts.reflect_rays + first.counts.refract_rays, 0);
    assert_int_equal(first.counts.texture_lookups, 0);
    uint64_t shadow_rays = first.counts.shadow_rays;
    assert_int_equal(first.counts.isect.primitive_tests, 256 + shadow_rays);
    assert_int_equal(first.counts.occlude.primitive_tests, shadow_rays);
    assert_in_range(shadow_rays, 10, 100); /* lit side of the sphere alone */

    w.params.camera.aperture = 0.1;
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    assert_int_equal(first.counts.sample_dimensions, 4 * 256);
    w.params.camera.aperture = 0;
    w.params.exact.pixel = FL_PIXEL_CENTER;
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    assert_int_equal(first.counts.sample_dimensions, 0);
    w.params.exact.no_shadows = true;
    world_render(&w, fl_cpu_best_isa(), 0, &second);
    assert_int_equal(second.counts.shadow_rays, 0);
    assert_int_equal(second.counts.occlude.primitive_tests, 0);
    w.scene.light_count = 0;
    world_render(&w, fl_cpu_best_isa(), 0, &second);
    assert_int_equal(second.counts.shadow_rays, 0);
}

/* The picture without it, and neither rays nor numbers. */
static void a_light_that_is_off_costs_nothing(void **state)
{
    (void)state;
    for (int precision = 0; precision < 2; precision++) {
        world w;
        make_rich(&w);
        w.params.precision = precision ? FL_PRECISION_DOUBLE : FL_PRECISION_FLOAT;
        for (uint32_t l = 0; l < w.scene.light_count; l++)
            w.lights[l].color = fl_v3(0, 0, 0);
        world_render(&w, fl_cpu_best_isa(), 2, &first);
        assert_int_equal(first.counts.shadow_rays, 0);
        w.scene.light_count = 0;
        world_render(&w, fl_cpu_best_isa(), 2, &second);
        assert_same_picture(&first, &second);
        assert_int_equal(first.counts.sample_dimensions, second.counts.sample_dimensions);
    }
}

static void crop_is_part_of_the_whole(void **state)
{
    (void)state;
    world w;
    make_rich(&w);
    world_render(&w, fl_cpu_best_isa(), 1, &first);
    w.params.crop_x = 5;
    w.params.crop_y = 3;
    w.params.crop_w = 11;
    w.params.crop_h = 13;
    world_render(&w, fl_cpu_best_isa(), 1, &second);
    assert_int_equal(second.count, 11 * 13);
    for (uint32_t i = 0; i < second.count; i++) {
        uint32_t whole = (3 + i / 11) * 32 + 5 + i % 11;
        assert_memory_equal(second.rgb[i], first.rgb[whole], sizeof first.rgb[0]);
    }
}

static void aperture_zero_is_a_pinhole(void **state)
{
    (void)state;
    static const double focuses[] = {1e-6, 3, 1e20};
    world w;
    make_rich(&w);
    w.params.camera.aperture = 0;
    w.params.camera.focus = HUGE_VAL;
    world_render(&w, fl_cpu_best_isa(), 2, &first);
    for (size_t i = 0; i < FL_COUNT_OF(focuses); i++) {
        w.params.camera.focus = focuses[i];
        world_render(&w, fl_cpu_best_isa(), 2, &second);
        assert_same_picture(&first, &second);
    }
    w.params.camera.aperture = 0.3;
    for (size_t i = 0; i < FL_COUNT_OF(focuses); i++) {
        w.params.camera.focus = focuses[i];
        w.params.camera.aperture = fl_min(0.3, focuses[i] * 1e6);
        world_render(&w, fl_cpu_best_isa(), 2, &second);
        assert_int_equal(second.counts.invalid_samples, 0);
        assert_true(memcmp(first.rgb, second.rgb, sizeof first.rgb) != 0);
    }
}

/* The centre pixel of a plane that faces the camera. */
static void phong_in_closed_form(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.width = w.params.height = 1;
    w.params.exact.pixel = FL_PIXEL_CENTER;
    w.params.ambient = fl_v3(0.1, 0.2, 0.3);
    fl_material *m = add_material(&w);
    m->diffuse = fl_v3(0.5, 0.25, 1);
    m->specular = fl_v3(1, 0.5, 0.25);
    m->shininess = 3;
    add_plane(&w, fl_v3(0, 0, 1), 0);
    fl_light *l =
        add_light(&w, FL_LIGHT_POINT, fl_v3(3, 0, 4), fl_v3(2, 4, 8)); /* 5 away, cosine 0.8 */
    world_render(&w, FL_ISA_SCALAR, 0, &first);
    double lobe = 0.8 * 0.8 * 0.8;
    assert_near((double)first.rgb[0][0], 0.05 + 2 * (0.5 * 0.8 + lobe), 1e-5);
    assert_near((double)first.rgb[0][1], 0.05 + 4 * (0.25 * 0.8 + 0.5 * lobe), 1e-5);
    assert_near((double)first.rgb[0][2], 0.3 + 8 * (0.8 + 0.25 * lobe), 1e-5);
    assert_int_equal(first.counts.shadow_rays, 1);

    l->attenuation[0] = 1;
    l->attenuation[1] = 2;
    l->attenuation[2] = 0.5; /* 1 + 10 + 12.5 */
    m->has_ambient = true;
    m->ambient = gray(2);
    world_render(&w, FL_ISA_SCALAR, 0, &first);
    assert_near((double)first.rgb[0][0], 0.2 + 2 * (0.5 * 0.8 + lobe) / 23.5, 1e-5);

    /* From behind: neither light nor shadow ray, whichever way the normal points. */
    for (int side = -1; side <= 1; side += 2) {
        l->position = fl_v3(3, 0, -4);
        w.objects[0].as.plane.normal = fl_v3(0, 0, side);
        world_render(&w, FL_ISA_SCALAR, 0, &first);
        assert_near((double)first.rgb[0][0], 0.2, 1e-6);
        assert_int_equal(first.counts.shadow_rays, 0);
    }
    /* The courses shade the side of the normal only. */
    l->position = fl_v3(3, 0, 4);
    w.params.exact.no_normal_flip = true;
    m->specular = gray(0);
    world_render(&w, FL_ISA_SCALAR, 0, &first);
    assert_true(first.rgb[0][0] > 0.21f);
    w.objects[0].as.plane.normal = fl_v3(0, 0, -1);
    world_render(&w, FL_ISA_SCALAR, 0, &first);
    assert_near((double)first.rgb[0][0], 0.2, 1e-6);
}

static void samples_of_a_light_are_averaged(void **state)
{
    (void)state;
    world w;
    make_plain(&w);
    w.params.exact.pixel = FL_PIXEL_CENTER; /* so that the samples differ in the light alone */
    w.lights[0].kind = FL_LIGHT_DISK;
    w.lights[0].radius = 3;
    w.params.light_samples = 4;
    world_render(&w, fl_cpu_best_isa(), 2, &second);
    float sum[256][3] = {{0}};
    w.params.light_samples = 1;
    for (uint32_t j = 0; j < 4; j++) {
        world_render(&w, fl_cpu_best_isa(), 2 * 4 + j, &first);
        for (int i = 0; i < 256; i++)
            for (int c = 0; c < 3; c++)
                sum[i][c] += first.rgb[i][c];
    }
    int lit = 0;
    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 3; c++) {
            lit += sum[i][c] > 0.0f;
            assert_true(sum[i][c] / 4.0f == second.rgb[i][c]);
        }
    assert_true(lit > 100);
    assert_true(second.counts.sample_dimensions % 8 == 0 &&
                second.counts.sample_dimensions > 8 * 30);
}

static void light_counts_come_from_the_right_place(void **state)
{
    (void)state;
    world w;
    make_rich(&w);
    w.params.light_samples_default = 5;
    fl_frame *frame = world_frame(&w, FL_ISA_SCALAR);
    assert_int_equal(frame->lights[0].samples, 3);
    assert_int_equal(frame->lights[1].samples, 1);
    fl_frame_release(frame);
    w.lights[0].samples = 0;
    frame = world_frame(&w, FL_ISA_SCALAR);
    assert_int_equal(frame->lights[0].samples, 5);
    fl_frame_release(frame);
    w.params.light_samples = 7;
    frame = world_frame(&w, FL_ISA_SCALAR);
    assert_int_equal(frame->lights[0].samples, 7);
    assert_int_equal(frame->lights[2].samples, 1);
    fl_frame_release(frame);
}

static void one_sided_disks_light_their_front(void **state)
{
    (void)state;
    world w;
    make_plain(&w);
    fl_light *l = &w.lights[0];
    l->kind = FL_LIGHT_DISK;
    l->radius = 0.5;
    l->is_two_sided = false;
    l->direction = fl_v3_normalize(fl_v3(-5, -5, -8));
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    l->is_two_sided = true;
    world_render(&w, fl_cpu_best_isa(), 0, &second);
    assert_same_picture(&first, &second);
    assert_true(first.counts.shadow_rays > 0);
    l->is_two_sided = false;
    l->direction = fl_v3_scale(l->direction, -1);
    world_render(&w, fl_cpu_best_isa(), 0, &second);
    assert_int_equal(second.counts.shadow_rays, 0);
}

/* A light in the plane of a panel is not hidden by it; one above a roof is. */
static void shadow_rays_end_before_the_light(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.width = w.params.height = 8;
    add_material(&w);
    add_plane(&w, fl_v3(0, 0, 1), 0);
    add_square(&w, fl_v3(-3, 4.1, 1), fl_v3(6, 0, 0), fl_v3(0, 0, 5));
    fl_light *l = add_light(&w, FL_LIGHT_DISK, fl_v3(0.3, 4.1, 3.3), gray(1));
    l->radius = 1;
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    for (uint32_t i = 0; i < first.count; i++)
        assert_true(first.rgb[i][0] > 0.0f);
    assert_int_equal(first.counts.shadow_rays, 64);
    l->position.y = 4.2;
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    uint32_t dark = 0;
    for (uint32_t i = 0; i < first.count; i++)
        dark += first.rgb[i][0] == 0.0f;
    assert_true(dark > 30);
}

static void glass_and_mirrors_in_a_furnace(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.background = gray(1);
    w.params.weight_threshold = 0;
    w.params.depth_limit = 4;
    fl_material *m = add_material(&w);
    m->diffuse = gray(0);
    m->reflect = gray(1);
    add_sphere(&w, fl_v3(0, 0, 0), 3);
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    for (uint32_t i = 0; i < first.count; i++)
        assert_true(first.rgb[i][0] == 1.0f && first.rgb[i][2] == 1.0f);
    assert_true(first.counts.reflect_rays > 100);
    m->reflect = gray(0);
    m->refract = gray(1);
    m->refraction_index = 1.7;
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    for (uint32_t i = 0; i < first.count; i++)
        assert_true(first.rgb[i][0] == 1.0f && first.rgb[i][2] == 1.0f);
    assert_true(first.counts.refract_rays > 200 && first.counts.refract_rays % 2 == 0);
    w.params.depth_limit = 1;
    world_render(&w, fl_cpu_best_isa(), 0, &second);
    for (uint32_t i = 0; i < first.count; i++)
        assert_true(second.rgb[i][0] == 0.0f || second.rgb[i][0] == 1.0f);
    assert_int_equal(2 * second.counts.refract_rays, first.counts.refract_rays);
}

/* From inside a medium (n = 1.5, critical angle 41.8 degrees) through its plane face. */
static void total_reflection_takes_both_weights(void **state)
{
    (void)state;
    static const double angles[] = {41.0, 42.5};
    for (int i = 0; i < 2; i++) {
        world w;
        world_init(&w);
        w.params.width = w.params.height = 1;
        w.params.exact.pixel = FL_PIXEL_CENTER;
        w.params.background = gray(1);
        double a = angles[i] * 3.14159265358979 / 180;
        w.params.camera.direction = fl_v3(sin(a), cos(a), 0);
        w.params.camera.up = fl_v3(0, 0, 1);
        w.params.camera.center = fl_v3(0, -1, 0);
        fl_material *m = add_material(&w);
        m->diffuse = gray(0);
        m->reflect = gray(0.25);
        m->refract = gray(0.5);
        m->refraction_index = 1.5;
        add_plane(&w, fl_v3(0, 1, 0), 0);
        world_render(&w, fl_cpu_best_isa(), 0, &first);
        assert_true(first.rgb[0][0] == 0.75f);
        assert_int_equal(first.counts.reflect_rays, 1);
        assert_int_equal(first.counts.refract_rays, i == 0 ? 1 : 0);
    }
}

/* Between two parallel mirrors. */
static void depth_and_weight_end_the_recursion(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.width = w.params.height = 2;
    w.params.weight_threshold = 0;
    fl_material *m = add_material(&w);
    m->diffuse = gray(1);
    m->reflect = fl_v3(0.5, 0.25, 0.125);
    w.params.ambient = gray(1);
    add_plane(&w, fl_v3(0, 0, 1), 0);
    add_plane(&w, fl_v3(0, 0, 1), 20);
    for (uint32_t depth = 0; depth <= 8; depth++) {
        w.params.depth_limit = depth;
        world_render(&w, fl_cpu_best_isa(), 0, &first);
        assert_int_equal(first.counts.reflect_rays, 4 * depth);
        assert_near((double)first.rgb[0][0], 2.0 - pow(0.5, (double)depth), 1e-6);
    }
    w.params.depth_limit = FL_DEPTH_MAX;
    w.params.weight_threshold = 1.0 / 16;
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    assert_int_equal(first.counts.reflect_rays, 4 * 4);
    w.params.exact.no_recursion = true;
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    assert_int_equal(first.counts.reflect_rays, 0);
}

static void transparent_shadows_multiply(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.width = w.params.height = 1;
    w.params.depth_limit = 0;
    w.params.exact.pixel = FL_PIXEL_CENTER;
    add_material(&w);
    add_plane(&w, fl_v3(0, 0, 1), 0);
    fl_light *l = add_light(&w, FL_LIGHT_POINT, fl_v3(3, 0, 4), gray(1));
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    assert_near((double)first.rgb[0][0], 0.8, 1e-6);
    add_material(&w)->refract = fl_v3(0.5, 1, 0.25);
    add_square(&w, fl_v3(1, -1, 2), fl_v3(1, 0, 0), fl_v3(0, 2, 0));
    add_square(&w, fl_v3(1, -1, 2.4), fl_v3(1.6, 0, 0), fl_v3(0, 2, 0));
    world_render(&w, fl_cpu_best_isa(), 0, &second);
    assert_true(second.rgb[0][0] == 0.0f);
    w.params.transparent_shadows = true;
    for (int pass = 0; pass < 2; pass++) {
        world_render(&w, fl_cpu_best_isa(), 0, &second);
        assert_near((double)second.rgb[0][0], 0.2, 1e-6);
        assert_near((double)second.rgb[0][1], 0.8, 1e-6);
        assert_near((double)second.rgb[0][2], 0.05, 1e-6);
        l->kind = FL_LIGHT_DIRECTIONAL;
        l->direction = fl_v3(-0.6, 0, -0.8);
    }
    w.materials[1].refract = gray(0);
    world_render(&w, fl_cpu_best_isa(), 0, &second);
    assert_true(second.rgb[0][0] == 0.0f);
}

static void bad_samples_are_counted_not_shown(void **state)
{
    (void)state;
    world w;
    make_plain(&w);
    w.lights[0].color = gray(-1);
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    assert_int_equal(first.counts.invalid_samples, 0);
    float least = 0.0f;
    for (uint32_t i = 0; i < first.count; i++)
        least = first.rgb[i][0] < least ? first.rgb[i][0] : least;
    assert_true(least < -0.3f);

    w.lights[0].attenuation[0] = 0; /* divides by zero */
    world_render(&w, fl_cpu_best_isa(), 0, &first);
    uint32_t bad = 0;
    for (uint32_t i = 0; i < first.count; i++) {
        bad += !first.is_valid[i];
        assert_true(isfinite(first.rgb[i][0]));
    }
    assert_true(bad > 30);
    assert_int_equal(first.counts.invalid_samples, bad);
    assert_int_equal(first.counts.samples, 256);
}

/* Shells within shells: two branches at every hit, none of which ends. */
static void pending_rays_are_bounded(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.width = w.params.height = 4;
    w.params.camera.fov_deg = 10;
    w.params.background = gray(1);
    w.params.weight_threshold = 0;
    w.params.depth_limit = 14;
    fl_material *m = add_material(&w);
    m->diffuse = gray(0.1);
    m->reflect = fl_v3(0.5, 0.4, 0.3);
    m->refract = fl_v3(0.4, 0.5, 0.6);
    m->refraction_index = 1.05;
    for (int i = 1; i <= 8; i++)
        add_sphere(&w, fl_v3(0, 0, 0), 0.4 * i);
    fl_frame *frame = world_frame(&w, fl_cpu_best_isa());
    picture_render(&first, frame, 0, 16, false);
    assert_true(first.counts.dropped_branches > 100);
    uint64_t rays = first.counts.reflect_rays + first.counts.refract_rays;
    assert_in_range(rays, 16 * 64, 16 * 64 * 14);
    picture_render(&second, frame, 0, 3, true);
    assert_same_picture(&first, &second);
    assert_int_equal(first.counts.dropped_branches, second.counts.dropped_branches);
    fl_frame_release(frame);
}

static void stale_work_stops(void **state)
{
    (void)state;
    world w;
    make_rich(&w);
    fl_frame *frame = world_frame(&w, fl_cpu_best_isa());
    fl_workspace *workspace = fl_workspace_create();
    uint16_t x[2] = {0, 1}, y[2] = {0, 0};
    fl_unit unit = {x, y, 2, 0};
    fl_counts counts = {0};
    atomic_uint_least64_t generation;
    atomic_init(&generation, 7);
    bool out_of_memory = true;
    assert_false(fl_pipeline_run(frame, &unit, workspace, &generation, 6, &counts, &out_of_memory));
    assert_false(out_of_memory);
    assert_int_equal(counts.samples + counts.camera_rays, 0);
    assert_true(fl_pipeline_run(frame, &unit, workspace, &generation, 7, &counts, &out_of_memory));
    assert_int_equal(counts.samples, 2);
    fl_workspace_destroy(workspace);
    fl_frame_release(frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grouping_does_not_matter),
        cmocka_unit_test(instruction_sets_agree),
        cmocka_unit_test(general_pipeline_agrees),
        cmocka_unit_test(unused_features_cost_nothing),
        cmocka_unit_test(a_light_that_is_off_costs_nothing),
        cmocka_unit_test(crop_is_part_of_the_whole),
        cmocka_unit_test(aperture_zero_is_a_pinhole),
        cmocka_unit_test(phong_in_closed_form),
        cmocka_unit_test(samples_of_a_light_are_averaged),
        cmocka_unit_test(light_counts_come_from_the_right_place),
        cmocka_unit_test(one_sided_disks_light_their_front),
        cmocka_unit_test(shadow_rays_end_before_the_light),
        cmocka_unit_test(glass_and_mirrors_in_a_furnace),
        cmocka_unit_test(total_reflection_takes_both_weights),
        cmocka_unit_test(depth_and_weight_end_the_recursion),
        cmocka_unit_test(transparent_shadows_multiply),
        cmocka_unit_test(bad_samples_are_counted_not_shown),
        cmocka_unit_test(pending_rays_are_bounded),
        cmocka_unit_test(stale_work_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
