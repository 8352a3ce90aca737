/* SPDX-License-Identifier: MIT
 *
 * obj.h: every form of the format, every class of error with its place, mutated files, and the
 * meshes of the course repositories against an independent count.
 */
#include "temp_files.h"

#include "io/mesh_file.h"
#include "io/obj.h"
#include "support/seed.h"

static fl_mesh *parse(const char *text)
{
    fl_diags diags = {0};
    fl_mesh *mesh = fl_obj_parse(text, strlen(text), "mesh.obj", &diags);
    expect_none(&diags);
    assert_non_null(mesh);
    return mesh;
}

static void assert_face(const fl_mesh *mesh, uint32_t f, const uint32_t position[3],
                        const uint32_t uv[3], const uint32_t normal[3])
{
    static const uint32_t none[3] = {FL_NONE, FL_NONE, FL_NONE};
    assert_true(f < mesh->face_count);
    assert_memory_equal(mesh->faces[f].position, position, sizeof none);
    assert_memory_equal(mesh->faces[f].uv, uv ? uv : none, sizeof none);
    assert_memory_equal(mesh->faces[f].normal, normal ? normal : none, sizeof none);
}

#define THREE(a, b, c) ((const uint32_t[3]){(a), (b), (c)})

static void all_forms_of_corners_are_read(void **state)
{
    (void)state;
    fl_mesh *mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0.5\nvt .25 1 0\n"
                          "vn 0 0 1\nvn 0 0 2\nf 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//2 3//1\n"
                          "f 1/3/2 2/2/1 3/1/1\nf 1 2/2 3//1\nf 1/ 2// 3/0/0\n");
    assert_int_equal(mesh->position_count, 3);
    assert_int_equal(mesh->uv_count, 3);
    assert_int_equal(mesh->normal_count, 2);
    assert_int_equal(mesh->face_count, 6);
    assert_face(mesh, 0, THREE(0, 1, 2), NULL, NULL);
    assert_face(mesh, 1, THREE(0, 1, 2), THREE(0, 1, 2), NULL);
    assert_face(mesh, 2, THREE(0, 1, 2), NULL, THREE(0, 1, 0));
    assert_face(mesh, 3, THREE(0, 1, 2), THREE(2, 1, 0), THREE(1, 0, 0));
    assert_face(mesh, 4, THREE(0, 1, 2), THREE(FL_NONE, 1, FL_NONE), THREE(FL_NONE, FL_NONE, 0));
    assert_face(mesh, 5, THREE(0, 1, 2), NULL, NULL);
    assert_true(mesh->uvs[1].u == 1.0f && mesh->uvs[2].u == 0.25f && mesh->uvs[2].v == 1.0f);
    assert_true(mesh->normals[1].z == 2.0);
    fl_mesh_release(mesh);
}

static void negative_and_forward_indices_are_resolved(void **state)
{
    (void)state;
    fl_mesh *mesh = parse("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf -3//-1 -2//1 -1//-1\n"
                          "v 5 5 5\nf -1 -2 -3\n");
    assert_face(mesh, 0, THREE(0, 1, 2), NULL, NULL);
    assert_face(mesh, 1, THREE(0, 1, 2), NULL, THREE(0, 0, 0));
    assert_face(mesh, 2, THREE(3, 2, 1), NULL, NULL);
    fl_mesh_release(mesh);
}

