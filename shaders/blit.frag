#version 330 core
// Copies texels. Whole numbers only, so that a picture of the window's own size arrives byte for byte.
uniform sampler2D picture;
uniform ivec4 area;  // x, y, width, height of the drawn rectangle in pixels from the bottom left
out vec4 color;

void main() {
    ivec2 size = textureSize(picture, 0);
    ivec2 texel = (ivec2(gl_FragCoord.xy) - area.xy) * size / area.zw;
    // The picture's first row is its top one.
    color = vec4(texelFetch(picture, ivec2(texel.x, size.y - 1 - texel.y), 0).rgb, 1.0);
}
