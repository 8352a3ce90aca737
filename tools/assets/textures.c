/* SPDX-License-Identifier: MIT
 *
 * textures floor|wall|porcelain OUT.png
 * textures ppm IN.ppm OUT.png
 */
#include <stdio.h>
#include <string.h>

#include "picture.h"

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        picture (*make)(void);
    } textures[] = {{"floor", make_floor}, {"wall", make_wall}, {"porcelain", make_porcelain}};

    if (argc == 4 && strcmp(argv[1], "ppm") == 0) {
        picture p = picture_load_ppm(argv[2]);
        picture_save(&p, argv[3]);
        return 0;
    }
    for (size_t i = 0; argc == 3 && i < sizeof textures / sizeof textures[0]; i++) {
        if (strcmp(argv[1], textures[i].name) != 0)
            continue;
        picture p = textures[i].make();
        picture_save(&p, argv[2]);
        return 0;
    }
    fprintf(stderr,
            "usage: textures floor|wall|porcelain OUT.png\n       textures ppm IN.ppm OUT.png\n");
    return 2;
}