static void polygons_become_fans(void **state)
{
    (void)state;
    fl_mesh *mesh = parse("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 .5 0\nf 1 2 3 4 5\n");
    assert_int_equal(mesh->face_count, 3);
    assert_face(mesh, 0, THREE(0, 1, 2), NULL, NULL);
    assert_face(mesh, 1, THREE(0, 2, 3), NULL, NULL);
    assert_face(mesh, 2, THREE(0, 3, 4), NULL, NULL);
    fl_mesh_release(mesh);

    enum { CORNERS = 5000 };
    static char text[CORNERS * 40];
    size_t used = 0;
    for (int i = 0; i < CORNERS; i++)
        used += (size_t)sprintf(text + used, "v %d %d 0\n", i, i * i % 77);
    text[used++] = 'f';
    for (int i = 0; i < CORNERS; i++)
        used += (size_t)sprintf(text + used, " %d", i + 1);
    mesh = parse(text);
    assert_int_equal(mesh->face_count, CORNERS - 2);
    assert_face(mesh, CORNERS - 3, THREE(0, CORNERS - 2, CORNERS - 1), NULL, NULL);
    fl_mesh_release(mesh);
}

static void every_layout_of_text_gives_the_same_mesh(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "v 0 0 0\nv 1.5 0 0\nv 0 -.25 1e-3\nf 1 2 3\n",
        "v 0 0 0\r\nv 1.5 0 0\r\nv 0 -.25 1e-3\r\nf 1 2 3\r\n",
        "v 0 0 0\rv 1.5 0 0\rv 0 -.25 1e-3\rf 1 2 3",
        "v\t0\t0  0\n  v  15E-1 0 0\nv 0 -.25 0.1e-2\nf\t1 2\t3 ",
        "\xEF\xBB\xBFv 0 0 0 # a comment\n#v 9 9 9\n\nv 1.5 0 0#x\nv 0 -.25 .001\nf 1 2 3 # end",
        "v 0 \\\n0 0\nv 1.5 0 \\\r\n 0\nv 0 -.25 1e-3\nf 1 2\\\n 3",
        ("mtllib a.mtl\no b\nv 0 0 0 1\nv 1.5 0 0 0.1 0.2 0.3\nv 0 -.25 1e-3\ng a\ns off\nvp 0.1 "
         "0.2\nl 1 2\nfoo \\\nv 7 7 7\nf 1 2 3\nend"),
    };
    for (size_t i = 0; i < FL_COUNT_OF(texts); i++) {
        fl_mesh *mesh = parse(texts[i]);
        assert_int_equal(mesh->position_count, 3);
        assert_int_equal(mesh->face_count, 1);
        assert_true(mesh->positions[1].x == 1.5);
        assert_true(mesh->positions[2].y == -0.25 && mesh->positions[2].z == 1e-3);
        assert_face(mesh, 0, THREE(0, 1, 2), NULL, NULL);
        fl_mesh_release(mesh);
    }
}

