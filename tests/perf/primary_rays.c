/* SPDX-License-Identifier: MIT
 *
 * Traces the camera rays of a mesh a given number of times: what instructions.sh counts the
 * instructions of.
 * usage: primary_rays MESH SIDE TIMES      prints the number of rays of one time
 */
#include <stdio.h>
#include <stdlib.h>

#include "cli/bench_work.h"

int main(int argc, char **argv)
{
    if (argc != 4)
        return 2;
    fl_diags diags = {0};
    bench_mesh mesh = {0};
    bench_rays rays = {0};
    const fl_compile_options options = {.accel = FL_ACCEL_BVH};
    fl_compiled *scene = NULL;
    bool ok = bench_mesh_load(argv[1], &mesh, &diags) &&
              (scene = bench_mesh_compile(&mesh, &options, NULL, &diags)) != NULL &&
              bench_rays_create(&mesh, scene, BENCH_PRIMARY, (uint32_t)atoi(argv[2]), NULL, &rays);
    for (int k = 0; ok && k < atoi(argv[3]); k++)
        bench_rays_trace(scene, &rays, NULL);
    printf("%u\n", rays.rays.count);
    bench_rays_deinit(&rays);
    fl_compiled_release(scene);
    bench_mesh_deinit(&mesh);
    fl_diags_deinit(&diags);
    return ok ? 0 : 1;
}
