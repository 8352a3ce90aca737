// SPDX-License-Identifier: MIT
// Coverage from the atlas times a premultiplied colour.
#version 330 core

in vec2 uv;
in vec4 ink;
uniform sampler2D atlas;
out vec4 color;

void main()
{
    color = ink * texture(atlas, uv).r;
}
