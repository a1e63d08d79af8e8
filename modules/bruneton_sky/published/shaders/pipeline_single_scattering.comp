#version 430
// Algorithm 4: light scattered once, by molecules and by aerosol, without phase functions.
// A work group has one ray and many suns.

layout(local_size_x = 64) in;

#include "pipeline_air.glsl"
#include "pipeline_lengths.glsl"
#include "pipeline_rays.glsl"
#include "pipeline_optical_depth.glsl"
#include "pipeline_scattering_nodes.glsl"
#include "pipeline_ray_nodes.glsl"

layout(rgba32f, binding = 0) writeonly uniform image3D scattering;
layout(rgba32f, binding = 1) writeonly uniform image3D single_mie;
uniform int first_layer;

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID) + ivec3(0, 0, first_layer);
    Ray ray = ray_of_node(at.z, at.y);
    prepare_ray(ray);
    barrier();
    if (at.x >= NU * MU_S) {
        return;
    }
    Sun sun = sun_of_node(ray, at.x / MU_S, at.x % MU_S);
    vec4 rayleigh = vec4(0.0);
    vec4 mie = vec4(0.0);
    for (int i = 0; i <= RAY_INTERVALS; ++i) {
        float altitude = ray_point[i].altitude;
        float mu_s = mu_s_after(ray.altitude, sun.mu_s, sun.nu, ray_distance[i], altitude);
        vec4 light = ray_clear[i] * transmittance_to_sun(altitude, mu_s);
        vec2 density = densities_at(altitude);
        rayleigh += light * density.x;
        mie += light * density.y;
    }
    imageStore(scattering, at, rayleigh * solar_irradiance * rayleigh_scattering);
    imageStore(single_mie, at, mie * solar_irradiance * mie_scattering);
}
