#version 430 core
// The means of a cube map's coarse cells, to measure its change.

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) writeonly buffer Summary { vec4 cells[]; };
uniform samplerCube sky;

//!include cube_texel.glsl

void main() {
    int size = int(gl_WorkGroupSize.x);
    ivec3 at = ivec3(gl_GlobalInvocationID);
    float level = max(0.0, log2(float(textureSize(sky, 0).x) / float(size)));
    cells[(at.z * size + at.y) * size + at.x] =
        textureLod(sky, texel_direction(at, size), level);
}
