#version 430 core
// The texture of the probes: six faces one behind the other, each with all slices.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(rgba32f, binding = 0) writeonly uniform image3D light_probes;
layout(std430, binding = 0) readonly buffer LinkStart { uint link_start[]; };
layout(std430, binding = 1) readonly buffer LinkEntry { uvec2 link_entry[]; };
layout(std430, binding = 2) readonly buffer Shown { vec4 shown[]; };
uniform uint texels;

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID), size = imageSize(light_probes);
    if (any(greaterThanEqual(at, size))) return;
    int slices = size.z / 6, face = at.z / slices;
    int probe = ((at.z % slices) * size.y + at.y) * size.x + at.x;
    vec4 sum = vec4(0.0);
    for (uint e = link_start[probe]; e < link_start[probe + 1]; ++e) {
        uvec2 entry = link_entry[e];
        sum += uintBitsToFloat(entry.y) * shown[texels + 6u * entry.x + uint(face)];
    }
    imageStore(light_probes, at, sum);
}
