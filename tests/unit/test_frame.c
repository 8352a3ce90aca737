/* SPDX-License-Identifier: MIT */
#include "../kernel/pipeline_world.h"

#include "core/math64.h"
#include "core/pipeline_work.h"

static fl_frame *frame_of(world *w)
{
    if (w->scene.object_count == 0) {
        add_material(w);
        add_sphere(w, fl_v3(0, 0, 0), 1);
    }
    return world_frame(w, FL_ISA_SCALAR);
}

/* Where the ray through (x, y) meets the plane at depth 1, in units of tan(fov / 2) to the right
 * and up. */
static void screen_at(const fl_frame *f, double x, double y, double *out_h, double *out_v)
{
    fl_vec3 o, d;
    fl_frame_ray(f, x, y, 0, 0, &o, &d);
    double t = fl_d_tan_deg(f->params.camera.fov_deg / 2);
    assert_near(fl_v3_dot(d, f->axis_w), 1, 1e-14);
    *out_h = fl_v3_dot(d, f->axis_h) / t;
    *out_v = fl_v3_dot(d, f->axis_v) / t;
}

static void vertical_field_of_view(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.width = 30;
    w.params.height = 20;
    w.params.camera.up = fl_v3(0, 3, -2); /* orthogonalised */
    fl_frame *f = frame_of(&w);
    double h, v;
    screen_at(f, 15, 10, &h, &v);
    assert_near(h, 0, 1e-15);
    assert_near(v, 0, 1e-15);
    screen_at(f, 30, 0, &h, &v); /* the top right corner */
    assert_near(h, 1.5, 1e-12);
    assert_near(v, 1, 1e-12);
    assert_near(f->axis_h.x, 1, 1e-15);
    assert_near(f->axis_v.y, 1, 1e-15);
    assert_int_equal(f->plan.dimensions, 2);
    fl_frame_release(f);
}

static void the_courses_put_samples_where_they_did(void **state)
{
    (void)state;
    static const struct {
        fl_camera_model model;
        fl_pixel_rule rule;
        double h0, v0, h1, v1; /* of the top left and the bottom right pixel; 20 wide, 10 high */
    } cases[] = {
        {FL_CAMERA_VERTICAL_FOV, FL_PIXEL_CORNER, -2, 0.8, 1.8, -1},
        {FL_CAMERA_VERTICAL_FOV, FL_PIXEL_CENTER, -1.9, 0.9, 1.9, -0.9},
        {FL_CAMERA_UNIT_SQUARE, FL_PIXEL_CENTER, -0.95, 0.9, 0.95, -0.9},
        {FL_CAMERA_RAW_UP, FL_PIXEL_GRID_ENDS, -1, 1, 1, -1},
    };
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        world w;
        world_init(&w);
        w.params.width = 20;
        w.params.height = 10;
        w.params.camera_model = cases[i].model;
        w.params.exact.pixel = cases[i].rule;
        fl_frame *f = frame_of(&w);
        double h, v;
        screen_at(f, f->pixel_x, f->pixel_y, &h, &v);
        assert_near(h, cases[i].h0, 1e-12);
        assert_near(v, cases[i].v0, 1e-12);
        screen_at(f, 19 + f->pixel_x, 9 + f->pixel_y, &h, &v);
        assert_near(h, cases[i].h1, 1e-12);
        assert_near(v, cases[i].v1, 1e-12);
        assert_int_equal(f->plan.dimensions, 0);
        fl_frame_release(f);
    }
}

static void raw_up_is_used_as_given(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.camera_model = FL_CAMERA_RAW_UP;
    w.params.camera.up = fl_v3(0, 2, 1);
    fl_frame *f = frame_of(&w);
    assert_true(f->axis_v.y == 2 && f->axis_v.z == 1);
    assert_near(f->axis_h.x, 1, 1e-15);
    fl_frame_release(f);
    w.params.width = w.params.height = 1;
    w.params.exact.pixel = FL_PIXEL_GRID_ENDS; /* one point is the middle */
    f = frame_of(&w);
    fl_vec3 o, d;
    fl_frame_ray(f, f->pixel_x, f->pixel_y, 0, 0, &o, &d);
    assert_true(fabs(d.x) < 1e-15 && fabs(d.y) < 1e-15);
    fl_frame_release(f);
}

