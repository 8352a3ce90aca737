/* SPDX-License-Identifier: MIT
 *
 * Mesa's renderer into plain memory. The library is found at run time: Mesa 25.1 and later come
 * without it.
 */
#include <dlfcn.h>
#include <stdlib.h>

#include "viewer/offscreen.h"

/* The few names of GL/osmesa.h that are used; that header pulls in another GL header. */
typedef struct osmesa_context *osmesa_handle;
enum {
    OSMESA_FORMAT = 0x22,
    OSMESA_DEPTH_BITS = 0x30,
    OSMESA_PROFILE = 0x33,
    OSMESA_CORE_PROFILE = 0x34,
    OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
    OSMESA_CONTEXT_MINOR_VERSION = 0x37
};

typedef struct platform_osmesa {
    vw_offscreen offscreen;
    void *library;
    osmesa_handle context;
    uint8_t *buffer;
    osmesa_handle (*create)(const int *attributes, osmesa_handle share);
    void (*destroy)(osmesa_handle context);
    GLboolean (*make_current)(osmesa_handle context, void *buffer, GLenum type, GLsizei width,
                              GLsizei height);
    vw_gl_proc (*get_proc)(const char *name);
} platform_osmesa;

static bool open_library(platform_osmesa *self)
{
    static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
    for (size_t i = 0; i < FL_COUNT_OF(names) && !self->library; i++)
        self->library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
    return self->library &&
           vw_offscreen_find(self->library, "OSMesaCreateContextAttribs", &self->create,
                             sizeof self->create) &&
           vw_offscreen_find(self->library, "OSMesaDestroyContext", &self->destroy,
                             sizeof self->destroy) &&
           vw_offscreen_find(self->library, "OSMesaMakeCurrent", &self->make_current,
                             sizeof self->make_current) &&
           vw_offscreen_find(self->library, "OSMesaGetProcAddress", &self->get_proc,
                             sizeof self->get_proc);
}

static bool open_context(vw_platform *platform, fl_diags *diags)
{
    static const int attributes[] = {OSMESA_FORMAT,
                                     GL_RGBA,
                                     OSMESA_DEPTH_BITS,
                                     0,
                                     OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     3,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     3,
                                     0};
    platform_osmesa *self = (platform_osmesa *)platform;
    if (!open_library(self))
        return fl_environment_error(
            diags, "libOSMesa is not here (package libosmesa6); try --platform egl");
    self->context = self->create(attributes, NULL);
    return self->context || fl_environment_error(diags, "OSMesa gives no OpenGL 3.3 core context");
}

static bool set_size(vw_platform *platform, uint32_t width, uint32_t height, fl_diags *diags)
{
    platform_osmesa *self = (platform_osmesa *)platform;
    size_t bytes;
    if (!fl_size_mul(width, height, &bytes) || !fl_size_mul(bytes, 4, &bytes))
        return fl_out_of_memory(diags, "the offscreen window");
    uint8_t *buffer = calloc(1, bytes);
    if (!buffer)
        return fl_out_of_memory(diags, "the offscreen window");
    if (!self->make_current(self->context, buffer, GL_UNSIGNED_BYTE, (GLsizei)width,
                            (GLsizei)height)) {
        free(buffer);
        return fl_environment_error(diags, "OSMesa cannot draw %ux%u pixels", width, height);
    }
    free(self->buffer);
    self->buffer = buffer;
    return true;
}

static void close_context(vw_platform *platform)
{
    platform_osmesa *self = (platform_osmesa *)platform;
    if (self->context) {
        self->make_current(NULL, NULL, 0, 0, 0);
        self->destroy(self->context);
    }
    /* The library stays loaded: Mesa's threads and handlers do not survive an unload. */
    free(self->buffer);
}

static vw_gl_proc get_proc(void *platform, const char *name)
{
    return ((platform_osmesa *)platform)->get_proc(name);
}

vw_platform *vw_platform_osmesa_create(const vw_window_desc *desc, fl_diags *diags)
{
    static const vw_offscreen_kind kind = {.bytes = sizeof(platform_osmesa),
                                           .ops = {.name = "osmesa", .get_proc = get_proc},
                                           .open = open_context,
                                           .set_size = set_size,
                                           .close = close_context};
    return vw_offscreen_create(&kind, desc, diags);
}
