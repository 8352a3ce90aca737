/* SPDX-License-Identifier: MIT
 *
 * simplify IN.obj OUT.obj [TRIANGLES]
 *
 * Places a triangle mesh for use in scenes: height 1, feet at y = 0, centred in x and z. With
 * TRIANGLES it is first simplified to exactly that many by edge collapses (libmeshoptimizer),
 * seeking the target that lands there; exit 1 if none does. Reads `v x y z` and `f a b c` only.
 */
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct mesh {
    float *positions; /* 3 a vertex */
    unsigned int *indices;
    size_t vertex_count, index_count;
} mesh;

static void *checked(void *memory)
{
    if (!memory) {
        fprintf(stderr, "simplify: out of memory\n");
        exit(4);
    }
    return memory;
}

static mesh read_obj(const char *path)
{
    mesh m = {0};
    size_t vertex_room = 0, index_room = 0;
    char line[256];
    FILE *file = fopen(path, "r");
    if (!file) {
        perror(path);
        exit(4);
    }
    while (fgets(line, sizeof line, file)) {
        float p[3];
        unsigned int f[3];
        if (sscanf(line, "v %f %f %f", &p[0], &p[1], &p[2]) == 3) {
            if (m.vertex_count == vertex_room) {
                vertex_room = vertex_room ? 2 * vertex_room : 1024;
                m.positions = checked(realloc(m.positions, vertex_room * sizeof p));
            }
            memcpy(&m.positions[3 * m.vertex_count++], p, sizeof p);
        } else if (sscanf(line, "f %u %u %u", &f[0], &f[1], &f[2]) == 3) {
            if (m.index_count == index_room) {
                index_room = index_room ? 2 * index_room : 3072;
                m.indices = checked(realloc(m.indices, index_room * sizeof *m.indices));
            }
            for (int k = 0; k < 3; k++)
                m.indices[m.index_count++] = f[k] - 1;
        }
    }
    fclose(file);
    for (size_t i = 0; i < m.index_count; i++) {
        if (m.indices[i] >= m.vertex_count) {
            fprintf(stderr, "simplify: %s: index out of range\n", path);
            exit(4);
        }
    }
    return m;
}

/* Simplification with a target of `target` indices; its result lands near, not on, the target. */
static size_t simplify_to(const mesh *from, unsigned int *out, size_t target)
{
    return meshopt_simplify(out, from->indices, from->index_count, from->positions,
                            from->vertex_count, 3 * sizeof(float), target, 1.0f, 0, NULL);
}

/* Targets around the wanted count are tried in growing distance until one lands on it. */
static void simplify(mesh *m, size_t wanted_triangles)
{
    unsigned int *out = checked(malloc(m->index_count * sizeof *out));
    for (size_t step = 0; step <= 200; step++) {
        size_t distance = (step + 1) / 2;
        size_t target = step % 2 ? wanted_triangles - distance : wanted_triangles + distance;
        if (simplify_to(m, out, 3 * target) != 3 * wanted_triangles)
            continue;
        free(m->indices);
        m->indices = out;
        m->index_count = 3 * wanted_triangles;
        m->vertex_count =
            meshopt_optimizeVertexFetch(m->positions, m->indices, m->index_count, m->positions,
                                        m->vertex_count, 3 * sizeof(float));
        return;
    }
    fprintf(stderr, "simplify: no target gives exactly %zu triangles\n", wanted_triangles);
    exit(1);
}

typedef struct placement {
    float offset[3], scale;
} placement;

static placement find_placement(const mesh *m)
{
    float lo[3], hi[3];
    for (int k = 0; k < 3; k++)
        lo[k] = hi[k] = m->positions[k];
    for (size_t i = 0; i < 3 * m->vertex_count; i++) {
        float x = m->positions[i];
        lo[i % 3] = x < lo[i % 3] ? x : lo[i % 3];
        hi[i % 3] = x > hi[i % 3] ? x : hi[i % 3];
    }
    return (placement){{-(lo[0] + hi[0]) / 2, -lo[1], -(lo[2] + hi[2]) / 2}, 1 / (hi[1] - lo[1])};
}

static void write_obj(const mesh *m, const placement *p, const char *path)
{
    FILE *file = fopen(path, "w");
    if (!file) {
        perror(path);
        exit(4);
    }
    fprintf(file, "# %zu vertices, %zu triangles; p' = %.6f (p + (%.6f, %.6f, %.6f))\n",
            m->vertex_count, m->index_count / 3, (double)p->scale, (double)p->offset[0],
            (double)p->offset[1], (double)p->offset[2]);
    for (size_t i = 0; i < m->vertex_count; i++) {
        fputs("v", file);
        for (int k = 0; k < 3; k++)
            fprintf(file, " %.6f",
                    (double)((m->positions[3 * i + (size_t)k] + p->offset[k]) * p->scale));
        fputs("\n", file);
    }
    for (size_t i = 0; i < m->index_count; i += 3)
        fprintf(file, "f %u %u %u\n", m->indices[i] + 1, m->indices[i + 1] + 1,
                m->indices[i + 2] + 1);
    if (fclose(file) != 0) {
        perror(path);
        exit(4);
    }
}

int main(int argc, char **argv)
{
    if (argc < 3 || argc > 4) {
        fprintf(stderr, "usage: simplify IN.obj OUT.obj [TRIANGLES]\n");
        return 2;
    }
    mesh m = read_obj(argv[1]);
    if (m.index_count == 0) {
        fprintf(stderr, "simplify: %s: no triangles\n", argv[1]);
        return 4;
    }
    /* The placement of the whole mesh, so that every version of it stands in the same place. */
    placement p = find_placement(&m);
    if (argc == 4)
        simplify(&m, strtoul(argv[3], NULL, 10));
    write_obj(&m, &p, argv[2]);
    free(m.positions);
    free(m.indices);
    return 0;
}