static void each_error_names_its_place(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t line, column;
        const char *part;
    } cases[] = {
        {"v 0 0\nf 1 1 1", 1, 6, "expected a number, but the line ends"},
        {"v 0 0 zero\n", 1, 7, "expected a number, got 'zero'"},
        {"v 0 0 1x\n", 1, 7, "expected a number, got '1x'"},
        {"v 0 0 0x1F\n", 1, 7, "expected a number, got '0x1F'"},
        {"v 0 0 nan\n", 1, 7, "expected a finite number, got 'nan'"},
        {"v 0 -inf 0\n", 1, 5, "expected a finite number"},
        {"v 1e999 0 0\n", 1, 3, "expected a finite number"},
        {"v 1 2 3 4 5 6 7 8 9\n", 1, 19, "expected the end of the statement, got '9'"},
        {"vn 1 2 3 4\n", 1, 10, "expected the end of the statement"},
        {"vt\n", 1, 3, "expected a number"},
        {"vt 1e200 0\n", 1, 3, "texture coordinates below"},
        {"v 0 0 0\nf 1 1\n", 2, 6, "at least 3 corners, but the line ends"},
        {"v 0 0 0\nf\n", 2, 2, "at least 3 corners"},
        {"v 0 0 0\nf 1 1 4\n", 2, 7, "vertex index 4 is out of range: the file has 1"},
        {"v 0 0 0\nf 1 1 0\n", 2, 7, "vertex index 0 is out of range"},
        {"v 0 0 0\nf 1 1 -2\n", 2, 7, "vertex index -2 is out of range"},
        {"v 0 0 0\nf 1/2 1/1 1/1\n", 2, 5, "texture coordinate index 2 is out of range"},
        {"v 0 0 0\nf 1//3 1 1\n", 2, 6, "normal index 3 is out of range"},
        {"v 0 0 0\nf 1 1 999999999\n", 2, 7, "out of range"},
        {"v 0 0 0\nf 1 1 99999999999999999999\n", 2, 7, "expected an index"},
        {"v 0 0 0\nf 1 1 1.5\n", 2, 7, "expected a corner"},
        {"v 0 0 0\nvt 0\nvn 0 0 0\nf 1 1 1/1/1/1\n", 4, 7, "expected a corner"},
        {"v 0 0 0\nf 1 1 /1\n", 2, 7, "expected an index"},
        {"v 0 0 0\nf a b c\n", 2, 3, "expected an index, got 'a'"},
        {"v 0 \\\n0 x\n", 2, 3, "expected a number, got 'x'"},
        {"", 0, 0, "no faces"},
        {"v 0 0 0\n", 0, 0, "no faces"},
        {"this is a letter\nto a friend\n", 0, 0, "no faces"},
    };
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        fl_diags diags = {0};
        assert_null(fl_obj_parse(cases[i].text, strlen(cases[i].text), "mesh.obj", &diags));
        assert_true(diags.error_count >= 1);
        const fl_diag *diag = &diags.items[0];
        if (!strstr(diag->message, cases[i].part) || diag->loc.line != cases[i].line ||
            (diag->loc.line > 0 && diag->loc.column != cases[i].column))
            fail_msg("case %zu: got %u:%u '%s'", i, diag->loc.line, diag->loc.column,
                     diag->message);
        assert_string_equal(diag->loc.file, "mesh.obj");
        assert_int_equal(diag->cause, FL_CAUSE_INPUT);
        fl_diags_deinit(&diags);
    }
}

static void binary_and_endless_errors_stay_short(void **state)
{
    (void)state;
    fl_diags diags = {0};
    assert_null(fl_obj_parse("v 0 0\0 0\n", 9, "mesh.obj", &diags));
    expect_error(&diags, FL_CAUSE_INPUT, "not an OBJ text: it has a zero byte at offset 5");

    static char text[4000];
    for (int i = 0; i < 1000; i++)
        memcpy(text + 4 * i, "v x\n", 4);
    assert_null(fl_obj_parse(text, sizeof text, "mesh.obj", &diags));
    assert_int_equal(diags.error_count, FL_OBJ_ERRORS_MAX);
    assert_string_equal(diags.items[7].source_line, "v x");
    assert_null(diags.text);
    fl_diags_deinit(&diags);
}

static uint64_t random_state;

static uint32_t draw(void)
{
    return (uint32_t)(test_bits(&random_state) >> 32);
}

static void assert_sound(const fl_mesh *mesh)
{
    assert_true(mesh->face_count > 0);
    for (uint32_t i = 0; i < mesh->position_count; i++)
        assert_true(fl_v3_is_finite(mesh->positions[i]));
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const fl_face *face = &mesh->faces[f];
        for (int k = 0; k < 3; k++) {
            assert_true(face->position[k] < mesh->position_count);
            assert_true(face->uv[k] == FL_NONE || face->uv[k] < mesh->uv_count);
            assert_true(face->normal[k] == FL_NONE || face->normal[k] < mesh->normal_count);
        }
    }
}

/* Change, insert, delete or repeat some bytes; the text is copied to exactly its size so that a
 * sanitizer sees every read beyond it. */
