/* SPDX-License-Identifier: MIT
 *
 * The tree of rays of a sample is the sample: its parts add up to the film's value, to the bit, on
 * every instruction set; what stands in the way of a light is found; what is printed says so.
 */
#include "pipeline_world.h"

#include "core/raytree.h"

static picture want;

/* Mirror, glass that a lens looks through, a floor, and lights of every kind. */
static void make_rich(world *w)
{
    world_init(w);
    w->params.width = 24;
    w->params.height = 16;
    w->params.camera.aperture = 0.2;
    w->params.camera.focus = 9;
    w->params.background = fl_v3(0.2, 0.3, 0.5);
    w->params.ambient = gray(0.1);
    w->params.depth_limit = 5;
    add_material(w)->diffuse = fl_v3(0.8, 0.7, 0.3);
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
    fl_light *soft = add_light(w, FL_LIGHT_DISK, fl_v3(2, 6, 5), gray(0.8));
    soft->radius = 1;
    soft->samples = 3;
    fl_light *near = add_light(w, FL_LIGHT_POINT, fl_v3(-4, 3, 4), fl_v3(4, 3, 2));
    near->attenuation[2] = 0.1;
    add_light(w, FL_LIGHT_DIRECTIONAL, fl_v3(1, -2, -1), gray(0.2));
}

/* Ambient, and of each light in turn the mean of its samples, as decision 5 has it. */
static void add_up_node(const fl_raytree *tree, const fl_raytree_node *node, float out[3])
{
    for (int c = 0; c < 3; c++) {
        out[c] = node->ambient[c];
        for (uint32_t i = 0; i < node->light_count;) {
            const fl_raytree_light *l = &tree->lights[node->first_light + i];
            uint32_t light = l->light;
            float lit = 0.0f;
            for (; i < node->light_count && tree->lights[node->first_light + i].light == light; i++)
                lit += tree->lights[node->first_light + i].arrives[c];
            out[c] += l->samples > 1 ? lit / (float)l->samples : lit;
        }
    }
}

static void check_tree(const fl_frame *frame, const fl_raytree *tree, fl_counts *sum)
{
    float rgb[3] = {0.0f, 0.0f, 0.0f};
    uint32_t kinds[FL_RAY_KIND_COUNT] = {0};
    for (uint32_t i = 0; i < tree->node_count; i++) {
        const fl_raytree_node *node = &tree->nodes[i];
        kinds[node->kind]++;
        if (i > 0) {
            assert_true(node->parent < i);
            const fl_raytree_node *parent = &tree->nodes[node->parent];
            assert_int_equal(node->level, parent->level + 1);
            fl_vec3 away = fl_v3_sub(node->origin, parent->position);
            assert_true(fl_v3_length(away) < 1e-4);
        }
        float radiance[3];
        add_up_node(tree, node, radiance);
        assert_memory_equal(radiance, node->radiance, sizeof radiance);
        for (int c = 0; c < 3; c++)
            rgb[c] += node->weight[c] * node->radiance[c];
        for (uint32_t k = 0; k < node->light_count; k++)
            assert_int_equal(tree->lights[node->first_light + k].node, i);
    }
    assert_memory_equal(rgb, tree->rgb, sizeof rgb);
    assert_int_equal(kinds[FL_RAY_CAMERA], 1);
    assert_int_equal(kinds[FL_RAY_REFLECT], tree->counts.reflect_rays);
    assert_int_equal(kinds[FL_RAY_REFRACT], tree->counts.refract_rays);
    assert_int_equal(tree->light_count, tree->counts.shadow_rays);
    (void)frame;
    fl_counts_add(sum, &tree->counts);
}

static void a_tree_adds_up_to_its_sample(void **state)
{
    (void)state;
    for (int isa = FL_ISA_SCALAR; isa < FL_ISA_COUNT; isa++) {
        if (!fl_cpu_has((fl_isa)isa))
            continue;
        for (int transparent = 0; transparent < 2; transparent++) {
            world w;
            make_rich(&w);
            w.params.transparent_shadows = transparent != 0;
            fl_frame *frame = world_frame(&w, (fl_isa)isa);
            fl_raytree tree = {0};
            for (uint32_t sample = 0; sample < 40; sample += 17) {
                picture_render(&want, frame, sample, FL_UNIT_PIXELS, false);
                fl_counts sum = {0};
                for (uint32_t i = 0; i < want.count; i++) {
                    assert_true(fl_raytree_trace(frame, i % 24, i / 24, sample, &tree));
                    assert_memory_equal(tree.rgb, want.rgb[i], sizeof tree.rgb);
                    check_tree(frame, &tree, &sum);
                }
                assert_int_equal(sum.shadow_rays, want.counts.shadow_rays);
                assert_int_equal(sum.reflect_rays, want.counts.reflect_rays);
                assert_true(sum.refract_rays > 50);
            }
            fl_raytree_deinit(&tree);
            fl_frame_release(frame);
        }
    }
}

