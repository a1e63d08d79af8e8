#version 430 core
// What smoothing took from texels.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Smooth { vec4 smooth_rows[]; };
layout(std430, binding = 1) buffer Light { vec4 light[]; };
uniform uint count;

void main() {
    uint row = gl_GlobalInvocationID.x;
    if (row < count) light[row] -= smooth_rows[row];
}
