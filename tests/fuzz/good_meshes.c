/* SPDX-License-Identifier: MIT
 *
 * A tetrahedron in every format that assimp reads for us, with what else such files hold: normals,
 * texture coordinates, nodes with matrices, and of glTF sparse accessors, morphing, skins, cameras.
 */
#include "fuzz/good_files.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 4, FACES = 4, BYTES_MAX = 8192 };

static const float corners[CORNERS][8] = {{0, 0, 0, -1, 0, 0, 0, 0},
                                          {1, 0, 0, 1, 0, 0, 1, 0},
                                          {0, 1, 0, 0, 1, 0, 0, 1},
                                          {0, 0, 1, 0, 0, 1, 1, 1}};
static const uint8_t faces[FACES][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

typedef struct bytes {
    uint8_t data[BYTES_MAX];
    size_t count;
} bytes;

static void put(bytes *b, const void *data, size_t count)
{
    memcpy(b->data + b->count, data, count);
    b->count += count;
}

static void put_text(bytes *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put_text(bytes *b, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int length = vsnprintf((char *)b->data + b->count, BYTES_MAX - b->count, format, args);
    va_end(args);
    b->count += (size_t)length;
}

/* Four bytes in the machine's order, or in the other. */
static void put_word(bytes *b, const void *word, bool is_swapped)
{
    const uint8_t *w = word;
    const uint8_t swapped[4] = {w[3], w[2], w[1], w[0]};
    put(b, is_swapped ? swapped : w, 4);
}

static bool save(const bytes *b, const char *folder, const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    bool is_fine = file && fwrite(b->data, 1, b->count, file) == b->count;
    if (!file || fclose(file) != 0 || !is_fine)
        fprintf(stderr, "cannot write %s\n", path);
    return is_fine;
}

static bool save_ply(const char *folder, const char *name, const char *format)
{
    static const char *const columns[] = {"x", "y", "z", "nx", "ny", "nz", "s", "t"};
    bool is_text = strcmp(format, "ascii") == 0, is_big = strcmp(format, "binary_big_endian") == 0;
    bytes b = {.count = 0};
    put_text(&b, "ply\nformat %s 1.0\ncomment a tetrahedron\nelement vertex %d\n", format, CORNERS);
    for (int k = 0; k < 8; k++)
        put_text(&b, "property float %s\n", columns[k]);
    put_text(&b, "element face %d\nproperty list uchar int vertex_indices\nend_header\n", FACES);
    for (int i = 0; i < CORNERS; i++)
        for (int k = 0; k < 8; k++)
            if (is_text)
                put_text(&b, "%g%c", (double)corners[i][k], k == 7 ? '\n' : ' ');
            else
                put_word(&b, &corners[i][k], is_big);
    for (int f = 0; f < FACES; f++) {
        put_text(&b, "%s", is_text ? "3" : "\3");
        for (int k = 0; k < 3; k++) {
            int32_t index = faces[f][k];
            if (is_text)
                put_text(&b, " %d", index);
            else
                put_word(&b, &index, is_big);
        }
        put_text(&b, "%s", is_text ? "\n" : "");
    }
    return save(&b, folder, name);
}

static bool save_stl(const char *folder, const char *name, bool is_text)
{
    bytes b = {.count = 0};
    uint32_t count = FACES;
    if (is_text) {
        put_text(&b, "solid tetrahedron\n");
    } else {
        put_text(&b, "%-80s", "binary");
        put_word(&b, &count, false);
    }
    for (int f = 0; f < FACES; f++) {
        if (is_text)
            put_text(&b, "facet normal 0 0 1\nouter loop\n");
        else
            put(&b, corners[0] + 3, 12);
        for (int k = 0; k < 3; k++) {
            const float *p = corners[faces[f][k]];
            if (is_text)
                put_text(&b, "vertex %g %g %g\n", (double)p[0], (double)p[1], (double)p[2]);
            else
                put(&b, p, 12);
        }
        if (is_text)
            put_text(&b, "endloop\nendfacet\n");
        else
            put(&b, "\0", 2);
    }
    if (is_text)
        put_text(&b, "endsolid tetrahedron\n");
    return save(&b, folder, name);
}

/* Binary part of glTF: 0 corners (32 bytes each), 128 indices, 152 two indices of sparse ones, 156
 * two positions, 180 a matrix, 244 joints, 260 weights. */
static void gltf_buffer(bytes *b)
{
    static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const uint8_t joints[16] = {0};
    put(b, corners, sizeof corners);
    for (int i = 0; i < 3 * FACES; i++) {
        uint16_t index = faces[i / 3][i % 3];
        put(b, &index, 2);
    }
    put(b, (const uint16_t[2]){1, 3}, 4);
    put(b, corners, 24);
    put(b, identity, sizeof identity);
    put(b, joints, sizeof joints);
    for (int i = 0; i < CORNERS; i++)
        put(b, identity, 16);
}

static void put_base64(bytes *b, const bytes *from)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i + 3 <= from->count; i += 3) {
        uint32_t word =
            (uint32_t)from->data[i] << 16 | (uint32_t)from->data[i + 1] << 8 | from->data[i + 2];
        for (int shift = 18; shift >= 0; shift -= 6)
            put(b, &digits[word >> shift & 63], 1);
    }
}

