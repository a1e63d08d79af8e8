#version 430 core
// A sweep of Chebyshev's semi-iteration over what patches send: `sweep_weights` of
// hour/card_tables.py. `before` holds the sweep before the last, and takes the new one.
layout(local_size_x = 64) in;

//!include hour_links.glsl
//!include hour_patches.glsl
layout(std430, binding = 4) readonly buffer Source { vec4 source[]; };
layout(std430, binding = 5) buffer Before { vec4 before[]; };
uniform uint count;
uniform uint nodes;
uniform float weight;
uniform int is_last;

void main() {
    uint p = gl_GlobalInvocationID.x;
    if (p >= count) return;
    vec3 old = before[nodes + p].rgb;
    vec3 once = source[p].rgb + reflectance_of(p) * linked(p).rgb;
    vec3 sent = weight * (once - old) + old;
    if (is_last != 0) sent = max(sent, vec3(0.0));
    before[nodes + p] = vec4(sent, 0.0);
}
