#version 430 core
// What texels and probes show: at borders by hour/borders.py, bent as their orientation asks, with
// lamps, and their share of the open sky as alpha.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Smooth { vec4 smooth_rows[]; };
layout(std430, binding = 1) readonly buffer Rows { uvec4 rows[]; };
layout(std430, binding = 2) readonly buffer BorderOf { int border_of[]; };
layout(std430, binding = 3) readonly buffer Borders { uvec2 borders[]; };
//!include hour_bends.glsl
#ifdef LAMPS
layout(std430, binding = 5) readonly buffer Lamps { vec4 lamps[]; };
#endif
layout(std430, binding = 6) writeonly buffer Shown { vec4 shown[]; };
uniform uint count;

const float LEAST_OWN = 0.6;    // as in hour/borders.py
const float MOST_CHANGE = 2.0;

vec4 at_border(uint row, vec4 mean, int number) {
    vec4 found = vec4(0.0);
    float own = 0.0;
    for (uint n = 0u; n < 9u; ++n) {
        uvec2 near = borders[9u * uint(number) + n];
        float weight = uintBitsToFloat(near.y);
        found += weight * smooth_rows[near.x];
        own += near.x == row ? weight : 0.0;
    }
    vec4 sharp = mean + (mean - found) / max(own, LEAST_OWN);
    return min(max(sharp, mean / MOST_CHANGE), mean * MOST_CHANGE);
}

void main() {
    uint row = gl_GlobalInvocationID.x;
    if (row >= count) return;
    uint orientation = rows[row].w;
    vec4 light = smooth_rows[row];
    if (row < texels) {
        if (border_of[row] >= 0) light = at_border(row, light, border_of[row]);
        light *= bends(orientation);
    }
#ifdef LAMPS
    light.rgb += lamps[row].rgb;
#endif
    light.a = clamp(light.a / open_sky_of[orientation], 0.0, 1.0);
    shown[row] = light;
}
