/* SPDX-License-Identifier: MIT
 *
 * usage: revolve_solve [newton] [CASES]
 * One line a ray of the corpus (standard input if none is named): M, or H u segment t, for grading
 * by any program that reads the format.
 */
#include <string.h>

#include "corpus_read.h"

static bool solve_all(const corpus *c, fl_revolve_solver solver)
{
    fl_arena arena = {0};
    fl_diags diags = {0};
    fl_revolve *revolve = NULL;
    uint32_t built = FL_NONE;
    for (size_t i = 0; i < c->ray_count; i++) {
        const corpus_ray *r = &c->rays[i];
        if (r->profile != built) {
            fl_arena_deinit(&arena);
            revolve = fl_revolve_build(&arena, &c->profiles[r->profile], &diags);
            built = r->profile;
        }
        if (!revolve) {
            fprintf(stderr, "%s\n", diags.items[0].message);
            break;
        }
        fl_revolve_hit hit;
        if (fl_revolve_nearest(revolve, r->o, r->d, 0.0, HUGE_VAL, solver, &hit))
            printf("H %a %u %a\n", hit.u, hit.segment, hit.t);
        else
            puts("M");
    }
    bool ok = diags.error_count == 0;
    fl_diags_deinit(&diags);
    fl_arena_deinit(&arena);
    return ok;
}

int main(int argc, char **argv)
{
    fl_revolve_solver solver = FL_REVOLVE_ROBUST;
    int at = 1;
    if (at < argc && strcmp(argv[at], "newton") == 0) {
        solver = FL_REVOLVE_NEWTON;
        at++;
    }
    FILE *file = at < argc ? fopen(argv[at], "r") : stdin;
    corpus c;
    if (!file || !corpus_load(&c, file)) {
        fprintf(stderr, "revolve_solve: cannot read %s\n", at < argc ? argv[at] : "standard input");
        return 2;
    }
    bool ok = solve_all(&c, solver);
    corpus_deinit(&c);
    if (file != stdin)
        fclose(file);
    return ok ? 0 : 1;
}
