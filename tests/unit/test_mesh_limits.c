/* SPDX-License-Identifier: MIT
 *
 * Limits of the mesh readers. A mesh of FL_MESH_ELEMENTS_MAX elements takes minutes and gigabytes:
 * here the readers are compiled with a smaller one. Everything else is at its constant.
 */
#include "io/mesh_file.h"
#undef FL_MESH_ELEMENTS_MAX
#define FL_MESH_ELEMENTS_MAX ((uint32_t)1000)

#include "io/assimp_mesh.c"
#include "io/obj.c"

/* Last: its `fail` is a macro. */
#include "temp_files.h"

/* The mesh of a text, or NULL after the one error expected. */
static fl_mesh *load(const char *name, const char *text, const char *message)
{
    fl_diags diags = {0};
    const char *path = temp_write(name, text, strlen(text));
    fl_mesh *mesh = strstr(name, ".obj") ? fl_obj_parse(text, strlen(text), path, &diags)
                                         : fl_mesh_load_assimp(path, strlen(text), &diags);
    if (message)
        expect_error(&diags, FL_CAUSE_INPUT, message);
    else
        expect_none(&diags);
    assert_true(!mesh == (message != NULL));
    return mesh;
}

/* `before`, then `count` lines, then `after`. From malloc. */
static char *lines(const char *before, const char *line, uint32_t count, const char *after)
{
    size_t bytes = strlen(before) + count * strlen(line) + strlen(after) + 1;
    char *text = malloc(bytes), *at = text;
    assert_non_null(text);
    at = stpcpy(at, before);
    for (uint32_t i = 0; i < count; i++)
        at = stpcpy(at, line);
    stpcpy(at, after);
    return text;
}

static void obj_elements(void **state)
{
    (void)state;
    static const char *const kinds[] = {"v 1 0 1\n", "vt 0 0\n", "vn 0 0 1\n", "f 1 2 3\n"};
    static const char three[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (size_t i = 0; i < FL_COUNT_OF(kinds); i++) {
        uint32_t most = FL_MESH_ELEMENTS_MAX - (i == 0 ? 3 : i == 3 ? 1 : 0);
        char *good = lines(three, kinds[i], most, "f 1 2 3\n");
        char *bad = lines(three, kinds[i], most + 1, "f 1 2 3\n");
        fl_mesh_release(load("a.obj", good, NULL));
        load("a.obj", bad, "the mesh is too large: more than 1000 elements of one kind");
        free(good);
        free(bad);
    }
    char *last = lines("", "v 1 0 1\n", 1000, "f 1 2 1000\n");
    fl_mesh_release(load("a.obj", last, NULL));
    load("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1001\n", "vertex index 1001 is out of range");
    free(last);
}

static fl_mesh *load_ply(uint32_t vertices, uint32_t faces, const char *message)
{
    char head[256];
    snprintf(head, sizeof head,
             "ply\nformat ascii 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
             "property float z\nelement face %u\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\n1 0 0\n0 1 0\n",
             vertices, faces);
    char *points = lines(head, "1 0 1\n", vertices - 3, "");
    char *text = lines(points, "3 0 1 2\n", faces, "");
    fl_mesh *mesh = load("a.ply", text, message);
    free(points);
    free(text);
    return mesh;
}

static void assimp_elements(void **state)
{
    (void)state;
    fl_mesh *mesh = load_ply(1000, 1000, NULL);
    assert_int_equal(mesh->face_count, 1000);
    fl_mesh_release(mesh);
    load_ply(1001, 10, "a.ply' is too large: more than 1000 elements of one kind");
    load_ply(10, 1001, "a.ply' is too large: more than 1000 elements of one kind");
}

/* One node with a triangle, all others its children. The buffer is the positions of the corners. */
static char *gltf_of(uint32_t node_count)
{
    static const char empty[] = ",{}";
    static const char buffer[] =
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"; /* 0 0 0  1 0 0  0 1 0 */
    static const char mesh[] =
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{"
        "\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],"
        "\"max\":[1,1,0]}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{"
        "\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,";
    size_t room = 1024 + (size_t)node_count * 12;
    char *text = malloc(room), *at = text;
    assert_non_null(text);
    at = stpcpy(at, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
                    "\"nodes\":[{\"mesh\":0,\"children\":[");
    for (uint32_t i = 1; i < node_count; i++)
        at += snprintf(at, room - (size_t)(at - text), i > 1 ? ",%u" : "%u", i);
    at = stpcpy(at, "]}");
    for (uint32_t i = 1; i < node_count; i++)
        at = stpcpy(at, empty);
    at = stpcpy(at, "],");
    at = stpcpy(at, mesh);
    at = stpcpy(at, buffer);
    stpcpy(at, "\"}]}");
    return text;
}

static void gltf_nodes(void **state)
{
    (void)state;
    char *good = gltf_of(NODES_MAX), *bad = gltf_of(NODES_MAX + 1);
    fl_mesh *mesh = load("a.gltf", good, NULL);
    assert_int_equal(mesh->face_count, 1);
    fl_mesh_release(mesh);
    load("a.gltf", bad, "a.gltf' has more than 100000 nodes");
    free(good);
    free(bad);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(obj_elements),
        cmocka_unit_test(assimp_elements),
        cmocka_unit_test(gltf_nodes),
    };
    return cmocka_run_group_tests(tests, temp_begin, temp_end);
}
