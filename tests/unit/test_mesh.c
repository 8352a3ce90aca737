/* SPDX-License-Identifier: MIT
 *
 * mesh.h: vertex normals against a plain long double evaluation of their definition.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/mesh.h"
#include "support/seed.h"

static uint64_t random_state;

static uint32_t draw(void)
{
    return (uint32_t)(test_bits(&random_state) >> 32);
}

static double draw_unit(void)
{
    return draw() / 2147483648.0 - 1.0;
}

static fl_mesh *make_mesh(uint32_t position_count, uint32_t face_count)
{
    fl_mesh *mesh = fl_mesh_create();
    assert_non_null(mesh);
    mesh->positions = calloc(position_count, sizeof *mesh->positions);
    mesh->faces = calloc(face_count, sizeof *mesh->faces);
    mesh->position_count = position_count;
    mesh->face_count = face_count;
    memset(mesh->faces, 0xFF, face_count * sizeof *mesh->faces);
    return mesh;
}

static void set_face(fl_mesh *mesh, uint32_t f, uint32_t a, uint32_t b, uint32_t c)
{
    memcpy(mesh->faces[f].position, (const uint32_t[]){a, b, c}, sizeof mesh->faces[f].position);
}

typedef struct vec3l {
    long double x, y, z;
} vec3l;

static vec3l difference(fl_vec3 a, fl_vec3 b)
{
    return (vec3l){(long double)a.x - (long double)b.x, (long double)a.y - (long double)b.y,
                   (long double)a.z - (long double)b.z};
}

static long double dot(vec3l a, vec3l b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vec3l unit(vec3l a)
{
    long double length = sqrtl(dot(a, a));
    return (vec3l){a.x / length, a.y / length, a.z / length};
}

/* The definition, one vertex at a time over all faces. */
static vec3l reference_normal(const fl_mesh *mesh, uint32_t v, fl_normals how)
{
    vec3l sum = {0, 0, 0};
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *p = mesh->faces[f].position;
        vec3l a = difference(mesh->positions[p[1]], mesh->positions[p[0]]);
        vec3l b = difference(mesh->positions[p[2]], mesh->positions[p[0]]);
        vec3l n =
            unit((vec3l){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x});
        for (int k = 0; k < 3; k++) {
            if (p[k] != v)
                continue;
            vec3l e = unit(difference(mesh->positions[p[(k + 1) % 3]], mesh->positions[v]));
            vec3l g = unit(difference(mesh->positions[p[(k + 2) % 3]], mesh->positions[v]));
            long double w = how == FL_NORMALS_ANGLE ? acosl(dot(e, g)) : 1.0L;
            sum = (vec3l){sum.x + w * n.x, sum.y + w * n.y, sum.z + w * n.z};
        }
    }
    return unit(sum);
}

static void random_meshes_match_the_definition(void **state)
{
    (void)state;
    random_state = 20240607;
    print_message("seed %llu\n", (unsigned long long)random_state);
    for (int round = 0; round < 200; round++) {
        uint32_t positions = 5 + draw() % 20, faces = 4 + draw() % 40;
        double scale = round % 4 == 0 ? 1e-120 : round % 4 == 1 ? 1e120 : 1.0;
        fl_mesh *mesh = make_mesh(positions, faces);
        for (uint32_t i = 0; i < positions; i++)
            mesh->positions[i] =
                fl_v3(scale * draw_unit(), scale * draw_unit(), scale * draw_unit());
        for (uint32_t f = 0; f < faces; f++) {
            uint32_t a = draw() % positions, b = (a + 1 + draw() % (positions - 2)) % positions;
            uint32_t c = 0;
            while (c == a || c == b)
                c++;
            set_face(mesh, f, a, b, c);
        }
        fl_vec3 *normals = calloc(positions, sizeof *normals);
        for (int how = FL_NORMALS_SMOOTH; how <= FL_NORMALS_ANGLE; how++) {
            fl_mesh_vertex_normals(mesh, (fl_normals)how, normals);
            for (uint32_t v = 0; v < positions; v++) {
                vec3l r = reference_normal(mesh, v, (fl_normals)how);
                if (isnan(r.x) || fl_v3_length(normals[v]) == 0.0)
                    continue; /* no face here, or they cancel: a test of its own */
                /* A random sum of at least 1e-3 loses three digits of sixteen; slivers two more. */
                assert_true(fabsl((long double)normals[v].x - r.x) < 1e-10L);
                assert_true(fabsl((long double)normals[v].y - r.y) < 1e-10L);
                assert_true(fabsl((long double)normals[v].z - r.z) < 1e-10L);
            }
        }
        free(normals);
        fl_mesh_release(mesh);
    }
}

