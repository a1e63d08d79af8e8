#version 430 core
// The number of each pixel's surface as its depth: depth tests then find a surface's pixels.

layout(binding = 36) uniform usampler2D surface_attributes;

void main() {
    uvec4 read = texelFetch(surface_attributes, ivec2(gl_FragCoord.xy), 0);
    gl_FragDepth = float(read.y & 0xffu) / 256.0;
}
