#version 430
// The map of a glow added to a cube map, and the ground in its light: the twin of night_glow.py.

#include "cube.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform imageCube sky;

// Radiance (rows, columns, 3) of the upper hemisphere: elevation, azimuth from -Z.
layout(std430, binding = 1) restrict readonly buffer Glow { float glow[]; };

uniform ivec2 glow_shape;     // rows, columns
uniform vec3 glow_ground;     // radiance below the horizon
uniform float sine_horizon;   // of the horizon's elevation
uniform float glow_share;     // over the scale

const float PI = 3.14159265358979;

vec3 node(int row, int column) {
    int at = 3 * (row * glow_shape.y + column);
    return vec3(glow[at], glow[at + 1], glow[at + 2]);
}

vec3 glow_towards(vec3 direction) {
    float elevation = atan(direction.y, length(direction.xz));
    float turn = atan(direction.x, -direction.z) / (2.0 * PI);
    float row = clamp(elevation * (2.0 * float(glow_shape.x) / PI) - 0.5,
                      0.0, float(glow_shape.x - 1));
    float column = fract(turn) * float(glow_shape.y) - 0.5;
    int r = min(int(row), glow_shape.x - 2), c = int(floor(column));
    int near = (c + glow_shape.y) % glow_shape.y, far = (c + 1) % glow_shape.y;
    float across = column - float(c);
    return mix(mix(node(r, near), node(r, far), across),
               mix(node(r + 1, near), node(r + 1, far), across), row - float(r));
}

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    int size = imageSize(sky).x;
    if (any(greaterThanEqual(at.xy, ivec2(size)))) {
        return;
    }
    vec3 direction = texel_direction(at.z, at.xy, size);
    vec3 added = direction.y > sine_horizon ? glow_towards(direction) : glow_ground;
    vec4 before = imageLoad(sky, at);
    imageStore(sky, at, vec4(before.rgb + glow_share * added, before.a));
}