static void the_lens_focuses_on_a_plane(void **state)
{
    (void)state;
    static const double focuses[] = {1e-6, 0.5, 8, 1e20, HUGE_VAL};
    for (size_t i = 0; i < FL_COUNT_OF(focuses); i++) {
        world w;
        world_init(&w);
        double focus = w.params.camera.focus = focuses[i];
        w.params.camera.aperture = fl_min(0.25, focus * 1e3);
        fl_frame *f = frame_of(&w);
        assert_int_equal(f->plan.dimensions, 4);
        for (int corner = 0; corner < 4; corner++) {
            fl_vec3 o, d, o0, d0;
            double lx = corner & 1 ? 0.6 : -1, ly = corner & 2 ? 0.8 : 0;
            fl_frame_ray(f, 3.25, 14.5, lx, ly, &o, &d);
            fl_frame_ray(f, 3.25, 14.5, 0, 0, &o0, &d0);
            assert_true(fl_v3_is_finite(d));
            assert_near(fl_v3_length(fl_v3_sub(o, o0)), f->aperture * sqrt(lx * lx + ly * ly),
                        1e-12);
            assert_near(fl_v3_dot(d, f->axis_w), 1, 1e-12);
            if (isinf(focus)) {
                assert_near(fl_v3_length(fl_v3_sub(d, d0)), 0, 1e-15);
                continue;
            }
            fl_vec3 a = fl_v3_mad(o, d, focus), b = fl_v3_mad(o0, d0, focus);
            assert_near(fl_v3_length(fl_v3_sub(a, b)), 0, 1e-14 * (1 + focus));
        }
        fl_frame_release(f);
    }
}

static void parallel_rays(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.width = 20;
    w.params.height = 10;
    w.params.camera.projection = FL_ORTHOGRAPHIC;
    w.params.camera.ortho_size = 4;
    fl_frame *f = frame_of(&w);
    fl_vec3 o, d;
    fl_frame_ray(f, 20, 0, 0, 0, &o, &d);
    assert_near(o.x + f->scene->geometry.origin.x, 4, 1e-12);
    assert_near(o.y + f->scene->geometry.origin.y, 2, 1e-12);
    assert_near(o.z + f->scene->geometry.origin.z, 10, 1e-12);
    assert_true(d.x == 0 && d.y == 0 && d.z == -1);
    fl_frame_release(f);
    /* In M04 the view is square, and what lies behind the camera is seen too. */
    w.params.camera_model = FL_CAMERA_UNIT_SQUARE;
    w.params.camera.center = fl_v3(0, 0, -5);
    f = frame_of(&w);
    fl_frame_ray(f, 20, 0, 0, 0, &o, &d);
    assert_near(o.x + f->scene->geometry.origin.x, 2, 1e-12);
    assert_true(o.z + f->scene->geometry.origin.z > 1);
    fl_frame_release(f);
}

/* The kernels' rays are this frame's rays, rounded once. */
static void kernels_generate_these_rays(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.width = 300;
    w.params.height = 200;
    w.params.camera.direction = fl_v3(0.3, -0.2, -1);
    w.params.camera.center = fl_v3(100, 3, 20);
    w.params.camera.aperture = 0.5;
    w.params.camera.focus = 7;
    w.params.camera.blades = 5;
    w.params.camera.blade_rotation_deg = 20;
    fl_frame *f = frame_of(&w);
    fl_workspace *workspace = fl_workspace_create();
    fl_stage *s = &workspace->stage;
    uint16_t x[FL_STREAM_RAYS], y[FL_STREAM_RAYS];
    for (uint32_t i = 0; i < FL_STREAM_RAYS; i++) {
        x[i] = (uint16_t)(i * 299 / FL_STREAM_RAYS);
        y[i] = (uint16_t)(i * 7 % 200);
    }
    fl_unit unit = {x, y, FL_STREAM_RAYS, 11};
    fl_shade_kernels_scalar.generate(f, &unit, 6, 250, s);
    assert_int_equal(s->rays.count, 250);
    for (uint32_t i = 0; i < 250; i++) {
        uint32_t px = x[i + 6], py = y[i + 6], id = fl_pixel_id(px, py);
        float u[4], lens_x, lens_y;
        for (uint32_t k = 0; k < 4; k++)
            u[k] = fl_sample_scalar(FL_SAMPLER_SOBOL, 0, id, 11, FL_SET_CAMERA, k);
        fl_f_warp_aperture(&f->opening, u[2], u[3], &lens_x, &lens_y);
        fl_vec3 o, d;
        fl_frame_ray(f, (double)px + (double)u[0], (double)py + (double)u[1], (double)lens_x,
                     (double)lens_y, &o, &d);
        assert_true(s->rays.ox[i] == (float)o.x && s->rays.oy[i] == (float)o.y &&
                    s->rays.oz[i] == (float)o.z);
        assert_true(s->rays.dx[i] == (float)d.x && s->rays.dy[i] == (float)d.y &&
                    s->rays.dz[i] == (float)d.z);
        assert_true(s->pixel[i] == id && s->path[i] == FL_PATH_CAMERA && isinf(s->rays.t_max[i]));
    }
    fl_workspace_destroy(workspace);
    fl_frame_release(f);
}

