/* SPDX-License-Identifier: MIT */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#include "cli/bench_run.h"
#include "io/module.h"

const bench_peer *bench_peer_load(const char *name, const char **out_config, fl_diags *diags)
{
    int name_length = (int)strcspn(name, ":");
    *out_config = name[name_length] ? name + name_length + 1 : "";
    char file[128], path[FL_MODULE_PATH_BYTES];
    snprintf(file, sizeof file, "firstlight-%.*s.so", name_length, name);
    static const char *const beside[] = {""};
    bool is_there = fl_program_find(beside, FL_COUNT_OF(beside), file, path);
    void *module = is_there ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!module)
        module = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    const bench_peer *peer = module ? dlsym(module, "bench_peer_module") : NULL;
    if (!peer)
        fl_environment_error(
            diags,
            "no module '%s' for --against: it is built where its library is installed "
            "(embree: libembree-dev)",
            file);
    return peer;
}
