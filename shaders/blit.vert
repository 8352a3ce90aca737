// SPDX-License-Identifier: MIT
// The picture as one quad. `corner` runs over the unit square from the top left; `place` is where the picture stands in
// the window (left, top, width, height in framebuffer pixels), `window` the window's size.
#version 330 core

in vec2 corner;
uniform vec4 place;
uniform vec2 window;
out vec2 uv;

void main()
{
    vec2 pixel = place.xy + corner * place.zw;
    uv = corner;
    gl_Position = vec4(2.0 * pixel.x / window.x - 1.0, 1.0 - 2.0 * pixel.y / window.y, 0.0, 1.0);
}
