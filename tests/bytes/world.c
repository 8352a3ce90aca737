/* SPDX-License-Identifier: MIT */
#include "bytes/world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RING_AROUND = 12, RING_ACROSS = 8, BUMPS_SIDE = 9 };

/* A point of the unit circle for a turn of s / 4, s in [0, 4): the rational circle, no sine. */
static void on_circle(double s, double *out_x, double *out_y)
{
    int quarter = (int)s;
    double t = s - quarter, n = 1.0 + t * t;
    double x = (1.0 - t * t) / n, y = 2.0 * t / n;
    const double turned[4][2] = {{x, y}, {-y, x}, {-x, -y}, {y, -x}};
    *out_x = turned[quarter & 3][0];
    *out_y = turned[quarter & 3][1];
}

static fl_mesh *mesh_with(uint32_t positions, uint32_t normals, uint32_t uvs, uint32_t faces)
{
    fl_mesh *mesh = fl_mesh_create();
    if (!mesh)
        return NULL;
    mesh->positions = calloc(positions, sizeof *mesh->positions);
    mesh->normals = normals ? calloc(normals, sizeof *mesh->normals) : NULL;
    mesh->uvs = uvs ? calloc(uvs, sizeof *mesh->uvs) : NULL;
    mesh->faces = calloc(faces, sizeof *mesh->faces);
    if (!mesh->positions || (normals && !mesh->normals) || (uvs && !mesh->uvs) || !mesh->faces) {
        fl_mesh_release(mesh);
        return NULL;
    }
    mesh->position_count = positions;
    mesh->normal_count = normals;
    mesh->uv_count = uvs;
    mesh->face_count = faces;
    return mesh;
}

/* Two faces of a quad whose corners are the numbers of positions, and of texture coordinates. */
static void add_quad(fl_mesh *mesh, uint32_t *face, const uint32_t corner[4], const uint32_t uv[4])
{
    static const uint8_t order[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (int half = 0; half < 2; half++) {
        fl_face *f = &mesh->faces[(*face)++];
        for (int i = 0; i < 3; i++) {
            f->position[i] = corner[order[half][i]];
            f->normal[i] = mesh->normals ? f->position[i] : FL_NONE;
            f->uv[i] = uv[order[half][i]];
        }
    }
}

/* A torus about y; the seams of the texture coordinates have vertices of their own. */
static fl_mesh *make_ring(void)
{
    enum { U = RING_AROUND, V = RING_ACROSS };
    fl_mesh *mesh = mesh_with(U * V, 0, (U + 1) * (V + 1), 2 * U * V);
    if (!mesh)
        return NULL;
    for (uint32_t i = 0; i < U * V; i++) {
        double cx, cz, r, y;
        on_circle(4.0 * (i / V) / U, &cx, &cz);
        on_circle(4.0 * (i % V) / V, &r, &y);
        r = 1.0 + 0.375 * r;
        mesh->positions[i] = fl_v3(r * cx, 0.375 * y, r * cz);
    }
    for (uint32_t i = 0; i < (U + 1) * (V + 1); i++)
        mesh->uvs[i] = (fl_uv){(float)(i / (V + 1)) / U, (float)(i % (V + 1)) / V};
    uint32_t face = 0;
    for (uint32_t u = 0; u < U; u++) {
        for (uint32_t v = 0; v < V; v++) {
            uint32_t u1 = (u + 1) % U, v1 = (v + 1) % V, row = V + 1;
            add_quad(mesh, &face, (uint32_t[]){u * V + v, u * V + v1, u1 * V + v1, u1 * V + v},
                     (uint32_t[]){u * row + v, u * row + v + 1, (u + 1) * row + v + 1,
                                  (u + 1) * row + v});
        }
    }
    return mesh;
}

/* y = x (1 - x^2) z over [-1, 1]^2 with its exact normals. */
static fl_mesh *make_bumps(void)
{
    enum { N = BUMPS_SIDE };
    fl_mesh *mesh = mesh_with(N * N, N * N, N * N, 2 * (N - 1) * (N - 1));
    if (!mesh)
        return NULL;
    for (uint32_t i = 0; i < N * N; i++) {
        double u = (double)(i % N) / (N - 1), v = (double)(i / N) / (N - 1);
        double x = 2.0 * u - 1.0, z = 1.0 - 2.0 * v;
        mesh->positions[i] = fl_v3(x, x * (1.0 - x * x) * z, z);
        mesh->normals[i] = fl_v3(-(1.0 - 3.0 * x * x) * z, 1.0, -x * (1.0 - x * x));
        mesh->uvs[i] = (fl_uv){(float)u, (float)v};
    }
    uint32_t face = 0;
    for (uint32_t row = 0; row + 1 < N; row++) {
        for (uint32_t column = 0; column + 1 < N; column++) {
            uint32_t a = row * N + column;
            uint32_t corner[4] = {a, a + 1, a + N + 1, a + N};
            add_quad(mesh, &face, corner, corner);
        }
    }
    return mesh;
}

static fl_mesh *make_slivers(void)
{
    static const double at[][3] = {{-1, 0, 0},      {1, 0, 0},       {0, 0x1p-20, 0},
                                   {0, 1, 0.5},     {0, 1, 0.5},     {-0.75, 0.5, 0.25},
                                   {1, 1, -0x1p-9}, {1, -1, 0x1p-9}, {-1, -1, 0x1p-9}};
    static const uint32_t faces[][3] = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 2, 5}, {3, 4, 5},
                                        {6, 7, 8}, {6, 7, 8}, {1, 1, 7}, {5, 2, 3}, {8, 5, 6}};
    fl_mesh *mesh = mesh_with(FL_COUNT_OF(at), 0, 0, FL_COUNT_OF(faces));
    if (!mesh)
        return NULL;
    for (size_t i = 0; i < FL_COUNT_OF(at); i++)
        mesh->positions[i] = fl_v3(at[i][0], at[i][1], at[i][2]);
    for (size_t i = 0; i < FL_COUNT_OF(faces); i++)
        mesh->faces[i] = (fl_face){.position = {faces[i][0], faces[i][1], faces[i][2]},
                                   .normal = {FL_NONE, FL_NONE, FL_NONE},
                                   .uv = {FL_NONE, FL_NONE, FL_NONE}};
    return mesh;
}

