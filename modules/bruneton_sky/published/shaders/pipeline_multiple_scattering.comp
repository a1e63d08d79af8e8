#version 430
// Algorithm 7: the light that points scatter into a view, gathered along the view, and its part
// in the sum of all orders. A work group has one ray and many suns.

layout(local_size_x = 64) in;

#include "pipeline_air.glsl"
#include "pipeline_lengths.glsl"
#include "pipeline_rays.glsl"
#include "pipeline_optical_depth.glsl"
#include "pipeline_scattering_nodes.glsl"
#include "pipeline_scattering_look_up.glsl"
#include "pipeline_ray_nodes.glsl"

layout(binding = 1) uniform sampler3D density;
layout(rgba32f, binding = 0) writeonly uniform image3D made;
layout(rgba32f, binding = 1) uniform image3D scattering;
uniform int first_layer;

// By how much the rest of the ray is shorter than the longest of its kind.
float deficit_of(Ray ray, int i) {
    if (!ray.hits) {
        return ray_point[i].deficit;
    }
    float rest = ray.ray_length - ray_distance[i];
    float rho = tangent(ray_point[i].altitude);
    return rest > 0.0 ? 2.0 * ray.line.along * rest / (rho + rest) : 0.0;
}

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID) + ivec3(0, 0, first_layer);
    Ray ray = ray_of_node(at.z, at.y);
    prepare_ray(ray);
    barrier();
    if (at.x >= NU * MU_S) {
        return;
    }
    Sun sun = sun_of_node(ray, at.x / MU_S, at.x % MU_S);
    vec4 place = vec4(0.0, nu_place(sun.nu), 0.0, 0.0);
    vec4 radiance = vec4(0.0);
    for (int i = 0; i <= RAY_INTERVALS; ++i) {
        float altitude = ray_point[i].altitude;
        float distance = ray_distance[i];
        float mu_s = mu_s_after(ray.altitude, sun.mu_s, sun.nu, distance, altitude);
        place.x = mu_s_place(mu_s);
        place.z = mu_place(altitude, deficit_of(ray, i), ray.hits);
        place.w = altitude_place(altitude);
        radiance += ray_clear[i] * look_up(density, place);
    }
    imageStore(made, at, radiance);
    // The sum is without Rayleigh's phase function, as its first order is.
    imageStore(scattering, at, imageLoad(scattering, at) + radiance / rayleigh_phase_at(sun.nu));
}
