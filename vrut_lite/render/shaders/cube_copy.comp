#version 430 core
// A cube map averaged down to the size of another.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform imageCube copy;
uniform samplerCube sky;

//!include cube_texel.glsl

void main() {
    int size = imageSize(copy).x;
    ivec3 at = ivec3(gl_GlobalInvocationID);
    if (at.x >= size || at.y >= size) return;
    float level = log2(float(textureSize(sky, 0).x) / float(size));
    imageStore(copy, at, textureLod(sky, texel_direction(at, size), level));
}
