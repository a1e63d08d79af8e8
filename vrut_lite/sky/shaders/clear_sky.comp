#version 430
// A clear sky's cube map as the first part of a sum: each texel is the mean of those that it covers.
// The ground under the layers has its share of the clear sky's.

#include "cube.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform imageCube sky;
layout(CLEAR_FORMAT, binding = 1) readonly uniform imageCube clear_sky;

uniform vec3 ground_share;
uniform float clear_scale;    // the clear sky's over the sum's

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    int size = imageSize(sky).x, many = imageSize(clear_sky).x;
    if (any(greaterThanEqual(at.xy, ivec2(size)))) {
        return;
    }
    int across = max(many / size, 1);
    ivec2 first = at.xy * many / size;
    vec3 total = vec3(0.0);
    for (int i = 0; i < across * across; ++i) {
        total += imageLoad(clear_sky, ivec3(first + ivec2(i % across, i / across), at.z)).rgb;
    }
    vec3 share = texel_direction(at.z, at.xy, size).y > 0.0 ? vec3(1.0) : ground_share;
    imageStore(sky, at, vec4(total / float(across * across) * clear_scale * share, 1.0));
}