static void assert_vec(fl_vec3 got, double x, double y, double z)
{
    if (fl_v3_max_abs(fl_v3_sub(got, fl_v3(x, y, z))) > 1e-15)
        fail_msg("got %.17g %.17g %.17g, want %.17g %.17g %.17g", got.x, got.y, got.z, x, y, z);
}

/* A cube's corner touched by one triangle on one side and two on another: smooth counts faces,
 * angle counts directions. */
static void angle_weights_ignore_how_a_side_is_cut(void **state)
{
    (void)state;
    fl_mesh *mesh = make_mesh(5, 3);
    fl_vec3 normals[5];
    mesh->positions[1] = fl_v3(1, 0, 0);
    mesh->positions[2] = fl_v3(0, 1, 0);
    mesh->positions[3] = fl_v3(0, 0, 1);
    mesh->positions[4] = fl_v3(1, 1, 0);
    set_face(mesh, 0, 0, 1, 4);
    set_face(mesh, 1, 0, 4, 2);
    set_face(mesh, 2, 0, 3, 1);
    fl_mesh_vertex_normals(mesh, FL_NORMALS_SMOOTH, normals);
    assert_vec(normals[0], 0, 1 / sqrt(5.0), 2 / sqrt(5.0));
    fl_mesh_vertex_normals(mesh, FL_NORMALS_ANGLE, normals);
    assert_vec(normals[0], 0, sqrt(0.5), sqrt(0.5));
    assert_vec(normals[2], 0, 0, 1);
    fl_mesh_release(mesh);
}

static void degenerate_and_cancelling_faces_give_no_normal(void **state)
{
    (void)state;
    fl_mesh *mesh = make_mesh(8, 5);
    fl_vec3 normals[8];
    for (uint32_t i = 0; i < 3; i++) /* on one line, no multiple of which is exact */
        mesh->positions[i] = fl_v3(0.1 * i, 0.3 * i, 0.7 * i);
    mesh->positions[3] = fl_v3(1, 0, 0);
    mesh->positions[4] = fl_v3(0, 1, 0);
    mesh->positions[5] = fl_v3(0, 0, 1);
    mesh->positions[6] = fl_v3(1e308, 0, 0);
    mesh->positions[7] = fl_v3(-1e308, 0, 0);
    set_face(mesh, 0, 0, 1, 2);
    set_face(mesh, 1, 1, 1, 1);
    set_face(mesh, 2, 3, 4, 5);
    set_face(mesh, 3, 5, 4, 3); /* the back of the one before */
    set_face(mesh, 4, 6, 7, 4); /* an edge longer than any double */
    for (int how = FL_NORMALS_SMOOTH; how <= FL_NORMALS_ANGLE; how++) {
        fl_mesh_vertex_normals(mesh, (fl_normals)how, normals);
        for (int v = 0; v < 8; v++)
            assert_vec(normals[v], 0, 0, 0);
    }
    fl_mesh_release(mesh);
}

static void an_empty_mesh_is_legal(void **state)
{
    (void)state;
    fl_mesh *mesh = fl_mesh_create();
    assert_non_null(mesh);
    fl_mesh_vertex_normals(mesh, FL_NORMALS_SMOOTH, NULL);
    assert_int_equal(fl_mesh_bytes(mesh), 0);
    assert_ptr_equal(fl_mesh_retain(mesh), mesh);
    fl_mesh_release(mesh);
    fl_mesh_release(mesh);
    fl_mesh_release(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_meshes_match_the_definition),
        cmocka_unit_test(angle_weights_ignore_how_a_side_is_cut),
        cmocka_unit_test(degenerate_and_cancelling_faces_give_no_normal),
        cmocka_unit_test(an_empty_mesh_is_legal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
