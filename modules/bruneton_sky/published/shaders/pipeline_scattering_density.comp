#version 430
// Algorithm 5: the light that a point of the air scatters into a direction, from all others.
//
// A work group has one point and one sun, both of them nodes of the tables, and many views:
// light arrives from a zenith angle at an angle from the sun, whatever the view. So it is looked
// up once for the group, along the one axis that is left, nu, and kept in shared memory.

#include "pipeline_air.glsl"
#include "pipeline_lengths.glsl"
#include "pipeline_rays.glsl"
#include "pipeline_optical_depth.glsl"
#include "pipeline_scattering_nodes.glsl"
#include "pipeline_scattering_look_up.glsl"

layout(local_size_x = 128) in;
layout(binding = 1) uniform sampler3D light;        // of the order before
layout(binding = 2) uniform sampler3D single_mie;
layout(binding = 3) uniform sampler2D irradiance;   // which that light shed on the ground
layout(rgba32f, binding = 0) writeonly uniform image3D made;
uniform int first_layer;
// Light scattered once comes in two tables that lack their phase functions.
uniform bool scattered_once;

const int ZENITHS = DENSITY_ZENITH_ANGLES;
const int AZIMUTHS = 2 * ZENITHS;
const float STEP = PI / float(ZENITHS);
shared vec4 light_from[ZENITHS * NU];
shared vec4 mie_from[ZENITHS * NU];
shared vec4 reflected[ZENITHS];             // by the ground, per unit of its irradiance
shared float ground_distance[ZENITHS];      // negative where there is no ground
shared vec4 ground_irradiance[IRRADIANCE_MU_S];
shared vec2 azimuth[AZIMUTHS];              // cosine and sine

vec4 on_mu(sampler3D table, ivec3 at, float far) {
    return mix(texelFetch(table, at, 0), texelFetch(table, at + ivec3(0, 1, 0), 0), far);
}

// Zenith angle and node of nu number i, at an altitude and under a sun that are nodes.
void prepare_light(int i, float h, int altitude_node, int mu_s_node) {
    float mu = cos((float(i / NU) + 0.5) * STEP);
    bool hits = hits_ground(h, mu);
    float deficit = hits ? tangent(h) - length_to_ground(h, mu) : towards(h, mu).deficit;
    float place = mu_place(h, deficit, hits);
    int before = min(int(place), MU - 2);
    ivec3 at = ivec3((i % NU) * MU_S + mu_s_node, before, altitude_node);
    light_from[i] = on_mu(light, at, place - float(before));
    mie_from[i] = scattered_once ? on_mu(single_mie, at, place - float(before)) : vec4(0.0);
}

void prepare_ground(int i, float h) {
    float mu = cos((float(i) + 0.5) * STEP);
    ground_distance[i] = -1.0;
    if (hits_ground(h, mu)) {
        float distance = length_to_ground(h, mu);
        // Looked up backwards: the table knows no rays through the planet.
        Point below = Point(0.0, top_tangent_m - length_to_top(h, -mu) - distance);
        vec4 clear = ratio(transmittance_to_top(below), transmittance_to_top(towards(h, -mu)));
        reflected[i] = clear * ground_albedo / PI;
        ground_distance[i] = distance;
    }
}

void prepare(float h, int altitude_node, int mu_s_node) {
    int first = int(gl_LocalInvocationIndex);
    int stride = int(gl_WorkGroupSize.x);
    for (int i = first; i < ZENITHS * NU; i += stride) {
        prepare_light(i, h, altitude_node, mu_s_node);
    }
    for (int i = first; i < ZENITHS; i += stride) {
        prepare_ground(i, h);
    }
    for (int i = first; i < IRRADIANCE_MU_S; i += stride) {
        ground_irradiance[i] = texelFetch(irradiance, ivec2(i, 0), 0);
    }
    for (int i = first; i < AZIMUTHS; i += stride) {
        float phi = (float(i) + 0.5) * STEP;
        azimuth[i] = vec2(cos(phi), sin(phi));
    }
}

vec4 from_ground(int zenith, float h, float mu_s, float nu) {
    float there = mu_s_after(h, mu_s, nu, ground_distance[zenith], 0.0);
    float place = (0.5 + 0.5 * there) * float(IRRADIANCE_MU_S - 1);
    int before = min(int(place), IRRADIANCE_MU_S - 2);
    float far = place - float(before);
    vec4 falling = mix(ground_irradiance[before], ground_irradiance[before + 1], far);
    return reflected[zenith] * falling;
}

// Radiance that arrives from a zenith angle, at an angle from the sun.
vec4 arriving(int zenith, float h, float mu_s, float nu) {
    float place = nu_place(nu);
    int before = min(int(place), NU - 2);
    int i = zenith * NU + before;
    float far = place - float(before);
    vec4 radiance = mix(light_from[i], light_from[i + 1], far);
    if (scattered_once) {
        radiance *= rayleigh_phase_at(nu);
        radiance += mix(mie_from[i], mie_from[i + 1], far) * mie_phase_at(nu);
    }
    if (ground_distance[zenith] >= 0.0) {
        radiance += from_ground(zenith, h, mu_s, nu);
    }
    return radiance;
}

void main() {
    int texel = int(gl_GlobalInvocationID.x);
    int mu_s_node = int(gl_WorkGroupID.y);
    int layer = int(gl_WorkGroupID.z) + first_layer;
    Ray ray = ray_of_node(layer, texel / NU);
    prepare(ray.altitude, layer, mu_s_node);
    barrier();
    if (texel >= MU * NU) {
        return;
    }
    Sun sun = sun_of_node(ray, texel % NU, mu_s_node);
    vec2 sun_across = sun.sine * vec2(sun.cos_azimuth, sqrt(1.0 - sun.cos_azimuth * sun.cos_azimuth));
    vec4 by_molecules = vec4(0.0);
    vec4 by_aerosol = vec4(0.0);
    for (int zenith = 0; zenith < ZENITHS; ++zenith) {
        float theta = (float(zenith) + 0.5) * STEP;
        float cosine = cos(theta);
        float sine = sin(theta);
        for (int k = 0; k < AZIMUTHS; ++k) {
            vec2 across = sine * azimuth[k];
            float to_sun = clamp(dot(sun_across, across) + sun.mu_s * cosine, -1.0, 1.0);
            float to_view = clamp(ray.sine * across.x + ray.mu * cosine, -1.0, 1.0);
            vec4 radiance = sine * arriving(zenith, ray.altitude, sun.mu_s, to_sun);
            by_molecules += radiance * rayleigh_phase_at(to_view);
            by_aerosol += radiance * mie_phase_at(to_view);
        }
    }
    vec2 density = densities_at(ray.altitude) * STEP * STEP;
    vec4 scattered = rayleigh_scattering * density.x * by_molecules
        + mie_scattering * density.y * by_aerosol;
    imageStore(made, ivec3((texel % NU) * MU_S + mu_s_node, texel / NU, layer), scattered);
}
