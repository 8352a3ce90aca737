/* SPDX-License-Identifier: MIT */
#include "corpus_read.h"

#include <stdlib.h>
#include <string.h>

/* Make room for one more item. */
static bool grow(void **items, size_t count, size_t item_bytes)
{
    if (count != 0 && (count & (count - 1)) != 0)
        return true;
    void *more = realloc(*items, (count ? 2 * count : 1) * item_bytes);
    if (more)
        *items = more;
    return more != NULL;
}

static bool read_profile(corpus *c, FILE *file)
{
    uint32_t id, segments, degree;
    char family[32];
    if (fscanf(file, "%u %u %u %31s", &id, &segments, &degree, family) != 4 || degree > 64 ||
        segments > 100000)
        return false;
    if (!grow((void **)&c->profiles, c->profile_count, sizeof *c->profiles) ||
        !grow((void **)&c->families, c->profile_count, sizeof *c->families))
        return false;
    fl_profile *p = &c->profiles[c->profile_count];
    size_t count = (size_t)segments * (degree + 1);
    *p = (fl_profile){.points = fl_arena_alloc(&c->arena, count, sizeof *p->points),
                      .segment_count = segments,
                      .degree = degree,
                      .loc = {.file = "corpus", .line = id}};
    if (!p->points)
        return false;
    for (size_t i = 0; i < count; i++)
        if (fscanf(file, "%lf %lf", &p->points[i].x, &p->points[i].y) != 2)
            return false;
    memcpy(c->families[c->profile_count++], family, sizeof family);
    return true;
}

static bool read_ray(corpus *c, FILE *file)
{
    if (!grow((void **)&c->rays, c->ray_count, sizeof *c->rays))
        return false;
    corpus_ray *r = &c->rays[c->ray_count];
    uint32_t id;
    if (fscanf(file, "%ld %u %31s %lf %lf %lf %lf %lf %lf", &r->id, &id, r->category, &r->o[0],
               &r->o[1], &r->o[2], &r->d[0], &r->d[1], &r->d[2]) != 9)
        return false;
    /* Ids are given in ascending order, and a ray mostly uses the newest profile. */
    for (uint32_t i = c->profile_count; i-- > 0;) {
        if (c->profiles[i].loc.line == id) {
            r->profile = i;
            c->ray_count++;
            return true;
        }
    }
    return false;
}

bool corpus_load(corpus *out, FILE *file)
{
    char tag[8];
    *out = (corpus){0};
    while (fscanf(file, "%7s", tag) == 1) {
        bool ok = true;
        if (tag[0] == '#')
            for (int c = getc(file); c != EOF && c != '\n'; c = getc(file))
                ;
        else if (strcmp(tag, "P") == 0)
            ok = read_profile(out, file);
        else
            ok = strcmp(tag, "R") == 0 && read_ray(out, file);
        if (!ok) {
            fprintf(stderr, "not a corpus, after %u profiles and %zu rays\n", out->profile_count,
                    out->ray_count);
            corpus_deinit(out);
            return false;
        }
    }
    return true;
}

void corpus_deinit(corpus *c)
{
    fl_arena_deinit(&c->arena);
    free(c->profiles);
    free(c->families);
    free(c->rays);
    *c = (corpus){0};
}
