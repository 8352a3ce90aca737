/* SPDX-License-Identifier: MIT */
#include "viewer/platform.h"

#include <string.h>

typedef vw_platform *create_fn(const vw_window_desc *desc, fl_diags *diags);

static const struct {
    const char *name;
    create_fn *create;
} platforms[] = {
    {"glfw", vw_platform_glfw_create},
    {"osmesa", vw_platform_osmesa_create},
    {"egl", vw_platform_egl_create},
};

vw_platform *vw_platform_create(const char *name, bool wants_window, const vw_window_desc *desc,
                                fl_diags *diags)
{
    if (!name && wants_window)
        return vw_platform_glfw_create(desc, diags);
    if (!name) {
        fl_diags unused = {0};
        vw_platform *platform = vw_platform_osmesa_create(desc, &unused);
        fl_diags_deinit(&unused);
        return platform ? platform : vw_platform_egl_create(desc, diags);
    }
    const char *names[FL_COUNT_OF(platforms)];
    for (size_t i = 0; i < FL_COUNT_OF(platforms); i++) {
        if (strcmp(platforms[i].name, name) == 0)
            return platforms[i].create(desc, diags);
        names[i] = platforms[i].name;
    }
    const char *near = fl_nearest_name(name, strlen(name), names, FL_COUNT_OF(names));
    if (near)
        fl_environment_error(diags, "unknown platform '%s'; did you mean '%s'?", name, near);
    else
        fl_environment_error(diags, "unknown platform '%s'; expected glfw, osmesa or egl", name);
    return NULL;
}
