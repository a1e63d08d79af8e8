#version 430
// The sky-view table of an observer, on the ground to space: the twin of sky_view/table_kernels.py.
// A thread computes a node.

layout(local_size_x = 8, local_size_y = 8) in;

#include "scattered_light.glsl"

// As in sky_view.glsl: fourth roots of radiance with its phase function, and of aerosol's without.
layout(std430, binding = 1) restrict writeonly buffer Nodes { vec4 nodes[]; };

struct Row {
    vec4 start;     // see shadow_of; radius over the ground's
    vec4 angles;    // cosine and sine of the ray's zenith angle, and of the angle at the planet's
                    // centre between the observer and the ray's start in the air
    vec4 bins;      // its first, how many for light scattered once, for more; length over the
                    // ground's radius of a ray that ends on the ground, else 0
    vec4 end;       // transmittance of that ray
};

// Of each row those for light scattered once, then those for more.
layout(std430, binding = 2) restrict readonly buffer Bins { Bin bins[]; };
layout(std430, binding = 3) restrict readonly buffer Rows { Row rows[]; };

// The ground's colours by four wavelengths, under some suns; the first also has the sun's cosine.
layout(std430, binding = 9) restrict readonly buffer Ground { vec4 ground[]; };

uniform ivec2 table;        // columns, rows
uniform vec2 sun;           // cosine and sine of its zenith angle, for the observer
uniform vec4 ground_grid;   // see SunGrid.constants
uniform mat4 colours;   // of the four wavelengths

vec4 fourth_root(vec4 light) {
    return sqrt(sqrt(max(light, 0.0)));
}

// The ground where a ray ends, seen through the air before it.
vec3 ground_seen(Row row, float mu_s, float nu) {
    float there = clamp(row.start.w * mu_s + row.bins.w * nu, -1.0, 1.0);
    float d = sqrt(1.0 - there) - ground_grid.x;
    float place = (ground_grid.z - d / (ground_grid.y + abs(d))) * ground_grid.w;
    int i = 4 * place_on(place, ground.length() / 4).low;
    float below = ground[i].w, rise = max(ground[i + 4].w - below, 1e-30);
    float far = clamp((there - below) / rise, 0.0, 1.0);
    vec3 seen = vec3(0.0);
    for (int k = 0; k < 4; ++k) {
        seen += row.end[k] * mix(ground[i + k].rgb, ground[i + 4 + k].rgb, far);
    }
    return seen;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, table))) {
        return;
    }
    Row row = rows[at.y];
    float x = float(at.x) / float(table.x - 1), across = sun.y * (1.0 - 2.0 * x * x);
    float nu = clamp(row.angles.x * sun.x + row.angles.y * across, -1.0, 1.0);
    float mu_s = clamp(row.angles.z * sun.x + row.angles.w * across, -1.0, 1.0);
    vec2 shadow = shadow_of(row.start, mu_s, nu);
    Phases phases = phases_of(nu);
    int first = int(row.bins.x), again_from = first + int(row.bins.y);
    vec4 molecules = vec4(0.0), aerosol = vec4(0.0), again = vec4(0.0);
    for (int k = first; k < again_from; ++k) {
        Bin bin = bins[k];
        if (bin.place.w > 0.0) {
            float there = (row.start.x * mu_s + bin.place.x * nu) * bin.centre.x;
            vec4 lit = sunlight(bin, there, shadow);
            molecules += bin.molecules * lit;
            aerosol += bin.aerosol * lit * mean_phase(bin, phases);
        }
    }
    for (int k = again_from; k < again_from + int(row.bins.z); ++k) {
        Bin bin = bins[k];
        if (bin.place.w > 0.0) {
            float there = (row.start.x * mu_s + bin.place.x * nu) * bin.centre.x;
            again += scattered_again(bin, clamp(there, -1.0, 1.0), nu);
        }
    }
    float phase = rayleigh_phase(nu);
    vec4 light = phase * depolarised(phase) * molecules + max(again, 0.0);
    vec4 seen = colours * light;
    if (row.bins.w > 0.0) {
        seen.rgb += ground_seen(row, mu_s, nu);
    }
    int node = 2 * (at.y * table.x + at.x);
    nodes[node] = fourth_root(seen);
    nodes[node + 1] = fourth_root(aerosol);
}
