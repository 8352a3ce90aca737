/* SPDX-License-Identifier: MIT
 *
 * The wide shading stages by themselves: every instruction set against the scalar one on random
 * streams, bit for bit, and what needs a shading normal that differs from the geometric one.
 */
#include "pipeline_world.h"

#include "core/pipeline_work.h"
#include "core/texture.h"

static const fl_shade_kernels *kernels_of(fl_isa isa)
{
    switch (isa) {
#if defined(__x86_64__)
    case FL_ISA_SSE2:
        return &fl_shade_kernels_sse2;
    case FL_ISA_AVX2:
        return &fl_shade_kernels_avx2;
#elif defined(__aarch64__)
    case FL_ISA_NEON:
        return &fl_shade_kernels_neon;
#endif
    default:
        return &fl_shade_kernels_scalar;
    }
}

static float random_in(uint32_t *seed, float low, float high)
{
    *seed = fl_lowbias32(*seed + 0x9E3779B9u);
    return low + (high - low) * ((float)(*seed >> 8) * 0x1p-24f);
}

static void random_unit(uint32_t *seed, float *x, float *y, float *z)
{
    fl_vec3 v = fl_v3((double)random_in(seed, -1, 1), (double)random_in(seed, -1, 1),
                      (double)random_in(seed, -1, 1));
    v = fl_v3_normalize(v);
    *x = (float)v.x;
    *y = (float)v.y;
    *z = (float)v.z;
}

static void random_color(uint32_t *seed, fl_array3 a, uint32_t i)
{
    bool is_black = random_in(seed, 0, 1) < 0.3f;
    a.x[i] = is_black ? 0.0f : random_in(seed, -0.1f, 1);
    a.y[i] = is_black ? 0.0f : random_in(seed, 0, 1);
    a.z[i] = is_black ? 0.0f : random_in(seed, 0, 1);
}

static void random_stage(fl_stage *s, uint32_t count, uint32_t seed)
{
    s->rays.count = count;
    s->is_camera = seed & 1u;
    for (uint32_t i = 0; i < count; i++) {
        fl_surface *f = &s->surface;
        random_unit(&seed, &s->rays.dx[i], &s->rays.dy[i], &s->rays.dz[i]);
        random_unit(&seed, &f->ngx[i], &f->ngy[i], &f->ngz[i]);
        random_unit(&seed, &f->nsx[i], &f->nsy[i], &f->nsz[i]);
        f->px[i] = random_in(&seed, -4, 4);
        f->py[i] = random_in(&seed, -4, 4);
        f->pz[i] = i % 16 == 3 ? 0.0f : random_in(&seed, -4, 4);
        f->offset[i] = 1e-5f;
        s->hits.object[i] = i % 5;
        s->hits.prim[i] = i * 3;
        s->pixel[i] = fl_pixel_id(i, 7);
        s->path[i] = s->is_camera ? FL_PATH_CAMERA : fl_lowbias32(i + seed);
        random_color(&seed, (fl_array3){s->diffuse.x, s->diffuse.y, s->diffuse.z}, i);
        random_color(&seed, (fl_array3){s->specular.x, s->specular.y, s->specular.z}, i);
        s->shininess[i] = i % 7 == 0 ? 0.0f : random_in(&seed, 0, 300);
        s->index[i] = i % 3 == 0 ? 0.0f : random_in(&seed, 0.4f, 2.5f);
    }
}

static void assert_same(const float *a, const float *b, uint32_t count)
{
    assert_memory_equal(a, b, count * sizeof *a);
}

static void assert_same3(fl_array3 a, fl_array3 b, uint32_t count)
{
    assert_same(a.x, b.x, count);
    assert_same(a.y, b.y, count);
    assert_same(a.z, b.z, count);
}

