#version 430
// A sky-view table as a cube map in world axes, in half precision: the twin of sky_view_fill.py,
// where the formulas are explained.

#include "cube.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform imageCube sky;
#include "sky_view.glsl"

uniform int faces[6];           // which face each layer of work groups writes
uniform vec3 ground;            // radiance
uniform float inverse_scale;

vec3 radiance(vec3 direction) {
    float height = background_height(direction);
    return background_on_side(direction, height, height >= 0.0 || background_shape.y == 0);
}

// The mean of some samples of a texel that the limb crosses, as seen from above the air.
vec3 sampled(int face, ivec2 at, int size, bool thin) {
    int samples = thin ? 13 : 5, stride = thin ? 5 : 2;
    vec3 total = vec3(0.0);
    for (int k = 0; k < samples; ++k) {
        vec2 offset = vec2(2 * k + 1, 2 * ((stride * k + stride / 2) % samples) + 1) - samples;
        vec2 place = texel_middle(at, size) + offset / float(samples * size);
        total += radiance(face_direction(face, place));
    }
    return total / float(samples);
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    int size = imageSize(sky).x;
    if (any(greaterThanEqual(at, ivec2(size)))) {
        return;
    }
    int face = faces[gl_WorkGroupID.z];
    // By index, not by direction.y: level directions are sky, as on the CPU.
    bool down = face == 3 || (face != 2 && 2 * at.y + 1 > size);
    vec3 rgb = ground;
    if (background_shape.y > 0 || !down) {
        vec3 direction = texel_direction(face, at, size);
        float horizon = background_horizon.x, limb = background_horizon.y - horizon;
        float reach = sqrt(2.0) / float(size);
        reach *= sqrt(horizon * (2.0 - horizon)) + reach;
        float height = background_height(direction);
        bool crossed = -reach < height && height < min(limb, 6.0 * reach) + reach;
        rgb = background_horizon.y <= 1.0 && crossed
            ? sampled(face, at, size, limb < 2.0 * reach) : radiance(direction);
    }
    imageStore(sky, ivec3(at, face), vec4(rounded_to_half(inverse_scale * rgb), 1.0));
}
