/* SPDX-License-Identifier: MIT
 *
 * EGL without any surface of a display: Mesa's surfaceless platform, drawing into a pbuffer.
 */
#include <EGL/egl.h>
#include <dlfcn.h>

#include "viewer/offscreen.h"

#define PLATFORM_SURFACELESS 0x31DD /* EGL_PLATFORM_SURFACELESS_MESA */

typedef struct platform_egl {
    vw_offscreen offscreen;
    void *library;
    EGLDisplay display;
    EGLConfig config;
    EGLContext context;
    EGLSurface surface;
    vw_gl_proc (*get_proc)(const char *name);
    EGLDisplay (*get_platform_display)(EGLenum platform, void *native, const EGLAttrib *attributes);
    EGLBoolean (*initialize)(EGLDisplay display, EGLint *major, EGLint *minor);
    EGLBoolean (*terminate)(EGLDisplay display);
    EGLBoolean (*bind_api)(EGLenum api);
    EGLBoolean (*choose_config)(EGLDisplay display, const EGLint *attributes, EGLConfig *configs,
                                EGLint size, EGLint *count);
    EGLContext (*create_context)(EGLDisplay display, EGLConfig config, EGLContext share,
                                 const EGLint *attributes);
    EGLBoolean (*destroy_context)(EGLDisplay display, EGLContext context);
    EGLSurface (*create_pbuffer)(EGLDisplay display, EGLConfig config, const EGLint *attributes);
    EGLBoolean (*destroy_surface)(EGLDisplay display, EGLSurface surface);
    EGLBoolean (*make_current)(EGLDisplay display, EGLSurface draw, EGLSurface read,
                               EGLContext context);
} platform_egl;

#define FIND(member, name)                                                                         \
    vw_offscreen_find(self->library, name, &self->member, sizeof self->member)

static bool open_library(platform_egl *self)
{
    self->library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    return self->library && FIND(get_proc, "eglGetProcAddress") &&
           FIND(get_platform_display, "eglGetPlatformDisplay") &&
           FIND(initialize, "eglInitialize") && FIND(terminate, "eglTerminate") &&
           FIND(bind_api, "eglBindAPI") && FIND(choose_config, "eglChooseConfig") &&
           FIND(create_context, "eglCreateContext") && FIND(destroy_context, "eglDestroyContext") &&
           FIND(create_pbuffer, "eglCreatePbufferSurface") &&
           FIND(destroy_surface, "eglDestroySurface") && FIND(make_current, "eglMakeCurrent");
}

static bool open_context(vw_platform *platform, fl_diags *diags)
{
    platform_egl *self = (platform_egl *)platform;
    static const EGLint config[] = {EGL_SURFACE_TYPE,
                                    EGL_PBUFFER_BIT,
                                    EGL_RENDERABLE_TYPE,
                                    EGL_OPENGL_BIT,
                                    EGL_RED_SIZE,
                                    8,
                                    EGL_GREEN_SIZE,
                                    8,
                                    EGL_BLUE_SIZE,
                                    8,
                                    EGL_ALPHA_SIZE,
                                    8,
                                    EGL_NONE};
    static const EGLint context[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     3,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     3,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
    EGLint count = 0;
    if (!open_library(self))
        return fl_environment_error(
            diags, "there is no OpenGL without a display here: install libosmesa6 or libegl1");
    self->display = self->get_platform_display(PLATFORM_SURFACELESS, EGL_DEFAULT_DISPLAY, NULL);
    if (self->display == EGL_NO_DISPLAY || !self->initialize(self->display, NULL, NULL)) {
        self->display = EGL_NO_DISPLAY;
        return fl_environment_error(diags, "EGL has no surfaceless platform here");
    }
    if (!self->bind_api(EGL_OPENGL_API) ||
        !self->choose_config(self->display, config, &self->config, 1, &count) || count < 1)
        return fl_environment_error(diags, "EGL has no OpenGL configuration to draw offscreen");
    self->context = self->create_context(self->display, self->config, EGL_NO_CONTEXT, context);
    if (self->context == EGL_NO_CONTEXT)
        return fl_environment_error(diags, "EGL gives no OpenGL 3.3 core context");
    return true;
}

static bool set_size(vw_platform *platform, uint32_t width, uint32_t height, fl_diags *diags)
{
    platform_egl *self = (platform_egl *)platform;
    const EGLint size[] = {EGL_WIDTH, (EGLint)width, EGL_HEIGHT, (EGLint)height, EGL_NONE};
    EGLSurface surface = self->create_pbuffer(self->display, self->config, size);
    if (surface == EGL_NO_SURFACE ||
        !self->make_current(self->display, surface, surface, self->context)) {
        if (surface != EGL_NO_SURFACE)
            self->destroy_surface(self->display, surface);
        return fl_environment_error(diags, "EGL cannot draw %ux%u pixels", width, height);
    }
    if (self->surface != EGL_NO_SURFACE)
        self->destroy_surface(self->display, self->surface);
    self->surface = surface;
    return true;
}

static void close_context(vw_platform *platform)
{
    platform_egl *self = (platform_egl *)platform;
    if (self->display == EGL_NO_DISPLAY)
        return;
    self->make_current(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (self->surface != EGL_NO_SURFACE)
        self->destroy_surface(self->display, self->surface);
    if (self->context != EGL_NO_CONTEXT)
        self->destroy_context(self->display, self->context);
    self->terminate(self->display);
}

static vw_gl_proc get_proc(void *platform, const char *name)
{
    return ((platform_egl *)platform)->get_proc(name);
}

vw_platform *vw_platform_egl_create(const vw_window_desc *desc, fl_diags *diags)
{
    static const vw_offscreen_kind kind = {.bytes = sizeof(platform_egl),
                                           .ops = {.name = "egl", .get_proc = get_proc},
                                           .open = open_context,
                                           .set_size = set_size,
                                           .close = close_context};
    return vw_offscreen_create(&kind, desc, diags);
}
