#version 430
// The light of a volume of air: the twin of air_volume/kernels.py, where the formulas are
// explained. A thread takes one column of one row, slice by slice.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform image3D light;  // columns, rows, 3 * slices

#include "scattered_light.glsl"

struct Slice {
    Bin bin;
    vec4 colour[3];    // of four wavelengths in red, green and blue, over 1 - T
};

layout(std430, binding = 1) restrict readonly buffer Slices { Slice slices[]; };  // of each row
layout(std430, binding = 2) restrict readonly buffer Rows { vec4 rows[]; };  // see shadow_of
layout(std430, binding = 3) restrict readonly buffer Suns { vec2 suns[]; };  // mu_s, nu

uniform ivec3 shape;            // slices, rows, columns

vec3 coloured(Slice s, vec4 spectral) {
    return vec3(dot(s.colour[0], spectral), dot(s.colour[1], spectral), dot(s.colour[2], spectral));
}

void store(int part, int slice, ivec2 at, vec3 rgb) {
    imageStore(light, ivec3(at, part * shape.x + slice), vec4(max(rgb, 0.0), 1.0));
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, shape.zy))) {
        return;
    }
    vec4 row = rows[at.y];
    float mu_s = suns[at.y * shape.z + at.x].x, nu = suns[at.y * shape.z + at.x].y;
    float molecules_phase = rayleigh_phase(nu), over_rayleigh = depolarised(molecules_phase);
    Phases kinds = phases_of(nu);
    vec3 phase = max(kinds.channels.rgb, 1e-30);
    vec2 shadow = shadow_of(row, mu_s, nu);
    vec4 again = vec4(0.0), off_molecules = vec4(0.0), off_aerosol = vec4(0.0);
    for (int k = 0; k < shape.x; ++k) {
        Slice s = slices[at.y * shape.x + k];
        if (s.bin.place.w > 0.0) {
            float sun = (row.x * mu_s + s.bin.place.x * nu) * s.bin.centre.x;
            vec4 lit = sunlight(s.bin, sun, shadow);
            off_molecules += s.bin.molecules * lit * over_rayleigh;
            off_aerosol += s.bin.aerosol * lit * mean_phase(s.bin, kinds);
            again += scattered_again(s.bin, clamp(sun, -1.0, 1.0), nu);
        }
        vec3 aerosol = coloured(s, off_aerosol) / phase;
        vec3 direct = coloured(s, off_molecules) + min(aerosol, 0.0) * phase / molecules_phase;
        vec3 shaded = coloured(s, again) + min(direct, 0.0) * molecules_phase;
        store(0, k, at, shaded);
        store(1, k, at, direct);
        store(2, k, at, aerosol);
    }
}