static void compare_lights(const fl_frame *frame, const fl_shade_kernels *kernels, fl_workspace *a,
                           fl_workspace *b)
{
    for (uint32_t l = 0; l < frame->light_count; l++)
        for (uint32_t j = 0; j < frame->lights[l].samples; j++) {
            fl_shade_kernels_scalar.light(frame, &frame->lights[l], 4, j, &a->stage, &a->shadow);
            kernels->light(frame, &frame->lights[l], 4, j, &b->stage, &b->shadow);
            uint32_t n = a->shadow.rays.count;
            const fl_rays *r = &a->shadow.rays, *t = &b->shadow.rays;
            assert_int_equal(n, t->count);
            assert_memory_equal(a->shadow.at, b->shadow.at, n * sizeof(uint32_t));
            assert_memory_equal(r->source_object, t->source_object, n * sizeof(uint32_t));
            assert_memory_equal(r->source_prim, t->source_prim, n * sizeof(uint32_t));
            assert_same3(a->shadow.arrives, b->shadow.arrives, n);
            assert_same3((fl_array3){r->ox, r->oy, r->oz}, (fl_array3){t->ox, t->oy, t->oz}, n);
            assert_same3((fl_array3){r->dx, r->dy, r->dz}, (fl_array3){t->dx, t->dy, t->dz}, n);
            assert_same(r->t_max, t->t_max, n);
        }
}

/* What the surfaces spawn, from throughputs and samples that belong to the stream with its misses.
 */
static void compare_spawns(const fl_frame *frame, const fl_shade_kernels *kernels, fl_workspace *a,
                           fl_workspace *b)
{
    uint32_t seed = 77, count = a->stage.rays.count;
    for (uint32_t i = 0; i < count; i++) {
        a->stage.entry[i] = b->stage.entry[i] = i + i / 40;
        a->stage.shader[i] = b->stage.shader[i] = i / 13 % frame->scene->shader_count;
    }
    for (uint32_t i = 0; i < count + count / 40 + 1; i++) {
        random_color(&seed, a->throughput, i);
        a->slot[i] = i;
    }
    assert_true(fl_branches_reserve(&a->next, 2 * count) &&
                fl_branches_reserve(&b->next, 2 * count));
    a->next.count = b->next.count = 0;
    fl_shade_kernels_scalar.spawn(frame, &a->stage, a->throughput, a->slot, &a->next);
    kernels->spawn(frame, &b->stage, a->throughput, a->slot, &b->next);
    assert_int_equal(a->next.count, b->next.count);
    for (int k = 0; k < FL_BRANCH_NUMBERS; k++)
        assert_same(a->next.number[k], b->next.number[k], a->next.count);
    for (int k = 0; k < FL_BRANCH_WORDS; k++)
        assert_memory_equal(a->next.word[k], b->next.word[k], a->next.count * sizeof(uint32_t));
}

static void every_instruction_set_gives_the_scalar_bits(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    add_material(&w)->specular = gray(1);
    w.materials[0].reflect = w.materials[0].refract = gray(0.5);
    add_sphere(&w, fl_v3(0, 0, 0), 1);
    add_light(&w, FL_LIGHT_POINT, fl_v3(1, 2, 0), gray(1))->attenuation[2] = 0.3;
    add_light(&w, FL_LIGHT_DIRECTIONAL, fl_v3(1, 2, 3), gray(1));
    fl_light *disk = add_light(&w, FL_LIGHT_DISK, fl_v3(-1, 0.5, 2), gray(1));
    disk->radius = 0.7;
    disk->samples = 3;
    disk->is_two_sided = false;
    fl_frame *frame = world_frame(&w, FL_ISA_SCALAR);
    fl_workspace *a = fl_workspace_create(), *b = fl_workspace_create();
    for (int isa = FL_ISA_SCALAR + 1; isa < FL_ISA_COUNT; isa++) {
        const fl_shade_kernels *kernels = kernels_of((fl_isa)isa);
        for (uint32_t round = 0; fl_cpu_has((fl_isa)isa) && round < 40; round++) {
            uint32_t count = round < 20 ? round : FL_STREAM_RAYS - (round & 7u);
            frame->params.sampler = round % 3 ? FL_SAMPLER_SOBOL : FL_SAMPLER_RANDOM;
            random_stage(&a->stage, count, round);
            random_stage(&b->stage, count, round);
            fl_shade_kernels_scalar.orient(frame, &a->stage);
            kernels->orient(frame, &b->stage);
            assert_same3(a->stage.view, b->stage.view, count);
            assert_same3(a->stage.normal, b->stage.normal, count);
            compare_lights(frame, kernels, a, b);
            compare_spawns(frame, kernels, a, b);
        }
    }
    fl_workspace_destroy(a);
    fl_workspace_destroy(b);
    fl_frame_release(frame);
}

/* One hit at the origin, seen from direction `from`, normals in the x-z plane at these angles from
 * +z. */