static size_t mutate(char *text, size_t bytes, size_t room)
{
    static const char alphabet[] = "vtnf 0123456789-+.eE/\\\n\r\t#x\0\xff";
    for (uint32_t i = 1 + draw() % 6; i > 0 && bytes > 0; i--) {
        size_t at = draw() % bytes, span = 1 + draw() % 8;
        switch (draw() % 4) {
        case 0:
            text[at] = alphabet[draw() % (sizeof alphabet - 1)];
            break;
        case 1:
            span = span < bytes - at ? span : bytes - at;
            memmove(text + at, text + at + span, bytes - at - span);
            bytes -= span;
            break;
        case 2:
            if (bytes + span > room)
                break;
            memmove(text + at + span, text + at, bytes - at);
            for (size_t k = 0; k < span; k++)
                text[at + k] = alphabet[draw() % (sizeof alphabet - 1)];
            bytes += span;
            break;
        default:
            bytes = draw() % 8 ? bytes : at; /* cut off */
        }
    }
    return bytes;
}

static void mutated_files_never_break_the_reader(void **state)
{
    (void)state;
    static const char seed_text[] =
        "# seed\nmtllib a\nv 0 0 0\nv 1 0 0 1\nv 0 1e0 0\nv 1 1 .5\nvt 0 0\nvt 1 1 0\nvn 0 0 1\n"
        "s 1\nf 1 2 3\nf 1/1 2/2 3/1\nf 1//1 2//1 4//1\nf -4/-2/-1 -3/1/1 \\\n -2/2/1 -1/1/-1\r\n";
    int good = 0, bad = 0;
    random_state = 7;
    print_message("seed %llu\n", (unsigned long long)random_state);
    for (int round = 0; round < 20000; round++) {
        char text[1024];
        memcpy(text, seed_text, sizeof seed_text - 1);
        size_t bytes = mutate(text, sizeof seed_text - 1, sizeof text);
        char *exact = malloc(bytes ? bytes : 1);
        memcpy(exact, text, bytes);
        fl_diags diags = {0};
        fl_mesh *mesh = fl_obj_parse(exact, bytes, "mutated.obj", &diags);
        if (mesh)
            assert_sound(mesh);
        assert_true((mesh == NULL) == (diags.error_count > 0));
        good += mesh != NULL;
        bad += mesh == NULL;
        fl_mesh_release(mesh);
        fl_diags_deinit(&diags);
        free(exact);
    }
    print_message("%d good, %d refused\n", good, bad);
    assert_true(good > 1000 && bad > 1000);
}

/* ---- Files ---- */

static void a_missing_or_wrong_file_is_one_clear_error(void **state)
{
    (void)state;
    fl_diags diags = {0};
    const fl_loc loc = {"a.scene", 3, 7, 4};
    assert_null(fl_mesh_load(temp_path("nothing.obj"), loc, &diags));
    assert_int_equal(diags.items[0].loc.line, 3);
    expect_error(&diags, FL_CAUSE_INPUT, "No such file");
    assert_null(fl_mesh_load(temp_path("mesh.txt"), loc, &diags));
    expect_error(&diags, FL_CAUSE_INPUT, ".obj .ply .stl .gltf or .glb");
    assert_int_equal(mkdir(temp_path("folder.obj"), 0777), 0);
    assert_null(fl_mesh_load(temp_path("folder.obj"), loc, &diags));
    expect_error(&diags, FL_CAUSE_INPUT, "it is a folder");
    assert_null(fl_mesh_load(temp_write("empty.OBJ", "", 0), loc, &diags));
    expect_error(&diags, FL_CAUSE_INPUT, "no faces");
    assert_null(fl_mesh_load(temp_write("empty.ply", "", 0), loc, &diags));
    expect_error(&diags, FL_CAUSE_INPUT, "empty");
    assert_null(fl_mesh_load(temp_write("bad.ply", "ply of no use", 13), loc, &diags));
    assert_int_equal(diags.items[0].loc.line, 3);
    expect_error(&diags, FL_CAUSE_INPUT, "cannot read mesh");
}