static void lights_are_prepared(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    add_light(&w, FL_LIGHT_DIRECTIONAL, fl_v3(0, 0, -3), gray(1));
    fl_light *disk = add_light(&w, FL_LIGHT_DISK, fl_v3(1, 2, 3), gray(1));
    disk->direction = fl_v3_normalize(fl_v3(1, -2, 0.5));
    disk->radius = 2;
    disk->samples = 6;
    fl_light *dot = add_light(&w, FL_LIGHT_DISK, fl_v3(1, 2, 3), gray(1));
    dot->samples = 6; /* radius 0: one exact ray */
    fl_frame *f = frame_of(&w);
    assert_true(f->lights[0].to_light[2] == 1.0f && !f->lights[0].has_attenuation);
    const fl_frame_light *l = &f->lights[1];
    double uu = 0, uv = 0, vv = 0, un = 0, vn = 0;
    for (int c = 0; c < 3; c++) {
        double u = (double)l->axis_u[c], v = (double)l->axis_v[c], n = (double)l->normal[c];
        uu += u * u;
        uv += u * v;
        vv += v * v;
        un += u * n;
        vn += v * n;
    }
    assert_near(uu, 4, 1e-5);
    assert_near(vv, 4, 1e-5);
    assert_near(fabs(uv) + fabs(un) + fabs(vn), 0, 1e-5);
    assert_true(l->draws && l->samples == 6 && l->index == 1);
    assert_true(!f->lights[2].draws && f->lights[2].samples == 1);
    /* The frame keeps its own copy. */
    w.lights[1].color = gray(7);
    assert_true(f->params.lights[1].color.x == 1);
    fl_frame_retain(f);
    fl_frame_release(f);
    fl_frame_release(f);
}

typedef struct branch {
    uint32_t slot, path;
    float weight;
} branch;

static branch branch_of(const fl_branches *b, uint32_t i)
{
    float rg = fmaxf(b->number[6][i], b->number[7][i]);
    return (branch){b->word[FL_BRANCH_SLOT][i], b->word[FL_BRANCH_PATH][i],
                    fmaxf(rg, b->number[8][i])};
}

/* Against the definition: the heaviest of each slot, of equals the higher path, in order of path.
 */
static void branches_settle(void **state)
{
    (void)state;
    fl_branches b = {0};
    uint32_t seed = 4711, dropped_want = 0;
    print_message("seed %u\n", seed);
    for (uint32_t slot = 0; slot < 40; slot++) {
        uint32_t n = slot % 3 == 0 ? 1 + slot : 60 + slot;
        assert_true(fl_branches_reserve(&b, n));
        for (uint32_t i = 0; i < n; i++) {
            seed = fl_lowbias32(seed + 0x9E3779B9u);
            for (int k = 0; k < FL_BRANCH_NUMBERS; k++)
                b.number[k][b.count] = k < 6 ? (float)(k * 100000) + (float)b.count : 0.0f;
            b.number[6 + seed % 3][b.count] = (float)(seed >> 4 & 7u) / 8.0f;
            for (int k = 0; k < FL_BRANCH_WORDS; k++)
                b.word[k][b.count] = (uint32_t)k * 100000 + b.count;
            b.word[FL_BRANCH_SLOT][b.count] = slot;
            b.word[FL_BRANCH_PATH][b.count++] = seed >> 8;
        }
        dropped_want += n > FL_PENDING_MAX ? n - FL_PENDING_MAX : 0;
    }
    uint32_t count = b.count;
    branch *before = malloc(count * sizeof *before), *after = malloc(count * sizeof *after);
    assert_true(before && after);
    for (uint32_t i = 0; i < count; i++)
        before[i] = branch_of(&b, i);
    assert_int_equal(fl_branches_settle(&b), dropped_want);
    assert_int_equal(b.count, count - dropped_want);
    for (uint32_t i = 0; i < b.count; i++) {
        after[i] = branch_of(&b, i);
        /* All that belongs to a branch went along with it. */
        uint32_t number = b.word[FL_BRANCH_OBJECT][i];
        assert_int_equal(b.word[FL_BRANCH_REFRACTED][i], FL_BRANCH_REFRACTED * 100000 + number);
        for (uint32_t k = 0; k < 6; k++)
            assert_true(b.number[k][i] == (float)(k * 100000) + (float)number);
        assert_int_equal(before[number].path, after[i].path);
    }
    for (uint32_t i = 1; i < b.count; i++)
        assert_true(after[i - 1].slot < after[i].slot ||
                    (after[i - 1].slot == after[i].slot && after[i - 1].path <= after[i].path));
    for (uint32_t i = 0, at = 0; i < count; i++) {
        const branch *a = &before[i];
        uint32_t heavier = 0;
        bool is_kept = false;
        for (uint32_t j = 0; j < count; j++) {
            const branch *c = &before[j];
            heavier += c->slot == a->slot &&
                       (c->weight > a->weight || (c->weight == a->weight && c->path > a->path));
        }
        for (at = 0; at < b.count && !is_kept; at++)
            is_kept = after[at].slot == a->slot && after[at].path == a->path;
        assert_int_equal(is_kept, heavier < FL_PENDING_MAX);
    }
    free(before);
    free(after);
    fl_branches_deinit(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertical_field_of_view),
        cmocka_unit_test(the_courses_put_samples_where_they_did),
        cmocka_unit_test(raw_up_is_used_as_given),
        cmocka_unit_test(the_lens_focuses_on_a_plane),
        cmocka_unit_test(parallel_rays),
        cmocka_unit_test(kernels_generate_these_rays),
        cmocka_unit_test(lights_are_prepared),
        cmocka_unit_test(branches_settle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
