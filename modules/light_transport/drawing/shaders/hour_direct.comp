#version 430 core
// What patches send of their direct light: of the sky by the mean of their rows, of the key light,
// of lamps, and their own. It begins the bounces, in both buffers of columns.
layout(local_size_x = 64) in;

//!include hour_links.glsl
//!include hour_patches.glsl
layout(std430, binding = 4) readonly buffer KeyMeans { float key_means[]; };
layout(std430, binding = 5) writeonly buffer Source { vec4 source[]; };
layout(std430, binding = 6) writeonly buffer Columns { vec4 columns[]; };
layout(std430, binding = 7) writeonly buffer OtherColumns { vec4 other_columns[]; };
uniform uint count;
uniform uint nodes;
uniform vec3 key_irradiance;

void main() {
    uint p = gl_GlobalInvocationID.x;
    if (p >= count) return;
    vec3 direct = linked(p).rgb + key_means[p] * key_irradiance + patches[3u * p + 2u].rgb;
    vec4 sent = vec4(patches[3u * p].rgb + reflectance_of(p) * direct, 0.0);
    source[p] = sent;
    columns[nodes + p] = sent;
    other_columns[nodes + p] = sent;
}
