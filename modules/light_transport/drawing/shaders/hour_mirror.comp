#version 430 core
// A glossy part's cube: means over the rays of its texels, weighed by the share that met a surface.
layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f, binding = 0) writeonly uniform imageCube cube;
layout(std430, binding = 0) readonly buffer Targets { int targets[]; };
layout(std430, binding = 1) readonly buffer Radiance { vec4 radiance[]; };
uniform uint number;
uniform uint rays;

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    int edge = imageSize(cube).x;
    if (max(at.x, at.y) >= edge) return;
    uint texel = ((number * 6u + uint(at.z)) * uint(edge) + uint(at.y)) * uint(edge) + uint(at.x);
    vec4 sum = vec4(0.0);
    for (uint k = 0u; k < rays; ++k) {
        int target = targets[texel * rays + k];
        if (target >= 0) sum += radiance[target];
    }
    imageStore(cube, at, sum / float(rays));
}
