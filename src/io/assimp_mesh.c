/* SPDX-License-Identifier: MIT */
#include "io/assimp_mesh.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/mesh_file.h"
#include "io/path.h"

/* Node trees are walked with a stack of our own; a deeper or wider one than this is no mesh. */
enum { NODES_MAX = 100000 };

/* ---- Identical positions joined ---- */

/* Open addressing over positions by their bits; slots hold indices, FL_NONE is free. At most half
 * full. */
typedef struct joiner {
    uint32_t *slots, mask;
} joiner;

static uint32_t hash_position(fl_vec3 p)
{
    uint32_t words[6], h = 0;
    memcpy(words, &p, sizeof words);
    for (size_t i = 0; i < FL_COUNT_OF(words); i++)
        h = fl_hash_step(h, words[i]);
    return h;
}

/* The index of the position equal to `p`, which is added if there is none. */
static uint32_t join(joiner *j, fl_mesh *mesh, fl_vec3 p)
{
    p = fl_v3(p.x + 0.0, p.y + 0.0, p.z + 0.0); /* -0 and 0 are one place */
    uint32_t slot = hash_position(p) & j->mask;
    while (j->slots[slot] != FL_NONE) {
        fl_vec3 q = mesh->positions[j->slots[slot]];
        if (p.x == q.x && p.y == q.y && p.z == q.z)
            return j->slots[slot];
        slot = (slot + 1) & j->mask;
    }
    j->slots[slot] = mesh->position_count;
    mesh->positions[mesh->position_count] = p;
    return mesh->position_count++;
}

/* ---- The walk over nodes ---- */

typedef struct assimp_reader {
    const struct aiScene *scene;
    const char *path;
    fl_diags *diags;
    bool has_vertex_normals; /* The format's normals belong to vertices. */
    joiner joiner;
    fl_mesh *mesh;
} assimp_reader;

typedef struct placed_node {
    const struct aiNode *node;
    fl_affine to_world;
} placed_node;

static fl_affine affine_from(const struct aiMatrix4x4 *m)
{
    return (fl_affine){{{(double)m->a1, (double)m->a2, (double)m->a3, (double)m->a4},
                        {(double)m->b1, (double)m->b2, (double)m->b3, (double)m->b4},
                        {(double)m->c1, (double)m->c2, (double)m->c3, (double)m->c4}}};
}

static fl_vec3 vec_from(struct aiVector3D v)
{
    return fl_v3((double)v.x, (double)v.y, (double)v.z);
}

/* Copy the triangles of one mesh, once for each node that shows it. */
static bool add_mesh(assimp_reader *r, const struct aiMesh *from, const fl_affine *to_world)
{
    fl_mesh *mesh = r->mesh;
    fl_affine inverse = fl_affine_identity();
    bool has_uvs = from->mTextureCoords[0] != NULL;
    bool has_normals =
        r->has_vertex_normals && from->mNormals && fl_affine_invert(to_world, &inverse);
    uint32_t normal_base = mesh->normal_count, uv_base = mesh->uv_count;
    for (uint32_t i = 0; i < from->mNumVertices; i++) {
        if (has_normals)
            mesh->normals[mesh->normal_count++] =
                fl_affine_transposed_direction(&inverse, vec_from(from->mNormals[i]));
        if (has_uvs)
            mesh->uvs[mesh->uv_count++] =
                (fl_uv){from->mTextureCoords[0][i].x, from->mTextureCoords[0][i].y};
    }
    for (uint32_t f = 0; f < from->mNumFaces; f++) {
        if (from->mFaces[f].mNumIndices != 3)
            continue; /* points and lines */
        fl_face *face = &mesh->faces[mesh->face_count++];
        for (int k = 0; k < 3; k++) {
            uint32_t index = from->mFaces[f].mIndices[k];
            if (index >= from->mNumVertices)
                return fl_error(r->diags, (fl_loc){0}, "mesh '%s' has a corner out of range",
                                r->path);
            fl_vec3 p = fl_affine_point(to_world, vec_from(from->mVertices[index]));
            if (!fl_v3_is_finite(p))
                return fl_error(r->diags, (fl_loc){0}, "mesh '%s' has a vertex that is not finite",
                                r->path);
            face->position[k] = join(&r->joiner, mesh, p);
            face->normal[k] = has_normals ? normal_base + index : FL_NONE;
            face->uv[k] = has_uvs ? uv_base + index : FL_NONE;
        }
    }
    return true;
}