static float arriving(world *w, double ng_deg, double ns_deg, fl_vec3 from, fl_vec3 to_light)
{
    w->scene.light_count = 0;
    add_light(w, FL_LIGHT_DIRECTIONAL, fl_v3_scale(to_light, -1), gray(1));
    fl_frame *frame = world_frame(w, FL_ISA_SCALAR);
    fl_workspace *work = fl_workspace_create();
    fl_stage *s = &work->stage;
    random_stage(s, 1, 1);
    double turn = 3.14159265358979323846 / 180;
    s->rays.dx[0] = (float)-from.x;
    s->rays.dy[0] = (float)-from.y;
    s->rays.dz[0] = (float)-from.z;
    s->surface.ngx[0] = (float)sin(ng_deg * turn);
    s->surface.ngz[0] = (float)cos(ng_deg * turn);
    s->surface.nsx[0] = (float)sin(ns_deg * turn);
    s->surface.nsz[0] = (float)cos(ns_deg * turn);
    s->surface.ngy[0] = s->surface.nsy[0] = 0;
    s->diffuse.x[0] = s->diffuse.y[0] = s->diffuse.z[0] = 0;
    s->specular.x[0] = s->specular.y[0] = s->specular.z[0] = 1;
    s->shininess[0] = 1;
    fl_shade_kernels_scalar.orient(frame, s);
    fl_shade_kernels_scalar.light(frame, &frame->lights[0], 0, 0, s, &work->shadow);
    float sum = work->shadow.rays.count ? work->shadow.arrives.x[0] : 0.0f;
    fl_workspace_destroy(work);
    fl_frame_release(frame);
    return sum;
}

static void specular_needs_both_normals(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    add_material(&w)->specular = gray(1);
    add_sphere(&w, fl_v3(0, 0, 0), 1);
    fl_vec3 view = fl_v3_normalize(fl_v3(1, 0, 1)), left = fl_v3_normalize(fl_v3(-1, 0, 0.1));
    assert_near((double)arriving(&w, 0, 0, view, fl_v3_normalize(fl_v3(-1, 0, 1))), 1, 1e-6);
    /* From behind a two-sided surface it is the same. */
    assert_near((double)arriving(&w, 180, 180, view, fl_v3_normalize(fl_v3(-1, 0, 1))), 1, 1e-6);
    /* Above the geometric surface, below the shading one: R.L alone would be positive. */
    assert_true(arriving(&w, 0, 8, view, left) == 0.0f);
    /* Above the shading surface, below the geometric one. */
    assert_true(arriving(&w, 8, 0, view, left) == 0.0f);
    assert_true(arriving(&w, 0, 0, view, left) > 0.5f);
    w.params.exact.ungated_specular = true;
    assert_true(arriving(&w, 0, 8, view, left) > 0.5f);
    assert_true(arriving(&w, 8, 0, view, left) > 0.5f);
}

/* Two squares in one plane: rays must leave on the side they go to, or the other square stops them.
 */
static void coplanar_neighbours_do_not_shade_each_other(void **state)
{
    (void)state;
    static picture got;
    for (int side = -1; side <= 1; side += 2) {
        world w;
        world_init(&w);
        add_material(&w);
        add_square(&w, fl_v3(-9, -9, 0.3), fl_v3(18, 0, 0.1), fl_v3(0, side * 18, 0.2));
        add_square(&w, fl_v3(-9, -9, 0.3), fl_v3(18, 0, 0.1), fl_v3(0, side * 18, 0.2));
        if (side < 0)
            w.objects[0].as.square.corner.y = w.objects[1].as.square.corner.y = 9;
        add_light(&w, FL_LIGHT_POINT, fl_v3(1, 2, 8), gray(1));
        world_render(&w, fl_cpu_best_isa(), 0, &got);
        for (uint32_t i = 0; i < got.count; i++)
            assert_true(got.rgb[i][0] > 0.3f);
        assert_int_equal(got.counts.shadow_rays, 256);
    }
}

/* Some texture coordinates of every kind: ordinary, at texel borders, far away, not numbers. */
static float coordinate(uint32_t *seed, uint32_t i)
{
    static const float odd[] = {0.0f, -0.0f,  1.0f,     -1.0f,     0.5f,
                                1e9f, -1e30f, INFINITY, -INFINITY, NAN};
    if (i % 4 == 0)
        return odd[i / 4 % FL_COUNT_OF(odd)];
    if (i % 4 == 1)
        return (float)((int)(i % 40) - 20) / 8.0f;
    return random_in(seed, -3, 3);
}

