#version 430
// The sky-view table of an observer on the ground: the twin of sky_view/table_kernels.py. A thread
// computes a node.

layout(local_size_x = 8, local_size_y = 8) in;

#include "scattered_light.glsl"

// As in sky_view.glsl: fourth roots of radiance with its phase function, and of aerosol's without.
layout(std430, binding = 1) restrict writeonly buffer Nodes { vec4 nodes[]; };

// Of each row those for light scattered once, then those for more.
layout(std430, binding = 2) restrict readonly buffer Bins { Bin bins[]; };
layout(std430, binding = 3) restrict readonly buffer Rows { vec4 rows[]; };  // see shadow_of; sine

uniform ivec2 table;    // columns, rows
uniform ivec2 counts;   // bins of a row for light scattered once, and for more
uniform vec2 sun;       // cosine and sine of its zenith angle
uniform mat4 colours;   // of the four wavelengths

vec4 fourth_root(vec4 light) {
    return sqrt(sqrt(max(light, 0.0)));
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, table))) {
        return;
    }
    vec4 row = rows[at.y];
    float x = float(at.x) / float(table.x - 1);
    float nu = clamp(row.z * sun.x + row.w * sun.y * (1.0 - 2.0 * x * x), -1.0, 1.0);
    vec2 shadow = shadow_of(row, sun.x, nu);
    Phases phases = phases_of(nu);
    int first = at.y * (counts.x + counts.y);
    vec4 molecules = vec4(0.0), aerosol = vec4(0.0), again = vec4(0.0);
    for (int k = first; k < first + counts.x; ++k) {
        Bin bin = bins[k];
        if (bin.place.w > 0.0) {
            float there = (row.x * sun.x + bin.place.x * nu) * bin.centre.x;
            vec4 lit = sunlight(bin, there, shadow);
            molecules += bin.molecules * lit;
            aerosol += bin.aerosol * lit * mean_phase(bin, phases);
        }
    }
    for (int k = first + counts.x; k < first + counts.x + counts.y; ++k) {
        Bin bin = bins[k];
        if (bin.place.w > 0.0) {
            float there = (row.x * sun.x + bin.place.x * nu) * bin.centre.x;
            again += scattered_again(bin, clamp(there, -1.0, 1.0), nu);
        }
    }
    float phase = rayleigh_phase(nu);
    vec4 light = phase * depolarised(phase) * molecules + max(again, 0.0);
    int node = 2 * (at.y * table.x + at.x);
    nodes[node] = fourth_root(colours * light);
    nodes[node + 1] = fourth_root(aerosol);
}
