/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/extremes.h"

enum { BALL_LEVEL = 3 };

static fl_mesh *mesh_with(uint32_t positions, uint32_t faces)
{
    fl_mesh *mesh = fl_mesh_create();
    if (!mesh)
        return NULL;
    mesh->position_count = positions;
    mesh->face_count = faces;
    mesh->positions = calloc(positions, sizeof *mesh->positions);
    mesh->faces = calloc(faces, sizeof *mesh->faces);
    if (mesh->positions && mesh->faces)
        return mesh;
    fl_mesh_release(mesh);
    return NULL;
}

static void set_face(fl_mesh *mesh, uint32_t f, uint32_t a, uint32_t b, uint32_t c)
{
    mesh->faces[f] = (fl_face){.position = {a, b, c},
                               .normal = {FL_NONE, FL_NONE, FL_NONE},
                               .uv = {FL_NONE, FL_NONE, FL_NONE}};
}

/* A texture coordinate for every position, and each corner's that of its position. */
static bool add_uvs(fl_mesh *mesh)
{
    mesh->uvs = calloc(mesh->position_count, sizeof *mesh->uvs);
    if (!mesh->uvs)
        return false;
    mesh->uv_count = mesh->position_count;
    for (uint32_t f = 0; f < mesh->face_count; f++)
        for (int k = 0; k < 3; k++)
            mesh->faces[f].uv[k] = mesh->faces[f].position[k];
    return true;
}

/* The eight faces of an octahedron, each a triangular grid of n rows; grids share no corners in the
 * file, but these are the same bits, and that is what closes the ball. */
fl_mesh *extreme_ball(uint32_t level, double radius)
{
    uint32_t n = 1u << level, corners = (n + 1) * (n + 2) / 2, at = 0, face = 0;
    fl_mesh *mesh = mesh_with(8 * corners, 8 * n * n);
    for (uint32_t side = 0; mesh && side < 8; side++) {
        uint32_t first = at;
        for (uint32_t i = 0; i <= n; i++)
            for (uint32_t j = 0; j <= n - i; j++) {
                fl_vec3 p = fl_v3((double)i, (double)j, (double)(n - i - j));
                p = fl_v3_scale(fl_v3_normalize(p), radius);
                mesh->positions[at++] =
                    fl_v3(side & 1u ? -p.x : p.x, side & 2u ? -p.y : p.y, side & 4u ? -p.z : p.z);
            }
        bool flips = (side & 1u) ^ (side >> 1 & 1u) ^ (side >> 2 & 1u);
        for (uint32_t i = 0, row = first; i < n; row += n - i + 1, i++)
            for (uint32_t j = 0; j < n - i; j++) {
                uint32_t a = row + j, b = row + n - i + 1 + j;
                set_face(mesh, face++, a, flips ? a + 1 : b, flips ? b : a + 1);
                if (j + 1 < n - i)
                    set_face(mesh, face++, b, flips ? a + 1 : b + 1, flips ? b + 1 : a + 1);
            }
    }
    if (mesh && !add_uvs(mesh)) {
        fl_mesh_release(mesh);
        return NULL;
    }
    for (uint32_t i = 0; mesh && i < at; i++) {
        mesh->uvs[i].u = (float)(mesh->positions[i].x / radius);
        mesh->uvs[i].v = (float)(mesh->positions[i].y / radius);
    }
    return mesh;
}

/* Two triangles, upright, whose texture coordinates go from `first` to first + 1. */
static fl_mesh *make_sheet(double first)
{
    static const uint32_t faces[][3] = {{0, 1, 2}, {2, 1, 3}};
    fl_mesh *mesh = mesh_with(4, FL_COUNT_OF(faces));
    for (uint32_t i = 0; mesh && i < FL_COUNT_OF(faces); i++)
        set_face(mesh, i, faces[i][0], faces[i][1], faces[i][2]);
    if (mesh && !add_uvs(mesh)) {
        fl_mesh_release(mesh);
        return NULL;
    }
    for (uint32_t i = 0; mesh && i < 4; i++) {
        double x = i & 1u, y = i >> 1;
        mesh->positions[i] = fl_v3(2.0 * x - 1.0, 2.0 * y - 1.0, 0.0);
        mesh->uvs[i].u = (float)(first + x);
        mesh->uvs[i].v = (float)(first + y);
    }
    return mesh;
}