static void ply_and_stl_share_their_vertices(void **state)
{
    (void)state;
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\n"
                              "property float y\nproperty float z\nelement face 2\n"
                              "property list uchar int vertex_indices\nend_header\n"
                              "0 0 0\n1 0 0\n0 1 0\n1 0 0\n1 1 0\n-0 1 0\n3 0 1 2\n3 3 4 5\n";
    static const char stl[] =
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\n"
        "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    const char *paths[2] = {temp_write("two.ply", ply, sizeof ply - 1),
                            temp_write("two.stl", stl, sizeof stl - 1)};
    for (int i = 0; i < 2; i++) {
        fl_diags diags = {0};
        fl_mesh *mesh = fl_mesh_load(paths[i], (fl_loc){0}, &diags);
        expect_none(&diags);
        assert_non_null(mesh);
        assert_sound(mesh);
        assert_int_equal(mesh->face_count, 2);
        assert_int_equal(mesh->position_count, 4);
        assert_int_equal(mesh->faces[0].normal[0], FL_NONE);
        fl_mesh_release(mesh);
    }
}

static void gltf_nodes_place_their_meshes(void **state)
{
    (void)state;
    /* One triangle shown by two nodes, the second moved by 10 in x and scaled by 2. */
    static const char gltf[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],"
        "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[10,0,0],\"scale\":[2,2,2]}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
        "\"min\":[0,0,0],\"max\":[1,1,0]}]}";
    fl_diags diags = {0};
    fl_mesh *mesh = fl_mesh_load(temp_write("t.gltf", gltf, sizeof gltf - 1), (fl_loc){0}, &diags);
    expect_none(&diags);
    assert_non_null(mesh);
    assert_sound(mesh);
    assert_int_equal(mesh->face_count, 2);
    assert_int_equal(mesh->position_count, 6);
    double right = 0;
    for (uint32_t i = 0; i < mesh->position_count; i++)
        right = fl_max(right, mesh->positions[i].x);
    assert_true(right == 12.0);
    fl_mesh_release(mesh);
}

/* The library asserts, crashes, goes on for ever or waits: whatever it does, the program lives. */
static void damaged_meshes_are_refused(void **state)
{
    (void)state;
    static const char head[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                               "property float y\nproperty float z\nelement face 1\n"
                               "property list uchar int vertex_indices\n";
    static const char corners[] = "end_header\n0 0 0\n1 0 0\n0 1 0\n";
    static const struct {
        const char *name, *end, *message;
    } cases[] = {
        {"cut.ply", "", "its head does not end"},
        {"many.ply", "element edge 4000000000\nend_header\n", "more elements than its"},
        {"below.ply", "-1 0 1 2\n", "cannot read mesh"},
        {"beyond.ply", "3 0 1 77\n", "mesh"},
        {"wide.ply", "4294967295 0 1 2\n", "cannot read mesh"},
    };
    char text[1024];
    const fl_loc loc = {"a.scene", 3, 7, 4};
    for (size_t i = 0; i < FL_COUNT_OF(cases); i++) {
        fl_diags diags = {0};
        snprintf(text, sizeof text, "%s%s%s", head, i > 1 ? corners : "", cases[i].end);
        assert_null(fl_mesh_load(temp_write(cases[i].name, text, strlen(text)), loc, &diags));
        assert_int_equal(diags.items[0].loc.line, 3);
        expect_error(&diags, FL_CAUSE_INPUT, cases[i].message);
    }
    /* A buffer that would never come. */
    static const char gltf[] =
        "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[{\"attributes\":{"
        "\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0,"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"pipe.bin\"}],\"bufferViews\":[{\"buffer\":0,"
        "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
        "\"type\":\"VEC3\"}]}";
    fl_diags diags = {0};
    assert_int_equal(mkfifo(temp_path("pipe.bin"), 0666), 0);
    assert_null(fl_mesh_load(temp_write("pipe.gltf", gltf, sizeof gltf - 1), loc, &diags));
    expect_error(&diags, FL_CAUSE_INPUT, "cannot read mesh");
}

static void a_reader_that_does_not_start_is_said(void **state)
{
    (void)state;
    fl_diags diags = {0};
    temp_write("libm.so.6", "no library", 10);
    assert_int_equal(setenv("LD_LIBRARY_PATH", temp_folder, 1), 0);
    assert_null(fl_mesh_load(temp_write("a.stl", "solid", 5), (fl_loc){0}, &diags));
    unsetenv("LD_LIBRARY_PATH");
    expect_error(&diags, FL_CAUSE_ENVIRONMENT, "fl_assimp does not work here");
}

/* The simplest counting of statements that could work, for files known to be well formed. */
static void count_statements(const char *path, uint32_t counts[4])
{
    static char line[1 << 16];
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    memset(counts, 0, 4 * sizeof *counts);
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "#")] = '\0';
        char *word = strtok(line, " \t\r\n");
        counts[0] += word && strcmp(word, "v") == 0;
        counts[1] += word && strcmp(word, "vt") == 0;
        counts[2] += word && strcmp(word, "vn") == 0;
        if (word && strcmp(word, "f") == 0)
            for (int corner = 0; strtok(NULL, " \t\r\n"); corner++)
                counts[3] += corner >= 2;
    }
    fclose(file);
}