static void what_blocks_a_light_is_found(void **state)
{
    (void)state;
    world w;
    make_rich(&w);
    w.params.camera.aperture = 0;
    fl_frame *frame = world_frame(&w, fl_cpu_best_isa());
    fl_raytree tree = {0};
    uint32_t blocked = 0, clear = 0;
    for (uint32_t i = 0; i < 24 * 16; i++) {
        assert_true(fl_raytree_trace(frame, i % 24, i / 24, 0, &tree));
        assert_true(fl_raytree_find_blockers(frame, &tree));
        for (uint32_t k = 0; k < tree.light_count; k++) {
            const fl_raytree_light *l = &tree.lights[k];
            bool is_blocked = l->arrives[0] == 0.0f && l->sends[0] != 0.0f;
            assert_int_equal(is_blocked, l->blocker != FL_NONE);
            assert_true(!is_blocked || l->blocker_t > 0.0);
            blocked += is_blocked;
            clear += !is_blocked;
        }
    }
    assert_true(blocked > 20 && clear > 20);
    fl_raytree_deinit(&tree);
    fl_frame_release(frame);
}

/* One sphere over a floor, the light above both: a shadow whose every number is known. */
static void the_text_says_what_happened(void **state)
{
    (void)state;
    world w;
    world_init(&w);
    w.params.ambient = gray(0.25);
    w.params.depth_limit = 1;
    add_material(&w)->diffuse = gray(0.5);
    add_plane(&w, fl_v3(0, 0, 1), 0);
    add_sphere(&w, fl_v3(0, 3, 0.5), 0.25);
    add_light(&w, FL_LIGHT_POINT, fl_v3(0, 6, 1), gray(1));
    w.params.width = w.params.height = 1;
    w.params.sampler = FL_SAMPLER_SOBOL;
    w.params.camera.fov_deg = 0.01;
    w.objects[1].as.sphere.center = fl_v3(0, 3, 0.5);
    w.materials[0].reflect = gray(0.5);
    fl_frame *frame = world_frame(&w, fl_cpu_best_isa());
    fl_raytree tree = {0};
    assert_true(fl_raytree_trace(frame, 0, 0, 0, &tree));
    assert_true(fl_raytree_find_blockers(frame, &tree));
    char text[4096];
    size_t length = fl_raytree_text(frame, &tree, false, text, sizeof text);
    assert_int_equal(length, strlen(text));
    assert_int_equal(length, fl_raytree_text(frame, &tree, false, NULL, 0));
    assert_non_null(strstr(text, "hits plane 1, "));
    assert_non_null(strstr(text, ", blocked by sphere 2, "));
    assert_non_null(strstr(text, "reflect weight 0.5 0.5 0.5"));
    assert_non_null(strstr(text, "leaves the scene: background"));
    assert_non_null(strstr(text, "pixel 0 0, sample 0: 0.125 0.125 0.125, the sum of 2 rays"));
    fl_raytree_text(frame, &tree, true, text, sizeof text);
    assert_non_null(strstr(text, "\ncamera: plane 1, "));
    assert_non_null(strstr(text, " + 0.125 lights 0/1\n"));
    assert_non_null(strstr(text, "\n reflect: background + 0\n"));
    assert_int_equal(fl_raytree_heaviest(&tree), 0);
    /* Cut short, never beyond the end. */
    char small[40];
    memset(small, 'x', sizeof small);
    fl_raytree_text(frame, &tree, false, small, 20);
    assert_int_equal(small[19], 0);
    assert_int_equal(small[20], 'x');
    fl_raytree_deinit(&tree);
    fl_frame_release(frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree_adds_up_to_its_sample),
        cmocka_unit_test(what_blocks_a_light_is_found),
        cmocka_unit_test(the_text_says_what_happened),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
