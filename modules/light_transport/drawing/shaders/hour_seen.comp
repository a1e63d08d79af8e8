#version 430 core
// Radiance of the rows that mirrors see. Twin: `texel_radiance` of hour/mirror_light.py.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Seen { uvec4 seen[]; };
layout(std430, binding = 1) readonly buffer SeenShares { float seen_shares[]; };
layout(std430, binding = 2) readonly buffer Shown { vec4 shown[]; };
layout(std430, binding = 3) readonly buffer Columns { vec4 columns[]; };
layout(std430, binding = 4) writeonly buffer Radiance { vec4 radiance[]; };
uniform uint count;
uniform vec3 ground_albedo;
uniform vec3 key_irradiance;

const float INVERSE_PI = 0.31830988618379067;
const uint OF_GROUND = 1u, OF_PATCH = 2u;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    uvec4 first = seen[3u * i], second = seen[3u * i + 1u];
    vec3 sent;
    if (first.w == OF_PATCH) {
        sent = columns[second.w].rgb;
    } else {
        vec3 falls = uintBitsToFloat(seen[3u * i + 2u].xyz) + seen_shares[i] * key_irradiance;
        if (int(second.w) >= 0) falls += shown[second.w].rgb;
        vec3 reflectance = first.w == OF_GROUND ? ground_albedo : uintBitsToFloat(second.xyz);
        sent = uintBitsToFloat(first.xyz) + reflectance * falls;
    }
    radiance[i] = vec4(sent * INVERSE_PI, 1.0);
}
