#version 430 core
// Smooth light of texels with the share of what smoothing took that is given back; of probes, which
// are not smoothed, the light itself.
layout(local_size_x = 64) in;

layout(std430, binding = 0) buffer Smooth { vec4 smooth_rows[]; };
layout(std430, binding = 1) readonly buffer Light { vec4 light[]; };
layout(std430, binding = 2) readonly buffer Back { float back[]; };
uniform uint count;
uniform uint texels;

void main() {
    uint row = gl_GlobalInvocationID.x;
    if (row >= count) return;
    vec4 found = light[row];
    if (row < texels) found = smooth_rows[row] + back[row] * found;
    smooth_rows[row] = max(found, vec4(0.0));
}