/* Two needles of 1 : 1e6 and 1 : 1e3, a triangle twice, one without area and one that is a point.
 */
static fl_mesh *make_needles(void)
{
    static const double at[][3] = {{-1, 0, 0},    {1, 0, 0},     {0, 2e-6, 0}, {-1, 0.5, 0},
                                   {1, 0.5, 0},   {0, 0.502, 0}, {-1, -1, 0},  {1, -1, 0},
                                   {0, -0.25, 0}, {0.5, 1, 0}};
    static const uint32_t faces[][3] = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {6, 7, 8},
                                        {0, 1, 1}, {9, 9, 9}, {0, 2, 3}, {2, 1, 4}};
    fl_mesh *mesh = mesh_with(FL_COUNT_OF(at), FL_COUNT_OF(faces));
    for (uint32_t i = 0; mesh && i < FL_COUNT_OF(at); i++)
        mesh->positions[i] = fl_v3(at[i][0], at[i][1], at[i][2]);
    for (uint32_t i = 0; mesh && i < FL_COUNT_OF(faces); i++)
        set_face(mesh, i, faces[i][0], faces[i][1], faces[i][2]);
    return mesh;
}

static fl_image *make_image(uint32_t width, uint32_t height)
{
    fl_image *image = fl_image_create(width, height, FL_PIXEL_SRGB8);
    uint8_t *pixel = image ? image->pixels : NULL;
    for (uint32_t y = 0; image && y < height; y++)
        for (uint32_t x = 0; x < width; x++, pixel += 3) {
            /* Slow waves: neighbours differ little, far texels much. */
            pixel[0] = (uint8_t)(40 + 200 * ((x * 8 / width + y * 8 / height) & 1u));
            pixel[1] = (uint8_t)(255 * (uint64_t)x / width);
            pixel[2] = (uint8_t)(255 - 255 * (uint64_t)y / height);
        }
    return image;
}

static const struct {
    const char *name;
    uint32_t width, height;
} images[] = {{"1x1.png", 1, 1},      {"2x1.png", 2, 1},       {"wide.png", 16384, 1},
              {"tall.png", 1, 16384}, {"checker.png", 64, 64}, {"large.png", 16384, 512}};

static bool find(void *context, const char *scene_path, const char *reference, char *out_path,
                 size_t out_bytes)
{
    (void)context;
    (void)scene_path;
    return (size_t)snprintf(out_path, out_bytes, "%s", reference) < out_bytes;
}

static fl_mesh *load_mesh(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)context;
    double first = 0.0;
    if (strncmp(path, "sheet", 5) == 0)
        fl_number_parse(path + 5, path + strlen(path) - strlen(".obj"), &first);
    fl_mesh *mesh = strcmp(path, "ball.obj") == 0    ? extreme_ball(BALL_LEVEL, 1.0)
                    : strncmp(path, "sheet", 5) == 0 ? make_sheet(first)
                                                     : make_needles();
    if (!mesh)
        fl_error(diags, loc, "no memory for '%s'", path);
    return mesh;
}

static fl_image *load_image(void *context, const char *path, fl_loc loc, fl_diags *diags)
{
    (void)context;
    fl_image *image = NULL;
    for (size_t i = 0; i < FL_COUNT_OF(images); i++)
        if (strcmp(images[i].name, path) == 0)
            image = make_image(images[i].width, images[i].height);
    if (!image)
        fl_error(diags, loc, "'%s' is no picture of the suite, or there is no memory", path);
    return image;
}

const fl_files extreme_files = {.find = find, .load_mesh = load_mesh, .load_image = load_image};
