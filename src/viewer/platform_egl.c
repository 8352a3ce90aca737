/* SPDX-License-Identifier: MIT
 *
 * EGL without any surface of a display: Mesa's surfaceless platform, drawing into a pbuffer.
 */
#include <EGL/egl.h>
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

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

static bool find(void *library, const char *name, void *out_function, size_t bytes)
{
    void *symbol = dlsym(library, name);
    memcpy(out_function, &symbol, bytes);
    return symbol != NULL;
}

#define FIND(member, name) find(self->library, name, &self->member, sizeof self->member)

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

static bool open_context(platform_egl *self, fl_diags *diags)
{
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

static bool set_size(platform_egl *self, uint32_t width, uint32_t height, fl_diags *diags)
{
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
    self->offscreen.width = width;
    self->offscreen.height = height;
    return true;
}

static bool resize(vw_platform *platform, uint32_t width, uint32_t height, fl_diags *diags)
{
    return set_size((platform_egl *)platform, width, height, diags);
}

static void destroy(vw_platform *platform)
{
    platform_egl *self = (platform_egl *)platform;
    if (self->display != EGL_NO_DISPLAY) {
        self->make_current(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (self->surface != EGL_NO_SURFACE)
            self->destroy_surface(self->display, self->surface);
        if (self->context != EGL_NO_CONTEXT)
            self->destroy_context(self->display, self->context);
        self->terminate(self->display);
    }
    vw_offscreen_deinit(&self->offscreen);
    free(self);
}

static void swap(vw_platform *platform)
{
    (void)platform;
}

static vw_gl_proc get_proc(void *platform, const char *name)
{
    return ((platform_egl *)platform)->get_proc(name);
}

static const vw_platform_ops ops = {
    .name = "egl",
    .destroy = destroy,
    .pump = vw_offscreen_pump,
    .wake = vw_offscreen_wake,
    .swap = swap,
    .framebuffer_size = vw_offscreen_framebuffer_size,
    .content_scale = vw_offscreen_content_scale,
    .get_proc = get_proc,
    .clipboard = vw_offscreen_clipboard,
    .set_clipboard = vw_offscreen_set_clipboard,
    .set_title = vw_offscreen_set_title,
    .key_label = vw_offscreen_key_label,
    .resize = resize,
};

vw_platform *vw_platform_egl_create(const vw_window_desc *desc, fl_diags *diags)
{
    platform_egl *self = calloc(1, sizeof *self);
    if (!self || !vw_offscreen_init(&self->offscreen, &ops, desc)) {
        free(self);
        fl_out_of_memory(diags, "the offscreen window");
        return NULL;
    }
    bool is_open = open_library(self);
    if (!is_open)
        fl_environment_error(
            diags, "there is no OpenGL without a display here: install libosmesa6 or libegl1");
    if (!is_open || !open_context(self, diags) ||
        !set_size(self, desc->width, desc->height, diags)) {
        destroy(&self->offscreen.base);
        return NULL;
    }
    return &self->offscreen.base;
}
