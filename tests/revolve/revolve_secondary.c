/* SPDX-License-Identifier: MIT
 *
 * usage: revolve_secondary CASES DISTANCE double|float [RAYS]
 * Writes a corpus of rays that leave the surfaces of CASES: for every profile, primary rays from
 * DISTANCE times its size; where they hit, the point is resolved, stored in the given type and
 * moved 16 e S along the normal (e the type's unit roundoff), and a ray leaves it in a random
 * direction at 0.05 or more from the tangent plane. Category `again`: a hit there that the oracle
 * does not find is a false self-hit, one that it alone finds a lost true one.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "corpus_read.h"

static uint32_t seed = 7;

static double draw(double lo, double hi)
{
    seed = fl_lowbias32(seed + 0x9E3779B9u);
    return lo + (hi - lo) * (seed >> 8) * 0x1p-24;
}

static fl_vec3 draw_direction(void)
{
    for (;;) {
        fl_vec3 v = fl_v3(draw(-1, 1), draw(-1, 1), draw(-1, 1));
        double length = fl_v3_length(v);
        if (length > 0.1 && length < 1.0)
            return fl_v3_scale(v, 1.0 / length);
    }
}

/* One ray that leaves the point seen by a primary ray. False: the primary ray missed. */
static bool leave(const fl_revolve *revolve, double distance, bool is_float, fl_vec3 *out_o,
                  fl_vec3 *out_d)
{
    fl_box box = fl_revolve_bounds(revolve);
    fl_vec3 away = draw_direction(),
            target = fl_v3(draw(box.lo.x, box.hi.x), draw(box.lo.y, box.hi.y), 0.0);
    double size = fl_max(box.hi.x, box.hi.y - box.lo.y);
    fl_vec3 from = fl_v3_mad(target, away, distance * size), to = fl_v3_scale(away, -1.0);
    double o[3] = {from.x, from.y, from.z}, d[3] = {to.x, to.y, to.z};
    fl_revolve_hit hit;
    fl_revolve_point p;
    if (!fl_revolve_nearest(revolve, o, d, 0.0, HUGE_VAL, FL_REVOLVE_ROBUST, &hit))
        return false;
    fl_revolve_resolve(revolve, o, d, &hit, &p);
    fl_vec3 out = draw_direction();
    double cosine = fl_v3_dot(out, p.normal);
    if (fabs(cosine) < 0.05)
        return false;
    double step = copysign(16.0 * (is_float ? 0x1p-24 : 0x1p-53) * p.scale, cosine);
    *out_o = fl_v3_mad(p.position, p.normal, step);
    *out_d = out;
    if (is_float) {
        *out_o = fl_v3((double)(float)out_o->x, (double)(float)out_o->y, (double)(float)out_o->z);
        *out_d = fl_v3((double)(float)out.x, (double)(float)out.y, (double)(float)out.z);
    }
    return true;
}

static bool write_profile(const corpus *c, uint32_t at, double distance, bool is_float, long rays,
                          long *next_id)
{
    const fl_profile *p = &c->profiles[at];
    fl_arena arena = {0};
    fl_diags diags = {0};
    fl_revolve *revolve = fl_revolve_build(&arena, p, &diags);
    if (revolve) {
        printf("P %u %u %u %s\n", p->loc.line, p->segment_count, p->degree, c->families[at]);
        for (size_t i = 0; i < (size_t)p->segment_count * (p->degree + 1); i++)
            printf("%a %a\n", p->points[i].x, p->points[i].y);
        for (long tries = 0, made = 0; made < rays && tries < 20 * rays; tries++) {
            fl_vec3 o, d;
            if (!leave(revolve, distance, is_float, &o, &d))
                continue;
            made++;
            printf("R %ld %u again %a %a %a %a %a %a\n", (*next_id)++, p->loc.line, o.x, o.y, o.z,
                   d.x, d.y, d.z);
        }
    }
    fl_diags_deinit(&diags);
    fl_arena_deinit(&arena);
    return revolve != NULL;
}

int main(int argc, char **argv)
{
    FILE *file = argc > 3 ? fopen(argv[1], "r") : NULL;
    corpus c;
    if (!file || !corpus_load(&c, file)) {
        fprintf(stderr, "usage: revolve_secondary CASES DISTANCE double|float [RAYS]\n");
        return 2;
    }
    fclose(file);
    double distance = strtod(argv[2], NULL);
    bool is_float = strcmp(argv[3], "float") == 0, ok = true;
    long rays = argc > 4 ? strtol(argv[4], NULL, 10) : 100, id = 0;
    for (uint32_t i = 0; ok && i < c.profile_count; i++)
        ok = write_profile(&c, i, distance, is_float, rays, &id);
    corpus_deinit(&c);
    return ok ? 0 : 1;
}