static int compare_folder(const char *folder)
{
    int compared = 0;
    char path[4096];
    DIR *entries = opendir(folder);
    for (struct dirent *e = entries ? readdir(entries) : NULL; e; e = readdir(entries)) {
        size_t length = strlen(e->d_name);
        if (snprintf(path, sizeof path, "%s/%s", folder, e->d_name) >= (int)sizeof path)
            continue;
        struct stat status;
        if (e->d_name[0] != '.' && stat(path, &status) == 0 && S_ISDIR(status.st_mode))
            compared += compare_folder(path);
        if (length < 4 || strcmp(e->d_name + length - 4, ".obj") != 0)
            continue;
        uint32_t counts[4];
        fl_diags diags = {0};
        fl_mesh *mesh = fl_mesh_load(path, (fl_loc){0}, &diags);
        if (!mesh)
            fail_msg("%s: %s", path, diags.items[0].message);
        assert_sound(mesh);
        count_statements(path, counts);
        assert_int_equal(mesh->position_count, counts[0]);
        assert_int_equal(mesh->uv_count, counts[1]);
        assert_int_equal(mesh->normal_count, counts[2]);
        assert_int_equal(mesh->face_count, counts[3]);
        fl_mesh_release(mesh);
        compared++;
    }
    if (entries)
        closedir(entries);
    return compared;
}

static void meshes_of_the_courses_are_all_read(void **state)
{
    (void)state;
    int compared = compare_folder(FL_SHARED_DIR "/scenes-wild/files");
    if (compared == 0)
        skip();
    print_message("%d meshes\n", compared);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_forms_of_corners_are_read),
        cmocka_unit_test(negative_and_forward_indices_are_resolved),
        cmocka_unit_test(polygons_become_fans),
        cmocka_unit_test(every_layout_of_text_gives_the_same_mesh),
        cmocka_unit_test(each_error_names_its_place),
        cmocka_unit_test(binary_and_endless_errors_stay_short),
        cmocka_unit_test(mutated_files_never_break_the_reader),
        cmocka_unit_test(a_missing_or_wrong_file_is_one_clear_error),
        cmocka_unit_test(ply_and_stl_share_their_vertices),
        cmocka_unit_test(gltf_nodes_place_their_meshes),
        cmocka_unit_test(damaged_meshes_are_refused),
        cmocka_unit_test(a_reader_that_does_not_start_is_said),
        cmocka_unit_test(meshes_of_the_courses_are_all_read),
    };
    return cmocka_run_group_tests(tests, temp_begin, temp_end);
}