/* Visit each node that shows a mesh. With `is_counting` only totals go to `totals`. */
typedef struct totals {
    uint64_t vertices, faces;
} totals;

static bool visit_node(assimp_reader *r, const placed_node *placed, totals *counting)
{
    for (uint32_t i = 0; i < placed->node->mNumMeshes; i++) {
        const struct aiMesh *mesh = r->scene->mMeshes[placed->node->mMeshes[i]];
        if (counting) {
            counting->vertices += mesh->mNumVertices;
            counting->faces += mesh->mNumFaces;
        } else if (!add_mesh(r, mesh, &placed->to_world)) {
            return false;
        }
    }
    return true;
}

static bool walk_nodes(assimp_reader *r, totals *counting)
{
    placed_node *stack = malloc(NODES_MAX * sizeof *stack);
    if (!stack)
        return fl_out_of_memory(r->diags, r->path);
    uint32_t depth = 1, visited = 0;
    bool is_good = true;
    stack[0] =
        (placed_node){r->scene->mRootNode, affine_from(&r->scene->mRootNode->mTransformation)};
    while (depth > 0 && is_good) {
        placed_node placed = stack[--depth];
        is_good = visit_node(r, &placed, counting);
        if (is_good && (++visited > NODES_MAX || depth + placed.node->mNumChildren > NODES_MAX))
            is_good = fl_error(r->diags, (fl_loc){0}, "mesh '%s' has more than %d nodes", r->path,
                               NODES_MAX);
        for (uint32_t i = placed.node->mNumChildren; is_good && i-- > 0;) {
            const struct aiNode *child = placed.node->mChildren[i];
            fl_affine local = affine_from(&child->mTransformation);
            stack[depth++] = (placed_node){child, fl_affine_mul(&placed.to_world, &local)};
        }
    }
    free(stack);
    return is_good;
}

static bool allocate(assimp_reader *r, const totals *need)
{
    fl_mesh *mesh = r->mesh;
    if (need->faces > FL_MESH_ELEMENTS_MAX || need->vertices > FL_MESH_ELEMENTS_MAX)
        return fl_error(r->diags, (fl_loc){0},
                        "mesh '%s' is too large: more than %u elements of one kind", r->path,
                        FL_MESH_ELEMENTS_MAX);
    size_t slot_count = 16;
    while (slot_count < 2 * need->vertices)
        slot_count *= 2;
    size_t vertices = (size_t)need->vertices + 1, faces = (size_t)need->faces + 1;
    r->joiner = (joiner){malloc(slot_count * sizeof(uint32_t)), (uint32_t)(slot_count - 1)};
    mesh->positions = malloc(vertices * sizeof *mesh->positions);
    mesh->normals = malloc(vertices * sizeof *mesh->normals);
    mesh->uvs = malloc(vertices * sizeof *mesh->uvs);
    mesh->faces = malloc(faces * sizeof *mesh->faces);
    if (!r->joiner.slots || !mesh->positions || !mesh->normals || !mesh->uvs || !mesh->faces)
        return fl_out_of_memory(r->diags, r->path);
    memset(r->joiner.slots, 0xFF, slot_count * sizeof(uint32_t));
    return true;
}

static bool convert(assimp_reader *r)
{
    totals need = {0};
    if (!r->mesh)
        return fl_out_of_memory(r->diags, r->path);
    if (!walk_nodes(r, &need) || !allocate(r, &need) || !walk_nodes(r, NULL))
        return false;
    if (r->mesh->face_count == 0)
        return fl_error(r->diags, (fl_loc){0}, "mesh '%s' has no faces", r->path);
    return true;
}

/* ---- Files ---- */

static size_t read_file(struct aiFile *file, char *out, size_t size, size_t count)
{
    return fread(out, size, count, (FILE *)(void *)file->UserData);
}

static size_t tell_file(struct aiFile *file)
{
    return (size_t)ftell((FILE *)(void *)file->UserData);
}