/* Checks with hashed values in them. */
static fl_image *make_bytes(uint32_t width, uint32_t height, fl_pixel_format format, uint32_t seed)
{
    fl_image *image = fl_image_create(width, height, format);
    if (!image)
        return NULL;
    uint8_t *pixel = image->pixels;
    for (uint32_t i = 0; i < 3 * width * height; i++) {
        uint32_t x = i / 3 % width, y = i / 3 / width;
        uint32_t noise = fl_hash_step(seed, i) >> 26;
        pixel[i] = (uint8_t)(((x ^ y) & 1u ? 180u : 20u) + noise);
    }
    return image;
}

static fl_image *make_glow(void)
{
    fl_image *image = fl_image_create(8, 5, FL_PIXEL_FLOAT);
    if (!image)
        return NULL;
    float *pixel = image->pixels;
    for (uint32_t i = 0; i < 3 * 8 * 5; i++)
        pixel[i] = (float)(fl_hash_step(7, i) >> 8) * 0x1p-22f;
    return image;
}

static const char *const mesh_names[] = {"ring.obj", "bumps.obj", "slivers.obj"};
static const char *const image_names[] = {"checker.png",   "ramp.png",      "glow.png",
                                          "sky/right.png", "sky/left.png",  "sky/up.png",
                                          "sky/down.png",  "sky/front.png", "sky/back.png"};

static uint32_t name_index(const char *const *names, size_t count, const char *name)
{
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0)
            return i;
    return FL_NONE;
}

static bool find(void *context, const char *scene_path, const char *reference, char *out_path,
                 size_t out_bytes)
{
    (void)context;
    (void)scene_path;
    if (name_index(mesh_names, FL_COUNT_OF(mesh_names), reference) == FL_NONE &&
        name_index(image_names, FL_COUNT_OF(image_names), reference) == FL_NONE)
        return false;
    return (size_t)snprintf(out_path, out_bytes, "%s", reference) < out_bytes;
}

static fl_mesh *load_mesh(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)context;
    static fl_mesh *(*const make[])(void) = {make_ring, make_bumps, make_slivers};
    uint32_t index = name_index(mesh_names, FL_COUNT_OF(mesh_names), path);
    if (index == FL_NONE) {
        fl_error(diags, loc, "'%s' is no mesh", path);
        return NULL;
    }
    fl_mesh *mesh = make[index]();
    if (!mesh)
        fl_out_of_memory(diags, "a mesh");
    return mesh;
}

static fl_image *load_image(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)context;
    uint32_t index = name_index(image_names, FL_COUNT_OF(image_names), path);
    if (index == FL_NONE) {
        fl_error(diags, loc, "'%s' is no picture", path);
        return NULL;
    }
    fl_image *image = index == 0   ? make_bytes(13, 9, FL_PIXEL_SRGB8, 1)
                      : index == 1 ? make_bytes(16, 16, FL_PIXEL_LINEAR8, 2)
                      : index == 2 ? make_glow()
                                   : make_bytes(8, 8, FL_PIXEL_SRGB8, index);
    if (!image)
        fl_out_of_memory(diags, "a picture");
    return image;
}

const fl_files test_world = {.find = find, .load_mesh = load_mesh, .load_image = load_image};
