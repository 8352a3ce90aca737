// SPDX-License-Identifier: MIT
// Panels and glyphs: rectangles in framebuffer pixels from the top left.
#version 330 core

in vec2 position;
in vec2 texel;
in vec4 tint;
uniform vec2 window;
uniform vec2 atlas_size;
out vec2 uv;
out vec4 ink;

void main()
{
    uv = texel / atlas_size;
    ink = tint;
    gl_Position = vec4(2.0 * position.x / window.x - 1.0, 1.0 - 2.0 * position.y / window.y, 0.0, 1.0);
}
