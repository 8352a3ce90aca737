/* SPDX-License-Identifier: MIT
 *
 * How the cost of a ray grows with what the scene holds.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli/bench_run.h"

const char *const bench_growth_names[BENCH_GROWTH_COUNT] = {"spheres", "triangles", "instances",
                                                            "lights"};

enum { INSTANCE_FACES = 1200, LIGHT_SPHERES = 48, LIGHT_SIDE_MAX = 64 };

/* Spheres and instances in the cube [-0.9, 0.9]^3 keep a distance to their neighbours, on average,
 * of four radii: a ray passes several and then hits one, however many there are. */
static const double half_side = 0.9;

static double radius_of(uint32_t count)
{
    return 0.5 * half_side / cbrt((double)count);
}

static double between(uint64_t *state, double lo, double hi)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (double)(*state >> 40) * 0x1p-24;
}

static fl_vec3 place(uint64_t *state)
{
    double x = between(state, -half_side, half_side), y = between(state, -half_side, half_side);
    return fl_v3(x, y, between(state, -half_side, half_side));
}

/* Scenes borrow the one material; whoever made the arrays frees them. */
static fl_scene scene_of(fl_object *objects, uint32_t count, fl_material *material)
{
    *material = (fl_material){.diffuse = {1, 1, 1}, .refraction_index = 1, .image = FL_NONE};
    fl_scene scene = {.path = "growth",
                      .objects = objects,
                      .object_count = count,
                      .materials = material,
                      .material_count = 1};
    for (int k = 0; k < FL_CUBE_FACES; k++)
        scene.background.cube_image[k] = FL_NONE;
    return scene;
}

static void add_spheres(fl_object *objects, uint32_t count)
{
    uint64_t state = 1;
    for (uint32_t i = 0; i < count; i++) {
        fl_object *o = &objects[i];
        *o = (fl_object){.kind = FL_OBJECT_SPHERE, .transform = FL_NONE};
        o->as.sphere.center = place(&state);
        o->as.sphere.radius = radius_of(count);
    }
}

static fl_compiled *compile_spheres(const bench_setup *setup, uint32_t count)
{
    fl_material material;
    fl_object *objects = calloc(count, sizeof *objects);
    fl_compiled *compiled = NULL;
    if (objects) {
        add_spheres(objects, count);
        fl_scene scene = scene_of(objects, count, &material);
        compiled = fl_compile(&scene, &setup->compile, NULL, setup->diags);
    } else {
        fl_out_of_memory(setup->diags, "the spheres to measure");
    }
    free(objects);
    return compiled;
}

/* --- Instances ------------------------------------------------------------------------------- */

static fl_affine turned(uint64_t *state, uint32_t count)
{
    double yaw = between(state, 0.0, 6.28), c = cos(yaw) * radius_of(count),
           s = sin(yaw) * radius_of(count);
    fl_vec3 at = place(state);
    fl_affine m = {.m = {{c, 0, s, at.x}, {0, radius_of(count), 0, at.y}, {-s, 0, c, at.z}}};
    return m;
}

static fl_compiled *compile_instances(const bench_setup *setup, uint32_t count)
{
    bench_mesh shape = {0};
    fl_object *objects = calloc(count, sizeof *objects);
    fl_affine *transforms = calloc(count, sizeof *transforms);
    fl_mesh *mesh = NULL;
    fl_compiled *compiled = NULL;
    if (!objects || !transforms)
        fl_out_of_memory(setup->diags, "the instances to measure");
    else if (bench_mesh_sphere(INSTANCE_FACES, &shape, setup->diags) &&
             (mesh = bench_mesh_create(&shape, setup->diags)) != NULL) {
        uint64_t state = 2;
        for (uint32_t i = 0; i < count; i++) {
            objects[i] = (fl_object){.kind = FL_OBJECT_MESH,
                                     .transform = i,
                                     .as.mesh = {.mesh = 0, .normals = FL_NORMALS_FLAT}};
            transforms[i] = turned(&state, count);
        }
        fl_material material;
        fl_scene_mesh row = {.path = shape.name, .mesh = mesh};
        fl_scene scene = scene_of(objects, count, &material);
        scene.transforms = transforms;
        scene.transform_count = count;
        scene.meshes = &row;
        scene.mesh_count = 1;
        compiled = fl_compile(&scene, &setup->compile, NULL, setup->diags);
    }
    fl_mesh_release(mesh);
    bench_mesh_deinit(&shape);
    free(objects);
    free(transforms);
    return compiled;
}

static fl_compiled *compile_triangles(const bench_setup *setup, uint32_t count)
{
    bench_mesh mesh = {0};
    fl_compiled *compiled = NULL;
    if (bench_mesh_sphere(count, &mesh, setup->diags))
        compiled = bench_mesh_compile(&mesh, &setup->compile, NULL, setup->diags);
    bench_mesh_deinit(&mesh);
    return compiled;
}

/* --- Measuring ------------------------------------------------------------------------------- */

static bool measure_primary(const bench_setup *setup, const fl_compiled *compiled,
                            bench_growth_row *out)
{
    bench_rays rays = {0};
    double ns[BENCH_ROUNDS_MAX];
    fl_isect_counts counts = {0};
    if (!bench_rays_create(NULL, compiled, BENCH_PRIMARY, setup->side, NULL, &rays))
        return fl_out_of_memory(setup->diags, "rays to measure with");
    double n = rays.rays.count;
    bench_rays_trace(compiled, &rays, &counts);
    for (uint32_t r = 0; r < setup->rounds; r++) {
        double begin = bench_thread_seconds();
        bench_rays_trace(compiled, &rays, NULL);
        ns[r] = (bench_thread_seconds() - begin) / n * 1e9;
    }
    bench_rays_deinit(&rays);
    out->ns = bench_figure_of(ns, setup->rounds);
    out->node_visits = (double)counts.node_visits / n;
    out->primitive_tests = (double)counts.primitive_tests / n;
    out->rays_per_pixel = 1.0;
    out->bytes = (double)(compiled->geometry_bytes + compiled->accel_bytes);
    return true;
}

