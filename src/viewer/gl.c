/* SPDX-License-Identifier: MIT */
#include "viewer/gl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/files.h"
#include "viewer/embed.h"

enum { SHADER_MAX_BYTES = 1 << 20, LOG_BYTES = 512 };

bool vw_gl_load(vw_gl *gl, vw_gl_proc (*get_proc)(void *context, const char *name), void *context,
                fl_diags *diags)
{
    vw_gl_proc proc;
    /* memcpy: ISO C has no cast between pointers to functions of unknown type that every compiler
     * accepts silently. */
#define LOAD(type, name)                                                                           \
    proc = get_proc(context, "gl" #name);                                                          \
    if (!proc)                                                                                     \
        return fl_environment_error(diags, "this OpenGL has no gl" #name);                         \
    memcpy(&gl->name, &proc, sizeof proc);
    VW_GL_FUNCTIONS(LOAD)
#undef LOAD
    GLint major = 0, minor = 0;
    gl->GetIntegerv(GL_MAJOR_VERSION, &major);
    gl->GetIntegerv(GL_MINOR_VERSION, &minor);
    if (major < 3 || (major == 3 && minor < 3))
        return fl_environment_error(diags, "OpenGL 3.3 is needed, this is %d.%d", major, minor);
    return true;
}

static GLuint compile(const vw_gl *gl, GLenum kind, const char *shader_dir, const char *name,
                      fl_diags *diags)
{
    const vw_embedded *built_in = vw_embedded_find(name);
    FL_ASSERT(built_in);
    const char *text = (const char *)built_in->begin;
    size_t bytes = (size_t)(built_in->end - built_in->begin);
    char path[1024];
    char *loaded = NULL;
    snprintf(path, sizeof path, "%s", name);
    if (shader_dir) {
        if ((size_t)snprintf(path, sizeof path, "%s/%s", shader_dir, name) >= sizeof path) {
            fl_error(diags, (fl_loc){0}, "the shader folder's name is too long");
            return 0;
        }
        text = loaded =
            fl_file_load(path, "shader", SHADER_MAX_BYTES, (fl_loc){.file = path}, diags, &bytes);
        if (!loaded)
            return 0;
    }
    GLuint shader = gl->CreateShader(kind);
    GLint length = (GLint)bytes, is_compiled = 0;
    gl->ShaderSource(shader, 1, &text, &length);
    gl->CompileShader(shader);
    free(loaded);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
    if (is_compiled)
        return shader;
    char log[LOG_BYTES] = "";
    gl->GetShaderInfoLog(shader, LOG_BYTES, NULL, log);
    gl->DeleteShader(shader);
    fl_error(diags, (fl_loc){.file = path}, "the shader does not compile: %s", log);
    return 0;
}

GLuint vw_gl_program(const vw_gl *gl, const char *shader_dir, const char *name,
                     const char *const *attributes, uint32_t attribute_count, fl_diags *diags)
{
    char file[64];
    snprintf(file, sizeof file, "%s.vert", name);
    GLuint vertex = compile(gl, GL_VERTEX_SHADER, shader_dir, file, diags);
    if (!vertex)
        return 0;
    snprintf(file, sizeof file, "%s.frag", name);
    GLuint fragment = compile(gl, GL_FRAGMENT_SHADER, shader_dir, file, diags);
    if (!fragment) {
        gl->DeleteShader(vertex);
        return 0;
    }
    GLuint program = gl->CreateProgram();
    gl->AttachShader(program, vertex);
    gl->AttachShader(program, fragment);
    for (uint32_t i = 0; i < attribute_count; i++)
        gl->BindAttribLocation(program, i, attributes[i]);
    gl->LinkProgram(program);
    gl->DeleteShader(vertex);
    gl->DeleteShader(fragment);
    GLint is_linked = 0;
    gl->GetProgramiv(program, GL_LINK_STATUS, &is_linked);
    if (is_linked)
        return program;
    char log[LOG_BYTES] = "";
    gl->GetProgramInfoLog(program, LOG_BYTES, NULL, log);
    gl->DeleteProgram(program);
    fl_error(diags, (fl_loc){.file = name}, "the shaders do not link: %s", log);
    return 0;
}
