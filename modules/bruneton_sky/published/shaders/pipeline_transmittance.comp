#version 430
// Algorithm 2 of the thesis: the transmittance to the top of the atmosphere, as optical depth.

#include "pipeline_air.glsl"
#include "pipeline_lengths.glsl"
#include "pipeline_rays.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform image2D made;

void main() {
    const ivec2 size = ivec2(TRANSMITTANCE_MU, TRANSMITTANCE_ALTITUDE);
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, size))) {
        return;
    }
    vec2 unit = vec2(at) / vec2(size - 1);
    float h = altitude_of_unit(unit.y);
    Ray ray = ray_to_top(h, 1.0 - unit.x);
    float step = ray.ray_length / float(TRANSMITTANCE_INTERVALS);
    vec3 paths = vec3(0.0);
    for (int i = 0; i <= TRANSMITTANCE_INTERVALS; ++i) {
        float altitude = point_on(ray, float(i) * step).altitude;
        bool end = i == 0 || i == TRANSMITTANCE_INTERVALS;
        paths += (end ? 0.5 * step : step) * vec3(densities_at(altitude), absorber_at(altitude));
    }
    vec4 depth = rayleigh_scattering * paths.x + mie_extinction * paths.y
        + absorption_extinction * paths.z;
    imageStore(made, at, depth);
}