static bool measure(const bench_setup *setup, bench_growth_row *out,
                    fl_compiled *(*compile)(const bench_setup *setup, uint32_t count))
{
    double begin = bench_thread_seconds();
    fl_compiled *compiled = compile(setup, out->count);
    if (!compiled)
        return false;
    out->build_seconds = bench_thread_seconds() - begin;
    bool ok = measure_primary(setup, compiled, out);
    fl_compiled_release(compiled);
    return ok;
}

/* Point lights in a square above a plane with spheres; all rays of a picture. */
static bool measure_lights(const bench_setup *setup, bench_growth_row *out)
{
    fl_object objects[LIGHT_SPHERES + 1];
    fl_light *lights = calloc(out->count, sizeof *lights);
    if (!lights)
        return fl_out_of_memory(setup->diags, "the lights to measure");
    add_spheres(objects, LIGHT_SPHERES);
    objects[LIGHT_SPHERES] = (fl_object){
        .kind = FL_OBJECT_PLANE, .transform = FL_NONE, .as.plane = {{0, 1, 0}, -half_side}};
    uint64_t state = 3;
    for (uint32_t i = 0; i < out->count; i++) {
        double x = between(&state, -3, 3), power = 1.0 / out->count;
        lights[i] = (fl_light){.kind = FL_LIGHT_POINT,
                               .position = {x, 4.0, between(&state, -3, 3)},
                               .color = {power, power, power},
                               .attenuation = {1, 0, 0}};
    }
    fl_material material;
    fl_scene scene = scene_of(objects, LIGHT_SPHERES + 1, &material);
    scene.lights = lights;
    scene.light_count = out->count;
    scene.camera = (fl_camera){.center = {1.4, 1.1, 3.1},
                               .direction = {-1.4, -1.1, -3.1},
                               .up = {0, 1, 0},
                               .fov_deg = 40,
                               .focus = (double)INFINITY};
    scene.has_camera = true;
    fl_params params;
    fl_params_from_scene(&params, &scene, false);
    params.width = params.height = fl_min_u32(setup->side, LIGHT_SIDE_MAX);
    double begin = bench_thread_seconds();
    fl_compiled *compiled = fl_compile(&scene, &setup->compile, NULL, setup->diags);
    out->build_seconds = bench_thread_seconds() - begin;
    bool ok = compiled != NULL;
    double ns[BENCH_ROUNDS_MAX];
    for (uint32_t r = 0; ok && r < setup->rounds; r++) {
        fl_progress p;
        ok = bench_render(compiled, &params, 1, &p, setup->diags);
        double rays = (double)(p.counts.camera_rays + p.counts.shadow_rays);
        ns[r] = p.cpu_seconds / rays * 1e9;
        out->node_visits = (double)p.counts.isect.node_visits / rays;
        out->primitive_tests = (double)p.counts.isect.primitive_tests / rays;
        out->rays_per_pixel = rays / (double)p.counts.camera_rays;
    }
    if (ok) {
        out->ns = bench_figure_of(ns, setup->rounds);
        out->bytes = (double)(compiled->geometry_bytes + compiled->accel_bytes);
    }
    fl_compiled_release(compiled);
    free(lights);
    return ok;
}

bool bench_growth_measure(const bench_setup *setup, bench_growth of, uint32_t count,
                          bench_growth_row *out)
{
    *out = (bench_growth_row){.of = of, .count = count};
    switch (of) {
    case BENCH_SPHERES:
        return measure(setup, out, compile_spheres);
    case BENCH_TRIANGLES:
        return measure(setup, out, compile_triangles);
    case BENCH_INSTANCES:
        return measure(setup, out, compile_instances);
    default:
        return measure_lights(setup, out);
    }
}

static void report(const bench_setup *setup, const bench_growth_row *r)
{
    const char *name = bench_growth_names[r->of];
    if (setup->rows)
        json_array_append_new(setup->rows,
                              json_pack("{s:s, s:s, s:I, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}",
                                        "kind", "growth", "of", name, "count", (json_int_t)r->count,
                                        "ns_per_ray", r->ns.median, "ns_min", r->ns.min, "ns_max",
                                        r->ns.max, "node_visits", r->node_visits, "primitive_tests",
                                        r->primitive_tests, "rays_per_pixel", r->rays_per_pixel,
                                        "build_ms", r->build_seconds * 1e3, "bytes", r->bytes));
    else
        printf("%-9s %9u  %8.1f ns (%.1f to %.1f) a ray %7.2f nodes %7.2f tests %8.2f rays a "
               "pixel, build %9.2f ms, %6.1f bytes each\n",
               name, r->count, r->ns.median, r->ns.min, r->ns.max, r->node_visits,
               r->primitive_tests, r->rays_per_pixel, r->build_seconds * 1e3, r->bytes / r->count);
    fflush(stdout);
}

bool bench_growth_run(const bench_setup *setup)
{
    static const uint32_t range[BENCH_GROWTH_COUNT][2] = {
        {1, 1000000}, {1000, 10000000}, {1, 100000}, {1, 1000}};
    for (int of = 0; of < BENCH_GROWTH_COUNT; of++)
        for (uint32_t count = range[of][0]; count <= range[of][1]; count *= 10) {
            bench_growth_row row;
            if (cli_was_interrupted())
                return true;
            if (!bench_growth_measure(setup, (bench_growth)of, count, &row))
                return false;
            report(setup, &row);
        }
    return true;
}
