/* SPDX-License-Identifier: MIT */
#include "viewer/blit.h"

#include <stdlib.h>

struct vw_blit {
    const vw_gl *gl;
    GLuint program, texture, vertices, array;
    GLint place, window;
    uint32_t width, height;
};

vw_blit *vw_blit_create(const vw_gl *gl, const char *shader_dir, fl_diags *diags)
{
    static const char *const attributes[] = {"corner"};
    static const float corners[] = {0, 0, 1, 0, 0, 1, 1, 1};
    vw_blit *blit = calloc(1, sizeof *blit);
    if (!blit) {
        fl_out_of_memory(diags, "the window");
        return NULL;
    }
    blit->gl = gl;
    blit->program = vw_gl_program(gl, shader_dir, "blit", attributes, 1, diags);
    if (!blit->program) {
        free(blit);
        return NULL;
    }
    blit->place = gl->GetUniformLocation(blit->program, "place");
    blit->window = gl->GetUniformLocation(blit->program, "window");
    gl->GenVertexArrays(1, &blit->array);
    gl->BindVertexArray(blit->array);
    gl->GenBuffers(1, &blit->vertices);
    gl->BindBuffer(GL_ARRAY_BUFFER, blit->vertices);
    gl->BufferData(GL_ARRAY_BUFFER, sizeof corners, corners, GL_STATIC_DRAW);
    gl->VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
    gl->EnableVertexAttribArray(0);
    gl->GenTextures(1, &blit->texture);
    gl->BindTexture(GL_TEXTURE_2D, blit->texture);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return blit;
}

void vw_blit_destroy(vw_blit *blit)
{
    if (!blit)
        return;
    const vw_gl *gl = blit->gl;
    gl->DeleteTextures(1, &blit->texture);
    gl->DeleteBuffers(1, &blit->vertices);
    gl->DeleteVertexArrays(1, &blit->array);
    gl->DeleteProgram(blit->program);
    free(blit);
}

void vw_blit_upload(vw_blit *blit, const uint8_t *rgba, uint32_t width, uint32_t height)
{
    const vw_gl *gl = blit->gl;
    gl->BindTexture(GL_TEXTURE_2D, blit->texture);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    if (width != blit->width || height != blit->height) {
        gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)width, (GLsizei)height, 0, GL_RGBA,
                       GL_UNSIGNED_BYTE, rgba);
        blit->width = width;
        blit->height = height;
        return;
    }
    gl->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA,
                      GL_UNSIGNED_BYTE, rgba);
}

void vw_blit_draw(vw_blit *blit, uint32_t window_width, uint32_t window_height, double x, double y,
                  double width, double height)
{
    if (blit->width == 0)
        return;
    const vw_gl *gl = blit->gl;
    double scale = width / (double)blit->width;
    GLint filter = scale == floor(scale) && scale >= 1.0 && height == scale * (double)blit->height
                       ? GL_NEAREST
                       : GL_LINEAR;
    gl->Disable(GL_BLEND);
    gl->UseProgram(blit->program);
    gl->Uniform4f(blit->place, (float)x, (float)y, (float)width, (float)height);
    gl->Uniform2f(blit->window, (float)window_width, (float)window_height);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_2D, blit->texture);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    gl->BindVertexArray(blit->array);
    gl->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}