static const char gltf_text[] =
    "\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,2]}],"
    "\"nodes\":[{\"mesh\":0,\"children\":[1],\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,3,0,0,1]},"
    "{\"mesh\":0,\"skin\":0,\"translation\":[0,2,0],\"rotation\":[0,0,0.7071068,0.7071068],"
    "\"scale\":[1,2,1]},"
    "{\"camera\":0}],\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":"
    "0.1}}],"
    "\"skins\":[{\"joints\":[0,1],\"inverseBindMatrices\":7}],"
    "\"materials\":[{\"name\":\"m\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,1]}}],"
    "\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
    "\"TEXCOORD_0\":2,"
    "\"JOINTS_0\":5,\"WEIGHTS_0\":6},\"indices\":3,\"material\":0,\"targets\":[{\"POSITION\":4}]},"
    "{\"attributes\":{\"POSITION\":0},\"mode\":5}]}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":"
    "[0,0,0],"
    "\"max\":[1,1,1]},{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5126,\"count\":4,"
    "\"type\":\"VEC3\"},"
    "{\"bufferView\":0,\"byteOffset\":24,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
    "{\"bufferView\":1,\"componentType\":5123,\"count\":12,\"type\":\"SCALAR\"},"
    "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":2,\"indices\":{"
    "\"bufferView\":2,"
    "\"componentType\":5123},\"values\":{\"bufferView\":3}}},"
    "{\"bufferView\":5,\"componentType\":5121,\"count\":4,\"type\":\"VEC4\"},"
    "{\"bufferView\":6,\"componentType\":5126,\"count\":4,\"type\":\"VEC4\"},"
    "{\"bufferView\":4,\"componentType\":5126,\"count\":1,\"type\":\"MAT4\"}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":128,\"byteStride\":32},"
    "{\"buffer\":0,\"byteOffset\":128,\"byteLength\":24},{\"buffer\":0,\"byteOffset\":152,"
    "\"byteLength\":4},"
    "{\"buffer\":0,\"byteOffset\":156,\"byteLength\":24},{\"buffer\":0,\"byteOffset\":180,"
    "\"byteLength\":64},"
    "{\"buffer\":0,\"byteOffset\":244,\"byteLength\":16},{\"buffer\":0,\"byteOffset\":260,"
    "\"byteLength\":64}],";

static bool save_gltf(const char *folder)
{
    bytes b = {.count = 0}, buffer = {.count = 0};
    gltf_buffer(&buffer);
    put_text(&b,
             "{%s\"buffers\":[{\"byteLength\":%zu,\"uri\":\"data:application/octet-stream;base64,",
             gltf_text, buffer.count);
    put_base64(&b, &buffer);
    put_text(&b, "\"}]}");
    return save(&b, folder, "two.gltf");
}

static bool save_glb(const char *folder)
{
    bytes json = {.count = 0}, buffer = {.count = 0}, b = {.count = 0};
    gltf_buffer(&buffer);
    put_text(&json, "{%s\"buffers\":[{\"byteLength\":%zu}]}", gltf_text, buffer.count);
    while (json.count % 4)
        put_text(&json, " ");
    uint32_t chunk = (uint32_t)json.count, rest = (uint32_t)buffer.count, all = 28 + chunk + rest,
             version = 2;
    put_text(&b, "glTF");
    put_word(&b, &version, false);
    put_word(&b, &all, false);
    put_word(&b, &chunk, false);
    put_text(&b, "JSON");
    put(&b, json.data, json.count);
    put_word(&b, &rest, false);
    put(&b, "BIN", 4);
    put(&b, buffer.data, buffer.count);
    return save(&b, folder, "two.glb");
}

/* The older glTF names its parts. */
static bool save_old_gltf(const char *folder)
{
    bytes b = {.count = 0}, buffer = {.count = 0};
    gltf_buffer(&buffer);
    put_text(
        &b,
        "{\"asset\":{\"version\":\"1.0\"},\"scene\":\"s\",\"scenes\":{\"s\":{\"nodes\":[\"n\"]}},"
        "\"nodes\":{\"n\":{\"meshes\":[\"m\"],\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}},"
        "\"meshes\":{\"m\":{\"primitives\":[{\"attributes\":{\"POSITION\":\"p\"},\"indices\":\"i\"}"
        "]}},"
        "\"accessors\":{\"p\":{\"bufferView\":\"v\",\"byteOffset\":0,\"byteStride\":32,"
        "\"componentType\":5126,"
        "\"count\":4,\"type\":\"VEC3\"},\"i\":{\"bufferView\":\"w\",\"byteOffset\":0,"
        "\"componentType\":5123,"
        "\"count\":12,\"type\":\"SCALAR\"}},"
        "\"bufferViews\":{\"v\":{\"buffer\":\"b\",\"byteOffset\":0,\"byteLength\":128,\"target\":"
        "34962},"
        "\"w\":{\"buffer\":\"b\",\"byteOffset\":128,\"byteLength\":24,\"target\":34963}},"
        "\"buffers\":{\"b\":{\"byteLength\":%zu,\"type\":\"arraybuffer\","
        "\"uri\":\"data:application/octet-stream;base64,",
        buffer.count);
    put_base64(&b, &buffer);
    put_text(&b, "\"}}}");
    return save(&b, folder, "one.gltf");
}

bool good_meshes(const char *folder)
{
    return save_ply(folder, "text.ply", "ascii") &&
           save_ply(folder, "little.ply", "binary_little_endian") &&
           save_ply(folder, "big.ply", "binary_big_endian") && save_stl(folder, "text.stl", true) &&
           save_stl(folder, "binary.stl", false) && save_gltf(folder) && save_glb(folder) &&
           save_old_gltf(folder);
}
