/* SPDX-License-Identifier: MIT */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "cli/bench_run.h"

const bench_peer *bench_peer_load(const char *name, const char **out_config, fl_diags *diags)
{
    int name_length = (int)strcspn(name, ":");
    *out_config = name[name_length] ? name + name_length + 1 : "";
    char program[1024], file[128], path[sizeof program + sizeof file];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = 0;
    char *slash = strrchr(program, '/');
    if (slash)
        slash[1] = 0;
    snprintf(file, sizeof file, "firstlight-%.*s.so", name_length, name);
    snprintf(path, sizeof path, "%s%s", program, file);
    void *module = slash ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
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
