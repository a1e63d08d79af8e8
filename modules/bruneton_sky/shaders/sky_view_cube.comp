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

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    int size = imageSize(sky).x;
    if (any(greaterThanEqual(at, ivec2(size)))) {
        return;
    }
    int face = faces[gl_WorkGroupID.z];
    // By index, not by direction.y: what is level is sky, as on the CPU.
    bool down = face == 3 || (face != 2 && 2 * at.y + 1 > size);
    vec3 rgb = ground;
    if (background_shape.y > 0 || !down) {
        vec3 direction = texel_direction(face, at, size);
        float height = background_height(direction);
        rgb = background_on_side(direction, height, height >= 0.0 || background_shape.y == 0);
    }
    imageStore(sky, ivec3(at, face), vec4(rounded_to_half(inverse_scale * rgb), 1.0));
}
