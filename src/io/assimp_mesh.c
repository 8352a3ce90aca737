/* SPDX-License-Identifier: MIT */
#include "io/mesh_file.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "io/files.h"

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
    fl_loc loc;
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
                return fl_error(r->diags, r->loc, "mesh '%s' has a corner out of range", r->path);
            fl_vec3 p = fl_affine_point(to_world, vec_from(from->mVertices[index]));
            if (!fl_v3_is_finite(p))
                return fl_error(r->diags, r->loc, "mesh '%s' has a vertex that is not finite",
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
            is_good =
                fl_error(r->diags, r->loc, "mesh '%s' has more than %d nodes", r->path, NODES_MAX);
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
        return fl_error(r->diags, r->loc,
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
        return fl_error(r->diags, r->loc, "mesh '%s' has no faces", r->path);
    return true;
}

fl_mesh *fl_mesh_load_assimp(const char *path, fl_loc loc, fl_diags *diags)
{
    size_t bytes;
    if (!fl_file_check(path, "mesh", FL_MESH_FILE_MAX_BYTES, loc, diags, &bytes))
        return NULL;
    const struct aiScene *scene =
        bytes > 0 ? aiImportFile(path, aiProcess_Triangulate | aiProcess_SortByPType) : NULL;
    if (!scene || !scene->mRootNode) {
        fl_error(diags, loc, "cannot read mesh '%s': %s", path,
                 bytes > 0 ? aiGetErrorString() : "it is empty");
        aiReleaseImport(scene);
        return NULL;
    }
    const char *dot = strrchr(path, '.');
    assimp_reader r = {.scene = scene,
                       .path = path,
                       .loc = loc,
                       .diags = diags,
                       .has_vertex_normals = dot && strcasecmp(dot, ".stl") != 0,
                       .mesh = fl_mesh_create()};
    bool is_good = convert(&r);
    free(r.joiner.slots);
    aiReleaseImport(scene);
    if (is_good)
        return r.mesh;
    fl_mesh_release(r.mesh);
    return NULL;
}