static size_t size_of_file(struct aiFile *file)
{
    struct stat status;
    return fstat(fileno((FILE *)(void *)file->UserData), &status) == 0 ? (size_t)status.st_size : 0;
}

static aiReturn seek_file(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
    int from = origin == aiOrigin_SET ? SEEK_SET : origin == aiOrigin_CUR ? SEEK_CUR : SEEK_END;
    return fseek((FILE *)(void *)file->UserData, (long)offset, from) == 0 ? aiReturn_SUCCESS
                                                                          : aiReturn_FAILURE;
}

static size_t write_file(struct aiFile *file, const char *data, size_t size, size_t count)
{
    (void)file;
    (void)data;
    (void)size;
    (void)count;
    return 0;
}

static void flush_file(struct aiFile *file)
{
    (void)file;
}

/* A glTF names other files: only regular ones, and without waiting for the other end of a pipe. */
static struct aiFile *open_file(struct aiFileIO *io, const char *path, const char *mode)
{
    (void)io;
    struct stat status;
    if (mode[0] != 'r')
        return NULL;
    int number = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    bool is_fine = number >= 0 && fstat(number, &status) == 0 && S_ISREG(status.st_mode);
    FILE *stream = is_fine ? fdopen(number, "rb") : NULL;
    struct aiFile *file = stream ? malloc(sizeof *file) : NULL;
    if (file)
        *file = (struct aiFile){read_file, write_file, tell_file,     size_of_file,
                                seek_file, flush_file, (char *)stream};
    else if (stream)
        fclose(stream);
    else if (number >= 0)
        close(number);
    return file;
}

static void close_file(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    fclose((FILE *)(void *)file->UserData);
    free(file);
}

/* ---- The whole ---- */

/* The library takes time by the counts of a PLY's head, and never finds the end of one that has
 * none. Every element has a byte at least. */
static bool check_ply_head(const char *path, size_t bytes, fl_diags *diags)
{
    enum { LINES_MAX = 1000 };
    char line[512];
    uintmax_t total = 0, count;
    bool has_end = false;
    FILE *file = fopen(path, "rb");
    for (int i = 0; file && i < LINES_MAX && !has_end && fgets(line, sizeof line, file); i++) {
        has_end = strncmp(line, "end_header", 10) == 0;
        if (sscanf(line, "element %*s %" SCNuMAX, &count) == 1)
            total = count > bytes || total > bytes ? UINTMAX_MAX : total + count;
    }
    if (file)
        fclose(file);
    if (!has_end)
        return fl_error(diags, (fl_loc){0}, "cannot read mesh '%s': its head does not end", path);
    return total <= bytes ||
           fl_error(diags, (fl_loc){0},
                    "cannot read mesh '%s': its head says more elements than its %zu bytes hold",
                    path, bytes);
}

static const char *find_reason(void)
{
    const char *text = aiGetErrorString();
    return strstr(text, "bad_alloc") ? "it asks for more memory than a file of its size needs"
                                     : text;
}

fl_mesh *fl_mesh_load_assimp(const char *path, size_t bytes, fl_diags *diags)
{
    struct aiFileIO io = {open_file, close_file, NULL};
    if (bytes == 0) {
        fl_error(diags, (fl_loc){0}, "cannot read mesh '%s': it is empty", path);
        return NULL;
    }
    if (strcasecmp(fl_path_ending(path), ".ply") == 0 && !check_ply_head(path, bytes, diags))
        return NULL;
    const struct aiScene *scene =
        aiImportFileEx(path, aiProcess_Triangulate | aiProcess_SortByPType, &io);
    if (!scene || !scene->mRootNode) {
        fl_error(diags, (fl_loc){0}, "cannot read mesh '%s': %s", path, find_reason());
        aiReleaseImport(scene);
        return NULL;
    }
    assimp_reader r = {.scene = scene,
                       .path = path,
                       .diags = diags,
                       .has_vertex_normals = strcasecmp(fl_path_ending(path), ".stl") != 0,
                       .mesh = fl_mesh_create()};
    bool is_good = convert(&r);
    free(r.joiner.slots);
    aiReleaseImport(scene);
    if (is_good)
        return r.mesh;
    fl_mesh_release(r.mesh);
    return NULL;
}
