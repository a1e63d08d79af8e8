#version 430
// A sky-view table as a cube map in world axes, in half precision: the twin of sky_view_fill.py,
// where the formulas are explained.

#include "cube.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform imageCube sky;
// Two of each node, fourth roots of radiance: that with its phase function, that without.
layout(std430, binding = 1) restrict readonly buffer Nodes { vec4 nodes[]; };

uniform int faces[6];           // which face each layer of work groups writes
uniform int rows_above;
uniform int rows_below;         // none: the ground fills what is below the level
uniform int columns;
uniform vec2 horizon;           // 1 + mu of the ground's horizon and of the air's end
uniform vec3 sun;               // unit vector
uniform vec2 sun_azimuth;       // its level part, a unit vector
uniform vec4 phase;             // factor, form, (1 - g)^2 and 2 g
uniform vec3 ground;            // radiance
uniform float inverse_scale;

float mie_phase_at(float nu) {
    float spread = phase.z + phase.w * (1.0 - nu);
    return phase.x * (1.0 + phase.y * nu * nu) / (spread * sqrt(spread));
}

vec4 blended(int node, vec2 far, int kind) {
    int at = 2 * node + kind;
    int next = at + 2 * columns;
    vec4 near_row = mix(nodes[at], nodes[at + 2], far.x);
    return mix(near_row, mix(nodes[next], nodes[next + 2], far.x), far.y);
}

vec3 fourth_power(vec3 root) {
    vec3 square = root * root;
    return square * square;
}

vec3 radiance(vec3 direction) {
    float level = dot(direction.xz, direction.xz);
    // 1 + mu without cancellation at the nadir, where a far observer has all of the planet.
    float sum = 1.0 + abs(direction.y);
    float height = (direction.y < 0.0 ? level / sum : sum) - horizon.x;
    bool up = height >= 0.0 || rows_below == 0;
    height = up ? max(height, 0.0) / (horizon.y - horizon.x) : -height / horizon.x;
    int rows = up ? rows_above : rows_below;
    float row = min(sqrt(height), 1.0) * float(rows - 1);
    int i = min(int(row), rows - 2);
    // Half the chord between the level directions is the sine of half the azimuth.
    vec2 chord = direction.xz * inversesqrt(max(level, 1e-30)) - sun_azimuth;
    float column = 0.5 * length(chord) * float(columns - 1);
    int k = min(int(column), columns - 2);
    int node = (up ? i : i + rows_above) * columns + k;
    vec2 far = vec2(column - float(k), row - float(i));
    vec3 phased = fourth_power(blended(node, far, 0).rgb);
    vec3 mie = fourth_power(blended(node, far, 1).rgb);
    return phased + mie_phase_at(dot(direction, sun)) * mie;
}

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
    if (rows_below > 0 || !down) {
        rgb = radiance(texel_direction(face, at, size));
    }
    imageStore(sky, ivec3(at, face), vec4(rounded_to_half(inverse_scale * rgb), 1.0));
}