/* Wide look-ups against the plain one, bit for bit, for every way to store and read a picture. */
static void textures_are_read_alike(void **state)
{
    (void)state;
    enum { COUNT = 397 };
    static float u[COUNT + FL_STREAM_SLACK], v[COUNT + FL_STREAM_SLACK];
    static float got[3][COUNT + FL_STREAM_SLACK];
    uint32_t seed = 5;
    for (uint32_t i = 0; i < COUNT; i++) {
        u[i] = coordinate(&seed, i);
        v[i] = coordinate(&seed, i / 3);
    }
    for (uint32_t kind = 0; kind < 24; kind++) {
        fl_image *image =
            fl_image_create(kind % 2 ? 5 : 1, kind % 2 ? 4 : 1, (fl_pixel_format)(kind / 2 % 3));
        for (size_t i = 0; i < fl_image_bytes(image); i++)
            ((uint8_t *)image->pixels)[i] = (uint8_t)(7 + 31 * i);
        for (uint32_t i = 0; image->format == FL_PIXEL_FLOAT && i < image->width; i++)
            ((float *)image->pixels)[3 * i] = i == 1 ? INFINITY : 0.3f * (float)i;
        fl_texture texture = {image,
                              kind / 6 % 2 ? FL_FILTER_NEAREST : FL_FILTER_BILINEAR,
                              {1.5f, -0.7f},
                              kind / 12 % 2};
        for (int isa = 0; isa < FL_ISA_COUNT; isa++) {
            if (!fl_cpu_has((fl_isa)isa))
                continue;
            kernels_of((fl_isa)isa)
                ->texture(&texture, u, v, COUNT, (fl_array3){got[0], got[1], got[2]});
            for (uint32_t i = 0; i < COUNT; i++) {
                float want[3];
                fl_texture_eval(&texture, u[i], v[i], want);
                for (int c = 0; c < 3; c++)
                    assert_true(memcmp(&want[c], &got[c][i], sizeof want[c]) == 0 ||
                                (isnan(want[c]) && isnan(got[c][i])));
            }
        }
        fl_image_release(image);
    }
}

/* What a scene does not use has no arrays: of the ray tree, of roots of surfaces of revolution, of
 * transparent shadows. */
static void unused_features_take_no_memory(void **state)
{
    (void)state;
    static fl_vec3 points[4] = {{1, -1, 0}, {1, -0.3, 0}, {1, 0.3, 0}, {1, 1, 0}};
    static fl_profile cylinder = {.points = points, .segment_count = 1, .degree = 3};
    for (int uses = 0; uses < 2; uses++) {
        world w;
        world_init(&w);
        fl_material *m = add_material(&w);
        m->reflect = gray(uses ? 0.5 : 0);
        add_sphere(&w, fl_v3(0, 0, 0), 2);
        add_light(&w, FL_LIGHT_POINT, fl_v3(5, 5, 8), gray(1));
        w.params.depth_limit = 2;
        w.params.transparent_shadows = uses;
        if (uses) {
            w.scene.profiles = &cylinder;
            w.scene.profile_count = 1;
            fl_object *o = add_object(&w, FL_OBJECT_REVOLUTION);
            o->as.revolution.image = FL_NONE;
        }
        fl_frame *frame = world_frame(&w, fl_cpu_best_isa());
        fl_workspace *work = fl_workspace_create();
        uint16_t x[256], y[256];
        for (uint32_t i = 0; i < 256; i++) {
            x[i] = (uint16_t)(i % 16);
            y[i] = (uint16_t)(i / 16);
        }
        fl_unit unit = {x, y, 256, 0};
        fl_counts counts = {0};
        bool out_of_memory;
        assert_true(fl_pipeline_run(frame, &unit, work, NULL, 0, &counts, &out_of_memory));
        assert_int_equal(work->next.memory || work->current.memory, uses);
        assert_int_equal(work->stage.hits.root != NULL, uses);
        assert_int_equal(work->end.x != NULL, uses);
        assert_int_equal(counts.reflect_rays > 0, uses);
        fl_workspace_destroy(work);
        fl_frame_release(frame);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unused_features_take_no_memory),
        cmocka_unit_test(textures_are_read_alike),
        cmocka_unit_test(every_instruction_set_gives_the_scalar_bits),
        cmocka_unit_test(specular_needs_both_normals),
        cmocka_unit_test(coplanar_neighbours_do_not_shade_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
